"""From sites to the combinatorial axis: every disc with its contacts, every strip between two discs.

Steps: 1. one disc a joint; 2. discs that connect the loops; 3. discs that are one are united; 4. contacts cut the boundary into
faces; 5. branch points are solved inside the faces.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.sites import SiteTable
from mat_core.kernels.boxtree import STACK, Tree, room_for_tree
from mat_core.kernels.layout import ARC_CONTACT, THROUGH
from mat_core.threads import Bounds, cut, each
from mat_core.tolerances import Tolerances
from mat_core.topology.discs import OK, UNCONNECTED
from mat_core.topology.joining import ASK, CONNECT, FILL, find_candidates, unite_discs
from mat_core.topology.solving import Found, failure, solve_all


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


def _numbers(n: int) -> NDArray[np.int64]:
    return np.empty(n, dtype=np.int64)


def _find_discs(t: SiteTable, tree: Tree, tolerances: Tolerances, threads: int) -> Found:
    """Steps 1 to 3, and the arcs between contacts."""
    n = len(t.si)
    loops = len(t.loop_start) - 1
    room = n + loops
    disc, kind, parent, sweep = np.empty((room, 3)), _numbers(room), _numbers(room), np.empty(room)
    winner, winner_s = _numbers(n), np.empty(n)
    most = 2 * n + 2 * loops
    site, s, owner, angle = _numbers(most), np.empty(most), _numbers(most), np.empty(most)
    key_x, key_y, right, right_site, extra = np.empty(n), np.empty(n), np.empty((loops, 2)), _numbers(loops), np.empty((loops, 5))
    extra_site, loop_parent, won = np.empty((loops, 2), dtype=np.int64), _numbers(loops), np.empty(n, dtype=np.bool_)

    def candidates(steps: int, part: Bounds) -> tuple[int, int, int, int]:
        told: tuple[int, int, int, int] = find_candidates(
            steps, *part, t.si, t.sf, t.cp, tree, key_x, key_y, _numbers(STACK), t.loop_start, tolerances.tie,
            tolerances.same_disc, tolerances.same_crossed, disc, kind, winner, winner_s, loop_parent, right, right_site, extra,
            extra_site, parent, won, site, s, owner, angle, sweep)
        if told[0] == UNCONNECTED:
            raise failure(t, told[1], "no disc connects a hole to the rest of the boundary")
        if told[0] != OK:
            raise failure(t, told[1], "the maximal disc at a joint touches no second part of the boundary")
        return told

    parts = cut(n)
    if len(parts) == 1:
        status, place, discs, contacts = candidates(FILL | ASK | CONNECT, parts[0])
    else:
        candidates(FILL, parts[0])
        each(lambda part: candidates(ASK, part), parts, threads)
        status, place, discs, contacts = candidates(CONNECT, parts[0])
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
    return Found(discs, n, united, united_kind, to_site[:n], to_s[:n], to_disc[:n], to_angle[:n], arc_hi[:n], next_contact[:n])


def build_skeleton(t: SiteTable, tolerances: Tolerances, threads: int = 1) -> Skeleton:
    """All discs, contacts and strips of the axis.

    Parameters
    ----------
    t : SiteTable
    tolerances : Tolerances
    threads : int
        How many may work at a time; the result does not depend on it.

    Returns
    -------
    Skeleton

    Raises
    ------
    NotCertified
        The discs do not fit together (their faces break Euler's identity); names a place.
    """
    tree = room_for_tree(len(t.si))
    f = _find_discs(t, tree, tolerances, threads)
    k, faces = solve_all(t, tree, f, tolerances.tie, threads)
    by_disc = np.lexsort((k.s, k.site, k.disc_of))
    contact_start = np.searchsorted(k.disc_of[by_disc], np.arange(len(k.disc) + 1))
    kinds = np.full(len(k.disc), THROUGH)
    kinds[: f.discs] = f.kind[: f.discs]
    kinds[k.whole_i[:, 1]] = ARC_CONTACT  # also with a spiral that is an arc but for rounding
    return Skeleton(k.disc, kinds, contact_start, k.site[by_disc], k.s[by_disc], k.strip_i, k.strip_s, k.whole_i, k.whole_s,
                    faces)
