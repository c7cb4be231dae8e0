"""From sites to the combinatorial axis: every disc with its contacts, every strip between two discs.

Steps: 1. one disc a joint; 2. discs that connect the loops; 3. discs that are one are united; 4. contacts cut the boundary into
faces; 5. branch points are solved inside the faces.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.sites import SiteTable
from mat_core.errors import NotCertified
from mat_core.kernels.boxtree import STACK, Tree, build_tree
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import jit
from mat_core.kernels.layout import ARC_CONTACT, LOOP, THROUGH, X0, Y0
from mat_core.tolerances import Tolerances
from mat_core.topology.branches import solve_faces
from mat_core.topology.discs import OK, all_joint_discs, connect_loops
from mat_core.topology.faces import cut_arcs, link_arcs, list_faces
from mat_core.topology.unite import (
    contact_angle,
    find,
    group_contacts,
    recentre,
    unite_at_joints,
    unite_crossed,
    unite_interleaved,
    unite_whole,
)

SLANT = 0.5957  # of the direction along which centres of discs are sorted, with 0.8 not quite of length 1


class Skeleton(NamedTuple):
    """The axis before it is traced; normalised coordinates.

    disc (D, 3): x, y, r. disc_kind (D,): THROUGH, VERTEX_LEAF, CURVATURE_LEAF or ARC_CONTACT. contact_start (D + 1,),
    contact_site (C,), contact_s (C,): the contacts of each disc. strip_i (S, 4): site_a, site_b, disc0, disc1; strip_s (S, 4):
    a0, a1, b0, b1: from disc0 to disc1 the right side runs up site_a from a0 to a1, the left side down site_b from b0 to b1.
    whole_i (A, 2): site, disc and whole_s (A, 2): lo, hi of boundary arcs in contact along their length.
    faces: number of faces the discs cut the domain into.
    """

    disc: NDArray[np.float64]
    disc_kind: NDArray[np.int64]
    contact_start: NDArray[np.int64]
    contact_site: NDArray[np.int64]
    contact_s: NDArray[np.float64]
    strip_i: NDArray[np.int64]
    strip_s: NDArray[np.float64]
    whole_i: NDArray[np.int64]
    whole_s: NDArray[np.float64]
    faces: int


@jit
def _angles(si, sf, cp, disc, owner, site, s, angle):
    """Direction of every contact from the centre of its disc."""
    for c in range(site.shape[0]):
        angle[c] = contact_angle(si, sf, cp, disc, owner[c], site[c], s[c])


@jit
def _best_members(si, sf, cp, kind, winner, winner_s, parent, chord, best):
    """best[root]: the member of each union whose disc is known best.

    A disc through two contacts is determined as well as they are apart; one of a whole arc is the arc's own circle.
    """
    for d in range(parent.shape[0]):
        best[d] = d
        chord[d] = 0.0
        if d < kind.shape[0]:
            if kind[d] == ARC_CONTACT:
                chord[d] = 4.0
            elif kind[d] == THROUGH:
                px, py, tx, ty, k, speed = evaluate(si, sf, cp, winner[d], winner_s[d], sf[d, X0], sf[d, Y0])
                chord[d] = px * px + py * py
    for d in range(parent.shape[0]):
        root = find(parent, d)
        if chord[d] > chord[best[root]]:
            best[root] = d


@jit
def _roots(parent, owner):
    """Replace every disc by the root of its union."""
    for c in range(owner.shape[0]):
        owner[c] = find(parent, owner[c])


def failure(table: SiteTable, site: int, what: str) -> NotCertified:
    """The honest error for trouble near a site: where, in the caller's coordinates."""
    x, y = evaluate(table.si, table.sf, table.cp, site, 0.0, 0.0, 0.0)[:2]
    place = (float(x / table.scale + table.origin[0]), float(y / table.scale + table.origin[1]))
    return NotCertified(what, place=place)


def _find_discs(
    t: SiteTable, tree: Tree, stack: NDArray[np.int64], tolerances: Tolerances
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64], NDArray[np.float64], NDArray[np.int64]]:
    """Steps 1 to 3: (disc, kind, contact_site, contact_s, contact_disc), contacts in loop order."""
    n = len(t.si)
    n_loops = len(t.loop_start) - 1
    disc = np.empty((n + n_loops, 3))
    kind = np.empty(n, dtype=np.int64)
    winner = np.empty(n, dtype=np.int64)
    winner_s = np.empty(n)
    status, place = all_joint_discs(t.si, t.sf, t.cp, tree, stack, tolerances.tie, disc, kind, winner, winner_s)
    if status != OK:
        raise failure(t, place, "the maximal disc at a joint touches no second part of the boundary")

    extra = np.empty((n_loops, 5))
    extra_site = np.empty((n_loops, 2), dtype=np.int64)
    loop_parent = np.empty(n_loops, dtype=np.int64)
    status, n_extra = connect_loops(t.si, t.sf, t.cp, tree, stack, t.loop_start, kind, winner, loop_parent,
                                    np.empty((n_loops, 2)), np.empty(n_loops, dtype=np.int64), extra, extra_site)
    if status != OK:
        raise failure(t, int(t.loop_start[-2]), "no disc connects a hole to the rest of the boundary")
    disc[n : n + n_extra] = extra[:n_extra, :3]

    parent = np.arange(n + n_extra)
    won = np.empty(n, dtype=np.bool_)
    unite_at_joints(t.si, t.sf, disc, kind, winner, winner_s, parent, won, tolerances.same_disc, tolerances.same_crossed)
    who = np.nonzero(won)[0]
    more = np.arange(n, n + n_extra)
    site = np.concatenate((np.arange(n), winner[who], extra_site[:n_extra, 0], extra_site[:n_extra, 1]))
    s = np.concatenate((np.zeros(n), winner_s[who], extra[:n_extra, 3], extra[:n_extra, 4]))
    owner = np.concatenate((np.arange(n), who, more, more))
    angle = np.empty(len(site))
    _angles(t.si, t.sf, t.cp, disc, owner, site, s, angle)
    order = np.lexsort((s, site))
    alive = np.ones(len(site), dtype=np.bool_)
    first = np.empty(n + n_extra, dtype=np.int64)
    last = np.empty(n + n_extra, dtype=np.int64)
    member_next = np.empty(len(site), dtype=np.int64)
    full_kind = np.concatenate((kind, np.full(n_extra, THROUGH)))
    # not along x, where a grid has many centres of one coordinate
    sweep = 0.8 * disc[: n + n_extra, 0] + SLANT * disc[: n + n_extra, 1]
    by_sweep = np.argsort(sweep, kind="stable")
    unite_whole(t.si, t.sf, disc, full_kind, winner, sweep, by_sweep, parent, tolerances.same_disc)
    group_contacts(owner, alive, parent, first, member_next, last)
    unite_interleaved(t.si, t.loop_start, disc, full_kind, site, s, angle, sweep, by_sweep, parent, first, member_next, last,
                      tolerances.same_crossed)
    while True:
        group_contacts(owner, alive, parent, first, member_next, last)
        united = unite_crossed(t.si, t.sf, t.loop_start, disc, site, s, owner, angle, order, alive, parent, first,
                               member_next, last, tolerances.same_crossed, tolerances.same_disc)
        order = order[alive[order]]
        if united == 0:
            break
    _roots(parent, owner)
    owner = owner[order]
    roots, owner = np.unique(owner, return_inverse=True)
    _roots(parent, parent)
    group_kind = np.zeros(n + n_extra, dtype=np.int64)
    np.maximum.at(group_kind, parent, full_kind)
    best = np.empty(n + n_extra, dtype=np.int64)
    _best_members(t.si, t.sf, t.cp, kind, winner, winner_s, parent, np.empty(n + n_extra), best)
    disc, kind, site, s = disc[best[roots]], group_kind[roots], site[order], s[order]
    recentre(t.si, t.sf, t.cp, disc, kind, site, s, owner, np.empty((len(disc), 8)))
    return disc, kind, site, s, owner


def build_skeleton(t: SiteTable, tolerances: Tolerances) -> Skeleton:
    """All discs, contacts and strips of the axis.

    Parameters
    ----------
    t : SiteTable
    tolerances : Tolerances

    Returns
    -------
    Skeleton

    Raises
    ------
    NotCertified
        The discs do not fit together (their faces break Euler's identity); names a place.
    """
    tree = build_tree(t.si, t.sf, t.cp)
    stack = np.empty(STACK, dtype=np.int64)
    disc, kind, site, s, owner = _find_discs(t, tree, stack, tolerances)
    n_contacts = len(site)
    n_discs = len(disc)
    holes = len(t.loop_start) - 2

    # 4. arcs between contacts (contacts stand in loop order: arc a starts at contact a), tied to faces by the discs
    order = np.arange(n_contacts)
    arc_hi = np.empty(n_contacts)
    next_contact = np.empty(n_contacts, dtype=np.int64)
    cut_arcs(site, s, t.si[:, LOOP], order, arc_hi, next_contact)
    angle = np.empty(n_contacts)
    _angles(t.si, t.sf, t.cp, disc, owner, site, s, angle)
    around = np.lexsort((angle, owner))
    around_start = np.searchsorted(owner[around], np.arange(n_discs + 1))
    place_around = np.empty(n_contacts, dtype=np.int64)
    place_around[around] = order
    next_arc = np.empty(n_contacts, dtype=np.int64)
    link_arcs(order, next_contact, around, around_start, owner, place_around, next_arc)
    face_arcs = np.empty(n_contacts, dtype=np.int64)
    starts = np.empty(n_contacts + 1, dtype=np.int64)
    faces = list_faces(next_arc, face_arcs, starts)
    expected = 1 - holes + n_contacts - n_discs
    if faces != expected:
        raise failure(t, 0, f"the discs cut the domain into {faces} faces where Euler's identity asks for {expected}")

    # 5. faces to strips, solving branch points
    room = 5 * n_contacts + 64  # three for each branch point, and those of discs that split large faces
    stack_i = np.empty((room, 2), dtype=np.int64)
    stack_f = np.empty((room, 2))
    stack_i[:n_contacts, 0] = site[face_arcs]
    stack_i[:n_contacts, 1] = owner[next_contact[face_arcs]]
    stack_f[:n_contacts, 0] = s[face_arcs]
    stack_f[:n_contacts, 1] = arc_hi[face_arcs]
    face_start = np.full(room + 1, -1, dtype=np.int64)
    face_start[: faces + 1] = starts[: faces + 1]
    grown = np.empty((n_discs + 2 * n_contacts, 3))
    grown[:n_discs] = disc
    disc_of = np.empty(room, dtype=np.int64)
    contact_site = np.empty(room, dtype=np.int64)
    contact_s = np.empty(room)
    disc_of[:n_contacts] = owner
    contact_site[:n_contacts] = site
    contact_s[:n_contacts] = s
    strip_i = np.empty((3 * n_contacts + 2, 4), dtype=np.int64)
    strip_s = np.empty((3 * n_contacts + 2, 4))
    whole_i = np.empty((n_contacts, 2), dtype=np.int64)
    whole_s = np.empty((n_contacts, 2))
    largest = int(np.diff(starts[: faces + 1]).max())
    status, discs, contacts, strips, wholes, place = solve_faces(
        t.si, t.sf, t.cp, tree, stack, tolerances.tie, face_start, stack_i, stack_f, grown, n_discs, disc_of, contact_site,
        contact_s, n_contacts, strip_i, strip_s, whole_i, whole_s, np.empty((largest, 2), dtype=np.int64), np.empty((largest, 2)),
        np.empty(4 * largest + 8, dtype=np.int64), np.empty(4 * largest + 8), np.empty(largest + 2, dtype=np.int64),
        np.empty((largest + 4, 2), dtype=np.int64), np.empty((largest + 4, 2)), np.empty(3, dtype=np.int64), np.empty(3),
        np.empty(3), np.empty(3))
    if status != OK:
        raise failure(t, int(place), "a branch point was not found where three or more parts of the boundary meet")
    by_disc = np.lexsort((contact_s[:contacts], contact_site[:contacts], disc_of[:contacts]))
    contact_start = np.searchsorted(disc_of[:contacts][by_disc], np.arange(discs + 1))
    all_kinds = np.concatenate((kind, np.full(discs - n_discs, THROUGH)))
    return Skeleton(grown[:discs], all_kinds, contact_start, contact_site[:contacts][by_disc], contact_s[:contacts][by_disc],
                    strip_i[:strips], strip_s[:strips], whole_i[:wholes], whole_s[:wholes], faces)


