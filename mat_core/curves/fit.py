"""Curves of all strips, piece by piece: conics where the sides allow, else polynomials with a measured error.

A piece of a fitted curve runs from disc P to disc Q in the space of (x, y, r). Its parameter is the share of the way
along the chord,

    tau(X) = (X - P).(Q - P) / |Q - P|^2,

in which the axis is a regular, smooth curve everywhere: also at a centre of curvature, where both footpoints run into
each other and every boundary parameter u gives tau ~ (u - u*)^2, and where a Bezier's own speed is zero. The true
axis is sampled through a footpoint s on one side; each sample brings its own tau, so no equation tau(s) = const has
to be solved.

    X(tau) = H(tau) + tau^2 (1 - tau)^2 g(tau)         H: cubic with the exact discs and exact tangents at both ends
                                                       g: linear (degree 5) or cubic (degree 7), through the samples
    tangent at a disc with normals n1 (right), n2 (left): t = (n1 - n2) turned by -90 degrees, dr = t.n1; at a centre of
    curvature (n, 1): the disc moves straight away from its only contact. Tangents know nothing of curvature, so pieces
    join with one tangent.

        check  node  check  node  check        The nodes make |tau^2 (1 - tau)^2 prod (tau - tau_i)| equally large at
      P---+-----o-----+-----o-----+---Q        all checks, which so see the largest error. A piece that fails is halved.
                                               One that passes is checked again nearer to P and Q, where an error that
                                               grows towards an end is largest.

Halving ends at a chord that is short for the tolerance, at neighbouring floats, and at MAX_PIECES. A strip whose sides
do not belong together, or whose end discs do not belong to its sides, cannot be followed; it is given up (NO_FIT).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.conics import K_FREEFORM, MAX_TURN, conic, conic_kind, is_conic, swing
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import FAN, KIND, LEN, LINE, SPIRAL, SWEEP, V0, V1
from mat_core.tracing.strip import trace

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# columns of the piece tables
P_STRIP, P_SIDE, P_DEGREE, P_KIND = range(4)  # piece_i; P_SIDE 0: s is on the strip's right site, 1: on its left one
P_S0, P_S1, P_ERROR, P_LENGTH = range(4)  # piece_f; s at the piece's start and end, error and length (normalised)
ROWS = 8  # control points kept for a piece: degree 7

# the stack of waiting intervals: rows 2 i and 2 i + 1 are the two ends of interval i; columns s, x, y, r, tangent
I_S, I_X, I_TX = 0, 1, 4
STACK_ROWS, STACK_COLUMNS = 128, 7

SAFETY = 1.5  # stated error over the largest one measured at the checks
MIN_COSINE = 0.4  # of the angle between an end tangent and the chord; a piece that turns more is halved
OUTER = 0.6  # abscissa of the checks beside the ends, relative to the first one's
CHASE = 4  # samples to bring such a check within NEAR_ENOUGH of its abscissa
NEAR_ENOUGH = 0.04
MIN_GAP = 0.04  # least distance of neighbouring abscissae; below, the interpolation would be ill-conditioned
TINY = 1e-11  # a chord this short is not halved any more, nor is an interval this short relative to the whole one
SHORT = 0.25  # nor is a chord this short relative to the tolerance: drawn straight it is near enough
LOST = 1e-9  # largest error, other than the tolerance, at which halving may end; more is a jump, not rounding
MAX_PIECES = 256  # of one strip; smooth ones need far fewer at any tolerance
NO_ROOM = -1  # status: the piece tables are too small
NO_FIT = -2  # status: a strip cannot be followed
CLOSED_FORM_BONUS = 0.1  # sample a free-form side unless it is this much shorter than a closed one: a cheap partner
PARALLEL = 1e-9  # |n1 - n2| below which two normals at one vertex are one


@inner
def _fraction(m: int, k: int) -> float:
    """Abscissa k = 0 .. 2 m of checks (even) and nodes (odd), for m nodes."""
    mirrored = k > m
    i = 2 * m - k if mirrored else k
    f = 0.5
    if m == 2:
        f = 0.18225 if i == 0 else (0.337294 if i == 1 else 0.5)
    elif i == 0:
        f = 0.09825
    elif i == 1:
        f = 0.186439
    elif i == 2:
        f = 0.2845
    elif i == 3:
        f = 0.390292
    return 1.0 - f if mirrored else f


@inner
def _binomial(n: int, k: int) -> float:
    """The binomial coefficient n over k; 0 outside the triangle."""
    if k < 0 or k > n:
        return 0.0
    c = 1.0
    for i in range(k):
        c = c * (n - i) / (i + 1.0)
    return c


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
def _choose_side(si: Ints, sf: Floats, a: int, b: int, ends: Floats, r0: float, r1: float) -> int:
    """The side to sample through: the longer travel; free-form against closed form is preferred for its speed."""
    along_a = _travel(si, sf, a, ends[0], ends[1], r0, r1)
    along_b = _travel(si, sf, b, ends[2], ends[3], r0, r1)
    if si[a, KIND] == SPIRAL and si[b, KIND] != SPIRAL:
        along_b *= CLOSED_FORM_BONUS
    elif si[b, KIND] == SPIRAL and si[a, KIND] != SPIRAL:
        along_a *= CLOSED_FORM_BONUS
    return 0 if along_a >= along_b else 1


@inner
def _sample(
    si: Ints, sf: Floats, cp: Floats, i: int, s: float, j: int, lo: float, hi: float, stack: Floats, top: int,
    samples: Floats, row: int,
) -> None:
    """Row of `samples`: tau, x, y, r, s, partner's s, for the true axis point with footpoint s on site i."""
    x, y, r, sj, dx, dy, dr = trace(si, sf, cp, i, s, j, lo, hi)
    ux = stack[2 * top + 1, I_X] - stack[2 * top, I_X]
    uy = stack[2 * top + 1, I_X + 1] - stack[2 * top, I_X + 1]
    ur = stack[2 * top + 1, I_X + 2] - stack[2 * top, I_X + 2]
    along = (x - stack[2 * top, I_X]) * ux + (y - stack[2 * top, I_X + 1]) * uy + (r - stack[2 * top, I_X + 2]) * ur
    samples[row, 0] = along / (ux * ux + uy * uy + ur * ur)
    samples[row, 1] = x
    samples[row, 2] = y
    samples[row, 3] = r
    samples[row, 4] = s
    samples[row, 5] = sj


@inner
def _hermite(stack: Floats, top: int, out: Floats) -> bool:
    """Bernstein coefficients (4, 3) of the cubic H over tau; False when an end tangent leans away from the chord."""
    ux = stack[2 * top + 1, I_X] - stack[2 * top, I_X]
    uy = stack[2 * top + 1, I_X + 1] - stack[2 * top, I_X + 1]
    ur = stack[2 * top + 1, I_X + 2] - stack[2 * top, I_X + 2]
    dd = ux * ux + uy * uy + ur * ur
    d = math.sqrt(dd)
    good = True
    for end in range(2):
        row = 2 * top + end
        tx = stack[row, I_TX]
        ty = stack[row, I_TX + 1]
        tr = stack[row, I_TX + 2]
        along = tx * ux + ty * uy + tr * ur
        size = math.sqrt(tx * tx + ty * ty + tr * tr)
        factor = dd / along / 3.0 if along > 0.0 else 0.0
        if not along >= MIN_COSINE * size * d or size == 0.0:
            good = False
        sign = 1.0 if end == 0 else -1.0
        for m in range(3):
            p = stack[row, I_X + m]
            out[3 * end, m] = p
            out[1 + end, m] = p + sign * factor * stack[row, I_TX + m]
    return good


@inner
def _bulge(hermite: Floats, t: float, m: int) -> float:
    """Component m of H at t."""
    s = 1.0 - t
    return float(
        s * s * (s * hermite[0, m] + 3.0 * t * hermite[1, m]) + t * t * (3.0 * s * hermite[2, m] + t * hermite[3, m])
    )


@inner
def _miss(samples: Floats, row: int, m: int, hermite: Floats, newton: Floats) -> float:
    """Distance of the sample in one row from the fit."""
    t = samples[row, 0]
    weight = t * t * (1.0 - t) * (1.0 - t)
    off = 0.0
    for c in range(3):
        g = newton[m - 1, c]
        for i in range(m - 2, -1, -1):
            g = g * (t - samples[2 * i + 1, 0]) + newton[i, c]
        gap = _bulge(hermite, t, c) + weight * g - samples[row, 1 + c]
        off += gap * gap
    return math.sqrt(off)


@inner
def _interpolate(samples: Floats, m: int, hermite: Floats, newton: Floats) -> float:
    """Newton coefficients (m, 3) of g through the nodes (odd rows of `samples`); largest distance from the checks."""
    for i in range(m):
        t = samples[2 * i + 1, 0]
        weight = t * t * (1.0 - t) * (1.0 - t)
        for c in range(3):
            newton[i, c] = (samples[2 * i + 1, 1 + c] - _bulge(hermite, t, c)) / weight
    for level in range(1, m):
        for i in range(m - 1, level - 1, -1):
            gap = samples[2 * i + 1, 0] - samples[2 * (i - level) + 1, 0]
            for c in range(3):
                newton[i, c] = (newton[i, c] - newton[i - 1, c]) / gap
    worst = 0.0
    for row in range(0, 2 * m + 3, 2):
        worst = max(worst, _miss(samples, row, m, hermite, newton))
    return worst


@inner
def _write_piece(samples: Floats, m: int, hermite: Floats, newton: Floats, work: Floats, out: Floats, row: int) -> None:
    """Bezier control points of degree m + 3: H raised in degree, plus tau^2 (1 - tau)^2 g in Bernstein form."""
    n = m + 3
    for j in range(n + 1):
        total = _binomial(n, j)
        for c in range(3):
            value = 0.0
            for i in range(4):
                value += hermite[i, c] * _binomial(3, i) * _binomial(n - 3, j - i) / total
            out[row + j, c] = value
        out[row + j, 3] = 1.0
    for c in range(3):
        # Horner: g <- g (tau - tau_i) + coefficient, each time one degree higher
        work[0] = newton[m - 1, c]
        for i in range(m - 2, -1, -1):
            d = m - 2 - i
            root = samples[2 * i + 1, 0]
            for j in range(d + 1, -1, -1):
                value = 0.0
                if j <= d:
                    value -= (d + 1 - j) * root * work[j]
                if j >= 1:
                    value += j * (1.0 - root) * work[j - 1]
                work[j] = value / (d + 1.0) + newton[i, c]
        for i in range(m):
            out[row + i + 2, c] += work[i] * _binomial(m - 1, i) / _binomial(n, i + 2)


@inner
def _share(f: float, half: float) -> float:
    """Share of the way in s where tau is about f, when tau is `half` in the middle."""
    return f * (1.0 - half) / (f * (1.0 - 2.0 * half) + half)


@inner
def _check_ends(
    si: Ints, sf: Floats, cp: Floats, i: int, j: int, lo: float, hi: float, stack: Floats, top: int, m: int,
    samples: Floats, hermite: Floats, newton: Floats,
) -> float:
    """Error of the fit that `_attempt` left, at one more check on the way from each outer one to the end.

    One sample each where tau runs evenly; where it does not, regula falsi brings the check to its place.
    """
    row = 2 * m + 3
    worst = 0.0
    for end in range(2):
        outer = 0 if end == 0 else 2 * m
        t_in = samples[outer, 0]
        s_in = samples[outer, 4]
        t_out = 0.0 if end == 0 else 1.0
        s_out = stack[2 * top + end, I_S]
        f = OUTER * _fraction(m, 0)
        wanted = f if end == 0 else 1.0 - f
        s0 = stack[2 * top, I_S]
        s = s0 + _share(wanted, samples[2 * m + 2, 0]) * (stack[2 * top + 1, I_S] - s0)
        for _ in range(CHASE):
            _sample(si, sf, cp, i, s, j, lo, hi, stack, top, samples, row)
            worst = max(worst, _miss(samples, row, m, hermite, newton))
            t = samples[row, 0]
            if abs(t - wanted) < NEAR_ENOUGH:
                break
            if (t < wanted) == (end == 0):
                t_out = t
                s_out = s
            else:
                t_in = t
                s_in = s
            s = s_in + (s_out - s_in) * (wanted - t_in) / (t_out - t_in)
    return worst


@inner
def _attempt(
    si: Ints, sf: Floats, cp: Floats, i: int, j: int, lo: float, hi: float, stack: Floats, top: int, m: int,
    samples: Floats, hermite: Floats, newton: Floats,
) -> float:
    """Error of the fit over the interval on top of the stack, infinite when it has to be halved anyway.

    The sample to halve at stands in row m in any case.
    """
    s0 = stack[2 * top, I_S]
    s1 = stack[2 * top + 1, I_S]
    last = 2 * m + 2
    _sample(si, sf, cp, i, 0.5 * (s0 + s1), j, lo, hi, stack, top, samples, m)
    for c in range(6):
        samples[last, c] = samples[m, c]
    half = samples[m, 0]
    if not _hermite(stack, top, hermite) or not 0.02 < half < 0.98:
        return math.inf
    for k in range(2 * m + 1):
        if k == m and abs(half - 0.5) < 0.03:
            continue
        _sample(si, sf, cp, i, s0 + _share(_fraction(m, k), half) * (s1 - s0), j, lo, hi, stack, top, samples, k)
    before = 0.0
    for k in range(1, 2 * m + 1, 2):
        if not samples[k, 0] - before > MIN_GAP:
            return math.inf
        before = samples[k, 0]
    if not 1.0 - before > MIN_GAP:
        return math.inf
    return _interpolate(samples, m, hermite, newton)


@jit
def _straight(samples: Floats, m: int, stack: Floats, top: int, out: Floats, row: int) -> float:
    """The last resort on a tiny interval: the chord itself; returns its error.

    That is how far the middle sample is from it, and half its length where that could be a jump of the axis.
    """
    off = 0.0
    dd = 0.0
    t = min(max(samples[m, 0], 0.0), 1.0)
    for c in range(3):
        p = stack[2 * top, I_X + c]
        q = stack[2 * top + 1, I_X + c]
        for k in range(m + 4):
            f = k / (m + 3.0)
            out[row + k, c] = (1.0 - f) * p + f * q
            out[row + k, 3] = 1.0
        gap = samples[m, 1 + c] - ((1.0 - t) * p + t * q)
        off += gap * gap
        dd += (q - p) * (q - p)
    return max(math.sqrt(off), 0.5 * math.sqrt(dd) if dd > LOST * LOST else 0.0)


@inner
def _polygon_length(cp: Floats, row: int, degree: int) -> float:
    """Between the chord and the control polygon, in (x, y): (2 chord + (n - 1) polygon) / (n + 1) (Gravesen 1997)."""
    polygon = 0.0
    for k in range(degree):
        polygon += math.hypot(cp[row + k + 1, 0] - cp[row + k, 0], cp[row + k + 1, 1] - cp[row + k, 1])
    chord = math.hypot(cp[row + degree, 0] - cp[row, 0], cp[row + degree, 1] - cp[row, 1])
    return (2.0 * chord + (degree - 1.0) * polygon) / (degree + 1.0)


@inner
def _finish_piece(
    piece_i: Ints, piece_f: Floats, piece_cp: Floats, p: int, strip: int, s0: float, s1: float, error: float
) -> None:
    """Row p of the piece tables, of which side, degree and kind are filled already."""
    degree = piece_i[p, P_DEGREE]
    piece_i[p, P_STRIP] = strip
    piece_f[p, P_S0] = s0
    piece_f[p, P_S1] = s1
    piece_f[p, P_ERROR] = error
    piece_f[p, P_LENGTH] = _polygon_length(piece_cp, ROWS * p, degree)


@inner
def _conic_strip(
    si: Ints, sf: Floats, cp: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, strip: int, ends: Floats,
    p0: Floats, p2: Floats, piece_i: Ints, piece_f: Floats, piece_cp: Floats, count: int,
) -> int:
    """Pieces of a strip between lines, arcs and points; returns the new number of pieces or a status."""
    a = strip_i[strip, 0]
    b = strip_i[strip, 1]
    turn_a = swing(si, sf, a) * (ends[1] - ends[0])
    turn_b = swing(si, sf, b) * (ends[3] - ends[2])
    kind = conic_kind(si, sf, a, b)
    both_lines = si[a, KIND] == LINE and si[b, KIND] == LINE
    share = 0.5 * abs(turn_a + turn_b) / MAX_TURN
    if not share < MAX_PIECES:
        return NO_FIT
    pieces = 1 + int(share)
    side = 0 if abs(turn_a) >= abs(turn_b) else 1
    if both_lines:
        side = 0
    s0 = ends[2 * side]
    s1 = ends[2 * side + 1]
    if count + pieces > piece_i.shape[0]:
        return NO_ROOM
    for m in range(3):
        p0[m] = disc[strip_i[strip, 2], m]
    before = s0
    for piece in range(pieces):
        after = s1
        if piece == pieces - 1:
            for m in range(3):
                p2[m] = disc[strip_i[strip, 3], m]
        else:
            after = s0 + (s1 - s0) * (piece + 1.0) / pieces
            i = a if side == 0 else b
            j = b if side == 0 else a
            lo = ends[3] if side == 0 else ends[0]
            hi = ends[2] if side == 0 else ends[1]
            p2[0], p2[1], p2[2], sj, dx, dy, dr = trace(si, sf, cp, i, after, j, lo, hi)
        piece_i[count, P_SIDE] = side
        piece_i[count, P_DEGREE] = 1 if both_lines else 2
        piece_i[count, P_KIND] = kind
        error = 0.0
        if both_lines:
            for m in range(3):
                piece_cp[ROWS * count, m] = p0[m]
                piece_cp[ROWS * count + 1, m] = p2[m]
            piece_cp[ROWS * count, 3] = 1.0
            piece_cp[ROWS * count + 1, 3] = 1.0
        else:
            error = conic(si, sf, a, b, p0, p2, piece_cp, ROWS * count)
        _finish_piece(piece_i, piece_f, piece_cp, count, strip, before, after, error)
        count += 1
        before = after
        for m in range(3):
            p0[m] = p2[m]
    return count


@inner
def _put_end(stack: Floats, row: int, s: float, x: float, y: float, r: float, t: tuple[float, float, float]) -> None:
    """One end of an interval."""
    stack[row, I_S] = s
    stack[row, I_X] = x
    stack[row, I_X + 1] = y
    stack[row, I_X + 2] = r
    stack[row, I_TX] = t[0]
    stack[row, I_TX + 1] = t[1]
    stack[row, I_TX + 2] = t[2]


@inner
def _free_strip(
    si: Ints, sf: Floats, cp: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, strip: int, ends: Floats,
    side: int, tolerance: float, m: int, stack: Floats, samples: Floats, hermite: Floats, newton: Floats, work: Floats,
    piece_i: Ints, piece_f: Floats, piece_cp: Floats, count: int,
) -> int:
    """Pieces of a strip sampled through one side, in order of travel; returns their new number or a status."""
    a = strip_i[strip, 0]
    b = strip_i[strip, 1]
    d0 = strip_i[strip, 2]
    d1 = strip_i[strip, 3]
    i = a if side == 0 else b
    j = b if side == 0 else a
    lo = ends[3] if side == 0 else ends[0]
    hi = ends[2] if side == 0 else ends[1]
    whole = abs(ends[2 * side + 1] - ends[2 * side])
    top = int(np.int64(0))  # not a literal: each literal would be compiled for once more
    t = tangent(si, sf, cp, a, ends[0], b, ends[2], disc[d0, 2], 1.0)
    _put_end(stack, top, ends[2 * side], disc[d0, 0], disc[d0, 1], disc[d0, 2], t)
    t = tangent(si, sf, cp, a, ends[1], b, ends[3], disc[d1, 2], -1.0)
    _put_end(stack, top + 1, ends[2 * side + 1], disc[d1, 0], disc[d1, 1], disc[d1, 2], t)
    begin = count
    while top >= 0:
        if count >= piece_i.shape[0]:
            return NO_ROOM
        if count - begin + top >= MAX_PIECES:
            return NO_FIT
        error = _attempt(si, sf, cp, i, j, lo, hi, stack, top, m, samples, hermite, newton)
        if SAFETY * error <= tolerance:
            error = max(error, _check_ends(si, sf, cp, i, j, lo, hi, stack, top, m, samples, hermite, newton))
        s0 = stack[2 * top, I_S]
        s1 = stack[2 * top + 1, I_S]
        s = samples[m, 4]
        chord = 0.0
        for c in range(3):
            chord = max(chord, abs(stack[2 * top + 1, I_X + c] - stack[2 * top, I_X + c]))
        tiny = not chord > max(TINY, SHORT * tolerance) or not abs(s1 - s0) > TINY * whole
        if not 0.0 < abs(s - s0) < abs(s1 - s0) or 2 * top + 4 >= STACK_ROWS:
            tiny = True
        if tiny or SAFETY * error <= tolerance:
            if error < math.inf:
                _write_piece(samples, m, hermite, newton, work, piece_cp, ROWS * count)
            else:
                error = _straight(samples, m, stack, top, piece_cp, ROWS * count)
            if not SAFETY * error <= max(tolerance, LOST):
                return NO_FIT
            piece_i[count, P_SIDE] = side
            piece_i[count, P_DEGREE] = m + 3
            piece_i[count, P_KIND] = K_FREEFORM
            _finish_piece(piece_i, piece_f, piece_cp, count, strip, s0, s1, SAFETY * error)
            count += 1
            top -= 1
            continue
        # the far half waits below, the near half is done first
        sj = samples[m, 5]
        t = tangent(si, sf, cp, a, s if side == 0 else sj, b, sj if side == 0 else s, samples[m, 3], 1.0)
        for c in range(STACK_COLUMNS):
            stack[2 * top + 3, c] = stack[2 * top + 1, c]
            stack[2 * top + 2, c] = stack[2 * top, c]
        _put_end(stack, 2 * top, s, samples[m, 1], samples[m, 2], samples[m, 3], t)
        _put_end(stack, 2 * top + 3, s, samples[m, 1], samples[m, 2], samples[m, 3], t)
        top += 1
    return count


@jit
def fit_strips(
    si: Ints, sf: Floats, cp: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, wanted: Ints, tolerance: float,
    degree: int, stack: Floats, samples: Floats, hermite: Floats, newton: Floats, work: Floats, ends: Floats,
    p0: Floats, p2: Floats, piece_i: Ints, piece_f: Floats, piece_cp: Floats, first: Ints,
) -> int:
    """Pieces of all `wanted` strips, from disc0 to disc1; those of strip w are first[w] .. first[w + 1].

    `piece_cp` has ROWS rows (x, y, r, w) for each piece. Room: stack (STACK_ROWS, STACK_COLUMNS), samples (12, 6),
    hermite (4, 3), newton (4, 3), work (8,), ends (4,), p0, p2 (3,). Returns the number of pieces, NO_ROOM when the tables
    are too small, NO_FIT - w when strip wanted[w] cannot be followed.
    """
    count = int(np.int64(0))
    for w in range(wanted.shape[0]):
        strip = wanted[w]
        first[w] = count
        for m in range(4):
            ends[m] = strip_s[strip, m]
        if is_conic(si, strip_i[strip, 0], strip_i[strip, 1]):
            count = _conic_strip(si, sf, cp, disc, strip_i, strip_s, strip, ends, p0, p2, piece_i, piece_f, piece_cp,
                                 count)
        else:
            side = _choose_side(si, sf, strip_i[strip, 0], strip_i[strip, 1], ends, disc[strip_i[strip, 2], 2],
                                disc[strip_i[strip, 3], 2])
            begin = count
            # a footpoint that belongs to its disc only to rounding misleads on its own side, not on the other one
            for _ in range(2):
                count = _free_strip(si, sf, cp, disc, strip_i, strip_s, strip, ends, side, tolerance, degree - 3, stack,
                                    samples, hermite, newton, work, piece_i, piece_f, piece_cp, begin)
                if count != NO_FIT:
                    break
                side = 1 - side
        if count == NO_FIT:
            return NO_FIT - w
        if count < 0:
            return NO_ROOM
    first[wanted.shape[0]] = count
    return count
