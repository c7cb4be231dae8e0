"""Where along segments the radius changes no faster than a bound: an inequality between polynomials on every span.

With X = (x, y, r) = P / W on a span the derivatives are X' = N / W^2, N = P' W - P W', and |dr/ds| <= c reads
c^2 (Nx^2 + Ny^2) - Nr^2 >= 0. Seen from its centre the footpoints of a disc are theta apart, |dr/ds| = cos(theta / 2).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.bernstein import derivative, product, sign_changes
from mat_core.analysis.intervals import Intervals, joined
from mat_core.analysis.spans import cut_spans
from mat_core.axis import MedialAxis

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

GRAZE = 1e-9  # of dr/ds: what changes by exactly the bound is within it whatever rounding says


def slope_intervals(axis: MedialAxis, steepest: float, sign: int = 0) -> Intervals:
    """Where |dr/ds| is at most a bound, or dr/ds in one direction is.

    Parameters
    ----------
    axis : MedialAxis
    steepest : float
        The bound, 0 to 1.
    sign : {0, 1, -1}
        0: |dr/ds| counts. 1: dr/ds with t, so that a radius that falls with t is within the bound however fast it falls;
        -1: dr/ds against t.

    Returns
    -------
    Intervals
        As long as can be.
    """
    bound = steepest + GRAZE
    spans = cut_spans(axis)
    weight = spans.rows[:, :, 3]
    margin = np.zeros((len(weight), 4 * weight.shape[1] - 5))
    for column, factor in ((0, bound**2), (1, bound**2), (2, -1.0)):
        # from the span's start, which loses no digits on a short one
        own = spans.rows[:, :, column] - spans.rows[:, :1, column] / weight[:, :1] * weight
        slope = product(derivative(own), weight) - product(own, derivative(weight))
        margin += factor * product(slope, slope)
    row, s = sign_changes(margin)
    segment, t = stretches(
        np.concatenate((spans.segment, spans.segment, spans.segment[row])),
        np.concatenate((spans.t[:, 0], spans.t[:, 1], spans.t[row, 0] + s * (spans.t[row, 1] - spans.t[row, 0]))))
    d = axis.evaluate(segment, t.mean(axis=1))
    change = np.abs(d[:, 5]) if sign == 0 else sign * d[:, 5]
    within = change <= bound * np.hypot(d[:, 3], d[:, 4])
    return joined(segment[within], t[within])


def stretches(segment: Ints, t: Floats) -> tuple[Ints, Floats]:
    """What lies between neighbouring places, given in any order: segment (k,) and t (k, 2), in order."""
    order = np.lexsort((t, segment))
    segment, t = segment[order], t[order]
    gap = np.nonzero((segment[1:] == segment[:-1]) & (t[1:] > t[:-1]))[0]
    return segment[gap], np.column_stack((t[gap], t[gap + 1]))
