"""The certificate of an axis: is it the medial axis of this boundary, and to what accuracy?

Nothing of what found the axis is used again: no disc query, no tree of boxes, no tracing step, no fit. What is shared is the
evaluation of a boundary piece at a parameter. The checks, in the order of `report.CHECKS`:

    boundary      the pieces form closed loops, turned once, on the input's edges
    combinatorics every bit of the boundary belongs to one strip; faces, components, cycles, leaves and degrees fit together
    discs         those handed in, and new ones inside every strip found from either side, are empty and touch where they should
    curves        run along the axis, through its discs, within the error they state
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.sites import SiteTable
from mat_core.certificate import report as r
from mat_core.certificate.coverage import check_boundary, check_coverage, check_edges, check_whole, list_places
from mat_core.certificate.discs import check_discs, check_touching, list_balls
from mat_core.certificate.network import check_counts, check_kinds, check_references, check_segments
from mat_core.certificate.splines import SAMPLES, check_curves, check_ends, check_shape, list_samples
from mat_core.kernels.judge import (
    JUDGE_ROWS, JUDGE_STACK, balls, depths, distances, fill_binomials, fill_boxes, frames_at,
)
from mat_core.kernels.layout import DEG
from mat_core.model.domain import Domain

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

SAME_DISC = 1e-9  # a strip between discs nearer than this has no inside to look at


class Discs(Protocol):
    """The part of a skeleton that is judged; the fields are those of `mat_core.topology.skeleton.Skeleton`."""

    @property
    def disc(self) -> Floats:
        """(D, 3) x, y, r."""

    @property
    def contact_start(self) -> Ints:
        """(D + 1,) first contact of each disc."""

    @property
    def contact_site(self) -> Ints:
        """(C,) sites."""

    @property
    def contact_s(self) -> Floats:
        """(C,) parameters."""

    @property
    def strip_i(self) -> Ints:
        """(S, 4) right site, left site, disc at the beginning, disc at the end."""

    @property
    def strip_s(self) -> Floats:
        """(S, 4) from, to on the right; from, to on the left."""

    @property
    def whole_i(self) -> Ints:
        """(W, 2) site, disc."""

    @property
    def whole_s(self) -> Floats:
        """(W, 2) from, to."""


class Network(Protocol):
    """The graph that is judged; the fields are those of `mat_core.topology.graph.AxisGraph`."""

    @property
    def node_disc(self) -> Ints:
        """(N,) disc of each node."""

    @property
    def node_kind(self) -> Ints:
        """(N,) branch, convex vertex, curvature centre, arc centre, point."""

    @property
    def run_start(self) -> Ints:
        """(G + 1,) first strip of each segment."""

    @property
    def run_strip(self) -> Ints:
        """Strips in order of travel."""

    @property
    def run_forward(self) -> NDArray[np.bool_]:
        """Whether each is travelled from its beginning."""

    @property
    def start_node(self) -> Ints:
        """(G,) or -1."""

    @property
    def end_node(self) -> Ints:
        """(G,) or -1."""

    @property
    def order(self) -> Ints:
        """(N,) nodes in topological order."""

    @property
    def components(self) -> int:
        """As stated."""

    @property
    def cycles(self) -> int:
        """As stated."""


class Curves(Protocol):
    """The curves that are judged; the fields are those of `mat_core.axis.CurveTable`."""

    @property
    def degree(self) -> Ints:
        """(G,) degrees."""

    @property
    def knot_start(self) -> Ints:
        """(G + 1,) first knot."""

    @property
    def knots(self) -> Floats:
        """All knots."""

    @property
    def cp_start(self) -> Ints:
        """(G + 1,) first control point."""

    @property
    def cp(self) -> Floats:
        """(n, 4) x, y, r, weight."""

    @property
    def max_error(self) -> Floats:
        """(G,) stated error."""

    @property
    def part_start(self) -> Ints:
        """(G + 1,) first piece."""

    @property
    def part_i(self) -> Ints:
        """(P, 4), column 1 is the strip."""

    @property
    def part_f(self) -> Floats:
        """(P, 4), columns 0 and 1 are the ends of the piece in t."""


def certify(
    table: SiteTable, skeleton: Discs, graph: Network, curves: Curves, tolerance: float, *, domain: Domain | None = None
) -> dict[str, Any]:
    """Check an axis against its boundary.

    Parameters
    ----------
    table : SiteTable
        The boundary, in normalised coordinates, as the axis refers to it.
    skeleton : Discs
        Discs, contacts, strips and arcs in whole contact.
    graph : Network
        Nodes and segments.
    curves : Curves
        Fitted curves of the segments, in (x, y, r).
    tolerance : float
        What the curves were asked to keep, relative to the larger side of the bounding box.
    domain : Domain, optional
        The input; with it the table itself is checked against the input's edges, and lengths are relative to its bounding box.

    Returns
    -------
    dict
        ``passed`` and ``checks``: for each its ``passed``, ``measured`` figure, ``limit``, ``unit`` (length: relative to the larger
        side of the bounding box; count: number of faults; angle: radians), ``place`` ([x, y] in the caller's coordinates or None)
        and ``detail``, what the figure says. When indices point to nothing that is the only check.
    """
    report = r.new_report()
    run_ends = np.empty((len(graph.start_node), 2), dtype=np.int64)
    if _same_lengths(skeleton, graph, curves):
        check_references(
            len(table.si), skeleton.disc, skeleton.contact_start, skeleton.contact_site, skeleton.contact_s, skeleton.strip_i,
            skeleton.strip_s, skeleton.whole_i, skeleton.whole_s, graph.node_disc, graph.run_start, graph.run_strip,
            graph.start_node, graph.end_node, graph.order, curves.knot_start, curves.knots, curves.cp_start, curves.cp,
            curves.part_start, curves.part_i, run_ends, report)
    else:
        report[r.REFERENCES, r.MEASURED] = 1.0
    if report[r.REFERENCES, r.MEASURED] > 0.0:
        return r.to_dict(report, 1.0, table.origin, table.scale, tolerance, range(r.REFERENCES + 1))

    places = _list_places(table, skeleton)
    turn = np.empty(len(table.si))
    check_boundary(table.si, table.sf, table.loop_start, turn, report)
    _judge_combinatorics(table, skeleton, graph, run_ends, places, report)
    if domain is not None:
        _judge_edges(table, domain, places, report)
    box = _judge_discs(table, skeleton, graph, curves, places, turn, report)
    size = domain.size * table.scale if domain is not None else float(max(box[1, 2] - box[1, 0], box[1, 3] - box[1, 1]))
    return r.to_dict(report, size, table.origin, table.scale, tolerance, range(len(r.CHECKS)))


class Places(NamedTuple):
    """Owned intervals of the boundary, and the points of it that are looked at: site, s, disc, frame; by `coverage.list_places`.

    Of the places, `ends` and `contacts` belong to discs; middles of arcs, points on pieces and footpoints inside strips follow.
    """

    owned_i: Ints
    owned_s: Floats
    site: Ints
    s: Floats
    disc: Ints
    frame: Floats
    job_i: Ints
    job_s: Floats
    job_strip: Ints
    arcs: int
    pieces: int
    samples: int


def _list_places(table: SiteTable, skeleton: Discs) -> Places:
    """All points of the boundary that are looked at, with position and tangent."""
    strips = len(skeleton.strip_i)
    owned = 2 * strips + len(skeleton.whole_i)
    arcs = 2 * owned + len(skeleton.contact_site)
    pieces = arcs + len(skeleton.whole_i)
    samples = pieces + len(table.si)
    owned_i = np.empty((owned, 3), dtype=np.int64)
    owned_s = np.empty((owned, 2))
    site = np.empty(samples + 2 * strips, dtype=np.int64)
    s = np.empty(len(site))
    disc = np.empty(arcs, dtype=np.int64)
    list_places(table.si, skeleton.strip_i, skeleton.strip_s, skeleton.whole_i, skeleton.whole_s, skeleton.contact_start,
                skeleton.contact_site, skeleton.contact_s, owned_i, owned_s, site, s, disc)
    job_i = np.empty((2 * strips, 2), dtype=np.int64)
    job_s = np.empty((2 * strips, 3))
    job_strip = np.empty((2 * strips, 2), dtype=np.int64)
    jobs = list_balls(skeleton.disc, skeleton.strip_i, skeleton.strip_s, samples, SAME_DISC, site, s, job_i, job_s, job_strip)
    site = site[: samples + jobs]
    s = s[: samples + jobs]
    frame = np.empty((len(site), 4))
    frames_at(table.si, table.sf, table.cp, site, s, frame)
    return Places(owned_i, owned_s, site, s, disc, frame, job_i[:jobs], job_s[:jobs], job_strip[:jobs], arcs, pieces, samples)


def _judge_edges(table: SiteTable, domain: Domain, places: Places, report: Floats) -> None:
    """The boundary pieces against the input's edges."""
    a = domain.arrays
    check_edges(table.si, table.sf, table.cp, places.site, places.s, places.pieces, places.frame, a.degree, a.cp_start, a.cp,
                a.knot_start, a.knots, a.loop_start, table.origin[0], table.origin[1], table.scale,
                np.empty((int(a.degree.max()) + 1, 3)), report)


def _same_lengths(skeleton: Discs, graph: Network, curves: Curves) -> bool:
    """Whether tables that belong together have as many rows."""
    return (
        len(skeleton.strip_s) == len(skeleton.strip_i)
        and len(skeleton.whole_s) == len(skeleton.whole_i)
        and len(skeleton.contact_s) == len(skeleton.contact_site)
        and len(curves.part_f) == len(curves.part_i)
        and len(graph.node_kind) == len(graph.node_disc)
        and len(graph.run_forward) == len(graph.run_strip)
        and len(graph.end_node) == len(graph.start_node) == len(curves.degree) == len(curves.max_error)
        and len(skeleton.disc) > 0
    )


def _judge_combinatorics(
    table: SiteTable, skeleton: Discs, graph: Network, run_ends: Ints, places: Places, report: Floats
) -> None:
    """Coverage, counts, segments and kinds of nodes."""
    si, sf = table.si, table.sf
    disc, strip_i = skeleton.disc, skeleton.strip_i
    # by the middle, so that ends that differ by rounding do not change the order
    order = np.lexsort((places.owned_s[:, 0] + places.owned_s[:, 1], places.owned_i[:, 0]))
    check_coverage(si, sf, disc, places.owned_i, places.owned_s, order, np.empty(len(si) + 1, dtype=np.int64), places.frame, report)
    check_whole(si, sf, disc, skeleton.whole_i, skeleton.whole_s, places.arcs, places.frame, report)

    discs = len(disc)
    nodes = len(graph.node_disc)
    per_disc = np.empty((4, discs), dtype=np.int64)
    degree, whole_count = per_disc[0], per_disc[1]
    check_counts(si, len(table.loop_start) - 2, disc, skeleton.contact_site, strip_i, skeleton.whole_i, run_ends,
                 graph.node_kind, graph.components, graph.cycles, np.empty(max(discs, nodes), dtype=np.int64), report)
    check_segments(disc, skeleton.contact_start, strip_i, skeleton.whole_i, graph.node_disc, graph.run_start, graph.run_strip,
                   graph.run_forward, run_ends, graph.order, degree, whole_count, per_disc[2], np.empty(nodes, dtype=np.int64),
                   np.empty(len(strip_i), dtype=np.int64), report)
    check_kinds(si, sf, disc, skeleton.contact_start, skeleton.contact_site, skeleton.contact_s, degree, whole_count,
                graph.node_disc, graph.node_kind, report)


def _judge_discs(
    table: SiteTable, skeleton: Discs, graph: Network, curves: Curves, places: Places, turn: Floats, report: Floats
) -> Floats:
    """Discs handed in, discs found anew, discs of the fitted curves; returns the tree of boxes, whose row 1 is the whole."""
    si, sf, cp = table.si, table.sf, table.cp
    disc, strip_i, strip_s = skeleton.disc, skeleton.strip_i, skeleton.strip_s
    discs = len(disc)
    jobs = len(places.job_i)
    check_shape(curves.degree, curves.knot_start, curves.knots, curves.cp_start, curves.cp, curves.max_error, curves.part_start,
                curves.part_f, graph.start_node, report)
    sampled = SAMPLES * len(curves.part_i) if report[r.CURVES_CONTINUOUS, r.MEASURED] < np.inf else 0
    probe = np.empty((discs + jobs + sampled, 3))
    probe[:discs] = disc
    partner = np.empty((jobs, 5))
    balls(si, sf, cp, places.job_i, places.job_s, places.frame, probe[discs:], partner)
    side_site = np.empty(2 * sampled, dtype=np.int64)
    side_interval = np.empty((2 * sampled, 3))
    side_disc = np.empty((2 * sampled, 3))
    if sampled > 0:
        point = np.empty((int(curves.degree.max()) + 1, 4))
        check_ends(disc, strip_i, graph.node_disc, graph.start_node, graph.end_node, graph.run_start, graph.run_strip,
                   graph.run_forward, curves.degree, curves.knot_start, curves.knots, curves.cp_start, curves.cp, curves.max_error,
                   curves.part_start, curves.part_i, curves.part_f, point, report)
        list_samples(strip_i, strip_s, curves.degree, curves.knot_start, curves.knots, curves.cp_start, curves.cp,
                     curves.part_start, curves.part_i, curves.part_f, point, discs + jobs, probe, side_site, side_interval, side_disc)

    box = np.empty((2 * len(si), 4))
    fill_boxes(si, sf, cp, box)
    width = 2 * int(si[:, DEG].max()) + 1
    binomial = np.empty((width, width))
    fill_binomials(binomial)
    depth = np.empty(len(probe))
    depths(si, sf, cp, box, np.empty(JUDGE_STACK, dtype=np.int64), np.empty((JUDGE_ROWS, width + 2)), binomial, probe, depth)
    distance = np.empty(len(side_site))
    distances(si, sf, cp, side_site, side_interval, side_disc, distance)

    disc_slack = np.empty(discs)
    strip_slack = np.empty(len(strip_i))
    check_touching(si, sf, turn, disc, places.site, places.s, places.disc, places.frame, places.arcs, disc_slack, report)
    check_discs(si, sf, disc, strip_i, disc_slack, strip_slack, jobs, places.job_i, places.job_strip, partner, probe, depth, report)
    if sampled > 0:
        check_curves(curves.degree, curves.max_error, curves.part_start, curves.part_i, strip_slack, discs + jobs, probe, depth,
                     distance, report)
    return box
