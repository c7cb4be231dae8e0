"""Position, tangent and curvature on a site, relative to an origin of the caller's choice.

Why relative: the curvature of a circle through two nearby boundary points divides by their squared distance. The control points
of a site are kept relative to its start, and taken relative to its end where that is the origin: all digits of small differences
stay when the origin is a vertex that both points are near to, and a tiny piece has derivatives as exact as a large one.

A Bezier of degree d is evaluated from three points b0, b1, b2 of its degree d - 2 sub-polygons:
    A = (1-s)^2 b0 + 2 s (1-s) b1 + s^2 b2,   A' = d ((1-s)(b1-b0) + s(b2-b1)),   A'' = d (d-1) (b2 - 2 b1 + b0)
and for a rational one C = A/w,  C' = (A' - C w')/w,  C'' = (A'' - 2 C' w' - C w'')/w.
"""

from __future__ import annotations

import math

from numpy.typing import NDArray

from mat_core.kernels.jit import inner, jit, pasted
from mat_core.kernels.layout import (
    ARC,
    CP0,
    DEG,
    FAN,
    K0,
    K1,
    KIND,
    LINE,
    RATIONAL,
    SKEW,
    SWEEP,
    TX0,
    TX1,
    TY0,
    TY1,
    UA,
    UB,
    X0,
    X0_LOW,
    X1,
    X1_LOW,
    Y0,
    Y0_LOW,
    Y1,
    Y1_LOW,
)

Floats = NDArray  # (n, k) float64
Ints = NDArray  # (n, k) int32


@jit
def bezier_frame(cp, c0, deg, rational, s, ox, oy):
    """Position relative to (ox, oy), first and second derivative of the Bezier in rows c0 .. c0+deg of `cp`; deg >= 2."""
    return pasted_frame(cp, c0, deg, rational, s, ox, oy)


@pasted
def pasted_frame(cp, c0, deg, rational, s, ox, oy):
    """`bezier_frame` where a call would cost as much as what it does."""
    m = deg - 2
    t = 1.0 - s
    b0x = b0y = b0w = b1x = b1y = b1w = b2x = b2y = b2w = 0.0
    low = s <= 0.5 or m < 2
    ratio = 0.0
    c = t
    if m > 1:
        ratio = s / t if low else t / s
        c = t**m if low else s**m
    elif m == 0:
        c = 1.0
    for step in range(m + 1):
        i = c0 + (step if low else m - step)
        w0 = w1 = w2 = c
        if rational:
            w0 = c * cp[i, 2]
            w1 = c * cp[i + 1, 2]
            w2 = c * cp[i + 2, 2]
            b0w += w0
            b1w += w1
            b2w += w2
        b0x += w0 * (cp[i, 0] - ox)
        b0y += w0 * (cp[i, 1] - oy)
        b1x += w1 * (cp[i + 1, 0] - ox)
        b1y += w1 * (cp[i + 1, 1] - oy)
        b2x += w2 * (cp[i + 2, 0] - ox)
        b2y += w2 * (cp[i + 2, 1] - oy)
        if m == 1:
            c = s
        else:
            c *= ratio * (m - step) / (step + 1.0)
    tt = t * t
    ts = 2.0 * t * s
    ss = s * s
    d2 = deg * (deg - 1.0)
    x = tt * b0x + ts * b1x + ss * b2x
    y = tt * b0y + ts * b1y + ss * b2y
    x1 = deg * (t * (b1x - b0x) + s * (b2x - b1x))
    y1 = deg * (t * (b1y - b0y) + s * (b2y - b1y))
    x2 = d2 * (b2x - b1x - (b1x - b0x))
    y2 = d2 * (b2y - b1y - (b1y - b0y))
    if rational:
        w = tt * b0w + ts * b1w + ss * b2w
        wd1 = deg * (t * (b1w - b0w) + s * (b2w - b1w))
        wd2 = d2 * (b2w - b1w - (b1w - b0w))
        x /= w
        y /= w
        x1 = (x1 - x * wd1) / w
        y1 = (y1 - y * wd1) / w
        x2 = (x2 - 2.0 * x1 * wd1 - x * wd2) / w
        y2 = (y2 - 2.0 * y1 * wd1 - y * wd2) / w
    return x, y, x1, y1, x2, y2


@pasted
def site_frame(si, sf, cp, i, s, ox, oy):
    """`bezier_frame` of the Bezier of site i, relative to (ox, oy): from the end that is the origin, else from the nearer one."""
    c0 = si[i, CP0]
    deg = si[i, DEG]
    at_start = ox == sf[i, X0] and oy == sf[i, Y0]
    at_end = ox == sf[i, X1] and oy == sf[i, Y1]
    rx = 0.0
    ry = 0.0
    if at_start if at_start != at_end else s <= 0.5:
        fx = (sf[i, X0] - ox) + sf[i, X0_LOW]
        fy = (sf[i, Y0] - oy) + sf[i, Y0_LOW]
    else:
        rx = cp[c0 + deg, 0]
        ry = cp[c0 + deg, 1]
        fx = (sf[i, X1] - ox) + sf[i, X1_LOW]
        fy = (sf[i, Y1] - oy) + sf[i, Y1_LOW]
    x, y, x1, y1, x2, y2 = pasted_frame(cp, c0, deg, si[i, RATIONAL], s, rx, ry)
    return x + fx, y + fy, x1, y1, x2, y2


@pasted
def evaluate_spiral(si, sf, cp, i, s, ox, oy):
    """`evaluate` of a SPIRAL."""
    x, y, x1, y1, x2, y2 = site_frame(si, sf, cp, i, s, ox, oy)
    speed = math.sqrt(x1 * x1 + y1 * y1)
    if s <= 0.0:
        return x, y, sf[i, TX0], sf[i, TY0], sf[i, K0], speed
    if s >= 1.0:
        return x, y, sf[i, TX1], sf[i, TY1], sf[i, K1], speed
    if speed == 0.0:
        near_start = s < 0.5
        tx = sf[i, TX0] if near_start else sf[i, TX1]
        ty = sf[i, TY0] if near_start else sf[i, TY1]
        return x, y, tx, ty, sf[i, K0] if near_start else sf[i, K1], 0.0
    return x, y, x1 / speed, y1 / speed, (x1 * y2 - y1 * x2) / (speed * speed * speed), speed


@jit
def evaluate(si, sf, cp, i, s, ox, oy):
    """(dx, dy, tx, ty, k, speed) at s on site i.

    Position relative to (ox, oy), unit tangent, curvature (+ left turning), |dC/ds|. A FAN stays at its vertex while the
    tangent turns: k = -inf and speed = |d angle / ds|.
    """
    kind = si[i, KIND]
    if kind == LINE:
        lx = sf[i, X1] - sf[i, X0]
        ly = sf[i, Y1] - sf[i, Y0]
        if s <= 0.5:
            x = ((sf[i, X0] - ox) + sf[i, X0_LOW]) + s * lx
            y = ((sf[i, Y0] - oy) + sf[i, Y0_LOW]) + s * ly
        else:
            x = ((sf[i, X1] - ox) + sf[i, X1_LOW]) - (1.0 - s) * lx
            y = ((sf[i, Y1] - oy) + sf[i, Y1_LOW]) - (1.0 - s) * ly
        return x, y, sf[i, TX0], sf[i, TY0], 0.0, math.sqrt(lx * lx + ly * ly)
    if kind == ARC:
        k = sf[i, K0]
        from_start = s <= 0.5
        angle = s * sf[i, SWEEP] if from_start else (s - 1.0) * sf[i, SWEEP]
        tx = sf[i, TX0] if from_start else sf[i, TX1]
        ty = sf[i, TY0] if from_start else sf[i, TY1]
        x = (sf[i, X0] - ox) + sf[i, X0_LOW] if from_start else (sf[i, X1] - ox) + sf[i, X1_LOW]
        y = (sf[i, Y0] - oy) + sf[i, Y0_LOW] if from_start else (sf[i, Y1] - oy) + sf[i, Y1_LOW]
        sa = math.sin(angle)
        ca = math.cos(angle)
        half = math.sin(0.5 * angle)
        along = sa / k
        across = 2.0 * half * half / k
        return (x + along * tx - across * ty, y + along * ty + across * tx,
                ca * tx - sa * ty, ca * ty + sa * tx, k, abs(sf[i, SWEEP] / k))
    if kind == FAN:
        angle = s * sf[i, SWEEP]
        sa = math.sin(angle)
        ca = math.cos(angle)
        tx = sf[i, TX0]
        ty = sf[i, TY0]
        x = (sf[i, X0] - ox) + sf[i, X0_LOW]
        y = (sf[i, Y0] - oy) + sf[i, Y0_LOW]
        return x, y, ca * tx - sa * ty, ca * ty + sa * tx, -math.inf, abs(sf[i, SWEEP])
    return evaluate_spiral(si, sf, cp, i, s, ox, oy)


@inner
def edge_parameter(si, sf, cp, i, s):
    """The input edge's own parameter u at s on site i; exact for SPIRAL, to rounding (bracketed Newton) for LINE and ARC.

    A LINE or ARC is parametrised by length or angle, its Bezier may not be: the Bezier parameter v is the one where the
    Bezier passes the point, found from f(v) = (C(v) - C(s)) . t(s), which increases through zero there.
    """
    ua = sf[i, UA]
    ub = sf[i, UB]
    kind = si[i, KIND]
    if kind == FAN or s <= 0.0:
        return ua
    if s >= 1.0:
        return ub
    deg = si[i, DEG]
    q = sf[i, SKEW]
    if kind != LINE and kind != ARC or (deg == 1 and si[i, RATIONAL] == 0):
        return ua + s / (s + q * (1.0 - s)) * (ub - ua)
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, i, s, 0.0, 0.0)
    c0 = si[i, CP0]
    if deg == 1:
        w0 = cp[c0, 2]
        w1 = cp[c0 + 1, 2]
        v = s * w0 / (s * w0 + (1.0 - s) * w1)
        return ua + v / (v + q * (1.0 - v)) * (ub - ua)
    lo = 0.0
    hi = 1.0
    v = s
    for _ in range(60):
        x, y, x1, y1, x2, y2 = site_frame(si, sf, cp, i, v, px, py)
        f = x * tx + y * ty
        if f > 0.0:
            hi = v
        else:
            lo = v
        slope = x1 * tx + y1 * ty
        new = v - f / slope if slope > 0.0 else 0.5 * (lo + hi)
        if not lo < new < hi and new != v:
            new = 0.5 * (lo + hi)
        if abs(new - v) <= 1e-16:
            break
        v = new
    return ua + v / (v + q * (1.0 - v)) * (ub - ua)
