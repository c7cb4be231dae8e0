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
from mat_core.boundary.sites import SiteTable
from mat_core.curves.bezier import raise_degree
from mat_core.curves.conics import K_FREEFORM
from mat_core.curves.fit import fit_strips, travel
from mat_core.curves.interval import AXIS_ROUNDING, CHEBYSHEV, MAX_DEGREE, ROWS, SAMPLE_ROWS
from mat_core.curves.pieces import (
    NO_FIT,
    NO_ROOM,
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
)
from mat_core.curves.way import END_COLUMNS, END_ROWS, MAX_STRIPS, SAMPLE_COLUMNS, WAITING
from mat_core.errors import NotCertified
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import EDGE, LOOP
from mat_core.model.domain import Domain
from mat_core.model.edges import HIGHEST_DEGREE
from mat_core.records import CurveTable
from mat_core.topology.graph import AxisGraph
from mat_core.topology.skeleton import Skeleton

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

FINE_TOLERANCE = 2e-5  # at and above: quintic pieces, below: degree 7; a quarter fewer pieces at 1e-6
FINEST_TOLERANCE = 2e-8  # below: degree 9; a fifth fewer pieces at 1e-9, a third at 1e-12
ROUNDING = 4.5e-16  # of coordinates, the caller's: two roundings of the largest one
LEAST_SHARE = 0.5  # of the tolerance that fits must keep, when rounding takes the rest or more
DRIFT = 64.0  # spans may grow or shrink so much against lengths; over thousands of C1 joints t would lose its digits
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
    run_start: Ints, run_strip: Ints, run_forward: Flags, first: Ints, piece_i: Ints, piece_f: Floats, piece_cp: Floats,
    found_i: Ints, found_f: Floats, rounding: float, degree: Ints, kind: Ints, max_error: Floats, knot_start: Ints,
    knots: Floats, cp_start: Ints, cp: Floats, part_start: Ints, part_i: Ints, part_f: Floats,
) -> None:
    """All segments; the pieces of run g are first[run_start[g]] .. first[run_start[g + 1]], their parts found_i and found_f.

    part_i (segment, strip, side, kind) and part_f (t0, t1, s0, s1) list the parts in order of travel.
    """
    cp_start[0] = 0
    knot_start[0] = 0
    part_start[0] = 0
    for g in range(degree.shape[0]):
        begin = first[run_start[g]]
        end = first[run_start[g + 1]]
        # 1. degree, kind and stated error of the whole run
        n = int(np.int64(1))
        error = 0.0
        common = piece_i[begin, P_KIND]
        for p in range(begin, end):
            n = max(n, piece_i[p, P_DEGREE])
            fitted = piece_i[p, P_KIND] == K_FREEFORM
            error = max(error, piece_f[p, P_ERROR] + (AXIS_ROUNDING if fitted else 0.0))
            if common != piece_i[p, P_KIND]:
                common = K_FREEFORM
        degree[g] = n
        kind[g] = common
        # 2. control points and knots, spans not yet scaled
        row = cp_start[g]
        knot = knot_start[g]
        for m in range(n + 1):
            knots[knot + m] = 0.0
        knot += n + 1
        u = 0.0
        span = 0.0
        defects = 0.0
        fitted_before = False
        for p in range(begin, end):
            fitted = piece_i[p, P_KIND] == K_FREEFORM and piece_i[p, P_DEGREE] == n
            raise_degree(piece_cp, piece_i[p, P_ROW], piece_i[p, P_DEGREE], n, cp, row)
            length = max(piece_f[p, P_LENGTH], 1e-15)
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
            for q in range(piece_i[p, P_PART], piece_i[p + 1, P_PART]):
                step = found_i[q, Q_ROW]
                part_i[q, 0] = g
                part_i[q, 1] = run_strip[step]
                part_i[q, 2] = found_i[q, Q_SIDE] if run_forward[step] else 1 - found_i[q, Q_SIDE]
                part_i[q, 3] = piece_i[p, P_KIND]
                part_f[q, 0] = u + span * found_f[q, Q_T0]
                part_f[q, 1] = u + span * found_f[q, Q_T1]
                part_f[q, 2] = found_f[q, Q_S0]
                part_f[q, 3] = found_f[q, Q_S1]
            u += span
            row += n
            for m in range(n):
                knots[knot + m] = u
            knot += n
            fitted_before = fitted
        row += 1
        knots[knot] = u
        knot += 1
        # 3. t from 0 to 1
        for m in range(knot_start[g] + n + 1, knot - n - 1):
            knots[m] /= u
        for m in range(n + 1):
            knots[knot - 1 - m] = 1.0
        part_start[g + 1] = piece_i[end, P_PART]
        for m in range(part_start[g], part_start[g + 1]):
            part_f[m, 0] /= u
            part_f[m, 1] = part_f[m, 1] / u if m < part_start[g + 1] - 1 else 1.0
        # a joint moved by its defect moves either neighbouring piece by no more, and either has two
        max_error[g] = error + 2.0 * defects + rounding
        cp_start[g + 1] = row
        knot_start[g + 1] = knot


def _cannot_follow(table: SiteTable, skeleton: Skeleton, strip: int, tolerance: float) -> NotCertified:
    """The diagnosis for a strip that was given up, at the middle of its two end discs."""
    site_a, site_b, disc0, disc1 = (int(i) for i in skeleton.strip_i[strip])
    middle = 0.5 * (skeleton.disc[disc0, :2] + skeleton.disc[disc1, :2]) / table.scale + table.origin
    sides = " and ".join(f"edge {table.si[i, EDGE]} of loop {table.si[i, LOOP]}" for i in (site_a, site_b))
    detail = (f"curves: the axis between {sides} does not lead from one of its end discs to the other, so no curve follows it "
              f"within {tolerance / table.scale:.3g}; the discs there were probably joined or told apart wrongly")
    return NotCertified(detail, (float(middle[0]), float(middle[1])) if np.isfinite(middle).all() else None)


def build_curves(table: SiteTable, skeleton: Skeleton, graph: AxisGraph, tolerance: float) -> CurveTable:
    """Fit and assemble the curves of all segments.

    Parameters
    ----------
    table : SiteTable
    skeleton : Skeleton
    graph : AxisGraph
        Its runs name the strips of every segment.
    tolerance : float
        Largest error of a fitted curve in (x, y, r), in normalised units.

    Returns
    -------
    CurveTable
        Normalised coordinates. A piece that rounding keeps above the tolerance states the larger error.

    Raises
    ------
    NotCertified
        A strip cannot be followed: its discs and its sides do not belong together. Names the place and both sides.
    """
    n = len(graph.run_strip)
    runs = len(graph.start_node)
    degree = _degree(tolerance)
    rounding = ROUNDING * (1.0 + float(np.abs(table.origin).max()) * table.scale)
    wanted = max(tolerance - rounding - AXIS_ROUNDING, LEAST_SHARE * tolerance)
    room = n + 8
    first = np.empty(n + 1, dtype=np.int64)
    strip_i = np.empty((n, 4), dtype=np.int64)
    strip_s = np.empty((n, 4))
    joined = np.empty(n, dtype=np.bool_)
    travel(table.si, table.sf, table.cp, skeleton.strip_i, skeleton.strip_s, graph.run_start, graph.run_strip, graph.run_forward,
           strip_i, strip_s, joined, np.empty((2 * HIGHEST_DEGREE + 2, 3)))
    way_i = np.empty((n, 2), dtype=np.int64)
    way_f = np.empty((n, 4))
    count = NO_ROOM
    while count == NO_ROOM:
        room *= 4
        piece_i = np.empty((room + 1, 4), dtype=np.int64)
        piece_f = np.empty((room, 2))
        piece_cp = np.empty((ROWS * room, 4))
        found_i = np.empty((room + n, 2), dtype=np.int64)
        found_f = np.empty((room + n, 4))
        # ends after the first growth but for curves of many pieces; at the latest at MAX_PIECES for each stretch
        count = fit_strips(
            table.si, table.sf, table.cp, skeleton.disc, strip_i, strip_s, joined, wanted, degree,
            np.empty((END_ROWS, END_COLUMNS)), np.empty((WAITING, END_COLUMNS)), np.empty((SAMPLE_ROWS, SAMPLE_COLUMNS)),
            np.empty((4, 3)), np.empty((MAX_DEGREE, 3)), np.empty((MAX_DEGREE, 3)), CHEBYSHEV, np.empty((MAX_STRIPS, 4)),
            np.empty(ROWS), np.empty(3), np.empty(3), way_i, way_f, piece_i, piece_f, piece_cp, found_i, found_f, first)
    if count <= NO_FIT:
        raise _cannot_follow(table, skeleton, int(graph.run_strip[NO_FIT - count]), tolerance)
    parts = int(piece_i[count, P_PART]) if count else 0
    degrees = np.empty(runs, dtype=np.int64)
    kinds = np.empty(runs, dtype=np.int64)
    max_error = np.empty(runs)
    knot_start = np.empty(runs + 1, dtype=np.int64)
    knots = np.empty(degree * count + (degree + 2) * runs)
    cp_start = np.empty(runs + 1, dtype=np.int64)
    cp = np.empty((degree * count + runs, 4))
    part_start = np.empty(runs + 1, dtype=np.int64)
    part_i = np.empty((parts, 4), dtype=np.int64)
    part_f = np.empty((parts, 4))
    assemble_runs(graph.run_start, graph.run_strip, graph.run_forward, first, piece_i, piece_f, piece_cp, found_i, found_f,
                  rounding, degrees, kinds, max_error, knot_start, knots, cp_start, cp, part_start, part_i, part_f)
    return CurveTable(degrees, kinds, knot_start, knots[: knot_start[-1]], cp_start, cp[: cp_start[-1]], max_error,
                      part_start, part_i, part_f)


def _degree(tolerance: float) -> int:
    """Of fitted pieces."""
    if tolerance < FINEST_TOLERANCE:
        return 9
    return 7 if tolerance < FINE_TOLERANCE else 5


def build_axis(
    domain: Domain, table: SiteTable, skeleton: Skeleton, graph: AxisGraph, tolerance: float, step: float | None
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

    Returns
    -------
    MedialAxis
    """
    curves = build_curves(table, skeleton, graph, tolerance * domain.size * table.scale)
    return MedialAxis(domain, table, skeleton, graph, curves, tolerance, step)
