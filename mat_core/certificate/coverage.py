"""The boundary as the certificate sees it: closed loops, turned once, every bit owned by exactly one strip side.

Why this proves the degrees: walking along a loop, one interval ends and the next one begins at the same disc, so every
contact of a disc takes one end and one beginning of an interval. A strip that ends at a disc brings one of each (its
right side ends, its left side begins there), and so does an arc in whole contact. Hence, when nothing is left over,

    contacts of a disc = strips that end there + arcs in whole contact with it,

and no branch can be missing at a disc, nor one be there twice.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mat_core.boundary.sites import SiteTable
from mat_core.certificate.inputs import Discs, Floats, Ints
from mat_core.certificate.report import Report
from mat_core.kernels.layout import (
    ARC,
    CONVEX_VERTEX,
    CORNER,
    EDGE,
    FAN,
    K0,
    KIND,
    LEN,
    LINE,
    LOOP,
    NEXT,
    PREV,
    SPIRAL,
    SWEEP,
    TX0,
    TX1,
    TY0,
    TY1,
    X0,
    X1,
    Y0,
    Y1,
)
from mat_core.kernels.rows import edge_parameters, frames_at, spline_values
from mat_core.model.domain import Domain

NEARLY_SMOOTH = 0.1  # a joint without a vertex turns by less than this
ON_PIECE = 0.47  # where a piece is compared with the input's edge


class Owned(NamedTuple):
    """Intervals of the boundary that belong to a strip's side or to a whole contact, sorted by site and along it.

    site, lo, hi; the discs at lo and at hi.
    """

    site: Ints
    lo: Floats
    hi: Floats
    disc_lo: Ints
    disc_hi: Ints


def list_owned(skeleton: Discs) -> Owned:
    """All owned intervals."""
    i, s, wi, ws = skeleton.strip_i, skeleton.strip_s, skeleton.whole_i, skeleton.whole_s
    rows = np.concatenate((i[:, [0, 2, 3]], i[:, [1, 3, 2]], wi[:, [0, 1, 1]]))
    ends = np.concatenate((s[:, :2], s[:, [3, 2]], ws))
    # by the middle, so that ends that differ by rounding do not change the order
    order = np.lexsort((ends[:, 0] + ends[:, 1], rows[:, 0]))
    place = np.stack((rows[order, 0], ends[order, 0], ends[order, 1]))
    again = np.flatnonzero((place[:, 1:] == place[:, :-1]).all(axis=0) & (place[1, 1:] == place[2, 1:]))
    for group in np.split(again, np.flatnonzero(np.diff(again) > 1) + 1) if len(again) else ():
        members = order[group[0] : group[-1] + 2]
        order[group[0] : group[-1] + 2] = _chained(members, rows[members, 1].tolist(), rows[members, 2].tolist())
    site, disc_lo, disc_hi = rows[order].T.copy()
    lo, hi = ends[order].T.copy()
    return Owned(site, lo, hi, disc_lo, disc_hi)


def _chained(members: Ints, disc_lo: list[int], disc_hi: list[int]) -> Ints:
    """Intervals of no length at one point, which have no order of their own, such that each begins at the disc the last one ended
    at; as they were where that leaves some over.
    """
    begun = {disc: k for k, disc in enumerate(disc_lo)}
    k = next((k for k, disc in enumerate(disc_lo) if disc not in disc_hi), -1)
    chain: list[int] = []
    while k >= 0 and len(chain) < len(members):
        chain.append(k)
        k = begun.get(disc_hi[k], -1)
    return members[chain] if len(chain) == len(members) else members


def _turn(ax: Floats, ay: Floats, bx: Floats, by: Floats) -> Floats:
    """Angles from directions a to directions b."""
    angle: Floats = np.arctan2(ax * by - ay * bx, ax * bx + ay * by)
    return angle


def check_boundary(t: SiteTable, report: Report) -> Floats:
    """Loops close and turn once around, by +2 pi or, holes, by -2 pi; returns the turn at each smooth joint."""
    si, sf = t.si, t.sf
    before = si[:, PREV]
    last = sf[before]
    joint = sf[:, [X0, Y0]]
    gap = np.hypot(last[:, X1] - joint[:, 0], last[:, Y1] - joint[:, 1])
    count = np.diff(t.loop_start)
    cyclic = np.arange(len(si)) - 1
    cyclic[t.loop_start[:-1]] += count
    gap[(before != cyclic) | (si[cyclic, NEXT] != np.arange(len(si)))] = np.inf
    report.worst("boundary", gap, joint)

    kind = si[:, KIND]
    at_joint = _turn(last[:, TX1], last[:, TY1], sf[:, TX0], sf[:, TY0])
    corner = si[:, CORNER] == CONVEX_VERTEX
    at_joint[corner & (at_joint < -0.5 * np.pi)] += 2.0 * np.pi
    inside = np.where(
        kind == SPIRAL, _turn(sf[:, TX0], sf[:, TY0], sf[:, TX1], sf[:, TY1]), np.where(kind == LINE, 0.0, sf[:, SWEEP])
    )
    total: Floats = np.bincount(si[:, LOOP], weights=at_joint + inside, minlength=len(count)).astype(np.float64)
    total[0] -= 2.0 * np.pi
    total[1:] += 2.0 * np.pi
    report.worst("turning", np.abs(total), joint[t.loop_start[:-1]])
    smooth = np.where(corner, 0.0, np.abs(at_joint))
    report.worst("turning", np.where(smooth > NEARLY_SMOOTH, smooth, 0.0), joint)
    return smooth


def check_edges(t: SiteTable, domain: Domain, report: Report) -> None:
    """Every piece lies on the input's edge that it names, at the parameter that it names."""
    a = domain.arrays
    site = np.flatnonzero(t.si[:, KIND] != FAN)
    s = np.full(len(site), ON_PIECE)
    frame = np.empty((len(site), 4))
    frames_at(t.si, t.sf, t.cp, site, s, frame)
    u = np.empty(len(site))
    edge_parameters(t.si, t.sf, t.cp, site, s, u)
    edge = a.loop_start[t.si[site, LOOP]] + t.si[site, EDGE]
    point = np.empty((len(site), 2))
    spline_values(
        a.degree, a.knot_start, a.knots, a.cp_start, a.cp, 2, edge, u, np.empty((int(a.degree.max()) + 1, 3)), point
    )
    off = (point - t.origin) * t.scale - frame[:, :2]
    report.worst("boundary", np.hypot(off[:, 0], off[:, 1]), frame)


def check_coverage(t: SiteTable, disc: Floats, owned: Owned, report: Report) -> None:
    """No gap, no overlap, and one disc where two intervals meet."""
    si, sf = t.si, t.sf
    site, lo, hi, disc_lo, disc_hi = owned
    n = len(si)
    count = np.bincount(site, minlength=n)
    after = np.cumsum(count)
    first = after - count
    starts = sf[:, [X0, Y0]]
    ends = sf[:, [X1, Y1]]

    # a length for a part of a site: on a fan that of the way of the disc's centre
    length = np.where(si[site, KIND] == FAN, np.abs(sf[site, SWEEP]) * disc[disc_lo, 2], sf[site, LEN])
    reached = np.empty(len(site))
    reached[1:] = hi[:-1]
    has = count > 0
    reached[first[has]] = 0.0
    report.worst("coverage", np.abs(lo - reached) * length, starts[site])
    report.worst("coverage", (lo - hi) * length, starts[site])
    final = after[has] - 1
    report.worst("coverage", np.abs(1.0 - hi[final]) * length[final], ends[site[final]])
    report.worst("coverage", np.where(has, 0.0, np.maximum(sf[:, LEN], np.abs(sf[:, SWEEP]))), starts)

    if has.all():
        # the interval that follows each one: the next of its site, or the first of the next site
        following = np.arange(1, len(site) + 1)
        following[after - 1] = first[si[:, NEXT]]
        report.faults("neighbours", disc_hi != disc_lo[following], disc[disc_hi])
    else:
        report.faults("neighbours", ~has, starts)


def check_whole(t: SiteTable, skeleton: Discs, report: Report) -> None:
    """An arc in whole contact lies on its disc's circle, at both ends, in the middle and in between, unless it is tiny.

    Its distance from that circle is a sine of amplitude `away`, the distance of the centres: between three points in a turn of
    `sweep` it can rise by away (1 - cos(sweep / 4)). The centres themselves may differ more, where the arc is short.
    """
    site, owner = skeleton.whole_i.T.copy()  # rows of their own: kernels are compiled anew for strided arrays
    row = t.sf[site]
    disc = skeleton.disc[owner]
    begin, end = skeleton.whole_s.T
    arc = (t.si[site, KIND] == ARC) & (row[:, K0] > 0.0)
    rho = 1.0 / np.where(arc, row[:, K0], 1.0)
    away = np.hypot(row[:, X0] - rho * row[:, TY0] - disc[:, 0], row[:, Y0] + rho * row[:, TX0] - disc[:, 1])
    off = away * (1.0 - np.cos(0.25 * np.minimum(np.abs((end - begin) * row[:, SWEEP]), np.pi)))
    frame = np.empty((len(site), 4))
    farthest = np.zeros(len(site))
    for share in (0.0, 0.5, 1.0):
        frames_at(t.si, t.sf, t.cp, site, begin + share * (end - begin), frame)
        reached = np.hypot(frame[:, 0] - disc[:, 0], frame[:, 1] - disc[:, 1])
        farthest = np.maximum(farthest, np.abs(reached - disc[:, 2]))
    off = np.where(arc & (away < rho), off + farthest, np.inf)
    report.worst("whole_arcs", np.minimum(off, np.abs((end - begin) * row[:, LEN])), disc)
