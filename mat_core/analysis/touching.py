"""Which boundary the discs of stretches of the axis touch, in the caller's terms.

Between two discs of the skeleton, on a strip, one footpoint runs up site a while the other runs down site b. A stretch of a
segment that covers a strip touches all of that strip's two boundary arcs; one that ends inside touches them up to the footpoints
of its end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.intervals import Intervals
from mat_core.axis import MedialAxis
from mat_core.kernels.layout import EDGE, LOOP, V0, V1

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_U = 1e-12  # of an edge's range of u: intervals this near to each other are one
SAME_ANGLE = 1e-9  # radians by which rounding may turn a contact


@dataclass(frozen=True, slots=True)
class BoundaryInterval:
    """A stretch of one edge, u0 <= u1 in the edge's own knots; a reflex vertex that is touched alone has u0 = u1."""

    loop: int
    edge: int
    u0: float
    u1: float

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers."""
        return {"loop": self.loop, "edge": self.edge, "u": [self.u0, self.u1]}


class StripRanges(NamedTuple):
    """The strips of all segments in order of travel: segment, strip (R,), forward (R,): from disc0 to disc1; t (R, 2)."""

    segment: Ints
    strip: Ints
    forward: NDArray[np.bool_]
    t: Floats


def strip_ranges(axis: MedialAxis) -> StripRanges:
    """Where on its segment each strip begins and ends."""
    c, runs = axis.curves, axis.runs
    segment, strip = c.part_segment, c.part_strip
    new = np.ones(len(strip), dtype=bool)
    new[1:] = (segment[1:] != segment[:-1]) | (strip[1:] != strip[:-1])
    first = np.nonzero(new)[0]
    last = np.append(first[1:], len(strip)) - 1 if len(strip) else first
    return StripRanges(segment[first], strip[first], runs.run_forward, np.column_stack((c.part_f[first, 0], c.part_f[last, 1])))


def facing_discs(axis: MedialAxis, angle: float) -> Ints:
    """Discs of the skeleton that are nodes or touch whole arcs, and have two contacts at least `angle` apart.

    Parameters
    ----------
    axis : MedialAxis
    angle : float
        Radians, 0 to pi.

    Returns
    -------
    (n,) int64
        Ids of discs, in increasing order. Discs at convex vertices have no two contacts and are not among them.
    """
    k = axis.skeleton
    wanted = np.unique(np.concatenate((axis.runs.node_disc, k.whole_i[:, 1])))
    wanted = wanted[k.disc[wanted, 2] > 0.0]
    by_disc = np.argsort(k.whole_i[:, 1], kind="stable")
    whole = np.searchsorted(k.whole_i[by_disc, 1], np.append(wanted, len(k.disc)))
    kept = []
    for n, d in enumerate(wanted.tolist()):
        rows = slice(int(k.contact_start[d]), int(k.contact_start[d + 1]))
        points = _angles(axis, d, k.contact_site[rows], k.contact_s[rows])
        arcs = by_disc[whole[n] : whole[n + 1]]
        begin = _angles(axis, d, k.whole_i[arcs, 0], k.whole_s[arcs, 0])
        end = _angles(axis, d, k.whole_i[arcs, 0], k.whole_s[arcs, 1])
        if _faces(points, begin, end, angle):
            kept.append(d)
    return np.array(kept, dtype=np.int64)


def _angles(axis: MedialAxis, disc: int, site: Ints, s: Floats) -> Floats:
    """Directions of contacts from the centre, in [0, 2 pi)."""
    to = axis._feet(site, s)[:, :2] - axis.skeleton.disc[disc, :2]
    out: Floats = np.mod(np.arctan2(to[:, 1], to[:, 0]), math.tau)
    return out


def _faces(points: Floats, begin: Floats, end: Floats, angle: float) -> bool:
    """Whether two contacts are at least `angle` apart: points, or points of whole arcs that run counter-clockwise."""
    sweep = np.mod(end - begin, math.tau)
    if (sweep >= angle - SAME_ANGLE).any():
        return True
    ends = np.sort(np.concatenate((points, begin, end)))
    if len(ends) < 2:
        return False
    # a contact faces every other between angle and 2 pi - angle ahead of it
    ring = np.concatenate((ends, ends + math.tau))
    low = np.searchsorted(ring, ends + angle - SAME_ANGLE)
    if (ring[np.minimum(low, len(ring) - 1)] <= ends + math.tau - angle + SAME_ANGLE).any():
        return True
    opposite = np.mod(ends[:, None] + math.pi - begin[None, :], math.tau)
    return bool((opposite <= sweep[None, :]).any())


def touched(axis: MedialAxis, stretches: Intervals, discs: Ints) -> tuple[BoundaryInterval, ...]:
    """The boundary that discs of stretches of the axis touch, and the whole arcs that the named discs touch.

    Parameters
    ----------
    axis : MedialAxis
    stretches : Intervals
    discs : (n,) int64
        Ids of discs of the skeleton.

    Returns
    -------
    tuple of BoundaryInterval
        In order of loop, edge and u; those that meet on an edge are one.
    """
    site, s, u = _strip_rows(axis, stretches)
    k = axis.skeleton
    whole = np.isin(k.whole_i[:, 1], discs)
    whole_site, whole_s = k.whole_i[whole, 0], k.whole_s[whole]
    whole_u = np.column_stack([axis._feet(whole_site, whole_s[:, end])[:, 2] for end in range(2)])
    site, s, u = np.concatenate((site, whole_site)), np.concatenate((s, whole_s)), np.concatenate((u, whole_u))
    return _merged(axis, site, s, u)


def _strip_rows(axis: MedialAxis, stretches: Intervals) -> tuple[Ints, Floats, Floats]:
    """(site, s, u) of the two boundary arcs of every part of a stretch that lies on one strip; s is nan inside a strip."""
    k, ranges = axis.skeleton, strip_ranges(axis)
    begin = np.searchsorted(ranges.segment, stretches.segment)
    end = np.searchsorted(ranges.segment, stretches.segment, side="right")
    rows = np.repeat(np.arange(len(begin)), end - begin)
    strips = np.arange(len(rows)) - np.repeat(np.cumsum(end - begin) - (end - begin), end - begin) + begin[rows]
    low = np.maximum(stretches.t[rows, 0], ranges.t[strips, 0])
    high = np.minimum(stretches.t[rows, 1], ranges.t[strips, 1])
    real = low < high
    low, high, place = low[real], high[real], strips[real]
    segment, strip, forward = ranges.segment[place], ranges.strip[place], ranges.forward[place]
    sites, s, u = [], [], []
    for side in range(2):
        site = k.strip_i[strip, side]
        own_s, own_u = np.full((len(strip), 2), np.nan), np.empty((len(strip), 2))
        for stop, at in enumerate((low, high)):
            corner = np.where(forward, stop, 1 - stop) + 2 * side
            exact = at == ranges.t[place, stop]
            own_s[exact, stop] = k.strip_s[strip[exact], corner[exact]]
            own_u[exact, stop] = axis._feet(site[exact], own_s[exact, stop])[:, 2]
            inner = np.nonzero(~exact)[0]
            found = axis.sample(segment[inner], at[inner])
            # going forward, site a is to the right
            right = forward[inner] == (side == 0)
            own_u[inner, stop] = np.where(right, found.right_u, found.left_u)
        sites.append(site)
        s.append(own_s)
        u.append(own_u)
    return np.concatenate(sites), np.concatenate(s), np.concatenate(u)


def _merged(axis: MedialAxis, site: Ints, s: Floats, u: Floats) -> tuple[BoundaryInterval, ...]:
    """Intervals of u on edges, merged; a vertex of its own is left out where an interval begins or ends at it."""
    si = axis.table.si
    low, high = u.min(axis=1, initial=math.inf), u.max(axis=1, initial=-math.inf)
    point = si[site, V0] == si[site, V1]
    ends = np.concatenate((si[site[~point & (s.min(axis=1, initial=1.0) == 0.0)], V0],
                           si[site[~point & (s.max(axis=1, initial=0.0) == 1.0)], V1]))
    kept = ~point | ~np.isin(si[site, V0], ends)
    site, low, high = site[kept], low[kept], high[kept]
    loop, edge = si[site, LOOP], si[site, EDGE]
    out: list[BoundaryInterval] = []
    for row in np.lexsort((high, low, edge, loop)).tolist():
        a, b = float(low[row]), float(high[row])
        key = (int(loop[row]), int(edge[row]))
        if out and (out[-1].loop, out[-1].edge) == key and a <= out[-1].u1 + SAME_U * _range(axis, *key):
            out[-1] = BoundaryInterval(*key, out[-1].u0, max(out[-1].u1, b))
        else:
            out.append(BoundaryInterval(*key, a, b))
    return tuple(out)


def _range(axis: MedialAxis, loop: int, edge: int) -> float:
    """Length of an edge's range of u."""
    a = axis.domain.arrays
    e = int(a.loop_start[loop]) + edge
    return float(a.knots[a.knot_start[e + 1] - 1] - a.knots[a.knot_start[e]])
