"""The certificate of an axis: is it the medial axis of this boundary, and to what accuracy?

Nothing of what found the axis is used again: no disc query, no tree of boxes, no tracing step, no fit. What is shared
is the evaluation of a boundary piece at a parameter. The checks, in the order of `report.CHECKS`:

    boundary       the pieces form closed loops, turned once, on the input's edges
    combinatorics  every bit of the boundary belongs to one strip; faces, components, cycles, leaves, degrees agree
    discs          those handed in, and new ones found from either side of every strip, are empty and touch
    curves         run along the axis, through its discs, within the error they state
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.sites import SiteTable
from mat_core.certificate.coverage import check_boundary, check_coverage, check_whole, list_owned
from mat_core.certificate.discs import check_disc, check_partners, check_touching
from mat_core.certificate.edges import check_edges
from mat_core.certificate.inputs import (
    NOTHING,
    Boundary,
    Curves,
    Discs,
    Edges,
    Floats,
    Ints,
    Network,
    dangling_references,
    taken,
)
from mat_core.certificate.network import check_counts, check_kinds, check_segments
from mat_core.certificate.report import (
    CURVES_EMPTY,
    CURVES_ON_AXIS,
    DISCS_EMPTY,
    PARTNERS_LEFT,
    PARTNERS_RIGHT,
    REFERENCES,
    Figures,
    fault,
    made,
    to_dict,
)
from mat_core.certificate.splines import SAMPLES, check_ends, check_piece, check_shape
from mat_core.kernels.jit import jit
from mat_core.kernels.judge import JUDGE_ROWS, JUDGE_STACK
from mat_core.kernels.judge_boxes import MOST_NEAR, fill_boxes, leaf_order
from mat_core.kernels.layout import DEG, XMAX, XMIN, YMAX, YMIN
from mat_core.model.domain import Domain
from mat_core.threads import Bounds, cut, each

DANGLING, UNFIT, SOUND = 0, 1, 2  # references lead nowhere; curves cannot be evaluated; all can be looked at


class Boxes(NamedTuple):
    """The tree of boxes over the sites, and the room that walking it and looking at pieces takes.

    order (n,), box (2 n, 6): see `fill_boxes`. stack (JUDGE_STACK,); work (JUDGE_ROWS, 2 d + 3) and binomial (2 d + 1, 2 d + 1),
    Pascal's triangle, for pieces of degree up to d. points: rows for de Boor's triangle. near (MOST_NEAR,): leaves; probe
    (SAMPLES, 3): discs.
    """

    order: Ints
    box: Floats
    stack: Ints
    work: Floats
    binomial: Floats
    points: Floats
    near: Ints
    probe: Floats

    def shared(self) -> Boxes:
        """The same tree, with room of its own for one more thread."""
        return Boxes(self.order, self.box, np.empty_like(self.stack), np.empty_like(self.work), self.binomial,
                     np.empty_like(self.points), np.empty_like(self.near), np.empty_like(self.probe))


class Room(NamedTuple):
    """Numbers of all sites, intervals, discs, strips or nodes, filled and read by the checks of `judge_structure`.

    turn (n,): at each smooth joint; first (n + 1,), order, spare, key (2 S + W,): of owned intervals; label, degree, wholes,
    nodes_at (D,); uses (S,); rank, incidence (N,).
    """

    turn: Floats
    first: Ints
    order: Ints
    spare: Ints
    key: Floats
    label: Ints
    degree: Ints
    wholes: Ints
    nodes_at: Ints
    uses: Ints
    rank: Ints
    incidence: Ints


@jit
def judge_structure(t, e, ox, oy, scale, k, g, c, boxes, room, granted, figures):
    """All checks but those of `judge_places`; fills the boxes, and `granted` for each disc. Returns SOUND, UNFIT or DANGLING."""
    dangling = dangling_references(t, k, g, c)
    fault(figures, REFERENCES, dangling, math.nan, math.nan)
    if dangling > 0:
        return DANGLING
    fill_boxes(t.si, t.sf, t.cp, boxes.order, boxes.box)
    check_boundary(t, room.turn, figures)
    if e.degree.shape[0] > 0:
        check_edges(t, e, ox, oy, scale, boxes.points, figures)
    list_owned(k, room.first, room.order, room.spare, room.key)
    check_coverage(t, k, room.first, room.order, figures)
    check_whole(t, k, figures)
    check_counts(t, k, g, room.label, figures)
    check_segments(k, g, room.degree, room.wholes, room.nodes_at, room.uses, room.rank, room.incidence, figures)
    check_kinds(t, k, g, room.degree, room.wholes, figures)
    check_touching(t, k, room.order, room.turn, granted, figures)
    if not check_shape(c, g, figures):
        return UNFIT
    check_ends(k, g, c, boxes.points, figures)
    return SOUND


@jit
def judge_places(t, k, c, boxes, granted, discs, strips, parts, run, figures):
    """Discs, strips and parts of curves, each from .. to - 1: the discs handed in, those found anew in strips, and samples.

    run: the segment of the first part.
    """
    made(figures, DISCS_EMPTY)
    made(figures, PARTNERS_RIGHT)
    made(figures, PARTNERS_LEFT)
    for d in range(discs[0], discs[1]):
        check_disc(t, k, d, boxes, granted, figures)
    for strip in range(strips[0], strips[1]):
        slack = max(granted[k.strip_i[strip, 2]], granted[k.strip_i[strip, 3]])
        check_partners(t, k, strip, boxes, slack, figures)
    if parts[0] < parts[1]:
        made(figures, CURVES_ON_AXIS)
        made(figures, CURVES_EMPTY)
    for part in range(parts[0], parts[1]):
        while part >= c.part_start[run + 1]:
            run += 1
        strip = c.part_i[part, 1]
        slack = max(granted[k.strip_i[strip, 2]], granted[k.strip_i[strip, 3]])
        check_piece(t, k, c, run, part, boxes, slack, figures)


def certify(
    table: SiteTable, skeleton: object, graph: object, curves: object, tolerance: float, *, domain: Domain | None = None,
    threads: int = 1,
) -> dict[str, Any]:
    """Check an axis against its boundary.

    Parameters
    ----------
    table : SiteTable
        The boundary, in normalised coordinates, as the axis refers to it.
    skeleton : Discs
        Discs, contacts, strips and arcs in whole contact; a `mat_core.topology.skeleton.Skeleton`.
    graph : Network
        Nodes and segments; a `mat_core.topology.graph.AxisGraph`.
    curves : Curves
        Fitted curves of the segments, in (x, y, r); a `mat_core.axis.records.CurveTable`.
    tolerance : float
        What the curves were asked to keep, relative to the larger side of the bounding box.
    domain : Domain, optional
        The input; with it the table itself is checked against the input's edges, and lengths are relative to its
        bounding box.
    threads : int
        How many may work at a time; the result does not depend on it.

    Returns
    -------
    dict
        ``passed`` and ``checks``: for each its ``passed``, ``measured`` figure, ``limit``, ``unit`` (length: relative
        to the larger side of the bounding box; count: number of faults; angle: radians), ``place`` ([x, y] in the
        caller's coordinates or None) and ``detail``, what the figure says. When indices point to nothing that is the
        only check.

    Notes
    -----
    Grows nearly linearly with the number of strips; some 0.2 ms for a glyph of 40 strips.
    """
    t, k, g, c = taken(Boundary, table), taken(Discs, skeleton), taken(Network, graph), taken(Curves, curves)
    e = NOTHING if domain is None else taken(Edges, domain.arrays)
    figures = Figures.unseen()
    granted = np.empty(len(k.disc))
    boxes = boxes_for(t, e, c)
    ox, oy = table.origin.tolist()
    sound = judge_structure(t, e, ox, oy, table.scale, k, g, c, boxes, _room(t, k, g), granted, figures)
    if sound == DANGLING:
        return to_dict(figures, 1.0, table.origin, table.scale, tolerance)
    _judge_everywhere(t, k, c, boxes, granted, sound == SOUND, figures, threads)
    size = domain.size * table.scale if domain is not None else _larger_side(table)
    return to_dict(figures, float(size), table.origin, table.scale, tolerance)


def _judge_everywhere(
    t: Boundary, k: Discs, c: Curves, boxes: Boxes, granted: Floats, curves: bool, figures: Figures, threads: int
) -> None:
    """`judge_places` for all that there is, with the curves if they can be evaluated; large domains in parts."""
    counts = (len(k.disc), len(k.strip_i), len(c.part_i) if curves else 0)
    shares = cut(max(counts))
    if len(shares) == 1:
        discs, strips, parts = ((0, count) for count in counts)
        judge_places(t, k, c, boxes, granted, discs, strips, parts, 0, figures)
        return

    def judge(part: Bounds) -> Figures:
        discs, strips, parts = ((min(part[0], count), min(part[1], count)) for count in counts)
        run = int(np.searchsorted(c.part_start, parts[0], side="right")) - 1 if curves else 0
        told = Figures.unseen()
        judge_places(t, k, c, boxes.shared(), granted, discs, strips, parts, run, told)
        return told

    for told in each(judge, shares, threads):
        figures.take(told)


def boxes_for(t: Boundary, e: Edges, c: Curves) -> Boxes:
    """Room for the tree, and for pieces and curves of the degrees that there are."""
    width = 2 * int(t.si[:, DEG].max()) + 1
    degree = max(int(c.degree.max(initial=1)), int(e.degree.max(initial=1)), 1)
    return Boxes(
        leaf_order(t.sf), np.empty((2 * len(t.sf), 6)), np.empty(JUDGE_STACK, dtype=np.int64), np.empty((JUDGE_ROWS, width + 2)),
        _binomials(width), np.empty((degree + 1, 4)), np.empty(MOST_NEAR, dtype=np.int64),
        np.empty((len(SAMPLES), 3)))  # fmt: skip


def _room(t: Boundary, k: Discs, g: Network) -> Room:
    """Room for the numbers of `judge_structure`."""
    sites, discs, strips, nodes = len(t.si), len(k.disc), len(k.strip_i), len(g.node_disc)
    intervals = 2 * strips + len(k.whole_i)

    def numbers(n: int) -> NDArray[np.int64]:
        return np.empty(n, dtype=np.int64)

    return Room(
        np.empty(sites), numbers(sites + 1), numbers(intervals), numbers(intervals), np.empty(intervals),
        numbers(max(discs, nodes)), numbers(discs), numbers(discs), numbers(discs), numbers(strips), numbers(nodes),
        numbers(nodes))  # fmt: skip


@functools.cache
def _binomials(rows: int) -> Floats:
    """Pascal's triangle."""
    return np.array([[float(math.comb(n, k)) for k in range(rows)] for n in range(rows)])


def _larger_side(table: SiteTable) -> float:
    """Of the boundary's bounding box."""
    low = table.sf[:, [XMIN, YMIN]].min(axis=0)
    return float((table.sf[:, [XMAX, YMAX]].max(axis=0) - low).max())
