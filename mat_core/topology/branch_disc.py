"""One branch disc: where along an arc of a face the partner changes, and the disc that touches three arcs there.

A face in the work buffer is a row for each arc: ints (site, disc that closes it towards the next arc), floats (lo, hi); see
`topology.branches`. From far away two arcs that meet at a nearly smooth corner look alike: the disc is solved once more along
one of them, where the other one's phi is taken relative to their common vertex, and polished on all three.
"""

from __future__ import annotations

import math

from mat_core.kernels.boxtree import box_distance_sq
from mat_core.kernels.curve import evaluate, site_frame
from mat_core.kernels.disc import touch_from
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import (
    ARC,
    CONVEX_VERTEX,
    CORNER,
    FAN,
    K0,
    KIND,
    LEN,
    LINE,
    NEXT,
    PREV,
    SWEEP,
    TX0,
    TY0,
    V0,
    V1,
    X0,
    X1,
    XMAX,
    XMIN,
    Y0,
    Y1,
    YMAX,
    YMIN,
)
from mat_core.topology.discs import BESIDE, K_LOW

ROOT_STEPS = 120
ROOT_ROUNDING = 2e-16  # of a parameter
YIELD = 4.0  # ties
CONCENTRIC = 1e-6  # a centre this near to that of curvature, relative to its radius, moves its nearest point by rounding alone
FOOT_STEPS = 40
POLISH_STEPS = 6
STEEP = 0.01  # radii between two contacts, within which phi of one seen from the other loses digits
PHI_NOISE = 8e-15  # of phi |D|^2 at a contact at D: thirty-two roundings of a coordinate
LEVER = 1e4  # a step this many times what it mends goes where two contacts that nearly are one leave the disc free
SETTLED = 1e-15  # distances of a centre that agree so well leave nothing to polish
AS_WIDE = 0.5  # of the distance of the contacts of a disc, which the feet of one that stands for it must keep
PARALLEL = 1e-7  # determinant of three contact directions below which a disc is not polished


@inner
def touch_arc(si, sf, cp, site, s, w_i, w_f, arc, tie):
    """`touch_from` against one arc of the face.

    A reflex vertex is the end of a piece and its fan at once: the piece yields to the fan where it is touched at that end, the
    fan to the piece where none of its own normals points at the centre. No disc touches a convex vertex: there both pieces yield
    to whatever is touched properly.
    """
    j = w_i[arc, 0]
    phi, sj = touch_from(si, sf, cp, site, s, j, w_f[arc, 0], w_f[arc, 1])
    if phi > 0.0 and (sj <= 0.0 or sj >= 1.0):
        beyond = si[j, PREV] if sj <= 0.0 else si[j, NEXT]
        corner = si[j if sj <= 0.0 else beyond, CORNER] == CONVEX_VERTEX
        if corner or si[j, KIND] == FAN or si[beyond, KIND] == FAN:
            phi *= 1.0 - YIELD * tie
    return phi, sj


@inner
def _difference(si, sf, cp, site, s, w_i, w_f, left, right, tie):
    """(phi_left - phi_right) scaled to [-1, 1], and both contacts."""
    a, sa = touch_arc(si, sf, cp, site, s, w_i, w_f, left, tie)
    b, sb = touch_arc(si, sf, cp, site, s, w_i, w_f, right, tie)
    total = abs(a) + abs(b)
    f = 0.0
    if a == -math.inf:
        f = -1.0 if b > a else 0.0
    elif b == -math.inf:
        f = 1.0
    elif total > 0.0:
        f = (a - b) / total
    return f, max(a, b), sa, sb


@inner
def partner_change(si, sf, cp, site, lo, hi, w_i, w_f, left, right, tie):
    """(s, phi, s_left, s_right) where the partner changes from `left` (wins at lo) to `right` (wins at hi).

    Inverse quadratic interpolation where three values allow it, else halving (Chandrupatla 1997), but the ends are never looked
    at: their signs are known. Never nearer to an end than rounding, so that a root just inside of one is bracketed at once.
    """
    a = lo
    b = hi
    fa = fb = 0.0
    known_a = known_b = False
    s = 0.5 * (a + b)
    at = s
    least = math.inf
    phi = s_left = s_right = 0.0
    for _ in range(ROOT_STEPS):
        f, value, sl, sr = _difference(si, sf, cp, site, s, w_i, w_f, left, right, tie)
        if abs(f) < least:
            least = abs(f)
            at = s
            phi = value
            s_left = sl
            s_right = sr
        # the end that s takes the place of is the third point
        if f > 0.0:
            third = a
            f3 = fa
            known = known_a
            a = s
            fa = f
            known_a = True
        else:
            third = b
            f3 = fb
            known = known_b
            b = s
            fb = f
            known_b = True
        tight = ROOT_ROUNDING * max(abs(a), abs(b))
        if f == 0.0 or b - a <= 2.0 * tight:
            break
        opposite = b if f > 0.0 else a
        share = 0.5
        if known_a and known_b:
            f2 = fb if f > 0.0 else fa
            share = f / (f - f2)
            if known:
                x = (s - opposite) / (third - opposite)
                y = (f - f2) / (f3 - f2)
                share = 0.5
                if 1.0 - math.sqrt(1.0 - x) < y < math.sqrt(x):
                    share = f / (f2 - f) * f3 / (f2 - f3) + (third - s) / (opposite - s) * f / (f3 - f) * f2 / (f3 - f2)
            share = min(max(share, tight / (b - a)), 1.0 - tight / (b - a))
        new = s + share * (opposite - s)
        if not a < new < b:
            break
        s = new
    return at, phi, s_left, s_right


@inner
def _meet(si, i, j):
    """Whether sites i and j have a vertex in common."""
    return i != j and (si[i, V0] == si[j, V1] or si[i, V1] == si[j, V0])


@inner
def _apart_sq(si, sf, cp, i, s, j, sj):
    """Squared distance of the points at s on site i and at sj on site j."""
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, i, s, 0.0, 0.0)
    qx, qy, tx, ty, k, speed = evaluate(si, sf, cp, j, sj, px, py)
    return qx * qx + qy * qy


@inner
def tie_beside(si, sf, cp, site, s, w_i, left, sl, right, sr, arc, sj, phi, tie):
    """The relative difference of phi up to which `arc`, touched at sj, ties with the contacts at s on a site, left and right.

    Seen from the site, phi of two contacts differs by theta x when the disc moves by x of its size, theta the share of their
    distance D from the site by which they are apart: those of a corner of 1e-6 rad tie within 1e-11 wherever the disc stands
    between its ends. So a tie is as much finer as contacts are nearer to each other, down to the rounding of phi, that of the
    coordinates over |D|^2.
    """
    j = w_i[arc, 0]
    away = _apart_sq(si, sf, cp, site, s, j, sj)
    if away == 0.0:
        return tie
    apart = min(_apart_sq(si, sf, cp, w_i[left, 0], sl, j, sj), _apart_sq(si, sf, cp, w_i[right, 0], sr, j, sj))
    return min(max(tie * math.sqrt(apart / away), PHI_NOISE / (phi * away)), tie)


@inner
def _beside(si, sf, cp, i, s, j, phi):
    """Whether the contact at s on site i of a disc lies where site j begins or ends, as far as that disc can tell.

    They have a vertex in common, or one tiny site between them.
    """
    if _meet(si, i, j):
        return True
    near = BESIDE / phi
    x0, y0, tx, ty, k, speed = evaluate(si, sf, cp, i, s, sf[j, X0], sf[j, Y0])
    x1, y1, tx, ty, k, speed = evaluate(si, sf, cp, i, s, sf[j, X1], sf[j, Y1])
    return min(x0 * x0 + y0 * y0, x1 * x1 + y1 * y1) < near * near


@inner
def solve_at_corner(si, sf, cp, w_i, w_f, left, right, tie, disc, d, s):
    """Solve the node of arcs 0, left, right once more along `left` or `right` if it touches these near each other.

    `disc[d]`, contacts `s` (on arcs 0, left, right). One of the two may be the fan of the vertex, which cannot be walked along.
    Returns which of the contacts the disc was built on: its foot is exact.
    """
    along = right if si[w_i[left, 0], KIND] == FAN else left
    other = left if along == right else right
    i = w_i[along, 0]
    near = STEEP * disc[d, 2]
    if si[i, KIND] == FAN or _apart_sq(si, sf, cp, w_i[left, 0], s[1], w_i[right, 0], s[2]) > near * near:
        return 0
    lo = w_f[along, 0]
    hi = w_f[along, 1]
    if along == left:
        at, phi, s_other, s_0 = partner_change(si, sf, cp, i, lo, hi, w_i, w_f, other, 0, tie)
    else:
        at, phi, s_0, s_other = partner_change(si, sf, cp, i, lo, hi, w_i, w_f, 0, other, tie)
    # where along the wall the disc lies the corner tells best, how large it is the opposite side
    phi, s_0 = touch_arc(si, sf, cp, i, at, w_i, w_f, 0, tie)
    # (an end of arc 0 may tie with the contact inside it: its vertex then is the other one)
    if not K_LOW < phi < math.inf or (not 0.0 < s_0 < 1.0 and 0.0 < s[0] < 1.0):
        return 0
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, i, at, 0.0, 0.0)
    x = px - ty / phi
    y = py + tx / phi
    if math.sqrt((x - disc[d, 0]) ** 2 + (y - disc[d, 1]) ** 2) > 1e-6 / phi:
        return 0
    disc[d, 0] = x
    disc[d, 1] = y
    disc[d, 2] = 1.0 / phi
    s[0] = s_0
    s[1] = at if along == left else s_other
    s[2] = s_other if along == left else at
    return 1 if along == left else 2


@inner
def best_between(si, sf, cp, site, s, w_i, w_f, low, high, phi, tie):
    """The partner among arcs low .. high (both ends left out) with a phi above `phi`: (phi, arc), arc -1 if there is none."""
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, site, s, 0.0, 0.0)
    best = phi
    best_arc = -1
    if not 0.0 < phi < math.inf:
        return best, -1
    r = 1.0 / phi
    for arc in range(low + 1, high):
        j = w_i[arc, 0]
        limit = r + 1e-15
        if box_distance_sq(px - r * ty, py + r * tx, sf[j, XMIN], sf[j, YMIN], sf[j, XMAX], sf[j, YMAX]) >= limit * limit:
            continue
        value, sj = touch_arc(si, sf, cp, site, s, w_i, w_f, arc, tie)
        if value > best:
            best = value
            best_arc = arc
            r = 1.0 / best
    return best, best_arc


@inner
def seen_from(si, sf, cp, w_i, w_f, arc, s, between, phi, tie):
    """phi over `phi` of the disc at s on one arc that touches `between`, which begins beside its contact; 1 if it does not.

    Two arcs that meet at a nearly smooth corner look alike from afar; seen from one of them, the other tells whether a disc
    reaches it.
    """
    i = w_i[arc, 0]
    j = w_i[between, 0]
    if si[i, KIND] == FAN or si[j, KIND] == FAN or s <= 0.0 or s >= 1.0 or not _beside(si, sf, cp, i, s, j, phi):
        return 1.0
    value, sj = touch_arc(si, sf, cp, i, s, w_i, w_f, between, tie)
    return value / phi


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
        ax = q1x / d1 - q0x / d0
        ay = q1y / d1 - q0y / d0
        bx = q2x / d2 - q0x / d0
        by = q2y / d2 - q0y / d0
        det = ax * by - ay * bx
        if abs(det) < PARALLEL:
            return
        e = d1 - d0
        f = d2 - d0
        mx = (e * by - f * ay) / det
        my = (ax * f - bx * e) / det
        move = math.sqrt(mx * mx + my * my)
        if move > 1e-7 * d0 or move > LEVER * miss:
            return
        cx += mx
        cy += my


@inner
def adopt(si, sf, cp, site, s, lo, hi, w_i, k, left, right, disc, d):
    """Make disc d of arcs 0, left, right one that closes these, if that touches all three as well as coordinates tell.

    Three neighbouring edges of a polygon of 100,000 tell the radius of their disc to 1e-8 only: it may lie beyond the centre.
    Where its feet run together, at a vertex between the three, say, that they are touched tells nothing; nor does a foot on a
    convex vertex, where no disc touches. The contacts become the feet of the disc taken.
    """
    near = STEEP * disc[d, 2]
    for m in range(1, 3):
        if _apart_sq(si, sf, cp, site[0], s[0], site[m], s[m]) > near * near:
            return
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
            if m > 0:
                wide = _apart_sq(si, sf, cp, site[0], f0, site[m], foot)
                fit &= wide >= AS_WIDE * AS_WIDE * _apart_sq(si, sf, cp, site[0], s[0], site[m], s[m])
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


@inner
def farther_phi(si, sf, cp, site, s, phi, w_i, w_f, left, sl, right, sr, tie):
    """phi at s on a site, which arcs left and right agree on, by the one that tells it better.

    That of a contact at D has an error of some 1e-16 / (phi |D|), relatively: if one is near, the other one has the better value.
    """
    if not 0.0 < phi < math.inf:
        return phi
    to_left = _apart_sq(si, sf, cp, site, s, w_i[left, 0], sl)
    to_right = _apart_sq(si, sf, cp, site, s, w_i[right, 0], sr)
    if min(to_left, to_right) * phi * phi < STEEP * STEEP:
        phi, sj = touch_arc(si, sf, cp, site, s, w_i, w_f, left if to_left > to_right else right, tie)
    return phi
