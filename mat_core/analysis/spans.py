"""The curves of an axis cut into Bezier spans, all of one degree, so that questions about them are asked of all at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.axis import MedialAxis

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
    owner = np.repeat(np.arange(len(c.degree)), np.diff(c.knot_start))
    at = np.nonzero((c.knots[:-1] < c.knots[1:]) & (owner[:-1] == owner[1:]))[0]
    segment = owner[at]
    top = int(c.degree.max(initial=1))
    rows = np.empty((len(at), top + 1, 4))
    homogeneous = np.column_stack((c.cp[:, :3] * c.cp[:, 3:], c.cp[:, 3]))
    for degree in np.unique(c.degree).tolist():
        chosen = np.nonzero(c.degree[segment] == degree)[0]
        knot = at[chosen]
        first = c.cp_start[segment[chosen]] + knot - c.knot_start[segment[chosen]] - degree
        local = homogeneous[first[:, None] + np.arange(degree + 1)]
        knots = c.knots[knot[:, None] + np.arange(1 - degree, degree + 1)]
        rows[chosen] = raised(_blossoms(local, knots, degree), top)
    return Spans(segment, np.column_stack((c.knots[at], c.knots[at + 1])), rows)


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
