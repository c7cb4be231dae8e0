"""What pruning leaves: a view of an axis, some segments of it whole and some cut short."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.places import discs_inside
from mat_core.analysis.pruning.peeling import Cut, Peeling
from mat_core.analysis.spans import stretch
from mat_core.axis import Footpoint, MedialAxis, Point
from mat_core.errors import UnsupportedOption
from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PrunedNode:
    """A node of a pruned axis.

    Attributes
    ----------
    id : int
        Its index in `PrunedAxis.nodes`.
    node : int or None
        Id of the node of the axis that it is; None where a segment was cut inside.
    kind : str
        ``branch``; the axis' own kind at a leaf that stays; ``cut`` where something was cut off and one segment ends; ``through``
        where two are left; ``point`` where none is.
    point : tuple of float
        Centre of its disc.
    radius : float
        Its radius.
    footpoints : tuple of Footpoint
        Its contacts.
    """

    id: int
    node: int | None
    kind: str
    point: Point
    radius: float
    footpoints: tuple[Footpoint, ...]


@dataclass(frozen=True, slots=True)
class PrunedSegment:
    """A segment that is kept, from t0 to t1.

    Attributes
    ----------
    segment : int
        Id in the axis.
    t0, t1 : float
        What is kept of it.
    start_node, end_node : int or None
        Ids of pruned nodes; None for a closed segment without a node.
    """

    segment: int
    t0: float
    t1: float
    start_node: int | None
    end_node: int | None


@dataclass(frozen=True, slots=True)
class PrunedAxis:
    """A pruned axis: a view of the axis it was made from.

    Attributes
    ----------
    axis : MedialAxis
        Which axis.
    nodes : tuple of PrunedNode
        By id.
    segments : tuple of PrunedSegment
        In order of the axis' segments.
    cuts : tuple of Cut
        What was cut off, in order.
    components, cycles : int
        As those of the axis.
    """

    axis: MedialAxis
    nodes: tuple[PrunedNode, ...]
    segments: tuple[PrunedSegment, ...]
    cuts: tuple[Cut, ...]
    components: int
    cycles: int

    @property
    def chains(self) -> tuple[tuple[tuple[int, bool], ...], ...]:
        """Segments in a row through nodes where two end: (index in `segments`, whether travelled with t) in order."""
        return _chains(self)

    @property
    def paths(self) -> list[list[RationalBSpline]]:
        """The curve of centres of each segment: what formats draw."""
        curves = []
        for s in self.segments:
            degree, knots, rows = stretch(self.axis, s.segment, s.t0, s.t1)
            curves.append([RationalBSpline(degree, knots, rows[:, :2], rows[:, 3])])
        return curves

    def sample(self, spacing: float) -> tuple[Floats, ...]:
        """Discs along each chain, evenly by length on each of its segments.

        Parameters
        ----------
        spacing : float
            Largest distance between neighbours, in the caller's unit.

        Returns
        -------
        tuple of (n, 3) float64
            Rows x, y, r of each of `chains`; its nodes are among them. Of an axis that is a point, its one disc.

        Raises
        ------
        UnsupportedOption
            `spacing` is not a positive length.
        """
        if not (spacing > 0.0 and math.isfinite(spacing)):
            raise UnsupportedOption("spacing", f"{spacing} is not a positive length")
        if not self.segments:
            return tuple(np.array([[*n.point, n.radius]]) for n in self.nodes)
        return tuple(self._along(chain, spacing) for chain in self.chains)

    def _along(self, chain: tuple[tuple[int, bool], ...], spacing: float) -> Floats:
        found: list[Floats] = []
        for i, forward in chain:
            kept = self.segments[i]
            segment = self.axis.segments[kept.segment]
            before, length = segment.arc_length(0.0, kept.t0), segment.arc_length(kept.t0, kept.t1)
            places = before + np.linspace(0.0, length, max(math.ceil(length / spacing), 1) + 1)
            rows = segment.evaluate(segment.parameter_at(places))[:: 1 if forward else -1]
            found.append(rows[1:] if found else rows)
        return np.vstack(found)

    def to_dict(self) -> dict[str, Any]:
        """The answer document's segments and graph of what is kept, and the cuts.

        Segments that were cut short have curves of their own over [0, 1]; ``segment`` and ``t`` say what they were.
        """
        whole = self.axis.to_dict()["segments"]
        return {
            "segments": [self._entry(i, whole) for i in range(len(self.segments))],
            "graph": {
                "nodes": [
                    {"id": n.id, "node": n.node, "kind": n.kind, "point": list(n.point), "radius": n.radius,
                     "footpoints": [f.to_dict() for f in n.footpoints]}
                    for n in self.nodes
                ],
                "edges": [{"segment": i, "source": s.start_node, "target": s.end_node} for i, s in enumerate(self.segments)],
                "components": self.components,
                "cycles": self.cycles,
            },
            "cuts": [c.to_dict() for c in self.cuts],
        }

    def _entry(self, i: int, whole: list[dict[str, Any]]) -> dict[str, Any]:
        s = self.segments[i]
        entry = {**whole[s.segment], "id": i, "start_node": s.start_node, "end_node": s.end_node,
                 "segment": s.segment, "t": [s.t0, s.t1]}
        if (s.t0, s.t1) == (0.0, 1.0):
            return entry
        degree, knots, rows = stretch(self.axis, s.segment, s.t0, s.t1)
        common = {"degree": degree, "knots": knots.tolist(), "weights": rows[:, 3].tolist()}
        entry["axis"] = {**common, "control_points": rows[:, :2].tolist()}
        entry["radius"] = {**common, "control_values": rows[:, 2].tolist()}
        width = s.t1 - s.t0
        entry["pieces"] = [
            {"t": [max((p["t"][0] - s.t0) / width, 0.0), min((p["t"][1] - s.t0) / width, 1.0)], "kind": p["kind"]}
            for p in entry["pieces"] if p["t"][0] < s.t1 and p["t"][1] > s.t0
        ]
        return entry


def view(axis: MedialAxis, peeling: Peeling) -> PrunedAxis:
    """What is left of a peeling."""
    left = peeling.left()
    used = sorted({v for e in left for v in e.ends if v >= 0})
    if not left:
        used = [peeling.anchor]
    new = {v: i for i, v in enumerate(used)}
    degree = dict.fromkeys(used, 0)
    inside: dict[int, tuple[int, float]] = {}
    for e in left:
        for v, t in zip(e.ends, e.t, strict=True):
            if v >= 0:
                degree[v] += 1
                inside[v] = (e.segment, t)
    own = [v for v in used if peeling.nodes[v] is None and v in inside]
    found = discs_inside(axis, np.array([inside[v][0] for v in own], dtype=np.int64), np.array([inside[v][1] for v in own]))
    feet = {v: disc.footpoints for v, disc in zip(own, found, strict=True)}
    nodes = []
    for v in used:
        node = peeling.nodes[v]
        x, y, r = peeling.discs[v]
        at_rest = peeling.largest.footpoints if peeling.largest is not None else ()
        contacts = axis.nodes[node].footpoints if node is not None else feet.get(v, at_rest)
        nodes.append(PrunedNode(new[v], node, _kind(axis, node, degree[v]), (x, y), r, contacts))
    kept = [
        PrunedSegment(e.segment, e.t[0], e.t[1], new.get(e.ends[0]), new.get(e.ends[1]))
        for e in sorted(left, key=lambda e: (e.segment, e.t[0]))
    ]
    return PrunedAxis(axis, tuple(nodes), tuple(kept), tuple(peeling.cuts), axis.graph.components, axis.graph.cycles)


def _kind(axis: MedialAxis, node: int | None, degree: int) -> str:
    """Kind of a node with so many segments left."""
    if degree != 1:
        return {0: "point", 2: "through"}.get(degree, "branch")
    kind = "branch" if node is None else axis.nodes[node].kind
    return "cut" if kind == "branch" else kind


def _chains(pruned: PrunedAxis) -> tuple[tuple[tuple[int, bool], ...], ...]:
    """Walk from every end that is no passage, then round what is left."""
    at: dict[int, list[tuple[int, bool]]] = {}
    for i, s in enumerate(pruned.segments):
        for node, forward in ((s.start_node, True), (s.end_node, False)):
            if node is not None:
                at.setdefault(node, []).append((i, forward))
    used: set[int] = set()
    out = []
    ends = [h for n in sorted(at) if len(at[n]) != 2 for h in at[n]]
    for step in [*ends, *((i, True) for i in range(len(pruned.segments)))]:
        chain: list[tuple[int, bool]] = []
        following: tuple[int, bool] | None = step
        while following is not None and following[0] not in used:
            i, forward = following
            used.add(i)
            chain.append(following)
            end = pruned.segments[i].end_node if forward else pruned.segments[i].start_node
            onward = at[end] if end is not None else []
            following = next((h for h in onward if h[0] != i), None) if len(onward) == 2 else None
        if chain:
            out.append(tuple(chain))
    return tuple(out)
