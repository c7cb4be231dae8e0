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
from mat_core.kernels.boxtree import STACK, Tree, room_for_tree
from mat_core.kernels.curve import evaluate
from mat_core.kernels.layout import ARC_CONTACT, THROUGH
from mat_core.tolerances import Tolerances
from mat_core.topology.branches import solve_faces
from mat_core.topology.discs import NOT_EULER, OK, UNCONNECTED
from mat_core.topology.joining import find_candidates, unite_discs


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


def failure(table: SiteTable, site: int, what: str) -> NotCertified:
    """The honest error for trouble near a site: where, in the caller's coordinates."""
    x, y = evaluate(table.si, table.sf, table.cp, site, 0.0, 0.0, 0.0)[:2]
    place = (float(x / table.scale + table.origin[0]), float(y / table.scale + table.origin[1]))
    return NotCertified(what, place=place)


class _Found(NamedTuple):
    """Discs told apart, and their contacts in loop order.

    discs, contacts: how many. disc, kind: room for more; site, s, owner and angle of each contact; arc a runs from contact a up
    to arc_hi[a], where contact next_contact[a] is.
    """

    discs: int
    contacts: int
    disc: NDArray[np.float64]
    kind: NDArray[np.int64]
    site: NDArray[np.int64]
    s: NDArray[np.float64]
    owner: NDArray[np.int64]
    angle: NDArray[np.float64]
    arc_hi: NDArray[np.float64]
    next_contact: NDArray[np.int64]


def _numbers(n: int) -> NDArray[np.int64]:
    return np.empty(n, dtype=np.int64)


def _find_discs(t: SiteTable, tree: Tree, stack: NDArray[np.int64], tolerances: Tolerances) -> _Found:
    """Steps 1 to 3, and the arcs between contacts."""
    n = len(t.si)
    loops = len(t.loop_start) - 1
    room = n + loops
    disc, kind, parent, sweep = np.empty((room, 3)), _numbers(room), _numbers(room), np.empty(room)
    winner, winner_s = _numbers(n), np.empty(n)
    most = 2 * n + 2 * loops
    site, s, owner, angle = _numbers(most), np.empty(most), _numbers(most), np.empty(most)
    status, place, discs, contacts = find_candidates(
        t.si, t.sf, t.cp, tree, np.empty(n), np.empty(n), stack, t.loop_start, tolerances.tie, tolerances.same_disc,
        tolerances.same_crossed, disc, kind, winner, winner_s, _numbers(loops), np.empty((loops, 2)), _numbers(loops),
        np.empty((loops, 5)), np.empty((loops, 2), dtype=np.int64), parent, np.empty(n, dtype=np.bool_), site, s, owner, angle,
        sweep)
    if status == UNCONNECTED:
        raise failure(t, place, "no disc connects a hole to the rest of the boundary")
    if status != OK:
        raise failure(t, place, "the maximal disc at a joint touches no second part of the boundary")
    disc, kind, parent, sweep = disc[:discs], kind[:discs], parent[:discs], sweep[:discs]
    site, s, owner, angle = site[:contacts], s[:contacts], owner[:contacts], angle[:contacts]
    order = np.lexsort((s, site))
    by_sweep = np.argsort(sweep, kind="stable")
    united, united_kind = np.empty((discs, 3)), _numbers(discs)
    to_site, to_s, to_disc, to_angle = _numbers(contacts), np.empty(contacts), _numbers(contacts), np.empty(contacts)
    arc_hi, next_contact = np.empty(contacts), _numbers(contacts)
    discs, contacts = unite_discs(
         t.si, t.sf, t.cp, t.loop_start, tolerances.same_disc, tolerances.same_crossed, disc, kind, winner, winner_s, parent,
        sweep, by_sweep, site, s, owner, angle, order, np.empty(contacts, dtype=np.bool_), _numbers(discs), _numbers(discs),
        _numbers(contacts), _numbers(discs), np.empty(discs), united, united_kind, np.empty((discs, 8)), to_site, to_s, to_disc,
        to_angle, arc_hi, next_contact)
    n = contacts
    return _Found(discs, n, united, united_kind, to_site[:n], to_s[:n], to_disc[:n], to_angle[:n], arc_hi[:n], next_contact[:n])


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
    tree = room_for_tree(len(t.si))
    stack = _numbers(STACK)
    f = _find_discs(t, tree, stack, tolerances)
    holes = len(t.loop_start) - 2
    expected = 1 - holes + f.contacts - f.discs

    # 4. and 5. faces to strips, solving branch points
    n = f.contacts
    room = 5 * n + 64  # three for each branch point, and those of discs that split large faces
    grown = np.empty((f.discs + 2 * n, 3))
    grown[: f.discs] = f.disc[: f.discs]
    disc_of, contact_site, contact_s = _numbers(room), _numbers(room), np.empty(room)
    contact_site[:n] = f.site
    contact_s[:n] = f.s
    strip_i, strip_s = np.empty((3 * n + 2, 4), dtype=np.int64), np.empty((3 * n + 2, 4))
    whole_i, whole_s = np.empty((n, 2), dtype=np.int64), np.empty((n, 2))
    status, discs, contacts, strips, wholes, place, faces = solve_faces(
        t.si, t.sf, t.cp, tree, stack, tolerances.tie, expected, f.owner, np.lexsort((f.angle, f.owner)), f.next_contact,
        f.arc_hi, _numbers(f.discs + 1), _numbers(n), _numbers(n), _numbers(n), _numbers(room + 1),
        np.empty((room, 2), dtype=np.int64), np.empty((room, 2)), grown, f.discs, disc_of, contact_site, contact_s, n, strip_i,
        strip_s, whole_i, whole_s, np.empty((n, 2), dtype=np.int64), np.empty((n, 2)), _numbers(4 * n + 8), np.empty(4 * n + 8),
        _numbers(n + 2), np.empty((n + 4, 2), dtype=np.int64), np.empty((n + 4, 2)), _numbers(3), np.empty(3),
        np.empty(3), np.empty(3))
    if status == NOT_EULER:
        raise failure(t, 0, f"the discs cut the domain into {faces} faces where Euler's identity asks for {expected}")
    if status != OK:
        raise failure(t, int(place), "a branch point was not found where three or more parts of the boundary meet")
    by_disc = np.lexsort((contact_s[:contacts], contact_site[:contacts], disc_of[:contacts]))
    contact_start = np.searchsorted(disc_of[:contacts][by_disc], np.arange(discs + 1))
    all_kinds = np.full(discs, THROUGH)
    all_kinds[: f.discs] = f.kind[: f.discs]
    all_kinds[whole_i[:wholes, 1]] = ARC_CONTACT  # also with a spiral that is an arc but for rounding
    return Skeleton(grown[:discs], all_kinds, contact_start, contact_site[:contacts][by_disc], contact_s[:contacts][by_disc],
                    strip_i[:strips], strip_s[:strips], whole_i[:wholes], whole_s[:wholes], faces)
