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

from mat_core.kernels.curve import evaluate, evaluate_spiral, site_frame
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

NEWTON_STEPS = 60
CAP_STEPS = 48  # halvings of a piece until the turn of D is clear
CONCENTRIC = 1e-14  # a disc this near to an arc's centre, relative to its radius, touches it anywhere
FLAT = 1e-12  # relative difference of two values of phi that does not make an end of a site better than its inside
SMALL = 0.5  # tan(psi) below which a few terms tell psi
CANCELLED = 0.1  # below this share left over, a difference has lost a digit


@inner
def through_point(dx, dy, nx, ny):
    """phi of the point at D; minus infinity for the point of tangency itself."""
    dd = dx * dx + dy * dy
    if dd == 0.0:
        return -math.inf
    return 2.0 * (nx * dx + ny * dy) / dd


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
        base = 1.0 if from_end else 0.0
        if k == 0.0:
            s = base + (cx * tx + cy * ty) / sf[j, LEN]
        else:
            # direction from the arc's centre o = ref + m/k to c, as an angle from ref's own direction -m sign(k)
            sign = 1.0 if k > 0.0 else -1.0
            ux = (cx - mx / k) * sign
            uy = (cy - my / k) * sign
            s = base + math.atan2(-(mx * uy - my * ux), -(mx * ux + my * uy)) / sf[j, SWEEP]
            if (ux * ux + uy * uy) * k * k < CONCENTRIC * CONCENTRIC:
                s = 0.5 * (lo + hi)
        if lo <= s <= hi:
            return 1.0 / r, s
    return _ends(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, nx, ny)


@inner
def _turning(dx, dy, tx, ty, k):
    """(W, |D|^2) at one point of the other site; W = 0 for D = 0."""
    dd = dx * dx + dy * dy
    if dd == 0.0:
        return 0.0, 0.0
    return k * dd + 2.0 * (dy * tx - dx * ty), dd


@inner
def _angle(dx, dy, tx, ty, nx, ny):
    """psi at one point of the other site; its limit (T' = -T) for D = 0."""
    dd = dx * dx + dy * dy
    if dd == 0.0:
        return math.atan2(-(nx * tx + ny * ty), ny * tx - nx * ty)
    along = 2.0 * (dx * tx + dy * ty)
    ix = tx * dd - along * dx
    iy = ty * dd - along * dy
    # t = (ny, -nx)
    return math.atan2(nx * ix + ny * iy, nx * iy - ny * ix)


@inner
def small_angle(q):
    """atan(q), for a small q to as many digits as the steps of Newton's method need, and exactly zero where q is."""
    qq = q * q
    return q * (1.0 - qq * (1.0 / 3.0 - qq * (0.2 - qq / 7.0))) if qq < SMALL * SMALL else math.atan(q)


@inner
def _turned(ax, ay, bx, by):
    """Angle from direction a to direction b, in (-pi, pi]."""
    return math.atan2(ax * by - ay * bx, ax * bx + ay * by)


@inner
def _fallen(si, sf, cp, j, ox, oy, dpx, dpy, a, ax, ay, tax, tay, b, bx, by, tbx, tby):
    """How much psi changes from a to b on a piece that turns by less than half a turn, whole turns counted.

    angle(T') = 2 angle(D) - angle(T) + pi, and psi falls as T' turns left: change = turn of T - 2 (turn of D). That of D is less
    than half a turn unless p lies inside the cap between the piece and its chord. It may do so where D turns the other way than
    it sets out and arrives: then halves are looked at, of which one is clear, until all are.
    """
    total = _turned(tax, tay, tbx, tby)
    for _ in range(CAP_STEPS):
        seen = _turned(ax, ay, bx, by)
        sense = ax * tay - ay * tax
        if sense * (bx * tby - by * tbx) <= 0.0 or seen * sense >= 0.0:
            break
        m = 0.5 * (a + b)
        x, y, tx, ty, k, speed = evaluate_spiral(si, sf, cp, j, m, ox, oy)
        x -= dpx
        y -= dpy
        if not a < m < b or x == 0.0 and y == 0.0:
            break
        first = _turned(ax, ay, x, y)
        if sense * (x * ty - y * tx) <= 0.0 or first * sense >= 0.0:
            total -= 2.0 * first
            a = m
            ax = x
            ay = y
            tax = tx
            tay = ty
        else:
            total -= 2.0 * _turned(x, y, bx, by)
            b = m
            bx = x
            by = y
            tbx = tx
            tby = ty
    return total - 2.0 * _turned(ax, ay, bx, by)


@inner
def touch_spiral(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, nx, ny):
    """Sup of phi over [lo, hi] of a piece of monotone curvature, and where."""
    x, y, tax, tay, k, speed = evaluate_spiral(si, sf, cp, j, lo, ox, oy)
    ax = x - dpx
    ay = y - dpy
    wa, da = _turning(ax, ay, tax, tay, k)
    best = through_point(ax, ay, nx, ny)
    x, y, tx, ty, k, speed = evaluate_spiral(si, sf, cp, j, hi, ox, oy)
    bx = x - dpx
    by = y - dpy
    wb, db = _turning(bx, by, tx, ty, k)
    at_hi = through_point(bx, by, nx, ny)
    s_best = lo
    if at_hi > best:
        best = at_hi
        s_best = hi
    x0 = ax
    y0 = ay
    if da == 0.0:
        wa = wb
        ax = tax
        ay = tay
    if db == 0.0:
        wb = wa
        bx = -tx
        by = -ty
    if not (wa < 0.0 or wb < 0.0) or hi <= lo:
        return best, s_best

    # 1. a bracket [a, b] in which psi falls through a multiple of a full turn, `goal`, where W < 0; psi counted from lo on
    pa = _angle(x0, y0, tax, tay, nx, ny)
    pb = pa + _fallen(si, sf, cp, j, ox, oy, dpx, dpy, lo, ax, ay, tax, tay, hi, bx, by, tx, ty)
    turn = 2.0 * math.pi
    if wa < 0.0:  # psi falls from pa, perhaps rises again later
        goal = 0.0 if pa > 0.0 else -turn
        found = pb <= goal
        if not found and wb < 0.0:
            return best, s_best
    else:  # psi rises first, then falls to pb
        goal = turn * math.ceil(pb / turn)
        found = pa > goal
    a = lo
    b = hi
    above = pa - goal
    below = pb - goal
    for _ in range(60):
        if found and above < 1.5 and below > -1.5:
            break
        m = 0.5 * (a + b)
        if not a < m < b:
            break
        x, y, tx, ty, k, speed = evaluate_spiral(si, sf, cp, j, m, ox, oy)
        dx = x - dpx
        dy = y - dpy
        dd = dx * dx + dy * dy
        value = above + _fallen(si, sf, cp, j, ox, oy, dpx, dpy, a, ax, ay, tax, tay, m, dx, dy, tx, ty)
        if found or (value <= 0.0 if wa < 0.0 else value > 0.0):
            found = True
            forward = value > 0.0
        else:
            forward = (k * dd + 2.0 * (dy * tx - dx * ty) < 0.0) == (wa < 0.0)
        if forward:
            a = m
            above = value
            ax = dx
            ay = dy
            tax = tx
            tay = ty
        else:
            b = m
            below = value
    if not found:
        return best, s_best

    # 2. Newton on psi, kept inside the bracket
    s = 0.5 * (a + b)
    for _ in range(NEWTON_STEPS):
        x, y, x1, y1, x2, y2 = site_frame(si, sf, cp, j, s, ox, oy)
        dx = x - dpx
        dy = y - dpy
        dd = dx * dx + dy * dy
        ss = x1 * x1 + y1 * y1
        if dd == 0.0 or ss == 0.0:
            break
        along = 2.0 * (dx * x1 + dy * y1)
        ix = x1 * dd - along * dx
        iy = y1 * dd - along * dy
        facing = nx * iy - ny * ix
        psi = nx * ix + ny * iy
        psi = small_angle(psi / facing) if abs(psi) < SMALL * facing else math.atan2(psi, facing)
        slope = (x1 * y2 - y1 * x2) / ss + 2.0 * (dy * x1 - dx * y1) / dd
        # where psi rises, the root lies on the other side of it, however small psi is there
        if (psi > 0.0) if slope < 0.0 else wa >= 0.0:
            a = s
        else:
            b = s
        new = s - psi / slope if slope < 0.0 else 0.5 * (a + b)
        if not a < new < b:
            new = 0.5 * (a + b)
        step = abs(new - s)
        s = new
        if step <= 1e-14 or b - a <= 1e-15:
            break
    x, y, x1, y1, x2, y2 = site_frame(si, sf, cp, j, s, ox, oy)
    phi = through_point(x - dpx, y - dpy, nx, ny)
    # an end is the next site's contact as well, and where phi is flat it is not better than rounding makes it
    if phi >= best - FLAT * abs(best):
        return phi, s
    return best, s_best


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
