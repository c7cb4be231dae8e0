"""Polynomials along one stretch: each as long as the tolerance lets it be, from its start to its end.

    P ----------o---x....o......... Q        o: discs between strips, exact, known beforehand; x: end of a piece

1. A piece is tried to the farthest end that is in question, with as few nodes as will do (`trial`). While its error is too large
   for the most nodes it is shortened to where its error says that it would do. Ends that were too far wait for the next piece.
2. A piece that does, with an error that leaves room, is lengthened towards the end that was too far; the longest is taken.

An end that would fall near a disc between strips is put there. Shortening ends at a chord that is short for the tolerance, at
neighbouring floats, and at MAX_PIECES.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.bezier import LOST, straight, write_fit
from mat_core.curves.conics import K_FREEFORM
from mat_core.curves.ends import apart, copy_end, put_disc, put_sample
from mat_core.curves.interval import attempt
from mat_core.curves.pieces import (
    MAX_PIECES,
    NO_FIT,
    NO_ROOM,
    P_DEGREE,
    P_ERROR,
    P_KIND,
    P_LENGTH,
    P_ROW,
    Pieces,
    add_part,
    choose_side,
    lay_way,
    polygon_length,
)
from mat_core.curves.plan import sample_at
from mat_core.curves.polynomial import hermite_of
from mat_core.curves.trial import hope, try_piece
from mat_core.curves.way import (
    I_ROW,
    I_S,
    I_SJ,
    I_X,
    MAX_STRIPS,
    PLAN_S0,
    PLAN_S1,
    PLAN_T,
    SPARE,
    WAITING,
    WAY_S0,
    WAY_S1,
    WAY_SITE,
    Scratch,
    Track,
    partner_end,
    place_partner,
    sample,
)
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import V0, V1

Floats = NDArray[np.float64]

TINY = 1e-11  # a chord this short is not cut any more, nor is an interval this short relative to the whole strip
SHORT = 0.25  # nor is a chord this short relative to the tolerance: drawn straight it is near enough
SHORT_FOR_DISCS = 4.0  # times its length over its radius: the share of the tolerance for a stretch, at most all of it
STRICTEST = 0.01  # and at least this
NO_STRICTER = 1e-10  # than this: discs beside the centre of an arc of noise are told no better
AT_LEAF = 0.1  # of the tolerance for a stretch that ends at a centre of curvature
LEAST_CUT, MOST_CUT = 0.1, 0.9  # range of the share that a piece is shortened to
PATIENCE = 8  # pieces in a row that are shortened by what their errors let hope; then
MANY_CUT = 0.5  # each is at least halved
BESIDE = 0.08  # of the wanted length, from a disc between strips: the piece ends there
WORTH = 1.15  # times as long: what a longer piece must be hoped to be, to be tried
TRIES = 2  # longer pieces tried
TOWARDS = 0.75  # most of the way to an end that was too far


@inner
def _shorten(track: Track, scratch: Scratch, tolerance: float, share: float, even: bool, to: int) -> bool:
    """Put an end at a share of the interval into row `to`; False when the interval is too short to be cut."""
    ends = scratch.ends
    steps = scratch.steps
    first = int(ends[0, I_ROW])
    strips = int(ends[1, I_ROW]) - first + 1
    w = first
    if strips > 1:
        cut = min(strips, MAX_STRIPS) // 2
        beside = 1.0
        if even:
            beside = BESIDE
            while w < first + strips - 1 and share >= steps[w + 1 - first, PLAN_T]:
                w += 1
            cut = w - first
            if cut == 0 or cut < strips - 1 and steps[cut + 1, PLAN_T] - share < share - steps[cut, PLAN_T]:
                cut += 1
        if not even or abs(steps[cut, PLAN_T] - share) <= beside * share:
            put_disc(track, first + cut - 1, 1, scratch.waiting, to)
            return True
    if even:
        sample_at(track, scratch, share, SPARE)
    s = scratch.samples[SPARE, 4]
    s0 = steps[w - first, PLAN_S0]
    s1 = steps[w - first, PLAN_S1]
    inside = 0.0 < abs(s - s0) < abs(s1 - s0)
    if strips > 1 and not inside:
        put_disc(track, max(w - 1, first), 1, scratch.waiting, to)
        return True
    chord = 0.0
    for c in range(3):
        chord = max(chord, abs(ends[1, I_X + c] - ends[0, I_X + c]))
    if not chord > max(TINY, SHORT * tolerance) or not inside or to + 1 >= WAITING:
        return False
    if not abs(s1 - s0) > TINY * abs(track.way_f[w, WAY_S1] - track.way_f[w, WAY_S0]):
        return False
    put_sample(track, scratch, w, SPARE, scratch.waiting, to)
    return True


@inner
def _lengthen(track: Track, scratch: Scratch, growth: float, limit: int) -> bool:
    """Move the interval's end towards that in row `limit`, which is too far; False when there is no room."""
    ends = scratch.ends
    waiting = scratch.waiting
    length = apart(ends, 0, ends, 1)
    room = apart(waiting, limit, ends, 0) - length
    wanted = min((growth - 1.0) * length, TOWARDS * room)
    if not wanted >= (WORTH - 1.0) * length:
        return False
    w = int(ends[1, I_ROW])
    last = int(waiting[limit, I_ROW])
    s = ends[1, I_S]
    sj = ends[1, I_SJ]
    if s == track.way_f[w, WAY_S1] and w < last:
        w += 1
        s = track.way_f[w, WAY_S0]
        sj = partner_end(track, w, 0)
    if w == last:
        between = s + wanted / room * (waiting[limit, I_S] - s)
        if not 0.0 < abs(between - s) < abs(waiting[limit, I_S] - s):
            return False
        sample(track, scratch, w, between, sj + wanted / room * (waiting[limit, I_SJ] - sj), SPARE)
        put_sample(track, scratch, w, SPARE, ends, 1)
        return True
    best = w
    off = math.inf
    for k in range(w, last):
        d = track.strip_i[k, 3]
        dx = track.disc[d, 0] - ends[0, I_X]
        dy = track.disc[d, 1] - ends[0, I_X + 1]
        dr = track.disc[d, 2] - ends[0, I_X + 2]
        miss = abs(math.sqrt(dx * dx + dy * dy + dr * dr) - length - wanted)
        if miss < off:
            off = miss
            best = k
    put_disc(track, best, 1, ends, 1)
    return True


@inner
def _record(track: Track, scratch: Scratch, pieces: Pieces, m: int, error: float, p: int) -> None:
    """Piece p is what was written for the interval; it takes the place of a shorter one."""
    steps = scratch.steps
    w = int(scratch.ends[0, I_ROW])
    strips = int(scratch.ends[1, I_ROW]) - w + 1
    row = pieces.piece_i[p, P_ROW]
    pieces.piece_i[p, P_DEGREE] = m + 3
    pieces.piece_i[p, P_KIND] = K_FREEFORM
    pieces.piece_f[p, P_ERROR] = error
    pieces.piece_f[p, P_LENGTH] = polygon_length(pieces.cp, row, m + 3)
    pieces.piece_i[p + 1, P_ROW] = row + m + 4
    for k in range(strips):
        t0 = steps[k, PLAN_T] if k else 0.0
        t1 = steps[k + 1, PLAN_T] if k < strips - 1 else 1.0
        side = 0 if track.way_i[w + k, WAY_SITE] == track.strip_i[w + k, 0] else 1
        add_part(pieces, p, k, w + k, side, t0, t1, steps[k, PLAN_S0], steps[k, PLAN_S1])


@inner
def _shortest(track: Track, scratch: Scratch, tolerance: float, left: int) -> tuple[int, float, int]:
    """Step 1: (nodes, bound or error of the first piece that does or cannot be shorter, how many ends wait less its own).

    Where the curve bends at once, within 1e-10 of its start, the error falls as slowly as the length, not as its error lets hope.
    """
    tried = 0
    while True:
        copy_end(scratch.waiting, left - 1, scratch.ends, 1)
        even, m, error = try_piece(track, scratch, tolerance)
        if error <= tolerance:
            return m, error, left - 1
        tried += 1
        share = min(max(hope(scratch, error, tolerance, m), LEAST_CUT), MOST_CUT if tried < PATIENCE else MANY_CUT)
        if not _shorten(track, scratch, tolerance, share, even, left):
            if even and hermite_of(scratch.ends, scratch.hermite):
                error = attempt(track, scratch, m, math.inf)
            return m, error, left - 1
        left += 1


@inner
def _next_start(track: Track, end: int, ends: Floats) -> None:
    """The next piece begins where the last one ended: in the next strip, where that is a disc between strips."""
    copy_end(ends, 2, ends, 0)
    w = int(ends[0, I_ROW])
    if ends[0, I_S] == track.way_f[w, WAY_S1] and w < end - 1:
        ends[0, I_ROW] = w + 1
        ends[0, I_S] = track.way_f[w + 1, WAY_S0]
        ends[0, I_SJ] = partner_end(track, w + 1, 0)


@inner
def _is_leaf(track: Track, w: int, end: int) -> bool:
    """Whether a strip ends (end 1) or starts (0) at a centre of curvature: both sides of it meet where the disc touches."""
    right = track.strip_i[w, 0]
    left = track.strip_i[w, 1]
    s_right = track.strip_s[w, end]
    s_left = track.strip_s[w, 2 + end]
    at_ends = (s_right == 0.0 or s_right == 1.0) and (s_left == 0.0 or s_left == 1.0)
    vertex_right = track.si[right, V1 if s_right > 0.5 else V0]
    vertex_left = track.si[left, V1 if s_left > 0.5 else V0]
    return at_ends and vertex_right == vertex_left and track.disc[track.strip_i[w, 2 + end], 2] > 0.0


@inner
def stricter(track: Track, begin: int, end: int, tolerance: float) -> float:
    """The tolerance for a stretch, which is less where it is hard to tell from its curve where its discs touch.

    How fast the radius changes tells that: from a curve that is short for its discs, or ends at a centre of curvature, where the
    radius changes as fast as the centre moves, and the square root of what is left over of that tells it.
    """
    first = track.strip_i[begin, 2]
    last = track.strip_i[end - 1, 3]
    length = 0.0
    for c in range(3):
        length = max(length, abs(track.disc[last, c] - track.disc[first, c]))
    radius = max(track.disc[first, 2], track.disc[last, 2])
    share = min(max(SHORT_FOR_DISCS * length / radius, STRICTEST), 1.0) if radius > 0.0 else 1.0
    if _is_leaf(track, begin, 0) or _is_leaf(track, end - 1, 1):
        share = min(share, AT_LEAF)
    return max(share * tolerance, min(tolerance, NO_STRICTER))


@inner
def free_stretch(
    track: Track, scratch: Scratch, pieces: Pieces, begin: int, end: int, flip: int, tolerance: float,
    count: int,
) -> int:
    """Pieces of the strips in rows begin .. end - 1, in order of travel; returns their new number or a status.

    With `flip` each strip is sampled through the other side.
    """
    for w in range(begin, end):
        side = choose_side(track, w)
        lay_way(track, w, 1 - side if flip else side)
        place_partner(track, w)
    ends = scratch.ends
    waiting = scratch.waiting
    put_disc(track, begin, 0, ends, 0)
    put_disc(track, end - 1, 1, waiting, 0)
    left = int(np.int64(1))  # not a literal: each literal would be compiled for once more
    p = count
    reach = 0.0
    while left > 0:
        if p + 1 >= pieces.piece_i.shape[0]:
            return NO_ROOM
        if p - count >= MAX_PIECES:
            return NO_FIT
        row = pieces.piece_i[p, P_ROW]
        # nearer ends than the last piece is long were too far from its start, not from this one
        while left > 1 and apart(waiting, left - 1, ends, 0) < reach:
            left -= 1
        m, error, left = _shortest(track, scratch, tolerance, left)
        if error < math.inf:
            write_fit(scratch, m, pieces.cp, row)
        else:
            error = straight(scratch, SPARE, m, pieces.cp, row)
        if not error <= max(tolerance, LOST):
            return NO_FIT
        _record(track, scratch, pieces, m, error, p)
        copy_end(ends, 1, ends, 2)
        # step 2: longer
        for _ in range(TRIES):
            if left == 0 or not error <= tolerance:
                break
            if not _lengthen(track, scratch, hope(scratch, error, tolerance, m), left - 1):
                break
            even, m, error = try_piece(track, scratch, tolerance)
            if error <= tolerance:
                write_fit(scratch, m, pieces.cp, row)
                _record(track, scratch, pieces, m, error, p)
                copy_end(ends, 1, ends, 2)
        reach = apart(ends, 0, ends, 2)
        _next_start(track, end, ends)
        p += 1
    return p
