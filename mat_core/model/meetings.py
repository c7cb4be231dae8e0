"""Where loops meet: the kernel's hits told apart (crossing, touching, running back, the same loop twice) and reported.

A meeting is looked at on circles of shrinking radius about it: four branches leave it, two of each curve. Where the
branches of one curve separate those of the other around the circle, by more than the gap, the curves cross.

             b              b   a
         a --+-- a           \\ /
             b              a-+-b         left: a b a b, they cross; right: a a b b, they touch
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mat_core.errors import Problem
from mat_core.kernels import intersect
from mat_core.kernels import outline as columns
from mat_core.kernels.bezier import point
from mat_core.kernels.joints import place_on
from mat_core.model.flattening import second_opinion
from mat_core.model.loop import Outline
from mat_core.model.reading import Draft
from mat_core.model.values import edge_pointer, loop_pointer

RADII = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)  # normalised
CLEAR = 8.0  # gaps by which branches must part on a circle to be put in order
SAME_PLACE = 1e-6  # normalised: hits nearer than this on the same loops are one meeting
TRANSVERSAL = 1e-3  # sine between curves from which on Newton's rule is sure to find their crossing from a gap away
NEWTON_STEPS = 3
SAME_SHAPE = 1e-9  # relative: box and area of a loop given twice
PER_EDGES = 4  # meetings reported of one pair of edges
WALK = 16  # points tried along a piece for a branch to leave the circle
BISECTIONS = 50


class Meeting(NamedTuple):
    """Two places of the boundary that are one point."""

    loops: tuple[int, int]  # smaller first
    pieces: tuple[int, int]
    t: tuple[float, float]
    place: tuple[float, float]  # normalised
    kind: int  # of kernels.intersect
    crosses: bool


def find_meetings(outline: Outline) -> tuple[list[Meeting], bool]:
    """All meetings, those of one place once, and whether all pairs could be compared."""
    rows, complete = outline.hits()
    meetings: list[Meeting] = []
    per_edges: dict[tuple[int, int], int] = {}
    near: dict[tuple[int, int, int, int], list[tuple[float, float]]] = {}
    for fi, s, fj, t, kind in rows.tolist():
        i, j = int(fi), int(fj)
        loops = (int(outline.pi[i, columns.LOOP]), int(outline.pi[j, columns.LOOP]))
        edges = (int(outline.pi[i, columns.EDGE]), int(outline.pi[j, columns.EDGE]))
        s, t = polished(outline, (i, j), (s, t))
        x, y = _place(outline, i, s)
        if per_edges.get(edges, 0) >= PER_EDGES or _seen(near, loops, x, y):
            continue
        per_edges[edges] = per_edges.get(edges, 0) + 1
        crosses = kind == intersect.TIP or (kind == intersect.MEET and branches_cross(outline, (i, j), (s, t)))
        meetings.append(Meeting(loops, (i, j), (s, t), (x, y), int(kind), crosses))
    return meetings, complete


def polished(outline: Outline, pieces: tuple[int, int], t: tuple[float, float]) -> tuple[float, float]:
    """Parameters of a meeting, by Newton's rule to the very crossing where there is one; as given where they touch."""
    rows, degrees = outline.pi[pieces, columns.CP0].tolist(), outline.pi[pieces, columns.DEG].tolist()
    s, r = t
    for _ in range(NEWTON_STEPS):
        ax, ay, adx, ady = place_on(outline.cp, rows[0], degrees[0], s, 0.0, 0.0)
        bx, by, bdx, bdy = place_on(outline.cp, rows[1], degrees[1], r, ax, ay)
        cross = adx * bdy - ady * bdx
        if abs(cross) <= TRANSVERSAL * math.hypot(adx, ady) * math.hypot(bdx, bdy):
            return t
        s += (bx * bdy - by * bdx) / cross
        r += (bx * ady - by * adx) / cross
    found = abs(s - t[0]) <= SAME_PLACE and abs(r - t[1]) <= SAME_PLACE and 0.0 <= s <= 1.0 and 0.0 <= r <= 1.0
    return (s, r) if found else t


def _seen(
    near: dict[tuple[int, int, int, int], list[tuple[float, float]]], loops: tuple[int, int], x: float, y: float
) -> bool:
    """Whether a place of these loops was met before; remembers it if not."""
    column, row = round(x / SAME_PLACE), round(y / SAME_PLACE)
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            for ox, oy in near.get((*loops, column + dx, row + dy), ()):
                if math.hypot(ox - x, oy - y) <= SAME_PLACE:
                    return True
    near.setdefault((*loops, column, row), []).append((x, y))
    return False


def _place(outline: Outline, piece: int, t: float) -> tuple[float, float]:
    row = outline.pi[piece]
    x, y = point(outline.cp, int(row[columns.CP0]), int(row[columns.DEG]), t)
    return float(x), float(y)


def branches_cross(outline: Outline, pieces: tuple[int, int], t: tuple[float, float]) -> bool:
    """Whether the two curves through a meeting separate each other's branches on some circle about it."""
    centre = _place(outline, pieces[0], t[0])
    for radius in RADII:
        branches: list[tuple[float, int]] = []
        for curve in (0, 1):
            for direction in (1, -1):
                end = leave_circle(outline, pieces[curve], t[curve], direction, centre, radius)
                if end is not None:
                    branches.append((math.atan2(end[1] - centre[1], end[0] - centre[0]), curve))
        if len(branches) < 4:
            continue
        branches.sort()
        parted = True
        for k in range(4):
            (angle, curve), (next_angle, next_curve) = branches[k - 1], branches[k]
            opening = (next_angle - angle) % (2.0 * math.pi)
            parted = parted and curve != next_curve and opening * radius > CLEAR * outline.frame.gap
        if parted:
            return True
    return False


def leave_circle(
    outline: Outline, piece: int, t: float, direction: int, centre: tuple[float, float], radius: float
) -> tuple[float, float] | None:
    """Where the boundary, followed from a place in one direction, first leaves a circle; None if it never does."""
    loop = int(outline.pi[piece, columns.LOOP])
    first, last = int(outline.piece_start[loop]), int(outline.piece_start[loop + 1])

    def outside(i: int, s: float) -> bool:
        x, y = _place(outline, i, s)
        return math.hypot(x - centre[0], y - centre[1]) >= radius

    for step in range(last - first + 1):
        i = first + (piece - first + direction * step) % (last - first)
        begin = t if step == 0 else (0.0 if direction > 0 else 1.0)
        end = 1.0 if direction > 0 else 0.0
        inner = begin
        for k in range(1, WALK + 1):
            outer = begin + (end - begin) * k / WALK
            if outside(i, outer):
                for _ in range(BISECTIONS):
                    middle = 0.5 * (inner + outer)
                    if outside(i, middle):
                        outer = middle
                    else:
                        inner = middle
                return _place(outline, i, outer)
            inner = outer
    return None


def same_loop(outline: Outline, a: int, b: int) -> bool:
    """Whether two loops that meet have the same box and area: one given twice, in whatever direction or pieces."""
    ea, eb = outline.extent(a), outline.extent(b)
    area_a, area_b = (abs(float(outline.measures[k, 0])) for k in (a, b))
    return max(abs(p - q) for p, q in zip(ea, eb, strict=True)) <= SAME_SHAPE and abs(
        area_a - area_b
    ) <= SAME_SHAPE * max(area_a, area_b)


def meeting_problems(outline: Outline, draft: Draft, meetings: list[Meeting], flat: set[int]) -> Iterator[Problem]:
    """One problem for each meeting; a loop given twice is one problem; loops without area have theirs already."""
    twins: dict[tuple[int, int], bool] = {}
    own = sorted({m.loops[0] for m in meetings if m.loops[0] == m.loops[1]} - flat)
    opinions = second_opinion(outline, own) if own else {}
    for meeting in meetings:
        a, b = meeting.loops
        if a == b:
            if a not in flat:
                problem = _describe(outline, draft, meeting)
                # Once a loop: shapely names one place of each.
                opinion = opinions.pop(a, None)
                yield problem if opinion is None else replace(problem, message=f"{problem.message} ({opinion})")
            continue
        if meeting.loops not in twins:
            twins[meeting.loops] = not meeting.crosses and same_loop(outline, a, b)
            if twins[meeting.loops]:
                first = "the outer loop" if a == 0 else f"hole {a - 1}"
                text = f"hole {b - 1} is the same curve as {first}; remove one of them"
                x, y = outline.frame.to_input(*meeting.place)
                yield Problem("duplicate-loop", loop_pointer(b), text, b, None, None, x, y, loop_pointer(a))
        if not twins[meeting.loops]:
            yield _describe(outline, draft, meeting)


def _describe(outline: Outline, draft: Draft, meeting: Meeting) -> Problem:
    """The problem of one meeting: both edges, both parameters, the place, what to do."""
    ends = []
    for piece, t in zip(meeting.pieces, meeting.t, strict=True):
        row = outline.pi[piece]
        ends.append((int(row[columns.LOOP]), int(draft.edge_of[row[columns.EDGE]]), outline.parameter(piece, t)))
    # The pointer goes to the later loop: a hole is in the way of the outer loop, not the other way round.
    ends.sort(key=lambda end: (-end[0], end[1]))
    (loop, edge, u), (other_loop, other_edge, other_u) = ends
    x, y = outline.frame.to_input(*meeting.place)
    x, y = float(np.float64(x)), float(np.float64(y))
    this, that = _words(loop, edge), _words(other_loop, other_edge)
    where = f"at ({x:.9g}, {y:.9g}), u = {u:.9g} and {other_u:.9g}"
    if meeting.kind == intersect.OVERLAP:
        text = f"{this} and {that} run back along each other {where}; a boundary must not double back"
    elif meeting.kind == intersect.UNDECIDED:
        text = f"{this} and {that} are too near to each other to be told apart {where}; move them apart"
    elif meeting.kind == intersect.TIP:
        text = (
            f"{this} crosses {that} in the tip of the cusp {where}; "
            "let both leave the tip on the sides they have farther on, or along one tangent"
        )
    elif meeting.crosses:
        text = f"{this} crosses {that} {where}; boundaries must not cross"
    else:
        text = f"{this} touches {that} {where}; leave a gap between them, or join or cut the loops there"
    if loop == other_loop:
        code = "self-intersection"
    else:
        code = "loops-cross" if meeting.crosses else "loops-touch"
    return Problem(code, edge_pointer(loop, edge), text, loop, edge, u, x, y, edge_pointer(other_loop, other_edge))


def _words(loop: int, edge: int) -> str:
    return f"edge {edge} of the outer loop" if loop == 0 else f"edge {edge} of hole {loop - 1}"
