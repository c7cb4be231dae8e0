"""The flat site table: what a maximal disc may touch, in loop order, interior on the left, in normalised coordinates.

Steps: 1. edges translated to the centre of the bounding box and scaled by a power of two (exact), then to Beziers (knot
insertion), reversed where the loop runs the wrong way; 2. Beziers to pieces of monotone curvature; 3. pieces and normal fans to
sites.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.curvature import SCRATCH_ROWS, scratch_width
from mat_core.boundary.joints import CUSP_ANGLE, cusp_is_convex
from mat_core.boundary.pieces import (
    P_CENTRE_X,
    P_CENTRE_Y,
    P_CP0,
    P_CURVATURE,
    P_DEG,
    P_EDGE,
    P_FRAME,
    P_KIND,
    P_RATIONAL,
    P_SKEW,
    P_SPAN,
    P_UA,
    P_UB,
    P_X,
    P_X_LOW,
    P_Y,
    P_Y_LOW,
    PF_WIDTH,
    PI_WIDTH,
    cut_beziers,
)
from mat_core.kernels.bernstein import MAX_DEPTH
from mat_core.kernels.bezier import balance, decompose
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import (
    ARC,
    CONVEX_VERTEX,
    CORNER,
    CP0,
    DEG,
    EDGE,
    FAN,
    K0,
    K1,
    KIND,
    KNOWN,
    LEN,
    LINE,
    LOOP,
    NEXT,
    PREV,
    RATIONAL,
    SF_WIDTH,
    SI_WIDTH,
    SKEW,
    SMOOTH_JOINT,
    SPAN,
    SWEEP,
    TX0,
    TX1,
    TY0,
    TY1,
    UA,
    UB,
    V0,
    V1,
    X0,
    X0_LOW,
    X1,
    X1_LOW,
    XMAX,
    XMIN,
    Y0,
    Y0_LOW,
    Y1,
    Y1_LOW,
    YMAX,
    YMIN,
)
from mat_core.model.domain import Domain
from mat_core.tolerances import Tolerances

KINK = 32.0  # roundings by which a joint may turn, radians, without anything being meant by it
BENT_BACK = 1e-9  # radians by which a reflex joint may turn and be smooth: no branch runs into it, so nothing is gained by more
SLIGHT_BEND = 0.01  # of a convex joint over the length of a piece beside it: no disc is bent so little by a hundred times
SAME_BEZIER = 0.1  # radians; a Bezier turns by less where it is cut, but at a cusp
UNCERTAIN = 2.0  # roundings over its length by which the tangent of a piece may be wrong
SAME_CURVATURE = 1e-12  # relative difference of the curvatures at both ends of a spiral below which it may be a circular arc
FROM_CIRCLE = 1e-16  # distance from that arc, normalised, which is rounding


class SiteTable(NamedTuple):
    """Sites of a domain in normalised coordinates, (input - origin) * scale, so that the larger side is in [0.5, 1].

    si (n, SI_WIDTH) int64 and sf (n, SF_WIDTH) float64: columns in `mat_core.kernels.layout`; cp (m, 3): control points x, y
    (relative to the site's start) and weight; loop_start (L + 1,): sites of each loop; origin (2,); scale: a power of two;
    smooth_angle: joints that turn by no more, radians, were taken as smooth.
    """

    si: NDArray[np.int64]
    sf: NDArray[np.float64]
    cp: NDArray[np.float64]
    loop_start: NDArray[np.int64]
    origin: NDArray[np.float64]
    scale: float
    smooth_angle: float


@jit
def _count_beziers(degree, cp_start):
    """What step 1 needs room for: (Beziers, their control points; most of one edge, most that one is given, highest degree)."""
    beziers = points = most_of_edge = longest = highest = 0
    for edge in range(degree.shape[0]):
        d = degree[edge]
        given = cp_start[edge + 1] - cp_start[edge]
        spans = max(given - d, 1)
        beziers += spans
        points += spans * (d + 1)
        most_of_edge = max(most_of_edge, given * (d + 1))
        longest = max(longest, given)
        highest = max(highest, d)
    return beziers, points, most_of_edge, longest, highest


@jit
def _cut_edges(
    degree, cp_start, control, knot_start, knots, edge_loop_start, backwards, ox, oy, scale, rounding, moved, span_cp, breaks,
    bez_i, bez_u, bez_loop_start, cp, pieces_i, pieces_f, piece_loop_start, table, work, bounds, roots,
):
    """Steps 1 and 2; returns (pieces, rows of cp), pieces = -1 if a buffer is too small."""
    # before knots are inserted: far from the origin a new point would be rounded as coarsely as those are
    for row in range(control.shape[0]):
        moved[row, 0] = (control[row, 0] - ox) * scale
        moved[row, 1] = (control[row, 1] - oy) * scale
        moved[row, 2] = control[row, 2]
    noise = 4.0 * rounding
    used = _collect_beziers(degree, cp_start, moved, knot_start, knots, edge_loop_start, backwards, noise, span_cp, breaks, bez_i,
                            bez_u, cp, bez_loop_start)
    return cut_beziers(bez_i, bez_u, bez_loop_start, cp, used, pieces_i, pieces_f, piece_loop_start, rounding, noise, table, work,
                       bounds, roots)


@inner
def _collect_beziers(
    degree, cp_start, control, knot_start, knots, edge_loop_start, backwards, rounding,
    span_cp, breaks, bez_i, bez_u, cp, bez_loop_start,
):
    """Step 1: fill bez_i (degree, cp0, rational, edge, span), bez_u (ua, ub, skew), cp; returns the rows of cp."""
    count = 0
    used = 0
    bez_loop_start[0] = 0
    for loop in range(edge_loop_start.shape[0] - 1):
        first = edge_loop_start[loop]
        last = edge_loop_start[loop + 1]
        flip = backwards[loop]
        loop_first = count
        for step in range(last - first):
            edge = last - 1 - step if flip else first + step
            d = degree[edge]
            n_spans = decompose(d, knots, knot_start[edge], knot_start[edge + 1] - knot_start[edge], control, cp_start[edge],
                                cp_start[edge + 1] - cp_start[edge], span_cp, breaks)
            for position in range(n_spans):
                span = n_spans - 1 - position if flip else position
                row = span * (d + 1)
                rational = 0
                extent = 0.0
                for i in range(d + 1):
                    source = row + (d - i if flip else i)
                    cp[used + i, 0] = span_cp[source, 0]
                    cp[used + i, 1] = span_cp[source, 1]
                    cp[used + i, 2] = span_cp[source, 2] / span_cp[row, 2]
                    if cp[used + i, 2] != 1.0:
                        rational = 1
                    extent = max(extent, abs(cp[used + i, 0] - cp[used, 0]), abs(cp[used + i, 1] - cp[used, 1]))
                if extent <= rounding:
                    continue
                bez_i[count, 0] = d
                bez_i[count, 1] = used
                bez_i[count, 2] = rational
                bez_i[count, 3] = edge - first
                bez_i[count, 4] = span
                bez_u[count, 0] = breaks[span + 1] if flip else breaks[span]
                bez_u[count, 1] = breaks[span] if flip else breaks[span + 1]
                bez_u[count, 2] = balance(cp, used, d)
                count += 1
                used += d + 1
        # ends that differ by rounding become one point
        for b in range(loop_first, count):
            after = b + 1 if b + 1 < count else loop_first
            end = bez_i[b, 1] + bez_i[b, 0]
            cp[end, 0] = cp[bez_i[after, 1], 0]
            cp[end, 1] = cp[bez_i[after, 1], 1]
        bez_loop_start[loop + 1] = count
    return used


@inner
def _fill_piece(pieces_i, pieces_f, p, after, cp, site, loop, si, sf):
    """Step 3 for piece p, which ends where `after` starts: its row of the table."""
    deg = pieces_i[p, P_DEG]
    c0 = pieces_i[p, P_CP0]
    kind = pieces_i[p, P_KIND]
    si[site, KIND] = kind
    si[site, DEG] = deg
    si[site, CP0] = c0
    si[site, RATIONAL] = pieces_i[p, P_RATIONAL]
    si[site, V0] = p
    si[site, V1] = after
    si[site, LOOP] = loop
    si[site, EDGE] = pieces_i[p, P_EDGE]
    si[site, SPAN] = pieces_i[p, P_SPAN]
    si[site, CORNER] = SMOOTH_JOINT
    si[site, KNOWN] = 0
    sf[site, UA] = pieces_f[p, P_UA]
    sf[site, UB] = pieces_f[p, P_UB]
    sf[site, SKEW] = pieces_f[p, P_SKEW]
    x0 = sf[site, X0] = pieces_f[p, P_X]
    y0 = sf[site, Y0] = pieces_f[p, P_Y]
    x1 = sf[site, X1] = pieces_f[after, P_X]
    y1 = sf[site, Y1] = pieces_f[after, P_Y]
    sf[site, X0_LOW] = pieces_f[p, P_X_LOW]
    sf[site, Y0_LOW] = pieces_f[p, P_Y_LOW]
    sf[site, X1_LOW] = pieces_f[after, P_X_LOW]
    sf[site, Y1_LOW] = pieces_f[after, P_Y_LOW]
    xmin = min(x0, x1)
    xmax = max(x0, x1)
    ymin = min(y0, y1)
    ymax = max(y0, y1)
    length = 0.0
    for i in range(1, deg + 1):
        dx = cp[c0 + i, 0]
        dy = cp[c0 + i, 1]
        xmin = min(xmin, x0 + dx)
        xmax = max(xmax, x0 + dx)
        ymin = min(ymin, y0 + dy)
        ymax = max(ymax, y0 + dy)
        length += math.sqrt((dx - cp[c0 + i - 1, 0]) ** 2 + (dy - cp[c0 + i - 1, 1]) ** 2)
    sf[site, XMIN] = xmin
    sf[site, YMIN] = ymin
    sf[site, XMAX] = xmax
    sf[site, YMAX] = ymax
    if kind == LINE:
        length = math.sqrt((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0))
        sf[site, TX0] = sf[site, TX1] = (x1 - x0) / length
        sf[site, TY0] = sf[site, TY1] = (y1 - y0) / length
        sf[site, K0] = sf[site, K1] = 0.0
        sf[site, SWEEP] = 0.0
    elif kind == ARC:
        k = pieces_f[p, P_CURVATURE]
        cx = pieces_f[p, P_CENTRE_X]
        cy = pieces_f[p, P_CENTRE_Y]
        h0 = math.sqrt((cx - x0) * (cx - x0) + (cy - y0) * (cy - y0)) * (1.0 if k > 0.0 else -1.0)
        h1 = math.sqrt((cx - x1) * (cx - x1) + (cy - y1) * (cy - y1)) * (1.0 if k > 0.0 else -1.0)
        tx0 = sf[site, TX0] = (cy - y0) / h0
        ty0 = sf[site, TY0] = -(cx - x0) / h0
        tx1 = sf[site, TX1] = (cy - y1) / h1
        ty1 = sf[site, TY1] = -(cx - x1) / h1
        sweep = math.atan2(tx0 * ty1 - ty0 * tx1, tx0 * tx1 + ty0 * ty1)
        sf[site, K0] = sf[site, K1] = k
        sf[site, SWEEP] = sweep
        length = abs(sweep / k)
    else:
        for side in range(2):
            sf[site, TX0 + 2 * side] = pieces_f[p, P_FRAME + 3 * side]
            sf[site, TY0 + 2 * side] = pieces_f[p, P_FRAME + 3 * side + 1]
            sf[site, K0 + side] = pieces_f[p, P_FRAME + 3 * side + 2]
        sf[site, SWEEP] = 0.0
        length = _as_arc(site, length, si, sf)
    sf[site, LEN] = length


@inner
def _as_arc(site, length, si, sf):
    """Make a spiral an arc that is one but for rounding, as beside the flat maximum of a curvature; its length."""
    k = 0.5 * (sf[site, K0] + sf[site, K1])
    change = abs(sf[site, K1] - sf[site, K0])
    if not 0.0 < abs(k) < math.inf or change > SAME_CURVATURE * abs(k) or change * length * length > FROM_CIRCLE:
        return length
    sweep = math.atan2(sf[site, TX0] * sf[site, TY1] - sf[site, TY0] * sf[site, TX1],
                       sf[site, TX0] * sf[site, TX1] + sf[site, TY0] * sf[site, TY1])
    if not sweep * k > 0.0:
        return length
    si[site, KIND] = ARC
    si[site, KNOWN] = 1
    sf[site, K0] = sf[site, K1] = k
    sf[site, SWEEP] = sweep
    return abs(sweep / k)


@inner
def _fill_fan(site, before, after, turn, si, sf):
    """Step 3 for one reflex vertex: the point with the normals between those of both pieces."""
    for column in range(SI_WIDTH):
        si[site, column] = si[after, column]
    si[site, KIND] = FAN
    si[site, V1] = si[after, V0]
    si[site, V0] = si[after, V0]
    si[site, CORNER] = CONVEX_VERTEX if sf[before, K1] == math.inf else SMOOTH_JOINT
    x = sf[after, X0]
    y = sf[after, Y0]
    sf[site, X0] = sf[site, X1] = sf[site, XMIN] = sf[site, XMAX] = x
    sf[site, Y0] = sf[site, Y1] = sf[site, YMIN] = sf[site, YMAX] = y
    sf[site, X0_LOW] = sf[site, X1_LOW] = sf[after, X0_LOW]
    sf[site, Y0_LOW] = sf[site, Y1_LOW] = sf[after, Y0_LOW]
    sf[site, TX0] = sf[before, TX1]
    sf[site, TY0] = sf[before, TY1]
    sf[site, TX1] = sf[after, TX0]
    sf[site, TY1] = sf[after, TY0]
    sf[site, K0] = sf[site, K1] = -math.inf
    sf[site, SWEEP] = turn
    sf[site, LEN] = 0.0
    sf[site, UA] = sf[site, UB] = sf[after, UA]
    sf[site, SKEW] = 1.0


@inner
def _bezier_length(si, sf, base, n, p, step):
    """Length of the Bezier that site base + p is cut from, from one end of the site on, in steps of 1 or -1."""
    length = sf[base + p, LEN]
    for k in range(1, n):
        a = base + (p + (k - 1) * step) % n
        b = base + (p + k * step) % n
        joined = sf[a, UB] == sf[b, UA] if step > 0 else sf[a, UA] == sf[b, UB]
        if si[a, EDGE] != si[b, EDGE] or si[a, SPAN] != si[b, SPAN] or not joined:
            break
        length += sf[b, LEN]
    return length


@inner
def _smooth_limit(si, sf, base, n, before, after, smooth_angle, rounding):
    """The angle up to which the convex joint of two of the n pieces of a loop is smooth.

    Two tiny sides that meet at a convex angle may be how a curve bends: a disc at one joint would touch what lies beyond the
    next one, as if there were no corner between. So the angle has to be small for the length of both, or their rounding. Sides
    are as long as the Beziers that the pieces are cut from: a noisy one may have a piece of 1e-9 at its end.
    """
    if SLIGHT_BEND * min(sf[base + before, LEN], sf[base + after, LEN]) >= smooth_angle:
        return smooth_angle
    length = min(_bezier_length(si, sf, base, n, before, -1), _bezier_length(si, sf, base, n, after, 1))
    return min(smooth_angle, max(SLIGHT_BEND * length, UNCERTAIN * rounding / length))


@inner
def _move_site(source, target, si, sf):
    """Copy one row of the table."""
    for column in range(SI_WIDTH):
        si[target, column] = si[source, column]
    for column in range(SF_WIDTH):
        sf[target, column] = sf[source, column]


@inner
def _has_two_leaves(si, sf, a, b, bend):
    """Whether the curvature is positive and highest at the reflex joint of pieces a and b, so that its fan would part one leaf.

    The osculating disc of the side that is curved less meets the other one 2 bend / (difference of curvatures) from the joint:
    along an arc that is longer than that there is one leaf, the arc's.
    """
    if not (min(sf[a, K1], sf[b, K0]) > 0.0 and sf[a, K1] >= sf[a, K0] and sf[b, K0] >= sf[b, K1]):
        return False
    sharper = a if sf[a, K1] > sf[b, K0] else b
    return si[sharper, KIND] != ARC or 2.0 * bend >= abs(sf[a, K1] - sf[b, K0]) * sf[sharper, LEN]


@inner
def _turn(si, sf, cp, base, n, p, smooth_angle, bent_back, rounding):
    """By how much the boundary turns where site base + p of a loop of n begins, radians; 0 where that is smooth.

    A convex joint that turns by no more than `_smooth_limit` is smooth, a reflex one by no more than `bent_back`: a fan has all
    of its normals, and the disc of their mean would be off by radius times angle. But for one leaf a fan would make two.
    """
    a = base + (p if p > 0 else n) - 1
    b = base + p
    turn = math.atan2(sf[a, TX1] * sf[b, TY0] - sf[a, TY1] * sf[b, TX0], sf[a, TX1] * sf[b, TX0] + sf[a, TY1] * sf[b, TY0])
    if math.pi - abs(turn) < CUSP_ANGLE:
        # the curves tell the side, the angle keeps its digits: a fan ends at the next piece's own normal
        if cusp_is_convex(si, sf, cp, a, b):
            return turn if turn > 0.0 else turn + 2.0 * math.pi
        return turn if turn < 0.0 else turn - 2.0 * math.pi
    if n > 1 and abs(turn) < SAME_BEZIER and si[a, EDGE] == si[b, EDGE] and si[a, SPAN] == si[b, SPAN] and sf[a, UB] == sf[b, UA]:
        return 0.0
    if turn < 0.0:
        smooth = -turn <= (smooth_angle if _has_two_leaves(si, sf, a, b, -turn) else bent_back)
    else:
        smooth = turn <= _smooth_limit(si, sf, base, n, a - base, p, smooth_angle, rounding)
    return 0.0 if smooth else turn


@jit
def _fill_sites(pieces_i, pieces_f, piece_loop_start, cp, smooth_angle, bent_back, rounding, si, sf, turns, loop_start):
    """Step 3: all loops. `si`, `sf` have room for twice the pieces; returns the number of sites."""
    count = 0
    loop_start[0] = 0
    for loop in range(piece_loop_start.shape[0] - 1):
        first = piece_loop_start[loop]
        n = piece_loop_start[loop + 1] - first
        base = count
        for p in range(n):
            after = p + 1 if p + 1 < n else 0
            _fill_piece(pieces_i, pieces_f, first + p, first + after, cp, base + p, loop, si, sf)
        fans = 0
        for p in range(n):
            a = base + (p if p > 0 else n) - 1
            b = base + p
            turn = _turn(si, sf, cp, base, n, p, smooth_angle, bent_back, rounding)
            # a curvature that grows without bound towards its end is a leaf of radius 0 there, like a convex corner
            if turn > 0.0 or sf[b, K0] == math.inf or (turn == 0.0 and sf[a, K1] == math.inf):
                si[b, CORNER] = CONVEX_VERTEX
            turns[p] = turn
            if turn < 0.0:
                fans += 1
        # make room for the fans, from the end, so that no row is overwritten before it is moved
        target = base + n + fans - 1
        for p in range(n - 1, -1, -1):
            _move_site(base + p, target, si, sf)
            target -= 1
            if turns[p] < 0.0:
                target -= 1
        count = base + n + fans
        target = base
        for p in range(n):
            if turns[p] < 0.0:
                before = target - 1 if target > base else count - 1
                _fill_fan(target, before, target + 1, turns[p], si, sf)
                target += 1
            target += 1
        for site in range(base, count):
            si[site, NEXT] = site + 1 if site + 1 < count else base
            si[site, PREV] = site - 1 if site > base else count - 1
        loop_start[loop + 1] = count
    return count


def build_sites(domain: Domain, smooth_angle: float, tolerances: Tolerances) -> SiteTable:
    """Cut the boundary of a valid domain into sites.

    Parameters
    ----------
    domain : Domain
        Valid (checked by its constructor).
    smooth_angle : float
        Radians; convex joints that turn by less are smooth, most reflex ones only if they turn by hardly anything.
    tolerances : Tolerances
        Rounding of the normalised coordinates is taken from here and from the size of the input's coordinates.

    Returns
    -------
    SiteTable
    """
    a = domain.arrays
    xmin, ymin, xmax, ymax = domain.bbox
    origin = np.array((0.5 * (xmin + xmax), 0.5 * (ymin + ymax)))
    scale = 2.0 ** -math.frexp(max(xmax - xmin, ymax - ymin))[1]
    magnitude = max(abs(xmin), abs(xmax), abs(ymin), abs(ymax)) * scale
    rounding = tolerances.rounding * max(1.0, magnitude)
    smooth_angle = max(smooth_angle, KINK * rounding)

    loops = len(a.loop_start)
    beziers, points, most_of_edge, longest, highest = _count_beziers(a.degree, a.cp_start)
    width = scratch_width(highest)
    moved, span_cp, breaks = np.empty_like(a.cp), np.empty((most_of_edge, 3)), np.empty(longest + 2)
    bez_i, bez_u, bez_loop_start = np.empty((beziers, 5), dtype=np.int64), np.empty((beziers, 3)), np.empty(loops, dtype=np.int64)
    table, work = np.empty((SCRATCH_ROWS, width)), np.empty((MAX_DEPTH + 2, width))
    bounds, roots = np.empty((MAX_DEPTH + 2, 2)), np.empty(width)
    piece_loop_start = np.empty(loops, dtype=np.int64)
    room, n_pieces = 1, -1
    while n_pieces < 0:
        room *= 4
        cp = np.empty((points * room + 256, 3))
        pieces_i, pieces_f = np.empty((beziers * room + 16, PI_WIDTH), dtype=np.int64), np.empty((beziers * room + 16, PF_WIDTH))
        n_pieces, rows = _cut_edges(
            a.degree, a.cp_start, a.cp, a.knot_start, a.knots, a.loop_start, a.reversed, origin[0], origin[1], scale, rounding,
            moved, span_cp, breaks, bez_i, bez_u, bez_loop_start, cp, pieces_i, pieces_f, piece_loop_start, table, work, bounds,
            roots)
    si, sf = np.empty((2 * n_pieces, SI_WIDTH), dtype=np.int64), np.empty((2 * n_pieces, SF_WIDTH))
    turns, loop_start = np.empty(n_pieces), np.empty(loops, dtype=np.int64)
    bent_back = min(smooth_angle, max(BENT_BACK, KINK * rounding))
    n = _fill_sites(pieces_i, pieces_f, piece_loop_start, cp, smooth_angle, bent_back, rounding, si, sf, turns,
                    loop_start)
    return SiteTable(si[:n], sf[:n], cp[:rows], loop_start, origin, scale, smooth_angle)
