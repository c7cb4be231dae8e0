"""Tables of fitted pieces and of the way along their strips: what conics and polynomials share."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.way import ROWS, WAY_HI, WAY_LO, WAY_PARTNER, WAY_S0, WAY_S1, WAY_SITE, Track
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import FAN, KIND, LEN, SPIRAL, SWEEP

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# columns of the tables of pieces and of their parts, one for each strip a piece passes
P_PART, P_DEGREE, P_KIND, P_ROW = range(4)  # piece_i; P_PART: its first part; P_ROW: its first control point
P_ERROR, P_LENGTH = range(2)  # piece_f, normalised
Q_ROW, Q_SIDE = range(2)  # part_i; Q_SIDE 0: s is on the right site of the strip in row Q_ROW, 1: on its left one
Q_T0, Q_T1, Q_S0, Q_S1 = range(4)  # part_f: the piece's own parameter and s, at the part's start and end

MAX_PIECES = 256  # of one stretch; smooth ones need far fewer at any tolerance
NO_ROOM = -1  # status: the piece tables are too small
NO_FIT = -2  # status: a strip cannot be followed
CLOSED_FORM_BONUS = 0.1  # sample a free-form side unless it is this much shorter than a closed one: a cheap partner


class Pieces(NamedTuple):
    """Room for the pieces of all strips and for their parts; where a piece ends in `cp` and the parts stands in the next row."""

    first: Ints  # (W + 1,) first piece of each strip; those of a stretch stand at the first of its strips
    piece_i: Ints  # (n + 1, 4)
    piece_f: Floats  # (n, 2)
    cp: Floats  # (ROWS n, 4) x, y, r, w
    part_i: Ints  # (k, 2)
    part_f: Floats  # (k, 4)


def new_pieces(room: int, strips: int) -> Pieces:
    """Tables for so many pieces of so many strips."""
    return Pieces(
        np.empty(strips + 1, dtype=np.int64),
        np.empty((room + 1, 4), dtype=np.int64),
        np.empty((room, 2)),
        np.empty((ROWS * room, 4)),
        np.empty((room + strips, 2), dtype=np.int64),
        np.empty((room + strips, 4)),
    )


@inner
def _roll(track: Track, i: int, s0: float, s1: float, r0: float, r1: float) -> float:
    """How far the disc rolls along a side, roughly."""
    if track.si[i, KIND] == FAN:
        return abs(track.sf[i, SWEEP] * (s1 - s0)) * 0.5 * (r0 + r1)
    return abs(track.sf[i, LEN] * (s1 - s0))


@inner
def choose_side(track: Track, w: int) -> int:
    """The side to sample through: the longer travel; free-form against closed form is preferred for its speed."""
    a = track.strip_i[w, 0]
    b = track.strip_i[w, 1]
    r0 = track.disc[track.strip_i[w, 2], 2]
    r1 = track.disc[track.strip_i[w, 3], 2]
    along_a = _roll(track, a, track.strip_s[w, 0], track.strip_s[w, 1], r0, r1)
    along_b = _roll(track, b, track.strip_s[w, 2], track.strip_s[w, 3], r0, r1)
    if track.si[a, KIND] == SPIRAL and track.si[b, KIND] != SPIRAL:
        along_b *= CLOSED_FORM_BONUS
    elif track.si[b, KIND] == SPIRAL and track.si[a, KIND] != SPIRAL:
        along_a *= CLOSED_FORM_BONUS
    return 0 if along_a >= along_b else 1


@inner
def lay_way(track: Track, w: int, side: int) -> None:
    """Row w of the way: its strip, sampled through its right (0) or left (1) site."""
    track.way_i[w, WAY_SITE] = track.strip_i[w, side]
    track.way_i[w, WAY_PARTNER] = track.strip_i[w, 1 - side]
    track.way_f[w, WAY_S0] = track.strip_s[w, 2 * side]
    track.way_f[w, WAY_S1] = track.strip_s[w, 2 * side + 1]
    track.way_f[w, WAY_LO] = track.strip_s[w, 3 if side == 0 else 0]
    track.way_f[w, WAY_HI] = track.strip_s[w, 2 if side == 0 else 1]


@inner
def polygon_length(cp: Floats, row: int, degree: int) -> float:
    """Between the chord and the control polygon, in (x, y): (2 chord + (n - 1) polygon) / (n + 1) (Gravesen 1997)."""
    polygon = 0.0
    for k in range(degree):
        polygon += math.hypot(cp[row + k + 1, 0] - cp[row + k, 0], cp[row + k + 1, 1] - cp[row + k, 1])
    chord = math.hypot(cp[row + degree, 0] - cp[row, 0], cp[row + degree, 1] - cp[row, 1])
    return (2.0 * chord + (degree - 1.0) * polygon) / (degree + 1.0)


@inner
def add_part(
    pieces: Pieces, p: int, more: int, row: int, side: int, t0: float, t1: float, s0: float, s1: float
) -> None:
    """Part number `more` of piece p; parts of the next piece begin behind it."""
    q = pieces.piece_i[p, P_PART] + more
    pieces.part_i[q, Q_ROW] = row
    pieces.part_i[q, Q_SIDE] = side
    pieces.part_f[q, Q_T0] = t0
    pieces.part_f[q, Q_T1] = t1
    pieces.part_f[q, Q_S0] = s0
    pieces.part_f[q, Q_S1] = s1
    pieces.piece_i[p + 1, P_PART] = q + 1
