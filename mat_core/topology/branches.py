"""Solve the branch points inside the faces.

Walk along one arc of a face, arc 0: the maximal disc there touches first the arc before it (k-1), in the end the arc after it
(1), and in between, because the axis is a planar tree, arcs of falling number. Where the partner changes from j to j' < j there
is a branch point, the disc with contacts on arc 0, arc j and arc j':

    1. the root s of phi_j(s) - phi_j'(s); the signs at the ends of its bracket are known, it is never evaluated there
    2. if another arc in between has a larger phi at s, it splits the bracket in two
    3. otherwise the disc is a node; arcs in between that tie with it and are touched inside are contacts too (4-way, n-way)

The nodes along arc 0 cut the face into strips on arc 0 and smaller faces that no longer contain it.

A face in the work buffer is a row for each arc: ints (site, disc that closes it towards the next arc), floats (lo, hi).
"""

from __future__ import annotations

from mat_core.kernels.boxtree import Tree, box_distance_sq
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import ARC_CONTACT, FAN, KIND, LEN, LINE, NEXT, SWEEP, THROUGH, XMAX, XMIN, YMAX, YMIN
from mat_core.kernels.sorting import group, sort
from mat_core.topology.branch_disc import (
    adopt,
    best_between,
    farther_phi,
    partner_change,
    polish,
    seen_from,
    solve_at_corner,
    tie_beside,
    touch_arc,
)
from mat_core.topology.discs import CLEARLY, K_LOW, NO_PARTNER, NOT_EULER, OK, TOO_SMALL
from mat_core.topology.faces import link_arcs, list_faces
from mat_core.topology.rooms import (
    AROUND,
    AROUND_START,
    CONTACT_ARC,
    DISC_OF,
    FACE_ARCS,
    NEXT_ARC,
    NODE_FIRST,
    PLACE_AROUND,
    SITE_OF,
    TRI_HI,
    TRI_LO,
    TRI_S,
    TRI_SITE,
    FaceRoom,
    Found,
    Listed,
)
from mat_core.topology.split import MANY, find_split, split_face

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
        s, phi, sl, sr = partner_change(si, sf, cp, site, lo, hi, w_i, w_f, left, right, tie)
        phi = farther_phi(si, sf, cp, site, s, phi, w_i, w_f, left, sl, right, sr, tie)
        # both may lie behind the tangent at s, where a third arc wins: no disc is larger than K_LOW allows
        least = max(phi, K_LOW)
        better, arc = best_between(si, sf, cp, site, s, w_i, w_f, right, left, least, tie)
        if phi < K_LOW and arc < 0:
            return NO_PARTNER, nodes
        if arc >= 0 and not better > least * (1.0 + tie):
            value, sj = touch_arc(si, sf, cp, site, s, w_i, w_f, arc, tie)
            if not better > least * (1.0 + tie_beside(si, sf, cp, site, s, w_i, left, sl, right, sr, arc, sj, phi, tie)):
                arc = -1
        if arc < 0 and left - 1 > right:
            if seen_from(si, sf, cp, w_i, w_f, left, sl, left - 1, phi, tie) > 1.0 + CLEARLY:
                arc = left - 1
            elif seen_from(si, sf, cp, w_i, w_f, right, sr, right + 1, phi, tie) > 1.0 + CLEARLY:
                arc = right + 1
        if arc >= 0:
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
        # nor is the right one a partner if the arc after it, seen from it, is reached first: rounding changed their order
        after = right - 1
        if after > 0 and top > 0 and seen_from(si, sf, cp, w_i, w_f, right, sr, after, phi, tie) > 1.0 + CLEARLY:
            if bracket_i[top - 1, 1] == after:
                top -= 1
                bracket_i[top, 0] = left
                bracket_f[top, 0] = lo
            else:
                bracket_i[top, 1] = after
                bracket_i[top - 1, 0] = after
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
        exact = solve_at_corner(si, sf, cp, w_i, w_f, left, right, tie, disc, d, tri_s)
        polish(si, sf, cp, tri_site, tri_s, tri_lo, tri_hi, exact, disc, d)
        adopt(si, sf, cp, tri_site, tri_s, tri_lo, tri_hi, w_i, k, left, right, disc, d)
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
            value, sj = touch_arc(si, sf, cp, site, s, w_i, w_f, between, tie)
            if between == left - 1 and abs(seen_from(si, sf, cp, w_i, w_f, left, sl, between, phi, tie) - 1.0) > CLEARLY:
                continue
            if between == right + 1 and abs(seen_from(si, sf, cp, w_i, w_f, right, sr, between, phi, tie) - 1.0) > CLEARLY:
                continue
            near = tie_beside(si, sf, cp, site, s, w_i, left, sl, right, sr, between, sj, phi, tie)
            if value >= phi * (1.0 - near) and w_f[between, 0] < sj < w_f[between, 1]:
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
        made = _link(found, links, room, n_discs, n_contacts)
        if made != faces:
            return NOT_EULER, n_discs, n_contacts, 0, 0, 0, made
    if steps & SOLVE:
        status, n_discs, n_contacts, strips, wholes, place = _solve_faces(
            si, sf, cp, tree, stack, tie, faces, room.face_start, room.stack_i, room.stack_f, disc, n_discs,
            room.contact_i[DISC_OF], room.contact_i[SITE_OF], room.contact_s, n_contacts, room.strip_i, room.strip_s,
            room.whole_i, room.whole_s, room.w_i, room.w_f, room.node_i[CONTACT_ARC], room.contacts_s, room.node_i[NODE_FIRST],
            room.bracket_i, room.bracket_f, room.node_i[TRI_SITE], room.tri[TRI_S], room.tri[TRI_LO], room.tri[TRI_HI])
        if status != OK:
            return status, n_discs, n_contacts, strips, wholes, place, faces
    if steps & LIST:
        wholes = wholes if steps & SOLVE else room.whole_i.shape[0]
        _list_contacts(found, room, listed, n_known, n_discs, n_contacts, wholes)
    return OK, n_discs, n_contacts, strips, wholes, -1, faces


@inner
def _link(found, links, room, discs, contacts):
    """Put the faces in `room`; how many."""
    around_start = links[AROUND_START]
    around = links[AROUND]
    place_around = links[PLACE_AROUND]
    face_arcs = links[FACE_ARCS]
    owner = found.owner
    for c in range(contacts):
        face_arcs[c] = c
    group(owner, contacts, discs, around_start, around, face_arcs)
    for d in range(discs):
        sort(found.angle, around, face_arcs, around_start[d], around_start[d + 1])
    for place in range(contacts):
        place_around[around[place]] = place
    link_arcs(contacts, found.next_contact, around, around_start, owner, place_around, links[NEXT_ARC])
    faces = list_faces(contacts, links[NEXT_ARC], face_arcs, room.face_start)
    for place in range(contacts):
        a = face_arcs[place]
        room.stack_i[place, 0] = found.site[a]
        room.stack_i[place, 1] = owner[found.next_contact[a]]
        room.stack_f[place, 0] = found.s[a]
        room.stack_f[place, 1] = found.arc_hi[a]
        room.contact_i[DISC_OF, place] = owner[place]
        room.contact_i[SITE_OF, place] = found.site[place]
        room.contact_s[place] = found.s[place]
    return faces


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
def _solve_faces(si, sf, cp, tree, stack, tie, faces, face_start, stack_i, stack_f, disc, n_discs, disc_of, contact_site,
                 contact_s, n_contacts, strip_i, strip_s, whole_i, whole_s, w_i, w_f, contacts_i, contacts_s, node_first,
                 bracket_i, bracket_f, tri_site, tri_s, tri_lo, tri_hi):
    """Resolve every face into strips; returns (status, discs, contacts, strips, whole contacts, place).

    The faces stand one after the other in `stack_i` (site, closing disc) and `stack_f` (lo, hi), bounded by `face_start`
    (rows 0 .. faces); smaller faces are put where the larger one stood. A face of many arcs is halved by a disc first. New
    contacts are appended to disc_of, contact_site, contact_s.
    """
    n_strips = 0
    n_whole = 0
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
