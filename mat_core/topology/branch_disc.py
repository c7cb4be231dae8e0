"""The disc that touches three arcs of a face, where along one of them the partner changes.

A face in the work buffer is a row for each arc: ints (site, disc that closes it towards the next arc), floats (lo, hi); see
`topology.branches`. Where two of the three meet at a nearly smooth corner the disc is solved once more along one of them, and
any is polished on all three.
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate, site_frame
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import ARC, CONVEX_VERTEX, CORNER, FAN, K0, KIND, LEN, LINE, NEXT, SWEEP, TX0, TY0, X0, Y0
from mat_core.topology.discs import K_LOW
from mat_core.topology.partners import ROOT_ROUNDING, STEEP, apart_sq, partner_change, touch_arc

CONCENTRIC = 1e-6  # a centre this near to that of curvature, relative to its radius, moves its nearest point by rounding alone
FOOT_STEPS = 40
POLISH_STEPS = 6
LEVER = 1e4  # a step this many times what it mends goes where two contacts that nearly are one leave the disc free
SETTLED = 1e-15  # distances of a centre that agree so well leave nothing to polish
SAME_CONTACT = 1e-3  # of the least distance between the contacts of a disc: no farther off is one of a disc that stands for it
AROUND = 0.1  # share of the way from a contact to either end of its site within which it is sought again
SAME_PLACE = 1e-6  # radii between a disc and the one solved for once more
DEPTH_NOISE = 8e-15  # of contacts, of which only the direction tells one from the other: thirty-two roundings of a coordinate
PARALLEL = 1e-7  # determinant of three contact directions below which a disc is not polished


@inner
def _foot(si, sf, cp, i, s, lo, hi, cx, cy):
    """Parameter in [lo, hi] of the point of site i nearest to (cx, cy), from s on; s itself near a centre of curvature."""
    kind = si[i, KIND]
    dx = cx - sf[i, X0]
    dy = cy - sf[i, Y0]
    tx = sf[i, TX0]
    ty = sf[i, TY0]
    if kind == LINE:
        return min(max((dx * tx + dy * ty) / sf[i, LEN], lo), hi)
    if kind == FAN:
        # from the middle normal, so that half a turn has both its ends
        half = 0.5 * sf[i, SWEEP]
        ch = math.cos(half)
        sh = math.sin(half)
        mx = -(sh * tx + ch * ty)
        my = ch * tx - sh * ty
        return min(max(0.5 + math.atan2(mx * dy - my * dx, mx * dx + my * dy) / sf[i, SWEEP], lo), hi)
    if kind == ARC:
        # direction from the arc's centre against that of its start, both times k: the start lies at -n
        ux = sf[i, K0] * dx + ty
        uy = sf[i, K0] * dy - tx
        if ux * ux + uy * uy < CONCENTRIC * CONCENTRIC:
            return min(max(s, lo), hi)
        turned = math.atan2(ty * uy + tx * ux, ty * ux - tx * uy) / sf[i, SWEEP]
        period = abs(2.0 * math.pi / sf[i, SWEEP])
        if turned < 0.5 - 0.5 * period:
            turned += period
        return min(max(turned, lo), hi)
    a = lo
    b = hi
    s = min(max(s, lo), hi)
    for _ in range(FOOT_STEPS):
        x, y, x1, y1, x2, y2 = site_frame(si, sf, cp, i, s, cx, cy)
        g = x * x1 + y * y1
        if g == 0.0:
            break
        if g > 0.0:
            b = s
        else:
            a = s
        speed = x1 * x1 + y1 * y1
        slope = speed + x * x2 + y * y2
        if abs(slope) < CONCENTRIC * speed and abs(g) < CONCENTRIC * speed:
            break
        new = s - g / slope if slope > 0.0 else 0.5 * (a + b)
        if abs(new - s) <= ROOT_ROUNDING:
            break
        if not a < new < b:
            new = 0.5 * (a + b)
            if not a < new < b:
                break
        s = new
    return s


@inner
def solve_at_corner(si, sf, cp, w_i, w_f, left, right, tie, disc, d, s):
    """Solve the node of arcs 0, left, right once more along `left` or `right` if it touches these near each other.

    `disc[d]`, contacts `s` (on arcs 0, left, right). One of the two may be the fan of the vertex, which cannot be walked along.
    Returns which of the contacts the disc was built on: its foot is exact.
    """
    along = right if si[w_i[left, 0], KIND] == FAN else left
    other = left if along == right else right
    i = w_i[along, 0]
    between = math.sqrt(apart_sq(si, sf, cp, w_i[left, 0], s[1], w_i[right, 0], s[2]))
    if si[i, KIND] == FAN or between > STEEP * disc[d, 2]:
        return 0
    lo = w_f[along, 0]
    hi = w_f[along, 1]
    # arc 0 may end at the vertex that the other two meet at: from there that end would hide the contact inside of it
    begin = w_f[0, 0]
    end = w_f[0, 1]
    if 0.0 < s[0] < 1.0:
        w_f[0, 0] = max(begin, (1.0 - AROUND) * s[0])
        w_f[0, 1] = min(end, s[0] + AROUND * (1.0 - s[0]))
    if along == left:
        at, phi, s_other, s_0 = partner_change(si, sf, cp, i, lo, hi, w_i, w_f, other, 0, tie)
    else:
        at, phi, s_0, s_other = partner_change(si, sf, cp, i, lo, hi, w_i, w_f, 0, other, tie)
    # where along the wall the disc lies the corner tells best, how large it is the opposite side
    phi, s_0 = touch_arc(si, sf, cp, i, at, w_i, w_f, 0, tie)
    w_f[0, 0] = begin
    w_f[0, 1] = end
    # (an end of arc 0 may tie with the contact inside it: its vertex then is the other one)
    if not K_LOW < phi < math.inf or (not 0.0 < s_0 < 1.0 and 0.0 < s[0] < 1.0):
        return 0
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, i, at, 0.0, 0.0)
    x = px - ty / phi
    y = py + tx / phi
    # from arc 0 the two contacts tell the direction of the disc from them as well as the rounding of their depth lets them
    doubt = min(DEPTH_NOISE / max(between, DEPTH_NOISE), STEEP)
    if math.sqrt((x - disc[d, 0]) ** 2 + (y - disc[d, 1]) ** 2) * phi > max(SAME_PLACE, doubt):
        return 0
    disc[d, 0] = x
    disc[d, 1] = y
    disc[d, 2] = 1.0 / phi
    s[0] = s_0
    s[1] = at if along == left else s_other
    s[2] = s_other if along == left else at
    return 1 if along == left else 2


@inner
def _mending(m0x, m0y, m1x, m1y, m2x, m2y, e, f):
    """(found, x, y): the move v of a centre with (m1 - m0) . v = e and (m2 - m0) . v = f; not found where these are parallel."""
    ax = m1x - m0x
    ay = m1y - m0y
    bx = m2x - m0x
    by = m2y - m0y
    det = ax * by - ay * bx
    if abs(det) < PARALLEL:
        return False, 0.0, 0.0
    return True, (e * by - f * ay) / det, (ax * f - bx * e) / det


@inner
def polish(si, sf, cp, site, s, lo, hi, exact, disc, d):
    """Newton for the disc that touches three given parts: m_m . dc - dr = r - |c - q_m|, q_m the feet of c, m_m towards c.

    Kept if it brings the disc nearer to touching all three. The foot `exact` is not sought before the disc moves: where a part is
    nearly concentric with the disc, it would be lost.
    """
    best = math.inf
    cx = disc[d, 0]
    cy = disc[d, 1]
    f0 = s[0]
    f1 = s[1]
    f2 = s[2]
    for step in range(POLISH_STEPS):
        if step > 0:
            if step > 1 or exact != 0:
                f0 = _foot(si, sf, cp, site[0], f0, lo[0], hi[0], cx, cy)
            if step > 1 or exact != 1:
                f1 = _foot(si, sf, cp, site[1], f1, lo[1], hi[1], cx, cy)
            if step > 1 or exact != 2:
                f2 = _foot(si, sf, cp, site[2], f2, lo[2], hi[2], cx, cy)
        q0x, q0y, tx, ty, k, speed = evaluate(si, sf, cp, site[0], f0, cx, cy)
        q1x, q1y, tx, ty, k, speed = evaluate(si, sf, cp, site[1], f1, cx, cy)
        q2x, q2y, tx, ty, k, speed = evaluate(si, sf, cp, site[2], f2, cx, cy)
        d0 = math.sqrt(q0x * q0x + q0y * q0y)
        d1 = math.sqrt(q1x * q1x + q1y * q1y)
        d2 = math.sqrt(q2x * q2x + q2y * q2y)
        if d0 == 0.0 or d1 == 0.0 or d2 == 0.0:
            return
        miss = max(d0, d1, d2) - min(d0, d1, d2)
        if step == 0:
            if miss <= SETTLED:
                for m in range(3):
                    if m != exact:
                        s[m] = _foot(si, sf, cp, site[m], s[m], lo[m], hi[m], cx, cy)
                return
            # the feet may be far off on parts that are nearly concentric with the disc: they are found first
            best = miss + SETTLED
            continue
        if not miss < best:
            return
        best = 0.5 * miss
        disc[d, 0] = cx
        disc[d, 1] = cy
        disc[d, 2] = (d0 + d1 + d2) / 3.0
        s[0] = f0
        s[1] = f1
        s[2] = f2
        found, mx, my = _mending(q0x / d0, q0y / d0, q1x / d1, q1y / d1, q2x / d2, q2y / d2, d1 - d0, d2 - d0)
        move = math.sqrt(mx * mx + my * my)
        if not found or move > 1e-7 * d0 or move > LEVER * miss:
            return
        cx += mx
        cy += my


@inner
def adopt(si, sf, cp, site, s, lo, hi, w_i, k, left, right, disc, d):
    """Make disc d of arcs 0, left, right one that closes these, if that touches all three as well as coordinates tell.

    Three neighbouring edges of a polygon of 100,000 tell the radius of their disc to 1e-8 only: it may lie beyond the centre.
    That disc is touched where the other one is. Where bends are so slight that no distance tells two discs apart, contacts still
    do: those of the branch to a leaf stand beside the leaf's point, and of two that run together that they are touched tells
    nothing. Nor does a foot on a convex vertex, where no disc touches. The contacts become the feet of the disc taken.
    """
    near = STEEP * disc[d, 2]
    between = apart_sq(si, sf, cp, site[1], s[1], site[2], s[2])
    for m in range(1, 3):
        away = apart_sq(si, sf, cp, site[0], s[0], site[m], s[m])
        if away > near * near:
            return
        between = min(between, away)
    for choice in range(6):
        arc = 0 if choice < 2 else (left if choice < 4 else right)
        closing = w_i[arc if choice % 2 == 0 else (arc + k - 1) % k, 1]
        x = disc[closing, 0]
        y = disc[closing, 1]
        f0 = _foot(si, sf, cp, site[0], s[0], lo[0], hi[0], x, y)
        f1 = _foot(si, sf, cp, site[1], s[1], lo[1], hi[1], x, y)
        f2 = _foot(si, sf, cp, site[2], s[2], lo[2], hi[2], x, y)
        miss = 0.0
        fit = True
        for m in range(3):
            foot = f0 if m == 0 else (f1 if m == 1 else f2)
            dx, dy, tx, ty, curvature, speed = evaluate(si, sf, cp, site[m], foot, x, y)
            miss = max(miss, abs(math.sqrt(dx * dx + dy * dy) - disc[closing, 2]))
            fit &= apart_sq(si, sf, cp, site[m], s[m], site[m], foot) <= SAME_CONTACT * SAME_CONTACT * between
            if foot <= 0.0 or foot >= 1.0:
                fit &= si[site[m] if foot <= 0.0 else si[site[m], NEXT], CORNER] != CONVEX_VERTEX
        if miss <= SETTLED and fit:
            disc[d, 0] = x
            disc[d, 1] = y
            disc[d, 2] = disc[closing, 2]
            s[0] = f0
            s[1] = f1
            s[2] = f2
            return
