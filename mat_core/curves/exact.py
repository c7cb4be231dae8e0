"""A strip between lines, arcs and points: as conics, exactly; cut evenly where it turns by more than one does well."""

from __future__ import annotations

from mat_core.curves.conics import MAX_TURN, conic, conic_kind, swing
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
from mat_core.kernels.layout import KIND, LINE
from mat_core.tracing.strip import trace


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
def conic_pieces(track: Track, scratch: Scratch, pieces: Pieces, w: int, count: int) -> int:
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
