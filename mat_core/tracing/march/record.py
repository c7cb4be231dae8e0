"""What a march knows: discs with their contacts, strips, and which parts of the boundary are not traced yet."""

from __future__ import annotations

import bisect
import math
from typing import NamedTuple

import numpy as np

from mat_core.boundary.sites import SiteTable
from mat_core.errors import NotCertified
from mat_core.kernels.curve import evaluate
from mat_core.kernels.layout import ARC_CONTACT, CONVEX_VERTEX, CORNER, EDGE, FAN, KIND, LEN, LOOP, NEXT, PREV, SWEEP, THROUGH
from mat_core.topology.skeleton import Skeleton

SNAP = 1e-11  # footpoints nearer than this to the end of an edge, or to a contact of a known disc, are there
TIE = 1e-11  # edges this near to the disc of a branch point touch it
INPUT_ROUNDING = 8.9e-16  # of a coordinate: nor are edges told apart that the input's own rounding may have moved
LARGEST_RADIUS = 0.5  # of a disc in a normalised domain


class Contact(NamedTuple):
    """A footpoint of a disc: s in [0, 1) on a site; the end of a site is the start of the next one."""

    site: int
    s: float


class Disc(NamedTuple):
    """A disc at an end of an edge or of a segment: x, y, r, its kind, its contacts anticlockwise, whole arcs among them."""

    x: float
    y: float
    r: float
    kind: int
    contacts: tuple[Contact, ...]
    whole: frozenset[int]


class Strip(NamedTuple):
    """A traced pair: right site from a0 up to a1, left site from b0 down to b1, between two discs."""

    a: int
    b: int
    disc0: int
    disc1: int
    a0: float
    a1: float
    b0: float
    b1: float


def lost(t: SiteTable, x: float, y: float, why: str) -> NotCertified:
    """The honest end of a march: where, in the caller's coordinates, and why."""
    place = (float(x / t.scale + t.origin[0]), float(y / t.scale + t.origin[1]))
    return NotCertified(f'march lost its way: {why}; a smaller step may help, method "discs" needs none', place)


class Record:
    """Discs, strips and untraced parts, growing while the march goes on.

    Attributes
    ----------
    table : SiteTable
    discs, strips : list
    open : list of list of (lo, hi)
        For each site the parts that are not traced (Proposition 1).
    is_open : ndarray of bool
        Whether a site has any.
    tie : float
        What is this near to the disc of a branch point touches it.
    """

    def __init__(self, table: SiteTable) -> None:
        self.table = table
        self.discs: list[Disc] = []
        self.strips: list[Strip] = []
        self.open: list[list[tuple[float, float]]] = [[(0.0, 1.0)] for _ in range(len(table.si))]
        self.tie = max(TIE, INPUT_ROUNDING * float(np.abs(table.origin).max()) * table.scale)
        self.is_open = np.ones(len(table.si), dtype=np.bool_)
        self._known: list[list[tuple[float, int]]] = [[] for _ in range(len(table.si))]

    # Places ------------------------------------------------------------------------------------------------------
    def next_site(self, site: int) -> int:
        """The site that begins where this one ends."""
        return int(self.table.si[site, NEXT])

    def previous_site(self, site: int) -> int:
        """The site that ends where this one begins."""
        return int(self.table.si[site, PREV])

    def is_convex(self, site: int) -> bool:
        """Whether a site starts at a convex vertex."""
        return bool(self.table.si[site, CORNER] == CONVEX_VERTEX)

    def named(self, a: int, b: int) -> str:
        """A pair of sites in the caller's terms."""
        si = self.table.si
        return " and ".join(f"edge {si[i, EDGE]} of loop {si[i, LOOP]}" for i in (a, b))

    def length(self, site: int) -> float:
        """Length of a site; of a fan the largest way that a centre can make about it."""
        if self.table.si[site, KIND] == FAN:
            return LARGEST_RADIUS * abs(float(self.table.sf[site, SWEEP]))
        return float(self.table.sf[site, LEN])

    def contact(self, site: int, s: float) -> Contact:
        """A footpoint in its one form: joints are starts, and what is next to a joint is the joint."""
        near = SNAP / max(self.length(site), SNAP)
        if s <= near:
            return Contact(site, 0.0)
        if s >= 1.0 - near:
            return Contact(self.next_site(site), 0.0)
        return Contact(site, s)

    def point(self, at: Contact) -> tuple[float, float]:
        """The place of a contact."""
        x, y, *_ = evaluate(self.table.si, self.table.sf, self.table.cp, at.site, at.s, 0.0, 0.0)
        return float(x), float(y)

    # Discs -------------------------------------------------------------------------------------------------------
    def add_disc(self, disc: Disc) -> int:
        """Take a disc in; its contacts become limits of later tracing."""
        number = len(self.discs)
        self.discs.append(disc)
        for at in disc.contacts:
            bisect.insort(self._known[at.site], (at.s, number))
        for site in disc.whole:
            self.mark(site, 0.0, 1.0)
        return number

    def disc_at(self, at: Contact) -> int:
        """The known disc with this contact, -1 if there is none."""
        known = self._known[at.site]
        near = SNAP / max(self.length(at.site), SNAP) if at.s > 0.0 else 0.0
        k = bisect.bisect_left(known, (at.s - near, -1))
        return known[k][1] if k < len(known) and known[k][0] <= at.s + near else -1

    def limit_up(self, site: int, s: float) -> float:
        """How far a footpoint may rise on a site: to the next known contact, else to the end."""
        known = self._known[site]
        k = bisect.bisect_right(known, (s, len(self.discs)))
        return known[k][0] if k < len(known) else 1.0

    def limit_down(self, site: int, s: float) -> float:
        """How far a footpoint may fall on a site: to the next known contact, else to the start."""
        known = self._known[site]
        k = bisect.bisect_left(known, (s, -1))
        return known[k - 1][0] if k > 0 else 0.0

    # Proposition 1 -----------------------------------------------------------------------------------------------
    def add_strip(self, strip: Strip) -> None:
        """Take a traced pair in; its sides need not be looked at again."""
        self.strips.append(strip)
        self.mark(strip.a, strip.a0, strip.a1)
        self.mark(strip.b, strip.b1, strip.b0)

    def mark(self, site: int, lo: float, hi: float) -> None:
        """Part lo .. hi of a site is traced."""
        left: list[tuple[float, float]] = []
        for begin, end in self.open[site]:
            left += [part for part in ((begin, min(end, lo)), (max(begin, hi), end)) if part[1] > part[0]]
        self.open[site] = left
        self.is_open[site] = bool(left)

    def check_complete(self) -> None:
        """All of the boundary is traced, else raise: the completeness of section 6, not of the graph but of the boundary."""
        t = self.table
        left = [
            (site, lo) for site, parts in enumerate(self.open) for lo, hi in parts if (hi - lo) * self.length(site) > SNAP
        ]
        if not left:
            return
        site, s = left[0]
        loop, edge = int(t.si[site, LOOP]), int(t.si[site, EDGE])
        x, y = self.point(Contact(site, s))
        traced = any(self.open[i] != [(0.0, 1.0)] for i in range(int(t.loop_start[loop]), int(t.loop_start[loop + 1])))
        what = f"edge {edge} of loop {loop}" if traced else f"loop {loop}"
        why = f"nothing is left to be traced, but {what} was never met by a disc (Proposition 2, or a step too long)"
        raise lost(t, x, y, why)

    # The result --------------------------------------------------------------------------------------------------
    def skeleton(self) -> Skeleton:
        """Everything as the stages that follow want it."""
        contacts = sorted((d, at.site, at.s) for d, disc in enumerate(self.discs) for at in disc.contacts)
        owner = np.array([d for d, _, _ in contacts], dtype=np.int64)
        wholes = [(site, d) for d, disc in enumerate(self.discs) for site in sorted(disc.whole)]
        return Skeleton(
            disc=np.array([(d.x, d.y, d.r) for d in self.discs]).reshape(-1, 3),
            disc_kind=np.array([d.kind for d in self.discs], dtype=np.int64),
            contact_start=np.searchsorted(owner, np.arange(len(self.discs) + 1)),
            contact_site=np.array([site for _, site, _ in contacts], dtype=np.int64),
            contact_s=np.array([s for _, _, s in contacts]),
            strip_i=np.array([strip[:4] for strip in self.strips], dtype=np.int64).reshape(-1, 4),
            strip_s=np.array([strip[4:] for strip in self.strips]).reshape(-1, 4),
            whole_i=np.array(wholes, dtype=np.int64).reshape(-1, 2),
            whole_s=np.tile((0.0, 1.0), (len(wholes), 1)),
            faces=len(self.strips) + len(wholes),
        )


def around(record: Record, x: float, y: float, contacts: list[Contact]) -> tuple[Contact, ...]:
    """Contacts anticlockwise about (x, y); those of nearly one direction as they follow each other on the boundary."""

    def angle(at: Contact) -> float:
        px, py = record.point(at)
        return math.atan2(py - y, px - x)

    ordered = sorted(contacts, key=lambda at: (angle(at), at))
    return tuple(ordered)


def disc_kind(whole: frozenset[int]) -> int:
    """Kind of a disc that touches more than one place."""
    return ARC_CONTACT if whole else THROUGH
