"""The circle tangent at a boundary point that touches one site first.

At p with inward unit normal n, the circle tangent at p through q has signed curvature

    phi(q) = 2 n.D / |D|^2,     D = q - p,

so the maximal disc at p has 1/r = sup phi over the boundary. phi = 2 n.I with I = D/|D|^2, the inversion at p, which maps
arcs of monotone curvature to such arcs. Hence on a SPIRAL phi has at most one interior maximum (Vogt: no circle touches such
an arc twice), where W = k|D|^2 + 2 N.D < 0; there the angle

    psi = atan2(n.T', -t.T'),    T' = T|D|^2 - 2 (D.T) D,    dpsi/ds = |C'| W / |D|^2

of the inverted tangent decreases through zero. The signs of dphi at both ends would not bracket it; psi does.

    p = O + dp   point of tangency; O is an end of its site, of both if there is one: small differences stay exact
    t, n         unit tangent and inward normal at p
    q, T, N, k   point, tangent, normal, curvature on the other site, at s in [lo, hi]
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import (
    ARC,
    FAN,
    K0,
    KIND,
    LEN,
    LINE,
    SWEEP,
    TX0,
    TX1,
    TY0,
    TY1,
    V0,
    V1,
    X0,
    X0_LOW,
    X1,
    X1_LOW,
    Y0,
    Y0_LOW,
    Y1,
    Y1_LOW,
)
from mat_core.kernels.spiral import through_point, touch_spiral

CONCENTRIC = 1e-14  # a disc this near to an arc's centre, relative to its radius, touches it anywhere
CANCELLED = 0.1  # below this share left over, a difference has lost a digit


@inner
def _ends(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, nx, ny):
    """The better one of the two ends of [lo, hi]: (phi, s)."""
    x, y, tx, ty, k, speed = evaluate(si, sf, cp, j, lo, ox, oy)
    at_lo = through_point(x - dpx, y - dpy, nx, ny)
    x, y, tx, ty, k, speed = evaluate(si, sf, cp, j, hi, ox, oy)
    at_hi = through_point(x - dpx, y - dpy, nx, ny)
    if at_hi > at_lo:
        return at_hi, hi
    return at_lo, lo


@inner
def touch_fan(sf, j, lo, hi, ox, oy, dpx, dpy, nx, ny):
    """A reflex vertex is a point: phi there, and which of its normals points at the centre (clamped to the range)."""
    dx = ((sf[j, X0] - ox) + sf[j, X0_LOW]) - dpx
    dy = ((sf[j, Y0] - oy) + sf[j, Y0_LOW]) - dpy
    phi = through_point(dx, dy, nx, ny)
    if phi <= 0.0:
        return phi, lo
    cx = nx / phi - dx
    cy = ny / phi - dy
    half = 0.5 * sf[j, SWEEP]
    ch = math.cos(half)
    sh = math.sin(half)
    mx = -(sh * sf[j, TX0] + ch * sf[j, TY0])
    my = ch * sf[j, TX0] - sh * sf[j, TY0]
    s = 0.5 + math.atan2(mx * cy - my * cx, mx * cx + my * cy) / sf[j, SWEEP]
    return phi, min(max(s, lo), hi)


@inner
def _onto_circle(ex, ey, nx, ny, k, r):
    """Radius near r of the disc at e (relative to the centre of a circle of curvature k), normal n, that touches the circle."""
    for _ in range(2):
        cx = ex + r * nx
        cy = ey + r * ny
        distance = math.sqrt(cx * cx + cy * cy)
        inside = k > 0.0
        slope = (cx * nx + cy * ny) / distance + (1.0 if inside else -1.0) if distance > 0.0 else 0.0
        if abs(slope) < 1e-3:
            break
        r -= (distance - (1.0 / k - r if inside else r - 1.0 / k)) / slope
    return r


@inner
def touch_circular(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, nx, ny):
    """LINE and ARC in closed form, about one end (ref, normal m, signed curvature k), g = p - ref:

    r = (2 g.m - k |g|^2) / (2 (k n.g + |n - m|^2 / 2))

    For an arc around a centre o near that of the disc it is nearly 0/0: Newton's method on |g + r n - o| = |1/k - r| follows.
    """
    from_end = sf[j, X1] == ox and sf[j, Y1] == oy
    rx = sf[j, X1] if from_end else sf[j, X0]
    ry = sf[j, Y1] if from_end else sf[j, Y0]
    tx = sf[j, TX1] if from_end else sf[j, TX0]
    ty = sf[j, TY1] if from_end else sf[j, TY0]
    k = sf[j, K0] if si[j, KIND] == ARC else 0.0
    gx = ((ox - rx) - (sf[j, X1_LOW] if from_end else sf[j, X0_LOW])) + dpx
    gy = ((oy - ry) - (sf[j, Y1_LOW] if from_end else sf[j, Y0_LOW])) + dpy
    mx = -ty
    my = tx
    gap = 0.5 * ((nx - mx) * (nx - mx) + (ny - my) * (ny - my))
    num = k * (nx * gx + ny * gy) + gap
    den = 2.0 * (gx * mx + gy * my) - k * (gx * gx + gy * gy)
    if num > 0.0 and den > 0.0:
        r = 0.5 * den / num
        if k != 0.0 and num < CANCELLED * gap:
            r = _onto_circle(gx - mx / k, gy - my / k, nx, ny, k, r)
        cx = gx + r * nx
        cy = gy + r * ny
        if k == 0.0:
            way = (cx * tx + cy * ty) / sf[j, LEN]
        else:
            # direction from the arc's centre o = ref + m/k to c, as an angle from ref's own direction -m sign(k)
            sign = 1.0 if k > 0.0 else -1.0
            ux = (cx - mx / k) * sign
            uy = (cy - my / k) * sign
            way = math.atan2(-(mx * uy - my * ux), -(mx * ux + my * uy)) / sf[j, SWEEP]
            if (ux * ux + uy * uy) * k * k < CONCENTRIC * CONCENTRIC:
                way = 0.5 * (lo + hi) - (1.0 if from_end else 0.0)
        s = (1.0 if from_end else 0.0) + way
        # beyond the end by less than a rounding of s is beyond it all the same: a bend of 1e-18 at a vertex has discs there
        if lo <= s <= hi and not (from_end and way > 0.0):
            return 1.0 / r, s
    return _ends(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, nx, ny)


@inner
def touch(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, nx, ny):
    """(phi, s): sup of phi over [lo, hi] of site j, for the circle tangent at O + dp with inward normal n."""
    kind = si[j, KIND]
    if kind == LINE or kind == ARC:
        return touch_circular(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, nx, ny)
    if kind == FAN:
        return touch_fan(sf, j, lo, hi, ox, oy, dpx, dpy, nx, ny)
    return touch_spiral(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, nx, ny)


@inner
def origin_end(si, i, j, near_start):
    """0 or 1: the end of site i from which differences to site j are taken: a vertex of both, else the one nearer to p.

    Coordinates of two sites that are near each other differ exactly; what is left are short ways along both of them.
    """
    start = si[j, V0] == si[i, V0] or si[j, V1] == si[i, V0]
    end = si[j, V0] == si[i, V1] or si[j, V1] == si[i, V1]
    if start != end:
        return 0 if start else 1
    return 0 if near_start else 1


@inner
def touch_from(si, sf, cp, i, s, j, lo, hi):
    """(phi, s_j) of the circle tangent at s on site i against [lo, hi] of site j."""
    at_start = origin_end(si, i, j, s <= 0.5) == 0
    ox = sf[i, X0] if at_start else sf[i, X1]
    oy = sf[i, Y0] if at_start else sf[i, Y1]
    dpx, dpy, tx, ty, k, speed = evaluate(si, sf, cp, i, s, ox, oy)
    return touch(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, -ty, tx)
