r"""Rebuilt loops made simple: where a loop crosses itself by no more than its errors, what runs round in between is cut out.

          a            An axis within e of the true one moves the boundary by no more across, but along itself by up to about
    -----+---->        sqrt(e size): beside flat corners, centres of curvature and cusps the ends of neighbouring sides pass
        / \            each other, or turn round. The way from such a crossing back to it is short, and what it encloses is
       |   |           thinner than the errors: it goes (`_is_error`). A wider one is the shape's own, two walls that are
        `-'            nearer to each other than the axis is to the true one, and stays.

Crossings are found and judged by what finds them in a domain that is handed in (`mat_core.model.meetings`). The branches of a
cusp that rounding turned across each other in its tip leave it along one tangent again.
"""

from __future__ import annotations

from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.outline import measure
from mat_core.kernels import outline as columns
from mat_core.kernels.intersect import TIP
from mat_core.model.curve import RationalBSpline
from mat_core.model.loop import BoundaryArrays, Outline, box_of, frame_of, outline_of
from mat_core.model.meetings import Meeting, find_meetings

Floats = NDArray[np.float64]
Loop = list[RationalBSpline]

ROUNDS = 8  # of looking for crossings; folds inside folds come to light one after the other
WIDTH = 4.0  # errors: mean width of what is cut out at most
LENGTH = 4.0  # times sqrt(error size): its length at most; measured up to 2.3
NOTHING = 1e-9  # of an edge's parameter: what is left of one by less is left out


class _Place(NamedTuple):
    """A place on a loop: edge, its parameter, and how far it is along the loop."""

    edge: int
    u: float
    along: float


class _Round(NamedTuple):
    """The way from a crossing back to it: its length, both ends, and where they meet."""

    length: float
    start: _Place
    end: _Place
    place: Floats


def untangled(loops: list[Loop], error: float) -> list[Loop]:
    """Loops without crossings that errors alone have made.

    Parameters
    ----------
    loops : list of list of RationalBSpline
        Closed, edges head to tail.
    error : float
        By which they may miss the true ones, in their unit.

    Returns
    -------
    list of list of RationalBSpline
        The same curves where nothing crosses.
    """
    for _ in range(ROUNDS):
        arrays = _arrays(loops)
        frame = frame_of(box_of(arrays.cp), float(np.abs(arrays.cp[:, :2]).max()))
        outline = outline_of(arrays, np.ones(len(loops), dtype=np.int64), frame)
        meetings = [m for m in find_meetings(outline)[0] if m.loops[0] == m.loops[1]]
        longest = LENGTH * float(np.sqrt(error * frame.size))
        changed = False
        for index in sorted({m.loops[0] for m in meetings}):
            own = [m for m in meetings if m.loops[0] == index]
            first = int(arrays.loop_start[index])
            for m in own:
                changed |= m.kind == TIP and _straighten_tip(loops[index], outline, m, first)
            cut = _without_rounds(loops[index], outline, [m for m in own if m.kind != TIP], first, longest, error)
            if cut is not None:
                loops = [*loops[:index], cut, *loops[index + 1 :]]
                changed = True
        if not changed:
            break
    return loops


def _arrays(loops: list[Loop]) -> BoundaryArrays:
    """The loops in flat arrays."""
    edges = [edge for loop in loops for edge in loop]

    def starts(counts: list[int]) -> NDArray[np.int64]:
        return np.array([0, *accumulate(counts)], dtype=np.int64)

    return BoundaryArrays(
        degree=np.array([e.degree for e in edges], dtype=np.int64),
        cp_start=starts([len(e.control_points) for e in edges]),
        cp=np.concatenate([np.column_stack((e.control_points, e.weights)) for e in edges]),
        knot_start=starts([len(e.knots) for e in edges]),
        knots=np.concatenate([e.knots for e in edges]),
        loop_start=starts([len(loop) for loop in loops]),
        reversed=np.zeros(len(loops), dtype=np.bool_),
    )


def _straighten_tip(loop: Loop, outline: Outline, meeting: Meeting, first: int) -> bool:
    """Both handles at the tip of a cusp put on one tangent, if rounding has parted them; changes the loop. Lines stay."""
    edges = [int(outline.pi[piece, columns.EDGE]) - first for piece in meeting.pieces]
    before, after = sorted(edges, key=lambda e: meeting.t[edges.index(e)], reverse=True)
    arriving, leaving = loop[before], loop[after]
    tip = leaving.control_points[0]
    handles = [(edge, at, edge.control_points[at] - tip) for edge, at in ((arriving, -2), (leaving, 1))]
    straight = [handle for edge, _, handle in handles if edge.degree == 1]
    along = sum(handle / np.hypot(*handle) for handle in straight or [handle for _, _, handle in handles])
    along = along / np.hypot(*along)
    moved = False
    for edge, at, handle in handles:
        place = tip + (handle @ along) * along
        if edge.degree > 1 and (edge.control_points[at] != place).any():
            edge.control_points[at] = place
            moved = True
    return moved


def _without_rounds(
    loop: Loop, outline: Outline, meetings: list[Meeting], first: int, longest: float, error: float
) -> Loop | None:
    """The loop without the ways from its crossings back to them, shorter ones first; None where none goes."""
    if not meetings:
        return None
    last = int(outline.piece_start[meetings[0].loops[0] + 1]) - 1
    total = float(outline.pf[last, columns.CUM] + outline.pf[last, columns.LEN])
    rounds = []
    for m in meetings:
        a, b = sorted((_place(outline, piece, t, first) for piece, t in zip(m.pieces, m.t, strict=True)),
                      key=lambda place: place.along)
        length = b.along - a.along
        if 2.0 * length > total:
            a, b, length = b, a, total - length
        if 0.0 < length <= longest * outline.frame.scale:
            rounds.append(_Round(length, a, b, np.array(outline.frame.to_input(*m.place))))
    cuts: list[_Round] = []
    for found in sorted(rounds, key=lambda found: found.length):
        apart = all((found.start.along - cut.start.along) % total > cut.length
                    and (cut.start.along - found.start.along) % total > found.length for cut in cuts)
        if apart and _is_error(_between(loop, found.start, found.end, found.place, found.place), error):
            cuts.append(found)
    if not cuts:
        return None
    cuts.sort(key=lambda cut: cut.start.along)
    return [edge for cut, after in zip(cuts, cuts[1:] + cuts[:1], strict=True)
            for edge in _between(loop, cut.end, after.start, cut.place, after.place)]


def _place(outline: Outline, piece: int, t: float, first: int) -> _Place:
    """Where on its loop t of a gentle piece is."""
    row = outline.pf[piece]
    along = float(row[columns.CUM] + t * row[columns.LEN])
    return _Place(int(outline.pi[piece, columns.EDGE]) - first, outline.parameter(piece, t), along)


def _is_error(way: Loop, error: float) -> bool:
    """Whether a closed way encloses no more than errors may."""
    if not way:
        return True
    area, length = measure(way)
    return abs(area) <= WIDTH * error * length


def _between(loop: Loop, a: _Place, b: _Place, start: Floats, end: Floats) -> Loop:
    """The edges from a on to b, which are put at `start` and `end`."""
    out = []
    n = len(loop)
    count = (b.edge - a.edge) % n
    if count == 0 and b.along < a.along:
        count = n
    for step in range(count + 1):
        edge = loop[(a.edge + step) % n]
        low, high = edge.domain
        u0 = a.u if step == 0 else low
        u1 = b.u if step == count else high
        if u1 - u0 > NOTHING * (high - low):
            out.append(edge if (u0, u1) == (low, high) else edge.part(u0, u1))
    if out:
        out[0] = _moved(out[0], 0, start)
        out[-1] = _moved(out[-1], -1, end)
    return out


def _moved(edge: RationalBSpline, end: int, place: Floats) -> RationalBSpline:
    """An edge with its first (0) or last (-1) point elsewhere."""
    control = edge.control_points.copy()
    control[end] = place
    return RationalBSpline(edge.degree, edge.knots, control, edge.weights)
