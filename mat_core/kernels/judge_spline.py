"""Points of rational B-splines as the certificate evaluates them: not by the kernel that the axis is evaluated with."""

from __future__ import annotations

from mat_core.kernels.jit import pasted


@pasted
def spline_value(degree, knot_start, knots, cp_start, cp, axes, g, t, work):
    """The point of spline g at t to work[0, :axes], by de Boor's homogeneous triangle.

    Rows of `cp` hold `axes` coordinates (not multiplied by it) and the weight. Assumes clamped, rising knots. `work` has
    (d + 1, axes + 1) or more. Coordinates are taken from the first control point on, so that weights of any size and a
    curve far away cost no digits.
    """
    d = degree[g]
    first = knot_start[g] + d
    span = first
    last = knot_start[g + 1] - d - 2
    while last > span:
        middle = (span + last + 1) // 2
        if knots[middle] <= t:
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
            share = 1.0 / (right - left)
            before = (right - t) * share
            after = (t - left) * share
            for c in range(axes + 1):
                work[i, c] = before * work[i, c] + after * work[i + 1, c]
    for c in range(axes):
        work[0, c] = cp[origin, c] + work[0, c] / work[0, axes]
