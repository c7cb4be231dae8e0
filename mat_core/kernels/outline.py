"""The boundary cut into gentle pieces.

A **gentle** piece is a rational Bezier whose control legs all lie within a right angle of each other. Its direction of
travel then stays in that cone (the hodograph of a rational Bezier with positive weights is a positive combination of
its legs: Floater, CAGD 9, 1992), so it cannot meet itself, is a graph over its chord, and is at most sqrt(2) chords
long. A curve is halved until its pieces are gentle; a cusp leaves a speck of extent SPECK.

Coordinates are normalised: size in [0.5, 1] about the origin. Piece tables (`mat_core.kernels.measuring` adds the columns
from XMIN on):

    pi (n, 4) int64     DEG, CP0 first control row, LOOP, EDGE
    pf (n, 9) float64   UA, UB parameter range on the edge; XMIN, YMIN, XMAX, YMAX control box; LEN length of its
                        control legs; CUM the sum of LEN from the loop's first piece to this one; PACE q of a line, on
                        which t counts along the chord: the edge's parameter there is UA + (UB - UA) q t / (q t + 1 - t)

A line's weights tell its pace only, and are 1 here: beside a heavy end the narrowest range would still be long.

Wherever a parameter range is subdivided, the ranges still to do lie on `stack`, one a row.
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints, decompose, restrict, unevenness
from mat_core.kernels.jit import inner

DEG, CP0, LOOP, EDGE = 0, 1, 2, 3
UA, UB, XMIN, YMIN, XMAX, YMAX, LEN, CUM, PACE = 0, 1, 2, 3, 4, 5, 6, 7, 8
PF_WIDTH = 9

SPECK = 1e-12  # a piece this small is kept however it turns: below what counts as touching
NOTHING = 1e-15  # control legs this short have no direction: the rounding of normalised coordinates
RIGHT_ANGLE = -1e-12  # cosine accepted as "within a right angle", so that a quarter circle stays whole
BLOCK = 32  # rows set aside for one control polygon, more than the largest degree + 1
NARROWEST = 0.5**50  # parameter range: below it floats run out
FASTEST = 64.0  # extent times the ratio of the weights: a piece that runs this fast is told to 1e-13 by the narrowest range

@inner
def split_range(stack: Floats, row: int, column: int) -> None:
    """The range in two columns of `row` is halved: its lower half goes to the row above, the upper half stays."""
    for c in range(stack.shape[1]):
        stack[row + 1, c] = stack[row, c]
    middle = 0.5 * (stack[row, column] + stack[row, column + 1])
    stack[row, column] = middle
    stack[row + 1, column + 1] = middle


@inner
def span_of(rows: Floats, c: int, p: int) -> float:
    """Largest distance, by coordinate, of a block's control points from its first one."""
    extent = 0.0
    for i in range(1, p + 1):
        for axis in range(2):
            d = abs(rows[c + i, axis] - rows[c, axis])
            if d > extent:
                extent = d
    return extent


@inner
def is_gentle(rows: Floats, c0: int, degree: int) -> bool:
    """Whether all control legs lie within a right angle of each other."""
    for i in range(1, degree):
        ax = rows[c0 + i + 1, 0] - rows[c0 + i, 0]
        ay = rows[c0 + i + 1, 1] - rows[c0 + i, 1]
        la = math.hypot(ax, ay)
        for j in range(i):
            bx = rows[c0 + j + 1, 0] - rows[c0 + j, 0]
            by = rows[c0 + j + 1, 1] - rows[c0 + j, 1]
            lb = math.hypot(bx, by)
            if la > NOTHING and lb > NOTHING and ax * bx + ay * by < RIGHT_ANGLE * la * lb:
                return False
    return True


@inner
def runs_fast(rows: Floats, c0: int, degree: int, extent: float) -> bool:
    """Whether a piece of this extent may run past what is near it within the narrowest range; not a line, which is its chord."""
    return degree > 1 and unevenness(rows, c0, degree) * extent > FASTEST


@inner
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
    """Fill `pi`, UA and UB of `pf` and the control rows for the loops in use; returns the number of pieces, or -1 when
    a buffer is too small.

    Spans without extent are left out. Ends are snapped: each piece starts at the very point where the one before ended.
    """
    n = 0
    used = 0
    for loop in range(loop_start.shape[0] - 1):
        first = n
        piece_start[loop] = n
        for e in range(loop_start[loop], loop_start[loop + 1] if use_loop[loop] else loop_start[loop]):
            p = degree[e]
            nk = knot_start[e + 1] - knot_start[e]
            spans = decompose(p, knots, knot_start[e], nk, cp, cp_start[e], cp_start[e + 1] - cp_start[e], work, ubreaks)
            scratch = spans * (p + 1)
            for k in range(spans):
                ua = ubreaks[k]
                ub = ubreaks[k + 1]
                top = 0
                stack[0, 0] = 0.0
                stack[0, 1] = 1.0
                while top >= 0:
                    t0 = stack[top, 0]
                    t1 = stack[top, 1]
                    restrict(work, k * (p + 1), p, t0, t1, work, scratch)
                    extent = span_of(work, scratch, p)
                    if extent > SPECK and t1 - t0 > NARROWEST and (
                            runs_fast(work, scratch, p, extent) or not is_gentle(work, scratch, p)):
                        split_range(stack, top, 0)
                        top += 1
                        continue
                    top -= 1
                    if extent <= NOTHING:
                        continue
                    if n >= pi.shape[0] or used + p + 1 > pcp.shape[0]:
                        return -1
                    for i in range(p + 1):
                        for c in range(3):
                            pcp[used + i, c] = work[scratch + i, c]
                    pf[n, PACE] = 1.0
                    if p == 1:
                        pf[n, PACE] = pcp[used, 2] / pcp[used + 1, 2]
                        pcp[used, 2] = 1.0
                        pcp[used + 1, 2] = 1.0
                    if n > first:
                        pcp[used, 0] = pcp[used - 1, 0]
                        pcp[used, 1] = pcp[used - 1, 1]
                    pi[n, DEG] = p
                    pi[n, CP0] = used
                    pi[n, LOOP] = loop
                    pi[n, EDGE] = e
                    pf[n, UA] = ua + t0 * (ub - ua)
                    pf[n, UB] = ua + t1 * (ub - ua) if t1 < 1.0 else ub
                    used += p + 1
                    n += 1
        if n > first:
            pcp[used - 1, 0] = pcp[pi[first, CP0], 0]
            pcp[used - 1, 1] = pcp[pi[first, CP0], 1]
    piece_start[loop_start.shape[0] - 1] = n
    return n
