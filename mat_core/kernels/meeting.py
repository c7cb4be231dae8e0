"""Where the boundary meets itself, from the pieces to the hits in one call, and the order in which pieces are best looked at.

Coordinates, piece tables and gentle pieces as in `mat_core.kernels.outline`.
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints
from mat_core.kernels.intersect import compare_closely, compare_joints
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.nearby import compare_pairs, fill_tree
from mat_core.kernels.sorting import sort

CELL_BITS = 20
CELLS = 1 << CELL_BITS  # of the Z-curve, along each axis of the unit square
TOO_FEW = 2  # groups to be worth an order


@jit
def compare(
    pi: Ints,
    pf: Floats,
    pcp: Floats,
    piece_start: Ints,
    gap: float,
    noise: float,
    cusp_path: float,
    piece: Ints,
    part: Floats,
    tree: Floats,
    pairs: Ints,
    budget: int,
    give_up: bool,
    work: Floats,
    stack: Floats,
    tasks: Floats,
    hits: Floats,
) -> tuple[int, int, int]:
    """Hits of all pieces with each other, looked at in the parts `piece`, `part`.

    Returns the numbers of hits, of tasks and of pairs of nodes that were looked at. Where there are more tasks than `tasks` has
    room for, none is looked at closely, unless to `give_up` is all that is left.
    """
    fill_tree(pi, pcp, piece, part, work, tree)
    found, planned = compare_joints(pi, pf, pcp, piece_start, gap, noise, work, tasks, hits)
    planned, looked = compare_pairs(pi, pf, pcp, piece_start, gap, piece, part, tree, pairs, work, tasks, planned)
    room = tasks.shape[0]
    if planned <= room or give_up:
        some = min(planned, room)
        found = compare_closely(pi, pcp, tasks, some, gap, cusp_path, work, stack, budget, hits, found)
    return found, planned, looked


@inner
def place_on_curve(x: float, y: float) -> int:
    """The place of a normalised point along a Z-curve."""
    column = int((x + 0.5) * (CELLS - 1))
    row = int((y + 0.5) * (CELLS - 1))
    place = 0
    for bit in range(CELL_BITS):
        place |= (column >> bit & 1) << 2 * bit | (row >> bit & 1) << 2 * bit + 1
    return place


@jit
def arrange(box: Floats, start: Ints, place: Ints, group: Ints, spare: Ints, order: Ints) -> None:
    """Fill `order` (n,) with 0 .. n - 1: those of a group in their order, the groups along a Z-curve.

    `box` (n, 4): xmin, ymin, xmax, ymax, normalised; start (G + 1,): those of group g are start[g] .. start[g + 1] - 1. Room for
    a number of each group: `place`, `group`, `spare`.
    """
    groups = 0
    for g in range(start.shape[0] - 1):
        if start[g] == start[g + 1]:
            continue
        x0 = y0 = math.inf
        x1 = y1 = -math.inf
        for i in range(start[g], start[g + 1]):
            x0 = min(x0, box[i, 0])
            y0 = min(y0, box[i, 1])
            x1 = max(x1, box[i, 2])
            y1 = max(y1, box[i, 3])
        place[g] = place_on_curve(0.5 * (x0 + x1), 0.5 * (y0 + y1))
        group[groups] = g
        groups += 1
    if groups > TOO_FEW:
        sort(place, group, spare, 0, groups)
    n = 0
    for k in range(groups):
        for i in range(start[group[k]], start[group[k] + 1]):
            order[n] = i
            n += 1
