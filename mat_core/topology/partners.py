"""Which arc of a face the maximal disc at a point of arc 0 touches, and where along arc 0 that changes.

A face in the work buffer is a row for each arc: ints (site, disc that closes it towards the next arc), floats (lo, hi); see
`topology.branches`. From far away two arcs that meet at a nearly smooth corner look alike, and contacts that are near each other
tie: what one of them sees of the other, relative to their common vertex, tells them apart.
"""

from __future__ import annotations

import math

from mat_core.kernels.boxtree import box_distance_sq
from mat_core.kernels.curve import evaluate
from mat_core.kernels.disc import touch_from
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, FAN, KIND, NEXT, PREV, V0, V1, X0, X1, XMAX, XMIN, Y0, Y1, YMAX, YMIN
from mat_core.topology.discs import BESIDE

ROOT_STEPS = 120
ROOT_ROUNDING = 2e-16  # of a parameter
YIELD = 4.0  # ties
STEEP = 0.01  # radii between two contacts, within which phi of one seen from the other loses digits
PHI_NOISE = 8e-15  # of phi |D|^2 at a contact at D: thirty-two roundings of a coordinate


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
def _at_fan(si, j, sj, i):
    """Whether the contact at sj on site j is the reflex vertex whose fan is site i."""
    return si[i, KIND] == FAN and (sj <= 0.0 and si[j, V0] == si[i, V0] or sj >= 1.0 and si[j, V1] == si[i, V0])


@inner
def _difference(si, sf, cp, site, s, w_i, w_f, left, right, tie):
    """(phi_left - phi_right) scaled to [-1, 1], and both contacts.

    Where both are one reflex vertex its fan wins, and clearly: by a tie only, it would look like the place where they change.
    """
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
    if f > 0.0 and _at_fan(si, w_i[right, 0], sb, w_i[left, 0]):
        f = 1.0
    elif f < 0.0 and _at_fan(si, w_i[left, 0], sa, w_i[right, 0]):
        f = -1.0
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
def apart_sq(si, sf, cp, i, s, j, sj):
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
    away = apart_sq(si, sf, cp, site, s, j, sj)
    if away == 0.0:
        return tie
    apart = min(apart_sq(si, sf, cp, w_i[left, 0], sl, j, sj), apart_sq(si, sf, cp, w_i[right, 0], sr, j, sj))
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
def best_between(si, sf, cp, site, s, w_i, w_f, low, high, phi, tie):
    """The partner among arcs low .. high (both ends left out) with a phi above `phi`: (phi, arc), arc -1 if there is none.

    A reflex vertex whose fan is low or high is no other partner, whatever rounding makes of it.
    """
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
        if value > best and not (_at_fan(si, j, sj, w_i[low, 0]) or _at_fan(si, j, sj, w_i[high, 0])):
            best = value
            best_arc = arc
            r = 1.0 / best
    return best, best_arc


@inner
def farther_phi(si, sf, cp, site, s, phi, w_i, w_f, left, sl, right, sr, tie):
    """phi at s on a site, which arcs left and right agree on, by the one that tells it better.

    That of a contact at D has an error of some 1e-16 / (phi |D|), relatively: if one is near, the other one has the better value.
    """
    if not 0.0 < phi < math.inf:
        return phi
    to_left = apart_sq(si, sf, cp, site, s, w_i[left, 0], sl)
    to_right = apart_sq(si, sf, cp, site, s, w_i[right, 0], sr)
    if min(to_left, to_right) * phi * phi < STEEP * STEEP:
        phi, sj = touch_arc(si, sf, cp, site, s, w_i, w_f, left if to_left > to_right else right, tie)
    return phi
