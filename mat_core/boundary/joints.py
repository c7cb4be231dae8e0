"""Ends of pieces and the joints between them: tangents, one-sided curvatures, corners, cusps.

A joint is smooth, a convex vertex (a leaf of the axis with radius 0) or a reflex vertex (a FAN site is put between the two
pieces). Limits are taken where the speed vanishes at an end: with the first i control points on the end, the Bezier behaves
like x ~ a s^i, y ~ b s^j along and across its limit tangent, so the curvature there is infinite for j < 2i and zero for j > 2i.
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import K0, K1, TX0, TY0, X0, X1, Y0, Y1

BEND = 1e-4  # relative difference of curvatures below which the branches of a cusp are told apart by their heights
CUSP_ANGLE = 1e-7  # a turn nearer than this to a half turn is a cusp, its side is decided by the curves, not by the angle


@inner
def _limit_frame(cp, first, step, deg, i, noise):
    """Limit tangent and curvature when control points first, first+step, ... coincide up to the i-th."""
    x0 = cp[first, 0]
    y0 = cp[first, 1]
    dx = cp[first + i * step, 0] - x0
    dy = cp[first + i * step, 1] - y0
    length = math.sqrt(dx * dx + dy * dy)
    tx = dx / length
    ty = dy / length
    ci = 1.0
    for m in range(i):
        ci = ci * (deg - m) / (m + 1.0)
    cj = ci
    for j in range(i + 1, deg + 1):
        cj = cj * (deg - j + 1.0) / j
        x = cp[first + j * step, 0] - x0
        y = cp[first + j * step, 1] - y0
        across = tx * y - ty * x
        if abs(across) > noise:
            if j < 2 * i:
                return tx, ty, math.inf if across > 0.0 else -math.inf
            if j == 2 * i:
                w0 = cp[first, 2]
                wi = cp[first + i * step, 2]
                wj = cp[first + j * step, 2]
                a = ci * length * wi / w0
                b = cj * across * wj / w0
                return tx, ty, 2.0 * b / (a * a)
            return tx, ty, 0.0
    return tx, ty, 0.0


@inner
def end_frame(cp, c0, deg, at_end, noise):
    """(tx, ty, k): unit tangent in the direction of travel and one-sided curvature at an end of a Bezier of degree >= 2.

    k = (d-1)/d * w0 w2 / w1^2 * (P1-P0) x (P2-P1) / |P1-P0|^3
    """
    first = c0 + deg if at_end else c0
    step = -1 if at_end else 1
    sign = -1.0 if at_end else 1.0
    ax = cp[first + step, 0] - cp[first, 0]
    ay = cp[first + step, 1] - cp[first, 1]
    length = math.sqrt(ax * ax + ay * ay)
    if length > noise:
        bx = cp[first + 2 * step, 0] - cp[first + step, 0]
        by = cp[first + 2 * step, 1] - cp[first + step, 1]
        w1 = cp[first + step, 2]
        k = (deg - 1.0) / deg * cp[first, 2] * cp[first + 2 * step, 2] / (w1 * w1)
        k *= (ax * by - ay * bx) / (length * length * length)
        return sign * ax / length, sign * ay / length, sign * k
    for i in range(2, deg + 1):
        x = cp[first + i * step, 0] - cp[first, 0]
        y = cp[first + i * step, 1] - cp[first, 1]
        if math.sqrt(x * x + y * y) > noise:
            tx, ty, k = _limit_frame(cp, first, step, deg, i, noise)
            return sign * tx, sign * ty, sign * k
    return 1.0, 0.0, 0.0


@inner
def _height_at(si, sf, cp, i, backwards, distance, ex, ey):
    """How far piece i lies to the left of the ray e at this distance along it, walking from its joint."""
    ox = sf[i, X1] if backwards else sf[i, X0]
    oy = sf[i, Y1] if backwards else sf[i, Y0]
    lo = 0.0
    hi = 1.0
    y = 0.0
    for _ in range(60):
        m = 0.5 * (lo + hi)
        dx, dy, tx, ty, k, speed = evaluate(si, sf, cp, i, 1.0 - m if backwards else m, ox, oy)
        y = ex * dy - ey * dx
        if ex * dx + ey * dy < distance:
            lo = m
        else:
            hi = m
    return y


@inner
def _reach(sf, i, ex, ey):
    """Extent of a piece along e, between its ends."""
    return abs((sf[i, X1] - sf[i, X0]) * ex + (sf[i, Y1] - sf[i, Y0]) * ey)


@inner
def cusp_is_convex(si, sf, cp, before, after):
    """Whether the interior is the thin side of the cusp between two pieces (a leaf) or all around it (a fan of half a turn).

    Both branches leave the cusp along e; the interior is left of `after` and, walking backwards, right of `before`: the thin
    side is the interior when `after` runs below `before`.
    """
    ex = sf[after, TX0]
    ey = sf[after, TY0]
    outward = sf[after, K0]
    back = -sf[before, K1]
    if not (math.isinf(outward) or math.isinf(back)) and abs(outward - back) > BEND * (abs(outward) + abs(back)):
        return outward < back
    if math.isinf(outward) and (not math.isinf(back) or outward * back < 0.0):
        return outward < 0.0
    if math.isinf(back) and not math.isinf(outward):
        return back > 0.0
    distance = 0.25 * min(_reach(sf, before, ex, ey), _reach(sf, after, ex, ey))
    above = _height_at(si, sf, cp, before, True, distance, ex, ey)
    below = _height_at(si, sf, cp, after, False, distance, ex, ey)
    return below < above
