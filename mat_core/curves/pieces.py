"""Tables of fitted pieces and of the way along their strips: what conics and polynomials share."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.way import WAY_HI, WAY_LO, WAY_PARTNER, WAY_S0, WAY_S1, WAY_SITE
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


@inner
def _roll(si: Ints, sf: Floats, i: int, s0: float, s1: float, r0: float, r1: float) -> float:
    """How far the disc rolls along a side, roughly."""
    if si[i, KIND] == FAN:
        return abs(sf[i, SWEEP] * (s1 - s0)) * 0.5 * (r0 + r1)
    return abs(sf[i, LEN] * (s1 - s0))


@inner
def choose_side(si: Ints, sf: Floats, disc: Floats, strip_i: Ints, strip_s: Floats, w: int) -> int:
    """The side to sample through: the longer travel; free-form against closed form is preferred for its speed."""
    a = strip_i[w, 0]
    b = strip_i[w, 1]
    r0 = disc[strip_i[w, 2], 2]
    r1 = disc[strip_i[w, 3], 2]
    along_a = _roll(si, sf, a, strip_s[w, 0], strip_s[w, 1], r0, r1)
    along_b = _roll(si, sf, b, strip_s[w, 2], strip_s[w, 3], r0, r1)
    if si[a, KIND] == SPIRAL and si[b, KIND] != SPIRAL:
        along_b *= CLOSED_FORM_BONUS
    elif si[b, KIND] == SPIRAL and si[a, KIND] != SPIRAL:
        along_a *= CLOSED_FORM_BONUS
    return 0 if along_a >= along_b else 1


@inner
def lay_way(strip_i: Ints, strip_s: Floats, w: int, side: int, way_i: Ints, way_f: Floats) -> None:
    """Row w of the way: its strip, sampled through its right (0) or left (1) site."""
    way_i[w, WAY_SITE] = strip_i[w, side]
    way_i[w, WAY_PARTNER] = strip_i[w, 1 - side]
    way_f[w, WAY_S0] = strip_s[w, 2 * side]
    way_f[w, WAY_S1] = strip_s[w, 2 * side + 1]
    way_f[w, WAY_LO] = strip_s[w, 3 if side == 0 else 0]
    way_f[w, WAY_HI] = strip_s[w, 2 if side == 0 else 1]


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
