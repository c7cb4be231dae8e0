"""The curves of an axis cut into Beziers: by their knots, all of one degree, or by the pairs of sides that they pass."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.bernstein import restrict
from mat_core.analysis.intervals import Intervals, containing
from mat_core.axis import MedialAxis
from mat_core.model.curve import restricted

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Spans(NamedTuple):
    """The knot spans of all segments in order of segment and t; normalised coordinates.

    segment (S,); t (S, 2): where a span begins and ends on its segment; rows (S, n + 1, 4): its Bezier rows w x, w y, w r, w
    with n the largest degree of any segment, s = (t - t0) / (t1 - t0) in [0, 1]. Weights are positive.
    """

    segment: Ints
    t: Floats
    rows: Floats


def cut_spans(axis: MedialAxis) -> Spans:
    """All knot spans of an axis, raised to one degree.

    Parameters
    ----------
    axis : MedialAxis

    Returns
    -------
    Spans
    """
    c = axis.curves
    at, segment = _places(axis)
    top = int(c.degree.max(initial=1))
    rows = np.empty((len(at), top + 1, 4))
    for degree in np.unique(c.degree).tolist():
        chosen = np.nonzero(c.degree[segment] == degree)[0]
        rows[chosen] = raised(_cut(axis, at[chosen], segment[chosen], degree), top)
    return Spans(segment, np.column_stack((c.knots[at], c.knots[at + 1])), rows)


def cut_parts(axis: MedialAxis) -> tuple[Ints, Floats]:
    """Every part of `CurveTable`, in its order, as a Bezier: its own share of the polynomial that may go through several.

    Parameters
    ----------
    axis : MedialAxis

    Returns
    -------
    degree : (P,) int64
    rows : (P, largest degree + 1, 4) float64
        Control discs x, y, r (normalised) and weight, not multiplied; the last one repeated where the degree is lower.
    """
    c = axis.curves
    at, owner = _places(axis)
    t = np.column_stack((c.knots[at], c.knots[at + 1]))
    segment = c.part_segment
    span = containing(Intervals(owner, t), segment, c.part_f[:, :2].mean(axis=1))
    share = np.clip((c.part_f[:, :2] - t[span, :1]) / (t[span, 1:] - t[span, :1]), 0.0, 1.0)
    share[share[:, 0] >= share[:, 1]] = 0.0, 1.0
    degree: Ints = c.degree[segment]
    rows = np.empty((len(segment), int(c.degree.max(initial=1)) + 1, 4))
    for p in np.unique(degree).tolist():
        own = np.flatnonzero(degree == p)
        cut = restrict(_cut(axis, at[span[own]], segment[own], p), share[own, 0], share[own, 1])
        cut[..., :3] /= cut[..., 3:]
        rows[own, : p + 1], rows[own, p + 1 :] = cut, cut[:, -1:]
    return degree, rows


def stretch(axis: MedialAxis, segment: int, t0: float, t1: float) -> tuple[int, Floats, Floats]:
    """The part of one segment's curve from t0 < t1 on, as a spline of its own over [0, 1].

    Returns
    -------
    degree : int
        The segment's own.
    knots : (n + degree + 1,) float64
        Clamped, each inner one `degree` times.
    rows : (n, 4) float64
        x, y, r in the caller's coordinates, and the weight, not multiplied.
    """
    c = axis.curves
    degree = int(c.degree[segment])
    at = np.arange(c.knot_start[segment], c.knot_start[segment + 1] - 1)
    begin, end = c.knots[at], c.knots[at + 1]
    kept = (begin < end) & (begin < t1) & (end > t0)
    at, begin, end = at[kept], begin[kept], end[kept]
    spans = _cut(axis, at, np.full(len(at), segment), degree)
    spans[-1] = restricted(spans[-1], 0.0, (t1 - begin[-1]) / (end[-1] - begin[-1]) if t1 < end[-1] else 1.0)
    if t0 > begin[0]:
        last = min(t1, float(end[0]))
        spans[0] = restricted(spans[0], (t0 - begin[0]) / (last - begin[0]), 1.0)
    rows = np.concatenate((spans[:, :-1].reshape(-1, 4), spans[-1:, -1]))
    rows[:, :3] /= rows[:, 3:]
    rows[:, :3] /= axis.table.scale
    rows[:, :2] += axis.table.origin
    inner = (begin[1:] - t0) / (t1 - t0)
    knots = np.concatenate((np.zeros(degree + 1), np.repeat(inner, degree), np.ones(degree + 1)))
    return degree, knots, rows


def _places(axis: MedialAxis) -> tuple[Ints, Ints]:
    """(index of its first knot, segment) of every knot span that has a length."""
    c = axis.curves
    owner = np.repeat(np.arange(len(c.degree)), np.diff(c.knot_start))
    at = np.nonzero((c.knots[:-1] < c.knots[1:]) & (owner[:-1] == owner[1:]))[0]
    return at, owner[at]


def _cut(axis: MedialAxis, at: Ints, segment: Ints, degree: int) -> Floats:
    """Bezier rows (m, degree + 1, 4) of the spans after knots `at` of segments of one degree."""
    c = axis.curves
    first = c.cp_start[segment] + at - c.knot_start[segment] - degree
    local = c.cp[first[:, None] + np.arange(degree + 1)]
    local = np.concatenate((local[..., :3] * local[..., 3:], local[..., 3:]), axis=2)
    return _blossoms(local, c.knots[at[:, None] + np.arange(1 - degree, degree + 1)], degree)


def _blossoms(rows: Floats, knots: Floats, degree: int) -> Floats:
    """Bezier rows of spans [a, b] from their B-spline rows (m, p + 1, d); knots (m, 2 p), a and b are the middle two.

    The row f(t_1 .. t_p) of the blossom has its knots left of a replaced by a, then those right of b by b, in convex steps.
    """
    p = degree
    a, b = knots[:, p - 1 : p], knots[:, p : p + 1]
    out = rows.copy()
    for r in range(1, p + 1):
        for q in range(p - r + 1):
            low, high = knots[:, q + r - 1 : q + r], knots[:, p + q : p + q + 1]
            share = (a - low) / (high - low)
            out[:, q] = (1.0 - share) * out[:, q] + share * out[:, q + 1]
    for r in range(1, p + 1):
        for i in range(p, r - 1, -1):
            high = knots[:, p + i - r : p + i - r + 1]
            share = (b - a) / (high - a)
            out[:, i] = (1.0 - share) * out[:, i - 1] + share * out[:, i]
    return out


def raised(rows: Floats, degree: int) -> Floats:
    """The same Bezier spans (m, p + 1, d) with `degree` + 1 rows each."""
    while rows.shape[1] <= degree:
        p = rows.shape[1]
        share = (np.arange(1, p) / p)[:, None]
        inner = share * rows[:, :-1] + (1.0 - share) * rows[:, 1:]
        rows = np.concatenate((rows[:, :1], inner, rows[:, -1:]), axis=1)
    return rows
