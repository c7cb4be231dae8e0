"""From sites to discs that are told apart: the compiled part of steps 1 to 3 of `mat_core.topology.skeleton`.

FILL    the tree of boxes
ASK     a disc at every joint; by far the longest, so it may be taken in parts
UNITE   discs that connect the loops, and the contacts of all of them; discs that are one are united; what is left, and the
arcs between contacts
"""

from __future__ import annotations

import math

from mat_core.kernels.boxtree import Tree, fill_tree
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import ARC_CONTACT, THROUGH, X0, Y0
from mat_core.kernels.sorting import group, sort
from mat_core.topology.connecting import EXTRA_S, EXTRA_SITE, EXTRA_X, connect_loops
from mat_core.topology.discs import OK, UNCONNECTED, joint_discs
from mat_core.topology.faces import cut_arcs
from mat_core.topology.interleaving import contact_angle
from mat_core.topology.rooms import (
    ALIVE,
    ANGLE,
    BY_SWEEP,
    DOUBT,
    FIRST,
    KEY_X,
    KEY_Y,
    KIND_OF,
    LAST,
    MEMBER_NEXT,
    NUMBER,
    ORDER,
    OWNER,
    PARENT,
    SITE,
    SPARE,
    SWEEP_OF,
    WINNER,
    WINNER_S,
    WON,
    Found,
    Room,
    S,
)
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

FILL, ASK, UNITE = 1, 2, 4  # steps of `find_discs`


@jit
def find_discs(steps, first, last, si, sf, cp, tree, stack, loop_start, tie, same_disc, same_crossed, room, found):
    """Steps 1 to 3 of the skeleton; returns (status, place, discs, contacts).

    steps: FILL, ASK for joints first .. last - 1, UNITE; their sum takes one after the other: a small domain needs one call.
    """
    tree, room, found = Tree(*tree), Room(*room), Found(*found)
    kind = room.by_disc_i[KIND_OF]
    winner = room.by_disc_i[WINNER]
    winner_s = room.by_disc_f[WINNER_S]
    if steps & FILL:
        fill_tree(si, sf, cp, tree, room.by_disc_f[KEY_X], room.by_disc_f[KEY_Y])
    if steps & ASK:
        status, place = joint_discs(si, sf, cp, tree, stack, tie, room.disc, kind, winner, winner_s, first, last)
        if status != OK:
            return status, place, 0, 0
    if not steps & UNITE:
        return OK, -1, 0, 0
    status, more = connect_loops(si, sf, cp, tree, stack, loop_start, kind, winner, room.by_loop_i, room.by_loop_f)
    if status != OK:
        return UNCONNECTED, loop_start[loop_start.shape[0] - 2], 0, 0
    contacts = _list_contacts(si, sf, cp, more, same_disc, same_crossed, room)
    discs, contacts = _unite_discs(si, sf, cp, loop_start, same_disc, same_crossed, si.shape[0] + more, contacts, room, found)
    return OK, -1, discs, contacts


@inner
def _list_contacts(si, sf, cp, more, same_disc, same_crossed, room):
    """Contacts of the discs at the joints and of `more` that connect loops; how many. Discs that win at a joint are united."""
    n = si.shape[0]
    disc = room.disc
    kind = room.by_disc_i[KIND_OF]
    parent = room.by_disc_i[PARENT]
    won = room.by_disc_i[WON]
    winner = room.by_disc_i[WINNER]
    winner_s = room.by_disc_f[WINNER_S]
    sweep = room.by_disc_f[SWEEP_OF]
    site = room.by_contact_i[SITE]
    owner = room.by_contact_i[OWNER]
    s = room.by_contact_f[S]
    angle = room.by_contact_f[ANGLE]
    for d in range(n + more):
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
            disc[n + m, axis] = room.by_loop_f[EXTRA_X + axis, m]
    for end in range(2):
        for m in range(more):
            site[contacts] = room.by_loop_i[EXTRA_SITE + end, m]
            s[contacts] = room.by_loop_f[EXTRA_S + end, m]
            owner[contacts] = n + m
            contacts += 1
    for c in range(contacts):
        angle[c] = contact_angle(si, sf, cp, disc, owner[c], site[c], s[c])
    for d in range(n + more):
        sweep[d] = ALONG * disc[d, 0] + SLANT * disc[d, 1]
    return contacts


@inner
def _best_members(si, sf, cp, discs, kind, winner, winner_s, parent, doubt, best):
    """best[root]: the member of each union whose disc is known best.

    A disc through two contacts is determined as well as they are apart, and as its joint has one normal; one of a whole arc is
    the arc's own circle.
    """
    for d in range(discs):
        best[d] = d
        doubt[d] = math.inf
        if d < si.shape[0]:
            if kind[d] == ARC_CONTACT:
                doubt[d] = 0.0
            elif kind[d] == THROUGH:
                px, py, tx, ty, k, speed = evaluate(si, sf, cp, winner[d], winner_s[d], sf[d, X0], sf[d, Y0])
                chord_sq = px * px + py * py
                doubt[d] = COORDINATE / chord_sq + kink(si, sf, d) if chord_sq > 0.0 else math.inf
    for d in range(discs):
        root = find(parent, d)
        if doubt[d] < doubt[best[root]]:
            best[root] = d


@inner
def _unite_discs(si, sf, cp, loop_start, same_disc, same_crossed, n, contacts, room, found):
    """Step 3 for n discs and their contacts: fills `found`; returns (discs, contacts)."""
    disc = room.disc
    kind = room.by_disc_i[KIND_OF]
    parent = room.by_disc_i[PARENT]
    winner = room.by_disc_i[WINNER]
    winner_s = room.by_disc_f[WINNER_S]
    sweep = room.by_disc_f[SWEEP_OF]
    by_sweep = room.by_disc_i[BY_SWEEP]
    first = room.by_disc_i[FIRST]
    last = room.by_disc_i[LAST]
    number = room.by_disc_i[NUMBER]
    site = room.by_contact_i[SITE]
    owner = room.by_contact_i[OWNER]
    s = room.by_contact_f[S]
    angle = room.by_contact_f[ANGLE]
    order = room.by_contact_i[ORDER]
    spare = room.by_contact_i[SPARE]
    alive = room.by_contact_i[ALIVE]
    member_next = room.by_contact_i[MEMBER_NEXT]
    for c in range(contacts):
        alive[c] = True
        spare[c] = c
    # the lists of `member_next` are made later; till then it has room for where the contacts of each site begin
    group(site, contacts, si.shape[0], member_next, order, spare)
    for i in range(si.shape[0]):
        sort(s, order, spare, member_next[i], member_next[i + 1])
    for d in range(n):
        by_sweep[d] = d
    sort(sweep, by_sweep, first, 0, n)
    unite_whole(si, sf, disc, n, kind, winner, sweep, by_sweep, parent, same_disc)
    group_contacts(owner, contacts, alive, parent, n, first, member_next, last)
    unite_interleaved(si, loop_start, disc, n, kind, site, s, angle, sweep, by_sweep, parent, first, member_next, last,
                      same_crossed)
    listed = contacts
    more = 1
    while more > 0:
        group_contacts(owner, contacts, alive, parent, n, first, member_next, last)
        more = unite_crossed(si, sf, loop_start, disc, kind, site, s, owner, angle, order, listed, alive, parent, first,
                             member_next, last, same_crossed, same_disc)
        left = 0
        for position in range(listed):
            if alive[order[position]]:
                order[left] = order[position]
                left += 1
        listed = left
    # what is left is numbered in the order of the roots
    for d in range(n):
        parent[d] = find(parent, d)
        number[d] = -1
    for position in range(listed):
        number[parent[owner[order[position]]]] = 0
    _best_members(si, sf, cp, n, kind, winner, winner_s, parent, room.by_disc_f[DOUBT], first)
    discs = 0
    for d in range(n):
        if number[d] == 0:
            number[d] = discs
            for axis in range(3):
                found.disc[discs, axis] = disc[first[d], axis]
            found.kind[discs] = 0
            discs += 1
    for d in range(n):
        root = number[parent[d]]
        if root >= 0 and kind[d] > found.kind[root]:
            found.kind[root] = kind[d]
    for position in range(listed):
        c = order[position]
        found.site[position] = site[c]
        found.s[position] = s[c]
        found.owner[position] = number[parent[owner[c]]]
    recentre(si, sf, cp, found.disc, found.kind, discs, found.site, found.s, found.owner, listed, room.spread)
    for position in range(listed):
        found.angle[position] = contact_angle(si, sf, cp, found.disc, found.owner[position], found.site[position],
                                              found.s[position])
    cut_arcs(si, found.site, found.s, listed, found.arc_hi, found.next_contact)
    return discs, listed
