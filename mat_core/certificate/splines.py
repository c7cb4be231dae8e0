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
from mat_core.kernels.judge import foot, reach_inside

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
def check_shape(degree, knot_start, knots, cp_start, cp, max_error, part_start, part_t, start_node, report):
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
            sound = sound and part_t[m, 0] == reached and part_t[m, 1] > reached
            reached = part_t[m, 1]
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
def check_curves(si, sf, cp, box, stack, work, binomial, disc, strip_i, strip_s, strip_slack, node_disc, start_node, end_node,
                 run_start, run_strip, run_forward, degree, knot_start, knots, control_start, control, max_error, part_start,
                 part_strip, part_t, point, report):
    """Samples of every piece against its strip's two sides and the whole boundary, and the discs between pieces."""
    for g in range(degree.shape[0]):
        granted = GRANTED * max_error[g]
        c0 = control_start[g]
        if start_node[g] >= 0:
            d = node_disc[start_node[g]]
            note(report, CURVES_ENDS, _apart(control, c0, disc, d) - max_error[g], disc[d, 0], disc[d, 1])
            d = node_disc[end_node[g]]
            note(report, CURVES_ENDS, _apart(control, control_start[g + 1] - 1, disc, d) - max_error[g], disc[d, 0], disc[d, 1])
        step = run_start[g]
        for m in range(part_start[g], part_start[g + 1]):
            strip = part_strip[m]
            if m > part_start[g] and strip != part_strip[m - 1]:
                # the disc between two strips of the run
                step += 1
                before = part_strip[m - 1]
                d = strip_i[before, 3 if run_forward[step - 1] else 2]
                rational_point(degree[g], knots, knot_start[g], knot_start[g + 1], control, c0, 3, part_t[m, 0], point)
                note(report, CURVES_ENDS, _apart(point, 0, disc, d) - max_error[g], disc[d, 0], disc[d, 1])
            if step >= run_start[g + 1] or run_strip[step] != strip:
                note(report, CURVES_ON_AXIS, math.inf, control[c0, 0], control[c0, 1])
                break
            for k in range(SAMPLES):
                f = _fraction(k)
                t = part_t[m, 0] + f * (part_t[m, 1] - part_t[m, 0])
                rational_point(degree[g], knots, knot_start[g], knot_start[g + 1], control, c0, 3, t, point)
                x = point[0, 0]
                y = point[0, 1]
                r = point[0, 2]
                along = f if run_forward[step] else 1.0 - f
                guess = strip_s[strip, 0] + along * (strip_s[strip, 1] - strip_s[strip, 0])
                right = foot(si, sf, cp, strip_i[strip, 0], strip_s[strip, 0], strip_s[strip, 1], x, y, guess)[0]
                guess = strip_s[strip, 2] + along * (strip_s[strip, 3] - strip_s[strip, 2])
                left = foot(si, sf, cp, strip_i[strip, 1], strip_s[strip, 3], strip_s[strip, 2], x, y, guess)[0]
                slack = granted + strip_slack[strip]
                off = abs(right - r)
                if not off >= abs(left - r):
                    off = abs(left - r)
                note(report, CURVES_ON_AXIS, off - slack, x, y)
                gap = reach_inside(si, sf, cp, box, stack, work, binomial, x, y, r)[0]
                note(report, CURVES_EMPTY, -gap - slack, x, y)
        if step != run_start[g + 1] - 1:
            note(report, CURVES_ON_AXIS, math.inf, control[c0, 0], control[c0, 1])
