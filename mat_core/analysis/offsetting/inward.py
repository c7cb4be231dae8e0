r"""Offsets: everything at a distance d from the boundary, as closed loops trimmed by the medial axis.

A boundary point takes part in the offset just when the radius of its own maximal disc is larger than d. So the offset is
read off the axis, and no crossing is ever searched for:

1. discs are larger than d or not; where r passes d along a strip is a corner of the offset (`level`);
2. what is left of a strip gives two arcs, one on each side; an arc ends at a corner, where the arc of the other side of the
   strip begins, or at a disc, where the next stretch of the boundary begins;
3. arcs linked head to tail are the loops, and what hangs together along the axis is one region with one outer loop;
4. arcs become lines, circular arcs and fitted splines (`parallel`).

              left arc <-----.          corner: both sides' parallel curves meet at the centre of the disc of radius d
      disc  ---- axis ----- corner
              right arc ----->'

A disc counts as larger when r > d + `NECK`: a neck thinner than walls of a domain may be is closed, and parallel walls
2 d apart leave nothing between them, whatever rounding says.

After H. Persson, "NC machining of arbitrarily shaped pockets", Computer-Aided Design 10 (1978), and M. Held, "On the
Computational Geometry of Pocket Machining", LNCS 500 (1991), who offset along the Voronoi diagram in the same way.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.offsetting.level import Corners, Strips, find_corners, frame, list_strips
from mat_core.analysis.offsetting.parallel import Drawn, Stretch, draw_loops, to_curve
from mat_core.analysis.offsetting.regions import OffsetEdge, OffsetLoop, OffsetRegion
from mat_core.axis import MedialAxis
from mat_core.errors import NotCertified
from mat_core.kernels.layout import LOOP

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

NECK = 1e-12  # normalised: discs must be larger than d by so much; see above
NECK_ULPS = 4.0  # of the largest coordinate, or by so much: walls are no better known


class _Arc(NamedTuple):
    """What one side of a strip, or a whole-arc contact, gives: interval, s at both ends, corner at both ends (-1: none)."""

    interval: int
    s0: float
    s1: float
    start: int
    end: int


class InwardOffsets:
    """Offsets of one domain to its inside."""

    def __init__(self, axis: MedialAxis) -> None:
        self.axis = axis
        self.strips: Strips = list_strips(axis)
        largest = max(abs(v) for v in axis.domain.bbox)
        self.neck = max(NECK, NECK_ULPS * math.ulp(largest) * axis.table.scale)
        # intervals that tile the boundary: right and left sides of strips in turn, then whole-arc contacts
        k, s = axis.skeleton, self.strips
        n = len(s.disc)
        self.site = np.concatenate((np.column_stack((s.right, s.left)).reshape(-1), k.whole_i[:, 0]))
        self.lo = np.concatenate((np.column_stack((s.right_s[:, 0], s.left_s[:, 1])).reshape(-1), k.whole_s[:, 0]))
        hi = np.concatenate((np.column_stack((s.right_s[:, 1], s.left_s[:, 0])).reshape(-1), k.whole_s[:, 1]))
        self.hi = hi
        self.wholes = range(2 * n, len(hi))
        order = np.lexsort((hi, self.lo, self.site))
        self.following = _following(order, axis.table.si[self.site[order], LOOP])

    def regions(self, distance: float, tolerance: float) -> tuple[OffsetRegion, ...]:
        """The regions of points farther than `distance` from the boundary; lengths in the caller's unit."""
        table = self.axis.table
        d = distance * table.scale
        above = self.axis.skeleton.disc[:, 2] > d + self.neck
        # the largest disc may stand inside a strip, with a smaller one at either end
        corners = find_corners(self.axis, self.strips, d, d + self.neck, above)
        if not above.any() and not len(corners.strip):
            return ()
        arcs, pairs = self._arcs(above, corners)
        loops = self._loops(arcs, len(corners.strip))
        part = _parts(len(arcs), loops, pairs)
        drawn = draw_loops(table, [self._stretches([arcs[a] for a in loop]) for loop in loops], d, tolerance * table.scale)
        return self._assemble(drawn, [part[loop[0]] for loop in loops])

    def _arcs(self, above: Flags, corners: Corners) -> tuple[list[_Arc], list[tuple[int, int]]]:
        """Step 2: all arcs, and which two are the sides of one stretch of the axis."""
        s = self.strips
        arcs: list[_Arc] = []
        pairs = []
        first = np.searchsorted(corners.strip, np.arange(len(s.disc) + 1)).tolist()
        inside = above[s.disc[:, 0]]
        for n in np.flatnonzero(inside | (np.diff(first) > 0)).tolist():
            own = list(range(first[n], first[n + 1]))
            bounds = ([-1] if inside[n] else []) + own + ([-1] if above[s.disc[n, 1]] else [])
            for c0, c1 in zip(bounds[0::2], bounds[1::2], strict=True):
                right0, left0 = (corners.right_s[c0], corners.left_s[c0]) if c0 >= 0 else (s.right_s[n, 0], s.left_s[n, 0])
                right1, left1 = (corners.right_s[c1], corners.left_s[c1]) if c1 >= 0 else (s.right_s[n, 1], s.left_s[n, 1])
                pairs.append((len(arcs), len(arcs) + 1))
                arcs.append(_Arc(2 * n, float(right0), float(right1), c0, c1))
                arcs.append(_Arc(2 * n + 1, float(left1), float(left0), c1, c0))
        for w, disc in zip(self.wholes, self.axis.skeleton.whole_i[:, 1].tolist(), strict=True):
            if above[disc]:
                arcs.append(_Arc(w, float(self.lo[w]), float(self.hi[w]), -1, -1))
        return arcs, pairs

    def _loops(self, arcs: list[_Arc], corners: int) -> list[list[int]]:
        """Step 3: arcs head to tail."""
        at_corner = [-1] * corners
        opens: dict[int, int] = {}
        for n, arc in enumerate(arcs):
            if arc.start >= 0:
                at_corner[arc.start] = n
            else:
                opens[arc.interval] = n
        after = [at_corner[arc.end] if arc.end >= 0 else self._next(arc.interval, opens) for arc in arcs]
        loops = []
        seen = [False] * len(arcs)
        for n in range(len(arcs)):
            loop = []
            while not seen[n]:
                seen[n] = True
                loop.append(n)
                n = after[n]
            if loop:
                loops.append(loop)
        return loops

    def _next(self, interval: int, opens: dict[int, int]) -> int:
        """The arc that begins where an interval ends."""
        place = self.following[interval]
        while place not in opens and self.lo[place] == self.hi[place] and place != interval:
            place = self.following[place]
        if place not in opens:
            raise self._broken(int(self.site[interval]))
        return opens[place]

    def _stretches(self, arcs: list[_Arc]) -> list[Stretch]:
        """Arcs of one loop with those on one site made one, in cyclic order."""
        runs = [Stretch(int(self.site[a.interval]), a.s0, a.s1, a.end >= 0) for a in arcs]
        begin = next((i for i, r in enumerate(runs) if not _same_site(runs[i - 1], r)), 0)
        out: list[Stretch] = []
        for run in runs[begin:] + runs[:begin]:
            if out and _same_site(out[-1], run):
                out[-1] = Stretch(run.site, out[-1].s0, run.s1, run.corner)
            else:
                out.append(run)
        return out

    def _assemble(self, drawn: list[list[Drawn]], part: list[int]) -> tuple[OffsetRegion, ...]:
        """Step 4: loops of one part of the axis make one region."""
        table = self.axis.table
        outer: dict[int, OffsetLoop] = {}
        holes: dict[int, list[OffsetLoop]] = {}
        for edges, p in zip(drawn, part, strict=True):
            if not edges:
                continue
            loop = OffsetLoop(tuple(OffsetEdge(to_curve(e, table), e.kind, e.source, e.error / table.scale) for e in edges))
            if loop.area > 0.0 and p not in outer:
                outer[p] = loop
            elif loop.area < 0.0:
                holes.setdefault(p, []).append(loop)
            elif loop.area > 0.0:
                raise self._broken(0)
        if not holes.keys() <= outer.keys():
            raise self._broken(0)
        return tuple(OffsetRegion(outer[p], tuple(holes.get(p, ()))) for p in sorted(outer))

    def _broken(self, site: int) -> NotCertified:
        """The honest error for arcs that make no loops."""
        t = self.axis.table
        x, y = frame(t, site, 1.0)[:2]
        place = (float(x / t.scale + t.origin[0]), float(y / t.scale + t.origin[1]))
        return NotCertified("offset: the arcs along the axis do not close to loops", place)


def _following(order: Ints, loop: Ints) -> list[int]:
    """For each interval the next one along its loop; `order` lists them in loop order."""
    after = np.roll(order, -1)
    first = np.flatnonzero(np.diff(loop, prepend=-1) != 0)
    last = np.append(first[1:], len(order)) - 1
    after[last] = order[first]
    out = np.empty(len(order), dtype=np.int64)
    out[order] = after
    return [int(i) for i in out]


def _same_site(a: Stretch, b: Stretch) -> bool:
    """Whether b goes on where a ends, on its site."""
    return not a.corner and a.site == b.site and a.s1 == b.s0


def _parts(arcs: int, loops: list[list[int]], pairs: list[tuple[int, int]]) -> list[int]:
    """A number for each arc, the same for all that hang together along the axis."""
    parent = list(range(arcs))

    def find(a: int) -> int:
        while parent[a] != a:
            parent[a] = parent[parent[a]]
            a = parent[a]
        return a

    for a, b in [*pairs, *((loop[0], a) for loop in loops for a in loop)]:
        low, high = sorted((find(a), find(b)))
        parent[high] = low
    return [find(a) for a in range(arcs)]
