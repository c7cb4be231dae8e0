"""The graph of an axis while branches are taken off it: stretches of segments between vertices, and what was cut."""

from __future__ import annotations

import heapq
from bisect import bisect_left
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.intervals import Intervals
from mat_core.analysis.places import AxisDisc
from mat_core.axis import MedialAxis

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

Place = tuple[int, float, float]  # segment, t0, t1
EQUAL = 1e-9  # relative: measures of branches that differ by less are equal


@dataclass(frozen=True, slots=True)
class Cut:
    """A branch, or the outer part of one, that was cut off.

    Attributes
    ----------
    reason : str
        ``scale``, ``angle``, ``radius_ratio`` or ``length``.
    places : tuple of (int, float, float)
        Segments with t0 < t1, from the tip inwards.
    length : float
        Of all of them, in the caller's unit.
    radius_ratio : float
        (length + radius at the tip) / radius at the root, where it was cut off.
    """

    reason: str
    places: tuple[Place, ...]
    length: float
    radius_ratio: float

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        places = [{"segment": g, "t": [t0, t1]} for g, t0, t1 in self.places]
        return {"reason": self.reason, "places": places, "length": self.length, "radius_ratio": self.radius_ratio}


@dataclass(slots=True)
class Edge:
    """A stretch of a segment between two vertices."""

    segment: int
    t: list[float]  # t0, t1
    ends: list[int]  # vertices at t0 and t1
    alive: bool = True


@dataclass(slots=True)
class _Branch:
    """From a tip through vertices that two edges share; `edges` with the end of each that points to the tip."""

    edges: list[tuple[int, int]]
    root: int
    length: float
    version: int = 0


class Peeling:
    """Vertices are the axis' nodes, then the largest disc of a tree where it lies inside a segment, then the ends of cuts.

    The vertex `anchor`, the largest disc of a tree, is never a tip.
    """

    def __init__(self, axis: MedialAxis, largest: AxisDisc | None) -> None:
        self.axis = axis
        self.discs: list[list[float]] = axis.node_discs.tolist()
        self.lengths: list[float] = axis.lengths.tolist()
        self.nodes: list[int | None] = list(range(len(self.discs)))
        self.anchor = -1 if largest is None or largest.node is None else largest.node
        self.edges: list[Edge] = []
        self.cuts: list[Cut] = []
        self.largest = largest
        self.at: list[list[int]] = []  # edges by vertex
        starts, ends = axis.runs.start_node.tolist(), axis.runs.end_node.tolist()
        for g, (a, b) in enumerate(zip(starts, ends, strict=True)):
            if largest is not None and largest.segment == g and largest.t is not None:
                self.anchor = self._vertex([*largest.point, largest.radius])
                self.edges += [Edge(g, [0.0, largest.t], [a, self.anchor]), Edge(g, [largest.t, 1.0], [self.anchor, b])]
            else:
                self.edges.append(Edge(g, [0.0, 1.0], [a, b]))
        self.at = [[] for _ in self.discs]
        for i, edge in enumerate(self.edges):
            for v in edge.ends:
                if v >= 0:
                    self.at[v].append(i)
        self.degree = [len(own) for own in self.at]

    def _vertex(self, disc: list[float]) -> int:
        self.discs.append(disc)
        self.nodes.append(None)
        return len(self.discs) - 1

    def roots(self) -> tuple[Floats, Floats]:
        """(G, 3) discs that segments lead to from their start, and from their end: nodes, or the anchor inside."""
        runs, axis = self.axis.runs, self.axis
        discs = axis.node_discs if len(axis.node_discs) else np.zeros((1, 3))
        out = discs[runs.end_node].copy(), discs[runs.start_node].copy()
        if self.anchor >= len(axis.node_discs):
            inside = next(e.segment for e in self.edges if self.anchor in e.ends)
            for roots in out:
                roots[inside] = self.discs[self.anchor]
        return out

    def left(self) -> list[Edge]:
        """What was not cut; a segment that was only parted at the anchor is whole again."""
        alive = [e for e in self.edges if e.alive]
        halves = [e for e in alive if self.anchor in e.ends] if self.anchor >= len(self.axis.runs.node_disc) else []
        if len(halves) == 2:
            low, high = halves
            alive = [e for e in alive if e is not low and e is not high]
            alive.append(Edge(low.segment, [low.t[0], high.t[1]], [low.ends[0], high.ends[1]]))
        return alive

    # Cutting -----------------------------------------------------------------------------------------------------
    def _tips(self) -> list[int]:
        return [v for v in range(len(self.degree)) if self.degree[v] == 1 and v != self.anchor]

    def _only(self, vertex: int) -> tuple[int, int]:
        """(edge, which of its ends) of a tip."""
        edge = next(e for e in self.at[vertex] if self.edges[e].alive)
        return edge, self.edges[edge].ends.index(vertex)

    def _length(self, segment: int, t0: float, t1: float) -> float:
        return self.lengths[segment] if (t0, t1) == (0.0, 1.0) else self.axis.segments[segment].arc_length(t0, t1)

    def _remove(self, edge: int) -> None:
        self.edges[edge].alive = False
        for v in self.edges[edge].ends:
            self.degree[v] -= 1

    def shorten(self, reason: str, from_start: Intervals, from_end: Intervals) -> None:
        """Cut from every tip to the first place that is kept: within the intervals for tips coming from a segment's start or end.

        Time is linear: every edge is taken off at most once.
        """
        count = len(self.axis.curves.degree)
        kept = [_by_segment(intervals, count) for intervals in (from_start, from_end)]
        waiting = self._tips()
        while waiting:
            tip = waiting.pop()
            if self.degree[tip] != 1:
                continue
            i, end = self._only(tip)
            edge = self.edges[i]
            stop = _first(kept[end][edge.segment], edge.t, end)
            if stop == edge.t[end]:
                continue
            whole = stop is None
            inner = edge.t[1 - end] if stop is None else stop
            disc = self.discs[edge.ends[1 - end]] if whole else self.axis.segments[edge.segment].evaluate(inner).tolist()
            place = (edge.segment, min(edge.t[end], inner), max(edge.t[end], inner))
            length = self._length(*place)
            self.cuts.append(Cut(reason, (place,), length, _ratio(length + self.discs[tip][2], disc[2])))
            if whole:
                self._remove(i)
                root = edge.ends[1 - end]
                if self.degree[root] == 1 and root != self.anchor:
                    waiting.append(root)
            else:
                self.degree[tip] = 0
                edge.t[end] = inner
                edge.ends[end] = self._vertex(disc)
                self.at.append([i])
                self.degree.append(1)

    def drop(self, reason: str, limit: float) -> None:
        """Cut whole branches whose measure is below the limit, the least first; a branch that grows is measured again."""
        branches: dict[int, _Branch] = {}
        at_root: dict[int, set[int]] = {}
        queue: list[tuple[float, int, int]] = []

        def measure(tip: int) -> None:
            branch = branches.setdefault(tip, _Branch([], tip, 0.0))
            self._grow(branch)
            branch.version += 1
            at_root.setdefault(branch.root, set()).add(tip)
            heapq.heappush(queue, (self._measure(reason, tip, branch), tip, branch.version))

        for tip in self._tips():
            measure(tip)
        while queue:
            least = queue[0][0]
            roots = set()
            # what is equal is cut together, so that the order of the input decides nothing
            while queue and queue[0][0] <= least * (1.0 + EQUAL):
                value, tip, version = heapq.heappop(queue)
                branch = branches[tip]
                if version == branch.version and value < limit:
                    self._cut(reason, tip, branch)
                    at_root[branch.root].discard(tip)
                    roots.add(branch.root)
            for root in sorted(roots - {self.anchor}):
                if self.degree[root] == 2:
                    for tip in at_root.pop(root):
                        measure(tip)
                elif self.degree[root] == 1:
                    measure(root)

    def _cut(self, reason: str, tip: int, branch: _Branch) -> None:
        """Take a whole branch off."""
        places = tuple((e.segment, e.t[0], e.t[1]) for e in (self.edges[i] for i, _ in branch.edges))
        reach = branch.length + self.discs[tip][2]
        self.cuts.append(Cut(reason, places, branch.length, _ratio(reach, self.discs[branch.root][2])))
        for e, _ in branch.edges:
            self._remove(e)

    def _grow(self, branch: _Branch) -> None:
        """Lengthen a branch to the next vertex where it may end."""
        while not branch.edges or (self.degree[branch.root] == 2 and branch.root != self.anchor):
            last = branch.edges[-1][0] if branch.edges else -1
            i = next(e for e in self.at[branch.root] if self.edges[e].alive and e != last)
            edge = self.edges[i]
            end = edge.ends.index(branch.root)
            branch.edges.append((i, end))
            branch.length += self._length(edge.segment, edge.t[0], edge.t[1])
            branch.root = edge.ends[1 - end]

    def _measure(self, reason: str, tip: int, branch: _Branch) -> float:
        if reason == "length":
            return branch.length
        return _ratio(branch.length + self.discs[tip][2], self.discs[branch.root][2])


def _ratio(reach: float, radius: float) -> float:
    """Reach over radius, at least 1: the triangle inequality holds but for rounding."""
    return max(reach / radius, 1.0) if radius > 0.0 else 1.0


def _by_segment(intervals: Intervals, count: int) -> list[list[tuple[float, float]]]:
    """The intervals of each segment."""
    bounds = np.searchsorted(intervals.segment, np.arange(count + 1)).tolist()
    t = [(a, b) for a, b in intervals.t.tolist()]
    return [t[low:high] for low, high in pairwise(bounds)]


def _first(kept: list[tuple[float, float]], t: list[float], end: int) -> float | None:
    """Where the first kept interval begins, coming from an end of [t0, t1]; None if none is met."""
    if end == 0:
        i = bisect_left(kept, t[0], key=lambda k: k[1])
        while i < len(kept) and kept[i][1] <= t[0]:
            i += 1
        return max(kept[i][0], t[0]) if i < len(kept) and kept[i][0] < t[1] else None
    i = bisect_left(kept, t[1], key=lambda k: k[0]) - 1
    return min(kept[i][1], t[1]) if i >= 0 and kept[i][1] > t[0] else None
