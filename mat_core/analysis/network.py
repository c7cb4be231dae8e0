"""The graph of an axis for graph programs, and the completeness test of the paper (section 6.1).

The paper's test: the start and the end nodes of the directed graph are the convex corners of the object and the centres of
curvature of its points of locally maximal positive curvature (LMPC), and a topological sort that lists them all shows that no
segment is missing. Two things are added that it passes over. An LMPC whose osculating disc does not fit, or touches elsewhere
too, has no leaf: then its own maximal disc passes it, and the test asks for that one. And an arc of a circle between gentler
pieces is an LMPC as a whole.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.radii import radius_arcs
from mat_core.axis import MedialAxis, Point
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, EDGE, K0, K1, LOOP, NEXT

if TYPE_CHECKING:
    import networkx

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_CURVATURE = 1e-6  # relative: curvatures on both sides of a joint that differ by less are one
SAME_RADIUS = 1e-6  # relative likewise, of a disc and its contact's own circle


@dataclass(frozen=True, slots=True)
class Feature:
    """A convex vertex or a point of locally maximal positive curvature of the boundary.

    Attributes
    ----------
    kind : str
        ``convex_vertex`` or ``curvature_maximum``.
    loop, edge, u : int, int, float
        Where on the boundary; of a whole arc its start, interior to the left.
    point : tuple of float
        The place.
    node : int or None
        Id of its leaf.
    state : str
        ``leaf``; ``shared``: its maximal disc touches elsewhere as well, so that the axis passes; ``missing``.
    """

    kind: str
    loop: int
    edge: int
    u: float
    point: Point
    node: int | None
    state: str

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        return {"kind": self.kind, "loop": self.loop, "edge": self.edge, "u": self.u, "point": list(self.point),
                "node": self.node, "state": self.state}


@dataclass(frozen=True, slots=True)
class Completeness:
    """The paper's completeness test.

    Attributes
    ----------
    complete : bool
        No feature is missing, and every leaf belongs to one.
    features : tuple of Feature
        In order of the boundary: convex vertices and curvature maxima.
    leaves : tuple of int
        Nodes where one segment ends, in topological order: the first one is the start of the directed graph if it has a leaf.
    """

    complete: bool
    features: tuple[Feature, ...]
    leaves: tuple[int, ...]

    @property
    def missing(self) -> tuple[Feature, ...]:
        """Features that no disc of the axis stands for."""
        return tuple(f for f in self.features if f.state == "missing")

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        return {
            "complete": self.complete,
            "features": [f.to_dict() for f in self.features],
            "leaves": list(self.leaves),
        }


def to_networkx(axis: MedialAxis) -> networkx.MultiDiGraph[Any]:
    """The directed graph of an axis as a `networkx.MultiDiGraph`.

    Parameters
    ----------
    axis : MedialAxis

    Returns
    -------
    networkx.MultiDiGraph
        Nodes are ids of nodes with ``kind``, ``x``, ``y``, ``r``, added in topological order; edges have the id of their segment
        as key, and ``segment``, ``kind``, ``length``, ``min_radius``, ``max_radius``. A closed segment without a node is a loop
        at a node of its own, named ``seam-<segment>``, of kind ``seam``, where t = 0. The graph has ``components``, ``cycles``.

    Raises
    ------
    ImportError
        networkx is not installed.
    """
    try:
        import networkx
    except ImportError as error:
        raise ImportError("to_networkx needs networkx; install the extra: pip install 'mat-core[graph]'") from error
    graph = axis.graph
    out: networkx.MultiDiGraph[Any] = networkx.MultiDiGraph(components=graph.components, cycles=graph.cycles)
    for node in axis.nodes:
        out.add_node(node.id, kind=node.kind, x=node.point[0], y=node.point[1], r=node.radius)
    smallest, largest = _radius_ranges(axis)
    lengths = axis.lengths.tolist()
    for g, start, end in graph.edges:
        seam = f"seam-{g}"
        if start is None:
            x, y, r = axis.segments[g].evaluate(0.0).tolist()
            out.add_node(seam, kind="seam", x=x, y=y, r=r)
        ends = (seam, seam) if start is None else (start, end)
        out.add_edge(*ends, key=g, segment=g, kind=axis.segments[g].kind, length=lengths[g], min_radius=smallest[g],
                     max_radius=largest[g])
    return out


def _radius_ranges(axis: MedialAxis) -> tuple[list[float], list[float]]:
    """Least and largest radius of every segment."""
    arcs = radius_arcs(axis)
    low = np.full(len(axis.curves.degree), np.inf)
    high = np.zeros(len(axis.curves.degree))
    np.minimum.at(low, arcs.segment, arcs.radius.min(axis=1, initial=np.inf))
    np.maximum.at(high, arcs.segment, arcs.radius.max(axis=1, initial=0.0))
    return low.tolist(), high.tolist()


def completeness(axis: MedialAxis) -> Completeness:
    """Whether every convex vertex and every curvature maximum of the boundary has its leaf, or a reason to have none.

    Parameters
    ----------
    axis : MedialAxis

    Returns
    -------
    Completeness
        A domain that is a disc has neither features nor leaves, and is complete with its one node.
    """
    ends = np.concatenate((axis.runs.start_node, axis.runs.end_node))
    degree = np.bincount(ends[ends >= 0], minlength=len(axis.runs.node_disc))
    leaves = [n for n in axis.graph.topological_order if degree[n] == 1]
    node_of_disc = {int(d): n for n, d in enumerate(axis.runs.node_disc.tolist()) if degree[n] == 1}
    contacts = _contacts(axis)
    features = []
    for sites, radius in _expected(axis):
        discs = [(site, d) for site in sites for d in contacts.get(site, [])]
        own = [(site, d) for site, d in discs if _fits(float(axis.skeleton.disc[d, 2]), radius) and d in node_of_disc]
        state = "leaf" if own else "shared" if discs else "missing"
        kind = "curvature_maximum" if radius > 0.0 else "convex_vertex"
        site, node = (own[0][0], node_of_disc[own[0][1]]) if own else (sites[0], None)
        features.append(_feature(axis, site, kind, node, state))
    explained = {f.node for f in features}
    complete = all(f.state != "missing" for f in features) and explained.issuperset(leaves)
    return Completeness(complete, tuple(features), tuple(leaves))


def _fits(radius: float, own: float) -> bool:
    return abs(radius - own) <= SAME_RADIUS * own


def _contacts(axis: MedialAxis) -> dict[int, list[int]]:
    """Discs by the joint they touch, named by the site that starts there."""
    k = axis.skeleton
    owner = np.repeat(np.arange(len(k.disc)), np.diff(k.contact_start))
    at_start, at_end = k.contact_s == 0.0, k.contact_s >= 1.0
    found: dict[int, list[int]] = {}
    for sites, discs in ((k.contact_site[at_start], owner[at_start]),
                         (axis.table.si[k.contact_site[at_end], NEXT], owner[at_end])):
        for site, disc in zip(sites.tolist(), discs.tolist(), strict=True):
            found.setdefault(site, []).append(disc)
    return found


def _expected(axis: MedialAxis) -> list[tuple[list[int], float]]:
    """(joints, radius) wherever a leaf is to be looked for: 0 at a convex vertex, else the own radius of an LMPC.

    Along a loop the curvature is a chain of values: of each site at its start and its end, infinite at a convex vertex, minus
    infinite in a normal fan. Equal neighbours are one; one that is positive and above both of its neighbours is an LMPC.
    """
    si, sf, starts = axis.table.si, axis.table.sf, axis.table.loop_start.tolist()
    vertex = si[:, CORNER] == CONVEX_VERTEX
    out = []
    for first, last in pairwise(starts):
        chain: list[tuple[list[int], float]] = []  # the joints a value is met at, each named by the site that starts there
        for site in range(first, last):
            if vertex[site]:
                chain.append(([site], np.inf))
            _append(chain, site, float(sf[site, K0]))
            _append(chain, int(si[site, NEXT]), float(sf[site, K1]))
        while len(chain) > 1 and _same(chain[0][1], chain[-1][1]):
            chain[0] = (chain.pop()[0] + chain[0][0], chain[0][1])
        n = len(chain)
        for i, (sites, value) in enumerate(chain):
            if value == np.inf:
                out.append((sites, 0.0))
            elif n > 1 and value > 0.0 and value > chain[i - 1][1] and value > chain[(i + 1) % n][1]:
                out.append((sites, 1.0 / value))
    return out


def _append(chain: list[tuple[list[int], float]], site: int, value: float) -> None:
    """A further value, or a further joint of the last one."""
    if chain and _same(chain[-1][1], value):
        chain[-1][0].append(site)
    else:
        chain.append(([site], value))


def _same(a: float, b: float) -> bool:
    return a == b or (math.isfinite(a - b) and abs(a - b) <= SAME_CURVATURE * min(abs(a), abs(b)))


def _feature(axis: MedialAxis, site: int, kind: str, node: int | None, state: str) -> Feature:
    foot = axis._feet(np.array([site]), np.zeros(1))
    x, y = axis.to_input(foot[:, :2])[0].tolist()
    return Feature(kind, int(axis.table.si[site, LOOP]), int(axis.table.si[site, EDGE]), float(foot[0, 2]), (x, y), node, state)
