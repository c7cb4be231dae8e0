"""Discs found from different contacts that are the same disc become one.

    same place        the winner is the very joint that another disc was found from
    same disc         the winner's site ends at a joint whose disc has this centre and radius (a disc touches a site once)
    one circle        arcs on one circle, wherever on the boundary these are
    crossed contacts  the contacts of two nearly equal discs interleave around their centre: both cannot be maximal

Unions are a forest: parent[d] leads to the disc that stands for all of its union.
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import (
    ARC,
    ARC_CONTACT,
    CURVATURE_LEAF,
    FAN,
    K0,
    KIND,
    KNOWN,
    LEN,
    LOOP,
    NEXT,
    PREV,
    THROUGH,
    TX0,
    TX1,
    TY0,
    TY1,
    VERTEX_LEAF,
)
from mat_core.topology.interleaving import interleaved

COORDINATE = 2.3e-16  # rounding of a normalised coordinate
FLATTEST = 1e-7  # no arc's circle is believed to be worse than this
MISSED = 1e-12  # a disc this near to its contacts touches them


@inner
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
def arc_noise(si, sf, i):
    """Relative rounding of the radius of a circular arc: that of the coordinates over the arc's height, length^2 / (8 r)."""
    if si[i, KNOWN] == 1:
        return 0.0
    flat = sf[i, K0] * sf[i, LEN]
    return min(16.0 * COORDINATE / (flat * flat), FLATTEST)


@inner
def kink(si, sf, joint):
    """By how much the boundary turns at a smooth joint, radians; 0 at a fan.

    The normal there may be any one in between: so far from each other are discs, over their radius, that are one.
    """
    before = si[joint, PREV]
    if si[joint, KIND] == FAN or si[before, KIND] == FAN:
        return 0.0
    return abs(sf[before, TX1] * sf[joint, TY0] - sf[before, TY1] * sf[joint, TX0])


@inner
def same_disc(disc, a, b, tolerance):
    """Centre and radius agree."""
    dx = disc[a, 0] - disc[b, 0]
    dy = disc[a, 1] - disc[b, 1]
    return math.sqrt(dx * dx + dy * dy) + abs(disc[a, 2] - disc[b, 2]) <= tolerance


@inner
def unite_at_joints(si, sf, disc, kind, winner, winner_s, parent, alive, tight, loose):
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
            near = loose + disc[d, 2] * kink(si, sf, joint) if exact else tight
            if not leaf and same_disc(disc, d, joint, near):
                unite(parent, d, joint)
                alive[d] = False
                break
            if exact:
                winner_s[d] = 1e-13 if end == 0 else 1.0 - 1e-13


@inner
def group_contacts(owner, contacts, alive, parent, discs, first, member_next, last):
    """Linked lists of the living contacts of each united disc."""
    for d in range(discs):
        first[d] = -1
    for c in range(contacts):
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


@inner
def recentre(si, sf, cp, disc, kind, discs, site, s, owner, contacts, spread):
    """Discs in contact with several short arcs, and those united beyond rounding, become the circle through three contacts.

    The circle of an arc of length l is known to 1e-16 (r / l)^2 only, that through contacts all around to rounding. Discs that
    were united though they differ are all wrong a little. `spread` (discs, 8): scratch: longest arc, or by how much a contact is
    missed; then x, y of three contacts, first the first one, each next one farthest from those before; what is largest so far.
    """
    for d in range(discs):
        for m in range(8):
            spread[d, m] = 0.0
        spread[d, 7] = -1.0
    for step in range(3):
        for c in range(contacts):
            d = owner[c]
            if kind[d] != ARC_CONTACT and (kind[d] != THROUGH or step > 0 and spread[d, 0] < MISSED):
                continue
            x, y, tx, ty, k, speed = evaluate(si, sf, cp, site[c], s[c], 0.0, 0.0)
            far = 0.0 if spread[d, 7] < 0.0 else -1.0
            if step == 0:
                if kind[d] == THROUGH:
                    miss = abs(math.sqrt((x - disc[d, 0]) ** 2 + (y - disc[d, 1]) ** 2) - disc[d, 2])
                    spread[d, 0] = max(spread[d, 0], miss)
                elif si[site[c], KIND] == ARC:
                    spread[d, 0] = max(spread[d, 0], sf[site[c], LEN])
            else:
                far = math.sqrt((x - spread[d, 1]) ** 2 + (y - spread[d, 2]) ** 2)
                if step == 2:
                    far = min(far, math.sqrt((x - spread[d, 3]) ** 2 + (y - spread[d, 4]) ** 2))
            if far > spread[d, 7]:
                spread[d, 7] = far
                spread[d, 2 * step + 1] = x
                spread[d, 2 * step + 2] = y
        for d in range(discs):
            if step < 2:
                spread[d, 7] = 0.0
    for d in range(discs):
        known = kind[d] == THROUGH and spread[d, 0] < MISSED or kind[d] == ARC_CONTACT and spread[d, 0] > 0.1 * disc[d, 2]
        if kind[d] != ARC_CONTACT and kind[d] != THROUGH or known or spread[d, 7] < 0.5 * disc[d, 2]:
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


@inner
def unite_whole(si, sf, disc, n, kind, winner, sweep, by_sweep, parent, tolerance):
    """Unite discs in contact with arcs of one circle, wherever on the boundary these are (the roots of a gear's teeth).

    `sweep`: a coordinate of the centres; `by_sweep`: the n discs in its order.
    """
    for position in range(n):
        a = by_sweep[position]
        if kind[a] != ARC_CONTACT:
            continue
        near = max(tolerance, 4.0 * arc_noise(si, sf, a if winner[a] & 1 else si[a, PREV]) * disc[a, 2])
        for later in range(position + 1, n):
            b = by_sweep[later]
            if sweep[b] - sweep[a] > near:
                break
            if kind[b] == ARC_CONTACT and same_disc(disc, a, b, near):
                unite(parent, a, b)
                break  # b goes on from here


@inner
def unite_interleaved(si, loop_start, disc, n, kind, site, s, angle, sweep, by_sweep, parent, first, member_next, last,
                      tolerance):
    """Unite nearly equal discs whose contacts interleave (two pairs of opposite contacts of one 4-way disc, say).

    `sweep`: a coordinate of the centres; `by_sweep`: the n discs in its order.
    """
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
            if interleaved(si, loop_start, site, s, angle, member_next, first, da, db):
                _merge(parent, first, member_next, last, da, db)


@inner
def unite_crossed(si, sf, loop_start, disc, kind, site, s, owner, angle, order, n, alive, parent, first, member_next, last,
                  tolerance, tight):
    """Unite discs whose contacts interleave; of two contacts that became one the second dies. Returns how many were united.

    The first n of `order`: contacts along the loops. First, last, member_next: linked lists of the contacts of each united disc.
    """
    united = 0
    begin = 0  # of the loop
    for position in range(n):
        a = order[position]
        loop = si[site[a], LOOP]
        if loop != si[site[order[begin]], LOOP]:
            begin = position
        closes = position + 1 == n or si[site[order[position + 1]], LOOP] != loop
        b = order[begin if closes else position + 1]
        if a == b or not alive[a] or not alive[b]:
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
        if kind[da] == VERTEX_LEAF or kind[db] == VERTEX_LEAF:  # no other disc is a vertex, however small
            continue
        at_joint = b if s[b] == 0.0 else a
        bend = kink(si, sf, site[at_joint]) if s[at_joint] == 0.0 else 0.0
        if not same_disc(disc, da, db, tolerance + disc[da, 2] * bend):
            continue
        same = same_disc(disc, da, db, tight)
        if not same and not interleaved(si, loop_start, site, s, angle, member_next, first, da, db):
            continue
        _merge(parent, first, member_next, last, da, db)
        # a joint stays, a winner next to it goes
        alive[a if s[b] == 0.0 else b] = False
        united += 1
    return united
