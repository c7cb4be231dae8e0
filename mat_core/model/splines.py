"""The rules one rational B-spline must keep, for all edges at once.

Each rule gives the places where it is broken: rows of the control points or indices of the knots, of which the first of
an edge is reported. A later rule on knots looks only at edges that kept the earlier ones.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.errors import Problem
from mat_core.model.loop import BoundaryArrays
from mat_core.model.reading import Draft
from mat_core.model.survey import HALF_RANGE, LARGEST, WIDEST
from mat_core.model.values import edge_pointer, loop_name

Places = NDArray[np.intp]
Flags = NDArray[np.bool_]


class Breach(NamedTuple):
    """Edges that break one rule, each with its first place: an index in its control points, weights or knots."""

    edges: Places
    places: Places
    code: str
    member: str  # of the edge; the place is appended. Empty: the edge as a whole
    text: str


def spline_problems(draft: Draft, rounding: float, join: float, sound: Flags) -> Iterator[Problem]:
    """Rules of single edges; clears `sound` (E,) where one is broken.

    `rounding`: extent below which an edge has no shape; `join`: distance below which two points of a curve are one.
    """
    arrays, seen = draft.arrays, draft.seen
    if seen.sound and seen.least_extent > rounding:
        return
    with np.errstate(invalid="ignore", over="ignore"):
        breaches = [*point_breaches(arrays, seen.extent, rounding), *weight_breaches(arrays), *knot_breaches(arrays, join)]
    for edges, places, code, member, text in breaches:
        sound[edges] = False
        for e, index in zip(edges.tolist(), places.tolist(), strict=True):
            loop, edge = draft.place_of(e)
            pointer = edge_pointer(loop, edge)
            if member:
                pointer += f"/{member}/{index}"
            row = arrays.cp[arrays.cp_start[e] + (index if member in ("control_points", "weights") else 0)]
            x, y = (float(c) if abs(c) <= LARGEST else None for c in row[:2])
            u = float(arrays.knots[arrays.knot_start[e] + (index if member == "knots" else 0)])
            yield Problem(
                code, pointer, f"{loop_name(loop)}, edge {edge}: {text}", loop, edge, u if math.isfinite(u) else None,
                x, y,
            )  # fmt: skip


def firsts(where: Flags, starts: NDArray[np.int64]) -> tuple[Places, Places]:
    """The edges in whose part of a flat array something is marked, and the first index of it in that part."""
    found = np.flatnonzero(where)
    edges, first = np.unique(np.searchsorted(starts, found, side="right") - 1, return_index=True)
    return edges, found[first] - starts[edges]


def point_breaches(arrays: BoundaryArrays, extent: NDArray[np.float64], rounding: float) -> Iterator[Breach]:
    """Control points finite, not too far out, and not all the very same.

    Almost the same will do (`mat_core.model.healing` passes such an edge over), but not for all edges of a loop.
    """
    points, starts = arrays.cp[:, :2], arrays.cp_start
    reach = np.abs(points).max(axis=1)
    # NaN fails every comparison; maximum and minimum hand it on.
    if not reach.max() <= LARGEST:
        finite = np.isfinite(reach)
        text = "coordinate is not a finite number; give numbers only"
        yield Breach(*firsts(~finite, starts), "non-finite", "control_points", text)
        text = f"coordinate is beyond {LARGEST:g}; scale the domain"
        yield Breach(*firsts(finite & (reach > LARGEST), starts), "out-of-range", "control_points", text)
    filled = np.flatnonzero(np.diff(arrays.loop_start))
    largest = np.maximum.reduceat(extent, arrays.loop_start[filled])
    shapeless = np.repeat(largest <= rounding, np.diff(arrays.loop_start)[filled])
    single = np.flatnonzero(shapeless | (extent == 0.0))
    if len(single):
        text = "all control points coincide: an edge without length; remove it"
        yield Breach(single, np.zeros_like(single), "zero-length-edge", "", text)


def weight_breaches(arrays: BoundaryArrays) -> Iterator[Breach]:
    """Weights finite, positive, and the largest at most WIDEST times the smallest."""
    weights, starts = arrays.cp[:, 2], arrays.cp_start
    if weights.min() > 0.0 and weights.max() <= WIDEST * weights.min() < math.inf:
        return
    finite = np.isfinite(weights)
    positive = weights > 0.0
    text = "weight is not a finite number; give positive numbers"
    yield Breach(*firsts(~finite, starts), "non-finite", "weights", text)
    text = "weight is not positive; weights must be greater than 0"
    yield Breach(*firsts(finite & ~positive, starts), "non-positive-weight", "weights", text)
    usable = finite & positive
    most = np.maximum.reduceat(np.where(usable, weights, 0.0), starts[:-1])
    least = np.minimum.reduceat(np.where(usable, weights, math.inf), starts[:-1])
    wide = np.flatnonzero(most > WIDEST * least)
    text = f"largest weight is over {WIDEST:g} times the smallest; split or refit the curve"
    yield Breach(wide, np.zeros_like(wide), "out-of-range", "weights", text)


def knot_breaches(arrays: BoundaryArrays, join: float) -> Iterator[Breach]:
    """Knots finite, in order, clamped, over a range; inner ones at most degree times unless the curve stays whole."""
    knots, starts, degree = arrays.knots, arrays.knot_start, arrays.degree
    first, last = starts[:-1], starts[1:] - 1
    good = np.ones(len(degree), dtype=np.bool_)

    def breach(where: Flags, text: str) -> Breach:
        edges, places = firsts(where, starts)
        kept = good[edges]
        good[edges] = False
        return Breach(edges[kept], places[kept], "non-finite" if "finite" in text else "invalid-spline", "knots", text)

    def breach_at(broken: Flags, offset: NDArray[np.int64], text: str) -> Breach:
        edges = np.flatnonzero(broken)
        return Breach(edges, offset[edges], "invalid-spline", "knots", text)

    finite = np.isfinite(knots)
    if not finite.all():
        yield breach(~finite, "knot is not a finite number; give numbers only")
    falls = np.zeros(len(knots), dtype=np.bool_)
    np.less(knots[1:], knots[:-1], out=falls[1:])
    falls[first] = False
    if falls.any():
        yield breach(falls, "knots decrease here; each must be at least the one before")
    start, end = knots[first], knots[last]
    empty = good & (~(end > start) | (0.5 * end - 0.5 * start > HALF_RANGE))
    loose_start = good & ~empty & ((knots[first + degree] != start) | (knots[first + degree + 1] == start))
    loose_end = good & ~empty & ((knots[last - degree] != end) | (knots[last - degree - 1] == end))
    if (empty | loose_start | loose_end).any():
        text = "parameter range is empty or infinite; the knots must span an interval"
        yield breach_at(empty, np.zeros_like(degree), text)
        text = "first knot must appear exactly degree + 1 times; clamp the curve"
        yield breach_at(loose_start, degree, text)
        text = "last knot must appear exactly degree + 1 times; clamp the curve"
        yield breach_at(loose_end, last - first - degree, text)
    good &= ~(empty | loose_start | loose_end)
    if (last - first + 1 > 3 * degree + 2).any():
        yield from repeated_knots(arrays, good, join)


def repeated_knots(arrays: BoundaryArrays, good: Flags, join: float) -> Iterator[Breach]:
    """Inner knots more than degree + 1 times, or degree + 1 times where the curve jumps."""
    knots, starts = arrays.knots, arrays.knot_start
    owner = np.repeat(np.arange(len(arrays.degree)), np.diff(starts))
    at = np.arange(len(knots))
    degree = arrays.degree[owner]
    # `at` is the last of degree + 1 equal inner knots.
    runs = good[owner] & (at - starts[owner] > 2 * degree) & (at < starts[owner + 1] - degree - 1)
    runs &= knots[at - np.where(runs, degree, 0)] == knots
    if not runs.any():
        return
    more = runs & (knots[at - np.where(runs, degree + 1, 0)] == knots)
    text = "inner knot appears more than degree + 1 times; remove some"
    yield Breach(*firsts(more, starts), "invalid-spline", "knots", text)
    # Nothing but its two neighbours in the control polygon holds the curve together here.
    ends = np.flatnonzero(runs & ~more)
    row = arrays.cp_start[owner[ends]] + ends - starts[owner[ends]] - degree[ends] - 1
    apart = np.abs(arrays.cp[row + 1, :2] - arrays.cp[row, :2]).max(axis=1) > join
    jumps = np.zeros(len(knots), dtype=np.bool_)
    jumps[ends[apart]] = True
    text = "curve jumps at this knot (degree + 1 times); split the edge here or close the gap"
    yield Breach(*firsts(jumps, starts), "invalid-spline", "knots", text)
