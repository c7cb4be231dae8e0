"""The fitted curves: can they be evaluated, are they continuous, do they pass the discs they should?

A curve states a bound e of |c' - c| + |r' - r| between its discs (c', r') and true axis discs (c, r). The distance of c'
from either side then differs from r' by at most e; that much is granted, no more.
"""

from __future__ import annotations

import math

from mat_core.certificate.report import (
    CURVES_CONTINUOUS,
    CURVES_ENDS,
    CURVES_TOLERANCE,
    made,
    worst,
)
from mat_core.kernels.jit import inner
from mat_core.kernels.judge_spline import spline_value


@inner
def check_shape(c, g, figures):
    """Knots are clamped and rise from 0 to 1, weights are positive; returns whether the curves can be evaluated."""
    made(figures, CURVES_TOLERANCE)
    made(figures, CURVES_CONTINUOUS)
    runs = c.degree.shape[0]
    all_sound = runs > 0
    for run in range(runs):
        row = c.cp_start[run]
        x = c.cp[row, 0] if row < c.cp.shape[0] else math.nan
        y = c.cp[row, 1] if row < c.cp.shape[0] else math.nan
        worst(figures, CURVES_TOLERANCE, c.max_error[run], x, y)
        sound = _is_sound(c, run)
        worst(figures, CURVES_CONTINUOUS, 0.0 if sound else math.inf, x, y)
        all_sound = all_sound and sound
    for run in range(runs if all_sound else 0):
        _check_jumps(c, run, figures)
        if g.start_node[run] < 0:
            _check_gap(c, c.cp_start[run], c.cp_start[run + 1] - 1, figures)
    return all_sound


@inner
def _is_sound(c, run):
    """Whether a curve can be evaluated anywhere in [0, 1], and its pieces cover that one after the other."""
    p = c.degree[run]
    first = c.knot_start[run]
    last = c.knot_start[run + 1] - 1
    control = c.cp_start[run + 1] - c.cp_start[run]
    if not (p >= 1 and control > p and last + 1 - first == control + p + 1 and c.max_error[run] >= 0.0):
        return False
    if c.knots[first] != 0.0 or c.knots[first + p] != 0.0 or c.knots[last - p] != 1.0 or c.knots[last] != 1.0:
        return False
    for knot in range(first, last):
        if not c.knots[knot + 1] >= c.knots[knot]:
            return False
    for row in range(c.cp_start[run], c.cp_start[run + 1]):
        if not c.cp[row, 3] > 0.0:
            return False
    reached = 0.0
    for part in range(c.part_start[run], c.part_start[run + 1]):
        if c.part_f[part, 0] != reached or not c.part_f[part, 1] > reached:
            return False
        reached = c.part_f[part, 1]
    return reached == 1.0


@inner
def _check_jumps(c, run, figures):
    """An inner knot of multiplicity degree + 1 parts a curve between two control points."""
    p = c.degree[run]
    for knot in range(c.knot_start[run], c.knot_start[run + 1] - p):
        if c.knots[knot] == c.knots[knot + p] and 0.0 < c.knots[knot] < 1.0:
            row = c.cp_start[run] + knot - c.knot_start[run]
            _check_gap(c, row, row - 1, figures)


@inner
def _check_gap(c, a, b, figures):
    """Two control points are one."""
    dx = c.cp[a, 0] - c.cp[b, 0]
    dy = c.cp[a, 1] - c.cp[b, 1]
    dr = c.cp[a, 2] - c.cp[b, 2]
    worst(figures, CURVES_CONTINUOUS, math.sqrt(dx * dx + dy * dy + dr * dr), c.cp[a, 0], c.cp[a, 1])


@inner
def _check_end(c, run, t, disc, d, work, figures):
    """The curve passes disc d at t."""
    spline_value(c.degree, c.knot_start, c.knots, c.cp_start, c.cp, 3, run, t, work)
    dx = work[0, 0] - disc[d, 0]
    dy = work[0, 1] - disc[d, 1]
    dr = work[0, 2] - disc[d, 2]
    worst(figures, CURVES_ENDS, math.sqrt(dx * dx + dy * dy + dr * dr) - c.max_error[run], disc[d, 0], disc[d, 1])


@inner
def check_ends(k, g, c, work, figures):
    """Curves begin and end at the discs of their nodes and pass the discs between their strips, taken in order."""
    for run in range(c.degree.shape[0]):
        m = g.run_start[run] - 1
        last = g.run_start[run + 1] - 1
        strip = -1
        for part in range(c.part_start[run], c.part_start[run + 1]):
            if c.part_i[part, 1] == strip:
                continue
            strip = c.part_i[part, 1]
            m += 1
            if m > last or g.run_strip[m] != strip:
                break
            _check_end(c, run, c.part_f[part, 0], k.disc, k.strip_i[strip, 2 if g.run_forward[m] else 3], work, figures)
        if m != last or g.run_strip[last] != strip:
            worst(figures, CURVES_ENDS, math.inf, c.cp[c.cp_start[run], 0], c.cp[c.cp_start[run], 1])
            continue
        _check_end(c, run, 1.0, k.disc, k.strip_i[strip, 3 if g.run_forward[last] else 2], work, figures)
