"""Distances to the boundary, for the certificate: how deep anything reaches into a disc, and the nearest foot.

Nothing here relies on curvature being monotone, nor on the tree and the tangent-circle search that found the axis: a
Bezier piece is shown to stay outside a disc of centre c and radius r by the signs of

    h(s) = |q(s)|^2 - r^2 w(s)^2,    q = w (C - c)        (homogeneous, so polynomial for rational pieces as well)

in Bernstein form; C and c are relative to the piece's start. Coefficients without a negative one prove it; a convex row
(second differences not negative) has one minimum, found by bracketed Newton; any other row is halved.
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import bezier_frame, evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.judge_boxes import outside
from mat_core.kernels.layout import (
    ARC,
    CP0,
    DEG,
    FAN,
    K0,
    KIND,
    LINE,
    RATIONAL,
    SWEEP,
    TX0,
    TX1,
    TY0,
    TY1,
    X0,
    X1,
    Y0,
    Y1,
)

JUDGE_STACK = 128  # depth of the walk through the tree of boxes
HALVINGS = 40  # deepest subdivision of one piece; 2^-40 of it is far below every limit
JUDGE_ROWS = HALVINGS + 6  # rows of the scratch table: three of points, then the stack
_QX, _QY, _QW, _FIRST = 0, 1, 2, 3
NOISE = 4e-15  # rounding of a coefficient of h, relative to the largest |q|^2
RATIONAL_ROUNDS = 12  # discs tried on a rational piece that reaches far inside
NEWTON = 60  # steps of the bracketed Newton iterations; halving alone ends in as many
INSET = 1e-3  # a first guess at an end is taken this share of the interval inside
SETTLED = 1e-8  # a Newton step below this squares to rounding
RETRIES = 6  # first guesses for a local foot
CLOSE = 1e-11  # a foot this near to where a disc should touch is the one that was looked for; well below what a check forgives


@inner
def _from_centre(cp, c0, deg, rational, s, x, y):
    """C - c with both derivatives of C; these are taken about the nearer end, or a tiny piece would lose their digits."""
    ox = 0.0 if s <= 0.5 else cp[c0 + deg, 0]
    oy = 0.0 if s <= 0.5 else cp[c0 + deg, 1]
    dx, dy, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, s, ox, oy)
    return dx + (ox - x), dy + (oy - y), x1, y1, x2, y2


@inner
def _bezier_foot(cp, c0, deg, rational, lo, hi, x, y, guess):
    """(distance, s): a local minimum of |C(s) - c| on [lo, hi], by bracketed Newton on g = (C - c).C' from a guess."""
    a = lo
    b = hi
    inset = INSET * (hi - lo)
    s = min(max(guess, lo + inset), hi - inset)
    for _ in range(NEWTON):
        dx, dy, x1, y1, x2, y2 = _from_centre(cp, c0, deg, rational, s, x, y)
        g = dx * x1 + dy * y1
        if g > 0.0:
            b = s
        else:
            a = s
        slope = x1 * x1 + y1 * y1 + dx * x2 + dy * y2
        new = s - g / slope if slope > 0.0 else (lo if g > 0.0 else hi)
        if slope > 0.0 and abs(new - s) <= SETTLED:
            s = min(max(new, lo), hi)
            break
        if a < new < b:
            s = new
            continue
        end = lo if new <= a else hi
        if end == a or end == b:
            # an end that nothing has excluded yet is tried itself before halving
            dx, dy, x1, y1, x2, y2 = _from_centre(cp, c0, deg, rational, end, x, y)
            g = dx * x1 + dy * y1
            if (g >= 0.0) if end == lo else (g <= 0.0):
                return math.sqrt(dx * dx + dy * dy), end
        new = 0.5 * (a + b)
        if abs(new - s) <= 2e-16:
            break
        s = new
    dx, dy, x1, y1, x2, y2 = _from_centre(cp, c0, deg, rational, s, x, y)
    return math.sqrt(dx * dx + dy * dy), s


@inner
def turn_fraction(px, py, qx, qy, sweep):
    """Where direction q stands on a turn from p by `sweep`, as a fraction; ambiguity is cut opposite its middle."""
    angle = math.atan2(px * qy - py * qx, px * qx + py * qy)
    if angle < 0.5 * sweep - math.pi:
        angle += 2.0 * math.pi
    elif angle > 0.5 * sweep + math.pi:
        angle -= 2.0 * math.pi
    return angle / sweep


@inner
def foot(si, sf, cp, i, lo, hi, x, y, guess):
    """(distance, s): the foot of c on [lo, hi] of site i; on a SPIRAL the local one that `guess` leads to."""
    kind = si[i, KIND]
    if kind == LINE:
        lx = sf[i, X1] - sf[i, X0]
        ly = sf[i, Y1] - sf[i, Y0]
        s = ((x - sf[i, X0]) * lx + (y - sf[i, Y0]) * ly) / (lx * lx + ly * ly)
        s = lo if s < lo else (hi if s > hi else s)
        # from the nearer end, which keeps the digits
        dx = (sf[i, X0] - x) + s * lx if s <= 0.5 else (sf[i, X1] - x) - (1.0 - s) * lx
        dy = (sf[i, Y0] - y) + s * ly if s <= 0.5 else (sf[i, Y1] - y) - (1.0 - s) * ly
        return math.sqrt(dx * dx + dy * dy), s
    if kind == ARC:
        k = sf[i, K0]
        vx = k * (x - sf[i, X0]) + sf[i, TY0]
        vy = k * (y - sf[i, Y0]) - sf[i, TX0]
        s = turn_fraction(sf[i, TY0], -sf[i, TX0], vx, vy, sf[i, SWEEP])
    elif kind == FAN:
        dx = x - sf[i, X0]
        dy = y - sf[i, Y0]
        s = turn_fraction(-sf[i, TY0], sf[i, TX0], dx, dy, sf[i, SWEEP])
        s = lo if s < lo else (hi if s > hi else s)
        return math.sqrt(dx * dx + dy * dy), s
    else:
        return _bezier_foot(cp, si[i, CP0], si[i, DEG], si[i, RATIONAL], lo, hi, x - sf[i, X0], y - sf[i, Y0], guess)
    s = lo if s < lo else (hi if s > hi else s)
    dx, dy, tx, ty, curvature, speed = evaluate(si, sf, cp, i, s, x, y)
    return math.sqrt(dx * dx + dy * dy), s


@inner
def _outside_bezier(cp, c0, deg, rational, x, y, r, hint, work, binomial):
    """min(0, smallest |C(s) - c| - r) over a whole Bezier piece; `hint`: where the nearest point may be.

    The lowest h is the nearest point when w = 1; a rational piece is asked again with the smaller disc that was left.
    """
    n = 2 * deg
    total = 0.0
    for _ in range(RATIONAL_ROUNDS if rational else 1):
        reach = r + total
        scale = r * r
        for i in range(deg + 1):
            w = cp[c0 + i, 2] * binomial[deg, i]
            dx = cp[c0 + i, 0] - x
            dy = cp[c0 + i, 1] - y
            size = dx * dx + dy * dy
            if size > scale:
                scale = size
            work[_QX, i] = w * dx
            work[_QY, i] = w * dy
            work[_QW, i] = w * reach
        for k in range(n + 1):
            work[_FIRST, k] = 0.0
        for i in range(deg + 1):
            qx = work[_QX, i]
            qy = work[_QY, i]
            qw = work[_QW, i]
            work[_FIRST, 2 * i] += qx * qx + qy * qy - qw * qw
            for j in range(i):
                work[_FIRST, i + j] += 2.0 * (qx * work[_QX, j] + qy * work[_QY, j] - qw * work[_QW, j])
        noise = -NOISE * scale
        low = 0.0
        for k in range(n + 1):
            work[_FIRST, k] /= binomial[n, k]
            if work[_FIRST, k] < low:
                low = work[_FIRST, k]
        if low >= noise:
            break
        gap = _least_gap(cp, c0, deg, rational, x, y, reach, hint, work, noise)
        if not gap < 0.0:
            break
        total += gap
    return total


@inner
def _least_gap(cp, c0, deg, rational, x, y, r, hint, work, noise):
    """Rows of h are halved until each is decided; columns n + 1, n + 2 hold the begin and width of its interval.

    `least` is the lowest value of h met so far: what cannot be lower need not be looked at, so a disc far too large
    costs no more than a good one.
    """
    n = 2 * deg
    gap = 0.0
    least = 0.0
    top = _FIRST
    work[top, n + 1] = 0.0
    work[top, n + 2] = 1.0
    while top >= _FIRST:
        lo = work[top, n + 1]
        width = work[top, n + 2]
        low = 0.0
        hollow = 0.0
        bulge = 0.0
        for k in range(n + 1):
            if work[top, k] < low:
                low = work[top, k]
            if 0 < k < n:
                second = work[top, k - 1] - 2.0 * work[top, k] + work[top, k + 1]
                if second < bulge:
                    bulge = second
                if second > hollow:
                    hollow = second
        # the first and the last coefficient are values of h
        for end in range(2):
            value = work[top, end * n]
            if value < least + noise:
                least = value
                dx, dy = bezier_frame(cp, c0, deg, rational, lo + end * width, x, y)[:2]
                gap = min(gap, math.sqrt(dx * dx + dy * dy) - r)
        if low >= least + noise or hollow <= -noise:
            top -= 1
        elif bulge >= noise or top == _FIRST + HALVINGS:
            guess = hint if lo < hint < lo + width else lo + 0.5 * width
            distance = _bezier_foot(cp, c0, deg, rational, lo, lo + width, x, y, guess)[0]
            gap = min(gap, distance - r)
            if not rational:
                least = min(least, (distance - r) * (distance + r))
            top -= 1
        else:
            # de Casteljau in place: the left half goes on top, the right half stays
            for k in range(n + 1):
                work[top + 1, k] = work[top, 0]
                for m in range(n - k):
                    work[top, m] = 0.5 * (work[top, m] + work[top, m + 1])
            work[top, n + 1] = lo + 0.5 * width
            work[top, n + 2] = 0.5 * width
            work[top + 1, n + 1] = lo
            work[top + 1, n + 2] = 0.5 * width
            top += 1
    return gap


@inner
def _line_distance(sf, i, x, y):
    """Distance of c from a LINE."""
    lx = sf[i, X1] - sf[i, X0]
    ly = sf[i, Y1] - sf[i, Y0]
    dx = x - sf[i, X0]
    dy = y - sf[i, Y0]
    along = dx * lx + dy * ly
    if along <= 0.0:
        return math.sqrt(dx * dx + dy * dy)
    length_sq = lx * lx + ly * ly
    if along >= length_sq:
        dx = x - sf[i, X1]
        dy = y - sf[i, Y1]
        return math.sqrt(dx * dx + dy * dy)
    return abs(lx * dy - ly * dx) / math.sqrt(length_sq)


@inner
def _arc_distance(sf, i, x, y):
    """Distance of c from an ARC of less than a half turn: from its circle inside its wedge, from an end elsewhere.

    | |c - o| - rho | = | k |D|^2 - 2 n.D | / (1 + |k D - n|)  with D = c - start, which keeps its digits on flat arcs.
    """
    k = sf[i, K0]
    dx = x - sf[i, X0]
    dy = y - sf[i, Y0]
    nx = -sf[i, TY0]
    ny = sf[i, TX0]
    vx = k * dx - nx
    vy = k * dy - ny
    side = 1.0 if k > 0.0 else -1.0
    if side * (vx * sf[i, TX0] + vy * sf[i, TY0]) >= 0.0 and side * (vx * sf[i, TX1] + vy * sf[i, TY1]) <= 0.0:
        return abs(k * (dx * dx + dy * dy) - 2.0 * (nx * dx + ny * dy)) / (1.0 + math.sqrt(vx * vx + vy * vy))
    ex = x - sf[i, X1]
    ey = y - sf[i, Y1]
    return math.sqrt(min(dx * dx + dy * dy, ex * ex + ey * ey))


@inner
def _gap(si, sf, cp, i, work, binomial, x, y, r, i0, s0, i1, s1):
    """Distance of site i from c less r, as far as it is negative."""
    kind = si[i, KIND]
    if kind == LINE:
        return _line_distance(sf, i, x, y) - r
    if kind == ARC:
        return _arc_distance(sf, i, x, y) - r
    hint = s0 if i == i0 else (s1 if i == i1 else 0.5)
    return _outside_bezier(cp, si[i, CP0], si[i, DEG], si[i, RATIONAL], x - sf[i, X0], y - sf[i, Y0], r, hint, work, binomial)


@inner
def depth(si, sf, cp, order, box, stack, work, binomial, x, y, r, i0, s0, i1, s1):
    """How deep the boundary reaches into a disc: r - distance of its centre, 0 if that is not positive.

    i0, s0 and i1, s1: two sites and where the point of them nearest to the centre may be; the search there begins at it.

    order, box: from `leaf_order` and `fill_boxes`; stack (JUDGE_STACK,); work (JUDGE_ROWS, 2 d + 3) and binomial
    (2 d + 1, 2 d + 1), Pascal's triangle, for pieces of degree up to d.
    """
    if not r > 0.0:
        return 0.0
    if not r < math.inf:
        return math.inf
    n = si.shape[0]
    worst = 0.0
    stack[0] = 1
    top = 0
    while top >= 0:
        k = stack[top]
        top -= 1
        if outside(box, k, x, y, r):
            continue
        if k < n:
            stack[top + 1] = 2 * k
            stack[top + 2] = 2 * k + 1
            top += 2
            continue
        gap = _gap(si, sf, cp, order[k - n], work, binomial, x, y, r, i0, s0, i1, s1)
        if gap < worst:
            worst = gap
    return -worst


@inner
def depth_near(si, sf, cp, order, box, near, count, work, binomial, x, y, r, i0, s0, i1, s1):
    """`depth` where no boxes but the first `count` of the leaves `near` reach into the disc."""
    if not r > 0.0:
        return 0.0
    worst = 0.0
    for m in range(count):
        if outside(box, near[m], x, y, r):
            continue
        gap = _gap(si, sf, cp, order[near[m] - si.shape[0]], work, binomial, x, y, r, i0, s0, i1, s1)
        if gap < worst:
            worst = gap
    return -worst


@inner
def distance_from(si, sf, cp, i, lo, hi, guess, x, y, r, granted):
    """(off, s): how far a disc is from touching [lo, hi] of site i, |distance of its centre - r|, and the foot.

    A local foot elsewhere is not believed before others were tried, unless it is as near as is granted; `guess` is the parameter
    to begin at.
    """
    if si[i, KIND] == FAN:  # one point, wherever its foot is said to be
        dx = x - sf[i, X0]
        dy = y - sf[i, Y0]
        return abs(math.sqrt(dx * dx + dy * dy) - r), guess
    best = math.inf
    best_s = guess
    for attempt in range(RETRIES):
        distance, s = foot(si, sf, cp, i, lo, hi, x, y, guess)
        off = abs(distance - r)
        if off < best:
            best = off
            best_s = s
        if best <= max(granted, CLOSE):
            break
        guess = lo + (attempt + 0.5) / (RETRIES - 1.0) * (hi - lo)
    return best, best_s
