"""Curves of all strips, piece by piece: conics where the sides allow, else polynomials with a bounded error.

Strips come in order and direction of travel. Where both sides of one run on in the next along the same curve (the disc between
them touches where a Bezier was cut, not where it ends), the axis is as smooth there as anywhere: such strips are one *stretch*,
and a polynomial may pass from one into the next. Joints of the boundary, where its curvature jumps, stay ends of pieces.

    stretch:   P --------o-------- o ---------- Q        o: discs between strips, exact, known beforehand
    pieces:    P ----------x-------x----------- Q        an interval that fails is cut: at the disc nearest to its middle,
                                                         or in one strip at an end of the equal parts it is expected to need

Cutting ends at a chord that is short for the tolerance, at neighbouring floats, and at MAX_PIECES. A strip whose sides
do not belong together, or whose end discs do not belong to its sides, cannot be followed; it is given up (NO_FIT).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.conics import K_FREEFORM, MAX_TURN, conic, conic_kind, is_conic, swing
from mat_core.curves.interval import (
    I_ROW,
    I_S,
    I_TX,
    I_X,
    MAX_STRIPS,
    PLAN_S0,
    PLAN_S1,
    PLAN_T,
    ROWS,
    STACK_COLUMNS,
    STACK_ROWS,
    WAY_HI,
    WAY_LO,
    WAY_PARTNER,
    WAY_S0,
    WAY_S1,
    WAY_SITE,
    attempt,
    plan,
    sample_at,
    write_fit,
)
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import EDGE, FAN, KIND, LEN, LINE, LOOP, SPAN, SPIRAL, SWEEP, V0, V1
from mat_core.tracing.strip import trace

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

# columns of the tables of pieces and of their parts, one for each strip a piece passes
P_PART, P_DEGREE, P_KIND = range(3)  # piece_i; P_PART: its first part
P_ERROR, P_LENGTH = range(2)  # piece_f, normalised
Q_ROW, Q_SIDE = range(2)  # part_i; Q_SIDE 0: s is on the right site of the strip in row Q_ROW, 1: on its left one
Q_T0, Q_T1, Q_S0, Q_S1 = range(4)  # part_f: the piece's own parameter and s, at the part's start and end

TINY = 1e-11  # a chord this short is not cut any more, nor is an interval this short relative to the whole one
SHORT = 0.25  # nor is a chord this short relative to the tolerance: drawn straight it is near enough
LOST = 1e-9  # largest error, other than the tolerance, at which cutting may end; more is a jump, not rounding
MAX_PIECES = 256  # of one stretch; smooth ones need far fewer at any tolerance
MAX_PARTS = 4  # equal parts an interval is expected to need, at most: the forecast reaches no further
NO_ROOM = -1  # status: the piece tables are too small
NO_FIT = -2  # status: a strip cannot be followed
CLOSED_FORM_BONUS = 0.1  # sample a free-form side unless it is this much shorter than a closed one: a cheap partner
PARALLEL = 1e-9  # |n1 - n2| below which two normals at one vertex are one


@inner
def _goes_on(si: Ints, i: int, j: int) -> bool:
    """Whether site j is i or the next part of the same Bezier."""
    if i == j:
        return True
    cut = si[i, KIND] == SPIRAL and si[j, KIND] == SPIRAL
    return bool(cut and si[i, LOOP] == si[j, LOOP] and si[i, EDGE] == si[j, EDGE] and si[i, SPAN] == si[j, SPAN])


@jit
def travel(
    si: Ints, skeleton_i: Ints, skeleton_s: Floats, run_start: Ints, run_strip: Ints, run_forward: Flags, strip_i: Ints,
    strip_s: Floats, joined: Flags,
) -> None:
    """Rows of `strip_i` and `strip_s`: the strips of all runs one after the other, each in the direction of travel.

    joined: the strip goes on where the one before it ends, along one analytic curve on either side.
    """
    for g in range(run_start.shape[0] - 1):
        for w in range(run_start[g], run_start[g + 1]):
            strip = run_strip[w]
            for m in range(4):
                # backwards left becomes right, the last disc the first, and either side is passed from its other end
                strip_i[w, m] = skeleton_i[strip, m if run_forward[w] else m ^ 1]
                strip_s[w, m] = skeleton_s[strip, m if run_forward[w] else 3 - m]
            joined[w] = False
            if w > run_start[g]:
                joined[w] = _goes_on(si, strip_i[w - 1, 0], strip_i[w, 0]) and _goes_on(si, strip_i[w - 1, 1], strip_i[w, 1])


@inner
def tangent(
    si: Ints, sf: Floats, cp: Floats, a: int, sa: float, b: int, sb: float, r: float, sign: float
) -> tuple[float, float, float]:
    """Direction (x, y, r) of the axis at the disc of radius r with contacts sa on the right and sb on the left site.

    `sign` is 1 where a strip leaves, -1 where it arrives; it matters at a centre of curvature only.
    """
    x, y, ax, ay, k, speed = evaluate(si, sf, cp, a, sa, 0.0, 0.0)
    x, y, bx, by, k, speed = evaluate(si, sf, cp, b, sb, 0.0, 0.0)
    # n1 - n2 = (by - ay, ax - bx), turned by -90 degrees
    tx = ax - bx
    ty = ay - by
    length = math.sqrt(tx * tx + ty * ty)
    vertex_a = si[a, V0] if sa <= 0.0 else (si[a, V1] if sa >= 1.0 else -1)
    vertex_b = si[b, V0] if sb <= 0.0 else (si[b, V1] if sb >= 1.0 else -2)
    if vertex_a == vertex_b and (r > 0.0 or length <= PARALLEL) or length == 0.0:
        return -sign * ay, sign * ax, sign
    tx /= length
    ty /= length
    return tx, ty, ty * ax - tx * ay


@inner
def _travel(si: Ints, sf: Floats, i: int, s0: float, s1: float, r0: float, r1: float) -> float:
    """How far the disc rolls along a side, roughly."""
    if si[i, KIND] == FAN:
        return abs(sf[i, SWEEP] * (s1 - s0)) * 0.5 * (r0 + r1)
    return abs(sf[i, LEN] * (s1 - s0))


@inner
def _choose_side(si: Ints, sf: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, w: int) -> int:
    """The side to sample through: the longer travel; free-form against closed form is preferred for its speed."""
    a = strip_i[w, 0]
    b = strip_i[w, 1]
    r0 = disc[strip_i[w, 2], 2]
    r1 = disc[strip_i[w, 3], 2]
    along_a = _travel(si, sf, a, strip_s[w, 0], strip_s[w, 1], r0, r1)
    along_b = _travel(si, sf, b, strip_s[w, 2], strip_s[w, 3], r0, r1)
    if si[a, KIND] == SPIRAL and si[b, KIND] != SPIRAL:
        along_b *= CLOSED_FORM_BONUS
    elif si[b, KIND] == SPIRAL and si[a, KIND] != SPIRAL:
        along_a *= CLOSED_FORM_BONUS
    return 0 if along_a >= along_b else 1


@inner
def _lay_way(strip_i: Ints, strip_s: Floats, w: int, side: int, way_i: Ints, way_f: Floats) -> None:
    """Row w of the way: its strip, sampled through its right (0) or left (1) site."""
    way_i[w, WAY_SITE] = strip_i[w, side]
    way_i[w, WAY_PARTNER] = strip_i[w, 1 - side]
    way_f[w, WAY_S0] = strip_s[w, 2 * side]
    way_f[w, WAY_S1] = strip_s[w, 2 * side + 1]
    way_f[w, WAY_LO] = strip_s[w, 3 if side == 0 else 0]
    way_f[w, WAY_HI] = strip_s[w, 2 if side == 0 else 1]


@inner
def _polygon_length(cp: Floats, row: int, degree: int) -> float:
    """Between the chord and the control polygon, in (x, y): (2 chord + (n - 1) polygon) / (n + 1) (Gravesen 1997)."""
    polygon = 0.0
    for k in range(degree):
        polygon += math.hypot(cp[row + k + 1, 0] - cp[row + k, 0], cp[row + k + 1, 1] - cp[row + k, 1])
    chord = math.hypot(cp[row + degree, 0] - cp[row, 0], cp[row + degree, 1] - cp[row, 1])
    return (2.0 * chord + (degree - 1.0) * polygon) / (degree + 1.0)


@inner
def _add_part(
    piece_i: Ints, part_i: Ints, part_f: Floats, p: int, more: int, row: int, side: int, t0: float, t1: float, s0: float,
    s1: float,
) -> None:
    """Part number `more` of piece p; parts of the next piece begin behind it."""
    q = piece_i[p, P_PART] + more
    part_i[q, Q_ROW] = row
    part_i[q, Q_SIDE] = side
    part_f[q, Q_T0] = t0
    part_f[q, Q_T1] = t1
    part_f[q, Q_S0] = s0
    part_f[q, Q_S1] = s1
    piece_i[p + 1, P_PART] = q + 1


@inner
def _conic_strip(
    si: Ints, sf: Floats, cp: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, w: int, p0: Floats, p2: Floats,
    way_i: Ints, way_f: Floats, piece_i: Ints, piece_f: Floats, piece_cp: Floats, part_i: Ints, part_f: Floats, count: int,
) -> int:
    """Pieces of a strip between lines, arcs and points; returns the new number of pieces or a status."""
    a = strip_i[w, 0]
    b = strip_i[w, 1]
    turn_a = swing(si, sf, a) * (strip_s[w, 1] - strip_s[w, 0])
    turn_b = swing(si, sf, b) * (strip_s[w, 3] - strip_s[w, 2])
    both_lines = si[a, KIND] == LINE and si[b, KIND] == LINE
    share = 0.5 * abs(turn_a + turn_b) / MAX_TURN
    if not share < MAX_PIECES:
        return NO_FIT
    pieces = 1 + int(share)
    side = 0 if abs(turn_a) >= abs(turn_b) or both_lines else 1
    _lay_way(strip_i, strip_s, w, side, way_i, way_f)
    s0 = way_f[w, WAY_S0]
    s1 = way_f[w, WAY_S1]
    if count + pieces >= piece_i.shape[0]:
        return NO_ROOM
    for m in range(3):
        p0[m] = disc[strip_i[w, 2], m]
    before = s0
    for piece in range(pieces):
        after = s1
        if piece == pieces - 1:
            for m in range(3):
                p2[m] = disc[strip_i[w, 3], m]
        else:
            after = s0 + (s1 - s0) * (piece + 1.0) / pieces
            p2[0], p2[1], p2[2], sj, dx, dy, dr = trace(
                si, sf, cp, way_i[w, WAY_SITE], after, way_i[w, WAY_PARTNER], way_f[w, WAY_LO], way_f[w, WAY_HI])
        piece_i[count, P_DEGREE] = 1 if both_lines else 2
        piece_i[count, P_KIND] = conic_kind(si, sf, a, b)
        row = ROWS * count
        error = 0.0
        if both_lines:
            for m in range(3):
                piece_cp[row, m] = p0[m]
                piece_cp[row + 1, m] = p2[m]
            piece_cp[row, 3] = 1.0
            piece_cp[row + 1, 3] = 1.0
        else:
            error = conic(si, sf, a, b, p0, p2, piece_cp, row)
        piece_f[count, P_ERROR] = error
        piece_f[count, P_LENGTH] = _polygon_length(piece_cp, row, piece_i[count, P_DEGREE])
        _add_part(piece_i, part_i, part_f, count, 0, w, side, 0.0, 1.0, before, after)
        count += 1
        before = after
        for m in range(3):
            p0[m] = p2[m]
    return count


@inner
def _put_end(
    stack: Floats, row: int, w: int, s: float, x: float, y: float, r: float, t: tuple[float, float, float]
) -> None:
    """One end of an interval."""
    stack[row, I_S] = s
    stack[row, I_X] = x
    stack[row, I_X + 1] = y
    stack[row, I_X + 2] = r
    stack[row, I_TX] = t[0]
    stack[row, I_TX + 1] = t[1]
    stack[row, I_TX + 2] = t[2]
    stack[row, I_ROW] = w


@inner
def _put_disc(
    si: Ints, sf: Floats, cp: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, way_f: Floats, w: int, end: int,
    stack: Floats, row: int,
) -> None:
    """End of an interval at the disc where the strip of row w starts (0) or ends (1)."""
    d = strip_i[w, 2 + end]
    t = tangent(si, sf, cp, strip_i[w, 0], strip_s[w, end], strip_i[w, 1], strip_s[w, 2 + end], disc[d, 2],
                -1.0 if end else 1.0)
    _put_end(stack, row, w, way_f[w, WAY_S1 if end else WAY_S0], disc[d, 0], disc[d, 1], disc[d, 2], t)


@inner
def _cut_at_disc(
    si: Ints, sf: Floats, cp: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, way_f: Floats, stack: Floats,
    top: int, steps: Floats,
) -> None:
    """Cut an interval of several strips at the disc nearest to its middle; the far part waits below."""
    first = int(stack[2 * top, I_ROW])
    last = int(stack[2 * top + 1, I_ROW])
    best = first + (last - first + 1) // 2
    if last - first < MAX_STRIPS:
        for w in range(first + 1, last + 1):
            if abs(steps[w - first, PLAN_T] - 0.5) < abs(steps[best - first, PLAN_T] - 0.5):
                best = w
    for c in range(STACK_COLUMNS):
        stack[2 * top + 2, c] = stack[2 * top, c]
    _put_disc(si, sf, cp, disc, strip_i, strip_s, way_f, best, 0, stack, 2 * top)
    for c in range(STACK_COLUMNS):
        stack[2 * top + 3, c] = stack[2 * top, c]
    stack[2 * top + 3, I_ROW] = best - 1
    stack[2 * top + 3, I_S] = way_f[best - 1, WAY_S1]


@inner
def _cut_at_sample(
    si: Ints, sf: Floats, cp: Floats, strip_i: Ints, side: int, stack: Floats, top: int, samples: Floats, row: int
) -> None:
    """Cut an interval of one strip at a sample; the far part waits below."""
    w = int(stack[2 * top, I_ROW])
    s = samples[row, 4]
    sj = samples[row, 5]
    t = tangent(si, sf, cp, strip_i[w, 0], s if side == 0 else sj, strip_i[w, 1], sj if side == 0 else s, samples[row, 3], 1.0)
    for c in range(STACK_COLUMNS):
        stack[2 * top + 2, c] = stack[2 * top, c]
    _put_end(stack, 2 * top, w, s, samples[row, 1], samples[row, 2], samples[row, 3], t)
    _put_end(stack, 2 * top + 3, w, s, samples[row, 1], samples[row, 2], samples[row, 3], t)


@inner
def _straight(samples: Floats, row: int, m: int, stack: Floats, top: int, out: Floats, to: int) -> float:
    """The last resort on a tiny interval: the chord itself; returns its error.

    That is how far the sample in `row` is from it, and its length where that could be a jump of the axis.
    """
    off = 0.0
    dd = 0.0
    t = min(max(samples[row, 0], 0.0), 1.0)
    for c in range(3):
        p = stack[2 * top, I_X + c]
        q = stack[2 * top + 1, I_X + c]
        for k in range(m + 4):
            f = k / (m + 3.0)
            out[to + k, c] = (1.0 - f) * p + f * q
            out[to + k, 3] = 1.0
        gap = samples[row, 1 + c] - ((1.0 - t) * p + t * q)
        off += gap * gap
        dd += (q - p) * (q - p)
    return max(math.sqrt(2.0 * off), math.sqrt(dd) if dd > LOST * LOST else 0.0)


@inner
def _free_stretch(
    si: Ints, sf: Floats, cp: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, begin: int, end: int, flip: int,
    tolerance: float, m: int, stack: Floats, samples: Floats, hermite: Floats, newton: Floats, misses: Floats,
    points: Floats, steps: Floats, work: Floats, way_i: Ints, way_f: Floats, piece_i: Ints, piece_f: Floats,
    piece_cp: Floats, part_i: Ints, part_f: Floats, count: int,
) -> int:
    """Pieces of the strips in rows begin .. end - 1, in order of travel; returns their new number or a status.

    With `flip` each strip is sampled through the other side.
    """
    for w in range(begin, end):
        side = _choose_side(si, sf, disc, strip_i, strip_s, w)
        _lay_way(strip_i, strip_s, w, 1 - side if flip else side, way_i, way_f)
    spare = 2 * m + 3
    top = int(np.int64(0))  # not a literal: each literal would be compiled for once more
    _put_disc(si, sf, cp, disc, strip_i, strip_s, way_f, begin, 0, stack, top)
    _put_disc(si, sf, cp, disc, strip_i, strip_s, way_f, end - 1, 1, stack, top + 1)
    pieces = count
    while top >= 0:
        w = int(stack[2 * top, I_ROW])
        strips = int(stack[2 * top + 1, I_ROW]) - w + 1
        if pieces + 1 >= piece_i.shape[0]:
            return NO_ROOM
        if pieces - count + top >= MAX_PIECES:
            return NO_FIT
        error = math.inf
        even = False
        if strips <= MAX_STRIPS:
            even = plan(si, sf, cp, way_i, way_f, disc, strip_i, stack, top, samples, spare, steps)
        if even:
            error = attempt(si, sf, cp, way_i, way_f, stack, top, m, tolerance, samples, hermite, newton, misses, points, steps)
        if not error <= tolerance and strips > 1:
            _cut_at_disc(si, sf, cp, disc, strip_i, strip_s, way_f, stack, top, steps)
            top += 1
            continue
        s0 = stack[2 * top, I_S]
        s1 = stack[2 * top + 1, I_S]
        tiny = False
        if not error <= tolerance:
            if tolerance < error < math.inf:
                forecast = min(max(math.ceil((error / tolerance) ** (1.0 / (m + 4.0))), 2.0), MAX_PARTS)
                sample_at(si, sf, cp, way_i, way_f, (forecast // 2.0) / forecast, stack, top, samples, spare, steps)
            chord = 0.0
            for c in range(3):
                chord = max(chord, abs(stack[2 * top + 1, I_X + c] - stack[2 * top, I_X + c]))
            s = samples[spare, 4]
            tiny = not chord > max(TINY, SHORT * tolerance)
            tiny = tiny or not abs(s1 - s0) > TINY * abs(way_f[w, WAY_S1] - way_f[w, WAY_S0])
            tiny = tiny or not 0.0 < abs(s - s0) < abs(s1 - s0) or 2 * top + 4 >= STACK_ROWS
            if not tiny:
                side = 0 if way_i[w, WAY_SITE] == strip_i[w, 0] else 1
                _cut_at_sample(si, sf, cp, strip_i, side, stack, top, samples, spare)
                top += 1
                continue
            if even:
                error = attempt(si, sf, cp, way_i, way_f, stack, top, m, math.inf, samples, hermite, newton, misses, points,
                                steps)
        row = ROWS * pieces
        if error < math.inf:
            write_fit(samples, m, hermite, newton, work, piece_cp, row)
        else:
            error = _straight(samples, spare, m, stack, top, piece_cp, row)
        if not error <= max(tolerance, LOST):
            return NO_FIT
        piece_i[pieces, P_DEGREE] = m + 3
        piece_i[pieces, P_KIND] = K_FREEFORM
        piece_f[pieces, P_ERROR] = error
        piece_f[pieces, P_LENGTH] = _polygon_length(piece_cp, row, m + 3)
        for k in range(strips):
            t0 = steps[k, PLAN_T] if k else 0.0
            t1 = steps[k + 1, PLAN_T] if k < strips - 1 else 1.0
            side = 0 if way_i[w + k, WAY_SITE] == strip_i[w + k, 0] else 1
            _add_part(piece_i, part_i, part_f, pieces, k, w + k, side, t0, t1, steps[k, PLAN_S0], steps[k, PLAN_S1])
        pieces += 1
        top -= 1
    return pieces


@jit
def fit_strips(
    si: Ints, sf: Floats, cp: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, joined: Flags, tolerance: float,
    degree: int, stack: Floats, samples: Floats, hermite: Floats, newton: Floats, misses: Floats, points: Floats,
    steps: Floats, work: Floats, p0: Floats, p2: Floats, way_i: Ints, way_f: Floats, piece_i: Ints, piece_f: Floats,
    piece_cp: Floats, part_i: Ints, part_f: Floats, first: Ints,
) -> int:
    """Pieces of all strips, rows of `strip_i` and `strip_s` in order and direction of travel; their number or a status.

    joined[w]: the strip of row w goes on where the one before ends, as smoothly as inside. The pieces of a stretch stand
    at the first of its strips: first[w] .. first[w + 1]. `piece_cp` has ROWS rows (x, y, r, w) for each piece. Tables are
    one row longer than needed. NO_ROOM when they are too small, NO_FIT - w when the strips from row w on cannot be followed.
    """
    rows = strip_i.shape[0]
    count = int(np.int64(0))
    piece_i[0, P_PART] = 0
    w = 0
    while w < rows:
        first[w] = count
        end = w + 1
        if is_conic(si, strip_i[w, 0], strip_i[w, 1]):
            count = _conic_strip(si, sf, cp, disc, strip_i, strip_s, w, p0, p2, way_i, way_f, piece_i, piece_f, piece_cp,
                                 part_i, part_f, count)
        else:
            while end < rows and joined[end]:
                end += 1
            begin = count
            # a footpoint that belongs to its disc only to rounding misleads on its own side, not on the other one
            for flip in range(2):
                count = _free_stretch(si, sf, cp, disc, strip_i, strip_s, w, end, flip, tolerance, degree - 3, stack, samples,
                                      hermite, newton, misses, points, steps, work, way_i, way_f, piece_i, piece_f,
                                      piece_cp, part_i, part_f, begin)
                if count != NO_FIT:
                    break
            if count == NO_FIT and end > w + 1:
                # one after the other: most can be followed, and the one that cannot is told
                for k in range(w + 1, end):
                    joined[k] = False
                count = begin
                continue
        if count == NO_FIT:
            return NO_FIT - w
        if count < 0:
            return NO_ROOM
        for k in range(w + 1, end):
            first[k] = count
        w = end
    first[rows] = count
    return count
