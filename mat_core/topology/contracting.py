"""Strips of no length are contracted: several discs of one n-way branch point were found one by one."""

from __future__ import annotations

from mat_core.kernels.jit import inner
from mat_core.kernels.layout import ARC, CURVATURE_LEAF, KIND, NEXT, VERTEX_LEAF
from mat_core.topology.unite import find, same_disc, unite


@inner
def _contact_at(si, contact_start, contact_site, contact_s, d, site, s):
    """The contact of disc d at s on a site; s = 1 is the start of the next site. Contacts of a disc stand in loop order."""
    if s >= 1.0:
        site = si[site, NEXT]
        s = 0.0
    low = contact_start[d]
    high = contact_start[d + 1]
    while low < high:
        middle = (low + high) // 2
        if contact_site[middle] < site or (contact_site[middle] == site and contact_s[middle] < s):
            low = middle + 1
        else:
            high = middle
    found = low < contact_start[d + 1] and contact_site[low] == site and contact_s[low] == s
    return low if found else -1


@inner
def contract(si, disc, kind, strip_i, strip_s, contact_start, contact_site, contact_s, tolerance, parent, strip_alive,
              contact_parent, contact_alive):
    """Unite the ends of strips of no length, how many; of each pair of contacts that fall together one dies.

    A strip of no length can still have sides (where a footpoint runs along a circle about the disc's own centre): strips that
    ended at the dead contact then end at the living one, so that all of the boundary stays owned.
    """
    for d in range(disc.shape[0]):
        parent[d] = d
    for c in range(contact_site.shape[0]):
        contact_alive[c] = True
        contact_parent[c] = c
    died = 0
    for n in range(strip_i.shape[0]):
        strip_alive[n] = True
        d0 = strip_i[n, 2]
        d1 = strip_i[n, 3]
        leaf = kind[d0] == VERTEX_LEAF or kind[d0] == CURVATURE_LEAF or kind[d1] == VERTEX_LEAF or kind[d1] == CURVATURE_LEAF
        if leaf or d0 == d1 or find(parent, d0) == find(parent, d1) or not same_disc(disc, d0, d1, tolerance):
            continue
        right = strip_s[n, 0] == 0.0 and strip_s[n, 1] == 1.0 and si[strip_i[n, 0], KIND] != ARC
        left = strip_s[n, 2] == 1.0 and strip_s[n, 3] == 0.0 and si[strip_i[n, 1], KIND] != ARC
        if right or left:
            continue  # all of a site that is no circle about the disc's centre: of its joints neither can stand for the other
        unite(parent, d0, d1)
        strip_alive[n] = False
        died += 1
        for side in range(2):
            a = _contact_at(si, contact_start, contact_site, contact_s, d0, strip_i[n, side], strip_s[n, 2 * side])
            b = _contact_at(si, contact_start, contact_site, contact_s, d1, strip_i[n, side], strip_s[n, 2 * side + 1])
            if a < 0 or b < 0:
                continue
            a = find(contact_parent, a)
            b = find(contact_parent, b)
            if a != b:
                # a joint stays, a contact found next to it goes
                keep = b if contact_s[b] == 0.0 and contact_s[a] != 0.0 else a
                lose = a if keep == b else b
                contact_parent[lose] = keep
                contact_alive[lose] = False
    for n in range(strip_i.shape[0]):
        if strip_alive[n]:
            for corner in range(4):
                side = corner // 2
                site = strip_i[n, side]
                c = _contact_at(si, contact_start, contact_site, contact_s, strip_i[n, 2 + corner % 2], site, strip_s[n, corner])
                kept = find(contact_parent, c) if c >= 0 else c
                if kept == c:
                    continue
                if contact_site[kept] == site:
                    strip_s[n, corner] = contact_s[kept]
                elif contact_site[kept] == si[site, NEXT] and contact_s[kept] == 0.0:
                    strip_s[n, corner] = 1.0
    for d in range(disc.shape[0]):
        parent[d] = find(parent, d)
    return died
