"""Many evaluations in one call, row by row: places on the boundary, input parameters, points of splines."""

from __future__ import annotations

from mat_core.kernels.curve import edge_parameter, evaluate
from mat_core.kernels.jit import jit


@jit
def edge_parameters(si, sf, cp, site, s, u):
    """The input edges' own parameters at s on a site."""
    for n in range(site.shape[0]):
        u[n] = edge_parameter(si, sf, cp, site[n], s[n])


@jit
def spline_values(degree, knot_start, knots, cp_start, cp, axes, which, t, work, out):
    """Points of rational B-splines, spline which[n] at t[n] to out[n, :axes], by de Boor's homogeneous triangle.

    Rows of `cp` hold `axes` coordinates (not multiplied by it) and the weight. Assumes clamped, rising knots. `work`
    is (d + 1, axes + 1). Coordinates are taken from the first control point on, so that weights of any size and a curve
    far away cost no digits.
    """
    for n in range(which.shape[0]):
        g = which[n]
        d = degree[g]
        first = knot_start[g] + d
        span = first
        last = knot_start[g + 1] - d - 2
        while last > span:
            middle = (span + last + 1) // 2
            if knots[middle] <= t[n]:
                span = middle
            else:
                last = middle - 1
        origin = cp_start[g] + span - first
        for i in range(d + 1):
            row = origin + i
            w = cp[row, axes]
            for c in range(axes):
                work[i, c] = w * (cp[row, c] - cp[origin, c])
            work[i, axes] = w
        for level in range(1, d + 1):
            for i in range(d + 1 - level):
                left = knots[span - d + level + i]
                right = knots[span + 1 + i]
                before = (right - t[n]) / (right - left)
                after = (t[n] - left) / (right - left)
                for c in range(axes + 1):
                    work[i, c] = before * work[i, c] + after * work[i + 1, c]
        for c in range(axes):
            out[n, c] = cp[origin, c] + work[0, c] / work[0, axes]


@jit
def frames_at(si, sf, cp, site, s, frame):
    """Rows x, y, tx, ty of the boundary at s on a site."""
    for n in range(site.shape[0]):
        x, y, tx, ty, k, speed = evaluate(si, sf, cp, site[n], s[n], 0.0, 0.0)
        frame[n, 0] = x
        frame[n, 1] = y
        frame[n, 2] = tx
        frame[n, 3] = ty
