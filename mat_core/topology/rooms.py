"""Room for what becomes of sites on their way to the skeleton: made in Python, filled by the kernels of this package.

A kernel is handed these as plain tuples, which Numba reads twice as fast as named ones, and makes them named again. Numbers of
the same things are rows of one table: each array that is handed over costs a tenth of a microsecond, and so does making it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.memory import maker

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Arrays = tuple[NDArray[Any], ...]

# rows of `Room`
KIND_OF, PARENT, WINNER, WON, BY_SWEEP, FIRST, LAST, NUMBER = range(8)  # by_disc_i
SWEEP_OF, WINNER_S, DOUBT, KEY_X, KEY_Y = range(5)  # by_disc_f
SITE, OWNER, ORDER, SPARE, ALIVE, MEMBER_NEXT = range(6)  # by_contact_i
S, ANGLE = range(2)  # by_contact_f


class Room(NamedTuple):
    """Numbers of each disc, contact and loop while discs are told apart: a row for each kind of number.

    disc (D, 3): x, y, r of n + L discs, one a joint and, for the loops, fewer than one each. by_disc_i, by_disc_f: KIND_OF;
    PARENT, those known to be one joined; WINNER and WINNER_S of those at joints; WON: whether the winner is a contact of its own;
    SWEEP_OF, a coordinate of the centre, and BY_SWEEP, discs in its order; FIRST and LAST of a list of contacts; NUMBER at last;
    DOUBT; KEY_X and KEY_Y to sort sites. by_contact_i, by_contact_f (2 n + 2 L): SITE, S and OWNER, ANGLE around it; ORDER along
    the loops, ALIVE, MEMBER_NEXT. by_loop_i, by_loop_f: see `connect_loops`. spread (D, 8): see `recentre`.
    """

    disc: Floats
    by_disc_i: Ints
    by_disc_f: Floats
    by_contact_i: Ints
    by_contact_f: Floats
    by_loop_i: Ints
    by_loop_f: Floats
    spread: Floats


class Found(NamedTuple):
    """Discs told apart, and their contacts in loop order; room for as many as there may be.

    disc, kind; site, s, owner and angle of each contact; arc a runs from contact a up to arc_hi[a], where contact next_contact[a]
    is.
    """

    disc: Floats
    kind: Ints
    site: Ints
    s: Floats
    owner: Ints
    angle: Floats
    arc_hi: Floats
    next_contact: Ints


class FaceRoom(NamedTuple):
    """Room to solve faces of n arcs in all, with c contacts known before.

    Faces: face_start, stack_i, stack_f, see `topology.branches`. Results: contact_i, rows DISC_OF and SITE_OF, contact_s;
    strip_i, strip_s; whole_i, whole_s. The rest is for the face at hand: its arcs w_i, w_f; brackets; node_i, rows CONTACT_ARC,
    NODE_FIRST and TRI_SITE, and contacts_s; tri, rows TRI_S, TRI_LO and TRI_HI of the three sides of a branch point.
    """

    face_start: Ints
    stack_i: Ints
    stack_f: Floats
    contact_i: Ints
    contact_s: Floats
    strip_i: Ints
    strip_s: Floats
    whole_i: Ints
    whole_s: Floats
    w_i: Ints
    w_f: Floats
    bracket_i: Ints
    bracket_f: Floats
    node_i: Ints
    contacts_s: Floats
    tri: Floats


class Work(NamedTuple):
    """`FaceRoom` with the rows of its tables, and the stack for walks through the tree of boxes, by name."""

    stack: Ints
    face_start: Ints
    stack_i: Ints
    stack_f: Floats
    disc_of: Ints
    contact_site: Ints
    contact_s: Floats
    strip_i: Ints
    strip_s: Floats
    whole_i: Ints
    whole_s: Floats
    w_i: Ints
    w_f: Floats
    contacts_i: Ints
    contacts_s: Floats
    node_first: Ints
    bracket_i: Ints
    bracket_f: Floats
    tri_site: Ints
    tri_s: Floats
    tri_lo: Floats
    tri_hi: Floats


DISC_OF, SITE_OF = range(2)  # rows of contact_i
CONTACT_ARC, NODE_FIRST, TRI_SITE = range(3)  # rows of node_i
TRI_S, TRI_LO, TRI_HI = range(3)  # rows of tri
AROUND_START, AROUND, PLACE_AROUND, NEXT_ARC, FACE_ARCS = range(5)  # rows of the links that tie arcs to faces


class Listed(NamedTuple):
    """The contacts of each disc: start (D + 1,), and site, s in loop order; kind (D,). order (2, C): room to sort."""

    start: Ints
    site: Ints
    s: Floats
    kind: Ints
    order: Ints


def numbers(*shape: int) -> Ints:
    """An array of integers yet to be filled."""
    return maker(max(shape))(shape, np.int64)


def room_for_discs(sites: int, loops: int) -> Arrays:
    """`Room` for a disc a joint, and one a loop to connect them."""
    discs, contacts = sites + loops, 2 * (sites + loops)
    make = maker(sites)
    return (make((discs, 3)), numbers(8, discs), make((5, discs)), numbers(6, contacts), make((2, contacts)),
            numbers(4, loops), make((7, loops)), make((discs, 8)))


def room_for_found(sites: int, loops: int) -> Arrays:
    """`Found` as large as it can be."""
    discs, contacts = sites + loops, 2 * (sites + loops)
    make = maker(sites)
    return (make((discs, 3)), numbers(discs), numbers(contacts), make(contacts), numbers(contacts), make(contacts),
            make(contacts), numbers(contacts))


def room_for_faces(arcs: int, contacts: int) -> Arrays:
    """`FaceRoom`: three new contacts for each branch point, two for each disc that splits a large face."""
    more = 4 * arcs + 64
    return (numbers(arcs + more + 1), numbers(arcs + more, 2), np.empty((arcs + more, 2)), numbers(2, contacts + more),
            np.empty(contacts + more), numbers(3 * arcs + 2, 4), np.empty((3 * arcs + 2, 4)), numbers(arcs, 2),
            np.empty((arcs, 2)), numbers(arcs, 2), np.empty((arcs, 2)), numbers(arcs + 4, 2), np.empty((arcs + 4, 2)),
            numbers(3, 4 * arcs + 8), np.empty(4 * arcs + 8), np.empty((3, 3)))


def room_for_lists(discs: int, contacts: int) -> Arrays:
    """`Listed` for so many discs and contacts."""
    return numbers(discs + 1), numbers(contacts), maker(contacts)(contacts), numbers(discs), numbers(2, contacts)
