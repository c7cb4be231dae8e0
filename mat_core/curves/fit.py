"""Curves of all strips, piece by piece: conics where the sides allow, else polynomials with a bounded error.

Strips come in order and direction of travel. Where both sides of one run on in the next along the same curve (the disc between
them touches where a curve was cut, here or in the input, not where it ends: `continuing`), the axis is as smooth there as
anywhere: such strips are one *stretch*, and a polynomial may pass from one into the next (`stretch`). Joints of the boundary,
where its curvature or a derivative of it jumps, stay ends of pieces. A strip whose sides do not belong together, or whose end
discs do not belong to its sides, cannot be followed; it is given up (NO_FIT).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.conics import MAX_TURN, conic, conic_kind, is_conic, swing
from mat_core.curves.continuing import goes_on
from mat_core.curves.pieces import (
    MAX_PIECES,
    NO_FIT,
    NO_ROOM,
    P_DEGREE,
    P_ERROR,
    P_KIND,
    P_LENGTH,
    P_PART,
    P_ROW,
    add_part,
    lay_way,
    polygon_length,
)
from mat_core.curves.stretch import free_stretch
from mat_core.curves.way import WAY_HI, WAY_LO, WAY_PARTNER, WAY_S0, WAY_S1, WAY_SITE
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import KIND, LINE
from mat_core.tracing.strip import trace

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@jit
def travel(
    si: Ints, sf: Floats, cp: Floats, skeleton_i: Ints, skeleton_s: Floats, run_start: Ints, run_strip: Ints, run_forward: Flags,
    strip_i: Ints, strip_s: Floats, joined: Flags, work: Floats,
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
                # u rises on the right and falls on the left
                right = goes_on(si, sf, cp, strip_i[w - 1, 0], strip_i[w, 0], work)
                joined[w] = right and goes_on(si, sf, cp, strip_i[w, 1], strip_i[w - 1, 1], work)


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
    lay_way(strip_i, strip_s, w, side, way_i, way_f)
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
        row = piece_i[count, P_ROW]
        piece_i[count + 1, P_ROW] = row + piece_i[count, P_DEGREE] + 1
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
        piece_f[count, P_LENGTH] = polygon_length(piece_cp, row, piece_i[count, P_DEGREE])
        add_part(piece_i, part_i, part_f, count, 0, w, side, 0.0, 1.0, before, after)
        count += 1
        before = after
        for m in range(3):
            p0[m] = p2[m]
    return count


@jit
def fit_strips(
    si: Ints, sf: Floats, cp: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, joined: Flags, tolerance: float,
    degree: int, ends: Floats, waiting: Floats, samples: Floats, hermite: Floats, newton: Floats, misses: Floats, points: Floats,
    steps: Floats, work: Floats, p0: Floats, p2: Floats, way_i: Ints, way_f: Floats, piece_i: Ints, piece_f: Floats,
    piece_cp: Floats, part_i: Ints, part_f: Floats, first: Ints, begin: int, rows: int,
) -> int:
    """Pieces of the strips in rows begin .. rows - 1, in order and direction of travel; their number or a status.

    joined[w]: the strip of row w goes on where the one before ends, as smoothly as inside; that of row `begin` does not. The
    pieces of a stretch stand at the first of its strips: first[w - begin] .. first[w + 1 - begin]. `piece_cp` has room for ROWS
    rows (x, y, r, w) a piece. Tables are one row longer than needed. NO_ROOM when they are too small, NO_FIT - w when the strips
    from row w on cannot be followed.
    """
    count = int(np.int64(0))
    piece_i[0, P_PART] = 0
    piece_i[0, P_ROW] = 0
    w = begin
    while w < rows:
        first[w - begin] = count
        end = w + 1
        if is_conic(si, strip_i[w, 0], strip_i[w, 1]):
            count = _conic_strip(si, sf, cp, disc, strip_i, strip_s, w, p0, p2, way_i, way_f, piece_i, piece_f, piece_cp,
                                 part_i, part_f, count)
        else:
            while end < rows and joined[end]:
                end += 1
            before = count
            # a footpoint that belongs to its disc only to rounding misleads on its own side, not on the other one
            for flip in range(2):
                count = free_stretch(si, sf, cp, disc, strip_i, strip_s, w, end, flip, tolerance, degree - 3, ends, waiting,
                                     samples, hermite, newton, misses, points, steps, work, way_i, way_f, piece_i, piece_f,
                                     piece_cp, part_i, part_f, before)
                if count != NO_FIT:
                    break
            if count == NO_FIT and end > w + 1:
                # one after the other: most can be followed, and the one that cannot is told
                for k in range(w + 1, end):
                    joined[k] = False
                count = before
                continue
        if count == NO_FIT:
            return NO_FIT - w
        if count < 0:
            return NO_ROOM
        for k in range(w + 1, end):
            first[k - begin] = count
        w = end
    first[rows - begin] = count
    return count
