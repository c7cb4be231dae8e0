"""The medial axis as people use it: nodes, segments, their curves and footpoints, and the graph they form.

Everything here is in the caller's coordinates. Flat arrays in normalised coordinates, (input - origin) * scale, are
kept underneath; the pleasant objects are made when they are asked for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.axis.lengths import curve_lengths
from mat_core.axis.records import CurveTable, Footpoint, Graph, Node, NodeFeet, Point, Samples
from mat_core.axis.sampling import spaced_parameters
from mat_core.axis.segment import SEGMENT_KINDS, Segment
from mat_core.boundary.sites import SiteTable
from mat_core.kernels.layout import EDGE, FAN, KIND, LOOP
from mat_core.kernels.nurbs import spline_points
from mat_core.model.domain import Domain
from mat_core.topology.graph import NODE_KINDS, AxisGraph
from mat_core.topology.skeleton import Skeleton
from mat_core.tracing.locate import feet, locate

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
__all__ = ["SEGMENT_KINDS", "CurveTable", "Footpoint", "Graph", "MedialAxis", "Node", "Point", "Samples", "Segment"]

NOTEBOOK_WIDTH = 480  # pixels


@dataclass(frozen=True, repr=False, eq=False)
class MedialAxis:
    """The medial axis transform of a domain.

    Made by `mat_core.medial_axis`. `nodes`, `segments` and `graph` are what one reads; `to_dict`, `to_json`,
    `to_svg`, `to_geojson` and `to_dxf` what one hands on.

    Attributes
    ----------
    domain : Domain
        What it is the axis of.
    table, skeleton, runs, curves : SiteTable, Skeleton, AxisGraph, CurveTable
        The flat arrays underneath, in normalised coordinates.
    tolerance : float
        Asked of fitted curves, relative to the larger side of the bounding box. What each one keeps is its `Segment.max_error`;
        the certificate's check ``curves_tolerance`` compares both.
    step : float or None
        Largest spacing of samples, relative likewise.
    certificate : mapping
        Each check with its measured figure and its limit; empty until the axis is certified.
    """

    domain: Domain
    table: SiteTable
    skeleton: Skeleton
    runs: AxisGraph
    curves: CurveTable
    tolerance: float = 1e-6
    step: float | None = None
    certificate: Mapping[str, Any] = field(default_factory=dict)

    def with_certificate(self, certificate: Mapping[str, Any]) -> MedialAxis:
        """The same axis with its certificate attached."""
        return replace(self, certificate=certificate)

    # Views -------------------------------------------------------------------------------------------------------
    @cached_property
    def nodes(self) -> tuple[Node, ...]:
        """All nodes by id."""
        feet = self.node_feet
        start = feet.start.tolist()
        out = []
        for n, (disc, kind) in enumerate(zip(self.node_discs.tolist(), self.runs.node_kind.tolist(), strict=True)):
            footpoints = tuple(
                self.footpoint(int(feet.site[c]), feet.u[c], feet.points[c], feet.angle[c])
                for c in range(start[n], start[n + 1])
            )
            out.append(Node(n, NODE_KINDS[kind], (disc[0], disc[1]), disc[2], footpoints))
        return tuple(out)

    @cached_property
    def node_feet(self) -> NodeFeet:
        """The footpoints of all nodes' discs."""
        k = self.skeleton
        wanted = self.runs.node_disc
        first = k.contact_start[wanted]
        counts = k.contact_start[wanted + 1] - first
        start = np.concatenate((np.zeros(1, dtype=np.int64), np.cumsum(counts)))
        rows = np.repeat(first - start[:-1], counts) + np.arange(start[-1])
        site = k.contact_site[rows]
        found = self._feet(site, k.contact_s[rows])
        return NodeFeet(start, site, self.to_input(found[:, :2]), found[:, 2], found[:, 3])

    @cached_property
    def segments(self) -> tuple[Segment, ...]:
        """All segments by id."""
        return tuple(Segment(self, g) for g in range(len(self.curves.degree)))

    @cached_property
    def graph(self) -> Graph:
        """The directed graph of the segments; its undirected cycle rank is the number of holes."""
        edges = tuple((s.id, s.start_node, s.end_node) for s in self.segments)
        return Graph(edges, tuple(self.runs.order.tolist()), int(self.runs.components), int(self.runs.cycles))

    @cached_property
    def node_discs(self) -> Floats:
        """(N, 3) rows x, y, r of the nodes."""
        return self._discs_to_input(self.skeleton.disc[self.runs.node_disc])

    @cached_property
    def control_discs(self) -> Floats:
        """(n, 3) rows x, y, r: the control points of all segments, one after the other."""
        return self._discs_to_input(self.curves.cp[:, :3])

    @cached_property
    def lengths(self) -> Floats:
        """(G,) lengths of the segments' curves of centres."""
        c = self.curves
        out = np.zeros(len(c.degree))
        np.add.at(out, c.part_segment, curve_lengths(self, c.part_segment, c.part_f[:, 0], c.part_f[:, 1]))
        return out

    # Coordinates -------------------------------------------------------------------------------------------------
    def to_input(self, points: Floats) -> Floats:
        """Normalised (n, 2) points in the caller's coordinates."""
        return points / self.table.scale + self.table.origin

    def _discs_to_input(self, discs: Floats) -> Floats:
        out = discs / self.table.scale
        out[:, :2] += self.table.origin
        return out

    # Queries -----------------------------------------------------------------------------------------------------
    def evaluate(self, segment: Ints, t: Floats) -> Floats:
        """Points and derivatives of many segments at once.

        Parameters
        ----------
        segment : (n,) int64
            Ids of segments.
        t : (n,) float64
            Parameters in [0, 1].

        Returns
        -------
        (n, 6) float64
            x, y, r and their derivatives by t.
        """
        c = self.curves
        segment, t = np.ascontiguousarray(segment), np.ascontiguousarray(t)  # strided arrays would be compiled for anew
        out = np.empty((len(t), 6))
        spline_points(c.degree, c.knot_start, c.knots, c.cp_start, c.cp, segment, t, self._work, np.empty(6), out)
        out /= self.table.scale
        out[:, :2] += self.table.origin
        return out

    def sample(self, segment: Ints, t: Floats) -> Samples:
        """True axis points of many segments at once, with their footpoints.

        Parameters
        ----------
        segment : (n,) int64
            Ids of segments.
        t : (n,) float64
            Parameters in [0, 1].

        Returns
        -------
        Samples
            Each true axis point lies within its segment's `max_error` of the curve's point at its t.
        """
        c = self.curves
        k = self.skeleton
        segment, t = np.ascontiguousarray(segment), np.ascontiguousarray(t)
        located = np.empty((5, len(t)))
        sites = np.empty((2, len(t)), dtype=np.int64)
        locate(self.table.si, self.table.sf, self.table.cp, k.strip_i, k.strip_s, c.degree, c.knot_start, c.knots,
               c.cp_start, c.cp, c.max_error, c.part_start, c.part_i, c.part_f, segment, t, self._work, np.empty(6),
               np.empty(6), np.empty(5), located, sites)
        right = self._feet(sites[0], located[3])
        left = self._feet(sites[1], located[4])
        discs = self._discs_to_input(located[:3].T)
        return Samples(t, discs[:, :2], discs[:, 2], self.to_input(left[:, :2]), self.to_input(right[:, :2]), sites[1],
                       sites[0], left[:, 2], right[:, 2], left[:, 3], right[:, 3])

    def sample_parameters(self) -> tuple[Ints, Floats]:
        """(segment, t) of the standard samples: 17 evenly in t on every segment, and more where `step` asks for them.

        With a `step` no two neighbours on a segment are farther apart than it.
        """
        return spaced_parameters(self)

    def footpoint(self, site: int, u: float, point: Floats, angle: float) -> Footpoint:
        """The pleasant form of a footpoint; `angle` is kept on a normal fan only."""
        row = self.table.si[site]
        turning = float(angle) if row[KIND] == FAN else None
        return Footpoint(int(row[LOOP]), int(row[EDGE]), float(u), (float(point[0]), float(point[1])), turning)

    def _feet(self, site: Ints, s: Floats) -> Floats:
        """(n, 4) rows x, y (normalised), u, direction of the normal."""
        out = np.empty((len(s), 4))
        feet(self.table.si, self.table.sf, self.table.cp, np.ascontiguousarray(site), np.ascontiguousarray(s), out)
        return out

    @property
    def _work(self) -> Floats:
        return np.empty((int(self.curves.degree.max(initial=1)) + 1, 4))

    # Output ------------------------------------------------------------------------------------------------------
    def to_dict(self, samples: bool = False) -> dict[str, Any]:
        """The answer document: plain dicts, lists and numbers.

        Parameters
        ----------
        samples : bool
            With points, radii and footpoints along every segment.

        Returns
        -------
        dict
            segments, graph, certificate, domain, version.
        """
        from mat_core.formats.json_document import document

        return document(self, samples)

    def to_json(self, samples: bool = False) -> bytes:
        """The answer document as UTF-8 JSON; see `to_dict`."""
        from mat_core.formats.json_document import encode

        return encode(self, samples)

    def to_svg(self, width: int = 800) -> str:
        """A picture, `width` pixels wide: boundary, axis coloured by radius, nodes, some maximal discs."""
        from mat_core.formats.svg import render

        return render(self, width)

    def _repr_svg_(self) -> str:
        """What a notebook shows."""
        return self.to_svg(NOTEBOOK_WIDTH)

    def to_geojson(self, tolerance: float = 1e-4) -> dict[str, Any]:
        """A GeoJSON FeatureCollection of chords, within a tolerance relative to the size; see `mat_core.formats.geojson`."""
        from mat_core.formats.geojson import to_geojson

        return to_geojson(self, tolerance)

    def to_dxf(self) -> str:
        """A DXF drawing of lines, arcs and rational splines (extra ``dxf``); see `mat_core.formats.dxf` for offsets in it."""
        from mat_core.formats.dxf import to_dxf

        return to_dxf(self)

    def __repr__(self) -> str:
        state = "certified" if self.certificate.get("passed") else "not certified"
        return (
            f"<MedialAxis: {len(self.runs.node_disc)} nodes, {len(self.curves.degree)} segments,"
            f" {self.runs.cycles} cycles, domain of area {self.domain.area:.6g} and size {self.domain.size:.4g},"
            f" tolerance {self.tolerance:g}, {state}>"
        )
