"""Control points of pieces: of a fitted polynomial, of the chord that stands for it at the last, and with a degree raised."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.way import I_X, Scratch
from mat_core.kernels.jit import inner

Floats = NDArray[np.float64]

LOST = 1e-9  # largest error, other than the tolerance, at which cutting may end; more is a jump, not rounding


@inner
def _binomial(n: int, k: int) -> float:
    """The binomial coefficient n over k; 0 outside the triangle."""
    if k < 0 or k > n:
        return 0.0
    c = 1.0
    for i in range(k):
        c = c * (n - i) / (i + 1.0)
    return c


@inner
def write_fit(scratch: Scratch, m: int, out: Floats, row: int) -> None:
    """Bezier control points of degree m + 3: H raised in degree, plus tau^2 (1 - tau)^2 g in Bernstein form."""
    newton = scratch.newton
    work = scratch.bernstein
    n = m + 3
    for j in range(n + 1):
        total = _binomial(n, j)
        for c in range(3):
            value = 0.0
            for i in range(4):
                value += scratch.hermite[i, c] * _binomial(3, i) * _binomial(n - 3, j - i) / total
            out[row + j, c] = value
        out[row + j, 3] = 1.0
    for c in range(3):
        # Horner: g <- g (tau - tau_i) + coefficient, each time one degree higher
        work[0] = newton[m - 1, c]
        for i in range(m - 2, -1, -1):
            d = m - 2 - i
            root = scratch.samples[i, 0]
            for j in range(d + 1, -1, -1):
                value = 0.0
                if j <= d:
                    value -= (d + 1 - j) * root * work[j]
                if j >= 1:
                    value += j * (1.0 - root) * work[j - 1]
                work[j] = value / (d + 1.0) + newton[i, c]
        for i in range(m):
            out[row + i + 2, c] += work[i] * _binomial(m - 1, i) / _binomial(n, i + 2)


@inner
def straight(scratch: Scratch, row: int, m: int, out: Floats, to: int) -> float:
    """The last resort on a tiny interval: the chord itself; returns its error.

    That is how far the sample in `row` is from it, and its length where that could be a jump of the axis.
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
    return max(math.sqrt(2.0 * off), math.sqrt(dd) if dd > LOST * LOST else 0.0)


@inner
def raise_degree(cp: Floats, row: int, degree: int, wanted: int, out: Floats, to: int) -> None:
    """Write a Bezier with `wanted` + 1 control points; rows are x, y, r, w (not multiplied)."""
    for j in range(wanted + 1):
        total = 1.0
        for i in range(j):
            total = total * (wanted - i) / (i + 1.0)
        x = y = r = w = 0.0
        for i in range(degree + 1):
            # binomial(degree, i) binomial(wanted - degree, j - i) / binomial(wanted, j)
            k = j - i
            if k < 0 or k > wanted - degree:
                continue
            share = 1.0 / total
            for m in range(i):
                share = share * (degree - m) / (m + 1.0)
            for m in range(k):
                share = share * (wanted - degree - m) / (m + 1.0)
            share *= cp[row + i, 3]
            x += share * cp[row + i, 0]
            y += share * cp[row + i, 1]
            r += share * cp[row + i, 2]
            w += share
        place = to + j
        out[place, 0] = x / w
        out[place, 1] = y / w
        out[place, 2] = r / w
        out[place, 3] = w
