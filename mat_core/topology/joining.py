"""From sites to discs that are told apart: the compiled part of steps 1 to 3 of `mat_core.topology.skeleton`.

    find_candidates   a disc at every joint, discs that connect the loops, and the contacts of all of them; in steps, of which
                      the middle one, by far the longest, may be taken in parts
    unite_discs       discs that are one are united; contacts of those that are left, and the arcs between them

In between contacts are sorted along the loops and discs by place, which is left to NumPy.
"""

from __future__ import annotations

import math

from mat_core.kernels.boxtree import fill_tree
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import ARC_CONTACT, THROUGH, X0, Y0
from mat_core.topology.connecting import connect_loops
from mat_core.topology.discs import OK, UNCONNECTED, joint_discs
from mat_core.topology.faces import cut_arcs
from mat_core.topology.interleaving import contact_angle
from mat_core.topology.unite import (
    COORDINATE,
    find,
    group_contacts,
    kink,
    recentre,
    unite_at_joints,
    unite_crossed,
    unite_interleaved,
    unite_whole,
)

ALONG = 0.8  # direction along which centres of discs are sorted: not x, where a grid has many of one coordinate,
SLANT = 0.5957  # and not quite of length 1

FILL, ASK, CONNECT = 1, 2, 4  # steps of `find_candidates`


@jit
def find_candidates(steps, first, last, si, sf, cp, tree, key_x, key_y, stack, loop_start, tie, same_disc, same_crossed, disc,
                    kind, winner, winner_s, loop_parent, right, right_site, extra, extra_site, parent, won, site, s, owner, angle,
                    sweep):
    """Steps 1 and 2 of the skeleton; returns (status, place, discs, contacts).

    steps: FILL the tree, ASK for the discs at the joints first .. last - 1, CONNECT the loops and list what there is; a sum of
    these takes one after the other, so that a small domain needs one call.

    For every disc `disc`, `kind`, `parent` (those known to be one joined) and `sweep`, a coordinate of its centre; for those of
    joints `winner`, `winner_s`; for every contact `site`, `s`, `owner` and `angle` around it.
    """
    n = si.shape[0]
    if steps & FILL:
        fill_tree(si, sf, cp, tree, key_x, key_y)
    if steps & ASK:
        status, place = joint_discs(si, sf, cp, tree, stack, tie, disc, kind, winner, winner_s, first, last)
        if status != OK:
            return status, place, 0, 0
    if not steps & CONNECT:
        return OK, -1, 0, 0
    status, more = connect_loops(si, sf, cp, tree, stack, loop_start, kind, winner, loop_parent, right, right_site, extra,
                                 extra_site)
    if status != OK:
        return UNCONNECTED, loop_start[loop_start.shape[0] - 2], 0, 0
    discs = n + more
    for d in range(discs):
        parent[d] = d
    unite_at_joints(si, sf, disc, kind, winner, winner_s, parent, won, same_disc, same_crossed)
    for d in range(n):
        site[d] = d
        s[d] = 0.0
        owner[d] = d
    contacts = n
    for d in range(n):
        if won[d]:
            site[contacts] = winner[d]
            s[contacts] = winner_s[d]
            owner[contacts] = d
            contacts += 1
    for m in range(more):
        kind[n + m] = THROUGH
        for axis in range(3):
            disc[n + m, axis] = extra[m, axis]
    for end in range(2):
        for m in range(more):
            site[contacts] = extra_site[m, end]
            s[contacts] = extra[m, 3 + end]
            owner[contacts] = n + m
            contacts += 1
    for c in range(contacts):
        angle[c] = contact_angle(si, sf, cp, disc, owner[c], site[c], s[c])
    for d in range(discs):
        sweep[d] = ALONG * disc[d, 0] + SLANT * disc[d, 1]
    return OK, -1, discs, contacts


@inner
def _best_members(si, sf, cp, kind, winner, winner_s, parent, doubt, best):
    """best[root]: the member of each union whose disc is known best.

    A disc through two contacts is determined as well as they are apart, and as its joint has one normal; one of a whole arc is
    the arc's own circle.
    """
    for d in range(parent.shape[0]):
        best[d] = d
        doubt[d] = math.inf
        if d < si.shape[0]:
            if kind[d] == ARC_CONTACT:
                doubt[d] = 0.0
            elif kind[d] == THROUGH:
                px, py, tx, ty, k, speed = evaluate(si, sf, cp, winner[d], winner_s[d], sf[d, X0], sf[d, Y0])
                chord_sq = px * px + py * py
                doubt[d] = COORDINATE / chord_sq + kink(si, sf, d) if chord_sq > 0.0 else math.inf
    for d in range(parent.shape[0]):
        root = find(parent, d)
        if doubt[d] < doubt[best[root]]:
            best[root] = d


@jit
def unite_discs(si, sf, cp, loop_start, same_disc, same_crossed, disc, kind, winner, winner_s, parent, sweep, by_sweep, site, s,
                owner, angle, order, alive, first, last, member_next, number, doubt, united, united_kind, spread, contact_site,
                contact_s, contact_disc, contact_angle_of, arc_hi, next_contact):
    """Step 3; returns (discs, contacts), and fills `united`, `united_kind`, the contacts in loop order and the arcs between them.

    `order`: contacts along the loops; `by_sweep`: discs by `sweep`. What follows them up to `doubt`, and `spread`, is room for a
    number of each contact or disc.
    """
    for c in range(owner.shape[0]):
        alive[c] = True
    unite_whole(si, sf, disc, kind, winner, sweep, by_sweep, parent, same_disc)
    group_contacts(owner, alive, parent, first, member_next, last)
    unite_interleaved(si, loop_start, disc, kind, site, s, angle, sweep, by_sweep, parent, first, member_next, last, same_crossed)
    contacts = order.shape[0]
    more = 1
    while more > 0:
        group_contacts(owner, alive, parent, first, member_next, last)
        more = unite_crossed(si, sf, loop_start, disc, site, s, owner, angle, order, contacts, alive, parent, first, member_next,
                             last, same_crossed, same_disc)
        left = 0
        for position in range(contacts):
            if alive[order[position]]:
                order[left] = order[position]
                left += 1
        contacts = left
    # what is left is numbered in the order of the roots
    for d in range(parent.shape[0]):
        parent[d] = find(parent, d)
        number[d] = -1
    for position in range(contacts):
        number[parent[owner[order[position]]]] = 0
    _best_members(si, sf, cp, kind, winner, winner_s, parent, doubt, first)
    discs = 0
    for d in range(parent.shape[0]):
        if number[d] == 0:
            number[d] = discs
            for axis in range(3):
                united[discs, axis] = disc[first[d], axis]
            united_kind[discs] = 0
            discs += 1
    for d in range(parent.shape[0]):
        root = number[parent[d]]
        if root >= 0 and kind[d] > united_kind[root]:
            united_kind[root] = kind[d]
    for position in range(contacts):
        c = order[position]
        contact_site[position] = site[c]
        contact_s[position] = s[c]
        contact_disc[position] = number[parent[owner[c]]]
    recentre(si, sf, cp, united, united_kind, discs, contact_site, contact_s, contact_disc, contacts, spread)
    for position in range(contacts):
        contact_angle_of[position] = contact_angle(si, sf, cp, united, contact_disc[position], contact_site[position],
                                                   contact_s[position])
    cut_arcs(si, contact_site, contact_s, contacts, arc_hi, next_contact)
    return discs, contacts
