"""Where the boundary meets itself: pairs of gentle pieces decided by subdivision.

    adjacent pieces      see `mat_core.kernels.joints`: whether they share more than their joint becomes some tasks
    other pairs          a task where `mat_core.kernels.nearby` finds them close: halve the longer piece, drop what is
                         separated by more than `gap` along x, y, either chord or its normal (control polygons bound
                         the curves); both smaller than gap / 4 and still not separated: they meet

Points of one loop joined by a boundary path of a few gaps are near each other by rights; so are, up to `cusp_path`, the
branches of a cusp (they run against each other, 2 x**1.5 apart at distance x from the tip).

Coordinates, piece tables and gentle pieces as in `mat_core.kernels.outline`. `gap`: what is nearer counts as touching.
Hits, rows of `hits` (n, 5): piece i, its t, piece j, its t, kind. Tasks: columns in `mat_core.kernels.joints`.
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints, restrict
from mat_core.kernels.jit import inner
from mat_core.kernels.joints import (
    AHEAD,
    BEHIND,
    CROSS,
    FOLD,
    I0,
    I1,
    J0,
    J1,
    NEAR_PATH,
    PART,
    PIECE_I,
    PIECE_J,
    distance,
    lines_fold,
    plan,
    plan_joint,
)
from mat_core.kernels.outline import BLOCK, CP0, CUM, DEG, LEN, NARROWEST, span_of, split_range

# Kinds of hits.
MEET = 0  # within `gap` of each other
OVERLAP = 1  # adjacent pieces, the second running back along the first
UNDECIDED = 2  # still not separated when the budget of subdivisions was spent
TIP = 3  # adjacent pieces, crossing in the thin tip at their joint

LEAF = 0.25  # of gap: extent at which subdivision ends; hulls of two leaves add half a gap at most
STRAIGHT_BACK = 0.1  # sine between chords that run against each other, as the branches of a cusp do


@inner
def separated(rows: Floats, p: int, q: int, gap: float) -> bool:
    """Whether blocks 0 (degree p) and BLOCK (degree q) are proved over `gap` apart along x, y, a chord or its normal."""
    dx = 1.0
    dy = 0.0
    for k in range(6):
        # x, y, chord of the first, its normal, chord of the second, its normal
        if k % 2 == 1:
            turned = -dy
            dy = dx
            dx = turned
        elif k > 0:
            c = 0 if k == 2 else BLOCK
            e = p if k == 2 else BLOCK + q
            length = distance(rows, c, rows, e)
            if length > 0.0:
                dx = (rows[e, 0] - rows[c, 0]) / length
                dy = (rows[e, 1] - rows[c, 1]) / length
        low = 0.0
        high = 0.0
        below = True
        above = True
        for i in range(p + q + 2):
            row = i if i <= p else BLOCK + i - p - 1
            v = (rows[row, 0] - rows[0, 0]) * dx + (rows[row, 1] - rows[0, 1]) * dy
            if i > p:
                below = below and v < low - gap
                above = above and v > high + gap
            elif v < low:
                low = v
            elif v > high:
                high = v
        if below or above:
            return True
    return False


@inner
def joined_by_right(rows: Floats, p: int, q: int, path: float, gap: float, cusp_path: float) -> bool:
    """Whether blocks 0 and BLOCK are near only because a short boundary path joins them; `path`: the longest such."""
    if path <= NEAR_PATH * gap:
        return True
    if path > cusp_path or p + q == 2:
        return False
    ax = rows[p, 0] - rows[0, 0]
    ay = rows[p, 1] - rows[0, 1]
    bx = rows[BLOCK + q, 0] - rows[BLOCK, 0]
    by = rows[BLOCK + q, 1] - rows[BLOCK, 1]
    dot = ax * bx + ay * by
    return dot < 0.0 and abs(ax * by - ay * bx) <= -STRAIGHT_BACK * dot


@inner
def compare_joints(
    pi: Ints,
    pf: Floats,
    pcp: Floats,
    piece_start: Ints,
    gap: float,
    noise: float,
    work: Floats,
    tasks: Floats,
    hits: Floats,
) -> tuple[int, int]:
    """All adjacent pairs: what runs back is a hit, what needs a closer look a task; returns the numbers of hits and tasks."""
    found = 0
    planned = 0
    for loop in range(piece_start.shape[0] - 1):
        first = piece_start[loop]
        n = piece_start[loop + 1] - first
        total = pf[first + n - 1, CUM] + pf[first + n - 1, LEN]
        # In a loop of two pieces each joint has the halves next to it; the halves not next to it are compared as well.
        cut = 0.5 if n == 2 else 0.0
        for k in range(n if n > 1 else 0):
            i = first + k
            j = first + (k + 1) % n
            if pi[i, DEG] == 1 and pi[j, DEG] == 1:
                status = FOLD if lines_fold(pcp, pi[i, CP0], pi[j, CP0], gap) else PART
            else:
                far = total - pf[i, LEN] - pf[j, LEN] if n > 2 else math.inf
                status, planned = plan_joint(pi, pcp, i, cut, j, 1.0 - cut, far, gap, noise, work, tasks, planned)
                if n == 2:
                    h = 0.5 * k
                    planned = plan(tasks, planned, first, h, h + 0.5, first + 1, h, h + 0.5, math.inf, math.inf)
            if status != PART and found < hits.shape[0]:
                hits[found, 0] = i
                hits[found, 1] = 1.0 if status == CROSS else 0.5
                hits[found, 2] = j
                hits[found, 3] = 0.0 if status == CROSS else 0.5
                hits[found, 4] = TIP if status == CROSS else OVERLAP
                found += 1
    return found, planned


@inner
def compare_closely(
    pi: Ints,
    pcp: Floats,
    tasks: Floats,
    n: int,
    gap: float,
    cusp_path: float,
    work: Floats,
    stack: Floats,
    budget: int,
    hits: Floats,
    found: int,
) -> int:
    """Do the pieces of the first `n` tasks come within `gap`? Hits after the `found` already there; returns all hits.

    Subdivides at most `budget` times; the pair at which it is spent is a hit of kind UNDECIDED, and the last one.
    """
    for task in range(n):
        i = int(tasks[task, PIECE_I])
        j = int(tasks[task, PIECE_J])
        p = pi[i, DEG]
        q = pi[j, DEG]
        a = pi[i, CP0]
        b = pi[j, CP0]
        stack[0, 0] = tasks[task, I0]
        stack[0, 1] = tasks[task, I1]
        stack[0, 2] = tasks[task, J0]
        stack[0, 3] = tasks[task, J1]
        top = 0
        while top >= 0 and found < hits.shape[0]:
            restrict(pcp, a, p, stack[top, 0], stack[top, 1], work, 0)
            restrict(pcp, b, q, stack[top, 2], stack[top, 3], work, BLOCK)
            on = tasks[task, AHEAD] + distance(pcp, a + p, work, 0) + distance(work, BLOCK + q, pcp, b)
            back = tasks[task, BEHIND] + distance(pcp, b + q, work, BLOCK) + distance(work, p, pcp, a)
            path = on if on < back else back
            if separated(work, p, q, gap) or joined_by_right(work, p, q, path, gap, cusp_path):
                top -= 1
                continue
            sa = span_of(work, 0, p)
            sb = span_of(work, BLOCK, q)
            # Beside a large weight a curve runs so fast that neighbouring parameters are more than a gap apart.
            can_i = stack[top, 1] - stack[top, 0] > NARROWEST
            can_j = stack[top, 3] - stack[top, 2] > NARROWEST
            small = (sa <= LEAF * gap and sb <= LEAF * gap) or not (can_i or can_j)
            if small or budget <= 0:
                hits[found, 0] = i
                hits[found, 1] = 0.5 * (stack[top, 0] + stack[top, 1])
                hits[found, 2] = j
                hits[found, 3] = 0.5 * (stack[top, 2] + stack[top, 3])
                hits[found, 4] = MEET if small else UNDECIDED
                found += 1
                break
            budget -= 1
            split_range(stack, top, 0 if can_i and (sa >= sb or not can_j) else 2)
            top += 1
        if budget <= 0 or found >= hits.shape[0]:
            break
    return found
