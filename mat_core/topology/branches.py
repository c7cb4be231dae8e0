"""Solve the branch points inside the faces.

A face with two discs is a strip; the nodes along its longest arc (`topology.walking`) cut a larger one into strips on that arc
and smaller faces that no longer contain it.

A face in the work buffer is a row for each arc: ints (site, disc that closes it towards the next arc), floats (lo, hi).
"""

from __future__ import annotations

from mat_core.kernels.boxtree import Tree
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import ARC_CONTACT, FAN, KIND, LEN, LINE, NEXT, SWEEP, THROUGH
from mat_core.kernels.sorting import group, sort
from mat_core.topology.discs import NO_PARTNER, NOT_EULER, OK, TOO_SMALL
from mat_core.topology.faces import link_faces
from mat_core.topology.rooms import (
    CONTACT_ARC,
    DISC_OF,
    NODE_FIRST,
    SITE_OF,
    TRI_HI,
    TRI_LO,
    TRI_S,
    TRI_SITE,
    FaceRoom,
    Found,
    Listed,
    Work,
)
from mat_core.topology.split import MANY, find_split, split_face
from mat_core.topology.walking import walk_arc

CURVED = 8.0  # a curved arc is walked along rather than a straight one this much longer: its partners are better told apart

LINK, SOLVE, LIST = 1, 2, 4  # steps of `solve_faces`


@inner
def _length(si, sf, disc, w_i, w_f, arc):
    """How far the disc travels along an arc, roughly: decides which arc is walked along."""
    site = w_i[arc, 0]
    share = w_f[arc, 1] - w_f[arc, 0]
    if si[site, KIND] == FAN:
        return 0.25 * abs(sf[site, SWEEP]) * disc[w_i[arc, 1], 2] * share
    return sf[site, LEN] * share * (1.0 if si[site, KIND] == LINE else CURVED)


@inner
def _emit_strip(room, n, site_a, a0, a1, site_b, b0, b1, disc0, disc1):
    """Write one strip: right side site_a from a0 up to a1, left side site_b from b0 down to b1; returns their new number."""
    room.strip_i[n, 0] = site_a
    room.strip_i[n, 1] = site_b
    room.strip_i[n, 2] = disc0
    room.strip_i[n, 3] = disc1
    room.strip_s[n, 0] = a0
    room.strip_s[n, 1] = a1
    room.strip_s[n, 2] = b0
    room.strip_s[n, 3] = b1
    return n + 1


@inner
def _halve(si, sf, cp, tree, room, faces, begin, k, disc, n_discs, n_contacts):
    """Cut the last of the faces by a disc: OK, TOO_SMALL, or NO_PARTNER where no disc does."""
    if faces + 2 >= room.face_start.shape[0] or begin + k + 2 > room.stack_i.shape[0]:
        return NO_PARTNER
    low, low_s, high, high_s, x, y, r = find_split(si, sf, cp, tree, room.stack, room.stack_i, room.stack_f, begin, k)
    if low < 0:
        return NO_PARTNER
    if n_discs >= disc.shape[0] or n_contacts + 2 > room.contact_site.shape[0]:
        return TOO_SMALL
    disc[n_discs, 0] = x
    disc[n_discs, 1] = y
    disc[n_discs, 2] = r
    for end in range(2):
        room.disc_of[n_contacts + end] = n_discs
        room.contact_site[n_contacts + end] = room.stack_i[begin + (low if end == 0 else high), 0]
        room.contact_s[n_contacts + end] = low_s if end == 0 else high_s
    room.face_start[faces] = split_face(room.stack_i, room.stack_f, room.w_i, room.w_f, begin, k, low, low_s, high, high_s,
                                        n_discs)
    room.face_start[faces + 1] = begin + k + 2
    return OK


@inner
def _take_up(si, sf, disc, room, begin, k):
    """Copy a face of k arcs to the work buffer, the longest arc first."""
    longest = 0
    best = -1.0
    for arc in range(k):
        length = _length(si, sf, disc, room.stack_i, room.stack_f, begin + arc)
        if length > best:
            best = length
            longest = arc
    for arc in range(k):
        source = begin + (longest + arc) % k
        room.w_i[arc, 0] = room.stack_i[source, 0]
        room.w_i[arc, 1] = room.stack_i[source, 1]
        room.w_f[arc, 0] = room.stack_f[source, 0]
        room.w_f[arc, 1] = room.stack_f[source, 1]


@inner
def _note_contacts(si, room, nodes, n_discs, n_contacts):
    """Append the contacts of the nodes that were found along arc 0; returns their new number."""
    contacts_s = room.contacts_s
    node_first = room.node_first
    for m in range(nodes):
        first = node_first[m]
        if m > 0:
            # contacts on one arc come in order: later nodes touch an arc before earlier ones
            contacts_s[first] = max(contacts_s[first], contacts_s[node_first[m - 1]])
            contacts_s[first + 1] = min(contacts_s[first + 1], contacts_s[first - 1])
        for c in range(first, node_first[m + 1]):
            site = room.w_i[room.contacts_i[c], 0]
            at_end = contacts_s[c] >= 1.0
            room.disc_of[n_contacts] = n_discs + m
            room.contact_site[n_contacts] = si[site, NEXT] if at_end else site
            room.contact_s[n_contacts] = 0.0 if at_end else contacts_s[c]
            n_contacts += 1
    return n_contacts


@inner
def _strips_along(room, k, nodes, n_discs, n_strips):
    """Strips on arc 0, from node to node; returns the new number of strips."""
    w_i = room.w_i
    w_f = room.w_f
    contacts_s = room.contacts_s
    lo = w_f[0, 0]
    before = w_i[k - 1, 1]
    partner = k - 1
    partner_from = w_f[k - 1, 1]
    for m in range(nodes):
        first = room.node_first[m]
        n_strips = _emit_strip(room, n_strips, w_i[0, 0], lo, contacts_s[first], w_i[partner, 0], partner_from,
                               contacts_s[first + 1], before, n_discs + m)
        lo = contacts_s[first]
        before = n_discs + m
        partner = room.contacts_i[room.node_first[m + 1] - 1]
        partner_from = contacts_s[room.node_first[m + 1] - 1]
    return _emit_strip(room, n_strips, w_i[0, 0], lo, w_f[0, 1], w_i[1, 0], partner_from, w_f[1, 0], before, w_i[0, 1])


@inner
def _smaller_faces(room, nodes, n_discs, faces, end):
    """Push the faces between neighbouring contacts of each node from row `end` on; returns their new number, -1: no room."""
    for m in range(nodes):
        for c in range(room.node_first[m] + 1, room.node_first[m + 1] - 1):
            high = room.contacts_i[c]
            low = room.contacts_i[c + 1]
            if end + high - low + 1 > room.stack_i.shape[0] or faces + 2 > room.face_start.shape[0]:
                return -1
            for arc in range(low, high + 1):
                room.stack_i[end, 0] = room.w_i[arc, 0]
                room.stack_i[end, 1] = room.w_i[arc, 1] if arc < high else n_discs + m
                room.stack_f[end, 0] = room.contacts_s[c + 1] if arc == low else room.w_f[arc, 0]
                room.stack_f[end, 1] = room.contacts_s[c] if arc == high else room.w_f[arc, 1]
                end += 1
            faces += 1
            room.face_start[faces] = end
    return faces


@jit
def solve_faces(steps, si, sf, cp, tree, stack, tie, faces, found, links, room, listed, disc, n_known, n_discs, n_contacts):
    """List the faces, resolve them into strips; returns (status, discs, contacts, strips, whole contacts, place, faces).

    steps: LINK the arcs to faces, NOT_EULER if there are not as many as `faces`; SOLVE the faces that stand in `room`; LIST the
    contacts of each disc. A sum of these takes one after the other. New discs are appended to the n_discs of `disc`, of which
    n_known were found at joints, new contacts to the n_contacts of `room`; `place` is a site near the trouble when the status is
    not OK.
    """
    tree, found, room, listed = Tree(*tree), Found(*found), FaceRoom(*room), Listed(*listed)
    strips = wholes = 0
    if steps & LINK:
        made = link_faces(found, links, room, n_discs, n_contacts)
        if made != faces:
            return NOT_EULER, n_discs, n_contacts, 0, 0, 0, made
    if steps & SOLVE:
        work = Work(
            stack, room.face_start, room.stack_i, room.stack_f, room.contact_i[DISC_OF], room.contact_i[SITE_OF], room.contact_s,
            room.strip_i, room.strip_s, room.whole_i, room.whole_s, room.w_i, room.w_f, room.node_i[CONTACT_ARC], room.contacts_s,
            room.node_i[NODE_FIRST], room.bracket_i, room.bracket_f, room.node_i[TRI_SITE], room.tri[TRI_S], room.tri[TRI_LO],
            room.tri[TRI_HI])
        status, n_discs, n_contacts, strips, wholes, place = _solve_faces(
            si, sf, cp, tree, tie, faces, work, disc, n_discs, n_contacts)
        if status != OK:
            return status, n_discs, n_contacts, strips, wholes, place, faces
    if steps & LIST:
        wholes = wholes if steps & SOLVE else room.whole_i.shape[0]
        _list_contacts(found, room, listed, n_known, n_discs, n_contacts, wholes)
    return OK, n_discs, n_contacts, strips, wholes, -1, faces


@inner
def _list_contacts(found, room, listed, n_known, discs, contacts, wholes):
    """Fill `listed`: contacts by disc, site and s, and the kind of each disc; `wholes` arcs are in whole contact with theirs."""
    order = listed.order[0]
    spare = listed.order[1]
    site = room.contact_i[SITE_OF]
    for c in range(contacts):
        spare[c] = c
    group(room.contact_i[DISC_OF], contacts, discs, listed.start, order, spare)
    for d in range(discs):
        # equal ones stay as they were, so that the last key counts most
        sort(room.contact_s, order, spare, listed.start[d], listed.start[d + 1])
        sort(site, order, spare, listed.start[d], listed.start[d + 1])
        listed.kind[d] = found.kind[d] if d < n_known else THROUGH
    for place in range(contacts):
        listed.site[place] = site[order[place]]
        listed.s[place] = room.contact_s[order[place]]
    for m in range(wholes):
        listed.kind[room.whole_i[m, 1]] = ARC_CONTACT  # also with a spiral that is an arc but for rounding


@inner
def _solve_faces(si, sf, cp, tree, tie, faces, room, disc, n_discs, n_contacts):
    """Resolve every face into strips; returns (status, discs, contacts, strips, whole contacts, place).

    The faces stand one after the other in `room.stack_i` (site, closing disc) and `room.stack_f` (lo, hi), bounded by
    `room.face_start` (rows 0 .. faces); smaller faces are put where the larger one stood. A face of many arcs is halved by a disc
    first. New contacts are appended to `room.disc_of`, `room.contact_site`, `room.contact_s`.
    """
    stack_i = room.stack_i
    stack_f = room.stack_f
    n_strips = 0
    n_whole = 0
    while faces > 0:
        begin = room.face_start[faces - 1]
        k = room.face_start[faces] - begin
        if k == 1:
            room.whole_i[n_whole, 0] = stack_i[begin, 0]
            room.whole_i[n_whole, 1] = stack_i[begin, 1]
            room.whole_s[n_whole, 0] = stack_f[begin, 0]
            room.whole_s[n_whole, 1] = stack_f[begin, 1]
            n_whole += 1
            faces -= 1
            continue
        if k == 2:
            # disc after arc 1 -> disc after arc 0
            n_strips = _emit_strip(room, n_strips, stack_i[begin, 0], stack_f[begin, 0], stack_f[begin, 1], stack_i[begin + 1, 0],
                                   stack_f[begin + 1, 1], stack_f[begin + 1, 0], stack_i[begin + 1, 1], stack_i[begin, 1])
            faces -= 1
            continue
        if k > MANY:
            status = _halve(si, sf, cp, tree, room, faces, begin, k, disc, n_discs, n_contacts)
            if status == TOO_SMALL:
                return TOO_SMALL, n_discs, n_contacts, n_strips, n_whole, stack_i[begin, 0]
            if status == OK:
                faces += 1
                n_contacts += 2
                n_discs += 1
                continue
        _take_up(si, sf, disc, room, begin, k)
        faces -= 1
        status, nodes = walk_arc(si, sf, cp, room, k, tie, disc, n_discs)
        if status != OK:
            return status, n_discs, n_contacts, n_strips, n_whole, room.w_i[0, 0]
        n_contacts = _note_contacts(si, room, nodes, n_discs, n_contacts)
        n_strips = _strips_along(room, k, nodes, n_discs, n_strips)
        faces = _smaller_faces(room, nodes, n_discs, faces, begin)
        if faces < 0:
            return TOO_SMALL, n_discs, n_contacts, n_strips, n_whole, room.w_i[0, 0]
        n_discs += nodes
    return OK, n_discs, n_contacts, n_strips, n_whole, -1
