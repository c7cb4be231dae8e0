"""Pieces in a row: the columns of their tables, where each starts, and how they meet and go on where the boundary is smooth."""

from __future__ import annotations

import math

from mat_core.boundary.bends import TRIM
from mat_core.kernels.bezier import add_closely
from mat_core.kernels.curve import bezier_frame
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import SPIRAL

# columns of the tables of pieces
P_KIND, P_DEG, P_CP0, P_RATIONAL, P_EDGE, P_SPAN, P_GOES_ON = range(7)
P_UA, P_UB, P_SKEW, P_X, P_Y, P_CURVATURE, P_CENTRE_X, P_CENTRE_Y, P_FRAME = range(9)
P_X_LOW, P_Y_LOW = 14, 15
# at an end of a Bezier a bend was cut off with its peak, or up to that; one beside it gave it its curvature; none of these
CUT_WITH_PEAK, CUT_OFF, EXTREME, PLAIN = range(4)
# P_SKEW: as `layout.SKEW`; P_X, P_Y: start, P_X_LOW, P_Y_LOW: its further digits; P_FRAME: tx, ty, k at both ends
PI_WIDTH = 7
PF_WIDTH = 16

AT_PEAK = 0.99  # of 1 / TRIM, the curvature that a convex bend is cut off at elsewhere
SWAY = 1e-4  # of curvature: what an end of a piece is moved by, over its squared length; by more it would sway, and is sheared
SAME_WAY = 0.995  # cosine of the angle at a knot of a curve that does not stand still there: rounding turns it by less


@inner
def longest_of(cp, deg, pieces_i, first, count):
    """The piece of a Bezier with the ends farthest apart: what must give, gives there."""
    longest = first
    most = -1.0
    for p in range(first, count):
        end = pieces_i[p, P_CP0] + deg
        size = abs(cp[end, 0]) + abs(cp[end, 1])
        if size > most:
            most = size
            longest = p
    return longest


@inner
def cut_off(cp, c0, deg, rational, begin, end):
    """(x, y): the way along what is cut off of a Bezier outside [begin, end]."""
    ax, ay, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, begin, cp[c0, 0], cp[c0, 1])
    bx, by, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, end, cp[c0 + deg, 0], cp[c0 + deg, 1])
    return ax - bx, ay - by


@inner
def stretch(cp, target, deg, x, y, most):
    """Let the piece in rows target.. end by (x, y), what was cut off of its Bezier, farther on: its pieces meet the vertices.

    A piece that ended beside its vertex was in two places, seen from either end. Its tangents stay what they are where it meets
    others, its curvatures, too, if its degree allows: a kink of 1e-12 there turned the axis away from the leaf of the joint. One
    so short that it would sway is sheared; False if it would lean by more than `most`, in radians, and stays as it is.
    """
    length = math.sqrt(cp[target + deg, 0] ** 2 + cp[target + deg, 1] ** 2)
    way = abs(x) + abs(y)
    if way > most * length:
        return False
    kept = min(2, (deg - 1) // 2) if way <= SWAY * length * length else 0
    for i in range(kept + 1, deg + 1):
        share = min((i - kept) / (deg - 2.0 * kept), 1.0)
        cp[target + i, 0] += share * x
        cp[target + i, 1] += share * y
    return True


@inner
def chain(cp, cp_low, bez_f, b, end, pieces_i, pieces_f, first, longest, count):
    """Starts of the pieces of Bezier b to more digits, each where the one before ends by its own control points.

    So pieces that are near each other, with tiny ones in between, keep the digits of their differences. What rounding leaves over
    goes to the longest piece; those behind it are placed from the end of the Bezier, row `end` of `cp`. Centres of arcs, relative
    to the start of their piece so far, are placed with it.
    """
    for axis in range(2):
        high = bez_f[b, 3 + axis]
        low = bez_f[b, 5 + axis]
        for p in range(first, longest + 1):
            pieces_f[p, P_X + axis] = high
            pieces_f[p, P_X_LOW + axis] = low
            high, low = add_closely(high, low, cp[pieces_i[p, P_CP0] + pieces_i[p, P_DEG], axis])
        high, low = add_closely(bez_f[b, 3 + axis], bez_f[b, 5 + axis] + cp_low[end, axis], cp[end, axis])
        for p in range(count - 1, longest, -1):
            high, low = add_closely(high, low, -cp[pieces_i[p, P_CP0] + pieces_i[p, P_DEG], axis])
            pieces_f[p, P_X + axis] = high
            pieces_f[p, P_X_LOW + axis] = low
        for p in range(first, count):
            pieces_f[p, P_CENTRE_X + axis] += pieces_f[p, P_X + axis]


@inner
def handle(cp, a, b):
    """Distance of two control points along x and y."""
    return abs(cp[b, 0] - cp[a, 0]) + abs(cp[b, 1] - cp[a, 1])


@inner
def go_on(pieces_i, pieces_f, before, after, left, right, kind, bent_alike):
    """One tangent where piece `after` goes on in the direction of `before`, at a knot: that of the side which tells it better.

    That is the one with the longer handle, `left` or `right`, of the Bezier that the tangent was taken from: pieces may be tiny.
    One curvature, too, where both are PLAIN and `bent_alike`: a side whose rounding hid that it rises there would have a leaf.

    Where something was cut off the knot is a vertex, unless that was a convex bend, up to its peak: its leaf is farther from the
    knot than `TRIM`.
    """
    tx = pieces_f[before, P_FRAME + 3]
    ty = pieces_f[before, P_FRAME + 4]
    ux = pieces_f[after, P_FRAME]
    uy = pieces_f[after, P_FRAME + 1]
    spirals = pieces_i[before, P_KIND] == SPIRAL and pieces_i[after, P_KIND] == SPIRAL
    peak = max(pieces_f[before, P_FRAME + 5], pieces_f[after, P_FRAME + 2]) if spirals else 0.0
    if kind == CUT_WITH_PEAK or kind == CUT_OFF and not (0.0 < peak * TRIM < AT_PEAK and tx * uy - ty * ux >= 0.0):
        return
    pieces_i[after, P_GOES_ON] = 1
    if not spirals or tx * ux + ty * uy < SAME_WAY:  # it stands still at the knot
        return
    for column in range(3 if kind == PLAIN and bent_alike else 2):
        if left >= right:
            pieces_f[after, P_FRAME + column] = pieces_f[before, P_FRAME + 3 + column]
        else:
            pieces_f[before, P_FRAME + 3 + column] = pieces_f[after, P_FRAME + column]
