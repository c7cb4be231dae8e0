"""The rules one rational B-spline must keep, checked for all edges in one pass.

A rule's answer is an index: -1 when kept, else where it is broken first (a control point, a weight or a knot of that
edge).
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints
from mat_core.kernels.jit import jit

# Columns of `broken`.
POINT_NOT_FINITE = 0
POINT_TOO_LARGE = 1
WEIGHT_NOT_FINITE = 2
WEIGHT_NOT_POSITIVE = 3
WEIGHTS_TOO_WIDE = 4
KNOT_NOT_FINITE = 5
KNOTS_DECREASE = 6
NOT_CLAMPED_START = 7
NOT_CLAMPED_END = 8
RANGE_EMPTY = 9
KNOT_TOO_MANY = 10
CURVE_JUMPS = 11
ZERO_LENGTH = 12
RULES = 13

HALF_RANGE = 8e307  # half of a parameter range that still is a float


@jit
def check_points(cp: Floats, first: int, last: int, largest: float, rounding: float, broken: Ints, e: int) -> None:
    """Rules on control points and weights, rows first .. last - 1 of `cp`, into row `e` of `broken`."""
    single = True
    for i in range(last - first - 1, -1, -1):
        x = cp[first + i, 0]
        y = cp[first + i, 1]
        if not (math.isfinite(x) and math.isfinite(y)):
            broken[e, POINT_NOT_FINITE] = i
        elif abs(x) > largest or abs(y) > largest:
            broken[e, POINT_TOO_LARGE] = i
        if abs(x - cp[first, 0]) > rounding or abs(y - cp[first, 1]) > rounding:
            single = False
    if single and broken[e, POINT_NOT_FINITE] < 0:
        broken[e, ZERO_LENGTH] = 0


@jit
def check_weights(cp: Floats, first: int, last: int, widest: float, broken: Ints, e: int) -> None:
    """Weights finite, positive, and the largest at most `widest` times the smallest."""
    least = math.inf
    most = 0.0
    for i in range(last - first - 1, -1, -1):
        w = cp[first + i, 2]
        if not math.isfinite(w):
            broken[e, WEIGHT_NOT_FINITE] = i
        elif w <= 0.0:
            broken[e, WEIGHT_NOT_POSITIVE] = i
        else:
            least = w if w < least else least
            most = w if w > most else most
    if most > widest * least:
        broken[e, WEIGHTS_TOO_WIDE] = 0


@jit
def check_knots(
    knots: Floats, k0: int, nk: int, cp: Floats, c0: int, degree: int, join: float, broken: Ints, e: int
) -> None:
    """Knots finite, in order, clamped, over a range; inner ones at most `degree` times unless the curve stays whole."""
    for i in range(nk - 1, -1, -1):
        if not math.isfinite(knots[k0 + i]):
            broken[e, KNOT_NOT_FINITE] = i
    if broken[e, KNOT_NOT_FINITE] >= 0:
        return
    for i in range(nk - 1, 0, -1):
        if knots[k0 + i] < knots[k0 + i - 1]:
            broken[e, KNOTS_DECREASE] = i
    if broken[e, KNOTS_DECREASE] >= 0:
        return
    start = knots[k0]
    end = knots[k0 + nk - 1]
    if not end > start or 0.5 * end - 0.5 * start > HALF_RANGE:
        broken[e, RANGE_EMPTY] = 0
        return
    if knots[k0 + degree] != start or knots[k0 + degree + 1] == start:
        broken[e, NOT_CLAMPED_START] = degree
    if knots[k0 + nk - 1 - degree] != end or knots[k0 + nk - 2 - degree] == end:
        broken[e, NOT_CLAMPED_END] = nk - 1 - degree
    if broken[e, NOT_CLAMPED_START] >= 0 or broken[e, NOT_CLAMPED_END] >= 0:
        return
    run = 1
    for i in range(degree + 2, nk - degree - 1):
        run = run + 1 if knots[k0 + i] == knots[k0 + i - 1] else 1
        if run > degree + 1 and broken[e, KNOT_TOO_MANY] < 0:
            broken[e, KNOT_TOO_MANY] = i
        if run == degree + 1:
            # Nothing but its two neighbours in the control polygon holds the curve together here.
            a = c0 + i - degree - 1
            jumps = abs(cp[a + 1, 0] - cp[a, 0]) > join or abs(cp[a + 1, 1] - cp[a, 1]) > join
            if jumps and broken[e, CURVE_JUMPS] < 0:
                broken[e, CURVE_JUMPS] = i


@jit
def check_splines(
    degree: Ints,
    cp_start: Ints,
    cp: Floats,
    knot_start: Ints,
    knots: Floats,
    largest: float,
    widest: float,
    rounding: float,
    join: float,
    broken: Ints,
) -> int:
    """Fill `broken` (edges, RULES); returns the number of edges with a broken rule. Assumes counts of knots fit."""
    bad = 0
    for e in range(degree.shape[0]):
        for rule in range(RULES):
            broken[e, rule] = -1
        check_points(cp, cp_start[e], cp_start[e + 1], largest, rounding, broken, e)
        check_weights(cp, cp_start[e], cp_start[e + 1], widest, broken, e)
        nk = knot_start[e + 1] - knot_start[e]
        check_knots(knots, knot_start[e], nk, cp, cp_start[e], degree[e], join, broken, e)
        for rule in range(RULES):
            if broken[e, rule] >= 0:
                bad += 1
                break
    return bad
