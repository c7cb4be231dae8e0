"""Where the curvature of a Bezier turns from rising to falling, and whether it is constant.

With homogeneous (X, Y, w), a = X'w - Xw', b = Y'w - Yw', q = a^2 + b^2 and D = det[A, A', A''] the curvature is
k = D w^3 / q^(3/2), and k' has the sign of

    N = (D' w + 3 D w') q - 3 D w (a a' + b b'),        D' = det[A, A', A'''],  a' = X''w - Xw'

(polynomial: N = (C' x C''') |C'|^2 - 3 (C' x C'') (C'.C'')), whose sign changes are isolated in Bernstein form. Points of zero
speed are among them. Near these N is smaller than elsewhere by many digits: parts of the Bezier are looked at by themselves
until none has coefficients that drown in the rounding of others.
"""

from __future__ import annotations

import math

from mat_core.boundary.bends import curvature_at
from mat_core.boundary.parts import SHORT, SMALLEST_PART, extent, place_part
from mat_core.kernels.bernstein import add_product, clear_row, first_sign, last_sign, scale_row, sign_changes
from mat_core.kernels.curve import bezier_frame
from mat_core.kernels.jit import inner

FAINT = 1e-8  # share of the largest coefficient of N below which one has lost half of its digits
SCRATCH_ROWS = 24
_X, _Y, _W, _X1, _Y1, _W1, _X2, _Y2, _W2, _X3, _Y3, _W3 = range(12)
_T0, _T1, _DET, _DETD, _A, _B, _AD, _BD, _Q, _S, _N = range(12, 23)


def scratch_width(max_degree: int) -> int:
    """Length of a scratch row for the numerator of k' of a rational Bezier of this degree."""
    return 8 * max_degree + 2


@inner
def _derivatives(cp, c0, deg, rational, table):
    """Scaled Bernstein rows of X, Y, w and three derivatives, about the first control point."""
    for i in range(deg + 1):
        w = cp[c0 + i, 2] if rational else 1.0
        table[_X, i] = (cp[c0 + i, 0] - cp[c0, 0]) * w
        table[_Y, i] = (cp[c0 + i, 1] - cp[c0, 1]) * w
        table[_W, i] = w
    for order in range(3):
        n = deg - order
        for axis in range(3):
            source = 3 * order + axis
            for i in range(n):
                table[source + 3, i] = n * (table[source, i + 1] - table[source, i])
    for order in range(4):
        if deg - order >= 0:
            for axis in range(3):
                scale_row(table, 3 * order + axis, deg - order, True)


@inner
def _determinant(table, d, higher, out):
    """out = det[A, A', A^(h)] for the derivative rows starting at `higher` (of degree d - h)."""
    n1 = d - 1
    nh = d - higher // 3
    for axis in range(3):
        u = (axis + 1) % 3
        v = (axis + 2) % 3
        clear_row(table, _T0, n1 + nh)
        add_product(table, _X1 + u, n1, higher + v, nh, _T0, 1.0)
        add_product(table, _X1 + v, n1, higher + u, nh, _T0, -1.0)
        add_product(table, _X + axis, d, _T0, n1 + nh, out, 1.0)


@inner
def _at_cusp(cp, c0, deg, rational, s):
    """The zero of the speed near s, if there is one: there N has a triple zero, C'.C'' a simple one.

    A curve that hardly moves at an end may have a peak of its curvature beside that; beside a cusp the curvature has none.
    """
    at = s
    largest = 0.0
    for _ in range(6):
        x, y, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, at, 0.0, 0.0)
        curve = x2 * x2 + y2 * y2
        if curve == 0.0:
            return s
        largest = max(largest, math.sqrt(curve))
        at -= (x1 * x2 + y1 * y2) / curve
        if abs(at - s) > 1e-3:
            return s
    x, y, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, at, 0.0, 0.0)
    if not 0.0 < at < 1.0 or math.sqrt(x1 * x1 + y1 * y1) > 1e-11 * largest:
        return s
    inner_k = curvature_at(cp, c0, deg, rational, at + 0.5 * (s - at))
    k = curvature_at(cp, c0, deg, rational, s)
    outer_k = curvature_at(cp, c0, deg, rational, min(max(at + 2.0 * (s - at), 0.0), 1.0))
    return s if (k - inner_k) * (k - outer_k) > 0.0 else at


@inner
def _numerator(cp, c0, deg, rational, table):
    """Bernstein coefficients of N to table[_N]; their degree."""
    d = deg
    _derivatives(cp, c0, deg, rational, table)
    if not rational:
        clear_row(table, _DET, 2 * d)
        add_product(table, _X1, d - 1, _Y2, d - 2, _DET, 1.0)
        add_product(table, _Y1, d - 1, _X2, d - 2, _DET, -1.0)
        clear_row(table, _DETD, 2 * d)
        if d >= 3:
            add_product(table, _X1, d - 1, _Y3, d - 3, _DETD, 1.0)
            add_product(table, _Y1, d - 1, _X3, d - 3, _DETD, -1.0)
        clear_row(table, _Q, 2 * d)
        add_product(table, _X1, d - 1, _X1, d - 1, _Q, 1.0)
        add_product(table, _Y1, d - 1, _Y1, d - 1, _Q, 1.0)
        clear_row(table, _S, 2 * d)
        add_product(table, _X1, d - 1, _X2, d - 2, _S, 1.0)
        add_product(table, _Y1, d - 1, _Y2, d - 2, _S, 1.0)
        n = 4 * d - 6
        clear_row(table, _N, n)
        if d >= 3:
            add_product(table, _DETD, 2 * d - 4, _Q, 2 * d - 2, _N, 1.0)
        add_product(table, _DET, 2 * d - 3, _S, 2 * d - 3, _N, -3.0)
    else:
        clear_row(table, _DET, 3 * d)
        _determinant(table, d, _X2, _DET)
        clear_row(table, _DETD, 3 * d)
        if d >= 3:
            _determinant(table, d, _X3, _DETD)
        for axis in range(2):
            clear_row(table, _A + axis, 2 * d)
            add_product(table, _X1 + axis, d - 1, _W, d, _A + axis, 1.0)
            add_product(table, _X + axis, d, _W1, d - 1, _A + axis, -1.0)
            clear_row(table, _AD + axis, 2 * d)
            add_product(table, _X2 + axis, d - 2, _W, d, _AD + axis, 1.0)
            add_product(table, _X + axis, d, _W2, d - 2, _AD + axis, -1.0)
        clear_row(table, _Q, 4 * d)
        clear_row(table, _S, 4 * d)
        for axis in range(2):
            add_product(table, _A + axis, 2 * d - 1, _A + axis, 2 * d - 1, _Q, 1.0)
            add_product(table, _A + axis, 2 * d - 1, _AD + axis, 2 * d - 2, _S, 1.0)
        clear_row(table, _T0, 4 * d)
        if d >= 3:
            add_product(table, _DETD, 3 * d - 4, _W, d, _T0, 1.0)
        add_product(table, _DET, 3 * d - 3, _W1, d - 1, _T0, 3.0)
        clear_row(table, _T1, 4 * d)
        add_product(table, _DET, 3 * d - 3, _W, d, _T1, 1.0)
        n = 8 * d - 6
        clear_row(table, _N, n)
        add_product(table, _T0, 4 * d - 4, _Q, 4 * d - 2, _N, 1.0)
        add_product(table, _T1, 4 * d - 3, _S, 4 * d - 3, _N, -3.0)
    scale_row(table, _N, n, False)
    return n


@inner
def _is_faint(table, n):
    """Whether two coefficients of N in a row are so small, and not zero, that their signs may be the rounding of others."""
    largest = 0.0
    for i in range(n + 1):
        largest = max(largest, abs(table[_N, i]))
    before = False
    for i in range(n + 1):
        faint = 0.0 < abs(table[_N, i]) < FAINT * largest
        if faint and before:
            return True
        before = faint
    return False


@inner
def curvature_changes(cp, c0, deg, rational, free, rounding, table, work, bounds, roots):
    """Write the parameters in (0, 1) where the curvature of a Bezier turns from rising to falling or back; their number.

    Rows of `cp` from `free` on are scratch; -1 if there are too few.
    """
    if free + deg + 1 > cp.shape[0]:
        return -1
    count = 0
    sign = 0.0
    begin = 0.0
    step = 1.0
    while begin < 1.0:
        end = min(begin + step, 1.0)
        part = c0
        if step < 1.0:
            part = free
            place_part(cp, c0, deg, rational, begin, end, table, free)
        n = _numerator(cp, part, deg, rational, table)
        if step > SMALLEST_PART and _is_faint(table, n) and extent(cp, part, deg) > SHORT * rounding:
            step *= 0.5
            continue
        # a change may lie right between two parts
        if sign * first_sign(table, _N, n) < 0.0 and count < roots.shape[0]:
            roots[count] = begin
            count += 1
        first = count
        count = sign_changes(table, _N, n, work, bounds, roots, count)
        for i in range(first, count):
            roots[i] = begin + roots[i] * (end - begin)
        last = last_sign(table, _N, n)
        sign = last if last != 0.0 else sign
        begin = end
        step *= 2.0
    for i in range(count):
        roots[i] = _at_cusp(cp, c0, deg, rational, roots[i])
    return count


@inner
def circle_of(cp, c0, deg, rounding, table):
    """(curvature, centre x, centre y) if the rational Bezier is a circular arc up to rounding, else curvature 0.

    The circle through the ends and the middle is compared in Bernstein form: F = |A - c w|^2 - R^2 w^2 vanishes identically.
    """
    mx, my, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, 1, 0.5, cp[c0, 0], cp[c0, 1])
    ex = cp[c0 + deg, 0] - cp[c0, 0]
    ey = cp[c0 + deg, 1] - cp[c0, 1]
    if ex * ex + ey * ey < mx * mx + my * my:  # more than a half circle, or closed: use quarter points instead
        ex, ey, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, 1, 0.25, cp[c0, 0], cp[c0, 1])
    cross = mx * ey - my * ex
    mm = mx * mx + my * my
    ee = ex * ex + ey * ey
    if abs(cross) <= 1e-6 * mm:  # a radius over some 1e5 chords: kept as a spiral
        return 0.0, 0.0, 0.0
    cx = 0.5 * (mm * ey - ee * my) / cross
    cy = 0.5 * (ee * mx - mm * ex) / cross
    radius_sq = cx * cx + cy * cy
    radius = math.sqrt(radius_sq)
    for i in range(deg + 1):
        w = cp[c0 + i, 2]
        table[_X, i] = (cp[c0 + i, 0] - cp[c0, 0] - cx) * w
        table[_Y, i] = (cp[c0 + i, 1] - cp[c0, 1] - cy) * w
        table[_W, i] = w
    for axis in range(3):
        scale_row(table, axis, deg, True)
    clear_row(table, _N, 2 * deg)
    add_product(table, _X, deg, _X, deg, _N, 1.0)
    add_product(table, _Y, deg, _Y, deg, _N, 1.0)
    add_product(table, _W, deg, _W, deg, _N, -radius_sq)
    clear_row(table, _T0, 2 * deg)
    add_product(table, _W, deg, _W, deg, _T0, 1.0)
    for i in range(2 * deg + 1):
        if abs(table[_N, i]) > 2.0 * radius * rounding * table[_T0, i]:
            return 0.0, 0.0, 0.0
    x, y, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, 1, 0.5, 0.0, 0.0)
    turn = 1.0 if x1 * y2 - y1 * x2 > 0.0 else -1.0
    return turn / radius, cp[c0, 0] + cx, cp[c0, 1] + cy
