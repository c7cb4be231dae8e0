"""Rational Bezier pieces: cutting a B-spline into them, cutting them smaller.

A control point is a row ``(x, y, w)``: the **Euclidean** point and its weight, not the product. Every affine step
between two rows is taken in the form

    w = (1 - a) w0 + a w1,        P = P0 + b (P1 - P0),        b = a w1 / w,

(Farin, *Curves and Surfaces for CAGD*, 13.2), so coordinates near 1e6 keep their digits whatever the weights are: no
row is ever multiplied by its weight. With positive weights and a in [0, 1] each step is a convex combination, hence
stable.

    p    degree, 1 to 25        t, s    parameter of a piece in [0, 1] and 1 - t        a, b    ends of a knot span

Contract of all kernels here: indices are in range, weights positive, knots clamped and non-decreasing (the model checks
them once); outputs are buffers of the caller; nothing is allocated, nothing raised.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.curve import bezier_frame
from mat_core.kernels.jit import inner, jit

BALANCED = 0.25  # ratio of the last weight of a Bezier to the first down to which (and up to 1 / it) it is left alone

CLOSE = 5  # columns of rows with what is left of their coordinates

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@inner
def blend(rows: Floats, i: int, j: int, k: int, a: float) -> None:
    """Row `k` becomes the point at `a` in [0, 1] between rows `i` and `j`; a = 0 and a = 1 give those rows exactly."""
    w0 = (1.0 - a) * rows[i, 2]
    w1 = a * rows[j, 2]
    w = w0 + w1
    xi = rows[i, 0]
    yi = rows[i, 1]
    xj = rows[j, 0]
    yj = rows[j, 1]
    # From the nearer end, so that the far end is met without a rounding.
    if w1 <= w0:
        b = w1 / w
        rows[k, 0] = xi + b * (xj - xi)
        rows[k, 1] = yi + b * (yj - yi)
    else:
        b = w0 / w
        rows[k, 0] = xj + b * (xi - xj)
        rows[k, 1] = yj + b * (yi - yj)
    rows[k, 2] = w


@inner
def unevenness(cp: Floats, c0: int, deg: int) -> float:
    """The ratio of the largest weight of a Bezier to the smallest: beside the large ones it runs faster by as much."""
    low = high = cp[c0, 2]
    for i in range(1, deg + 1):
        low = min(low, cp[c0 + i, 2])
        high = max(high, cp[c0 + i, 2])
    return float(high / low)


@inner
def add_closely(high: float, low: float, by: float) -> tuple[float, float]:
    """high + low + by as a number in two parts, the first one rounded (Knuth's sum of two)."""
    rounded = high + by
    rest = rounded - high
    low += (high - (rounded - rest)) + (by - rest)
    return rounded + low, low - ((rounded + low) - rounded)


@inner
def blend_closely(rows: Floats, i: int, j: int, k: int, a: float) -> None:
    """`blend` with what is left of x and y beyond their digits in columns 3 and 4."""
    w0 = (1.0 - a) * rows[i, 2]
    w1 = a * rows[j, 2]
    w = w0 + w1
    n = i if w1 <= w0 else j
    o = j if w1 <= w0 else i
    b = min(w0, w1) / w
    # n + b (o - n), to the digits of b (o - n), not of n
    x, x_low = add_closely(rows[n, 0], rows[n, 3], b * ((rows[o, 0] - rows[n, 0]) + (rows[o, 3] - rows[n, 3])))
    y, y_low = add_closely(rows[n, 1], rows[n, 4], b * ((rows[o, 1] - rows[n, 1]) + (rows[o, 4] - rows[n, 4])))
    rows[k, 0] = x
    rows[k, 1] = y
    rows[k, 2] = w
    rows[k, 3] = x_low
    rows[k, 4] = y_low


@jit
def count_beziers(degree: Ints, cp_start: Ints) -> tuple[int, int, int, int, int]:
    """Room for the Beziers of all edges: (Beziers, their control points; most of one edge, most given of one, highest degree)."""
    beziers = points = most_of_edge = longest = highest = 0
    for edge in range(degree.shape[0]):
        d = degree[edge]
        given = cp_start[edge + 1] - cp_start[edge]
        spans = max(given - d, 1)
        beziers += spans
        points += spans * (d + 1)
        most_of_edge = max(most_of_edge, given * (d + 1))
        longest = max(longest, given)
        highest = max(highest, d)
    return beziers, points, most_of_edge, longest, highest


@jit
def decompose(
    degree: int,
    knots: Floats,
    knot0: int,
    nknots: int,
    cp: Floats,
    cp0: int,
    ncp: int,
    out: Floats,
    ubreaks: Floats,
) -> int:
    """Cut one clamped rational B-spline into its Bezier pieces; returns their number S.

    Reads knots[knot0 : knot0 + nknots] and cp[cp0 : cp0 + ncp] (x, y, w). Piece i is written to rows i (degree + 1)
    ... of `out`, its parameter range to ubreaks[i], ubreaks[i + 1]. S <= ncp - degree bounds both buffers. With `CLOSE`
    columns in both, what is left of x and y is carried on: short ways between points keep all their digits.

    For the span [a, b] = [t_k, t_k+1] the p + 1 rows d_k-p .. d_k are the blossom f(t_i+1, .., t_i+p). Two triangles
    of convex steps, in place, replace the knots left of a by a, then those right of b by b. Any inner multiplicity will
    do: at p + 1 neighbouring pieces share no row and may be apart. A Bezier curve comes out bit for bit as it went in.
    """
    p = degree
    spans = 0
    closely = out.shape[1] == CLOSE
    ubreaks[0] = knots[knot0]
    for k in range(p, ncp):
        a = knots[knot0 + k]
        b = knots[knot0 + k + 1]
        if not a < b:
            continue
        base = spans * (p + 1)
        for i in range(p + 1):
            for column in range(out.shape[1]):
                out[base + i, column] = cp[cp0 + k - p + i, column]
        for r in range(1, p + 1):
            for q in range(p - r + 1):
                lo = knots[knot0 + k - p + q + r]
                hi = knots[knot0 + k + q + 1]
                if closely:
                    blend_closely(out, base + q, base + q + 1, base + q, (a - lo) / (hi - lo))
                else:
                    blend(out, base + q, base + q + 1, base + q, (a - lo) / (hi - lo))
        for r in range(1, p + 1):
            for i in range(p, r - 1, -1):
                hi = knots[knot0 + k + i - r + 1]
                if closely:
                    blend_closely(out, base + i - 1, base + i, base + i, (b - a) / (hi - a))
                else:
                    blend(out, base + i - 1, base + i, base + i, (b - a) / (hi - a))
        # Neighbours share their joint exactly unless a knot of multiplicity p + 1 lets them part.
        if spans > 0 and knots[knot0 + k - p] < a:
            for column in range(out.shape[1]):
                if column != 2:
                    out[base, column] = out[base - 1, column]
        spans += 1
        ubreaks[spans] = b
    return spans


@jit
def restrict(cp: Floats, c0: int, degree: int, t0: float, t1: float, out: Floats, o0: int) -> None:
    """Rows of the piece over [t0, t1] in [0, 1], t0 < t1, from row `o0` of `out` on, by two de Casteljau triangles."""
    for i in range(degree + 1):
        out[o0 + i, 0] = cp[c0 + i, 0]
        out[o0 + i, 1] = cp[c0 + i, 1]
        out[o0 + i, 2] = cp[c0 + i, 2]
    if t1 < 1.0:
        for r in range(1, degree + 1):
            for i in range(degree, r - 1, -1):
                blend(out, o0 + i - 1, o0 + i, o0 + i, t1)
    if t0 > 0.0:
        a = t0 / t1
        for r in range(1, degree + 1):
            for i in range(degree - r + 1):
                blend(out, o0 + i, o0 + i + 1, o0 + i, a)


@inner
def balance(rows: Floats, c0: int, degree: int) -> float:
    """Let the last weight of a Bezier be its first again, where they differ much; returns the skew c.

    Weights w_i c^i belong to the same curve with another parameter, t = c s / (c s + 1 - s). Where the last weight is far from
    the first, nearly all of the curve would else lie at one end of the parameter.
    """
    ratio = rows[c0 + degree, 2] / rows[c0, 2]
    if BALANCED <= ratio <= 1.0 / BALANCED:
        return 1.0
    skew = float(ratio ** (-1.0 / degree))
    factor = 1.0
    for i in range(1, degree + 1):
        factor *= skew
        rows[c0 + i, 2] *= factor
    return skew


def derivatives(
    cp: Floats, c0: int, degree: int, t: float, ox: float, oy: float
) -> tuple[float, float, float, float, float, float]:
    """Position relative to (ox, oy), first and second derivative by t; degree >= 2. Interpreted, for typed callers."""
    x, y, x1, y1, x2, y2 = bezier_frame(cp, c0, degree, degree, t, ox, oy)
    return x, y, x1, y1, x2, y2


def point(cp: Floats, c0: int, degree: int, t: float) -> tuple[float, float]:
    """The point at t in [0, 1]. Interpreted: for the few places that are told to people."""
    start = c0 if t <= 0.5 else c0 + degree
    ox, oy = cp[start, :2].tolist()
    if degree == 1:
        share = t * cp[c0 + 1, 2] / ((1.0 - t) * cp[c0, 2] + t * cp[c0 + 1, 2]) - (start - c0)
        dx, dy = (cp[c0 + 1, :2] - cp[c0, :2]).tolist()
        return ox + float(share) * dx, oy + float(share) * dy
    x, y, *_ = derivatives(cp, c0, degree, t, ox, oy)
    return ox + x, oy + y
