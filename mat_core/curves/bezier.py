"""Control points of pieces: of a fitted polynomial, of the chord that stands for it at the last, and with a degree raised."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.way import I_X, ROWS, Scratch
from mat_core.kernels.jit import inner

Floats = NDArray[np.float64]

# H in the Bernstein form of degree n: coefficient j is the sum over i of RAISED[n, j, i] H_i. Coefficient i of g, whose degree is
# n - 4, becomes coefficient i + 2 of tau^2 (1 - tau)^2 g by the factor WEIGHED[n, i]
RAISED = np.array([[[math.comb(3, i) * math.comb(n - 3, j - i) / math.comb(n, j) if 0 <= j - i <= n - 3 else 0.0
                     for i in range(4)] for j in range(ROWS)] for n in range(ROWS)])  # fmt: skip
WEIGHED = np.array([[math.comb(n - 4, i) / math.comb(n, i + 2) if 0 <= i <= n - 4 else 0.0 for i in range(ROWS)]
                    for n in range(ROWS)])  # fmt: skip

LOST = 1e-9  # largest error, other than the tolerance, at which cutting may end; more is a jump, not rounding


@inner
def write_fit(scratch: Scratch, m: int, out: Floats, row: int) -> None:
    """Bezier control points of degree m + 3: H raised in degree, plus tau^2 (1 - tau)^2 g in Bernstein form."""
    newton = scratch.newton
    work = scratch.bernstein
    n = m + 3
    for j in range(n + 1):
        for c in range(3):
            value = 0.0
            for i in range(4):
                value += scratch.hermite[i, c] * RAISED[n, j, i]
            out[row + j, c] = value
        out[row + j, 3] = 1.0
    for c in range(3):
        # Horner: g <- g (tau - tau_i) + coefficient, each time one degree higher
        work[0] = newton[m - 1, c]
        for i in range(m - 2, -1, -1):
            d = m - 2 - i
            root = scratch.samples[i, 0]
            share = 1.0 / (d + 1.0)
            for j in range(d + 1, -1, -1):
                value = 0.0
                if j <= d:
                    value -= (d + 1 - j) * root * work[j]
                if j >= 1:
                    value += j * (1.0 - root) * work[j - 1]
                work[j] = value * share + newton[i, c]
        for i in range(m):
            out[row + i + 2, c] += work[i] * WEIGHED[n, i]


@inner
def straight(scratch: Scratch, row: int, m: int, out: Floats, to: int) -> float:
    """The last resort on a tiny interval: the chord itself; returns its error.

    Its ends are true discs, and no point of it is farther from both than half its length: in the norm that is sqrt(2) times as
    much. It is no less than how far the sample in `row` is off, and than the length where that could be a jump of the axis.
    """
    samples = scratch.samples
    ends = scratch.ends
    off = 0.0
    dd = 0.0
    t = min(max(samples[row, 0], 0.0), 1.0)
    for c in range(3):
        p = ends[0, I_X + c]
        q = ends[1, I_X + c]
        for k in range(m + 4):
            f = k / (m + 3.0)
            out[to + k, c] = (1.0 - f) * p + f * q
            out[to + k, 3] = 1.0
        gap = samples[row, 1 + c] - ((1.0 - t) * p + t * q)
        off += gap * gap
        dd += (q - p) * (q - p)
    return max(math.sqrt(2.0 * off), math.sqrt(dd if dd > LOST * LOST else 0.5 * dd))


@inner
def raise_degree(cp: Floats, row: int, degree: int, wanted: int, out: Floats, to: int) -> None:
    """Write a Bezier with `wanted` + 1 control points, one degree after the other; rows are x, y, r, w (not multiplied)."""
    for j in range(degree + 1):
        w = cp[row + j, 3]
        for c in range(3):
            out[to + j, c] = w * cp[row + j, c] if degree < wanted else cp[row + j, c]
        out[to + j, 3] = w
    for n in range(degree + 1, wanted + 1):
        for c in range(4):
            out[to + n, c] = out[to + n - 1, c]
        for j in range(n - 1, 0, -1):
            share = j / n
            for c in range(4):
                out[to + j, c] = share * out[to + j - 1, c] + (1.0 - share) * out[to + j, c]
    if degree < wanted:
        for j in range(wanted + 1):
            for c in range(3):
                out[to + j, c] /= out[to + j, 3]
