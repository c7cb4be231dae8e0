"""What is judged, as plain arrays: the judge knows the fields it reads, not the modules that made them."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

# kinds of nodes
BRANCH, VERTEX, CURVATURE, ARC_CENTRE, POINT = range(5)


class Discs(Protocol):
    """Discs, contacts, strips and arcs in whole contact; normalised coordinates."""

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
        """(S, 4) from, to on the right (rising); from, to on the left (falling)."""

    @property
    def whole_i(self) -> Ints:
        """(W, 2) site, disc."""

    @property
    def whole_s(self) -> Floats:
        """(W, 2) from, to."""


class Network(Protocol):
    """Nodes and segments, each segment a run of strips."""

    @property
    def node_disc(self) -> Ints:
        """(N,) disc of each node."""

    @property
    def node_kind(self) -> Ints:
        """(N,) BRANCH, VERTEX, CURVATURE, ARC_CENTRE or POINT."""

    @property
    def run_start(self) -> Ints:
        """(G + 1,) first strip of each segment."""

    @property
    def run_strip(self) -> Ints:
        """(R,) strips in order of travel."""

    @property
    def run_forward(self) -> NDArray[np.bool_]:
        """(R,) whether each is travelled from its beginning."""

    @property
    def start_node(self) -> Ints:
        """(G,) node, or -1 when the segment is closed without one."""

    @property
    def end_node(self) -> Ints:
        """(G,) node or -1."""

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
    """Curves of the segments, rational B-splines in (x, y, r) over [0, 1]; normalised coordinates."""

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
        """(n, 4) x, y, r, weight (not multiplied by it)."""

    @property
    def max_error(self) -> Floats:
        """(G,) stated error, in (x, y, r) together."""

    @property
    def part_start(self) -> Ints:
        """(G + 1,) first piece."""

    @property
    def part_i(self) -> Ints:
        """(P, 2 or more); column 1 is the strip."""

    @property
    def part_f(self) -> Floats:
        """(P, 2 or more); columns 0 and 1 are the ends of the piece in t."""


def _in_range(values: Ints, low: int, high: int) -> bool:
    """Whether all integers are in low .. high - 1."""
    return not values.size or bool(values.min() >= low and values.max() < high)


def _are_parameters(values: Floats) -> bool:
    """Whether all are in [0, 1]."""
    return not values.size or bool(values.min() >= 0.0 and values.max() <= 1.0)


def _are_offsets(starts: Ints, rows: int, count: int) -> bool:
    """Whether these are `rows` offsets that begin at 0, never fall, and end at `count`."""
    return len(starts) == rows and starts[0] == 0 and starts[-1] == count and bool((starts[1:] >= starts[:-1]).all())


def dangling_references(sites: int, skeleton: Discs, graph: Network, curves: Curves) -> int:
    """How many tables hold indices or parameters that point to nothing, or have too few rows; the rest relies on 0."""
    discs = len(skeleton.disc)
    strips = len(skeleton.strip_i)
    nodes = len(graph.node_disc)
    runs = len(graph.start_node)
    sound = (
        discs > 0,
        len(skeleton.strip_s) == strips and len(skeleton.whole_s) == len(skeleton.whole_i),
        len(skeleton.contact_s) == len(skeleton.contact_site),
        len(curves.part_f) == len(curves.part_i),
        len(graph.node_kind) == nodes and len(graph.run_forward) == len(graph.run_strip),
        len(graph.end_node) == runs == len(curves.degree) == len(curves.max_error),
        _in_range(skeleton.contact_site, 0, sites) and _are_parameters(skeleton.contact_s),
        _in_range(skeleton.strip_i[:, :2], 0, sites) and _in_range(skeleton.strip_i[:, 2:], 0, discs),
        _in_range(skeleton.whole_i[:, 0], 0, sites) and _in_range(skeleton.whole_i[:, 1], 0, discs),
        _are_parameters(skeleton.strip_s) and _are_parameters(skeleton.whole_s),
        _in_range(graph.node_disc, 0, discs)
        and _in_range(graph.order, 0, nodes)
        and _in_range(graph.run_strip, 0, strips),
        _in_range(graph.start_node, -1, nodes) and _in_range(graph.end_node, -1, nodes),
        bool(((graph.start_node < 0) == (graph.end_node < 0)).all()) if len(graph.end_node) == runs else False,
        _in_range(curves.part_i[:, 1], 0, strips),
        _are_offsets(skeleton.contact_start, discs + 1, len(skeleton.contact_site)),
        _are_offsets(graph.run_start, runs + 1, len(graph.run_strip))
        and bool((graph.run_start[1:] > graph.run_start[:-1]).all()),
        _are_offsets(curves.knot_start, runs + 1, len(curves.knots))
        and _are_offsets(curves.cp_start, runs + 1, len(curves.cp)),
        _are_offsets(curves.part_start, runs + 1, len(curves.part_i)),
    )
    return len(sound) - sum(sound)
