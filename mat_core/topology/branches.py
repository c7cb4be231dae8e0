"""Solve the branch points inside the faces.

Walk along one arc of a face, arc 0: the maximal disc there touches first the arc before it (k-1), in the end the arc after it
(1), and in between, because the axis is a planar tree, arcs of falling number. Where the partner changes from j to j' < j there
is a branch point, the disc with contacts on arc 0, arc j and arc j':

    1. the root s of phi_j(s) - phi_j'(s); the signs at the ends of its bracket are known, it is never evaluated there
    2. if another arc in between has a larger phi at s, it splits the bracket in two
    3. otherwise the disc is a node; arcs in between that tie with it and are touched inside are contacts too (4-way, n-way)

From far away two arcs that meet at a nearly smooth corner look alike: there the root is solved once more along one of them, where
the other one's phi is taken relative to their common vertex.

The nodes along arc 0 cut the face into strips on arc 0 and smaller faces that no longer contain it.

A face in the work buffer is a row for each arc: ints (site, disc that closes it towards the next arc), floats (lo, hi).
"""

from __future__ import annotations

import math

from mat_core.kernels.boxtree import box_distance_sq
from mat_core.kernels.curve import evaluate, site_frame
from mat_core.kernels.disc import touch_from
from mat_core.kernels.jit import inner, jit
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
    XMAX,
    XMIN,
    Y0,
    YMAX,
    YMIN,
)
from mat_core.topology.discs import K_LOW, NO_PARTNER, OK, TOO_SMALL
from mat_core.topology.split import MANY, find_split, split_face

ROOT_STEPS = 120
YIELD = 4.0  # ties
CONCENTRIC = 1e-6  # a centre this near to that of curvature, relative to its radius, moves its nearest point by rounding alone
FOOT_STEPS = 40
POLISH_STEPS = 6
LEVER = 1e4  # a step this many times what it mends goes where two contacts that nearly are one leave the disc free
CLEARLY = 1e-6  # relative difference of curvatures seen across a nearly smooth corner that is no rounding
SETTLED = 1e-15  # distances of a centre that agree so well leave nothing to polish
CURVED = 8.0  # a curved arc is walked along rather than a straight one this much longer: its partners are better told apart
PARALLEL = 1e-7  # determinant of three contact directions below which a disc is not polished


@inner
def _touch_arc(si, sf, cp, site, s, w_i, w_f, arc, tie):
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
    a, sa = _touch_arc(si, sf, cp, site, s, w_i, w_f, left, tie)
    b, sb = _touch_arc(si, sf, cp, site, s, w_i, w_f, right, tie)
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
def _root(si, sf, cp, site, lo, hi, w_i, w_f, left, right, tie):
    """(s, phi, s_left, s_right) where the partner changes from `left` (wins at lo) to `right` (wins at hi)."""
    a = lo
    b = hi
    fa = fb = 0.0
    known_a = known_b = False
    s = 0.5 * (a + b)
    side = 0
    for step in range(ROOT_STEPS):
        f, phi, sl, sr = _difference(si, sf, cp, site, s, w_i, w_f, left, right, tie)
        if f > 0.0:
            a = s
            fa = f
            known_a = True
            if side == 1 and known_b:
                fb *= 0.5
            side = 1
        elif f < 0.0:
            b = s
            fb = f
            known_b = True
            if side == -1 and known_a:
                fa *= 0.5
            side = -1
        if f == 0.0 or b - a <= 2e-16 * max(abs(a), abs(b)):
            break
        new = 0.5 * (a + b)
        if known_a and known_b and step % 4 != 3:
            new = a + (b - a) * (fa / (fa - fb))
            if not a < new < b:
                new = 0.5 * (a + b)
        if not a < new < b:
            break
        s = new
    f, phi, sl, sr = _difference(si, sf, cp, site, s, w_i, w_f, left, right, tie)
    return s, phi, sl, sr


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
def _common_end(si, i, j):
    """0 or 1 when pieces i and j meet at the start or at the end of i, else -1."""
    if si[i, KIND] == FAN or si[j, KIND] == FAN or not _meet(si, i, j):
        return -1
    return 0 if si[i, V0] == si[j, V1] else 1


@inner
def _root_at_corner(si, sf, cp, w_i, w_f, left, right, tie, disc, d, s):
    """Solve the node of arcs 0, left, right once more along `left` or `right` if these meet at a vertex.

    `disc[d]`, contacts `s` (on arcs 0, left, right). One of the two may be the fan of the vertex, which cannot be walked along.
    """
    along = right if si[w_i[left, 0], KIND] == FAN else left
    other = left if along == right else right
    i = w_i[along, 0]
    if si[i, KIND] == FAN or not _meet(si, i, w_i[other, 0]):
        return
    lo = w_f[along, 0]
    hi = w_f[along, 1]
    if si[i, V0] == si[w_i[other, 0], V1]:
        at, phi, s_other, s_0 = _root(si, sf, cp, i, lo, hi, w_i, w_f, other, 0, tie)
    else:
        at, phi, s_0, s_other = _root(si, sf, cp, i, lo, hi, w_i, w_f, 0, other, tie)
    # where along the wall the disc lies the corner tells best, how large it is the opposite side
    phi, s_0 = _touch_arc(si, sf, cp, i, at, w_i, w_f, 0, tie)
    if not K_LOW < phi < math.inf:
        return
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, i, at, 0.0, 0.0)
    x = px - ty / phi
    y = py + tx / phi
    if math.sqrt((x - disc[d, 0]) ** 2 + (y - disc[d, 1]) ** 2) > 1e-6 / phi:
        return
    disc[d, 0] = x
    disc[d, 1] = y
    disc[d, 2] = 1.0 / phi
    s[0] = s_0
    s[1] = at if along == left else s_other
    s[2] = s_other if along == left else at


@inner
def _best_between(si, sf, cp, site, s, w_i, w_f, low, high, phi, tie):
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
        value, sj = _touch_arc(si, sf, cp, site, s, w_i, w_f, arc, tie)
        if value > best:
            best = value
            best_arc = arc
            r = 1.0 / best
    return best, best_arc


@inner
def _seen_from(si, sf, cp, w_i, w_f, arc, s, between, phi, tie):
    """phi over `phi` of the disc at s on one arc that touches `between`, which begins where the arc ends; 1 if it does not.

    Two arcs that meet at a nearly smooth corner look alike from afar; seen from one of them, the other tells whether a disc
    reaches it.
    """
    i = w_i[arc, 0]
    if _common_end(si, i, w_i[between, 0]) < 0 or s <= 0.0 or s >= 1.0:
        return 1.0
    value, sj = _touch_arc(si, sf, cp, i, s, w_i, w_f, between, tie)
    return value / phi


@inner
def _length(si, sf, disc, w_i, w_f, arc):
    """How far the disc travels along an arc, roughly: decides which arc is walked along."""
    site = w_i[arc, 0]
    share = w_f[arc, 1] - w_f[arc, 0]
    if si[site, KIND] == FAN:
        return 0.25 * abs(sf[site, SWEEP]) * disc[w_i[arc, 1], 2] * share
    return sf[site, LEN] * share * (1.0 if si[site, KIND] == LINE else CURVED)


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
        if abs(slope) < CONCENTRIC * speed:
            break
        new = s - g / slope if slope > 0.0 else 0.5 * (a + b)
        if not a < new < b:
            new = 0.5 * (a + b)
        if abs(new - s) <= 1e-16 or not a < new < b:
            break
        s = new
    return s


@inner
def _polish(si, sf, cp, site, s, lo, hi, disc, d):
    """Newton for the disc that touches three given parts: m_m . dc - dr = r - |c - q_m|, q_m the feet of c, m_m towards c.

    Kept if it brings the disc nearer to touching all three.
    """
    best = math.inf
    cx = disc[d, 0]
    cy = disc[d, 1]
    f0 = s[0]
    f1 = s[1]
    f2 = s[2]
    for step in range(POLISH_STEPS):
        if step > 0:
            f0 = _foot(si, sf, cp, site[0], f0, lo[0], hi[0], cx, cy)
            f1 = _foot(si, sf, cp, site[1], f1, lo[1], hi[1], cx, cy)
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
def walk_arc(si, sf, cp, w_i, w_f, k, tie, disc, n_discs, contacts_i, contacts_s, n_contacts, node_first, bracket_i, bracket_f,
             tri_site, tri_s, tri_lo, tri_hi):
    """Find the nodes along arc 0 of the face in the work buffer, in the order in which they lie on it.

    New discs go to `disc` from row n_discs on, their contacts (arc of the face; s) to `contacts_i`, `contacts_s` from row
    n_contacts on, by falling arc number with arc 0 first; `node_first[m]` is the first contact of the m-th node.
    Returns (status, nodes).
    """
    site = w_i[0, 0]
    nodes = 0
    top = 0
    bracket_i[0, 0] = k - 1
    bracket_i[0, 1] = 1
    bracket_f[0, 0] = w_f[0, 0]
    bracket_f[0, 1] = w_f[0, 1]
    node_first[0] = n_contacts
    while top >= 0:
        left = bracket_i[top, 0]
        right = bracket_i[top, 1]
        lo = bracket_f[top, 0]
        hi = bracket_f[top, 1]
        s, phi, sl, sr = _root(si, sf, cp, site, lo, hi, w_i, w_f, left, right, tie)
        # beside a vertex of both, phi is steep: the contact that is farther away has the better value
        beside_left = _meet(si, site, w_i[left, 0])
        beside_right = _meet(si, site, w_i[right, 0])
        if beside_left and beside_right:
            beside_left = _apart_sq(si, sf, cp, site, s, w_i[left, 0], sl) < _apart_sq(si, sf, cp, site, s, w_i[right, 0], sr)
            beside_right = not beside_left
        if beside_left or beside_right:
            phi = _touch_arc(si, sf, cp, site, s, w_i, w_f, right if beside_left else left, tie)[0]
        # both may lie behind the tangent at s, where a third arc wins: no disc is larger than K_LOW allows
        least = max(phi, K_LOW)
        better, arc = _best_between(si, sf, cp, site, s, w_i, w_f, right, left, least, tie)
        if phi < K_LOW and arc < 0:
            return NO_PARTNER, nodes
        if arc >= 0 and better > least * (1.0 + tie):
            # the far half waits below, the near half is done first
            if top + 2 >= bracket_i.shape[0]:
                return TOO_SMALL, nodes
            bracket_i[top, 0] = arc
            bracket_i[top, 1] = right
            bracket_f[top, 0] = s
            bracket_f[top, 1] = hi
            top += 1
            bracket_i[top, 0] = left
            bracket_i[top, 1] = arc
            bracket_f[top, 0] = lo
            bracket_f[top, 1] = s
            continue
        beside = -1
        if left - 1 > right and _seen_from(si, sf, cp, w_i, w_f, left, sl, left - 1, phi, tie) > 1.0 + CLEARLY:
            beside = left - 1
        elif left - 1 > right and _seen_from(si, sf, cp, w_i, w_f, right, sr, right + 1, phi, tie) > 1.0 + CLEARLY:
            beside = right + 1
        if beside >= 0:
            if top + 2 >= bracket_i.shape[0]:
                return TOO_SMALL, nodes
            bracket_i[top, 0] = beside
            bracket_i[top, 1] = right
            bracket_f[top, 0] = s
            bracket_f[top, 1] = hi
            top += 1
            bracket_i[top, 0] = left
            bracket_i[top, 1] = beside
            bracket_f[top, 0] = lo
            bracket_f[top, 1] = s
            continue
        top -= 1
        d = n_discs + nodes
        if d >= disc.shape[0] or n_contacts + left - right + 2 > contacts_i.shape[0]:
            return TOO_SMALL, nodes
        px, py, tx, ty, curvature, speed = evaluate(si, sf, cp, site, s, 0.0, 0.0)
        disc[d, 0] = px - ty / phi
        disc[d, 1] = py + tx / phi
        disc[d, 2] = 1.0 / phi
        for m in range(3):
            arc_m = 0 if m == 0 else (left if m == 1 else right)
            tri_site[m] = w_i[arc_m, 0]
            tri_s[m] = s if m == 0 else (sl if m == 1 else sr)
            tri_lo[m] = w_f[arc_m, 0]
            tri_hi[m] = w_f[arc_m, 1]
        tri_lo[0] = lo
        tri_hi[0] = hi
        _root_at_corner(si, sf, cp, w_i, w_f, left, right, tie, disc, d, tri_s)
        _polish(si, sf, cp, tri_site, tri_s, tri_lo, tri_hi, disc, d)
        contacts_i[n_contacts] = 0
        contacts_s[n_contacts] = tri_s[0]
        contacts_i[n_contacts + 1] = left
        contacts_s[n_contacts + 1] = tri_s[1]
        n_contacts += 2
        # ties: touched strictly inside (at an end the disc that closes the arc there is the same disc; the graph unites them)
        r = 1.0 / phi
        for between in range(left - 1, right, -1):
            j = w_i[between, 0]
            limit = r * (1.0 + 2.0 * tie) + 1e-15
            if box_distance_sq(disc[d, 0], disc[d, 1], sf[j, XMIN], sf[j, YMIN], sf[j, XMAX], sf[j, YMAX]) > limit * limit:
                continue
            value, sj = _touch_arc(si, sf, cp, site, s, w_i, w_f, between, tie)
            if between == left - 1 and abs(_seen_from(si, sf, cp, w_i, w_f, left, sl, between, phi, tie) - 1.0) > CLEARLY:
                continue
            if between == right + 1 and abs(_seen_from(si, sf, cp, w_i, w_f, right, sr, between, phi, tie) - 1.0) > CLEARLY:
                continue
            if value >= phi * (1.0 - tie) and w_f[between, 0] < sj < w_f[between, 1]:
                contacts_i[n_contacts] = between
                contacts_s[n_contacts] = sj
                n_contacts += 1
        contacts_i[n_contacts] = right
        contacts_s[n_contacts] = tri_s[2]
        n_contacts += 1
        nodes += 1
        node_first[nodes] = n_contacts
    return OK, nodes


@inner
def _emit_strip(strip_i, strip_s, n, site_a, a0, a1, site_b, b0, b1, disc0, disc1):
    """Write one strip: right side site_a from a0 up to a1, left side site_b from b0 down to b1."""
    strip_i[n, 0] = site_a
    strip_i[n, 1] = site_b
    strip_i[n, 2] = disc0
    strip_i[n, 3] = disc1
    strip_s[n, 0] = a0
    strip_s[n, 1] = a1
    strip_s[n, 2] = b0
    strip_s[n, 3] = b1
    return n + 1


@jit
def solve_faces(si, sf, cp, tree, stack, tie, face_start, stack_i, stack_f, disc, n_discs, disc_of, contact_site, contact_s,
                n_contacts, strip_i, strip_s, whole_i, whole_s, w_i, w_f, contacts_i, contacts_s, node_first, bracket_i,
                bracket_f, tri_site, tri_s, tri_lo, tri_hi):
    """Resolve every face into strips; returns (status, discs, contacts, strips, whole contacts, place).

    The faces stand one after the other in `stack_i` (site, closing disc) and `stack_f` (lo, hi), bounded by `face_start`
    (rows 0 .. faces); smaller faces are put where the larger one stood. A face of many arcs is halved by a disc first. New
    contacts are appended to disc_of, contact_site, contact_s. `place` is a site near the trouble when the status is not OK.
    """
    n_strips = 0
    n_whole = 0
    top = face_start.shape[0] - 1
    while face_start[top] < 0:
        top -= 1
    faces = top
    while faces > 0:
        begin = face_start[faces - 1]
        k = face_start[faces] - begin
        if k == 1:
            whole_i[n_whole, 0] = stack_i[begin, 0]
            whole_i[n_whole, 1] = stack_i[begin, 1]
            whole_s[n_whole, 0] = stack_f[begin, 0]
            whole_s[n_whole, 1] = stack_f[begin, 1]
            n_whole += 1
            faces -= 1
            continue
        if k == 2:
            # disc after arc 1 -> disc after arc 0
            n_strips = _emit_strip(strip_i, strip_s, n_strips, stack_i[begin, 0], stack_f[begin, 0], stack_f[begin, 1],
                                   stack_i[begin + 1, 0], stack_f[begin + 1, 1], stack_f[begin + 1, 0],
                                   stack_i[begin + 1, 1], stack_i[begin, 1])
            faces -= 1
            continue
        if k > MANY and faces + 2 < face_start.shape[0] and begin + k + 2 <= stack_i.shape[0]:
            low, low_s, high, high_s, x, y, r = find_split(si, sf, cp, tree, stack, stack_i, stack_f, begin, k)
            if low >= 0:
                if n_discs >= disc.shape[0] or n_contacts + 2 > contact_site.shape[0]:
                    return TOO_SMALL, n_discs, n_contacts, n_strips, n_whole, stack_i[begin, 0]
                disc[n_discs, 0] = x
                disc[n_discs, 1] = y
                disc[n_discs, 2] = r
                for end in range(2):
                    disc_of[n_contacts + end] = n_discs
                    contact_site[n_contacts + end] = stack_i[begin + (low if end == 0 else high), 0]
                    contact_s[n_contacts + end] = low_s if end == 0 else high_s
                face_start[faces] = split_face(stack_i, stack_f, w_i, w_f, begin, k, low, low_s, high, high_s, n_discs)
                faces += 1
                face_start[faces] = begin + k + 2
                n_contacts += 2
                n_discs += 1
                continue
        # arc 0 of the work buffer is the longest one
        longest = 0
        best = -1.0
        for arc in range(k):
            length = _length(si, sf, disc, stack_i, stack_f, begin + arc)
            if length > best:
                best = length
                longest = arc
        for arc in range(k):
            source = begin + (longest + arc) % k
            w_i[arc, 0] = stack_i[source, 0]
            w_i[arc, 1] = stack_i[source, 1]
            w_f[arc, 0] = stack_f[source, 0]
            w_f[arc, 1] = stack_f[source, 1]
        faces -= 1
        status, nodes = walk_arc(si, sf, cp, w_i, w_f, k, tie, disc, n_discs, contacts_i, contacts_s, 0, node_first,
                                 bracket_i, bracket_f, tri_site, tri_s, tri_lo, tri_hi)
        if status != OK:
            return status, n_discs, n_contacts, n_strips, n_whole, w_i[0, 0]
        # contacts on one arc come in order: later nodes touch an arc before earlier ones
        for m in range(nodes):
            first = node_first[m]
            if m > 0:
                contacts_s[first] = max(contacts_s[first], contacts_s[node_first[m - 1]])
                contacts_s[first + 1] = min(contacts_s[first + 1], contacts_s[node_first[m] - 1])
            for c in range(first, node_first[m + 1]):
                disc_of[n_contacts] = n_discs + m
                at_end = contacts_s[c] >= 1.0
                contact_site[n_contacts] = si[w_i[contacts_i[c], 0], NEXT] if at_end else w_i[contacts_i[c], 0]
                contact_s[n_contacts] = 0.0 if at_end else contacts_s[c]
                n_contacts += 1
        # strips on arc 0
        lo = w_f[0, 0]
        before = w_i[k - 1, 1]
        partner = k - 1
        partner_from = w_f[k - 1, 1]
        for m in range(nodes):
            first = node_first[m]
            n_strips = _emit_strip(strip_i, strip_s, n_strips, w_i[0, 0], lo, contacts_s[first], w_i[partner, 0], partner_from,
                                   contacts_s[first + 1], before, n_discs + m)
            lo = contacts_s[first]
            before = n_discs + m
            partner = contacts_i[node_first[m + 1] - 1]
            partner_from = contacts_s[node_first[m + 1] - 1]
        n_strips = _emit_strip(strip_i, strip_s, n_strips, w_i[0, 0], lo, w_f[0, 1], w_i[1, 0], partner_from, w_f[1, 0], before,
                               w_i[0, 1])
        # smaller faces between neighbouring contacts of each node
        end = begin
        for m in range(nodes):
            for c in range(node_first[m] + 1, node_first[m + 1] - 1):
                high = contacts_i[c]
                low = contacts_i[c + 1]
                if end + high - low + 1 > stack_i.shape[0] or faces + 2 > face_start.shape[0]:
                    return TOO_SMALL, n_discs, n_contacts, n_strips, n_whole, w_i[0, 0]
                for arc in range(low, high + 1):
                    stack_i[end, 0] = w_i[arc, 0]
                    stack_i[end, 1] = w_i[arc, 1] if arc < high else n_discs + m
                    stack_f[end, 0] = contacts_s[c + 1] if arc == low else w_f[arc, 0]
                    stack_f[end, 1] = contacts_s[c] if arc == high else w_f[arc, 1]
                    end += 1
                faces += 1
                face_start[faces] = end
        n_discs += nodes
    return OK, n_discs, n_contacts, n_strips, n_whole, -1
