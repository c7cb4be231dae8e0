"""The fitted curves: do they run along the axis, through its discs, within the error they state?

A curve states a bound e of |c' - c| + |r' - r| between its discs (c', r') and true axis discs (c, r). The distance of c'
from either side then differs from r' by at most e; that much is granted, no more.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.sites import SiteTable
from mat_core.certificate.inputs import Curves, Discs, Floats, Ints, Network
from mat_core.certificate.report import Report
from mat_core.kernels.judge import distances
from mat_core.kernels.rows import spline_values

SAMPLES = np.array(
    (0.057, 0.281, 0.473, 0.726, 0.894)
)  # of a piece; at places of no symmetry, so not at those of a fit


class Sampled(NamedTuple):
    """Discs of the curves (n, 3) with their segments and strips."""

    disc: Floats
    segment: Ints
    strip: Ints


def check_shape(curves: Curves, graph: Network, report: Report) -> bool:
    """Knots are clamped and rise from 0 to 1, weights are positive; returns whether the curves can be evaluated."""
    c = curves
    runs = len(c.degree)
    if not runs:
        for name in ("curves_tolerance", "curves_continuous"):
            report.worst(name, np.empty(0), np.empty((0, 2)))
        return False
    first = c.cp_start[:-1]
    place = c.cp[np.minimum(first, len(c.cp) - 1)]
    report.worst("curves_tolerance", c.max_error, place)
    k0 = c.knot_start[:-1]
    k1 = c.knot_start[1:]
    control = np.diff(c.cp_start)
    sound = (c.degree >= 1) & (control > c.degree) & (k1 - k0 == control + c.degree + 1) & (c.max_error >= 0.0)
    if sound.all():
        p = c.degree
        sound &= (
            (c.knots[k0] == 0.0) & (c.knots[k0 + p] == 0.0) & (c.knots[k1 - p - 1] == 1.0) & (c.knots[k1 - 1] == 1.0)
        )
        falls = np.zeros(len(c.knots), dtype=np.int64)
        falls[1:] = c.knots[1:] < c.knots[:-1]
        falls[k0] = 0
        sound &= (np.add.reduceat(falls, k0) == 0) & (np.minimum.reduceat(c.cp[:, 3], first) > 0.0)
        sound &= _parts_follow(c)
    report.worst("curves_continuous", np.where(sound, 0.0, np.inf), place)
    if not sound.all():
        return False
    _check_jumps(c, report)
    closed = np.flatnonzero(graph.start_node < 0)
    gap = c.cp[c.cp_start[closed + 1] - 1, :3] - c.cp[first[closed], :3]
    report.worst("curves_continuous", np.sqrt((gap * gap).sum(axis=1)), place[closed])
    return True


def _parts_follow(c: Curves) -> NDArray[np.bool_]:
    """Whether the pieces of each segment cover [0, 1] one after the other."""
    begin = c.part_f[:, 0]
    end = c.part_f[:, 1]
    first = c.part_start[:-1]
    last = c.part_start[1:] - 1
    if not (last >= first).all():
        return last >= first
    wrong = np.zeros(len(begin), dtype=np.int64)
    wrong[1:] = begin[1:] != end[:-1]
    wrong[first] = begin[first] != 0.0
    wrong[last] += end[last] != 1.0
    wrong += ~(end > begin)
    return np.add.reduceat(wrong, first) == 0


def _check_jumps(c: Curves, report: Report) -> None:
    """An inner knot of multiplicity degree + 1 parts a curve between two control points."""
    for p in np.flatnonzero(np.bincount(c.degree)).tolist():
        row = np.flatnonzero(c.knots[p:] == c.knots[:-p])
        segment = np.searchsorted(c.knot_start, row, side="right") - 1
        inner = (
            (c.degree[segment] == p)
            & (c.knots[row] > 0.0)
            & (c.knots[row] < 1.0)
            & (row + p < c.knot_start[segment + 1])
        )
        after = (c.cp_start[segment] + row - c.knot_start[segment])[inner]
        gap = c.cp[after, :3] - c.cp[after - 1, :3]
        report.worst("curves_continuous", np.sqrt((gap * gap).sum(axis=1)), c.cp[after])


def _values(c: Curves, segment: Ints, t: Floats) -> Floats:
    """Points x, y, r."""
    out = np.empty((len(t), 3))
    work = np.empty((int(c.degree.max()) + 1, 4))
    spline_values(c.degree, c.knot_start, c.knots, c.cp_start, c.cp, 3, segment, t, work, out)
    return out


def check_ends(skeleton: Discs, graph: Network, curves: Curves, report: Report) -> None:
    """Curves begin and end at the discs of their nodes and pass the discs between their strips, taken in order."""
    disc, c = skeleton.disc, curves
    segment = c.part_i[:, 0]
    strip = c.part_i[:, 1]
    new = np.ones(len(strip), dtype=np.bool_)
    new[1:] = (strip[1:] != strip[:-1]) | (segment[1:] != segment[:-1])
    entered = np.flatnonzero(new)
    runs = np.repeat(np.arange(len(c.degree)), np.diff(graph.run_start))
    of_parts = np.repeat(np.arange(len(c.degree)), np.diff(c.part_start))
    if len(entered) != len(runs) or (strip[entered] != graph.run_strip).any() or (of_parts[entered] != runs).any():
        report.worst("curves_ends", np.array((np.inf,)), c.cp)
        return
    ends = skeleton.strip_i[graph.run_strip, 2:]
    forward = graph.run_forward
    begin = np.where(forward, ends[:, 0], ends[:, 1])
    last = graph.run_start[1:] - 1
    stop = np.where(forward[last], ends[last, 1], ends[last, 0])
    which = np.concatenate((begin, stop))
    of = np.concatenate((runs, np.arange(len(last))))
    t = np.concatenate((c.part_f[entered, 0], np.ones(len(last))))
    off = _values(c, of, t) - disc[which]
    report.worst("curves_ends", np.sqrt((off * off).sum(axis=1)) - c.max_error[of], disc[which])


def sample(curves: Curves, pieces: slice) -> Sampled:
    """Discs of the curves inside some of the pieces."""
    c = curves
    n = len(SAMPLES)
    f = c.part_f[pieces]
    t = f[:, :1] + SAMPLES * (f[:, 1:2] - f[:, :1])
    of_pieces = np.searchsorted(c.part_start, np.arange(pieces.start, pieces.stop), side="right") - 1
    segment = np.repeat(of_pieces, n)
    return Sampled(_values(c, segment, t.ravel()), segment, np.repeat(c.part_i[pieces, 1], n))


def check_curves(
    t: SiteTable, skeleton: Discs, curves: Curves, sampled: Sampled, depth: Floats, strip_slack: Floats, report: Report
) -> None:
    """Samples of the curves touch either side of their strip, and the boundary stays out of them."""
    granted = curves.max_error[sampled.segment] + strip_slack[sampled.strip]
    s = skeleton.strip_s[sampled.strip]
    distance = np.empty(len(granted))
    for side in range(2):
        interval = np.empty((len(granted), 3))
        interval[:, 0] = s[:, 3 * side]
        interval[:, 1] = s[:, 1 + side]
        interval[:, 2] = 0.5 * (interval[:, 0] + interval[:, 1])
        distances(t.si, t.sf, t.cp, skeleton.strip_i[sampled.strip, side], interval, sampled.disc, distance)
        report.worst("curves_on_axis", distance - granted, sampled.disc)
    report.worst("curves_empty", depth - granted, sampled.disc)
