"""The boundary cut into gentle pieces, and what can be read off them: area, length, extent, inside or outside.

A **gentle** piece is a rational Bezier whose control legs all lie within a right angle of each other. Its direction of
travel then stays in that cone (the hodograph of a rational Bezier with positive weights is a positive combination of
its legs: Floater, CAGD 9, 1992), so it cannot meet itself, is a graph over its chord, and is at most sqrt(2) chords
long. A curve is halved until its pieces are gentle; a cusp leaves a speck of extent SPECK.

Coordinates are normalised: size in [0.5, 1] about the origin. Piece tables (written by `cut_gently`):

    pi (n, 4) int64     DEG, CP0 first control row, LOOP, EDGE
    pf (n, 8) float64   UA, UB parameter range on the edge; XMIN, YMIN, XMAX, YMAX control box; LEN length of its
                        control legs; CUM the sum of LEN from the loop's first piece to this one
"""

from __future__ import annotations

import math

import numpy as np

from mat_core.kernels.bezier import Floats, Ints, decompose, derivatives, halve, restrict
from mat_core.kernels.jit import jit

DEG, CP0, LOOP, EDGE = 0, 1, 2, 3
UA, UB, XMIN, YMIN, XMAX, YMAX, LEN, CUM = 0, 1, 2, 3, 4, 5, 6, 7

SPECK = 1e-12  # a piece this small is kept however it turns: below what counts as touching
NOTHING = 1e-15  # control legs this short have no direction: the rounding of normalised coordinates
RIGHT_ANGLE = -1e-12  # cosine accepted as "within a right angle", so that a quarter circle stays whole
BLOCK = 32  # rows set aside for one control polygon, more than the largest degree + 1
DEEPEST = 50  # halvings of a parameter range: below 2**-50 floats run out

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
GAUSS_T = 0.5 + 0.5 * _NODES
GAUSS_W = 0.5 * _WEIGHTS


@jit
def is_gentle(rows: Floats, c0: int, degree: int) -> bool:
    """Whether all control legs lie within a right angle of each other."""
    for i in range(1, degree):
        ax = rows[c0 + i + 1, 0] - rows[c0 + i, 0]
        ay = rows[c0 + i + 1, 1] - rows[c0 + i, 1]
        la = math.hypot(ax, ay)
        if la <= NOTHING:
            continue
        for j in range(i):
            bx = rows[c0 + j + 1, 0] - rows[c0 + j, 0]
            by = rows[c0 + j + 1, 1] - rows[c0 + j, 1]
            lb = math.hypot(bx, by)
            if lb > NOTHING and ax * bx + ay * by < RIGHT_ANGLE * la * lb:
                return False
    return True


@jit
def box_of(rows: Floats, c0: int, degree: int) -> tuple[float, float, float, float]:
    """Smallest and largest x and y of the control points: xmin, ymin, xmax, ymax."""
    x0 = x1 = rows[c0, 0]
    y0 = y1 = rows[c0, 1]
    for i in range(1, degree + 1):
        x = rows[c0 + i, 0]
        y = rows[c0 + i, 1]
        if x < x0:
            x0 = x
        elif x > x1:
            x1 = x
        if y < y0:
            y0 = y
        elif y > y1:
            y1 = y
    return x0, y0, x1, y1


@jit
def cut_gently(
    use_loop: Ints,
    loop_start: Ints,
    degree: Ints,
    cp_start: Ints,
    cp: Floats,
    knot_start: Ints,
    knots: Floats,
    pi: Ints,
    pf: Floats,
    pcp: Floats,
    piece_start: Ints,
    work: Floats,
    ubreaks: Floats,
    stack: Floats,
) -> int:
    """Fill the piece tables for the loops in use; returns their number, or -1 when a buffer is too small.

    Spans without extent are left out. Ends are snapped: each piece starts at the very point where the one before ended.
    """
    n = 0
    rows_used = 0
    for loop in range(loop_start.shape[0] - 1):
        piece_start[loop] = n
        if use_loop[loop] == 0:
            continue
        first = n
        cum = 0.0
        for e in range(loop_start[loop], loop_start[loop + 1]):
            p = degree[e]
            ncp = cp_start[e + 1] - cp_start[e]
            nk = knot_start[e + 1] - knot_start[e]
            spans = decompose(p, knots, knot_start[e], nk, cp, cp_start[e], ncp, work, ubreaks)
            scratch = spans * (p + 1)
            for k in range(spans):
                top = 0
                stack[0, 0] = 0.0
                stack[0, 1] = 1.0
                while top >= 0:
                    t0 = stack[top, 0]
                    t1 = stack[top, 1]
                    top -= 1
                    restrict(work, k * (p + 1), p, t0, t1, work, scratch)
                    x0, y0, x1, y1 = box_of(work, scratch, p)
                    if x1 - x0 <= NOTHING and y1 - y0 <= NOTHING:
                        continue
                    speck = x1 - x0 <= SPECK and y1 - y0 <= SPECK
                    if not speck and t1 - t0 > 0.5**DEEPEST and not is_gentle(work, scratch, p):
                        tm = 0.5 * (t0 + t1)
                        stack[top + 1, 0] = tm
                        stack[top + 1, 1] = t1
                        stack[top + 2, 0] = t0
                        stack[top + 2, 1] = tm
                        top += 2
                        continue
                    if n >= pi.shape[0] or rows_used + p + 1 > pcp.shape[0]:
                        return -1
                    length = 0.0
                    for i in range(p + 1):
                        x = work[scratch + i, 0]
                        y = work[scratch + i, 1]
                        if i == 0 and n > first:
                            x = pcp[rows_used - 1, 0]
                            y = pcp[rows_used - 1, 1]
                        pcp[rows_used + i, 0] = x
                        pcp[rows_used + i, 1] = y
                        pcp[rows_used + i, 2] = work[scratch + i, 2]
                        if i > 0:
                            length += math.hypot(x - pcp[rows_used + i - 1, 0], y - pcp[rows_used + i - 1, 1])
                    pi[n, DEG] = p
                    pi[n, CP0] = rows_used
                    pi[n, LOOP] = loop
                    pi[n, EDGE] = e
                    ua = ubreaks[k]
                    pf[n, UA] = ua + t0 * (ubreaks[k + 1] - ua)
                    pf[n, UB] = ua + t1 * (ubreaks[k + 1] - ua) if t1 < 1.0 else ubreaks[k + 1]
                    pf[n, LEN] = length
                    pf[n, CUM] = cum
                    cum += length
                    rows_used += p + 1
                    n += 1
        if n > first:
            pcp[rows_used - 1, 0] = pcp[pi[first, CP0], 0]
            pcp[rows_used - 1, 1] = pcp[pi[first, CP0], 1]
    piece_start[loop_start.shape[0] - 1] = n
    for i in range(n):
        x0, y0, x1, y1 = box_of(pcp, pi[i, CP0], pi[i, DEG])
        pf[i, XMIN] = x0
        pf[i, YMIN] = y0
        pf[i, XMAX] = x1
        pf[i, YMAX] = y1
    return n


@jit
def gauss_sector(pcp: Floats, c0: int, p: int, t0: float, t1: float) -> float:
    """Area swept about the piece's start over [t0, t1], half the integral of x y' - y x', by 16 Gauss points."""
    ox = pcp[c0, 0]
    oy = pcp[c0, 1]
    total = 0.0
    for g in range(16):
        x, y, dx, dy, _, _ = derivatives(pcp, c0, p, t0 + GAUSS_T[g] * (t1 - t0), ox, oy)
        total += GAUSS_W[g] * (x * dy - y * dx)
    return 0.5 * total * (t1 - t0)


@jit
def sector_area(pcp: Floats, c0: int, p: int, stack: Floats) -> float:
    """Signed area between a piece and its chord; exact for polynomials to degree 16, else halved until it stays."""
    polynomial = p <= 16
    for i in range(p):
        polynomial = polynomial and pcp[c0 + i, 2] == pcp[c0 + p, 2]
    if polynomial:
        return 0.0 if p == 1 else gauss_sector(pcp, c0, p, 0.0, 1.0)
    area = 0.0
    top = 0
    stack[0, 0] = 0.0
    stack[0, 1] = 1.0
    while top >= 0:
        t0 = stack[top, 0]
        t1 = stack[top, 1]
        top -= 1
        tm = 0.5 * (t0 + t1)
        whole = gauss_sector(pcp, c0, p, t0, t1)
        halves = gauss_sector(pcp, c0, p, t0, tm) + gauss_sector(pcp, c0, p, tm, t1)
        if abs(whole - halves) <= 1e-17 + 1e-15 * abs(halves) or t1 - t0 < 1e-9:
            area += halves
            continue
        stack[top + 1, 0] = tm
        stack[top + 1, 1] = t1
        stack[top + 2, 0] = t0
        stack[top + 2, 1] = tm
        top += 2
    return area


@jit
def measure(pi: Ints, pf: Floats, pcp: Floats, piece_start: Ints, stack: Floats, out: Floats) -> None:
    """Of each loop: signed area, length of its control legs, control box; out (L, 6) area, length, x0, y0, x1, y1."""
    for loop in range(piece_start.shape[0] - 1):
        area = 0.0
        length = 0.0
        x0 = y0 = math.inf
        x1 = y1 = -math.inf
        for i in range(piece_start[loop], piece_start[loop + 1]):
            a = pi[i, CP0]
            b = a + pi[i, DEG]
            area += 0.5 * (pcp[a, 0] * pcp[b, 1] - pcp[a, 1] * pcp[b, 0])
            area += sector_area(pcp, a, pi[i, DEG], stack)
            length += pf[i, LEN]
            x0 = pf[i, XMIN] if pf[i, XMIN] < x0 else x0
            y0 = pf[i, YMIN] if pf[i, YMIN] < y0 else y0
            x1 = pf[i, XMAX] if pf[i, XMAX] > x1 else x1
            y1 = pf[i, YMAX] if pf[i, YMAX] > y1 else y1
        out[loop, 0] = area
        out[loop, 1] = length
        out[loop, 2] = x0
        out[loop, 3] = y0
        out[loop, 4] = x1
        out[loop, 5] = y1


@jit
def farthest(pi: Ints, pf: Floats, pcp: Floats, first: int, last: int, axis: int, sign: float, work: Floats) -> float:
    """Largest `sign` * coordinate `axis` on pieces first .. last - 1: halve what reaches beyond the best point so far.

    Stops within NOTHING of the best: below it control points exceed the curve by rounding alone, on every half.
    """
    best = -math.inf
    for i in range(first, last):
        best = max(best, sign * pcp[pi[i, CP0], axis])
    for i in range(first, last):
        reach = sign * (pf[i, XMAX + axis] if sign > 0.0 else pf[i, XMIN + axis])
        if reach <= best:
            continue
        p = pi[i, DEG]
        depth = 0
        restrict(pcp, pi[i, CP0], p, 0.0, 1.0, work, 0)
        # Blocks 0 .. depth of `work` hold the halves still to look at, the nearest on top.
        while depth >= 0:
            c = depth * BLOCK
            best = max(best, sign * work[c, axis], sign * work[c + p, axis])
            reach = -math.inf
            for k in range(p + 1):
                reach = max(reach, sign * work[c + k, axis])
            if reach <= best + NOTHING or depth >= DEEPEST:
                depth -= 1
                continue
            halve(work, c, p, c + BLOCK, c)
            depth += 1
    return best


@jit
def is_inside(pi: Ints, pf: Floats, pcp: Floats, first: int, last: int, qx: float, qy: float, work: Floats) -> bool:
    """Whether (qx, qy) lies inside the closed chain of pieces first .. last - 1; assumes it does not lie on it.

    Crossings of the ray towards +x are counted modulo two. What lies wholly to the right of q crosses an odd number of
    times just when its ends differ in "above q"; ends are shared bit for bit, so no vertex is counted twice or missed.
    """
    odd = False
    for i in range(first, last):
        if pf[i, YMIN] > qy or pf[i, YMAX] < qy or pf[i, XMAX] < qx:
            continue
        p = pi[i, DEG]
        c0 = pi[i, CP0]
        if pf[i, XMIN] > qx:
            odd = odd != ((pcp[c0, 1] > qy) != (pcp[c0 + p, 1] > qy))
            continue
        depth = 0
        restrict(pcp, c0, p, 0.0, 1.0, work, 0)
        while depth >= 0:
            c = depth * BLOCK
            x0, y0, x1, y1 = box_of(work, c, p)
            if y0 > qy or y1 < qy or x1 < qx:
                depth -= 1
            elif x0 > qx or (x1 - x0 <= NOTHING and y1 - y0 <= NOTHING) or depth >= DEEPEST:
                odd = odd != ((work[c, 1] > qy) != (work[c + p, 1] > qy))
                depth -= 1
            else:
                halve(work, c, p, c + BLOCK, c)
                depth += 1
    return odd


@jit
def find_nesting(pi: Ints, pf: Floats, pcp: Floats, piece_start: Ints, boxes: Floats, work: Floats, nest: Ints) -> None:
    """Where each hole lies, by its first point: nest (L, 3) int64 rows inside the outer loop, around it, first hole
    around.

    `boxes` (L, 6) as written by `measure`. Loops without pieces are passed over; answers hold for loops that do not
    meet.
    """
    loops = piece_start.shape[0] - 1
    for h in range(1, loops):
        nest[h, 0] = 1
        nest[h, 1] = 0
        nest[h, 2] = -1
        first = piece_start[h]
        if first == piece_start[h + 1]:
            continue
        x = pcp[pi[first, CP0], 0]
        y = pcp[pi[first, CP0], 1]
        if piece_start[1] > 0:
            o = pi[0, CP0]
            nest[h, 0] = is_inside(pi, pf, pcp, 0, piece_start[1], x, y, work)
            nest[h, 1] = is_inside(pi, pf, pcp, first, piece_start[h + 1], pcp[o, 0], pcp[o, 1], work)
        for k in range(1, loops):
            if k == h or x < boxes[k, 2] or x > boxes[k, 4] or y < boxes[k, 3] or y > boxes[k, 5]:
                continue
            if is_inside(pi, pf, pcp, piece_start[k], piece_start[k + 1], x, y, work):
                nest[h, 2] = k
                break
