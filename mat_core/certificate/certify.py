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
from mat_core.certificate.discs import check_disc, check_touching
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
    boundary_of,
    curves_of,
    dangling_references,
    discs_of,
    edges_of,
    network_of,
)
from mat_core.certificate.network import check_counts, check_kinds, check_segments
from mat_core.certificate.report import (
    CURVES_EMPTY,
    CURVES_ON_AXIS,
    DISCS_EMPTY,
    PARTNERS_LEFT,
    PARTNERS_RIGHT,
    REFERENCES,
    Certificate,
    conclude,
    fault,
    made,
    no_figures,
    take,
)
from mat_core.certificate.splines import check_ends, check_shape
from mat_core.certificate.strips import PROBES, check_strip, list_parts
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.judge import JUDGE_ROWS, JUDGE_STACK
from mat_core.kernels.judge_boxes import fill_boxes, leaf_order
from mat_core.kernels.layout import XMAX, XMIN, YMAX, YMIN
from mat_core.memory import maker
from mat_core.model.domain import Domain
from mat_core.model.edges import HIGHEST_DEGREE
from mat_core.threads import Bounds, cut, each

STRUCTURE, PLACES, CONCLUDE = 1, 2, 4  # steps of `judge`
DANGLING, UNFIT, SOUND = 0, 1, 2  # references lead nowhere; curves cannot be evaluated; all can be looked at

# rows of `Room.numbers`
FIRST, LABEL, DEGREE, WHOLES, NODES_AT, USES, RANK, INCIDENCE, PART_OF, RUN_OF = range(10)
NUMBERS = 10


class Boxes(NamedTuple):
    """The tree of boxes over the sites, and the room that walking it and looking at pieces takes.

    order (n,), box (2 n, 6): see `fill_boxes`. walk (2, JUDGE_STACK): a stack, and leaves that are near. work (JUDGE_ROWS,
    2 d + 3) and binomial (2 d + 1, 2 d + 1), Pascal's triangle, for pieces of degree up to d = HIGHEST_DEGREE. points: rows for
    de Boor's triangle; probe (PROBES, 5): discs.
    """

    order: Ints
    box: Floats
    walk: Ints
    work: Floats
    binomial: Floats
    points: Floats
    probe: Floats


class Room(NamedTuple):
    """Numbers of all sites, intervals, discs, strips or nodes, filled and read by the checks of STRUCTURE.

    turn (n,): at each smooth joint. key (I,), intervals (2, I): of owned intervals, I = 2 S + W; their order, and room to sort.
    numbers (NUMBERS, m): FIRST interval of each site; LABEL, DEGREE, WHOLES, NODES_AT of discs, USES of strips, RANK and
    INCIDENCE of nodes; PART_OF and RUN_OF of strips, where their curves begin.
    """

    turn: Floats
    key: Floats
    intervals: Ints
    numbers: Ints


@jit
def judge(steps, t, e, ox, oy, scale, size, tolerance, k, g, c, boxes, room, granted, curves, begin, end, figures):
    """STRUCTURE, all checks but those of PLACES; these, for discs and strips begin .. end - 1; CONCLUDE the figures.

    A sum of steps takes one after the other, so that a small domain needs one call. STRUCTURE fills the boxes and `granted` for
    each disc. curves: SOUND or UNFIT, for PLACES without STRUCTURE. Returns (SOUND, UNFIT or DANGLING; 1 if all is well).
    """
    t, e, k, g, c = Boundary(*t), Edges(*e), Discs(*k), Network(*g), Curves(*c)
    boxes, room = Boxes(*boxes), Room(*room)
    if steps & STRUCTURE:
        curves = _structure(t, e, ox, oy, scale, k, g, c, boxes, room, granted, figures)
    if steps & PLACES and curves != DANGLING:
        _places(t, k, c, boxes, room.numbers, granted, curves == SOUND, begin, end, figures)
    passed = conclude(figures, size, ox, oy, scale, tolerance) if steps & CONCLUDE else 0
    return curves, passed


@inner
def _structure(t, e, ox, oy, scale, k, g, c, boxes, room, granted, figures):
    """All checks but those of `_places`: SOUND, UNFIT or DANGLING."""
    dangling = dangling_references(t, k, g, c)
    fault(figures, REFERENCES, dangling, math.nan, math.nan)
    if dangling > 0:
        return DANGLING
    numbers = room.numbers
    order = room.intervals[0]
    degree = numbers[DEGREE]
    wholes = numbers[WHOLES]
    fill_boxes(t.si, t.sf, t.cp, boxes.order, boxes.box)
    check_boundary(t, room.turn, figures)
    if e.degree.shape[0] > 0:
        check_edges(t, e, ox, oy, scale, boxes.points, figures)
    list_owned(k, t.si.shape[0], numbers[FIRST], order, room.intervals[1], room.key)
    check_coverage(t, k, numbers[FIRST], order, figures)
    check_whole(t, k, figures)
    check_counts(t, k, g, numbers[LABEL], figures)
    check_segments(k, g, degree, wholes, numbers[NODES_AT], numbers[USES], numbers[RANK], numbers[INCIDENCE], figures)
    check_kinds(t, k, g, degree, wholes, figures)
    check_touching(t, k, order, room.turn, granted, figures)
    if not check_shape(c, g, figures):
        return UNFIT
    check_ends(k, g, c, boxes.points, figures)
    list_parts(k, c, numbers[PART_OF], numbers[RUN_OF])
    return SOUND


@inner
def _places(t, k, c, boxes, numbers, granted, curves, begin, end, figures):
    """Discs handed in and strips, each begin .. end - 1 as far as there are: with discs found anew, and samples of the curves."""
    made(figures, DISCS_EMPTY)
    made(figures, PARTNERS_RIGHT)
    made(figures, PARTNERS_LEFT)
    for d in range(begin, min(end, k.disc.shape[0])):
        check_disc(t, k, d, boxes, granted, figures)
    strips = min(end, k.strip_i.shape[0])
    if curves and begin < strips:
        made(figures, CURVES_ON_AXIS)
        made(figures, CURVES_EMPTY)
    for strip in range(begin, strips):
        slack = max(granted[k.strip_i[strip, 2]], granted[k.strip_i[strip, 3]])
        part = numbers[PART_OF, strip] if curves else -1
        check_strip(t, k, c, strip, part, numbers[RUN_OF, strip], boxes, slack, figures)


def certify(
    table: SiteTable, skeleton: object, graph: object, curves: object, tolerance: float, *, domain: Domain | None = None,
    threads: int = 1,
) -> Certificate:
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
    Certificate
        ``passed``, ``smooth_angle`` and ``checks``: for each its ``passed``, ``measured`` figure, ``limit``, ``unit`` (length:
        relative to the larger side of the bounding box; count: number of faults; angle: radians), ``place`` ([x, y] in the
        caller's coordinates or None) and ``detail``, what the figure says. When indices point to nothing that is the only check.

    Notes
    -----
    Grows nearly linearly with the number of strips; some 0.2 ms for a glyph of 40 strips.
    """
    k = discs_of(skeleton)
    discs, strips, wholes, nodes = len(k[0]), len(k[4]), len(k[6]), len(graph.node_disc)  # type: ignore[attr-defined]
    e = NOTHING if domain is None else edges_of(domain.arrays)
    ox, oy = table.origin.tolist()
    size = domain.size * table.scale if domain is not None else _larger_side(table)
    granted = np.empty(discs)
    boxes = boxes_for(table)
    room = _room(len(table.si), discs, strips, wholes, nodes)
    asked = (boundary_of(table), e, ox, oy, table.scale, size, tolerance, k, network_of(graph), curves_of(curves))
    figures = no_figures()
    parts = cut(max(discs, strips))
    if len(parts) == 1:
        _, passed = judge(STRUCTURE | PLACES | CONCLUDE, *asked, boxes, room, granted, UNFIT, *parts[0], figures)
        return Certificate(figures, passed == 1, table.smooth_angle)

    def judge_part(part: Bounds) -> Floats:
        told = no_figures()
        judge(PLACES, *asked, own_room(boxes), room, granted, sound, *part, told)
        return told

    sound, _ = judge(STRUCTURE, *asked, boxes, room, granted, UNFIT, 0, 0, figures)
    if sound != DANGLING:
        for told in each(judge_part, parts, threads):
            take(figures, told)
    _, passed = judge(CONCLUDE, *asked, boxes, room, granted, sound, 0, 0, figures)
    return Certificate(figures, passed == 1, table.smooth_angle)


def boxes_for(table: SiteTable) -> tuple[NDArray[Any], ...]:
    """`Boxes` yet to be filled."""
    order, box = leaf_order(table.sf), maker(len(table.sf))((2 * len(table.sf), 6))
    return (
        order, box, np.empty((2, JUDGE_STACK), dtype=np.int64), np.empty((JUDGE_ROWS, 2 * HIGHEST_DEGREE + 3)),
        _binomials(2 * HIGHEST_DEGREE + 1), np.empty((HIGHEST_DEGREE + 1, 4)), np.empty((PROBES, 5)))  # fmt: skip


def own_room(boxes: tuple[NDArray[Any], ...]) -> tuple[NDArray[Any], ...]:
    """The same tree, with room of its own for one more thread."""
    b = Boxes(*boxes)
    return (b.order, b.box, np.empty_like(b.walk), np.empty_like(b.work), b.binomial, np.empty_like(b.points),
            np.empty_like(b.probe))


def _room(sites: int, discs: int, strips: int, wholes: int, nodes: int) -> tuple[NDArray[Any], ...]:
    """`Room` for the numbers of STRUCTURE."""
    intervals = 2 * strips + wholes
    most = max(sites + 1, discs, strips, nodes)
    make = maker(most)
    return make(sites), make(intervals), make((2, intervals), np.int32), make((NUMBERS, most), np.int32)


@functools.cache
def _binomials(rows: int) -> Floats:
    """Pascal's triangle."""
    return np.array([[float(math.comb(n, k)) for k in range(rows)] for n in range(rows)])


def _larger_side(table: SiteTable) -> float:
    """Of the boundary's bounding box."""
    low = table.sf[:, [XMIN, YMIN]].min(axis=0)
    return float((table.sf[:, [XMAX, YMAX]].max(axis=0) - low).max())
