"""The true axis point and both footpoints that belong to a point of a fitted curve.

On a conic the footpoints are those of the centre on a line, arc or point. On a fitted piece they are found on the
sampled side, where the true axis point X(s) lies in the plane through the curve's point that is square to the chord d of
the polynomial: (X(s) - X) . d = 0, by a bracketed secant method (Illinois). There the piece's error was bounded. Centres of
curvature need no care: there s moves like the square root of the distance.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.curve import edge_parameter, evaluate
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import ARC, K0, KIND, LEN, LINE, SPIRAL, SWEEP, TX0, TY0, X0, Y0, SiteInts
from mat_core.kernels.nurbs import spline_point
from mat_core.tracing.strip import trace

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

STEPS = 60
NEAR = 1e-15  # the plane is met when the point is this near to it (normalised)


@inner
def foot_on(si: SiteInts, sf: Floats, i: int, lo: float, hi: float, x: float, y: float) -> float:
    """Parameter of the point of a LINE, ARC or FAN nearest to the centre (x, y), kept in [lo, hi]."""
    gx = x - sf[i, X0]
    gy = y - sf[i, Y0]
    tx = sf[i, TX0]
    ty = sf[i, TY0]
    kind = si[i, KIND]
    if kind == LINE:
        s = (gx * tx + gy * ty) / sf[i, LEN]
    elif kind == ARC:
        # from the arc's centre o = (X0, Y0) + n / k: direction of the foot against that of the start, -n sign(k)
        k = sf[i, K0]
        ux = k * gx + ty
        uy = k * gy - tx
        angle = math.atan2(tx * ux + ty * uy, ty * ux - tx * uy)
        s = angle / sf[i, SWEEP]
        period = abs(2.0 * math.pi / sf[i, SWEEP])
        if s < 0.0 and s < 0.5 - 0.5 * period:
            s += period
    else:
        # the normal at the vertex that points at the centre, measured from the middle one
        half = 0.5 * sf[i, SWEEP]
        ch = math.cos(half)
        sh = math.sin(half)
        nx = -(sh * tx + ch * ty)
        ny = ch * tx - sh * ty
        s = 0.5 + math.atan2(nx * gy - ny * gx, nx * gx + ny * gy) / sf[i, SWEEP]
    return min(max(s, lo), hi)


@inner
def _plane_root(
    si: SiteInts, sf: Floats, cp: Floats, i: int, s0: float, s1: float, j: int, lo: float, hi: float, x: float, y: float,
    r: float, share: float, ends: Floats, dx: float, dy: float, dr: float, out: Floats,
) -> None:
    """`out` = x, y, r, s, s_j of the axis point between s0 and s1 on side i that lies in a plane square to (dx, dy, dr).

    That plane goes through (x, y, r); `ends` (6,) are discs in the planes of s0 and s1.
    """
    size = math.sqrt(dx * dx + dy * dy + dr * dr)
    if size == 0.0:
        size = 1.0
    fa = ((ends[0] - x) * dx + (ends[1] - y) * dy + (ends[2] - r) * dr) / size
    fb = ((ends[3] - x) * dx + (ends[4] - y) * dy + (ends[5] - r) * dr) / size
    a = s0
    b = s1
    s = s0 + share * (s1 - s0)
    side = 0
    best = math.inf
    for step in range(STEPS):
        px, py, pr, sj, ex, ey, er = trace(si, sf, cp, i, s, j, lo, hi)
        f = ((px - x) * dx + (py - y) * dy + (pr - r) * dr) / size
        if abs(f) < best:
            best = abs(f)
            out[0] = px
            out[1] = py
            out[2] = pr
            out[3] = s
            out[4] = sj
        if abs(f) <= NEAR:
            return
        if f < 0.0:
            a = s
            fa = f
            if side == -1:
                fb *= 0.5
            side = -1
        else:
            b = s
            fb = f
            if side == 1:
                fa *= 0.5
            side = 1
        new = 0.5 * (a + b)
        if fa < 0.0 < fb and step % 8 != 7:
            new = a + (b - a) * (fa / (fa - fb))
        if new == s or (new - a) * (new - b) >= 0.0:
            return
        s = new


@inner
def _on_fit(
    si: SiteInts, sf: Floats, cp: Floats, a: int, b: int, strip_s: Floats, strip: int, side: int, s0: float, s1: float,
    share: float, degree: int, knots: Floats, k0: int, k1: int, curve: Floats, c0: int, part_f: Floats, part: int,
    point: Floats, work: Floats, ends: Floats, found: Floats,
) -> None:
    """`found` = x, y, r, s, s_j of the axis point beside `point` on a fitted piece."""
    x = point[0]
    y = point[1]
    r = point[2]
    # a polynomial may go on beyond the part's ends: its own ends are the knots around
    hi = k0 + degree + 1
    while hi < k1 - 1 and knots[hi] < part_f[part, 1]:
        hi += 1
    lo = hi - 1
    while knots[lo] > part_f[part, 0]:
        lo -= 1
    spline_point(degree, knots, k0, k1, curve, c0, knots[lo], work, point)
    dx = -point[0]
    dy = -point[1]
    dr = -point[2]
    spline_point(degree, knots, k0, k1, curve, c0, knots[hi], work, point)
    dx += point[0]
    dy += point[1]
    dr += point[2]
    for end in range(2):
        spline_point(degree, knots, k0, k1, curve, c0, part_f[part, end], work, point)
        for c in range(3):
            ends[3 * end + c] = point[c]
    if side == 0:
        _plane_root(si, sf, cp, a, s0, s1, b, strip_s[strip, 3], strip_s[strip, 2], x, y, r, share, ends, dx, dy, dr, found)
    else:
        _plane_root(si, sf, cp, b, s0, s1, a, strip_s[strip, 0], strip_s[strip, 1], x, y, r, share, ends, dx, dy, dr, found)


@inner
def _part_at(part_f: Floats, first: int, last: int, t: float) -> int:
    """The part among first .. last - 1 of a segment that t is in."""
    lo = first
    hi = last
    while hi - lo > 1:
        mid = (lo + hi) // 2
        if part_f[mid, 0] <= t:
            lo = mid
        else:
            hi = mid
    return lo


@inner
def _feet_beside(
    si: SiteInts, sf: Floats, cp: Floats, a: int, b: int, strip_s: Floats, strip: int, side: int, t: float, degree: int,
    knots: Floats, k0: int, k1: int, curve: Floats, c0: int, part_f: Floats, part: int, point: Floats, work: Floats,
    ends: Floats, found: Floats,
) -> tuple[float, float]:
    """Both footpoints of the axis point beside `point` at t of a fitted piece; that point comes first in `found`."""
    s0 = part_f[part, 2]
    s1 = part_f[part, 3]
    a0 = strip_s[strip, 0]
    a1 = strip_s[strip, 1]
    b0 = strip_s[strip, 2]
    b1 = strip_s[strip, 3]
    share = (t - part_f[part, 0]) / (part_f[part, 1] - part_f[part, 0])
    at = s0 if share <= 0.0 else (s1 if share >= 1.0 else math.inf)
    # the ends of a strip are known exactly, and may be centres of curvature
    if side == 0 and (at == a0 or at == a1):
        found[0], found[1], found[2], sj, dx, dy, dr = trace(si, sf, cp, a, at, b, b1, b0)
        return at, b0 if at == a0 else b1
    if side == 1 and (at == b0 or at == b1):
        found[0], found[1], found[2], sj, dx, dy, dr = trace(si, sf, cp, b, at, a, a0, a1)
        return a0 if at == b0 else a1, at
    _on_fit(si, sf, cp, a, b, strip_s, strip, side, s0, s1, min(max(share, 0.0), 1.0), degree, knots, k0, k1, curve, c0,
            part_f, part, point, work, ends, found)
    if side == 0:
        return found[3], found[4]
    return found[4], found[3]


@jit
def locate(
    si: SiteInts, sf: Floats, cp: Floats, strip_i: Ints, strip_s: Floats, degree: Ints, knot_start: Ints, knots: Floats,
    cp_start: Ints, curve: Floats, max_error: Floats, part_start: Ints, part_i: Ints, part_f: Floats, segment: Ints,
    t: Floats, work: Floats, point: Floats, ends: Floats, found: Floats, located: Floats, sites: Ints,
) -> None:
    """True axis points for t[n] on segment[n]: `located` (5, n) x, y, r, s right, s left; `sites` (2, n) right, left.

    Right and left are as seen in the direction of increasing t. `point`, `ends` (6,) and `found` (5,) are scratch.
    """
    for n in range(t.shape[0]):
        g = segment[n]
        part = _part_at(part_f, part_start[g], part_start[g + 1], t[n])
        strip = part_i[part, 1]
        side = part_i[part, 2]
        forward = part_f[part, 2] == part_f[part, 3] or (part_f[part, 3] > part_f[part, 2]) == (side == 0)
        a = strip_i[strip, 0]
        b = strip_i[strip, 1]
        spline_point(degree[g], knots, knot_start[g], knot_start[g + 1], curve, cp_start[g], t[n], work, point)
        x = point[0]
        y = point[1]
        r = point[2]
        if si[a, KIND] != SPIRAL and si[b, KIND] != SPIRAL:
            sa = foot_on(si, sf, a, strip_s[strip, 0], strip_s[strip, 1], x, y)
            sb = foot_on(si, sf, b, strip_s[strip, 3], strip_s[strip, 2], x, y)
        else:
            sa, sb = _feet_beside(si, sf, cp, a, b, strip_s, strip, side, t[n], degree[g], knots, knot_start[g],
                                  knot_start[g + 1], curve, cp_start[g], part_f, part, point, work, ends, found)
            # nearer to a centre of curvature than the true point can be told, the curve is the better one
            gap = math.sqrt((found[0] - x) ** 2 + (found[1] - y) ** 2 + (found[2] - r) ** 2)
            if gap <= max_error[g]:
                x = found[0]
                y = found[1]
                r = found[2]
        located[0, n] = x
        located[1, n] = y
        located[2, n] = r
        located[3, n] = sa if forward else sb
        located[4, n] = sb if forward else sa
        sites[0, n] = a if forward else b
        sites[1, n] = b if forward else a


@jit
def feet(si: SiteInts, sf: Floats, cp: Floats, site: Ints, s: Floats, out: Floats) -> None:
    """Rows x, y, u, angle of `out` (n, 4): point, input parameter and direction of the normal at s[n] on site[n]."""
    for n in range(s.shape[0]):
        x, y, tx, ty, k, speed = evaluate(si, sf, cp, site[n], s[n], 0.0, 0.0)
        out[n, 0] = x
        out[n, 1] = y
        out[n, 2] = edge_parameter(si, sf, cp, site[n], s[n])
        out[n, 3] = math.atan2(tx, -ty)
