"""One maximal disc at every joint of the boundary, found by one global query each, whatever their order.

A joint (the start of site j, written (j, 0)) is either a convex vertex (leaf, r = 0), or its own curvature wins against all
other sites (leaf: centre of curvature; or a whole circular arc in contact), or the disc touches another site, the winner.
A boundary point has exactly one maximal disc; discs found from different contacts that are the same disc are united:

    same place        the winner is the very joint that another disc was found from
    same disc         the winner's site ends at a joint whose disc has this centre and radius (a disc touches a site once)
    crossed contacts  the contacts of two nearly equal discs interleave around their centre: both cannot be maximal
"""

from __future__ import annotations

import math

from mat_core.kernels.boxtree import query
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import (
    ARC,
    ARC_CONTACT,
    CONVEX_VERTEX,
    CORNER,
    CURVATURE_LEAF,
    FAN,
    K0,
    K1,
    KIND,
    LEN,
    LOOP,
    NEXT,
    PREV,
    SWEEP,
    THROUGH,
    TX0,
    TX1,
    TY0,
    TY1,
    V0,
    V1,
    VERTEX_LEAF,
    X0,
    Y0,
)

OWN_RELATIVE = 1e-13  # own curvature wins on a spiral when no other site is better by more than rounding
COORDINATE = 2.3e-16  # rounding of a normalised coordinate
FLATTEST = 1e-7  # no arc's circle is believed to be worse than this
ANGLE_NEAR = 1e-5  # contacts nearer than this around a centre are ordered along the boundary, not by angle
K_LOW = 1.9  # no disc in a domain of size at most 1 has a radius over 1/2

OK, NO_PARTNER, TOO_SMALL = 0, 1, 2


@inner
def joint_normal(si, sf, j):
    """Inward unit normal at the start of site j; the mean of both sides at a smooth joint."""
    before = si[j, PREV]
    if si[j, KIND] == FAN:
        tx = sf[before, TX1]
        ty = sf[before, TY1]
    elif si[before, KIND] == FAN:
        tx = sf[j, TX0]
        ty = sf[j, TY0]
    else:
        tx = sf[before, TX1] + sf[j, TX0]
        ty = sf[before, TY1] + sf[j, TY0]
        length = math.sqrt(tx * tx + ty * ty)
        tx /= length
        ty /= length
    return -ty, tx


@inner
def _grows(at_joint, far):
    """Curvature grows from the joint along a monotone piece, beyond rounding."""
    return far - at_joint > 1e-12 * abs(at_joint)


@inner
def _phi_noise(si, sf, cp, j, winner, s):
    """Rounding of phi at a contact of the disc at joint j: that of the coordinates over the squared distance.

    Nothing where the contact's site meets the joint: it is taken relative to that.
    """
    if winner < 0 or si[winner, V0] == si[j, V0] or si[winner, V1] == si[j, V0]:
        return 0.0
    dx, dy, tx, ty, k, speed = evaluate(si, sf, cp, winner, s, sf[j, X0], sf[j, Y0])
    return 2.0 * COORDINATE / (dx * dx + dy * dy)


@inner
def _arc_noise(sf, i):
    """Relative rounding of the radius of a circular arc: that of the coordinates over the arc's height, length^2 / (8 r)."""
    flat = sf[i, K0] * sf[i, LEN]
    return min(16.0 * COORDINATE / (flat * flat), FLATTEST)


@inner
def joint_disc(si, sf, cp, tree, stack, j, hint, tie, disc, whole):
    """(status, kind, x, y, r, winner, s): the maximal disc at the start of site j.

    Row `whole` of `disc` is one that touches along an arc (-1: none is known yet): an arc on the same circle touches it, too.
    Without it each tooth of a gear would ask all other teeth.

    kind THROUGH: it touches `winner` at s; VERTEX_LEAF; CURVATURE_LEAF; ARC_CONTACT: winner is 1 if the arc that starts here
    is in contact, 2 if the one that ends here, 3 if both are (one circle).
    """
    px = sf[j, X0]
    py = sf[j, Y0]
    if si[j, CORNER] == CONVEX_VERTEX:
        return OK, VERTEX_LEAF, px, py, 0.0, -1, 0.0
    before = si[j, PREV]
    nx, ny = joint_normal(si, sf, j)
    kl = sf[before, K1]
    kr = sf[j, K0]
    own = max(kl, kr)
    left = kl >= own - 1e-9 * abs(own)
    right = kr >= own - 1e-9 * abs(own)
    arcs = (1 if right and si[j, KIND] == ARC else 0) + (2 if left and si[before, KIND] == ARC else 0)
    rough = max(_arc_noise(sf, j) if arcs & 1 else 0.0, _arc_noise(sf, before) if arcs & 2 else 0.0)
    if arcs > 0 and own > 0.0 and whole >= 0:
        r = 1.0 / own
        off = math.sqrt((px + r * nx - disc[whole, 0]) ** 2 + (py + r * ny - disc[whole, 1]) ** 2) + abs(r - disc[whole, 2])
        if off <= max(0.25 * tie, 2.0 * rough) * r:
            return OK, ARC_CONTACT, px + r * nx, py + r * ny, r, arcs, 0.0
    phi, winner, s = query(si, sf, cp, tree, stack, j, 0.0, nx, ny, before, hint, K_LOW)
    if arcs > 0 and own >= phi * (1.0 - max(tie, 2.0 * rough)):
        return OK, ARC_CONTACT, px + nx / own, py + ny / own, 1.0 / own, arcs, 0.0
    noise = _phi_noise(si, sf, cp, j, winner, s)
    # an osculating disc that touches elsewhere as well is no leaf: the branch to it has no length
    elsewhere = 0.0 < noise < tie * own and phi >= own * (1.0 - tie)
    if own >= phi * (1.0 - OWN_RELATIVE) - noise and not elsewhere:
        grows = (left and _grows(kl, sf[before, K0])) or (right and _grows(kr, sf[j, K1]))
        if not grows or winner < 0:
            return OK, CURVATURE_LEAF, px + nx / own, py + ny / own, 1.0 / own, -1, 0.0
    if winner < 0:
        return NO_PARTNER, THROUGH, px, py, 0.0, -1, 0.0
    return OK, THROUGH, px + nx / phi, py + ny / phi, 1.0 / phi, winner, s


@jit
def all_joint_discs(si, sf, cp, tree, stack, tie, disc, kind, winner, winner_s):
    """`joint_disc` for every site's start; returns (status, joint)."""
    hint = -1
    whole = -1
    for j in range(si.shape[0]):
        status, kind[j], x, y, r, winner[j], winner_s[j] = joint_disc(si, sf, cp, tree, stack, j, hint, tie, disc, whole)
        if kind[j] == ARC_CONTACT:
            whole = j
        disc[j, 0] = x
        disc[j, 1] = y
        disc[j, 2] = r
        if status != OK:
            return status, j
        hint = winner[j] if kind[j] == THROUGH else -1
    return OK, -1


@jit
def find(parent, a):
    """Root of a in a union-find forest, halving the path."""
    while parent[a] != a:
        parent[a] = parent[parent[a]]
        a = parent[a]
    return a


@inner
def unite(parent, a, b):
    """Join the trees of a and b; the smaller root stays."""
    a = find(parent, a)
    b = find(parent, b)
    if a < b:
        parent[b] = a
    elif b < a:
        parent[a] = b


@inner
def rightmost(si, sf, cp, first, last):
    """(x, site, s) of the point with the largest x on the sites first .. last-1: its outward normal is (1, 0).

    On a FAN s is where the normal passes (1, 0); on a piece where the tangent is vertical.
    """
    best = -math.inf
    best_site = -1
    best_s = 0.0
    for i in range(first, last):
        if si[i, KIND] == FAN:
            # normals turn clockwise by |SWEEP| from that of the start: is (1, 0) among them?
            turn = math.atan2(sf[i, TX0], -sf[i, TY0])  # from (1, 0) anticlockwise to the first normal
            s = turn / -sf[i, SWEEP]
            if -1e-9 <= s <= 1.0 + 1e-9 and sf[i, X0] > best:
                best = sf[i, X0]
                best_site = i
                best_s = min(max(s, 0.0), 1.0)
            continue
        if sf[i, X0] > best:
            best = sf[i, X0]
            best_site = i
            best_s = 0.0
        if sf[i, TX0] * sf[i, TX1] < 0.0:
            lo = 0.0
            hi = 1.0
            for _ in range(60):
                m = 0.5 * (lo + hi)
                dx, dy, tx, ty, k, speed = evaluate(si, sf, cp, i, m, 0.0, 0.0)
                if tx * sf[i, TX0] > 0.0:
                    lo = m
                else:
                    hi = m
            dx, dy, tx, ty, k, speed = evaluate(si, sf, cp, i, 0.5 * (lo + hi), 0.0, 0.0)
            if dx > best:
                best = dx
                best_site = i
                best_s = 0.5 * (lo + hi)
    return best, best_site, best_s


@jit
def connect_loops(si, sf, cp, tree, stack, loop_start, kind, winner, loop_parent, right, right_site, extra,
                  extra_site):
    """Discs that join loops no joint disc joins; returns (status, how many).

    The disc at the rightmost point of a group of loops lies right of all of them, so it touches another group: after at most one
    disc a hole all loops are connected. Rows of `extra`: x, y, r, s, s_winner; of `extra_site`: site, winner.
    """
    n_loops = loop_start.shape[0] - 1
    for loop in range(n_loops):
        loop_parent[loop] = loop
    for j in range(si.shape[0]):
        if kind[j] == THROUGH:
            unite(loop_parent, si[j, LOOP], si[winner[j], LOOP])
    # the rightmost point of each group stands at its root
    for loop in range(1, n_loops):
        x, site, s = rightmost(si, sf, cp, loop_start[loop], loop_start[loop + 1])
        right[loop, 0] = x
        right[loop, 1] = s
        right_site[loop] = site
    for loop in range(1, n_loops):
        _keep_rightmost(right, right_site, find(loop_parent, loop), loop)
    count = 0
    for group in range(1, n_loops):
        # until it hangs on a smaller one: in the end all hang on loop 0
        while find(loop_parent, group) == group:
            site = right_site[group]
            s = right[group, 1]
            px, py, tx, ty, k, speed = evaluate(si, sf, cp, site, s, 0.0, 0.0)
            skip = si[site, PREV] if s == 0.0 else -1
            phi, w, sw = query(si, sf, cp, tree, stack, site, s, -ty, tx, skip, -1, K_LOW)
            if w < 0 or find(loop_parent, si[w, LOOP]) == group:
                return NO_PARTNER, count
            other = find(loop_parent, si[w, LOOP])
            unite(loop_parent, group, other)
            _keep_rightmost(right, right_site, min(group, other), max(group, other))
            extra[count, 0] = px - ty / phi
            extra[count, 1] = py + tx / phi
            extra[count, 2] = 1.0 / phi
            extra[count, 3] = s
            extra[count, 4] = sw
            extra_site[count, 0] = site
            extra_site[count, 1] = w
            count += 1
    return OK, count


@inner
def _keep_rightmost(right, right_site, root, member):
    """The rightmost point of `member` becomes that of `root` if it lies further right; loop 0 needs none."""
    if root > 0 and right[member, 0] > right[root, 0]:
        right[root, 0] = right[member, 0]
        right[root, 1] = right[member, 1]
        right_site[root] = right_site[member]


@jit
def same_disc(disc, a, b, tolerance):
    """Centre and radius agree."""
    dx = disc[a, 0] - disc[b, 0]
    dy = disc[a, 1] - disc[b, 1]
    return math.sqrt(dx * dx + dy * dy) + abs(disc[a, 2] - disc[b, 2]) <= tolerance


@jit
def unite_at_joints(si, disc, kind, winner, winner_s, parent, alive, tight, loose):
    """Unite discs whose winner is another joint (exactly, or by disc identity), and chains of arcs on one circle.

    `alive[d]` becomes False where the winner of disc d is the contact of another disc's joint.
    """
    n = si.shape[0]
    for d in range(n):
        alive[d] = kind[d] == THROUGH
        if kind[d] == ARC_CONTACT:
            if winner[d] & 1 and same_disc(disc, d, si[d, NEXT], loose):
                unite(parent, d, si[d, NEXT])
            if winner[d] & 2 and same_disc(disc, d, si[d, PREV], loose):
                unite(parent, d, si[d, PREV])
            continue
        if kind[d] != THROUGH:
            continue
        w = winner[d]
        s = winner_s[d]
        for end in range(2):
            joint = w if end == 0 else si[w, NEXT]
            exact = (s <= 0.0 and end == 0) or (s >= 1.0 and end == 1)
            leaf = kind[joint] == VERTEX_LEAF or kind[joint] == CURVATURE_LEAF
            if not leaf and same_disc(disc, d, joint, loose if exact else tight):
                unite(parent, d, joint)
                alive[d] = False
                break
            if exact:
                winner_s[d] = 1e-13 if end == 0 else 1.0 - 1e-13


@inner
def _before(angle_a, key_a, s_a, angle_b, key_b, s_b):
    """Whether contact a comes before b anticlockwise, from a cut of the circle that both are away from."""
    if abs(angle_a - angle_b) < ANGLE_NEAR:
        return key_a < key_b or (key_a == key_b and s_a < s_b)
    return angle_a < angle_b


@inner
def interleaved(site, s, angle, member_next, first, a, b, cut):
    """Whether the contacts of groups a and b alternate around their common centre.

    Groups are linked lists (`first`, `member_next`) of contacts; `cut` is an angle at which no contact lies near.
    """
    gap = -1
    cb = first[b]
    while cb >= 0:
        below = 0
        ca = first[a]
        total = 0
        while ca >= 0:
            if _before((angle[ca] - cut) % (2.0 * math.pi), site[ca], s[ca],
                       (angle[cb] - cut) % (2.0 * math.pi), site[cb], s[cb]):
                below += 1
            total += 1
            ca = member_next[ca]
        if below == total:
            below = 0
        if gap < 0:
            gap = below
        elif gap != below:
            return True
        cb = member_next[cb]
    return False


@inner
def contact_angle(si, sf, cp, disc, d, i, s):
    """Direction from the centre of disc d to its contact at s on site i."""
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, i, s, 0.0, 0.0)
    return math.atan2(py - disc[d, 1], px - disc[d, 0])


@jit
def group_contacts(owner, alive, parent, first, member_next, last):
    """Linked lists of the living contacts of each united disc."""
    for d in range(first.shape[0]):
        first[d] = -1
    for c in range(owner.shape[0]):
        if not alive[c]:
            continue
        d = find(parent, owner[c])
        member_next[c] = -1
        if first[d] < 0:
            first[d] = c
        else:
            member_next[last[d]] = c
        last[d] = c


@inner
def _merge(parent, first, member_next, last, da, db):
    """Unite two discs and their lists of contacts."""
    unite(parent, da, db)
    root = find(parent, da)
    other = db if root == da else da
    member_next[last[root]] = first[other]
    last[root] = last[other]


@jit
def recentre(si, sf, cp, disc, kind, site, s, owner, spread):
    """Discs in contact with several short arcs become the circle through three of their contacts.

    The circle of an arc of length l is known to 1e-16 (r / l)^2 only, that through contacts all around to rounding. `spread`
    (discs, 8): scratch: longest arc; then x, y of three contacts, first the first one, each next one farthest from those before;
    what is largest so far.
    """
    n = site.shape[0]
    for d in range(disc.shape[0]):
        for m in range(8):
            spread[d, m] = 0.0
        spread[d, 7] = -1.0
    for step in range(3):
        for c in range(n):
            d = owner[c]
            if kind[d] != ARC_CONTACT:
                continue
            x, y, tx, ty, k, speed = evaluate(si, sf, cp, site[c], s[c], 0.0, 0.0)
            far = 0.0 if spread[d, 7] < 0.0 else -1.0
            if step == 0:
                if si[site[c], KIND] == ARC:
                    spread[d, 0] = max(spread[d, 0], sf[site[c], LEN])
            else:
                far = math.sqrt((x - spread[d, 1]) ** 2 + (y - spread[d, 2]) ** 2)
                if step == 2:
                    far = min(far, math.sqrt((x - spread[d, 3]) ** 2 + (y - spread[d, 4]) ** 2))
            if far > spread[d, 7]:
                spread[d, 7] = far
                spread[d, 2 * step + 1] = x
                spread[d, 2 * step + 2] = y
        for d in range(disc.shape[0]):
            if step < 2:
                spread[d, 7] = 0.0
    for d in range(disc.shape[0]):
        if kind[d] != ARC_CONTACT or spread[d, 7] < 0.5 * disc[d, 2] or spread[d, 0] > 0.1 * disc[d, 2]:
            continue
        bx = spread[d, 3] - spread[d, 1]
        by = spread[d, 4] - spread[d, 2]
        cx = spread[d, 5] - spread[d, 1]
        cy = spread[d, 6] - spread[d, 2]
        b = bx * bx + by * by
        c2 = cx * cx + cy * cy
        double = 2.0 * (bx * cy - by * cx)
        x = (cy * b - by * c2) / double
        y = (bx * c2 - cx * b) / double
        disc[d, 0] = spread[d, 1] + x
        disc[d, 1] = spread[d, 2] + y
        disc[d, 2] = math.sqrt(x * x + y * y)


@inner
def _can_cross(kind, parent, d):
    """Whether disc d has contacts that may interleave with another's; of arcs on one circle one stands for all."""
    return kind[d] == THROUGH or (kind[d] == ARC_CONTACT and parent[d] == d)


@jit
def unite_whole(si, sf, disc, kind, winner, sweep, by_sweep, parent, tolerance):
    """Unite discs in contact with arcs of one circle, wherever on the boundary these are (the roots of a gear's teeth).

    `sweep`: a coordinate of the centres; `by_sweep`: discs in its order.
    """
    n = by_sweep.shape[0]
    for position in range(n):
        a = by_sweep[position]
        if kind[a] != ARC_CONTACT:
            continue
        near = max(tolerance, 4.0 * _arc_noise(sf, a if winner[a] & 1 else si[a, PREV]) * disc[a, 2])
        for later in range(position + 1, n):
            b = by_sweep[later]
            if sweep[b] - sweep[a] > near:
                break
            if kind[b] == ARC_CONTACT and same_disc(disc, a, b, near):
                unite(parent, a, b)
                break  # b goes on from here


@jit
def unite_interleaved(disc, kind, site, s, angle, sweep, by_sweep, parent, first, member_next, last, tolerance):
    """Unite nearly equal discs whose contacts interleave (two pairs of opposite contacts of one 4-way disc, say).

    `sweep`: a coordinate of the centres; `by_sweep`: discs in its order.
    """
    n = by_sweep.shape[0]
    for position in range(n):
        a = by_sweep[position]
        if not _can_cross(kind, parent, a):
            continue
        for later in range(position + 1, n):
            b = by_sweep[later]
            if sweep[b] - sweep[a] > tolerance:
                break
            if not _can_cross(kind, parent, b) or not same_disc(disc, a, b, tolerance):
                continue
            da = find(parent, a)
            db = find(parent, b)
            if da == db:
                continue
            cut = angle[first[da]] - 3.0 * ANGLE_NEAR
            if interleaved(site, s, angle, member_next, first, da, db, cut):
                _merge(parent, first, member_next, last, da, db)


@jit
def unite_crossed(si, disc, site, s, owner, angle, order, alive, parent, first, member_next, last, tolerance, tight):
    """Unite discs whose contacts interleave; of two contacts that became one the second dies. Returns how many were united.

    `order`: contacts along the loops. First, last, member_next: linked lists of the contacts of each united disc.
    """
    united = 0
    n = order.shape[0]
    for position in range(n):
        a = order[position]
        b = order[position + 1 if position + 1 < n else 0]
        if not alive[a] or not alive[b] or si[site[a], LOOP] != si[site[b], LOOP]:
            continue
        if not (site[b] == site[a] or (site[b] == si[site[a], NEXT] and s[b] == 0.0)):
            continue
        if s[a] == 0.0 and s[b] == 0.0:
            continue
        da = find(parent, owner[a])
        db = find(parent, owner[b])
        if da == db:  # a disc touches a site once
            alive[a if s[b] == 0.0 else b] = False
            continue
        if not same_disc(disc, da, db, tolerance):
            continue
        cut = 0.5 * (angle[a] + angle[b]) + math.pi
        if not same_disc(disc, da, db, tight) and not interleaved(site, s, angle, member_next, first, da, db, cut):
            continue
        _merge(parent, first, member_next, last, da, db)
        # a joint stays, a winner next to it goes
        alive[a if s[b] == 0.0 else b] = False
        united += 1
    return united
