"""Strips between lines, arcs and points: as conics, exactly.

One rational quadratic does for all strips in a row between the same two curves, as long as it turns by less than a quadratic does
well (`MAX_TURN`). A strip that turns by more is cut evenly.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.conics import EXACT, MAX_TURN, conic, conic_kind, swing
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
    lay_way,
    polygon_length,
)
from mat_core.curves.way import WAY_HI, WAY_LO, WAY_PARTNER, WAY_S0, WAY_S1, WAY_SITE, Scratch, Track
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import KIND, LEN, LINE
from mat_core.tracing.strip import trace

Floats = NDArray[np.float64]


@inner
def conic_end(track: Track, begin: int, rows: int) -> int:
    """The row after the last strip that one quadratic from the start of row `begin` may pass."""
    end = begin + 1
    turn = _turn(track, begin)
    while end < rows and track.joined[end]:
        turn += _turn(track, end)
        if not turn < MAX_TURN:
            break
        end += 1
    return end


@inner
def conic_pieces(track: Track, scratch: Scratch, pieces: Pieces, begin: int, end: int, count: int) -> int:
    """Pieces of the strips in rows begin .. end - 1, one if these are several; their new number or a status."""
    if end > begin + 1 and not _in_one(track, scratch, pieces, begin, end, count):
        # the curves of several differ by rounding that tells: each by itself
        for w in range(begin, end):
            count = _cut(track, scratch, pieces, w, count)
            if count < 0:
                break
        return count
    return count + 1 if end > begin + 1 else _cut(track, scratch, pieces, begin, count)


@inner
def _turn(track: Track, w: int) -> float:
    """By how much the axis turns along a strip: the mean of both normals."""
    a = swing(track.si, track.sf, track.strip_i[w, 0]) * (track.strip_s[w, 1] - track.strip_s[w, 0])
    b = swing(track.si, track.sf, track.strip_i[w, 1]) * (track.strip_s[w, 3] - track.strip_s[w, 2])
    return 0.5 * abs(a + b)


@inner
def _side(track: Track, w: int) -> int:
    """The side that a strip is sampled through: the one that turns by more; straight between lines."""
    a = swing(track.si, track.sf, track.strip_i[w, 0]) * (track.strip_s[w, 1] - track.strip_s[w, 0])
    b = swing(track.si, track.sf, track.strip_i[w, 1]) * (track.strip_s[w, 3] - track.strip_s[w, 2])
    return 0 if abs(a) >= abs(b) else 1


@inner
def _write(track: Track, scratch: Scratch, pieces: Pieces, a: int, b: int, p: int) -> float:
    """Piece p, between sites a and b and both `corners`; its measured error."""
    corners = scratch.corners
    both_lines = track.si[a, KIND] == LINE and track.si[b, KIND] == LINE
    degree = 1 if both_lines else 2
    row = pieces.piece_i[p, P_ROW]
    pieces.piece_i[p, P_DEGREE] = degree
    pieces.piece_i[p, P_KIND] = conic_kind(track.si, track.sf, a, b)
    pieces.piece_i[p + 1, P_ROW] = row + degree + 1
    error = 0.0
    if both_lines:
        for end in range(2):
            for m in range(3):
                pieces.cp[row + end, m] = corners[end, m]
            pieces.cp[row + end, 3] = 1.0
    else:
        error = conic(track.si, track.sf, a, b, corners[0], corners[1], pieces.cp, row)
    pieces.piece_f[p, P_ERROR] = error
    pieces.piece_f[p, P_LENGTH] = polygon_length(pieces.cp, row, degree)
    return error


@inner
def _cut(track: Track, scratch: Scratch, pieces: Pieces, w: int, count: int) -> int:
    """Pieces of one strip; their new number or a status."""
    share = _turn(track, w) / MAX_TURN
    if not share < MAX_PIECES:
        return NO_FIT
    number = 1 + int(share)
    if count + number >= pieces.piece_i.shape[0]:
        return NO_ROOM
    corners = scratch.corners
    side = _side(track, w)
    lay_way(track, w, side)
    s0 = track.way_f[w, WAY_S0]
    s1 = track.way_f[w, WAY_S1]
    for m in range(3):
        corners[0, m] = track.disc[track.strip_i[w, 2], m]
    before = s0
    for piece in range(number):
        after = s1
        if piece == number - 1:
            for m in range(3):
                corners[1, m] = track.disc[track.strip_i[w, 3], m]
        else:
            after = s0 + (s1 - s0) * (piece + 1.0) / number
            corners[1, 0], corners[1, 1], corners[1, 2], sj, dx, dy, dr = trace(
                track.si, track.sf, track.cp, track.way_i[w, WAY_SITE], after, track.way_i[w, WAY_PARTNER],
                track.way_f[w, WAY_LO], track.way_f[w, WAY_HI])
        _write(track, scratch, pieces, track.strip_i[w, 0], track.strip_i[w, 1], count)
        add_part(pieces, count, 0, w, side, 0.0, 1.0, before, after)
        count += 1
        before = after
        for m in range(3):
            corners[0, m] = corners[1, m]
    return count


@inner
def _in_one(track: Track, scratch: Scratch, pieces: Pieces, begin: int, end: int, p: int) -> bool:
    """Piece p for several strips; False where it does not follow them but for rounding, or there is no room."""
    if p + 1 >= pieces.piece_i.shape[0]:
        return False
    for m in range(3):
        scratch.corners[0, m] = track.disc[track.strip_i[begin, 2], m]
        scratch.corners[1, m] = track.disc[track.strip_i[end - 1, 3], m]
    # of parts of one curve the longest tells best where it runs
    a = track.strip_i[begin, 0]
    b = track.strip_i[begin, 1]
    for w in range(begin + 1, end):
        if track.sf[track.strip_i[w, 0], LEN] > track.sf[a, LEN]:
            a = track.strip_i[w, 0]
        if track.sf[track.strip_i[w, 1], LEN] > track.sf[b, LEN]:
            b = track.strip_i[w, 1]
    if not _write(track, scratch, pieces, a, b, p) <= EXACT:
        return False
    row = pieces.piece_i[p, P_ROW]
    before = 0.0
    for w in range(begin, end):
        after = 1.0 if w == end - 1 else _parameter(pieces.cp, row, pieces.piece_i[p, P_DEGREE], track.disc, track.strip_i[w, 3])
        if not before < after:
            return False
        side = _side(track, w)
        lay_way(track, w, side)
        add_part(pieces, p, w - begin, w, side, before, after, track.way_f[w, WAY_S0], track.way_f[w, WAY_S1])
        before = after
    return True


@inner
def _parameter(cp: Floats, row: int, degree: int, disc: Floats, d: int) -> float:
    """t of a disc on a piece: where both are equally far along its chord.

    With tau the share along the chord, of the disc and of the middle control point (v):  2 w v t (1 - t) + t^2 = tau W(t).
    """
    along = 0.0
    middle = 0.0
    chord = 0.0
    for m in range(3):
        way = cp[row + degree, m] - cp[row, m]
        chord += way * way
        along += way * (disc[d, m] - cp[row, m])
        middle += way * (cp[row + 1, m] - cp[row, m])
    tau = along / chord
    if degree == 1:
        return tau
    w = cp[row + 1, 3]
    # a t^2 + 2 b t - tau = 0
    b = w * (middle / chord - tau) + tau
    a = 1.0 - 2.0 * tau - 2.0 * w * (middle / chord - tau)
    root = math.sqrt(max(b * b + a * tau, 0.0))
    return tau / (b + root) if b + root > 0.0 else 1.0
