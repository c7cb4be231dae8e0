"""The longest path along an axis: the stroke of a letter, the middle of a channel.

On a tree the longest path between two nodes is found by two sweeps: the farthest node from any node is an end of it. With cycles
the longest path is NP-hard, and would run round holes for the sake of length; there the *longest shortest path* is taken, the
diameter of the graph by lengths of segments. Sweeps bound how far any node is from any other,

    d(v, w) and e(v) - d(v, w)  <=  e(w)  <=  e(v) + d(v, w)          e: distance to the farthest node

and nodes that cannot beat the best path are never swept from (F. Takes and W. Kosters, "Determining the diameter of small world
networks", 2011). A graph in which nearly all nodes are equally far would need a sweep from each; after `SWEEPS` the search ends,
and the answer says how much longer another path might be.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.axis import MedialAxis, Point
from mat_core.errors import UnsupportedOption
from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SWEEPS = 64  # each takes time n log n; trees need two, letters and plates with holes a handful
SURE = 1e-12  # relative: a bound this near to the best path is met
EXTENDED = ("curvature_center", "arc_center")


@dataclass(frozen=True, slots=True)
class Extension:
    """A straight prolongation from an end of the path to the boundary.

    Attributes
    ----------
    node : int
        The leaf it leaves.
    start, end : tuple of float
        The leaf's centre and the point of the boundary.
    length : float
        The radius of the leaf's disc.
    """

    node: int
    start: Point
    end: Point
    length: float

    def to_dict(self) -> dict[str, Any]:
        """Plain lists and numbers."""
        return {"node": self.node, "start": list(self.start), "end": list(self.end), "length": self.length}


@dataclass(frozen=True, slots=True)
class Centerline:
    """A path along the axis.

    Attributes
    ----------
    axis : MedialAxis
        Which axis.
    path : tuple of (int, bool)
        Segments in order of travel, and whether each is travelled with its t.
    nodes : tuple of int
        The nodes on the way, one more than segments; none on a closed segment without a node, one where the axis is a point.
    length : float
        Of the path with its extensions.
    bound : float
        No shortest path between two nodes is longer than this, extensions left aside: the path's own length where it was proven
        to be the longest, as on every tree.
    closed : bool
        Whether the path is a closed segment.
    before, after : Extension or None
        Prolongations at its start and its end, when asked for.
    """

    axis: MedialAxis
    path: tuple[tuple[int, bool], ...]
    nodes: tuple[int, ...]
    length: float
    bound: float
    closed: bool
    before: Extension | None
    after: Extension | None

    @property
    def paths(self) -> list[list[RationalBSpline]]:
        """The one path with its extensions, from its start to its end: what formats draw."""
        curves = ((self.axis.segments[g].curve, forward) for g, forward in self.path)
        turned = [c if forward else c.reversed() for c, forward in curves]
        before = [_line(self.before.end, self.before.start)] if self.before else []
        after = [_line(self.after.start, self.after.end)] if self.after else []
        return [[*before, *turned, *after]]

    def sample(self, spacing: float | None = None) -> Floats:
        """Discs along the path with its extensions, evenly by length.

        Parameters
        ----------
        spacing : float, optional
            Largest distance along the path between neighbours, in the caller's unit; a hundredth of the length by default.

        Returns
        -------
        (n, 3) float64
            Rows x, y, r. On an extension the radius falls to 0 at the boundary.

        Raises
        ------
        UnsupportedOption
            `spacing` is not a positive length.
        """
        if spacing is not None and not (spacing > 0.0 and math.isfinite(spacing)):
            raise UnsupportedOption("spacing", f"{spacing} is not a positive length")
        if not self.path:
            return self.axis.node_discs[:1].copy()
        step = self.length / 100.0 if spacing is None else spacing
        places = np.linspace(0.0, self.length, max(math.ceil(self.length / step), 1) + 1)
        lead = 0.0 if self.before is None else self.before.length
        lengths = self.axis.lengths[[g for g, _ in self.path]]
        reached = lead + np.concatenate(([0.0], np.cumsum(lengths)))
        piece = np.searchsorted(reached, places, side="right") - 1
        out = np.empty((len(places), 3))
        for k, (g, forward) in enumerate(self.path):
            own = (piece == k) if k + 1 < len(self.path) else (piece >= k) & (places <= reached[k + 1])
            along = places[own] - reached[k]
            segment = self.axis.segments[g]
            out[own] = segment.evaluate(segment.parameter_at(along if forward else lengths[k] - along))
        for extension, own, along in (
            (self.before, places < lead, lead - places),
            (self.after, places > reached[-1], places - reached[-1]),
        ):
            if extension is not None:
                share = (along[own] / extension.length)[:, None]
                ends = np.array([[*extension.start, extension.length], [*extension.end, 0.0]])
                out[own] = (1.0 - share) * ends[0] + share * ends[1]
        return out

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        return {
            "path": [{"segment": g, "forward": forward} for g, forward in self.path],
            "nodes": list(self.nodes),
            "length": self.length,
            "bound": self.bound,
            "closed": self.closed,
            "before": None if self.before is None else self.before.to_dict(),
            "after": None if self.after is None else self.after.to_dict(),
        }


def _line(start: Point, end: Point) -> RationalBSpline:
    return RationalBSpline(1, np.array([0.0, 0.0, 1.0, 1.0]), np.array([start, end]), np.ones(2))


def centerline(axis: MedialAxis, extend: bool = False) -> Centerline:
    """The longest path along the axis; with cycles, the longest of the shortest paths between nodes.

    Parameters
    ----------
    axis : MedialAxis
    extend : bool
        Prolong ends at curvature centres and arc centres straight on, along the axis' tangent, to the boundary. At a convex
        vertex the axis is there already; a path round holes may end at branch points, where there is nothing to follow.

    Returns
    -------
    Centerline
        Of a ring whose axis is one closed segment, that segment; of a disc, no segment and length 0.
    """
    if not len(axis.curves.degree):
        return Centerline(axis, (), (0,), 0.0, 0.0, False, None, None)
    if not len(axis.runs.node_disc):
        total = float(axis.lengths[0])
        return Centerline(axis, ((0, True),), (), total, total, True, None, None)
    net = _Net(axis)
    path, nodes, length, bound = _longest(net, tree=axis.runs.cycles == 0)
    ends = (nodes[0], path[0], True), (nodes[-1], path[-1], False)
    before, after = (_extension(axis, *end) if extend else None for end in ends)
    total = length + sum(e.length for e in (before, after) if e is not None)
    return Centerline(axis, path, nodes, total, bound, False, before, after)


class _Net:
    """Neighbours of every node, and shortest ways through them."""

    def __init__(self, axis: MedialAxis) -> None:
        start, end = axis.runs.start_node, axis.runs.end_node
        half = np.concatenate((np.arange(len(start)), np.arange(len(start))))
        source = np.concatenate((start, end))
        order = np.argsort(source, kind="stable")
        self.size = len(axis.runs.node_disc)
        self.first = np.searchsorted(source[order], np.arange(self.size + 1)).tolist()
        self.target = np.concatenate((end, start))[order].tolist()
        self.segment = half[order].tolist()
        self.forward = (order < len(start)).tolist()
        self.length = axis.lengths[half[order]].tolist()

    def sweep(self, node: int) -> tuple[Floats, list[int]]:
        """Distances from a node, and the half edge by which each node is reached (-1 at the start); Dijkstra's method."""
        distance = [math.inf] * self.size
        by = [-1] * self.size
        distance[node] = 0.0
        queue = [(0.0, node)]
        while queue:
            d, v = heapq.heappop(queue)
            if d > distance[v]:
                continue
            for half in range(self.first[v], self.first[v + 1]):
                w, reached = self.target[half], d + self.length[half]
                if reached < distance[w]:
                    distance[w], by[w] = reached, half
                    heapq.heappush(queue, (reached, w))
        return np.array(distance), by

    def way(self, start: int, end: int, by: list[int]) -> tuple[tuple[tuple[int, bool], ...], tuple[int, ...]]:
        """Segments and nodes from the start of a sweep to a node."""
        path, nodes = [], [end]
        source = {half: v for v in range(self.size) for half in range(self.first[v], self.first[v + 1])}
        while nodes[-1] != start:
            half = by[nodes[-1]]
            path.append((self.segment[half], self.forward[half]))
            nodes.append(source[half])
        return tuple(reversed(path)), tuple(reversed(nodes))


def _longest(net: _Net, tree: bool) -> tuple[tuple[tuple[int, bool], ...], tuple[int, ...], float, float]:
    """(path, nodes, length, bound) of the longest shortest path."""
    low, high = np.zeros(net.size), np.full(net.size, math.inf)
    best, ends, by = -1.0, (0, 0), [-1] * net.size
    node = 0
    for step in range(SWEEPS):
        distance, reached_by = net.sweep(node)
        far = int(np.argmax(distance))
        reach = float(distance[far])
        if reach > best:
            best, ends, by = reach, (node, far), reached_by
        low = np.maximum(low, np.maximum(distance, reach - distance))
        high = np.minimum(high, reach + distance)
        low[node] = high[node] = reach
        open_ = np.nonzero((high > best * (1.0 + SURE)) & (low < high))[0]
        if step == 0:
            node = far
            continue
        if tree or not len(open_):
            high = np.full(net.size, best)
            break
        # by turns the node that may be farthest out, and the one most in the middle
        node = int(open_[np.argmax(high[open_])]) if step % 2 else int(open_[np.argmin(low[open_])])
    path, nodes = net.way(ends[0], ends[1], by)
    return path, nodes, best, max(best, float(high.max()))


def _extension(axis: MedialAxis, node: int, end: tuple[int, bool], first: bool) -> Extension | None:
    """Straight on from a leaf that is no vertex, as far as its radius: there the tangent meets the contact."""
    leaf = axis.nodes[node]
    if leaf.kind not in EXTENDED:
        return None
    g, forward = end
    at_start = forward == first
    along = axis.segments[g].tangent(0.0 if at_start else 1.0) * (-1.0 if at_start else 1.0)
    x, y = (np.array(leaf.point) + leaf.radius * along).tolist()
    if leaf.kind == "curvature_center":
        x, y = leaf.footpoints[0].point
    return Extension(node, leaf.point, (x, y), leaf.radius)
