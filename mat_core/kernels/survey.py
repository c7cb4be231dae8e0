"""From the numbers of a document to flat arrays, and what the rules of a valid domain ask of all its edges at once.

The arrays are those of `mat_core.model.loop.BoundaryArrays`. Nothing is judged here: what is measured proves most rules kept in
a few comparisons (`mat_core.model.survey`).
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints
from mat_core.kernels.jit import inner, jit

# What `survey` finds: largest coordinate in magnitude, infinite where one is not finite; the box of all control points; the least
# extent of an edge, the least and largest weight (-1 where one is not a number), the widest gap between edges; whether all knots
# are sound, 1 or 0.
REACH, XMIN, YMIN, XMAX, YMAX, LEAST_EXTENT, LIGHTEST, HEAVIEST, WIDEST_GAP, SOUND_KNOTS, FACTS = range(11)


@jit
def read_edges(
    table: Ints,
    numbers: Floats,
    half_range: float,
    degree: Ints,
    cp_start: Ints,
    cp: Floats,
    knot_start: Ints,
    knots: Floats,
    loop_start: Ints,
    edge_of: Ints,
    extent: Floats,
    gap: Floats,
    facts: Floats,
) -> None:
    """Fill the arrays of E edges in L loops, and what there is to know of them (`lay_out`, `survey`)."""
    lay_out(table, numbers, degree, cp_start, cp, knot_start, knots, loop_start, edge_of)
    survey(degree, cp_start, cp, knot_start, knots, loop_start, half_range, extent, gap, facts)


@inner
def lay_out(
    table: Ints,
    numbers: Floats,
    degree: Ints,
    cp_start: Ints,
    cp: Floats,
    knot_start: Ints,
    knots: Floats,
    loop_start: Ints,
    edge_of: Ints,
) -> None:
    """Fill the arrays, and `edge_of` (E,) with each edge's place in its loop.

    `table`: degrees (E,), numbers of control points (E,), of knots given (E,) and weights given (E,), edges of each loop (L,).
    `numbers`: x, y of all points, then all knots given, then all weights given. An edge without knots is a Bezier, without
    weights all of them are 1.
    """
    edges = degree.shape[0]
    rows = cp.shape[0]
    cp_start[0] = 0
    knot_start[0] = 0
    loop_start[0] = 0
    for loop in range(loop_start.shape[0] - 1):
        own = table[4 * edges + loop]
        for k in range(own):
            edge_of[loop_start[loop] + k] = k
        loop_start[loop + 1] = loop_start[loop] + own
    for i in range(rows):
        cp[i, 0] = numbers[2 * i]
        cp[i, 1] = numbers[2 * i + 1]
        cp[i, 2] = 1.0
    knot = 2 * rows
    weight = knot
    for e in range(edges):
        weight += table[2 * edges + e]
    for e in range(edges):
        p = table[e]
        n = table[edges + e]
        degree[e] = p
        cp_start[e + 1] = cp_start[e] + n
        knot_start[e + 1] = knot_start[e] + n + p + 1
        for k in range(n + p + 1):
            knots[knot_start[e] + k] = numbers[knot + k] if table[2 * edges + e] > 0 else 0.0 if k <= p else 1.0
        knot += table[2 * edges + e]
        for k in range(table[3 * edges + e]):
            cp[cp_start[e] + k, 2] = numbers[weight + k]
        weight += table[3 * edges + e]


@inner
def knots_are_sound(knots: Floats, first: int, last: int, p: int, half_range: float) -> bool:
    """Whether knots[first : last + 1] are finite, in order, clamped over a range that is a float, inner ones at most p times."""
    start = knots[first]
    end = knots[last]
    for k in range(first, last):
        if not knots[k] <= knots[k + 1]:
            return False
    if not (-math.inf < start < end < math.inf and 0.5 * end - 0.5 * start <= half_range):
        return False
    if knots[first + p] != start or knots[first + p + 1] == start or knots[last - p] != end or knots[last - p - 1] == end:
        return False
    # Between the knots at both ends, no p + 1 in a row are the same.
    for k in range(first + 2 * p + 1, last - p):
        if knots[k] == knots[k - p]:
            return False
    return True


@inner
def larger(a: float, b: float) -> float:
    """The larger of two numbers; none if one of them is none."""
    return a if a > b or a != a else b


@inner
def apart(cp: Floats, i: int, j: int) -> float:
    """Distance of two control points along x or y."""
    return larger(abs(cp[i, 0] - cp[j, 0]), abs(cp[i, 1] - cp[j, 1]))


@inner
def survey(
    degree: Ints,
    cp_start: Ints,
    cp: Floats,
    knot_start: Ints,
    knots: Floats,
    loop_start: Ints,
    half_range: float,
    extent: Floats,
    gap: Floats,
    facts: Floats,
) -> None:
    """Fill `facts` (FACTS,) and for each edge (E,): how far its control points get from the first one, by how much its end misses
    the start of the next edge of the loop, each along x or y; no number where points are none.
    """
    lightest = least = math.inf
    heaviest = -math.inf
    reach = widest = 0.0
    for axis in range(2):
        low = math.inf
        high = -math.inf
        for i in range(cp.shape[0]):
            low = min(low, cp[i, axis])
            high = max(high, cp[i, axis])
            if not abs(cp[i, axis]) <= reach:
                reach = abs(cp[i, axis]) if cp[i, axis] == cp[i, axis] else math.inf
        facts[XMIN + axis] = low
        facts[XMAX + axis] = high
    for i in range(cp.shape[0]):
        if not cp[i, 2] >= lightest:
            lightest = cp[i, 2] if cp[i, 2] < lightest else -1.0
        heaviest = max(heaviest, cp[i, 2])
    sound = 1.0
    for loop in range(loop_start.shape[0] - 1):
        for e in range(loop_start[loop], loop_start[loop + 1]):
            following = e + 1 if e + 1 < loop_start[loop + 1] else loop_start[loop]
            end = cp_start[e + 1] - 1
            gap[e] = apart(cp, end, cp_start[following])
            if not gap[e] <= widest:
                widest = gap[e] if gap[e] == gap[e] else math.inf
            extent[e] = 0.0
            for i in range(cp_start[e] + 1, end + 1):
                extent[e] = larger(extent[e], apart(cp, i, cp_start[e]))
            least = min(least, extent[e])
            if not knots_are_sound(knots, knot_start[e], knot_start[e + 1] - 1, degree[e], half_range):
                sound = 0.0
    facts[REACH] = reach
    facts[LEAST_EXTENT] = least
    facts[LIGHTEST] = lightest
    facts[HEAVIEST] = heaviest
    facts[WIDEST_GAP] = widest
    facts[SOUND_KNOTS] = sound
