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

from mat_core.curves.conics import is_conic
from mat_core.curves.continuing import goes_on
from mat_core.curves.exact import conic_pieces
from mat_core.curves.pieces import NO_FIT, NO_ROOM, P_PART, P_ROW, Pieces
from mat_core.curves.stretch import free_stretch, stricter
from mat_core.curves.way import Scratch, Track
from mat_core.kernels.jit import jit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@jit
def travel(
    track: Track, skeleton_i: Ints, skeleton_s: Floats, run_start: Ints, run_strip: Ints, run_forward: Flags, work: Floats
) -> None:
    """Rows of the track's `strip_i` and `strip_s`: the strips of all runs one after the other, each in the direction of travel.

    joined: a strip goes on where the one before it ends, along one analytic curve on either side.
    """
    for g in range(run_start.shape[0] - 1):
        for w in range(run_start[g], run_start[g + 1]):
            strip = run_strip[w]
            for m in range(4):
                # backwards left becomes right, the last disc the first, and either side is passed from its other end
                track.strip_i[w, m] = skeleton_i[strip, m if run_forward[w] else m ^ 1]
                track.strip_s[w, m] = skeleton_s[strip, m if run_forward[w] else 3 - m]
            track.joined[w] = False
            if w > run_start[g]:
                # u rises on the right and falls on the left
                right = goes_on(track.si, track.sf, track.cp, track.strip_i[w - 1, 0], track.strip_i[w, 0], work)
                left = goes_on(track.si, track.sf, track.cp, track.strip_i[w, 1], track.strip_i[w - 1, 1], work)
                track.joined[w] = right and left


@jit
def fit_strips(track: Track, scratch: Scratch, pieces: Pieces, tolerance: float, begin: int, rows: int) -> int:
    """Pieces of the strips in rows begin .. rows - 1 of the track; their number or a status.

    The strip of row `begin` is not joined to the one before. The pieces of a stretch stand at the first of its strips:
    first[w - begin] .. first[w + 1 - begin]. NO_ROOM when the tables are too small, NO_FIT - w when the strips from row w on
    cannot be followed.
    """
    joined = track.joined
    first = pieces.first
    count = int(np.int64(0))
    pieces.piece_i[0, P_PART] = 0
    pieces.piece_i[0, P_ROW] = 0
    w = begin
    while w < rows:
        first[w - begin] = count
        end = w + 1
        if is_conic(track.si, track.strip_i[w, 0], track.strip_i[w, 1]):
            count = conic_pieces(track, scratch, pieces, w, count)
        else:
            while end < rows and joined[end]:
                end += 1
            before = count
            strict = stricter(track, w, end, tolerance)
            # a footpoint that belongs to its disc only to rounding misleads on its own side, not on the other one; and no curve
            # follows an axis more closely than its discs are known, as beside a leaf at a joint that is smooth but for a kink
            for attempt in range(4 if strict < tolerance else 2):
                within = strict if strict < tolerance and attempt < 2 else tolerance
                count = free_stretch(track, scratch, pieces, w, end, attempt & 1, within, before)
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
