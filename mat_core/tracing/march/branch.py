"""Sections 5.2 and 5.3: bisection back to a branch point, its footpoints, and the pairs that leave it."""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.layout import FAN, K0, K1, KIND
from mat_core.tracing.march.checks import curvature_holds, cutting, touching
from mat_core.tracing.march.footpoint import AxisPoint
from mat_core.tracing.march.record import Contact, Disc, Record, around, disc_kind
from mat_core.tracing.march.step import Pair, point_between

HALVINGS = 60
SAME_FOOT = 1e-5  # footpoints of a disc nearer than this, over its radius, are one


def bisect_branch(record: Record, pair: Pair, good: AxisPoint, right: float, left: float,
                  cut: list[Contact]) -> tuple[AxisPoint, list[Contact]]:
    """The last axis point before the disc is cut, and where edges cut it just after; section 5.2.

    `good` passes the checks, footpoints `right` and `left` do not (by `cut`; empty where it is the curvature criterion, or
    where no left footpoint belongs to the right one).
    """
    t = record.table
    for _ in range(HALVINGS):
        middle = 0.5 * (good.right + right)
        if middle in (good.right, right):
            break
        point = point_between(record, pair, good, middle, left)
        found = cutting(record, pair.a, pair.b, point.x, point.y, point.r) if point is not None else []
        if found:
            cut = found
        if point is None:
            right = middle
        elif found or not curvature_holds(t, pair.a, pair.b, point):
            right, left = middle, point.left
        else:
            good = point
    return good, cut


def make_disc(record: Record, pair: Pair, p: AxisPoint, cut: list[Contact]) -> Disc:
    """The disc of an axis point with all of its footpoints: of the pair, of edges that cut it next, and of those that tie."""
    own = [record.contact(pair.a, p.right), record.contact(pair.b, p.left)]
    more, whole = touching(record, pair.a, pair.b, p.x, p.y, p.r)
    kept = list(dict.fromkeys([*own, *(at for at in more if at.site in whole or record.previous_site(at.site) in whole)]))
    more += cut
    more.sort(key=lambda at: _slant(record, at, p))
    for at in more:
        if at not in kept and all(_apart(record, at, other) > SAME_FOOT * p.r for other in kept):
            kept.append(at)
    contacts = around(record, p.x, p.y, kept)
    flat = frozenset(whole)
    return Disc(p.x, p.y, p.r, disc_kind(flat), contacts, flat)


def _slant(record: Record, at: Contact, p: AxisPoint) -> float:
    """How far the normal at a contact misses the centre."""
    t = record.table
    dx, dy, tx, ty, _, _ = evaluate(t.si, t.sf, t.cp, at.site, at.s, p.x, p.y)
    return abs(float(dx * tx + dy * ty))


def _apart(record: Record, one: Contact, other: Contact) -> float:
    """Distance of two contacts."""
    ax, ay = record.point(one)
    bx, by = record.point(other)
    return math.hypot(ax - bx, ay - by)


def pair_from(record: Record, disc: int, half: int, from_branch: bool) -> Pair:
    """Section 5.3: the pair between two neighbouring footpoints of a disc.

    The right footpoint leaves contact `half` upwards, the left one the next contact (anticlockwise) downwards.
    """
    contacts = record.discs[disc].contacts
    at = contacts[half]
    other = contacts[(half + 1) % len(contacts)]
    b, left = (record.previous_site(other.site), 1.0) if other.s == 0.0 else other
    return Pair(disc, half, at.site, b, at.s, left, at.s, left, from_branch or len(contacts) > 2)


def halves_of(disc: Disc, record: Record) -> list[int]:
    """The contacts of a disc that a pair leaves upwards: all but those from which a whole arc leads to the next one."""
    n = len(disc.contacts)
    return [
        half
        for half, at in enumerate(disc.contacts)
        if not (
            at.s == 0.0
            and at.site in disc.whole
            and disc.contacts[(half + 1) % n] == Contact(record.next_site(at.site), 0.0)
        )
    ]


def curvature_ahead(record: Record, site: int, upwards: bool) -> Contact:
    """Section 5.3: the joint ahead of a footpoint where the curvature is locally maximal (LMPC), or a convex vertex."""
    t = record.table
    for _ in range(len(t.si)):
        joint = record.next_site(site) if upwards else site
        following = joint if upwards else record.previous_site(joint)
        if t.si[following, KIND] == FAN:
            return Contact(joint, 0.0)
        here, far = (K1, K0) if upwards else (K0, K1)
        begins, ends = t.sf[following, far], t.sf[following, here]
        if begins < t.sf[site, here] or ends <= begins:
            return Contact(joint, 0.0)
        site = following
    return Contact(site, 0.0)
