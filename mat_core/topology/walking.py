"""The nodes along one arc of a face: where the partner of the maximal disc there changes.

Walk along arc 0: the maximal disc there touches first the arc before it (k-1), in the end the arc after it (1), and in between,
because the axis is a planar tree, arcs of falling number. Where the partner changes from j to j' < j there is a branch point, the
disc with contacts on arc 0, arc j and arc j':

    1. the root s of phi_j(s) - phi_j'(s); the signs at the ends of its bracket are known, it is never evaluated there
    2. if another arc in between has a larger phi at s, it splits the bracket in two
    3. otherwise the disc is a node; arcs in between that tie with it and are touched inside are contacts too (4-way, n-way)

A face in the work buffer of `room` is a row for each arc: `w_i` (site, disc that closes it towards the next arc), `w_f` (lo, hi).
"""

from __future__ import annotations

from mat_core.kernels.boxtree import box_distance_sq
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import XMAX, XMIN, YMAX, YMIN
from mat_core.topology.branch_disc import adopt, polish, solve_at_corner
from mat_core.topology.discs import CLEARLY, K_LOW, NO_PARTNER, OK, TOO_SMALL
from mat_core.topology.partners import best_between, farther_phi, partner_change, seen_from, tie_beside, touch_arc

NONE, NOBODY = -1, -2  # of the arcs in between is reached first; nor are left and right


@inner
def _first_between(si, sf, cp, w_i, w_f, s, phi, left, sl, right, sr, tie):
    """Which arc the disc at s on arc 0 reaches before those two that agree there on phi, or NONE, NOBODY."""
    site = w_i[0, 0]
    # both may lie behind the tangent at s, where a third arc wins: no disc is larger than K_LOW allows
    least = max(phi, K_LOW)
    better, arc = best_between(si, sf, cp, site, s, w_i, w_f, right, left, least, tie)
    if phi < K_LOW and arc < 0:
        return NOBODY
    if arc >= 0 and not better > least * (1.0 + tie):
        value, sj = touch_arc(si, sf, cp, site, s, w_i, w_f, arc, tie)
        if not better > least * (1.0 + tie_beside(si, sf, cp, site, s, w_i, left, sl, right, sr, arc, sj, phi, tie)):
            arc = NONE
    if arc < 0 and left - 1 > right:
        if seen_from(si, sf, cp, w_i, w_f, left, sl, left - 1, phi, tie) > 1.0 + CLEARLY:
            return left - 1
        if seen_from(si, sf, cp, w_i, w_f, right, sr, right + 1, phi, tie) > 1.0 + CLEARLY:
            return right + 1
    return arc


@inner
def _place_disc(si, sf, cp, room, k, left, sl, right, sr, lo, hi, s, phi, tie, disc, d):
    """Disc d: tangent at s on arc 0, then settled on all three arcs; the contacts are left in `room.tri_s`."""
    w_i = room.w_i
    px, py, tx, ty, curvature, speed = evaluate(si, sf, cp, w_i[0, 0], s, 0.0, 0.0)
    disc[d, 0] = px - ty / phi
    disc[d, 1] = py + tx / phi
    disc[d, 2] = 1.0 / phi
    for m in range(3):
        arc = 0 if m == 0 else (left if m == 1 else right)
        room.tri_site[m] = w_i[arc, 0]
        room.tri_s[m] = s if m == 0 else (sl if m == 1 else sr)
        room.tri_lo[m] = lo if m == 0 else room.w_f[arc, 0]
        room.tri_hi[m] = hi if m == 0 else room.w_f[arc, 1]
    exact = solve_at_corner(si, sf, cp, w_i, room.w_f, left, right, tie, disc, d, room.tri_s)
    polish(si, sf, cp, room.tri_site, room.tri_s, room.tri_lo, room.tri_hi, exact, disc, d)
    adopt(si, sf, cp, room.tri_site, room.tri_s, room.tri_lo, room.tri_hi, w_i, k, left, right, disc, d)


@inner
def _list_ties(si, sf, cp, room, left, sl, right, sr, s, phi, tie, disc, d, n_contacts):
    """Contacts of disc d with arcs between left and right; returns the new number of contacts.

    They are touched strictly inside: at an end the disc that closes the arc there is the same disc, and the graph unites them.
    """
    w_i = room.w_i
    w_f = room.w_f
    site = w_i[0, 0]
    limit = 1.0 / phi * (1.0 + 2.0 * tie) + 1e-15
    for between in range(left - 1, right, -1):
        j = w_i[between, 0]
        if box_distance_sq(disc[d, 0], disc[d, 1], sf[j, XMIN], sf[j, YMIN], sf[j, XMAX], sf[j, YMAX]) > limit * limit:
            continue
        value, sj = touch_arc(si, sf, cp, site, s, w_i, w_f, between, tie)
        if between == left - 1 and abs(seen_from(si, sf, cp, w_i, w_f, left, sl, between, phi, tie) - 1.0) > CLEARLY:
            continue
        if between == right + 1 and abs(seen_from(si, sf, cp, w_i, w_f, right, sr, between, phi, tie) - 1.0) > CLEARLY:
            continue
        near = tie_beside(si, sf, cp, site, s, w_i, left, sl, right, sr, between, sj, phi, tie)
        if value >= phi * (1.0 - near) and w_f[between, 0] < sj < w_f[between, 1]:
            room.contacts_i[n_contacts] = between
            room.contacts_s[n_contacts] = sj
            n_contacts += 1
    return n_contacts


@inner
def walk_arc(si, sf, cp, room, k, tie, disc, n_discs):
    """Find the nodes along arc 0 of the face in the work buffer, in the order in which they lie on it.

    New discs go to `disc` from row n_discs on, their contacts (arc of the face; s) to `room.contacts_i`, `room.contacts_s`, by
    falling arc number with arc 0 first; `room.node_first[m]` is the first contact of the m-th node. Returns (status, nodes).
    """
    w_i = room.w_i
    w_f = room.w_f
    bracket_i = room.bracket_i
    bracket_f = room.bracket_f
    nodes = 0
    n_contacts = 0
    top = 0
    bracket_i[0, 0] = k - 1
    bracket_i[0, 1] = 1
    bracket_f[0, 0] = w_f[0, 0]
    bracket_f[0, 1] = w_f[0, 1]
    room.node_first[0] = 0
    while top >= 0:
        left = bracket_i[top, 0]
        right = bracket_i[top, 1]
        lo = bracket_f[top, 0]
        hi = bracket_f[top, 1]
        s, phi, sl, sr = partner_change(si, sf, cp, w_i[0, 0], lo, hi, w_i, w_f, left, right, tie)
        phi = farther_phi(si, sf, cp, w_i[0, 0], s, phi, w_i, w_f, left, sl, right, sr, tie)
        arc = _first_between(si, sf, cp, w_i, w_f, s, phi, left, sl, right, sr, tie)
        if arc == NOBODY:
            return NO_PARTNER, nodes
        if arc >= 0:
            # the far half waits below, the near half is done first
            if top + 2 >= bracket_i.shape[0]:
                return TOO_SMALL, nodes
            bracket_i[top, 0] = arc
            bracket_f[top, 0] = s
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
        if d >= disc.shape[0] or n_contacts + left - right + 2 > room.contacts_i.shape[0]:
            return TOO_SMALL, nodes
        _place_disc(si, sf, cp, room, k, left, sl, right, sr, lo, hi, s, phi, tie, disc, d)
        room.contacts_i[n_contacts] = 0
        room.contacts_s[n_contacts] = room.tri_s[0]
        room.contacts_i[n_contacts + 1] = left
        room.contacts_s[n_contacts + 1] = room.tri_s[1]
        n_contacts = _list_ties(si, sf, cp, room, left, sl, right, sr, s, phi, tie, disc, d, n_contacts + 2)
        room.contacts_i[n_contacts] = right
        room.contacts_s[n_contacts] = room.tri_s[2]
        n_contacts += 1
        nodes += 1
        room.node_first[nodes] = n_contacts
    return OK, nodes
