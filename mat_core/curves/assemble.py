"""From pieces to segments: each run of strips becomes one clamped B-spline in (x, y, r) over t in [0, 1].

Pieces of a run meet with a common tangent. Knot spans are proportional to length; between two fitted pieces the
second span is chosen so that the derivatives agree, too: there the knot is one simpler (C1), the common control point
is left out, unless t would drift too far from length. Everywhere else inner knots have multiplicity `degree`. Conics
keep weights 1 at their ends, so the homogeneous curve is continuous.

Stated error of a segment, normalised: the largest bound of its pieces (`interval`; a conic's measured residual), where
fitted AXIS_ROUNDING for the axis points it is held against, twice the largest distance a joint was moved to make it C1,
and the rounding of coordinates, two units of the largest the caller sees: evaluating is done in those.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.axis import MedialAxis
from mat_core.axis.records import CurveTable
from mat_core.boundary.sites import SiteTable
from mat_core.curves.bezier import raise_degree
from mat_core.curves.conics import K_FREEFORM
from mat_core.curves.fitting import fit_all
from mat_core.curves.interval import AXIS_ROUNDING
from mat_core.curves.pieces import (
    P_DEGREE,
    P_ERROR,
    P_KIND,
    P_LENGTH,
    P_PART,
    P_ROW,
    Q_ROW,
    Q_S0,
    Q_S1,
    Q_SIDE,
    Q_T0,
    Q_T1,
    Pieces,
)
from mat_core.kernels.jit import inner, jit
from mat_core.memory import maker
from mat_core.model.domain import Domain
from mat_core.topology.graph import AxisGraph
from mat_core.topology.skeleton import Skeleton

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

ROUNDING = 4.5e-16  # of coordinates, the caller's: two roundings of the largest one
LEAST_SHARE = 0.5  # of the tolerance that fits must keep, when rounding takes the rest or more
DRIFT = 64.0  # spans may grow or shrink so much against lengths; over thousands of C1 joints t would lose its digits
SHORTEST = 1e-15  # span of a piece without length
C1_DEFECT = 1e-12  # a joint whose control points are off their common line by more than this stays a full knot


@inner
def _smooth_span(cp: Floats, joint: int, span: float) -> tuple[float, float]:
    """(span of the next piece that makes the joint at row `joint` C1, its distance from its neighbours' line)."""
    before = 0.0
    after = 0.0
    for m in range(3):
        d = cp[joint, m] - cp[joint - 1, m]
        before += d * d
        d = cp[joint + 1, m] - cp[joint, m]
        after += d * d
    if not before > 0.0 or not after > 0.0:
        return span, math.inf
    ratio = math.sqrt(after / before)
    defect = 0.0
    for m in range(3):
        d = (ratio * cp[joint - 1, m] + cp[joint + 1, m]) / (1.0 + ratio) - cp[joint, m]
        defect += d * d
    return span * ratio, math.sqrt(defect)


@jit
def assemble_runs(
    run_start: Ints, run_strip: Ints, run_forward: Flags, pieces: Pieces, rounding: float, out: CurveTable
) -> None:
    """All segments, each from the pieces of the strips of its run; its end in the tables of `out` is found here."""
    out.cp_start[0] = 0
    out.knot_start[0] = 0
    out.part_start[0] = 0
    for g in range(out.degree.shape[0]):
        begin = pieces.first[run_start[g]]
        end = pieces.first[run_start[g + 1]]
        error = _measure(pieces, begin, end, out, g)
        defects = _join(pieces, begin, end, out, g)
        _list_parts(pieces, begin, end, run_strip, run_forward, out, g)
        # a joint moved by its defect moves either neighbouring piece by no more, and either has two
        out.max_error[g] = error + 2.0 * defects + rounding


@inner
def _measure(pieces: Pieces, begin: int, end: int, out: CurveTable, g: int) -> float:
    """Degree and kind of segment g; the largest error of its pieces."""
    degree = int(np.int64(1))
    error = 0.0
    kind = pieces.piece_i[begin, P_KIND]
    for p in range(begin, end):
        degree = max(degree, pieces.piece_i[p, P_DEGREE])
        fitted = pieces.piece_i[p, P_KIND] == K_FREEFORM
        error = max(error, pieces.piece_f[p, P_ERROR] + (AXIS_ROUNDING if fitted else 0.0))
        if kind != pieces.piece_i[p, P_KIND]:
            kind = K_FREEFORM
    out.degree[g] = degree
    out.kind[g] = kind
    return error


@inner
def _join(pieces: Pieces, begin: int, end: int, out: CurveTable, g: int) -> float:
    """Control points and knots of segment g; the largest distance that a joint was moved. Spans go to P_LENGTH."""
    n = out.degree[g]
    cp = out.cp
    row = out.cp_start[g]
    knot = out.knot_start[g]
    for m in range(n + 1):
        out.knots[knot + m] = 0.0
    knot += n + 1
    u = 0.0
    span = 0.0
    defects = 0.0
    fitted_before = False
    for p in range(begin, end):
        fitted = pieces.piece_i[p, P_KIND] == K_FREEFORM
        raise_degree(pieces.cp, pieces.piece_i[p, P_ROW], pieces.piece_i[p, P_DEGREE], n, cp, row)
        length = max(pieces.piece_f[p, P_LENGTH], SHORTEST)
        if p > begin and fitted and fitted_before:
            smooth_span, defect = _smooth_span(cp, row, span)
            span = length
            if defect <= C1_DEFECT and length < DRIFT * smooth_span and smooth_span < DRIFT * length:
                span = smooth_span
                defects = max(defects, defect)
                for m in range(row, row + n):
                    for c in range(4):
                        cp[m, c] = cp[m + 1, c]
                row -= 1
                knot -= 1
        else:
            span = length
        pieces.piece_f[p, P_LENGTH] = span
        u += span
        row += n
        for m in range(n):
            out.knots[knot + m] = u
        knot += n
        fitted_before = fitted
    out.cp_start[g + 1] = row + 1
    out.knots[knot] = u
    out.knot_start[g + 1] = knot + 1
    # t from 0 to 1
    for m in range(out.knot_start[g] + n + 1, knot - n):
        out.knots[m] /= u
    for m in range(n + 1):
        out.knots[knot - m] = 1.0
    return defects


@inner
def _list_parts(
    pieces: Pieces, begin: int, end: int, run_strip: Ints, run_forward: Flags, out: CurveTable, g: int
) -> None:
    """Parts of segment g in order of travel, in the strips' own terms."""
    first = out.part_start[g]
    last = pieces.piece_i[end, P_PART]
    u = 0.0
    for p in range(begin, end):
        span = pieces.piece_f[p, P_LENGTH]
        for q in range(pieces.piece_i[p, P_PART], pieces.piece_i[p + 1, P_PART]):
            step = pieces.part_i[q, Q_ROW]
            out.part_i[q, 0] = g
            out.part_i[q, 1] = run_strip[step]
            out.part_i[q, 2] = pieces.part_i[q, Q_SIDE] if run_forward[step] else 1 - pieces.part_i[q, Q_SIDE]
            out.part_i[q, 3] = pieces.piece_i[p, P_KIND]
            out.part_f[q, 0] = u + span * pieces.part_f[q, Q_T0]
            out.part_f[q, 1] = u + span * pieces.part_f[q, Q_T1]
            out.part_f[q, 2] = pieces.part_f[q, Q_S0]
            out.part_f[q, 3] = pieces.part_f[q, Q_S1]
        u += span
    for q in range(first, last):
        out.part_f[q, 0] /= u
        out.part_f[q, 1] = out.part_f[q, 1] / u if q < last - 1 else 1.0
    out.part_start[g + 1] = last


def build_curves(table: SiteTable, skeleton: Skeleton, graph: AxisGraph, tolerance: float, threads: int = 1) -> CurveTable:
    """Fit and assemble the curves of all segments.

    Parameters
    ----------
    table : SiteTable
    skeleton : Skeleton
    graph : AxisGraph
        Its runs name the strips of every segment.
    tolerance : float
        Largest error of a fitted curve in (x, y, r), in normalised units.
    threads : int
        How many may work at a time; the result does not depend on it.

    Returns
    -------
    CurveTable
        Normalised coordinates. A piece that rounding keeps above the tolerance states the larger error.

    Raises
    ------
    NotCertified
        A strip cannot be followed: its discs and its sides do not belong together. Names the place and both sides.
    """
    runs = len(graph.start_node)
    rounding = ROUNDING * (1.0 + float(np.abs(table.origin).max()) * table.scale)
    wanted = max(tolerance - rounding - AXIS_ROUNDING, LEAST_SHARE * tolerance)
    pieces, count = fit_all(table, skeleton, graph, wanted, threads)
    degree = int(pieces.piece_i[:count, P_DEGREE].max(initial=1))
    parts = int(pieces.piece_i[count, P_PART])
    make = maker(parts)
    out = CurveTable(
        make(runs, np.int64), make(runs, np.int64),
        make(runs + 1, np.int64), make(degree * count + (degree + 2) * runs),
        make(runs + 1, np.int64), make((degree * count + runs, 4)),
        make(runs),
        make(runs + 1, np.int64), make((parts, 4), np.int64), make((parts, 4)),
    )  # fmt: skip
    assemble_runs(graph.run_start, graph.run_strip, graph.run_forward, pieces, rounding, out)
    return CurveTable(out.degree, out.kind, out.knot_start, out.knots[: out.knot_start[-1]], out.cp_start,
                      out.cp[: out.cp_start[-1]], out.max_error, out.part_start, out.part_i, out.part_f)


def build_axis(
    domain: Domain, table: SiteTable, skeleton: Skeleton, graph: AxisGraph, tolerance: float, step: float | None,
    threads: int = 1, closer: float = 1.0,
) -> MedialAxis:
    """The medial axis with its curves, still without a certificate.

    Parameters
    ----------
    domain : Domain
    table : SiteTable
    skeleton : Skeleton
        Contracted, as `graph` refers to it.
    graph : AxisGraph
    tolerance : float
        Largest error of fitted curves, relative to the larger side of the bounding box.
    step : float or None
        Largest spacing of samples, relative to the larger side of the bounding box.
    threads : int
        How many may work at a time; the result does not depend on it.
    closer : float
        The share of the tolerance that curves are fitted within.

    Returns
    -------
    MedialAxis
    """
    curves = build_curves(table, skeleton, graph, closer * tolerance * domain.size * table.scale, threads)
    return MedialAxis(domain, table, skeleton, graph, curves, tolerance, step)
