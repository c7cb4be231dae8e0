"""Where the circle tangent at a boundary point touches a piece of monotone curvature first; see `mat_core.kernels.disc`."""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate_spiral, site_frame
from mat_core.kernels.jit import inner, pasted

NEWTON_STEPS = 60
CAP_STEPS = 48  # halvings of a piece until the turn of D is clear
FLAT = 1e-12  # relative difference of two values of phi that does not make an end of a site better than its inside
SUMMIT_STEPS = 8  # of Newton's method; from a guess nearby two or three are enough
SETTLED = 1e-8  # a step this short, in s, leaves an error of rounding
CLEAR = 3e-5  # nor may it be longer than this share of the distance from the footpoint, on which psi changes
AMPLE = 2.0  # turns are taken for so much more than they are
SMALL = 0.5  # tan(psi) below which a few terms tell psi


@inner
def through_point(dx, dy, nx, ny):
    """phi of the point at D; minus infinity for the point of tangency itself."""
    dd = dx * dx + dy * dy
    if dd == 0.0:
        return -math.inf
    return 2.0 * (nx * dx + ny * dy) / dd


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
def _turns(si, sf, cp, j, ox, oy, dpx, dpy, a, ax, ay, tax, tay, b, bx, by, tbx, tby):
    """(turn of T, turn of D) from a to b on a piece that turns by less than half a turn, whole turns counted.

    angle(T') = 2 angle(D) - angle(T) + pi, and psi falls as T' turns left: change = turn of T - 2 (turn of D). That of D is less
    than half a turn unless p lies inside the cap between the piece and its chord. It may do so where D turns the other way than
    it sets out and arrives: then halves are looked at, of which one is clear, until all are.
    """
    tangent = _turned(tax, tay, tbx, tby)
    counted = 0.0
    turned = _turned(ax, ay, bx, by)
    for _ in range(CAP_STEPS):
        sense = ax * tay - ay * tax
        if sense * (bx * tby - by * tbx) <= 0.0 or turned * sense >= 0.0:
            break
        m = 0.5 * (a + b)
        x, y, tx, ty, k, speed = evaluate_spiral(si, sf, cp, j, m, ox, oy)
        x -= dpx
        y -= dpy
        if not a < m < b or x == 0.0 and y == 0.0:
            break
        first = _turned(ax, ay, x, y)
        second = _turned(x, y, bx, by)
        if sense * (x * ty - y * tx) <= 0.0 or first * sense >= 0.0:
            counted += first
            turned = second
            a = m
            ax = x
            ay = y
            tax = tx
            tay = ty
        else:
            counted += second
            turned = first
            b = m
            bx = x
            by = y
            tbx = tx
            tby = ty
    return tangent, counted + turned


@inner
def _one_way(ax, ay, tax, tay, ka, bx, by, tbx, tby, kb):
    """Whether T and D turn one way only from a to b: curvature and the side of the tangent that p is on keep their signs.

    That side could change twice where p comes nearest on the way, or is farthest; it does neither where D keeps going with T,
    or against it.
    """
    aside = (ax * tay - ay * tax) * (bx * tby - by * tbx)
    return ka * kb >= 0.0 and aside > 0.0 and (ax * tax + ay * tay) * (bx * tbx + by * tby) > 0.0


@inner
def _bracket(si, sf, cp, j, ox, oy, dpx, dpy, lo, ax, ay, tax, tay, ka, pa, wa, hi, bx, by, tbx, tby, kb, wb):
    """(found, a, b): where psi, pa at lo and counted from there on, falls through a multiple of a full turn, `goal`, and W < 0.

    D, the tangent and the curvature at lo and hi are given, and W there.
    """
    tangent, sight = _turns(si, sf, cp, j, ox, oy, dpx, dpy, lo, ax, ay, tax, tay, hi, bx, by, tbx, tby)
    pb = pa + tangent - 2.0 * sight
    turn = 2.0 * math.pi
    if wa < 0.0:  # psi falls from pa, perhaps rises again later
        goal = 0.0 if pa > 0.0 else -turn
        found = pb <= goal
        if not found and wb < 0.0:
            return False, lo, hi
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
        # from a to its extremum psi changes by no more than T and D turn from a to b
        change = AMPLE * (abs(tangent) + 2.0 * abs(sight))
        if not found and (min(above, below) > change if wa < 0.0 else max(above, below) < -change):
            if _one_way(ax, ay, tax, tay, ka, bx, by, tbx, tby, kb):
                break
        m = 0.5 * (a + b)
        if not a < m < b:
            break
        x, y, tx, ty, k, speed = evaluate_spiral(si, sf, cp, j, m, ox, oy)
        dx = x - dpx
        dy = y - dpy
        dd = dx * dx + dy * dy
        first_tangent, first_sight = _turns(si, sf, cp, j, ox, oy, dpx, dpy, a, ax, ay, tax, tay, m, dx, dy, tx, ty)
        value = above + first_tangent - 2.0 * first_sight
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
            ka = k
            tangent -= first_tangent
            sight -= first_sight
        else:
            b = m
            below = value
            bx = dx
            by = dy
            tbx = tx
            tby = ty
            kb = k
            tangent = first_tangent
            sight = first_sight
    return found, a, b


@pasted
def _inverted(si, sf, cp, j, s, ox, oy, dpx, dpy):
    """D at s and |D|^2, both derivatives of the site and |C'|^2, the direction of T'."""
    x, y, x1, y1, x2, y2 = site_frame(si, sf, cp, j, s, ox, oy)
    dx = x - dpx
    dy = y - dpy
    dd = dx * dx + dy * dy
    along = 2.0 * (dx * x1 + dy * y1)
    return dx, dy, dd, x1, y1, x2, y2, x1 * x1 + y1 * y1, x1 * dd - along * dx, y1 * dd - along * dy


@inner
def _root(si, sf, cp, j, ox, oy, dpx, dpy, nx, ny, wa, a, b):
    """Where psi falls through zero between a and b, by Newton's method kept inside the bracket; wa: W where the piece begins."""
    s = 0.5 * (a + b)
    for _ in range(NEWTON_STEPS):
        dx, dy, dd, x1, y1, x2, y2, ss, ix, iy = _inverted(si, sf, cp, j, s, ox, oy, dpx, dpy)
        if dd == 0.0 or ss == 0.0:
            break
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
        if not a < new < b and new != s:
            new = 0.5 * (a + b)
        step = abs(new - s)
        s = new
        if step <= 1e-14 or b - a <= 1e-15:
            break
    return s


@inner
def summit(si, sf, cp, j, lo, hi, guess, ox, oy, dpx, dpy, nx, ny, near):
    """(phi, s) of the maximum of phi inside (lo, hi), by Newton's method on psi from a guess; (0, s) when it leads elsewhere.

    On a piece of monotone curvature phi has one interior maximum at most, so a zero of psi at which phi has one is *the* maximum,
    wherever the guess was. A step no longer than `near` is the last one.
    """
    s = guess
    for _ in range(SUMMIT_STEPS):
        dx, dy, dd, x1, y1, x2, y2, ss, ix, iy = _inverted(si, sf, cp, j, s, ox, oy, dpx, dpy)
        if dd == 0.0 or ss == 0.0:
            break
        facing = nx * iy - ny * ix
        # slope of psi, times ss and dd
        slope = (x1 * y2 - y1 * x2) * dd + 2.0 * (dy * x1 - dx * y1) * ss
        if not (facing > 0.0 and slope < 0.0):
            break
        share = 1.0 / (facing * slope)
        step = -small_angle((nx * ix + ny * iy) * slope * share) * (ss * dd) * (facing * share)
        s += step
        if not lo < s < hi:
            break
        if abs(step) <= near and step * step * ss <= CLEAR * CLEAR * dd:
            # what the step changes is told well enough by the derivatives
            dx += step * (x1 + 0.5 * step * x2)
            dy += step * (y1 + 0.5 * step * y2)
            return 2.0 * (nx * dx + ny * dy) / (dx * dx + dy * dy), s
    return 0.0, s


@inner
def touch_spiral(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, nx, ny):
    """Sup of phi over [lo, hi] of a piece of monotone curvature, and where.

    Half of the inner maxima are where Newton's method leads to from the middle; the rest are sought with certainty.
    """
    x, y, tax, tay, ka, speed = evaluate_spiral(si, sf, cp, j, lo, ox, oy)
    ax = x - dpx
    ay = y - dpy
    wa, da = _turning(ax, ay, tax, tay, ka)
    best = through_point(ax, ay, nx, ny)
    x, y, tx, ty, kb, speed = evaluate_spiral(si, sf, cp, j, hi, ox, oy)
    bx = x - dpx
    by = y - dpy
    wb, db = _turning(bx, by, tx, ty, kb)
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

    phi, s = summit(si, sf, cp, j, lo, hi, 0.5 * (lo + hi), ox, oy, dpx, dpy, nx, ny, SETTLED)
    if phi > 0.0:
        return (phi, s) if phi >= best - FLAT * abs(best) else (best, s_best)
    pa = _angle(x0, y0, tax, tay, nx, ny)
    found, a, b = _bracket(si, sf, cp, j, ox, oy, dpx, dpy, lo, ax, ay, tax, tay, ka, pa, wa, hi, bx, by, tx, ty, kb, wb)
    if not found:
        return best, s_best
    s = _root(si, sf, cp, j, ox, oy, dpx, dpy, nx, ny, wa, a, b)
    x, y, x1, y1, x2, y2 = site_frame(si, sf, cp, j, s, ox, oy)
    phi = through_point(x - dpx, y - dpy, nx, ny)
    # an end is the next site's contact as well, and where phi is flat it is not better than rounding makes it
    if phi >= best - FLAT * abs(best):
        return phi, s
    return best, s_best
