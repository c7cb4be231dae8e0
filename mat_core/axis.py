"""The medial axis as people use it: nodes, segments, their curves and footpoints, and the graph they form.

Everything here is in the caller's coordinates. Flat arrays in normalised coordinates, (input - origin) * scale, are
kept underneath; the pleasant objects are made when they are asked for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mat_core.boundary.sites import SiteTable
from mat_core.kernels.layout import EDGE, FAN, KIND, LOOP
from mat_core.kernels.nurbs import spline_points
from mat_core.model.domain import Domain
from mat_core.topology.graph import NODE_KINDS, AxisGraph
from mat_core.topology.skeleton import Skeleton
from mat_core.tracing.locate import feet, locate

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Point = tuple[float, float]

SEGMENT_KINDS = ("line", "parabola", "hyperbola", "ellipse", "freeform")
SAMPLES = 17  # points sampled on a segment when no step is asked for
LENGTH_NODES = 12  # Gauss points for the length of one piece
CLOSE_CURVE = 0.1  # of the spacing of samples: a curve this near to the axis stands for it where they are spaced
T_ROUNDING = 1e-14  # samples of parameters nearer than this are not told apart


class CurveTable(NamedTuple):
    """The curves of all segments as flat arrays; normalised coordinates.

    degree (G,) and kind (G,), an index into `SEGMENT_KINDS`. Segment g has the knots
    knots[knot_start[g]:knot_start[g + 1]], from 0 to 1, and the rows cp[cp_start[g]:cp_start[g + 1]]: x, y, r, weight
    (not multiplied by it). max_error (G,): measured, in (x, y, r) together. Pieces: part_start (G + 1,); part_i (P, 4):
    segment, strip, side, kind; part_f (P, 4): t0, t1 and the parameters s0, s1 at them on the strip's right site
    (side 0) or left site (side 1).
    """

    degree: Ints
    kind: Ints
    knot_start: Ints
    knots: Floats
    cp_start: Ints
    cp: Floats
    max_error: Floats
    part_start: Ints
    part_i: Ints
    part_f: Floats

    @property
    def part_segment(self) -> Ints:
        """Segment of each piece, (P,)."""
        return self.part_i[:, 0]

    @property
    def part_strip(self) -> Ints:
        """Strip of each piece, (P,)."""
        return self.part_i[:, 1]

    @property
    def part_t(self) -> Floats:
        """(t0, t1) of each piece, (P, 2)."""
        return self.part_f[:, :2]


@dataclass(frozen=True, slots=True)
class Footpoint:
    """Where a maximal disc touches the boundary.

    Attributes
    ----------
    loop : int
        0 is the outer loop, i is ``holes[i - 1]`` of the input.
    edge : int
        Edge of that loop, as the input counts them.
    u : float
        Parameter on that edge, in the edge's own knots.
    point : tuple of float
        The place.
    angle : float or None
        At a reflex vertex, where all normals of a range start: direction of this one, in radians.
    """

    loop: int
    edge: int
    u: float
    point: Point
    angle: float | None = None


@dataclass(frozen=True, slots=True)
class Node:
    """A leaf or branch point of the axis, with its maximal disc.

    Attributes
    ----------
    id : int
        Its index in `MedialAxis.nodes`.
    kind : str
        ``convex_vertex``, ``curvature_center``, ``arc_center``, ``branch`` or ``point``.
    point : tuple of float
        Centre of the disc.
    radius : float
        Its radius.
    footpoints : tuple of Footpoint
        Its contacts in cyclic order; where an arc is touched along its length, both ends of the arc.
    """

    id: int
    kind: str
    point: Point
    radius: float
    footpoints: tuple[Footpoint, ...]


class Samples(NamedTuple):
    """True axis points of segments, not points of their fitted curves.

    t (n,); points (n, 2); radii (n,); left and right (n, 2): footpoints; left_site and right_site (n,): rows of the
    site table; left_u, right_u (n,): the input's parameter; left_angle, right_angle (n,): direction of the normal.
    """

    t: Floats
    points: Floats
    radii: Floats
    left: Floats
    right: Floats
    left_site: Ints
    right_site: Ints
    left_u: Floats
    right_u: Floats
    left_angle: Floats
    right_angle: Floats


@dataclass(frozen=True, repr=False, eq=False)
class Segment:
    """One curve of the axis between two nodes, with its radius: a rational B-spline in (x, y, r) over t in [0, 1].

    Attributes
    ----------
    axis : MedialAxis
        Where it belongs.
    id : int
        Its index in `MedialAxis.segments`.
    """

    axis: MedialAxis
    id: int

    def _node(self, ends: Ints) -> int | None:
        node = int(ends[self.id])
        return node if node >= 0 else None

    @property
    def start_node(self) -> int | None:
        """Id of the node at t = 0; None for a closed segment without a node."""
        return self._node(self.axis.runs.start_node)

    @property
    def end_node(self) -> int | None:
        """Id of the node at t = 1; None for a closed segment without a node."""
        return self._node(self.axis.runs.end_node)

    @property
    def kind(self) -> str:
        """``line``, ``parabola``, ``hyperbola`` or ``ellipse`` when all of it is exactly that, else ``freeform``."""
        return SEGMENT_KINDS[self.axis.curves.kind[self.id]]

    @property
    def degree(self) -> int:
        """Degree of the spline."""
        return int(self.axis.curves.degree[self.id])

    @property
    def knots(self) -> Floats:
        """Clamped knots from 0 to 1, (n + degree + 1,)."""
        c = self.axis.curves
        return c.knots[c.knot_start[self.id] : c.knot_start[self.id + 1]]

    @property
    def _rows(self) -> slice:
        c = self.axis.curves
        return slice(int(c.cp_start[self.id]), int(c.cp_start[self.id + 1]))

    @property
    def control_points(self) -> Floats:
        """(n, 2) points x, y."""
        return self.axis.control_discs[self._rows, :2]

    @property
    def control_values(self) -> Floats:
        """(n,) radii at the control points."""
        return self.axis.control_discs[self._rows, 2]

    @property
    def weights(self) -> Floats:
        """(n,) weights, all 1 on a polynomial curve."""
        return self.axis.curves.cp[self._rows, 3]

    @property
    def max_error(self) -> float:
        """Largest distance from the true axis in (x, y, r), measured."""
        return float(self.axis.curves.max_error[self.id] / self.axis.table.scale)

    @property
    def pieces(self) -> tuple[tuple[float, float, str], ...]:
        """(t0, t1, kind) of every piece between two joints of the boundary."""
        c = self.axis.curves
        rows = range(int(c.part_start[self.id]), int(c.part_start[self.id + 1]))
        return tuple((float(c.part_f[p, 0]), float(c.part_f[p, 1]), SEGMENT_KINDS[c.part_i[p, 3]]) for p in rows)

    def evaluate(self, t: ArrayLike, derivative: bool = False) -> Floats:
        """Centres and radii of discs.

        Parameters
        ----------
        t : array_like
            Parameters in [0, 1]; those outside are moved to the nearer end.
        derivative : bool
            Give the derivatives by t instead.

        Returns
        -------
        ndarray
            (n, 3) rows x, y, r; (3,) for a single t.
        """
        at = np.asarray(t, dtype=float)
        flat = self.axis.evaluate(np.full(at.size, self.id), at.reshape(-1))
        out = flat[:, 3:] if derivative else flat[:, :3]
        return out.reshape(*at.shape, 3)

    def samples(self, t: ArrayLike) -> Samples:
        """True axis points beside the curve's points at t, with both footpoints.

        Parameters
        ----------
        t : array_like
            (n,) parameters in [0, 1].

        Returns
        -------
        Samples
        """
        at = np.atleast_1d(np.asarray(t, dtype=float))
        return self.axis.sample(np.full(at.size, self.id), at)

    def footpoints(self, t: float) -> tuple[Footpoint, Footpoint]:
        """Left and right footpoint, as seen in the direction of increasing t, of the disc at t in [0, 1]."""
        s = self.samples(t)
        return (
            self.axis.footpoint(int(s.left_site[0]), s.left_u[0], s.left[0], s.left_angle[0]),
            self.axis.footpoint(int(s.right_site[0]), s.right_u[0], s.right[0], s.right_angle[0]),
        )

    @property
    def length(self) -> float:
        """Length of the curve of centres."""
        return float(self.axis.lengths[self.id])

    def __repr__(self) -> str:
        ends = "closed" if self.start_node is None else f"{self.start_node} -> {self.end_node}"
        return f"<Segment {self.id}: {ends}, {self.kind}, degree {self.degree}, {len(self.pieces)} pieces>"


@dataclass(frozen=True)
class Graph:
    """How nodes and segments hang together.

    Attributes
    ----------
    edges : tuple of (int, int or None, int or None)
        (segment, source node, target node).
    topological_order : tuple of int
        Nodes, sources before targets; starts at a convex vertex where there is one.
    components, cycles : int
        Of the undirected graph; closed segments count as one component with one cycle.
    """

    edges: tuple[tuple[int, int | None, int | None], ...]
    topological_order: tuple[int, ...]
    components: int
    cycles: int


@dataclass(frozen=True, repr=False, eq=False)
class MedialAxis:
    """The medial axis transform of a domain.

    Made by `mat_core.medial_axis`. `nodes`, `segments` and `graph` are what one reads; `to_dict`, `to_json` and
    `to_svg` what one hands on.

    Attributes
    ----------
    domain : Domain
        What it is the axis of.
    table, skeleton, runs, curves : SiteTable, Skeleton, AxisGraph, CurveTable
        The flat arrays underneath, in normalised coordinates.
    tolerance : float
        Asked of fitted curves, relative to the larger side of the bounding box.
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
        return replace(self, certificate=dict(certificate))

    # Views -------------------------------------------------------------------------------------------------------
    @cached_property
    def nodes(self) -> tuple[Node, ...]:
        """All nodes by id."""
        k = self.skeleton
        discs = self.node_discs
        start = k.contact_start
        wanted = self.runs.node_disc
        counts = start[wanted + 1] - start[wanted]
        ends = np.cumsum(counts)
        rows = np.repeat(start[wanted] - (ends - counts), counts) + np.arange(int(counts.sum()))
        sites = k.contact_site[rows]
        found = self._feet(sites, k.contact_s[rows])
        points = self.to_input(found[:, :2])
        out = []
        for n, (disc, kind) in enumerate(zip(discs.tolist(), self.runs.node_kind.tolist(), strict=True)):
            contacts = range(int(ends[n] - counts[n]), int(ends[n]))
            footpoints = tuple(self.footpoint(int(sites[c]), found[c, 2], points[c], found[c, 3]) for c in contacts)
            out.append(Node(n, NODE_KINDS[kind], (disc[0], disc[1]), disc[2], footpoints))
        return tuple(out)

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
        """(G,) lengths of the segments' curves of centres, by Gauss quadrature on every piece."""
        c = self.curves
        nodes, weights = np.polynomial.legendre.leggauss(LENGTH_NODES)
        half = 0.5 * (c.part_f[:, 1] - c.part_f[:, 0])
        t = 0.5 * (c.part_f[:, 0] + c.part_f[:, 1])[:, None] + half[:, None] * nodes
        d = self.evaluate(np.repeat(c.part_segment, LENGTH_NODES), t.reshape(-1))[:, 3:5]
        speed = np.hypot(d[:, 0], d[:, 1]).reshape(-1, LENGTH_NODES)
        out = np.zeros(len(c.degree))
        np.add.at(out, c.part_segment, half * (speed @ weights))
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
        count = np.full(len(self.curves.degree), SAMPLES)
        if self.step is not None:
            count = np.maximum(count, np.ceil(self.lengths / (self.step * self.domain.size)).astype(np.int64) + 1)
        segment = np.repeat(np.arange(len(count)), count)
        first = np.cumsum(count) - count
        t = (np.arange(len(segment)) - first[segment]) / np.maximum(count - 1, 1)[segment]
        # t runs only nearly in proportion to length: what is still too wide is divided until nothing is
        while self.step is not None:
            parts = self._parts_needed(segment, t, self.step * self.domain.size)
            if not (parts > 1).any():
                break
            before = np.repeat(np.arange(len(parts)), parts - 1)
            place = np.arange(len(before)) - np.repeat(np.cumsum(parts - 1) - (parts - 1), parts - 1) + 1
            between = t[before] + place / parts[before] * (t[before + 1] - t[before])
            segment, t = np.insert(segment, before + 1, segment[before]), np.insert(t, before + 1, between)
        return segment, t

    def _parts_needed(self, segment: Ints, t: Floats, spacing: float) -> Ints:
        """Into how many parts each interval between neighbouring samples must be divided so that none is wider than `spacing`."""
        error = float(self.curves.max_error.max(initial=0.0)) / self.table.scale
        if error <= CLOSE_CURVE * spacing:
            # true axis points lie within the stated error of the curve
            points = self.evaluate(segment, t)[:, :2]
            spacing -= 2.0 * error
        else:
            points = self.sample(segment, t).points
        wide = np.hypot(*np.diff(points, axis=0).T)
        inside = (segment[1:] == segment[:-1]) & (np.diff(t) > T_ROUNDING)
        return np.where(inside, np.maximum(np.ceil(wide / spacing), 1.0), 1.0).astype(np.int64)

    def footpoint(self, site: int, u: float, point: Floats, angle: float) -> Footpoint:
        """The pleasant form of a footpoint; `angle` is kept on a normal fan only."""
        row = self.table.si[site]
        turning = float(angle) if row[KIND] == FAN else None
        return Footpoint(int(row[LOOP]), int(row[EDGE]), float(u), (float(point[0]), float(point[1])), turning)

    def _feet(self, site: Ints, s: Floats) -> Floats:
        """(n, 4) rows x, y (normalised), u, direction of the normal."""
        out = np.empty((len(s), 4))
        feet(self.table.si, self.table.sf, self.table.cp, site, s, out)
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

    def __repr__(self) -> str:
        state = "certified" if self.certificate.get("passed") else "not certified"
        return (
            f"<MedialAxis: {len(self.runs.node_disc)} nodes, {len(self.curves.degree)} segments,"
            f" {self.runs.cycles} cycles, domain of area {self.domain.area:.6g} and size {self.domain.size:.4g},"
            f" tolerance {self.tolerance:g}, {state}>"
        )
