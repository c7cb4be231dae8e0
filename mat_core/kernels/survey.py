"""From the numbers of a document to flat arrays, and what the rules of a valid domain ask of all its edges at once.

The arrays are those of `mat_core.model.loop.BoundaryArrays`. Nothing is judged here: what is measured proves most rules kept in
a few comparisons (`mat_core.model.survey`); the others are looked at edge by edge.
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
    """Fill the arrays of E edges in L loops.

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


@jit
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
    x0 = y0 = lightest = least = math.inf
    x1 = y1 = heaviest = -math.inf
    reach = widest = 0.0
    for i in range(cp.shape[0]):
        x = cp[i, 0]
        y = cp[i, 1]
        w = cp[i, 2]
        far = larger(abs(x), abs(y))
        if not far <= reach:
            reach = far if far == far else math.inf
        if not w >= lightest:
            lightest = w if w < lightest else -1.0
        heaviest = max(heaviest, w)
        x0 = min(x0, x)
        y0 = min(y0, y)
        x1 = max(x1, x)
        y1 = max(y1, y)
    sound = 1.0
    for loop in range(loop_start.shape[0] - 1):
        for e in range(loop_start[loop], loop_start[loop + 1]):
            following = e + 1 if e + 1 < loop_start[loop + 1] else loop_start[loop]
            end = cp_start[e + 1] - 1
            begin = cp_start[following]
            gap[e] = larger(abs(cp[end, 0] - cp[begin, 0]), abs(cp[end, 1] - cp[begin, 1]))
            if not gap[e] <= widest:
                widest = gap[e] if gap[e] == gap[e] else math.inf
            first = cp_start[e]
            extent[e] = 0.0
            for i in range(first + 1, end + 1):
                extent[e] = larger(extent[e], larger(abs(cp[i, 0] - cp[first, 0]), abs(cp[i, 1] - cp[first, 1])))
            least = min(least, extent[e])
            if not knots_are_sound(knots, knot_start[e], knot_start[e + 1] - 1, degree[e], half_range):
                sound = 0.0
    facts[REACH] = reach
    facts[XMIN] = x0
    facts[YMIN] = y0
    facts[XMAX] = x1
    facts[YMAX] = y1
    facts[LEAST_EXTENT] = least
    facts[LIGHTEST] = lightest
    facts[HEAVIEST] = heaviest
    facts[WIDEST_GAP] = widest
    facts[SOUND_KNOTS] = sound
