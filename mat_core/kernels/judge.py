"""Distances to the boundary, for the certificate: how deep anything reaches into a disc.

Nothing here relies on curvature being monotone, nor on the tree and the tangent-circle search that found the axis: a
Bezier piece is shown to stay outside a disc of centre c and radius r by the signs of

    h(s) = |q(s)|^2 - r^2 w(s)^2,    q = w (C - c)        (homogeneous, so polynomial for rational pieces as well)

in Bernstein form; C and c are relative to the piece's start. Coefficients without a negative one prove it; a convex row
(second differences not negative) has one minimum, found by bracketed Newton; any other row is halved.
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import bezier_frame
from mat_core.kernels.jit import inner
from mat_core.kernels.judge_boxes import outside
from mat_core.kernels.judge_foot import bezier_foot
from mat_core.kernels.layout import ARC, CP0, DEG, K0, KIND, LINE, RATIONAL, TX0, TX1, TY0, TY1, X0, X1, Y0, Y1

JUDGE_STACK = 128  # depth of the walk through the tree of boxes
HALVINGS = 40  # deepest subdivision of one piece; 2^-40 of it is far below every limit
JUDGE_ROWS = HALVINGS + 6  # rows of the scratch table: three of points, then the stack
_QX, _QY, _QW, _FIRST = 0, 1, 2, 3
NOISE = 4e-15  # rounding of a coefficient of h, relative to the largest |q|^2
RATIONAL_ROUNDS = 12  # discs tried on a rational piece that reaches far inside


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
            distance = bezier_foot(cp, c0, deg, rational, lo, lo + width, x, y, guess)[0]
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
