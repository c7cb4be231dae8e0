"""Solve all faces: small domains in one call, large ones in parts whose faces have about as many arcs, on several threads.

Faces share nothing but the discs that close them: a part has room of its own, and numbers its new discs from a place that no
other part can reach. Afterwards they are numbered on from those that were known, part by part.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mat_core.boundary.sites import SiteTable
from mat_core.errors import NotCertified
from mat_core.kernels.boxtree import STACK
from mat_core.kernels.curve import evaluate
from mat_core.memory import joined, joined_one_by_one, maker
from mat_core.threads import Bounds, cut, cut_between, each
from mat_core.topology.branches import LINK, LIST, SOLVE, solve_faces
from mat_core.topology.discs import NOT_EULER, OK
from mat_core.topology.rooms import DISC_OF, Arrays, FaceRoom, Listed, numbers, room_for_faces, room_for_lists
from mat_core.topology.skeleton import Skeleton


def failure(table: SiteTable, site: int, what: str) -> NotCertified:
    """The honest error for trouble near a site: where, in the caller's coordinates."""
    x, y = evaluate(table.si, table.sf, table.cp, site, 0.0, 0.0, 0.0)[:2]
    place = (float(x / table.scale + table.origin[0]), float(y / table.scale + table.origin[1]))
    return NotCertified(what, place=place)


class Counts(NamedTuple):
    """How many there are: of discs, contacts, strips and arcs in whole contact; and of faces."""

    discs: int
    contacts: int
    strips: int
    wholes: int
    faces: int


class Part(NamedTuple):
    """What a part gives: its discs, numbered from `begin` on, contacts in no order, strips and arcs in whole contact."""

    begin: int
    disc: Any
    contact_i: Any
    contact_s: Any
    strip_i: Any
    strip_s: Any
    whole_i: Any
    whole_s: Any

    @classmethod
    def of(cls, begin: int, disc: Any, room: FaceRoom, n: Counts) -> Part:
        """Copies of what is filled, for the room is five times as large."""
        return cls(begin, disc[begin : n.discs], room.contact_i[:, : n.contacts].copy(), room.contact_s[: n.contacts].copy(),
                   room.strip_i[: n.strips].copy(), room.strip_s[: n.strips].copy(), room.whole_i[: n.wholes].copy(),
                   room.whole_s[: n.wholes].copy())


class _Task(NamedTuple):
    """What every call of the kernel is given; disc: room for two more a contact, of which `known` were found at joints."""

    t: SiteTable
    tree: Arrays
    tie: float
    faces: int
    found: Arrays
    disc: Any
    known: int

    def run(
        self, steps: int, links: Any, room: Arrays, listed: Arrays, faces: int, disc: Any, discs: int, contacts: int
    ) -> Counts:
        """`solve_faces` with the room for discs `disc`, of which `discs` are there; what is there afterwards."""
        t = self.t
        status, discs, contacts, strips, wholes, place, made = solve_faces(
            steps, t.si, t.sf, t.cp, self.tree, numbers(STACK), self.tie, faces, self.found, links, tuple(room), tuple(listed),
            disc, self.known, discs, contacts)
        if status == NOT_EULER:
            raise failure(t, 0, f"the discs cut the domain into {made} faces where Euler's identity asks for {faces}")
        if status != OK:
            raise failure(t, int(place), "a branch point was not found where three or more parts of the boundary meet")
        return Counts(discs, contacts, strips, wholes, made)


_NOTHING = numbers(0, 0)
_NO_LISTS = room_for_lists(0, 0)


def solve_all(t: SiteTable, tree: Arrays, found: Arrays, discs: int, contacts: int, tie: float, threads: int) -> Skeleton:
    """All discs, contacts, strips and whole arcs, from discs told apart and their contacts."""
    faces = 1 - (len(t.loop_start) - 2) + contacts - discs
    disc = maker(contacts)((discs + 2 * contacts, 3))
    disc[:discs] = found[0][:discs]
    task = _Task(t, tree, tie, faces, found, disc, discs)
    if len(cut(contacts)) > 1:
        return _solve_in_parts(task, discs, contacts, threads)
    links = numbers(5, max(discs + 1, contacts))
    room = room_for_faces(contacts, contacts)
    listed = room_for_lists(len(disc), len(room[4]))
    n = task.run(LINK | SOLVE | LIST, links, room, listed, faces, disc, discs, contacts)
    return _skeleton(disc, FaceRoom(*room), Listed(*listed), n)


def _skeleton(disc: Any, room: FaceRoom, listed: Listed, n: Counts) -> Skeleton:
    """The filled rows."""
    return Skeleton(
        disc[: n.discs], listed.kind[: n.discs], listed.start[: n.discs + 1], listed.site[: n.contacts], listed.s[: n.contacts],
        room.strip_i[: n.strips], room.strip_s[: n.strips], room.whole_i[: n.wholes], room.whole_s[: n.wholes], n.faces)


def _solve_in_parts(task: _Task, discs: int, contacts: int, threads: int) -> Skeleton:
    """The same on several threads."""
    disc, room, n = _gathered(task, _solve_parts(task, discs, contacts, threads))
    listed = Listed(*room_for_lists(n.discs, n.contacts))
    task.run(LIST, _NOTHING, room, listed, task.faces, disc, n.discs, n.contacts)
    return _skeleton(disc, room, listed, n)


def _solve_parts(task: _Task, discs: int, contacts: int, threads: int) -> list[Part]:
    """What was known before, and what each part gives."""
    room = FaceRoom(*room_for_faces(0, contacts))
    room = room._replace(
        face_start=numbers(contacts + 1), stack_i=numbers(contacts, 2), stack_f=maker(contacts)((contacts, 2)))
    task.run(LINK, numbers(5, max(discs + 1, contacts)), room, _NO_LISTS, task.faces, task.disc, discs, contacts)
    known = Part.of(discs, task.disc, room, Counts(discs, contacts, 0, 0, task.faces))
    parts = cut_between(room.face_start[: task.faces], contacts)
    return [known, *each(lambda part: _solve_part(task, room, part), parts, threads)]


def _solve_part(task: _Task, room: FaceRoom, part: Bounds) -> Part:
    """The faces with the arcs from .. to - 1 of `room`."""
    first, last = part
    start = room.face_start[: task.faces + 1]
    start = start[np.searchsorted(start, first) : np.searchsorted(start, last) + 1] - first
    own = FaceRoom(*room_for_faces(last - first, 0))
    own.face_start[: len(start)] = start
    own.stack_i[: last - first] = room.stack_i[first:last]
    own.stack_f[: last - first] = room.stack_f[first:last]
    begin = task.known + 2 * first
    n = task.run(SOLVE, _NOTHING, own, _NO_LISTS, len(start) - 1, task.disc[: task.known + 2 * last], begin, 0)
    return Part.of(begin, task.disc, own, n)


def _gathered(task: _Task, every: list[Part]) -> tuple[Any, FaceRoom, Counts]:
    """What all parts give in one, their discs numbered on from those that were known, which the first one tells."""
    discs = task.known
    made = every[1:]
    for part in made:
        for discs_of in (part.contact_i[DISC_OF], part.strip_i[:, 2:], part.whole_i[:, 1:]):
            discs_of[discs_of >= task.known] += discs - part.begin
        discs += len(part.disc)
    disc = joined([task.disc[: task.known], *(part.disc for part in made)])
    contact_i = joined([part.contact_i for part in every], axis=1)
    names = ("contact_s", "strip_i", "strip_s", "whole_i", "whole_s")
    columns: list[Any] = [[getattr(part, name) for part in every] for name in names]
    made.clear()
    every.clear()
    found = dict(zip(names, joined_one_by_one(columns), strict=True))
    room = FaceRoom(*room_for_faces(0, 0))._replace(contact_i=contact_i, **found)
    return disc, room, Counts(discs, len(room.contact_s), len(room.strip_i), len(room.whole_i), task.faces)
