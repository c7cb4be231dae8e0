"""Evaluating the curves of an axis: rational B-splines in (x, y, r), by de Boor's algorithm in homogeneous form.

X(t) = sum N_i(t) w_i P_i / sum N_i(t) w_i,      X'(t) from the last but one column of the triangle
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.jit import inner, jit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@inner
def spline_point(
    degree: int, knots: Floats, k0: int, k1: int, cp: Floats, c0: int, t: float, work: Floats, out: Floats
) -> None:
    """X and X' by t (both x, y, r) to `out` (6,): knots k0 .. k1 - 1, rows x, y, r, w of `cp` from c0 on.

    `work` is (degree + 1, 4). At an inner knot the span to its right counts; t outside is moved to the nearer end.
    """
    last = k1 - degree - 2
    t = min(max(t, knots[k0]), knots[k1 - 1])
    lo = k0 + degree
    hi = last + 1
    while hi - lo > 1:
        mid = (lo + hi) // 2
        if knots[mid] <= t:
            lo = mid
        else:
            hi = mid
    while lo > k0 + degree and knots[lo] == knots[lo + 1]:
        lo -= 1
    for i in range(degree + 1):
        row = c0 + lo - k0 - degree + i
        w = cp[row, 3]
        for c in range(3):
            work[i, c] = w * cp[row, c]
        work[i, 3] = w
    slope = 0.0
    for level in range(1, degree + 1):
        if level == degree:
            slope = degree / (knots[lo + 1] - knots[lo])
            for c in range(3):
                out[3 + c] = slope * (work[degree, c] - work[degree - 1, c])
            slope *= work[degree, 3] - work[degree - 1, 3]
        for i in range(degree, level - 1, -1):
            left = knots[lo - degree + i]
            a = (t - left) / (knots[lo + 1 + i - level] - left)
            for c in range(4):
                work[i, c] = (1.0 - a) * work[i - 1, c] + a * work[i, c]
    w = work[degree, 3]
    for c in range(3):
        out[c] = work[degree, c] / w
        out[3 + c] = (out[3 + c] - slope * out[c]) / w


@jit
def spline_points(
    degree: Ints, knot_start: Ints, knots: Floats, cp_start: Ints, cp: Floats, segment: Ints, t: Floats, work: Floats,
    point: Floats, out: Floats
) -> None:
    """Rows X, X' of `out` (n, 6) at t[n] of curve segment[n]; room: work (largest degree + 1, 4), point (6,)."""
    for n in range(t.shape[0]):
        g = segment[n]
        spline_point(degree[g], knots, knot_start[g], knot_start[g + 1], cp, cp_start[g], t[n], work, point)
        for c in range(6):
            out[n, c] = point[c]
