r"""How far the radius of a polynomial F = (c, r)(v) is from the distance of its centre to one side: a bound over 0 <= v <= 1.

LINE        n.(c - p) - r is a polynomial.
ARC, FAN    with g = c - o and the signed radius rho of the arc (0: FAN)     (|g|^2 - (r - rho)^2) / (|g| + |r - rho|).
SPIRAL      C = P / w a Bezier. A polynomial s(v) is laid through true feet of some of the centres: a guess, about which all is
            proved that is used. With V = c w - P and T = P' w - P w' at s(v), all of them polynomials in v,

    e = |c - C(s)| - r = m / (1 + e / 2 r),    m = (|V|^2 - (r w)^2) / (2 r w^2),    |e - m| <= m^2 / r      (a)
    D(s) = |c - C(s)|^2 / 2,     D' = -V.T / w^3,     D'' = Q / w^4,     Q = T.T - w V.T' + 2 w' V.T    (b)

            and the true distance falls short of |c - C(s)| by at most D'^2 / (D'' r), where D'' is what it is at least between
            s and the foot, |D' / D''| away; Q changes by Q' and by the bounds of Q'' there.

Coefficients in Bernstein form enclose each of these. Where both sides meet in one point at v = 0 all of it vanishes together
and is divided by powers of v first:

    VERTEX    r, V, V.T ~ v, and so the miss: `miss` is a bound of miss / v
    LEAF      a centre of curvature, v = sqrt(way along the axis): V.T ~ v^3, Q ~ v^2, the miss ~ v^4 as F has the axis's tangent
              there; `miss` and `bend` are bounds of miss / v^4 and bend v^2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.bernstein import derivative, product, restrict
from mat_core.analysis.proving.polynomials import (
    compose,
    largest,
    least_and_most,
    over_power,
    places,
    through,
    total,
    values,
)
from mat_core.boundary.sites import SiteTable
from mat_core.kernels.layout import ARC, CP0, DEG, K0, KIND, LINE, RATIONAL, SPIRAL, TX0, TY0, X0, X0_LOW, Y0, Y0_LOW

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

PLAIN, VERTEX, LEAF = 0, 1, 2  # what happens at v = 0

FOOT_DEGREE = 6  # of s(v)
GRID = 65  # places of a site from which the feet are searched
NEWTON_STEPS = 12
REACH = 0.02  # of a strip's interval: feet of a polynomial may stand so much beside it
STEADY = 0.2  # share of D'' that it may lose between s and the foot
NEAR = 1e-3  # of the site's parameter: how far they may be from each other
BEYOND = 0.05  # of it: how far beyond both ends of the Bezier polynomials in s are enclosed
SMALL = 0.1  # of the radius: the miss at most
POWERS = {PLAIN: 0, VERTEX: 1, LEAF: 4}  # of v in the miss


class Side(NamedTuple):
    """What is known of one side, (R,) each: infinite `miss` where nothing is.

    miss: bound of |distance - r|; off, over: rows of polynomials, the distance less r is off / over but for `slack`; bend: of the
    second derivative of the distance, across its gradient; x, y, m: (x, y) / m is the direction from the foot; astray: bound of
    the error of that direction.
    """

    miss: Floats
    slack: Floats
    off: list[Floats]
    over: list[Floats]
    bend: Floats
    x: list[Floats]
    y: list[Floats]
    m: list[Floats]
    astray: Floats


def side_of(table: SiteTable, site: Ints, interval: Floats, disc: Floats, kind: int) -> Side:
    """One side of polynomials.

    Parameters
    ----------
    table : SiteTable
    site : (R,) int64
    interval : (R, 2) float64
        Of the site, within which the feet are.
    disc : (R, n + 1, 3) float64
        Bernstein coefficients of x, y, r; normalised.
    kind : int
        PLAIN, VERTEX or LEAF: of all rows.
    """
    si, sf = table.si[site], table.sf[site]
    spiral = si[:, KIND] == SPIRAL
    shape = np.column_stack((si[:, KIND], np.where(spiral, si[:, DEG], 0), np.where(spiral, si[:, RATIONAL], 0)))
    n = len(site)
    off, over, nx, ny, nm = ([np.empty(0)] * n for _ in range(5))
    out = Side(np.full(n, np.inf), np.zeros(n), off, over, np.zeros(n), nx, ny, nm, np.zeros(n))
    for one in np.unique(shape, axis=0).tolist():
        rows = np.flatnonzero((shape == one).all(axis=1))
        f = sf[rows]
        start = np.column_stack((f[:, X0] + f[:, X0_LOW], f[:, Y0] + f[:, Y0_LOW]))
        x, y, r = disc[rows, :, 0] - start[:, :1], disc[rows, :, 1] - start[:, 1:], disc[rows, :, 2]
        if one[0] == LINE:
            found = _line(f, x, y, r, kind)
        elif one[0] == SPIRAL:
            control = table.cp[si[rows, CP0][:, None] + np.arange(one[1] + 1)]
            found = _spiral(control, bool(one[2]), interval[rows], x, y, r, kind)
        else:
            found = _circle(f, one[0] == ARC, x, y, r, kind)
        out.miss[rows], out.slack[rows], out.bend[rows], out.astray[rows] = found.miss, found.slack, found.bend, found.astray
        for all_, own in ((off, found.off), (over, found.over), (nx, found.x), (ny, found.y), (nm, found.m)):
            for place, row in enumerate(rows.tolist()):
                all_[row] = own[place]
    return out


def _line(f: Floats, x: Floats, y: Floats, r: Floats, kind: int) -> Side:
    """The distance from a line."""
    nx, ny = -f[:, TY0 : TY0 + 1], f[:, TX0 : TX0 + 1]
    off, good = over_power(nx * x + ny * y - r, POWERS[kind])
    none = np.zeros(len(f))
    one: list[Floats] = list(np.ones_like(nx))
    return Side(np.where(good, largest(off), np.inf), none, list(off), one, none, list(nx), list(ny), one, none)


def _circle(f: Floats, arc: bool, x: Floats, y: Floats, r: Floats, kind: int) -> Side:
    """The distance from a circular arc or a point, and from its centre."""
    rho = 1.0 / f[:, K0 : K0 + 1] if arc else np.zeros((len(f), 1))
    gx, gy, reach = x + f[:, TY0 : TY0 + 1] * rho, y - f[:, TX0 : TX0 + 1] * rho, r - rho
    off, good = over_power(total(product(gx, gx) + product(gy, gy), product(reach, reach), -1.0), POWERS[kind])
    low, high = least_and_most(reach)
    nearest = np.where(low > 0.0, low, np.where(high < 0.0, -high, 0.0))
    good &= nearest > 0.0
    nearest = np.where(good, nearest, 1.0)
    miss = np.where(good, largest(off) / nearest, np.inf)
    astray = miss / nearest
    over = 2.0 * np.where(low > 0.0, 1.0, -1.0)[:, None] * reach
    return Side(miss, miss * astray, list(off), list(over), 1.0 / nearest, list(gx), list(gy), list(reach), astray)


def _spiral(control: Floats, rational: bool, interval: Floats, x: Floats, y: Floats, r: Floats, kind: int) -> Side:
    """The distance from a Bezier: steps (a) and (b)."""
    weight = control[:, :, 2] if rational else np.ones((len(control), 1))
    own = [control[:, :, i] * (control[:, :, 2] if rational else 1.0) for i in range(2)]
    tangent = [total(product(derivative(p), weight), product(p, _derivative(weight)), -1.0) for p in own]
    foot = _feet(own, weight, tangent, interval, x, y, kind)
    w = compose(weight, foot)
    vx, vy = (total(product(c, w), compose(p, foot), -1.0) for c, p in zip((x, y), own, strict=True))
    rw = product(r, w)
    power = {PLAIN: (0, 0, 0, 0), VERTEX: (2, 1, 1, 0), LEAF: (4, 0, 3, 2)}[kind]
    off, good = over_power(total(product(vx, vx) + product(vy, vy), product(rw, rw), -1.0), power[0])
    radius, fits = over_power(r, power[1])
    good &= fits
    slope, fits = over_power(product(vx, compose(tangent[0], foot)) + product(vy, compose(tangent[1], foot)), power[2])
    good &= fits
    q, change, bends, rest = _second(own, weight, tangent, foot, x, y)
    q, fits = over_power(q, power[3])
    good &= fits
    change, fits = over_power(change, 1 if kind == LEAF else 0)
    good &= fits
    w_low, w_high = least_and_most(w)
    r_low, _ = least_and_most(radius)
    q_low, _ = least_and_most(q)
    good &= (r_low > 0.0) & (q_low > 0.0) & (w_low > 0.0)
    r_low, q_low, w_low = (np.where(good, low, 1.0) for low in (r_low, q_low, w_low))
    most = largest(slope) / w_low**3
    w_near = w_high + NEAR * largest(_derivative(weight))
    away = most * w_near**4 / ((1.0 - STEADY) * q_low)
    good &= (away <= NEAR) & (away * (largest(change) + bends * away) <= STEADY * q_low)
    missed, fall = largest(off) / (2.0 * r_low * w_low**2), most * away / ((1.0 - SMALL) * r_low)
    good &= missed <= SMALL * r_low
    slack = fall + missed * missed / r_low
    miss = missed + slack
    along = largest(tangent[0]) + largest(tangent[1])
    bent, fits = over_power(rest, 1 if kind == VERTEX else 0)
    bend = largest(bent) / ((1.0 - STEADY) * q_low * (1.0 - SMALL) * r_low)
    good &= fits
    astray = away * along / (w_low**2 * r_low) + miss / r_low
    nx, ny, nm = (list(over_power(p, power[1])[0]) for p in (vx, vy, rw))
    over = 2.0 * product(radius, product(w, w))
    return Side(np.where(good, miss, np.inf), slack, list(off), list(over), bend, nx, ny, nm, astray)


def _derivative(rows: Floats) -> Floats:
    """Of rows that may be constant."""
    return derivative(rows) if rows.shape[1] > 1 else np.zeros((len(rows), 1))


def _second(
    own: list[Floats], weight: Floats, tangent: list[Floats], foot: Floats, x: Floats, y: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """(Q, Q' by s, bounds (R,) of |Q''| / 2 by s, Q - T.T) at s(v).

    Q = Q0(s) + x Qx(s) + y Qy(s), and so its derivatives. For a centre among the control points' hull Q'' is among theirs.
    """
    slope = _derivative(weight)
    bent = [_derivative(t) for t in tangent]
    square = product(tangent[0], tangent[0]) + product(tangent[1], tangent[1])
    by_centre = [total(-product(product(weight, weight), b), 2.0 * product(product(weight, slope), t))
                 for b, t in zip(bent, tangent, strict=True)]
    constant = sum(
        (total(product(product(weight, p), b), -2.0 * product(product(slope, p), t)) for p, b, t in
         zip(own, bent, tangent, strict=True)), np.zeros((len(weight), 1))
    )  # fmt: skip
    terms = [np.asarray(constant), *by_centre]

    def at(rows: list[Floats]) -> Floats:
        c, cx, cy = (compose(row, foot) for row in rows)
        return total(total(c, product(x, cx)), product(y, cy))

    rest = at(terms)
    whole = [total(square, terms[0]), *by_centre]
    once = [_derivative(row) for row in whole]
    ends = np.full(len(weight), -BEYOND), np.full(len(weight), 1.0 + BEYOND)
    twice = [restrict(_derivative(row), *ends) for row in once]
    bends = np.zeros(len(weight))
    for i in range(x.shape[1]):
        bends = np.maximum(bends, largest(total(twice[0], total(x[:, i : i + 1] * twice[1], y[:, i : i + 1] * twice[2]))))
    return total(compose(square, foot), rest), at(once), 0.5 * bends, rest


def _feet(
    own: list[Floats], weight: Floats, tangent: list[Floats], interval: Floats, x: Floats, y: Floats, kind: int
) -> Floats:
    """s(v) (R, FOOT_DEGREE + 1): through the feet of some centres; nothing is assumed of it."""
    at = np.tile(places(FOOT_DEGREE), (len(x), 1))
    cx, cy = values(x, at), values(y, at)
    low, high = interval.min(axis=1)[:, None], interval.max(axis=1)[:, None]
    grid = low + (high - low) * np.linspace(0.0, 1.0, GRID)
    nearest = least_places(own, weight, tangent, grid, cx, cy)
    if kind == LEAF:
        nearest = np.clip(nearest, 1, GRID - 2)  # the centre of curvature's own foot is where the distance is stationary, too
    s = np.take_along_axis(grid, nearest, axis=1)
    pad = 0.0 if kind == LEAF else REACH * (high - low)
    slope, bent = _derivative(weight), [_derivative(t) for t in tangent]
    for _ in range(NEWTON_STEPS):
        w, w1 = values(weight, s), values(slope, s)
        tx, ty = values(tangent[0], s), values(tangent[1], s)
        vx, vy = cx * w - values(own[0], s), cy * w - values(own[1], s)
        along = vx * tx + vy * ty
        q = tx * tx + ty * ty - w * (vx * values(bent[0], s) + vy * values(bent[1], s)) + 2.0 * w1 * along
        step = np.where(q > 0.0, along * w / np.where(q > 0.0, q, 1.0), 0.0)
        s = np.clip(s + step, low - pad, high + pad)
    if kind != PLAIN:
        # where both sides meet the foot is the end of the interval that is nearer
        s[:, 0] = np.where(s[:, 1] - low[:, 0] < high[:, 0] - s[:, 1], low[:, 0], high[:, 0])
    return through(s)


def least_places(
    own: list[Floats], weight: Floats, tangent: list[Floats], grid: Floats, cx: Floats, cy: Floats
) -> Ints:
    """(R, k) the place of a grid (R, g) that is nearest to each centre (R, k), among those where the distance has a minimum.

    A vertex at the end of an interval may be as near as the foot, and beside the foot of a centre of curvature the distance is
    stationary, too. Where it has no minimum on the grid, any place may be the nearest.
    """
    w = values(weight, grid)
    dx = cx[:, :, None] - (values(own[0], grid) / w)[:, None]
    dy = cy[:, :, None] - (values(own[1], grid) / w)[:, None]
    apart = np.hypot(dx, dy)
    nearing = dx * values(tangent[0], grid)[:, None] + dy * values(tangent[1], grid)[:, None] > 0.0
    turn = nearing[:, :, :-1] & ~nearing[:, :, 1:]
    never = np.zeros_like(turn[:, :, :1])
    least = np.concatenate((turn, never), axis=2) | np.concatenate((never, turn), axis=2)
    among = np.where(least | ~least.any(axis=2, keepdims=True), apart, np.inf)
    return np.asarray(among.argmin(axis=2))
