"""Solve all faces: small domains in one call, large ones in parts whose faces have about as many arcs, on several threads.

Faces share nothing but the discs that close them: a part has room of its own, and numbers its new discs from a place that no
other part can reach. Afterwards they are numbered on from those that were known, part by part.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.sites import SiteTable
from mat_core.errors import NotCertified
from mat_core.kernels.boxtree import STACK, Tree
from mat_core.kernels.curve import evaluate
from mat_core.threads import Bounds, cut, cut_between, each
from mat_core.topology.branches import LINK, SOLVE, solve_faces
from mat_core.topology.discs import NOT_EULER, OK

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def failure(table: SiteTable, site: int, what: str) -> NotCertified:
    """The honest error for trouble near a site: where, in the caller's coordinates."""
    x, y = evaluate(table.si, table.sf, table.cp, site, 0.0, 0.0, 0.0)[:2]
    place = (float(x / table.scale + table.origin[0]), float(y / table.scale + table.origin[1]))
    return NotCertified(what, place=place)


class Found(NamedTuple):
    """Discs told apart, and their contacts in loop order.

    discs, contacts: how many. disc, kind: room for more; site, s, owner and angle of each contact; arc a runs from contact a up
    to arc_hi[a], where contact next_contact[a] is.
    """

    discs: int
    contacts: int
    disc: Floats
    kind: Ints
    site: Ints
    s: Floats
    owner: Ints
    angle: Floats
    arc_hi: Floats
    next_contact: Ints


class Links(NamedTuple):
    """Room to tie n arcs of D discs to faces: around_start (D + 1,); place_around, next_arc, face_arcs (n,)."""

    around_start: Ints
    place_around: Ints
    next_arc: Ints
    face_arcs: Ints


class FaceRoom(NamedTuple):
    """Room to solve faces of n arcs in all, with c contacts known before.

    stack (STACK,): for walks through the tree of boxes. Faces: face_start, stack_i, stack_f, see `topology.branches`. Results:
    disc_of, contact_site, contact_s; strip_i, strip_s; whole_i, whole_s. The rest is for the face at hand.
    """

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

    @classmethod
    def of(cls, n: int, c: int) -> FaceRoom:
        """Three new contacts for each branch point, two for each disc that splits a large face."""
        rows = 4 * n + 64
        return cls(
            _numbers(STACK), _numbers(n + rows + 1), _rows_i(n + rows, 2), np.empty((n + rows, 2)), _numbers(c + rows),
            _numbers(c + rows), np.empty(c + rows), _rows_i(3 * n + 2, 4), np.empty((3 * n + 2, 4)), _rows_i(n, 2),
            np.empty((n, 2)), _rows_i(n, 2), np.empty((n, 2)), _numbers(4 * n + 8), np.empty(4 * n + 8), _numbers(n + 2),
            _rows_i(n + 4, 2), np.empty((n + 4, 2)), _numbers(3), np.empty(3), np.empty(3), np.empty(3))


def _numbers(n: int) -> Ints:
    return np.empty(n, dtype=np.int64)


def _rows_i(n: int, columns: int) -> Ints:
    return np.empty((n, columns), dtype=np.int64)


class Solved(NamedTuple):
    """All discs; disc_of, site, s of contacts in no order; strips and arcs in whole contact as in `skeleton.Skeleton`."""

    disc: Floats
    disc_of: Ints
    site: Ints
    s: Floats
    strip_i: Ints
    strip_s: Floats
    whole_i: Ints
    whole_s: Floats


class _Task(NamedTuple):
    """What every call of the kernel is given; `order`: contacts by disc and around it, `disc`: room for two more a contact."""

    t: SiteTable
    tree: Tree
    tie: float
    found: Found
    links: Links
    order: Ints
    disc: Floats

    def run(self, steps: int, faces: int, room: FaceRoom, discs: int, contacts: int, most: int) -> tuple[Solved, int]:
        """`solve_faces` with room for `most` discs, of which `discs` are there; what is there afterwards, and how many faces."""
        t, f = self.t, self.found
        status, discs, contacts, strips, wholes, place, made = solve_faces(
            steps, t.si, t.sf, t.cp, self.tree, self.tie, faces, f.owner, self.order, f.next_contact, f.arc_hi, self.links, room,
            self.disc[:most], discs, contacts)
        if status == NOT_EULER:
            raise failure(t, 0, f"the discs cut the domain into {made} faces where Euler's identity asks for {faces}")
        if status != OK:
            raise failure(t, int(place), "a branch point was not found where three or more parts of the boundary meet")
        return Solved(self.disc[:discs], room.disc_of[:contacts], room.contact_site[:contacts], room.contact_s[:contacts],
                      room.strip_i[:strips], room.strip_s[:strips], room.whole_i[:wholes], room.whole_s[:wholes]), made


def solve_all(t: SiteTable, tree: Tree, f: Found, tie: float, threads: int) -> tuple[Solved, int]:
    """All discs, contacts, strips and whole arcs, and the number of faces."""
    n = f.contacts
    expected = 1 - (len(t.loop_start) - 2) + n - f.discs
    disc = np.empty((f.discs + 2 * n, 3))
    disc[: f.discs] = f.disc[: f.discs]
    links = Links(_numbers(f.discs + 1), _numbers(n), _numbers(n), _numbers(n))
    task = _Task(t, tree, tie, f, links, np.lexsort((f.angle, f.owner)), disc)
    small = len(cut(n)) == 1
    room = FaceRoom.of(n if small else 0, n)
    room.contact_site[:n] = f.site
    room.contact_s[:n] = f.s
    if small:
        return task.run(LINK | SOLVE, expected, room, f.discs, n, len(disc))
    room = room._replace(face_start=_numbers(n + 1), stack_i=_rows_i(n, 2), stack_f=np.empty((n, 2)))
    known, faces = task.run(LINK, expected, room, f.discs, n, len(disc))
    nothing = _numbers(0)  # what tied the arcs to faces has done its work
    task = task._replace(links=Links(nothing, nothing, nothing, nothing), order=nothing)
    del links
    begins = room.face_start[:faces]
    made = each(lambda part: _solve_part(task, room, faces, part), cut_between(begins, n), threads)
    return _gathered(known, made), faces


def _solve_part(task: _Task, room: FaceRoom, faces: int, part: Bounds) -> tuple[int, Solved]:
    """The faces with the arcs from .. to - 1 of `room`: the number of the first new disc, and what is new."""
    first, last = part
    start = room.face_start[: faces + 1]
    start = start[np.searchsorted(start, first) : np.searchsorted(start, last) + 1] - first
    own = FaceRoom.of(last - first, 0)
    own.face_start[: len(start)] = start
    own.stack_i[: last - first] = room.stack_i[first:last]
    own.stack_f[: last - first] = room.stack_f[first:last]
    begin = task.found.discs + 2 * first
    made, _ = task.run(SOLVE, len(start) - 1, own, begin, 0, task.found.discs + 2 * last)
    # copies, for the room is five times as large
    return begin, Solved(made.disc[begin:], made.disc_of.copy(), made.site.copy(), made.s.copy(), made.strip_i.copy(),
                         made.strip_s.copy(), made.whole_i.copy(), made.whole_s.copy())


def _gathered(known: Solved, parts: list[tuple[int, Solved]]) -> Solved:
    """What all parts give in one, their discs numbered on from those that were known."""
    discs = before = len(known.disc)
    for begin, made in parts:
        for numbers in (made.disc_of, made.strip_i[:, 2:], made.whole_i[:, 1:]):
            numbers[numbers >= before] += discs - begin
        discs += len(made.disc)
    return Solved(*(np.concatenate(columns) for columns in zip(known, *(made for _, made in parts), strict=True)))
