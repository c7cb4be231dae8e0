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
from collections.abc import Callable
from typing import Any

import numpy as np

from mat_core.boundary.sites import SiteTable
from mat_core.certificate.coverage import check_boundary, check_coverage, check_edges, check_whole, list_owned
from mat_core.certificate.discs import check_discs, check_partners, check_touching, find_anew
from mat_core.certificate.inputs import Curves, Discs, Floats, Network, dangling_references
from mat_core.certificate.network import check_counts, check_kinds, check_segments
from mat_core.certificate.report import Report
from mat_core.certificate.splines import check_curves, check_ends, check_shape, sample
from mat_core.kernels.judge import JUDGE_ROWS, JUDGE_STACK, depths
from mat_core.kernels.judge_boxes import judge_boxes
from mat_core.kernels.layout import DEG, XMAX, XMIN, YMAX, YMIN
from mat_core.model.domain import Domain

BLOCK = 1 << 15  # strips or pieces checked at a time: some 15 MB, where all at once would double what a large domain needs


def certify(
    table: SiteTable, skeleton: Discs, graph: Network, curves: Curves, tolerance: float, *, domain: Domain | None = None
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
        Fitted curves of the segments, in (x, y, r); a `mat_core.axis.CurveTable`.
    tolerance : float
        What the curves were asked to keep, relative to the larger side of the bounding box.
    domain : Domain, optional
        The input; with it the table itself is checked against the input's edges, and lengths are relative to its
        bounding box.

    Returns
    -------
    dict
        ``passed`` and ``checks``: for each its ``passed``, ``measured`` figure, ``limit``, ``unit`` (length: relative
        to the larger side of the bounding box; count: number of faults; angle: radians), ``place`` ([x, y] in the
        caller's coordinates or None) and ``detail``, what the figure says. When indices point to nothing that is the
        only check.

    Notes
    -----
    Grows nearly linearly with the number of strips; some 1 ms for a glyph of 40 strips.
    """
    report = Report()
    dangling = dangling_references(len(table.si), skeleton, graph, curves)
    report.faults("references", [dangling], np.empty((0, 2)))
    if dangling:
        return report.to_dict(1.0, table.origin, table.scale, tolerance)

    turn = check_boundary(table, report)
    if domain is not None:
        check_edges(table, domain, report)
    owned = list_owned(skeleton)
    check_coverage(table, skeleton.disc, owned, report)
    check_whole(table, skeleton, report)
    check_counts(table, skeleton, graph, report)
    degree, wholes = check_segments(skeleton, graph, report)
    check_kinds(table, skeleton, graph, degree, wholes, report)

    follows = check_shape(curves, graph, report)
    slack = check_touching(table, skeleton, owned, turn, report)
    del owned, turn  # of the size of the boundary, like all that the blocks below do without
    strip_slack = slack[skeleton.strip_i[:, 2:]].max(axis=1)
    depths_of = depth_finder(table)
    check_discs(skeleton.disc, depths_of(skeleton.disc), slack, report)
    for block in _blocks(len(skeleton.strip_i)):
        found = find_anew(table, skeleton, block)
        check_partners(table, found, depths_of(found.disc), strip_slack, report)
    if follows:
        check_ends(skeleton, graph, curves, report)
        for block in _blocks(len(curves.part_i)):
            sampled = sample(curves, block)
            check_curves(table, skeleton, curves, sampled, depths_of(sampled.disc), strip_slack, report)
    size = domain.size * table.scale if domain is not None else _larger_side(table)
    return report.to_dict(float(size), table.origin, table.scale, tolerance)


@functools.cache
def _binomials(rows: int) -> Floats:
    """Pascal's triangle."""
    return np.array([[float(math.comb(n, k)) for k in range(rows)] for n in range(rows)])


def _larger_side(table: SiteTable) -> float:
    """Of the boundary's bounding box."""
    low = table.sf[:, [XMIN, YMIN]].min(axis=0)
    return float((table.sf[:, [XMAX, YMAX]].max(axis=0) - low).max())


def _blocks(n: int) -> list[slice]:
    """0 .. n - 1 in parts that are checked one after the other; at least one."""
    return [slice(begin, min(begin + BLOCK, n)) for begin in range(0, max(n, 1), BLOCK)]


def depth_finder(table: SiteTable) -> Callable[[Floats], Floats]:
    """A function that tells how deep the boundary reaches into each of many discs (n, 3)."""
    order, box = judge_boxes(table.si, table.sf, table.cp)
    width = 2 * int(table.si[:, DEG].max()) + 1
    stack = np.empty(JUDGE_STACK, dtype=np.int64)
    work = np.empty((JUDGE_ROWS, width + 2))

    def depths_of(probe: Floats) -> Floats:
        depth = np.empty(len(probe))
        depths(table.si, table.sf, table.cp, order, box, stack, work, _binomials(width), probe, depth)
        return depth

    return depths_of
