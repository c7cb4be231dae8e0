"""From pieces to rows of the site table: geometry of each piece, a fan of normals at each reflex vertex, neighbours by index."""

from __future__ import annotations

import math

from mat_core.boundary.chain import (
    P_CENTRE_X,
    P_CENTRE_Y,
    P_CP0,
    P_CURVATURE,
    P_DEG,
    P_EDGE,
    P_FRAME,
    P_GOES_ON,
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
)
from mat_core.boundary.faint import flatten_rises
from mat_core.boundary.turning import joint_turn
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import (
    ARC,
    CONVEX_VERTEX,
    CORNER,
    CP0,
    DEG,
    EDGE,
    FAN,
    GOES_ON,
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

SAME_CURVATURE = 1e-12  # relative difference of the curvatures at both ends of a spiral below which it may be a circular arc
FROM_CIRCLE = 1e-16  # distance from that arc, normalised, which is rounding


@inner
def _bound_piece(cp, c0, deg, site, sf):
    """The box of a site with ends and control points known; the length of its control polygon."""
    x0 = sf[site, X0]
    y0 = sf[site, Y0]
    xmin = min(x0, sf[site, X1])
    xmax = max(x0, sf[site, X1])
    ymin = min(y0, sf[site, Y1])
    ymax = max(y0, sf[site, Y1])
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
    return length


@inner
def _fill_arc(pieces_f, p, site, sf):
    """Tangents, curvature and sweep of a circular arc, from its centre; its length."""
    k = pieces_f[p, P_CURVATURE]
    cx = pieces_f[p, P_CENTRE_X]
    cy = pieces_f[p, P_CENTRE_Y]
    x0 = sf[site, X0]
    y0 = sf[site, Y0]
    x1 = sf[site, X1]
    y1 = sf[site, Y1]
    h0 = math.sqrt((cx - x0) * (cx - x0) + (cy - y0) * (cy - y0)) * (1.0 if k > 0.0 else -1.0)
    h1 = math.sqrt((cx - x1) * (cx - x1) + (cy - y1) * (cy - y1)) * (1.0 if k > 0.0 else -1.0)
    tx0 = sf[site, TX0] = (cy - y0) / h0
    ty0 = sf[site, TY0] = -(cx - x0) / h0
    tx1 = sf[site, TX1] = (cy - y1) / h1
    ty1 = sf[site, TY1] = -(cx - x1) / h1
    sweep = math.atan2(tx0 * ty1 - ty0 * tx1, tx0 * tx1 + ty0 * ty1)
    sf[site, K0] = sf[site, K1] = k
    sf[site, SWEEP] = sweep
    return abs(sweep / k)


@inner
def _fill_piece(pieces_i, pieces_f, p, after, cp, site, loop, si, sf):
    """The row of piece p, which ends where `after` starts."""
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
    si[site, GOES_ON] = pieces_i[p, P_GOES_ON]
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
    length = _bound_piece(cp, c0, deg, site, sf)
    if kind == LINE:
        length = math.sqrt((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0))
        sf[site, TX0] = sf[site, TX1] = (x1 - x0) / length
        sf[site, TY0] = sf[site, TY1] = (y1 - y0) / length
        sf[site, K0] = sf[site, K1] = 0.0
        sf[site, SWEEP] = 0.0
    elif kind == ARC:
        length = _fill_arc(pieces_f, p, site, sf)
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
    """One reflex vertex: the point with the normals between those of both pieces."""
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
def _move_site(source, target, si, sf):
    """Copy one row of the table."""
    for column in range(SI_WIDTH):
        si[target, column] = si[source, column]
    for column in range(SF_WIDTH):
        sf[target, column] = sf[source, column]


@jit
def fill_sites(pieces_i, pieces_f, piece_loop_start, cp, smooth_angle, bent_back, rounding, si, sf, turns, loop_start):
    """All loops. `si`, `sf` have room for twice the pieces; returns the number of sites."""
    count = 0
    loop_start[0] = 0
    for loop in range(piece_loop_start.shape[0] - 1):
        first = piece_loop_start[loop]
        n = piece_loop_start[loop + 1] - first
        base = count
        for p in range(n):
            after = p + 1 if p + 1 < n else 0
            _fill_piece(pieces_i, pieces_f, first + p, first + after, cp, base + p, loop, si, sf)
        flatten_rises(si, sf, cp, base, n)
        fans = 0
        for p in range(n):
            a = base + (p if p > 0 else n) - 1
            b = base + p
            turn = joint_turn(si, sf, cp, base, n, p, smooth_angle, bent_back, rounding)
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
