"""Where the radius along an axis rises, falls, turns and takes a value.

The radius of a knot span is R(s) / W(s) in Bernstein form. It turns where N = R' W - R W' changes sign; those places are
isolated by Descartes' rule (`mat_core.analysis.bernstein`), not sampled. Between them the radius is monotone, so that it
takes a value once or not at all, which its two ends decide:

        r |      __max__                      arcs       /  -  \\  /      (rising, flat, falling, rising)
          |   __/       \\__     __            value      found on each arc whose ends lie on both sides of it
          |__/             \\min/             interval   where low <= r <= high: one stretch or none on each arc

All of this is about the curves as they are given: the true radius is within `Segment.max_error` of theirs.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.bernstein import derivative, product, sign_changes
from mat_core.analysis.intervals import Intervals, joined
from mat_core.analysis.spans import cut_spans
from mat_core.axis import MedialAxis

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FLAT = 4e-15  # change of a normalised radius that is rounding: radii of one wall computed at two places differ by as much
STEPS = 80  # of Newton's method held by bisection; a dozen do but at a root of high order


class RadiusArcs(NamedTuple):
    """The stretches of all segments on which the radius is monotone, in order of segment and t; they leave no gap.

    segment (m,); t (m, 2): begin and end; radius (m, 2): at these, in the caller's unit; direction (m,): 1 the radius rises
    with t, -1 it falls, 0 it is constant to within rounding. Neighbours on a segment differ in direction.
    """

    segment: Ints
    t: Floats
    radius: Floats
    direction: Ints


class RadiusExtremes(NamedTuple):
    """Local extremes of the radius inside segments, in order of segment and t; ends of open segments are none.

    segment (m,); t (m,): the place, the middle one where the radius is constant along a stretch; radius (m,): there, in
    the caller's unit; kind (m,): 1 a maximum, -1 a minimum. On a closed segment t = 0 stands for the seam.
    """

    segment: Ints
    t: Floats
    radius: Floats
    kind: Ints


def radius_arcs(axis: MedialAxis) -> RadiusArcs:
    """Cut all segments where the radius turns.

    Parameters
    ----------
    axis : MedialAxis

    Returns
    -------
    RadiusArcs
    """
    segment, t = _breaks(axis)
    radius = axis.evaluate(segment, t)[:, 2]
    inner = segment[1:] == segment[:-1]
    change = np.diff(radius)
    flat = FLAT / axis.table.scale
    direction = np.where(change > flat, 1, np.where(change < -flat, -1, 0))[inner]
    low, high = np.nonzero(inner)[0], np.nonzero(inner)[0] + 1
    owner = segment[low]
    new = np.ones(len(low), dtype=bool)
    new[1:] = (owner[1:] != owner[:-1]) | (direction[1:] != direction[:-1])
    first = np.nonzero(new)[0]
    last = np.append(first[1:], len(low)) - 1 if len(low) else first
    low, high = low[first], high[last]
    return RadiusArcs(owner[first], np.column_stack((t[low], t[high])), np.column_stack((radius[low], radius[high])),
                      direction[first])


def _breaks(axis: MedialAxis) -> tuple[Ints, Floats]:
    """(segment, t) of all ends of knot spans and all places inside them where the radius may turn, in order."""
    spans = cut_spans(axis)
    weight = spans.rows[:, :, 3]
    # r - r0 turns where r does, and keeps the digits of a radius that hardly changes
    height = spans.rows[:, :, 2] - (spans.rows[:, :1, 2] / weight[:, :1]) * weight
    slope = product(derivative(height), weight) - product(height, derivative(weight))
    # the slope of a radius that is constant but for rounding
    floor = 2.0 * FLAT * np.square(weight.max(axis=1, initial=1.0))
    row, s = sign_changes(slope, floor)
    begin, end = spans.t[row, 0], spans.t[row, 1]
    segment = np.concatenate((spans.segment, spans.segment, spans.segment[row]))
    t = np.concatenate((spans.t[:, 0], spans.t[:, 1], begin + s * (end - begin)))
    order = np.lexsort((t, segment))
    segment, t = segment[order], t[order]
    new = np.ones(len(t), dtype=bool)
    new[1:] = (t[1:] != t[:-1]) | (segment[1:] != segment[:-1])
    return segment[new], t[new]


def radius_extremes(axis: MedialAxis, arcs: RadiusArcs | None = None) -> RadiusExtremes:
    """Local maxima and minima of the radius inside segments.

    Parameters
    ----------
    axis : MedialAxis
    arcs : RadiusArcs, optional
        From `radius_arcs`, when at hand.

    Returns
    -------
    RadiusExtremes
    """
    a = radius_arcs(axis) if arcs is None else arcs
    sloped = np.nonzero(a.direction)[0]
    segment = a.segment[sloped]
    before, after = sloped[:-1], sloped[1:]
    turns = (segment[:-1] == segment[1:]) & (a.direction[before] != a.direction[after])
    place = 0.5 * (a.t[before, 1] + a.t[after, 0])[turns]
    owner, kind = segment[:-1][turns], a.direction[before][turns]
    # over the seam of a closed segment its last arc comes before its first
    if len(sloped):
        starts = np.nonzero(np.append(True, segment[1:] != segment[:-1]))[0]
        first, last = sloped[starts], sloped[np.append(starts[1:], len(sloped)) - 1]
        over = (axis.runs.start_node[a.segment[first]] < 0) & (a.direction[first] != a.direction[last])
        first, last = first[over], last[over]
        place = np.append(place, np.mod(0.5 * (a.t[last, 1] + a.t[first, 0] + 1.0), 1.0))
        owner, kind = np.append(owner, a.segment[first]), np.append(kind, a.direction[last])
    order = np.lexsort((place, owner))
    owner, place = owner[order], place[order]
    return RadiusExtremes(owner, place, axis.evaluate(owner, place)[:, 2], kind[order])


def solve_radius(axis: MedialAxis, value: float, arcs: RadiusArcs | None = None) -> tuple[Ints, Floats]:
    """Every place inside a segment where the radius passes through a value.

    Parameters
    ----------
    axis : MedialAxis
    value : float
        In the caller's unit.
    arcs : RadiusArcs, optional
        From `radius_arcs`, when at hand: for many values on one axis.

    Returns
    -------
    segment : (k,) int64
    t : (k,) float64
        In order of segment and t. An arc is listed where the radius is at least the value at one of its ends and less at the
        other: a maximum of exactly the value counts twice, a minimum and a stretch of constant radius not at all, so that
        the places always separate where r >= value from where r < value.
    """
    a = radius_arcs(axis) if arcs is None else arcs
    at_least = a.radius >= value
    crossed = np.nonzero(at_least[:, 0] != at_least[:, 1])[0]
    return a.segment[crossed], _on_arcs(axis, a, crossed, np.full(len(crossed), value))


def radius_intervals(
    axis: MedialAxis, low: float = 0.0, high: float = math.inf, arcs: RadiusArcs | None = None
) -> Intervals:
    """The stretches of segments where low <= r <= high.

    Parameters
    ----------
    axis : MedialAxis
    low, high : float
        In the caller's unit.
    arcs : RadiusArcs, optional
        From `radius_arcs`, when at hand.

    Returns
    -------
    Intervals
        As long as can be: no two of one segment share an end, but for the seam of a closed one. Single places where the
        radius only touches a bound have no length and are left out.
    """
    a = radius_arcs(axis) if arcs is None else arcs
    smaller, larger = a.radius.min(axis=1, initial=math.inf), a.radius.max(axis=1, initial=-math.inf)
    kept = np.nonzero((larger >= low) & (smaller <= high) & ((larger > low) | (smaller == larger) | (low == high)))[0]
    t = a.t[kept].copy()
    for end in range(2):
        radius = a.radius[kept, end]
        for bound, outside in ((low, radius < low), (high, radius > high)):
            rows = np.nonzero(outside)[0]
            t[rows, end] = _on_arcs(axis, a, kept[rows], np.full(len(rows), bound))
    long = t[:, 1] > t[:, 0]
    segment, t = a.segment[kept[long]], t[long]
    return joined(segment, t)


def _on_arcs(axis: MedialAxis, a: RadiusArcs, rows: Ints, value: Floats) -> Floats:
    """(k,) the t at which the radius takes value[i] on arc rows[i]; assumes that it does."""
    low, high = a.t[rows, 0], a.t[rows, 1]
    rises = a.radius[rows, 1] > a.radius[rows, 0]
    r0, r1 = a.radius[rows, 0], a.radius[rows, 1]
    span = np.where(r1 == r0, 1.0, r1 - r0)
    t: Floats = low + np.clip((value - r0) / span, 0.0, 1.0) * (high - low)
    active = np.arange(len(rows))
    for _ in range(STEPS):
        if not len(active):
            break
        found = axis.evaluate(a.segment[rows[active]], t[active])
        gap = found[:, 2] - value[active]
        below = (gap < 0.0) == rises[active]
        low[active] = np.where(below, t[active], low[active])
        high[active] = np.where(below, high[active], t[active])
        with np.errstate(divide="ignore", invalid="ignore"):
            step = t[active] - gap / found[:, 5]
        inside = (step > low[active]) & (step < high[active])
        new = np.where(inside, step, 0.5 * (low[active] + high[active]))
        # Newton's own step tells when it has arrived, and so does an interval without room
        moved = np.abs(new - t[active])
        t[active] = np.where(gap == 0.0, t[active], new)
        active = active[(gap != 0.0) & (moved > 1e-16) & (low[active] < high[active])]
    return t
