"""From the loops of a boundary to measured gentle pieces: boxes, lengths, areas and extents.

Coordinates, piece tables and gentle pieces as in `mat_core.kernels.outline`. Rows of `measures` (L, 6): signed AREA and LENGTH of
the control legs of a loop, normalised, and the box of the ends of its edges, LEFT, BOTTOM, RIGHT, TOP, in the caller's
coordinates.
"""

from __future__ import annotations

import math

import numpy as np

from mat_core.kernels.bezier import Floats, Ints, restrict
from mat_core.kernels.curve import bezier_frame
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.outline import CP0, CUM, DEG, LEN, NARROWEST, NOTHING, XMAX, XMIN, YMAX, YMIN, cut_gently, split_range

AREA, LENGTH, LEFT, BOTTOM, RIGHT, TOP, MEASURES = range(7)

SAME_AREA = 1e-15  # relative, of a sector and its halves
HIGHEST_EXACT = 16  # degree: 16 Gauss points integrate the area of a polynomial piece exactly

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
GAUSS_T = 0.5 + 0.5 * _NODES
GAUSS_W = 0.5 * _WEIGHTS


@jit
def draw_outline(
    use_loop: Ints,
    degree: Ints,
    cp_start: Ints,
    cp: Floats,
    knot_start: Ints,
    knots: Floats,
    loop_start: Ints,
    ox: float,
    oy: float,
    scale: float,
    moved: Floats,
    pi: Ints,
    pf: Floats,
    pcp: Floats,
    piece_start: Ints,
    measures: Floats,
    work: Floats,
    ubreaks: Floats,
    stack: Floats,
) -> int:
    """Cut the loops marked in `use_loop` (L,), control points (input - (ox, oy)) * scale, and measure them.

    Returns the number of pieces, or -1 when a buffer is too small. `moved`: room for the control points.
    """
    for row in range(cp.shape[0]):
        moved[row, 0] = (cp[row, 0] - ox) * scale
        moved[row, 1] = (cp[row, 1] - oy) * scale
        moved[row, 2] = cp[row, 2]
    n = cut_gently(
        use_loop, loop_start, degree, cp_start, moved, knot_start, knots, pi, pf, pcp, piece_start, work, ubreaks, stack
    )
    if n < 0:
        return n
    before = 0.0
    for loop in range(loop_start.shape[0] - 1):
        box_of_ends(cp_start, cp, loop_start[loop], loop_start[loop + 1], measures, loop)
        before = measure_loop(pi, pf, pcp, piece_start[loop], piece_start[loop + 1], before, stack, measures, loop)
    return n


@inner
def box_of_ends(cp_start: Ints, cp: Floats, first: int, last: int, measures: Floats, loop: int) -> None:
    """LEFT to TOP of a loop with the edges first .. last - 1."""
    measures[loop, LEFT] = measures[loop, BOTTOM] = math.inf
    measures[loop, RIGHT] = measures[loop, TOP] = -math.inf
    for e in range(first, last):
        for row in (cp_start[e], cp_start[e + 1] - 1):
            for axis in range(2):
                measures[loop, LEFT + axis] = min(measures[loop, LEFT + axis], cp[row, axis])
                measures[loop, RIGHT + axis] = max(measures[loop, RIGHT + axis], cp[row, axis])


@inner
def measure_loop(
    pi: Ints, pf: Floats, pcp: Floats, first: int, last: int, before: float, stack: Floats, measures: Floats, loop: int
) -> float:
    """AREA and LENGTH of a loop, and the columns of its pieces from XMIN on.

    `before`: length of all loops before this one; returns that length with this one's.
    """
    area = 0.0
    length = 0.0
    total = before
    for i in range(first, last):
        a = pi[i, CP0]
        b = a + pi[i, DEG]
        x0 = x1 = pcp[a, 0]
        y0 = y1 = pcp[a, 1]
        legs = 0.0
        for row in range(a + 1, b + 1):
            x = pcp[row, 0]
            y = pcp[row, 1]
            x0 = min(x0, x)
            y0 = min(y0, y)
            x1 = max(x1, x)
            y1 = max(y1, y)
            legs += math.hypot(x - pcp[row - 1, 0], y - pcp[row - 1, 1])
        pf[i, XMIN] = x0
        pf[i, YMIN] = y0
        pf[i, XMAX] = x1
        pf[i, YMAX] = y1
        pf[i, LEN] = legs
        pf[i, CUM] = total - before
        total += legs
        length += legs
        area += sector_area(pi, pcp, i, stack) + 0.5 * (pcp[a, 0] * pcp[b, 1] - pcp[a, 1] * pcp[b, 0])
    measures[loop, AREA] = area
    measures[loop, LENGTH] = length
    return total


@inner
def gauss_sector(pcp: Floats, c0: int, p: int, rational: int, t0: float, t1: float) -> float:
    """Area swept about the piece's start over [t0, t1], half the integral of x y' - y x', by 16 Gauss points."""
    total = 0.0
    for g in range(GAUSS_T.shape[0]):
        t = t0 + GAUSS_T[g] * (t1 - t0)
        x, y, dx, dy, _, _ = bezier_frame(pcp, c0, p, rational, t, pcp[c0, 0], pcp[c0, 1])
        total += GAUSS_W[g] * (x * dy - y * dx)
    return 0.5 * total * (t1 - t0)


@inner
def sector_area(pi: Ints, pcp: Floats, i: int, stack: Floats) -> float:
    """Signed area between a piece and its chord; of a polynomial at once, others are halved until the sum stays."""
    p = pi[i, DEG]
    c0 = pi[i, CP0]
    rational = 0
    for k in range(p):
        if pcp[c0 + k, 2] != pcp[c0 + p, 2]:
            rational = 1
    area = 0.0
    top = 0 if p > 1 else -1
    stack[0, 0] = 0.0
    stack[0, 1] = 1.0
    while top >= 0:
        t0 = stack[top, 0]
        t1 = stack[top, 1]
        tm = 0.5 * (t0 + t1)
        whole = gauss_sector(pcp, c0, p, rational, t0, t1)
        if rational == 1 or p > HIGHEST_EXACT:
            halves = gauss_sector(pcp, c0, p, rational, t0, tm) + gauss_sector(pcp, c0, p, rational, tm, t1)
            if abs(whole - halves) > 1e-17 + SAME_AREA * abs(halves) and t1 - t0 > 1e-9:
                split_range(stack, top, 0)
                top += 1
                continue
            whole = halves
        area += whole
        top -= 1
    return area


@jit
def extent(pi: Ints, pf: Floats, pcp: Floats, first: int, last: int, work: Floats, stack: Floats, out: Floats) -> None:
    """Tight bounds of the pieces first .. last - 1 to `out`: XMIN, YMIN, XMAX, YMAX."""
    for side in range(4):
        axis = side % 2
        sign = -1.0 if side < 2 else 1.0
        ends = -math.inf
        for i in range(first, last):
            ends = max(ends, sign * pcp[pi[i, CP0], axis])
        best = ends
        for i in range(first, last):
            # Only pieces whose control box goes farther than all ends can reach beyond them.
            if sign * pf[i, XMIN + side] > ends:
                best = farthest(pcp, pi[i, CP0], pi[i, DEG], axis, sign, best, work, stack)
        out[side] = sign * best


@inner
def farthest(
    pcp: Floats, c0: int, p: int, axis: int, sign: float, best: float, work: Floats, stack: Floats
) -> float:
    """Largest `sign` * coordinate `axis` on a piece, or `best` if that is larger: halve what reaches beyond it.

    Stops within NOTHING of the best: below it control points exceed the curve by rounding alone, on every half.
    """
    top = 0
    stack[0, 0] = 0.0
    stack[0, 1] = 1.0
    while top >= 0:
        restrict(pcp, c0, p, stack[top, 0], stack[top, 1], work, 0)
        reach = best
        for k in range(p + 1):
            value = sign * work[k, axis]
            if value > reach:
                reach = value
            if value > best and (k == 0 or k == p):
                best = value
        if reach <= best + NOTHING or stack[top, 1] - stack[top, 0] <= NARROWEST:
            top -= 1
        else:
            split_range(stack, top, 0)
            top += 1
    return best
