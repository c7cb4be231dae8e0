"""Loops as polygons: points on gentle pieces, as many as a wanted error needs, and the error that is left.

A chord of C over a stretch h of its parameter strays from it by at most h**2 / 8 max |C''|. With X = sum B_j w_j Q_j and
W = sum B_j w_j about the first control point (Q_j = P_j - P_0, d = max |Q_j|, weights scaled to at most 1):

    |C'| <= c1 = (p max |D(wQ)| + p max |Dw| d) / min w
    |C''| <= (p (p - 1) max |D2(wQ)| + 2 p max |Dw| c1 + p (p - 1) max |D2 w| d) / min w

D and D2 being first and second differences over j. Exact for parabolas, some five times too large for a quarter circle.

Coordinates and piece tables as in `mat_core.kernels.outline`.
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.outline import BLOCK, CP0, DEG

FEWEST_CHORDS = 2  # of a curve, so that two curves make a ring


@inner
def bend_bound(pcp: Floats, c0: int, p: int) -> float:
    """A bound of |C''| on a piece of degree p >= 2."""
    most = least = pcp[c0, 2]
    for j in range(1, p + 1):
        most = max(most, pcp[c0 + j, 2])
        least = min(least, pcp[c0 + j, 2])
    far = turn = turning = leg = bend = 0.0
    dx = dy = dw = 0.0
    for j in range(p):
        x = pcp[c0 + j, 0] - pcp[c0, 0]
        y = pcp[c0 + j, 1] - pcp[c0, 1]
        w = pcp[c0 + j, 2] / most
        next_x = pcp[c0 + j + 1, 0] - pcp[c0, 0]
        next_y = pcp[c0 + j + 1, 1] - pcp[c0, 1]
        next_w = pcp[c0 + j + 1, 2] / most
        before_x = dx
        before_y = dy
        before_w = dw
        dx = next_w * next_x - w * x
        dy = next_w * next_y - w * y
        dw = next_w - w
        far = max(far, math.hypot(next_x, next_y))
        leg = max(leg, math.hypot(dx, dy))
        turn = max(turn, abs(dw))
        if j > 0:
            bend = max(bend, math.hypot(dx - before_x, dy - before_y))
            turning = max(turning, abs(dw - before_w))
    least /= most
    speed = p * (leg + turn * far) / least
    return (p * (p - 1) * (bend + turning * far) + 2.0 * p * turn * speed) / least


@inner
def place_point(pcp: Floats, c0: int, p: int, t: float, points: Floats, n: int) -> None:
    """Row n of `points` becomes the point at t, by Horner's scheme over sum C(p, j) (1 - t)^(p - j) t^j w_j P_j."""
    s = 1.0 - t
    factor = 1.0
    w = pcp[c0, 2]
    x = w * pcp[c0, 0]
    y = w * pcp[c0, 1]
    for j in range(1, p + 1):
        factor *= t * (p - j + 1) / j
        weight = factor * pcp[c0 + j, 2]
        x = x * s + weight * pcp[c0 + j, 0]
        y = y * s + weight * pcp[c0 + j, 1]
        w = w * s + weight
    points[n, 0] = x / w
    points[n, 1] = y / w


@jit
def flatten_loops(
    pi: Ints,
    pcp: Floats,
    piece_start: Ints,
    loops: Ints,
    wanted: float,
    most: int,
    bend: Floats,
    worst: Floats,
    points: Floats,
    ring: Ints,
    error: Floats,
) -> int:
    """Fill `points` with the corners of the polygons of these loops, `ring` with each one's place among them, `error` (K,).

    Returns the number of points. All curves of one degree get as many chords, so that none strays by more than `wanted`, but no
    more than `most`. Room: a number of each piece, `bend`, and of each degree, `worst` (BLOCK,); `most` points a piece.
    """
    for p in range(BLOCK):
        worst[p] = 0.0
    for k in range(loops.shape[0]):
        for i in range(piece_start[loops[k]], piece_start[loops[k] + 1]):
            p = pi[i, DEG]
            bend[i] = bend_bound(pcp, pi[i, CP0], p) if p > 1 else 0.0
            worst[p] = max(worst[p], bend[i])
    n = 0
    for k in range(loops.shape[0]):
        error[k] = 0.0
        for i in range(piece_start[loops[k]], piece_start[loops[k] + 1]):
            p = pi[i, DEG]
            chords = 1
            if p > 1:
                # Extreme weights make the bound infinite.
                chords = max(FEWEST_CHORDS, math.ceil(math.sqrt(min(worst[p] / (8.0 * wanted), float(most * most)))))
            error[k] = max(error[k], bend[i] / (8.0 * chords * chords))
            points[n, 0] = pcp[pi[i, CP0], 0]
            points[n, 1] = pcp[pi[i, CP0], 1]
            for c in range(1, chords):
                place_point(pcp, pi[i, CP0], p, c / chords, points, n + c)
            for c in range(chords):
                ring[n + c] = k
            n += chords
    return n
