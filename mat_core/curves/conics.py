r"""The axis between two lines, circular arcs or points: one exact rational quadratic in (x, y, r).

A disc X = (c, r) touches a side when it lies on the side's quadric in the space of discs. Write <u, v> = ux vx + uy
vy - ur vr, take any point p of the side with its inward normal n and curvature k, and G = (c - p, r):

    Q(X) = kappa <G, G> - 2 sigma <G, nu> = 0,    nu = (n, 1),    kappa : sigma = k : 1

(line k = 0: the plane r = n.(c - p); point k = infinite: the cone |c - p| = r; both limits are met without a large
number). Two such quadrics share their quadratic part, so the curve in both lies in a plane with normal

    N = kappa1 kappa2 (p2 - p1, 0) - kappa2 sigma1 nu1 + kappa1 sigma2 nu2,    <e, N> = 0 for e in the plane,

and is a conic. With its ends P0, P2, middle M and half chord d, the end tangents meet in V = M + e and the middle
weight is w:

    <e, d> = 0,    <e, N> = 0,    <e, B> = kappa <d, d>,    B = kappa (M - p) - sigma nu,
    w^2 = <d, d> / (<d, d> + <e, e>)

Where a conic bends sharply near one end (w > SHARP: discs that leave a narrow neck), d nearly is a ruling of the cone and
<d, d> cancels. There V is put right as the pole of the chord, by Newton steps on three of its polar planes

    Q(P0, V; 1) = Q(P0, V; 2) = Q(P2, V) = 0,    w^2 = -Q(P0, P2) / 2 Q(V, V),
    Q(X, Y) = kappa <GX, GY> - sigma <GX + GY, nu>        measured from p, the apex of a point's cone: nothing cancels

      V        e is of second order in d, so nothing cancels for short curves. The tangent turns by the mean of the
     /|\       turning of both normals, which is known beforehand: curves that turn by more than MAX_TURN are split,
    / e \      and the tangents are never parallel.
   P0-M--P2    Farin, Curves and Surfaces for CAGD, chapter 12 (conics in standard form).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.jit import inner
from mat_core.kernels.layout import ARC, FAN, K0, KIND, LINE, SPIRAL, SWEEP, TX0, TY0, X0, Y0, SiteInts

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

KINDS = ("line", "parabola", "hyperbola", "ellipse", "freeform")
K_LINE, K_PARABOLA, K_HYPERBOLA, K_ELLIPSE, K_FREEFORM = range(5)

MAX_TURN = 1.75  # radians (100 degrees) a single quadratic may turn by: keeps its weights above 0.6 for circles
SAME_RADIUS = 1e-12  # two radii nearer than this, relative, give a straight bisector: its bulge would be as small
EXACT = 1e-13  # an error this small is rounding
SHARP = 8.0  # middle weight from which a conic is seen as bent at one place: V is put right
RULING = 1e-6  # <d, d> relative to d below which the chord nearly is a ruling: likewise
CHECKS = 9  # places where the error is measured; Q along the curve is t^2 (1 - t)^2 times a constant, but for rounding
FLAT_APEX = 1e-3  # least slope dQ/dr used to turn a residual into a length; only matters at the apex of a cone


@inner
def side_quadric(si: SiteInts, sf: Floats, i: int) -> tuple[float, float, float, float, float, float]:
    """(px, py, nx, ny, kappa, sigma) of a LINE, ARC or FAN."""
    px = sf[i, X0]
    py = sf[i, Y0]
    nx = -sf[i, TY0]
    ny = sf[i, TX0]
    kind = si[i, KIND]
    if kind == LINE:
        return px, py, nx, ny, 0.0, 1.0
    if kind == FAN:
        return px, py, nx, ny, 1.0, 0.0
    k = sf[i, K0]
    if abs(k) > 1.0:
        return px, py, nx, ny, 1.0 if k > 0.0 else -1.0, 1.0 / abs(k)
    return px, py, nx, ny, k, 1.0


@inner
def swing(si: SiteInts, sf: Floats, i: int) -> float:
    """How far the normal turns along a whole LINE, ARC or FAN, left positive."""
    if si[i, KIND] == LINE:
        return 0.0
    return float(sf[i, SWEEP])


@inner
def is_conic(si: SiteInts, a: int, b: int) -> bool:
    """Whether the axis between two sites has a closed form."""
    return bool(si[a, KIND] != SPIRAL and si[b, KIND] != SPIRAL)


@inner
def conic_kind(si: SiteInts, sf: Floats, a: int, b: int) -> int:
    """What the centres run on, from the sides: focal radii of constant sum (ellipse) or difference (hyperbola)."""
    if si[a, KIND] == LINE and si[b, KIND] == LINE:
        return K_LINE
    if si[a, KIND] == LINE or si[b, KIND] == LINE:
        return K_PARABOLA
    ka = sf[a, K0] if si[a, KIND] == ARC else -math.inf
    kb = sf[b, K0] if si[b, KIND] == ARC else -math.inf
    if (ka > 0.0) != (kb > 0.0):
        return K_ELLIPSE
    ra = 1.0 / ka
    rb = 1.0 / kb
    if abs(ra - rb) <= SAME_RADIUS * max(1.0, abs(ra)):
        return K_LINE
    return K_HYPERBOLA


@inner
def _residual(
    px: float, py: float, nx: float, ny: float, kappa: float, sigma: float, x: float, y: float, r: float
) -> float:
    """How far the disc (x, y, r) is from touching a side."""
    gx = x - px
    gy = y - py
    if abs(kappa) == 1.0:
        # a point, or an arc about p + n sigma / kappa, which the disc touches from inside when kappa > 0
        gx -= nx * sigma * kappa
        gy -= ny * sigma * kappa
        wanted = sigma - r if kappa > 0.0 and sigma > 0.0 else r - sigma * kappa
        return abs(math.sqrt(gx * gx + gy * gy) - wanted)
    q = kappa * (gx * gx + gy * gy - r * r) - 2.0 * sigma * (gx * nx + gy * ny - r)
    return abs(q) / max(2.0 * abs(sigma - kappa * r), FLAT_APEX)


@inner
def _polar(
    px: float, py: float, nx: float, ny: float, kappa: float, sigma: float, x: float, y: float, r: float
) -> tuple[float, float, float, float]:
    """Q(X, .) of a side as (a, b, c, d): Q(X, Y) = a yx + b yy + c yr + d for Y relative to (p, 0)."""
    gx = x - px
    gy = y - py
    return kappa * gx - sigma * nx, kappa * gy - sigma * ny, sigma - kappa * r, -sigma * (gx * nx + gy * ny - r)


@inner
def _sharpen(
    si: SiteInts, sf: Floats, a: int, b: int, p0: Floats, p2: Floats, x: float, y: float, r: float
) -> tuple[float, float, float, float]:
    """V = (x, y, r) put right as the pole of the chord, and the middle weight; 0 when there is none."""
    px, py, nx, ny, kappa, sigma = side_quadric(si, sf, a)
    qx, qy, ox, oy, lam, tau = side_quadric(si, sf, b)
    a0, b0, c0, d0 = _polar(px, py, nx, ny, kappa, sigma, p0[0], p0[1], p0[2])
    a1, b1, c1, d1 = _polar(qx, qy, ox, oy, lam, tau, p0[0], p0[1], p0[2])
    # the third plane through the side that bends: that of a line is the same everywhere
    first = abs(kappa) >= abs(lam)
    ux = px if first else qx
    uy = py if first else qy
    mx = nx if first else ox
    my = ny if first else oy
    rho = kappa if first else lam
    ups = sigma if first else tau
    a2, b2, c2, d2 = _polar(ux, uy, mx, my, rho, ups, p2[0], p2[1], p2[2])
    f0 = a0 * (x - px) + b0 * (y - py) + c0 * r + d0
    f1 = a1 * (x - qx) + b1 * (y - qy) + c1 * r + d1
    f2 = a2 * (x - ux) + b2 * (y - uy) + c2 * r + d2
    det = a0 * (b1 * c2 - b2 * c1) - b0 * (a1 * c2 - a2 * c1) + c0 * (a1 * b2 - a2 * b1)
    if det == 0.0:
        return x, y, r, 0.0
    x -= (f0 * (b1 * c2 - b2 * c1) - b0 * (f1 * c2 - f2 * c1) + c0 * (f1 * b2 - f2 * b1)) / det
    y -= (a0 * (f1 * c2 - f2 * c1) - f0 * (a1 * c2 - a2 * c1) + c0 * (a1 * f2 - a2 * f1)) / det
    r -= (a0 * (b1 * f2 - b2 * f1) - b0 * (a1 * f2 - a2 * f1) + f0 * (a1 * b2 - a2 * b1)) / det
    chord = a2 * (p0[0] - ux) + b2 * (p0[1] - uy) + c2 * p0[2] + d2
    av, bv, cv, dv = _polar(ux, uy, mx, my, rho, ups, x, y, r)
    own = av * (x - ux) + bv * (y - uy) + cv * r + dv
    ratio = -0.5 * chord / own if own != 0.0 else 0.0
    return x, y, r, math.sqrt(ratio) if ratio > 0.0 else 0.0


@inner
def _middle(
    si: SiteInts, sf: Floats, a: int, b: int, p0: Floats, p2: Floats
) -> tuple[float, float, float, float, float]:
    """(e, w, <d, d>) of the quadratic from disc p0 to disc p2 between sites a and b; e = 0 and w = 1 where there is none."""
    px, py, nx, ny, kappa, sigma = side_quadric(si, sf, a)
    qx, qy, ox, oy, lam, tau = side_quadric(si, sf, b)
    mx = 0.5 * (p0[0] + p2[0])
    my = 0.5 * (p0[1] + p2[1])
    mr = 0.5 * (p0[2] + p2[2])
    dx = 0.5 * (p2[0] - p0[0])
    dy = 0.5 * (p2[1] - p0[1])
    dr = 0.5 * (p2[2] - p0[2])
    # e = f kappa <d, d> / <f, B> with f orthogonal to d and N; vectors in the form for the Euclidean product
    ux = kappa * lam * (qx - px) - lam * sigma * nx + kappa * tau * ox
    uy = kappa * lam * (qy - py) - lam * sigma * ny + kappa * tau * oy
    ur = lam * sigma - kappa * tau
    fx = uy * -dr - ur * dy
    fy = ur * dx - ux * -dr
    fr = ux * dy - uy * dx
    dd = dx * dx + dy * dy - dr * dr
    ax = kappa * (mx - px) - sigma * nx
    ay = kappa * (my - py) - sigma * ny
    ar = sigma - kappa * mr
    bx = lam * (mx - qx) - tau * ox
    by = lam * (my - qy) - tau * oy
    br = tau - lam * mr
    fa = fx * ax + fy * ay + fr * ar
    fb = fx * bx + fy * by + fr * br
    scale_a = (ax * ax + ay * ay + ar * ar) * fb * fb
    scale_b = (bx * bx + by * by + br * br) * fa * fa
    factor = 0.0
    if kappa != 0.0 and fa != 0.0 and (lam == 0.0 or scale_b >= scale_a):
        factor = kappa * dd / fa
    elif fb != 0.0:
        factor = lam * dd / fb
    ex = factor * fx
    ey = factor * fy
    er = factor * fr
    ee = ex * ex + ey * ey - er * er
    if dd > 0.0 and dd + ee > 0.0:
        return ex, ey, er, math.sqrt(dd / (dd + ee)), dd
    return 0.0, 0.0, 0.0, 1.0, dd


@inner
def _measured(
    si: SiteInts, sf: Floats, a: int, b: int, p0: Floats, p2: Floats, ex: float, ey: float, er: float, weight: float
) -> float:
    """How far the quadratic with the middle control point M + e is from touching either site, at most, where it is looked at."""
    px, py, nx, ny, kappa, sigma = side_quadric(si, sf, a)
    qx, qy, ox, oy, lam, tau = side_quadric(si, sf, b)
    error = 0.0
    for m in range(CHECKS):
        # a weight above 1 crowds the curve's ends at the ends of t
        t = (m + 0.5) / CHECKS
        if t < 0.5:
            t = t / (t + weight * (1.0 - t))
        elif t > 0.5:
            t = weight * t / (weight * t + 1.0 - t)
        u = (1.0 - t) * (1.0 - t)
        v = 2.0 * t * (1.0 - t) * weight
        total = u + v + t * t
        along = 0.5 * (t * t - u)
        x = 0.5 * (p0[0] + p2[0]) + (v * ex + along * (p2[0] - p0[0])) / total
        y = 0.5 * (p0[1] + p2[1]) + (v * ey + along * (p2[1] - p0[1])) / total
        r = 0.5 * (p0[2] + p2[2]) + (v * er + along * (p2[2] - p0[2])) / total
        error = max(error, _residual(px, py, nx, ny, kappa, sigma, x, y, r))
        error = max(error, _residual(qx, qy, ox, oy, lam, tau, x, y, r))
    # a disc larger than an arc does not touch it from inside: such a curve runs through the arc's centre and back
    beyond = 0.5 * (p0[2] + p2[2]) + er
    if kappa > 0.0 and beyond > sigma / kappa > 0.0 or lam > 0.0 and beyond > tau / lam > 0.0:
        error = max(error, beyond)
    return error


@inner
def conic(si: SiteInts, sf: Floats, a: int, b: int, p0: Floats, p2: Floats, cp: Floats, row: int) -> float:
    """Write the quadratic from disc p0 to disc p2 to rows row .. row + 2 of `cp` (x, y, r, w); its measured error.

    Assumes, does not check: not both sides are lines, and the curve turns by less than MAX_TURN.
    """
    ex, ey, er, w, dd = _middle(si, sf, a, b, p0, p2)
    long = 0.0
    for m in range(3):
        cp[row, m] = p0[m]
        cp[row + 2, m] = p2[m]
        long += 0.25 * (p2[m] - p0[m]) * (p2[m] - p0[m])
    cp[row, 3] = 1.0
    cp[row + 2, 3] = 1.0
    best = math.inf
    for attempt in range(3):
        # discs that all touch nearly one point lie nearly on a line, and e is nearly 0/0: so the line itself is tried first
        bulge = 0.0 if attempt == 0 else 1.0
        weight = w if attempt > 0 else 1.0
        if attempt == 2:
            if not (w > SHARP or dd <= RULING * long):
                break
            vx = 0.5 * (p0[0] + p2[0]) + ex
            vy = 0.5 * (p0[1] + p2[1]) + ey
            vr = 0.5 * (p0[2] + p2[2]) + er
            for _ in range(2):
                vx, vy, vr, weight = _sharpen(si, sf, a, b, p0, p2, vx, vy, vr)
            if not weight > 0.0:
                break
            ex = vx - 0.5 * (p0[0] + p2[0])
            ey = vy - 0.5 * (p0[1] + p2[1])
            er = vr - 0.5 * (p0[2] + p2[2])
        error = _measured(si, sf, a, b, p0, p2, bulge * ex, bulge * ey, bulge * er, weight)
        if error < best:
            best = error
            cp[row + 1, 0] = 0.5 * (p0[0] + p2[0]) + bulge * ex
            cp[row + 1, 1] = 0.5 * (p0[1] + p2[1]) + bulge * ey
            cp[row + 1, 2] = 0.5 * (p0[2] + p2[2]) + bulge * er
            cp[row + 1, 3] = weight
        if best <= EXACT:
            break
    return best
