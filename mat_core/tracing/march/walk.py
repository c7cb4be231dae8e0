"""Sections 4, 5.3, 5.5 and 5.6: from a convex vertex along pairs of edges to branch points and on, until nothing is left.

1. start at a convex vertex                                                   4, 5.1
2. trace a pair, checking every `check_step` steps                            5.1, 5.2
3. where the distance check fails: bisect, note the branch point              5.2
   where the curvature check fails: first trace from the LMPC ahead           5.3
   where a footpoint reaches the end of its edge: the neighbouring edge       5.4, 5.5
   where both reach the joint that they share: a convex vertex or an LMPC     5.5
   where they reach the footpoints of a known disc: the segment ends there
4. take the next pair that waits at any disc; depth first                     5.3
5. a convex vertex that was not met starts anew; else stop                    5.6
"""

from __future__ import annotations

import math

from mat_core.boundary.sites import SiteTable
from mat_core.kernels.curve import evaluate
from mat_core.kernels.layout import ARC, CONVEX_VERTEX, CORNER, CURVATURE_LEAF, K0, K1, KIND, VERTEX_LEAF
from mat_core.tracing.march.branch import bisect_branch, curvature_ahead, halves_of, make_disc, pair_from
from mat_core.tracing.march.checks import cut_beside, cutting, violating_foot
from mat_core.tracing.march.footpoint import AxisPoint, axis_point
from mat_core.tracing.march.record import Contact, Disc, Record, Strip, lost
from mat_core.tracing.march.step import Limits, Pair, limits_of, parameter_step, tracing_step

AGREE = 1e-7  # discs reached from two sides are one if centres and radii differ by less; the certificate asks for more
MOST_PUT_OFF = 8  # times that a pair waits for the trace from an LMPC ahead
MOST_DISCS = 64  # for each edge: far beyond what an axis has, so that nothing is done for ever


class March:
    """One march.

    Attributes
    ----------
    record : Record
        What is known by now.
    step : float
        Tracing step, normalised.
    check_step : int
        Tracing steps from check to check.
    steps : int
        Tracing steps taken.
    """

    def __init__(self, table: SiteTable, step: float, check_step: int) -> None:
        self.record = Record(table)
        self.step = step
        self.check_step = check_step
        self.steps = 0
        self._waiting: list[Pair] = []
        self._done: set[tuple[int, int]] = set()  # (disc, half) from which a pair was traced, or at which one arrived
        self._met: set[int] = set()  # discs whose pairs were made to wait
        self._ahead: dict[tuple[int, int], int] = {}  # (disc, half) of a pair that was set aside -> the LMPC's disc it waits for

    def run(self) -> None:
        """Steps 1, 4 and 5."""
        t = self.record.table
        for site in range(len(t.si)):
            if t.si[site, CORNER] != CONVEX_VERTEX or self.record.disc_at(Contact(site, 0.0)) >= 0:
                continue
            self._start(Contact(site, 0.0), 0.0)
            while self._waiting:
                pair = self._waiting.pop()
                if (pair.disc, pair.half) not in self._done:
                    self._trace(pair)
        self.record.check_complete()

    # 1. Where segments start --------------------------------------------------------------------------------------
    def _start(self, at: Contact, r: float) -> None:
        """A leaf: both footpoints at a convex vertex (r = 0) or at an LMPC; its pair waits."""
        leaf = self._add_leaf(at, r)
        self._met.add(leaf)
        self._wait(leaf, from_branch=False)

    def _add_leaf(self, at: Contact, r: float) -> int:
        """The disc of a convex vertex or of an LMPC."""
        x, y = self._centre(at, r)
        return self.record.add_disc(Disc(x, y, r, CURVATURE_LEAF if r > 0.0 else VERTEX_LEAF, (at,), frozenset()))

    def _centre(self, at: Contact, r: float) -> tuple[float, float]:
        """Centre of the disc of radius r that touches at a joint, along the mean of both normals."""
        t = self.record.table
        before = evaluate(t.si, t.sf, t.cp, self.record.previous_site(at.site), 1.0, 0.0, 0.0)
        x, y, tx, ty, _, _ = evaluate(t.si, t.sf, t.cp, at.site, 0.0, 0.0, 0.0)
        if r == 0.0:
            return x, y
        tx, ty = tx + before[2], ty + before[3]
        length = math.hypot(tx, ty)
        return x - r * ty / length, y + r * tx / length

    def _curvature(self, at: Contact) -> float:
        """Of the boundary at a joint, the larger one of both sides."""
        t = self.record.table
        return float(max(t.sf[self.record.previous_site(at.site), K1], t.sf[at.site, K0]))

    def _bends(self, at: Contact) -> bool:
        """Whether a disc may end at a joint: the boundary is convex there."""
        return self.record.is_convex(at.site) or self._curvature(at) > 0.0

    def _leaf_radius(self, at: Contact) -> float:
        """0 at a convex vertex, else that of the larger curvature; raises where that is no maximum."""
        if self.record.is_convex(at.site):
            return 0.0
        if not self._bends(at):
            x, y = self.record.point(at)
            raise lost(self.record.table, x, y, "both footpoints meet where the boundary is not convex")
        return 1.0 / self._curvature(at)

    def _wait(self, disc: int, from_branch: bool, arrived: int = -1) -> None:
        """All pairs that leave a disc wait, but for the one that arrived there; the last to come is the first to be traced."""
        for half in reversed(halves_of(self.record.discs[disc], self.record)):
            if half != arrived:
                self._waiting.append(pair_from(self.record, disc, half, from_branch))

    # 2. One pair of edges -----------------------------------------------------------------------------------------
    def _trace(self, pair: Pair) -> None:
        """Follow one pair to where it ends.

        `now` is the last axis point, `good` the last that passed the distance check, where a bisection may start.
        """
        record = self.record
        t = record.table
        limits = limits_of(record, pair)
        now = good = self._where(pair)
        du = parameter_step(record, pair.a, self.step)
        exempt = pair.from_branch and limits.closing and self.record.is_convex(pair.b)
        taken = 0
        pace = 0.0
        while True:
            point, ended = tracing_step(record, pair, now, du, pace, limits)
            self.steps += 1
            taken += 1
            if point is None:
                if ended:
                    self._reach_joint(pair, good, exempt)
                else:
                    self._branch(pair, good, min(now.right + du, limits.right), limits.left, [])
                return
            foot = violating_foot(t, pair.a, pair.b, point)
            if foot != 0:
                self._missed(pair, good, point, foot, cutting(record, pair.a, pair.b, point.x, point.y, point.r))
                return
            known = self._known_end(pair, point, limits) if ended else -1
            if known >= 0 and self._agrees(point, known):
                self._arrive(pair, point, known)
                return
            if ended or (taken % self.check_step == 0 and not exempt):
                cut = cutting(record, pair.a, pair.b, point.x, point.y, point.r)
                if cut:
                    self._missed(pair, good, point, cut_beside(t, pair.a, pair.b, cut), cut)
                    return
                good = point
            if ended:
                self._arrive(pair, point, known if known >= 0 else self._disc_of(pair, point, []))
                return
            pace = now.left - point.left
            now = point

    def _where(self, pair: Pair) -> AxisPoint:
        """Where a pair starts, or was set aside."""
        if (pair.right, pair.left) == (pair.a0, pair.b0):
            disc = self.record.discs[pair.disc]
            return AxisPoint(disc.x, disc.y, disc.r, pair.right, pair.left)
        point = axis_point(self.record.table, pair.a, pair.right, pair.b, pair.left)
        assert point is not None  # it was found there before
        return point

    # 3. Where a pair ends -----------------------------------------------------------------------------------------
    def _branch(self, pair: Pair, good: AxisPoint, right: float, left: float, cut: list[Contact]) -> None:
        """5.2: the branch point between a good axis point and footpoints that are too far."""
        point, cut = bisect_branch(self.record, pair, good, right, left, cut)
        if not cut:
            why = f"the trace of {self.record.named(pair.a, pair.b)} ends where no third edge touches the disc"
            raise lost(self.record.table, point.x, point.y, why)
        self._arrive(pair, point, self._disc_of(pair, point, cut))

    def _missed(self, pair: Pair, good: AxisPoint, point: AxisPoint, foot: int, cut: list[Contact]) -> None:
        """A branch point lies before an axis point that fails a check: 5.3 where that is due to the pair's own side `foot`.

        The edge that runs on from a footpoint cuts the disc, or bends more than it: then the axis is traced from the centre of
        curvature of the LMPC ahead first, and the pair goes on to the branch point found so. That is far better conditioned than
        to see when the disc begins to touch an edge that it nearly osculates. Where the disc of that LMPC is not empty it is no
        end of the axis: another edge was passed, and bisection finds it, as where a convex vertex is ahead. Two LMPCs that share
        a branch point are each ahead of the other: there the one of the larger disc, nearer to the branch point, leads on.
        """
        record = self.record
        if foot != 0:
            at = curvature_ahead(record, pair.a if foot > 0 else pair.b, foot > 0)
            leaf = record.disc_at(at)
            if leaf < 0 and self._ends_axis(at):
                self._set_aside(pair, good, len(self._waiting))
                self._start(at, self._leaf_radius(at))
                self._ahead[pair.disc, pair.half] = record.disc_at(at)
                return
            beside = {record.next_site(pair.a), record.previous_site(pair.b)}
            alone = all(touched.site in beside for touched in cut) and not self._leads(pair, leaf)
            if leaf >= 0 and (leaf, 0) not in self._done and alone and pair.put_off < MOST_PUT_OFF:
                self._set_aside(pair, good, 0)
                self._ahead[pair.disc, pair.half] = leaf
                return
        self._branch(pair, good, point.right, point.left, cut)

    def _leads(self, pair: Pair, leaf: int) -> bool:
        """Whether the pair from a leaf waits for this one, whose disc is the larger."""
        discs = self.record.discs
        return self._ahead.get((leaf, 0)) == pair.disc and discs[pair.disc].r >= discs[leaf].r

    def _set_aside(self, pair: Pair, good: AxisPoint, place: int) -> None:
        """A pair waits at its last good point: for those after `place` in the row."""
        pair.right, pair.left = good.right, good.left
        pair.put_off += 1
        self._waiting.insert(place, pair)

    def _ends_axis(self, at: Contact) -> bool:
        """Whether a joint is an LMPC whose disc is empty, with no arc in whole contact with it."""
        record = self.record
        before = record.previous_site(at.site)
        arc = ARC in (record.table.si[at.site, KIND], record.table.si[before, KIND])
        if arc or self.record.is_convex(at.site) or not self._bends(at):
            return False
        r = self._leaf_radius(at)
        return not cutting(record, at.site, before, *self._centre(at, r), r)

    def _reach_joint(self, pair: Pair, good: AxisPoint, exempt: bool) -> None:
        """5.5: both footpoints come to the joint that their edges share: a convex vertex, or an LMPC."""
        record = self.record
        at = Contact(pair.b, 0.0)
        leaf = record.disc_at(at)
        if leaf < 0:
            r = self._leaf_radius(at)
            x, y = self._centre(at, r)
            cut = [] if exempt else cutting(record, pair.a, pair.b, x, y, r)
            if cut:
                self._branch(pair, good, 1.0, 0.0, cut)
                return
            leaf = self._add_leaf(at, r)
        disc = record.discs[leaf]
        self._arrive(pair, AxisPoint(disc.x, disc.y, disc.r, 1.0, 0.0), leaf)

    def _known_end(self, pair: Pair, point: AxisPoint, limits: Limits) -> int:
        """The known disc with a footpoint at the limit that is reached, -1 if there is none."""
        record = self.record
        for site, s, limit in ((pair.a, point.right, limits.right), (pair.b, point.left, limits.left)):
            known = record.disc_at(record.contact(site, s)) if s == limit else -1
            if known >= 0:
                return known
        return -1

    def _disc_of(self, pair: Pair, point: AxisPoint, cut: list[Contact]) -> int:
        """The disc of an axis point where a pair ends: one that is known, or a new one, whose pairs then wait."""
        record = self.record
        disc = make_disc(record, pair, point, cut)
        for at in disc.contacts:
            known = record.disc_at(at)
            if known >= 0:
                return known
        if len(record.discs) > MOST_DISCS * len(record.table.si) + MOST_DISCS:
            raise lost(record.table, point.x, point.y, "there are more discs than any axis of this boundary can have")
        return record.add_disc(disc)

    def _arrive(self, pair: Pair, point: AxisPoint, number: int) -> None:
        """The pair ends at a disc: note its strip, and let the pairs that leave a new disc wait."""
        record = self.record
        disc = record.discs[number]
        half, right, left = self._half_of(pair, point, disc)
        taken = (number, half) in self._done or (number, half) == (pair.disc, pair.half)
        if half < 0 or taken or not self._agrees(point, number):
            edges = record.named(pair.a, pair.b)
            why = f"tracing {edges} ends at a disc that has other footpoints, so a branch point was missed before"
            raise lost(record.table, point.x, point.y, why)
        record.add_strip(Strip(pair.a, pair.b, pair.disc, number, pair.a0, right, pair.b0, left))
        self._done |= {(pair.disc, pair.half), (number, half)}
        if number not in self._met:
            self._met.add(number)
            self._wait(number, pair.from_branch, half)

    def _agrees(self, point: AxisPoint, number: int) -> bool:
        """Whether the disc of an axis point is a known one."""
        disc = self.record.discs[number]
        return math.hypot(disc.x - point.x, disc.y - point.y) + abs(disc.r - point.r) <= AGREE

    def _half_of(self, pair: Pair, point: AxisPoint, disc: Disc) -> tuple[int, float, float]:
        """(contact, right, left): the contact of a disc that the left footpoint has come to, the right one to the next; or -1."""
        record = self.record
        best = (-1, point.right, point.left)
        nearest = math.inf
        for half, down in enumerate(disc.contacts):
            up = disc.contacts[(half + 1) % len(disc.contacts)]
            right = 1.0 if up == Contact(record.next_site(pair.a), 0.0) else up.s
            if down.site != pair.b or (right < 1.0 and up.site != pair.a) or right < pair.a0 or down.s > pair.b0:
                continue
            off = abs(right - point.right) * record.length(pair.a) + abs(down.s - point.left) * record.length(pair.b)
            if off < nearest:
                nearest = off
                best = (half, right, down.s)
        return best
