r"""One polynomial over one interval of the axis.

An interval runs from disc P to disc Q in the space of (x, y, r). Its parameter is the share of the way along the chord,

    tau(X) = (X - P).(Q - P) / |Q - P|^2,

in which the axis is a regular, smooth curve everywhere: also at a centre of curvature, where both footpoints run into
each other and every boundary parameter u gives tau ~ (u - u*)^2, and where a Bezier's own speed is zero. The true
axis is sampled through a footpoint s on one side; each sample brings its own tau, so no equation tau(s) = const has
to be solved.

    F(tau) = H(tau) + tau^2 (1 - tau)^2 g(tau)         H: cubic with the exact discs and exact tangents at both ends
                                                       g: through samples at m nodes; degree of F: m + 3
    tangent at a disc with normals n1 (right), n2 (left): t = (n1 - n2) turned by -90 degrees, dr = t.n1; at a centre of
    curvature (n, 1): the disc moves straight away from its only contact. Tangents know nothing of curvature, so pieces
    join with one tangent.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.way import I_TX, I_X, Scratch
from mat_core.kernels.jit import inner

Floats = NDArray[np.float64]

MIN_COSINE = 0.4  # of the angle between an end tangent and the chord; a piece that turns more is halved


@inner
def hermite_of(ends: Floats, out: Floats) -> bool:
    """Bernstein coefficients (4, 3) of the cubic H over tau; False when an end tangent leans away from the chord."""
    ux = ends[1, I_X] - ends[0, I_X]
    uy = ends[1, I_X + 1] - ends[0, I_X + 1]
    ur = ends[1, I_X + 2] - ends[0, I_X + 2]
    dd = ux * ux + uy * uy + ur * ur
    d = math.sqrt(dd)
    good = True
    for end in range(2):
        tx = ends[end, I_TX]
        ty = ends[end, I_TX + 1]
        tr = ends[end, I_TX + 2]
        lean = tx * ux + ty * uy + tr * ur
        size = math.sqrt(tx * tx + ty * ty + tr * tr)
        factor = dd / lean / 3.0 if lean > 0.0 else 0.0
        if not lean >= MIN_COSINE * size * d or size == 0.0:
            good = False
        sign = 1.0 if end == 0 else -1.0
        for m in range(3):
            p = ends[end, I_X + m]
            out[3 * end, m] = p
            out[1 + end, m] = p + sign * factor * ends[end, I_TX + m]
    return good


@inner
def _cubic(hermite: Floats, t: float, c: int) -> float:
    """Component c of H at t."""
    s = 1.0 - t
    return s * s * (s * hermite[0, c] + 3.0 * t * hermite[1, c]) + t * t * (3.0 * s * hermite[2, c] + t * hermite[3, c])


@inner
def cubic_miss(scratch: Scratch, row: int) -> float:
    """Norm of H - X at the sample in one row."""
    samples = scratch.samples
    x = _cubic(scratch.hermite, samples[row, 0], 0) - samples[row, 1]
    y = _cubic(scratch.hermite, samples[row, 0], 1) - samples[row, 2]
    return math.sqrt(x * x + y * y) + abs(_cubic(scratch.hermite, samples[row, 0], 2) - samples[row, 3])


@inner
def interpolate(scratch: Scratch, m: int) -> None:
    """Newton coefficients (m, 3) of g through the nodes."""
    samples = scratch.samples
    newton = scratch.newton
    for i in range(m):
        t = samples[i, 0]
        share = 1.0 / (t * t * (1.0 - t) * (1.0 - t))
        for c in range(3):
            newton[i, c] = (samples[i, 1 + c] - _cubic(scratch.hermite, t, c)) * share
    divide(samples, newton, 0, m)


@inner
def divide(samples: Floats, values: Floats, first: int, n: int) -> None:
    """Divided differences in place: values (n, 3) at the abscissae of the samples from row `first` on."""
    for level in range(1, n):
        for i in range(n - 1, level - 1, -1):
            share = 1.0 / (samples[first + i, 0] - samples[first + i - level, 0])
            for c in range(3):
                values[i, c] = (values[i, c] - values[i - 1, c]) * share


@inner
def miss(scratch: Scratch, row: int, m: int, k: int) -> float:
    """Norm of F - X at the sample in one row; the vector goes to row k of `misses`."""
    samples = scratch.samples
    newton = scratch.newton
    out = scratch.misses
    t = samples[row, 0]
    weight = t * t * (1.0 - t) * (1.0 - t)
    for c in range(3):
        g = newton[m - 1, c]
        for i in range(m - 2, -1, -1):
            g = g * (t - samples[i, 0]) + newton[i, c]
        out[k, c] = _cubic(scratch.hermite, t, c) + weight * g - samples[row, 1 + c]
    return math.sqrt(out[k, 0] * out[k, 0] + out[k, 1] * out[k, 1]) + abs(out[k, 2])


@inner
def weight_of(samples: Floats, m: int, t: float) -> float:
    """W at t."""
    w = t * t * (1.0 - t) * (1.0 - t)
    for i in range(m):
        w *= t - samples[i, 0]
    return w
