"""From sites to the combinatorial axis.

Steps: 1. one disc a joint; 2. discs that connect the loops; 3. discs that are one are united; 4. contacts cut the boundary into
faces; 5. branch points are solved inside the faces.
"""

from __future__ import annotations

from mat_core.boundary.sites import SiteTable
from mat_core.kernels.boxtree import STACK, room_for_tree
from mat_core.threads import Bounds, cut, each
from mat_core.tolerances import Tolerances
from mat_core.topology.discs import OK, UNCONNECTED
from mat_core.topology.joining import ASK, FILL, UNITE, find_discs
from mat_core.topology.rooms import Arrays, numbers, room_for_discs, room_for_found
from mat_core.topology.skeleton import Skeleton
from mat_core.topology.solving import failure, solve_all


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
    found = room_for_found(len(t.si), len(t.loop_start) - 1)
    discs, contacts = _find_discs(t, tree, found, tolerances, threads)
    return solve_all(t, tree, found, discs, contacts, tolerances.tie, threads)


def _find_discs(t: SiteTable, tree: Arrays, found: Arrays, tolerances: Tolerances, threads: int) -> tuple[int, int]:
    """Steps 1 to 3, and the arcs between contacts; how many discs and contacts there are."""
    room = room_for_discs(len(t.si), len(t.loop_start) - 1)

    def find(steps: int, part: Bounds) -> tuple[int, int]:
        status, place, discs, contacts = find_discs(
            steps, *part, t.si, t.sf, t.cp, tree, numbers(STACK), t.loop_start, tolerances.tie, tolerances.same_disc,
            tolerances.same_crossed, room, found)
        if status == UNCONNECTED:
            raise failure(t, place, "no disc connects a hole to the rest of the boundary")
        if status != OK:
            raise failure(t, place, "the maximal disc at a joint touches no second part of the boundary")
        return discs, contacts

    parts = cut(len(t.si))
    if len(parts) == 1:
        return find(FILL | ASK | UNITE, parts[0])
    find(FILL, parts[0])
    each(lambda part: find(ASK, part), parts, threads)
    return find(UNITE, parts[0])
