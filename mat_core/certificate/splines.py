"""The fitted curves: do they run along the axis, through its discs, within the error they state?

A curve's error is stated in (x, y, r) together. If the disc (c', r') is off a true axis disc (c, r) by e in that sense, then the
distance of c' from either side differs from r' by at most |c' - c| + |r' - r| <= sqrt(2) e; that much is granted, no more.
"""

from __future__ import annotations

import math

from mat_core.certificate.report import (
    CURVES_CONTINUOUS, CURVES_EMPTY, CURVES_ENDS, CURVES_ON_AXIS, CURVES_TOLERANCE, note,
)
from mat_core.kernels.jit import jit

SAMPLES = 3
GRANTED = math.sqrt(2.0)


@jit
def _fraction(k):
    """Where pieces are sampled: at places of no symmetry, so not at those of a fit."""
    return 0.131 if k == 0 else (0.473 if k == 1 else 0.826)


@jit
def rational_point(degree, knots, k0, k1, cp, c0, axes, t, work):
    """Point of a rational B-spline to work[0, :axes], by de Boor's triangle in homogeneous coordinates.

    Knots k0 .. k1 - 1; rows c0 .. of `cp` hold `axes` coordinates (not multiplied by it) and the weight.
    """
    span = k0 + degree
    last = k1 - degree - 2
    while last > span:
        middle = (span + last + 1) // 2
        if knots[middle] <= t:
            span = middle
        else:
            last = middle - 1
    for i in range(degree + 1):
        row = c0 + span - k0 - degree + i
        w = cp[row, axes]
        for c in range(axes):
            work[i, c] = w * cp[row, c]
        work[i, axes] = w
    for level in range(1, degree + 1):
        for i in range(degree + 1 - level):
            left = knots[span - degree + level + i]
            share = (t - left) / (knots[span + 1 + i] - left)
            for c in range(axes + 1):
                work[i, c] += share * (work[i + 1, c] - work[i, c])
    for c in range(axes):
        work[0, c] /= work[0, axes]


@jit
def _apart(cp, row, disc, d):
    """Distance of a control point from a disc, in (x, y, r)."""
    dx = cp[row, 0] - disc[d, 0]
    dy = cp[row, 1] - disc[d, 1]
    dr = cp[row, 2] - disc[d, 2]
    return math.sqrt(dx * dx + dy * dy + dr * dr)


@jit
def check_shape(degree, knot_start, knots, cp_start, cp, max_error, part_start, part_f, start_node, report):
    """Knots are clamped, rise from 0 to 1 and break nothing; weights are positive; pieces follow each other; errors stated."""
    for g in range(degree.shape[0]):
        p = degree[g]
        k0 = knot_start[g]
        k1 = knot_start[g + 1]
        c0 = cp_start[g]
        c1 = cp_start[g + 1]
        x = cp[c0, 0]
        y = cp[c0, 1]
        note(report, CURVES_TOLERANCE, max_error[g], x, y)
        sound = c1 - c0 > p and k1 - k0 == c1 - c0 + p + 1 and knots[k0] == 0.0 and knots[k1 - 1] == 1.0 and max_error[g] >= 0.0
        if sound:
            sound = knots[k0 + p] == 0.0 and knots[k1 - p - 1] == 1.0
            for k in range(k0 + 1, k1):
                sound = sound and knots[k] >= knots[k - 1]
            for c in range(c0, c1):
                sound = sound and cp[c, 3] > 0.0
        reached = 0.0
        for m in range(part_start[g], part_start[g + 1]):
            sound = sound and part_f[m, 0] == reached and part_f[m, 1] > reached
            reached = part_f[m, 1]
        if not sound or reached != 1.0:
            note(report, CURVES_CONTINUOUS, math.inf, x, y)
            continue
        # an inner knot of multiplicity degree + 1 parts the curve between two control points
        for k in range(k0 + p + 1, k1 - 2 * p - 1):
            if knots[k] == knots[k + p]:
                a = c0 + k - k0 - 1
                gap = math.hypot(cp[a + 1, 0] - cp[a, 0], cp[a + 1, 1] - cp[a, 1]) + abs(cp[a + 1, 2] - cp[a, 2])
                note(report, CURVES_CONTINUOUS, gap, cp[a, 0], cp[a, 1])
        if start_node[g] < 0:
            gap = math.hypot(cp[c1 - 1, 0] - x, cp[c1 - 1, 1] - y) + abs(cp[c1 - 1, 2] - cp[c0, 2])
            note(report, CURVES_CONTINUOUS, gap, x, y)


@jit
def check_ends(disc, strip_i, node_disc, start_node, end_node, run_start, run_strip, run_forward, degree, knot_start, knots,
               control_start, control, max_error, part_start, part_i, part_f, point, report):
    """Curves begin and end at the discs of their nodes, and pass the discs between their strips, which they take in order."""
    for g in range(degree.shape[0]):
        c0 = control_start[g]
        if start_node[g] >= 0:
            d = node_disc[start_node[g]]
            note(report, CURVES_ENDS, _apart(control, c0, disc, d) - max_error[g], disc[d, 0], disc[d, 1])
            d = node_disc[end_node[g]]
            note(report, CURVES_ENDS, _apart(control, control_start[g + 1] - 1, disc, d) - max_error[g], disc[d, 0], disc[d, 1])
        step = run_start[g] - 1
        before = -1
        for m in range(part_start[g], part_start[g + 1]):
            strip = part_i[m, 1]
            if strip != before:
                step += 1
                if step >= run_start[g + 1] or run_strip[step] != strip:
                    note(report, CURVES_ENDS, math.inf, control[c0, 0], control[c0, 1])
                    break
                if before >= 0:
                    d = strip_i[strip, 2 if run_forward[step] else 3]
                    rational_point(degree[g], knots, knot_start[g], knot_start[g + 1], control, c0, 3, part_f[m, 0], point)
                    note(report, CURVES_ENDS, _apart(point, 0, disc, d) - max_error[g], disc[d, 0], disc[d, 1])
            before = strip
        if step != run_start[g + 1] - 1:
            note(report, CURVES_ENDS, math.inf, control[c0, 0], control[c0, 1])


@jit
def list_samples(strip_i, strip_s, degree, knot_start, knots, control_start, control, part_start, part_i, part_f, point, first,
                 probe, side_site, side_interval, side_disc):
    """Discs of the curves inside every piece: to `probe` from row `first` on, and twice to side_disc, for either side."""
    n = 0
    for g in range(degree.shape[0]):
        for m in range(part_start[g], part_start[g + 1]):
            strip = part_i[m, 1]
            for k in range(SAMPLES):
                t = part_f[m, 0] + _fraction(k) * (part_f[m, 1] - part_f[m, 0])
                rational_point(degree[g], knots, knot_start[g], knot_start[g + 1], control, control_start[g], 3, t, point)
                for side in range(2):
                    row = 2 * n + side
                    side_site[row] = strip_i[strip, side]
                    side_interval[row, 0] = strip_s[strip, 3 * side]
                    side_interval[row, 1] = strip_s[strip, 1 + side]
                    side_interval[row, 2] = 0.5 * (side_interval[row, 0] + side_interval[row, 1])
                    for c in range(3):
                        side_disc[row, c] = probe[first + n, c] = point[0, c]
                n += 1


@jit
def check_curves(degree, max_error, part_start, part_i, strip_slack, first, probe, depth, distance, report):
    """Samples of the curves touch either side of their strip, and the boundary stays out of them."""
    n = 0
    for g in range(degree.shape[0]):
        for m in range(part_start[g], part_start[g + 1]):
            granted = GRANTED * max_error[g] + strip_slack[part_i[m, 1]]
            for _ in range(SAMPLES):
                x = probe[first + n, 0]
                y = probe[first + n, 1]
                note(report, CURVES_ON_AXIS, distance[2 * n] - granted, x, y)
                note(report, CURVES_ON_AXIS, distance[2 * n + 1] - granted, x, y)
                note(report, CURVES_EMPTY, depth[first + n] - granted, x, y)
                n += 1
