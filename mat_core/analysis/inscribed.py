"""The largest disc inside a domain, and the largest in each of its parts.

A disc inside the domain is largest in its surroundings where the radius has a local maximum on the axis. Going down from one,
all axis with radii above a level hangs together, until at a *neck* it meets what came down from another:

        r |    A                 B           The level sinks: A begins, then C, then B. At n C joins A, which is larger;
          |   / \\      C        / \\          at m B does. C's part ends at n, B's at m: necks are the narrowest places on
          |  /   \\    / \\      /   \\         the widest way out. The prominence of C is r(C) - r(n). Where axis closes
          | /     \\n_/   \\m___/     \\        round a hole at the sinking level, there is a neck between a part and itself.

This is the merge tree of the radius on the graph (H. Edelsbrunner and J. Harer, "Computational Topology", 2010, chapter VII), so
a plateau is one maximum whatever the curves make of it, and nodes are treated as all other places.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.options import real
from mat_core.analysis.places import AxisDisc, disc_at_node, discs_inside, radius_noise
from mat_core.analysis.radii import RadiusArcs, radius_arcs
from mat_core.axis import MedialAxis
from mat_core.errors import UnsupportedOption

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Part:
    """A part of the domain by its largest disc.

    Attributes
    ----------
    disc : AxisDisc
        The largest disc of the part; on a plateau one of its discs.
    neck : AxisDisc or None
        The largest disc through which the way leads to a larger part; None for the part with the largest disc of all.
    prominence : float
        Radius of the disc less that of the neck; of the largest disc, its radius.
    """

    disc: AxisDisc
    neck: AxisDisc | None
    prominence: float

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        neck = None if self.neck is None else self.neck.to_dict()
        return {"disc": self.disc.to_dict(), "neck": neck, "prominence": self.prominence}


@dataclass(frozen=True, slots=True)
class InscribedDiscs:
    """Parts of a domain, the one with the largest disc first."""

    parts: tuple[Part, ...]

    @property
    def discs(self) -> tuple[AxisDisc, ...]:
        """The largest disc of each part."""
        return tuple(p.disc for p in self.parts)

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        return {"parts": [p.to_dict() for p in self.parts]}


class Terrain(NamedTuple):
    """The axis as a graph whose edges are arcs of monotone radius.

    node, segment (V,) and t (V,): the place of each vertex: a node, or inside a segment (node -1); radius (V,);
    arc_ends (m, 2): vertices of each arc.
    """

    node: Ints
    segment: Ints
    t: Floats
    radius: Floats
    arc_ends: Ints


class Tops(NamedTuple):
    """The merge tree: vertices of the maxima that stand out, and of the necks.

    top (k,), saddle (k,) (-1 for the first), falling in radius; necks (j, 2): vertex of every neck, that of the largest disc on
    the lower of its two sides.
    """

    top: Ints
    saddle: Ints
    necks: Ints


def terrain(axis: MedialAxis, arcs: RadiusArcs | None = None) -> Terrain:
    """Nodes first, then the places inside segments where arcs meet; a closed segment has one at its seam."""
    a = radius_arcs(axis) if arcs is None else arcs
    nodes, count = len(axis.runs.node_disc), len(a.segment)
    start, end = axis.runs.start_node[a.segment], axis.runs.end_node[a.segment]
    first, last = a.t[:, 0] == 0.0, a.t[:, 1] == 1.0
    inner = ~first | (start < 0)
    place = nodes + np.cumsum(inner) - 1
    low = np.where(inner, place, start)
    # an arc ends where the next one of its segment begins, the last of a closed segment where its first begins
    after = np.roll(low, -1) if count else low
    seam = np.zeros(len(axis.curves.degree), dtype=np.int64)
    seam[a.segment[first]] = low[first]
    high = np.where(last, np.where(end < 0, seam[a.segment], end), after)
    rows = np.nonzero(inner)[0]
    none = np.full(nodes, -1)
    return Terrain(
        np.concatenate((np.arange(nodes), np.full(len(rows), -1))),
        np.concatenate((none, a.segment[rows])),
        np.concatenate((np.zeros(nodes), a.t[rows, 0])),
        np.concatenate((axis.node_discs[:, 2], a.radius[rows, 0])),
        np.column_stack((low, high)),
    )


def find_tops(ground: Terrain, prominence: float) -> Tops:
    """Sink the level through all vertices; maxima and necks that stand out by no more than `prominence` do not count."""
    vertices = len(ground.radius)
    ends = ground.arc_ends[ground.arc_ends[:, 0] != ground.arc_ends[:, 1]]
    half = np.concatenate((ends, ends[:, ::-1]))
    half = half[np.argsort(half[:, 0], kind="stable")]
    begin = np.searchsorted(half[:, 0], np.arange(vertices + 1)).tolist()
    other = half[:, 1].tolist()
    order = np.argsort(-ground.radius, kind="stable")
    rank = np.empty(vertices, dtype=np.int64)
    rank[order] = np.arange(vertices)
    ranks, radius = rank.tolist(), ground.radius.tolist()
    parent = list(range(vertices))  # a root is the highest vertex of what hangs together
    saddle: dict[int, int] = {}
    necks: list[tuple[int, int]] = []

    def root(v: int) -> int:
        while parent[v] != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    for v in order.tolist():
        above = [w for w in other[begin[v] : begin[v + 1]] if ranks[w] < ranks[v]]
        for w in above:
            a, b = root(v), root(w)
            high, low = (a, b) if ranks[a] < ranks[b] else (b, a)
            if radius[low] - radius[v] > prominence:
                # what comes down from `low` ends here; for a == b the way round a hole is closed
                necks.append((v, low))
                if a != b:
                    saddle[low] = v
            parent[low] = high
    tops = [v for v in order.tolist() if root(v) == v or v in saddle]
    found = np.array(necks, dtype=np.int64).reshape(-1, 2)
    return Tops(np.array(tops, dtype=np.int64), np.array([saddle.get(v, -1) for v in tops], dtype=np.int64), found)


def discs_of(axis: MedialAxis, ground: Terrain, vertices: Ints) -> list[AxisDisc]:
    """The discs at vertices of the terrain."""
    inside = vertices[ground.node[vertices] < 0]
    found = iter(discs_inside(axis, ground.segment[inside], ground.t[inside]))
    nodes = ground.node[vertices].tolist()
    return [next(found) if node < 0 else disc_at_node(axis, node) for node in nodes]


def inscribed_discs(axis: MedialAxis, prominence: float = 0.0) -> InscribedDiscs:
    """The largest disc of each part of a domain.

    Parts are what the necks separate: each has one local maximum of the radius over the whole axis. A plateau, such as the
    spine of a rectangle, is one maximum.

    Parameters
    ----------
    axis : MedialAxis
    prominence : float
        Caller's unit. Parts whose largest disc is wider than their neck, in radius, by no more than this belong to the larger
        part they lead to. Differences below the stated error of the curves never count.

    Returns
    -------
    InscribedDiscs
        At least one part; the largest disc first. Circle: its one disc; annulus: one disc.

    Raises
    ------
    UnsupportedOption
        `prominence` is negative or not finite.
    """
    prominence = real("prominence", prominence)
    if not (prominence >= 0.0 and math.isfinite(prominence)):
        raise UnsupportedOption("prominence", f"{prominence} is not a length of at least 0")
    ground = terrain(axis)
    tops = find_tops(ground, max(prominence, radius_noise(axis)))
    discs = discs_of(axis, ground, tops.top)
    led = np.nonzero(tops.saddle >= 0)[0]
    necks = dict(zip(led.tolist(), discs_of(axis, ground, tops.saddle[led]), strict=True))
    parts = []
    for i, disc in enumerate(discs):
        neck = necks.get(i)
        parts.append(Part(disc, neck, disc.radius - (0.0 if neck is None else neck.radius)))
    return InscribedDiscs(tuple(parts))


def inscribed_disc(axis: MedialAxis) -> AxisDisc:
    """The largest disc inside the domain.

    Parameters
    ----------
    axis : MedialAxis

    Returns
    -------
    AxisDisc
        A true maximal disc with its contacts. Its radius is the domain's inradius, to within the square of the curves' error
        where it sits inside a segment. Where several are largest, one of them.
    """
    ground = terrain(axis)
    return discs_of(axis, ground, np.array([int(np.argmax(ground.radius))]))[0]
