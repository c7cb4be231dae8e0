"""Loops as polygons of known error, for the questions shapely answers.

A chord of C over a stretch h of its parameter strays from it by at most h**2 / 8 max |C''|. With X = sum B_j w_j Q_j and
W = sum B_j w_j about the first control point (Q_j = P_j - P_0, d = max |Q_j|, weights scaled to at most 1):

    |C'| <= c1 = (p max |D(wQ)| + p max |Dw| d) / min w
    |C''| <= (p (p - 1) max |D2(wQ)| + 2 p max |Dw| c1 + p (p - 1) max |D2 w| d) / min w

D and D2 being first and second differences over j. Exact for parabolas, some five times too large for a quarter circle.
The loop can be moved onto its polygon without leaving that distance, so a point farther from the polygon than that lies
inside the one just when it lies inside the other.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core.kernels.outline import CP0, DEG, LOOP
from mat_core.model.loop import Outline

CHORD_ERROR = 1e-3  # normalised, aimed at: most loops are farther apart, those that are not are decided exactly
FEWEST_CHORDS = 2  # of a curve, so that two curves make a ring
MOST_CHORDS = 64  # of a curve
MOST_POINTS = 500_000  # about; beyond it curves get fewer chords, and the error grows
PLACE = re.compile(r"(.*)\[(\S+) (\S+)\]")


class Flattening(NamedTuple):
    """Polygons of some loops of an outline, in normalised coordinates."""

    rings: NDArray[Any]  # (K,) shapely.LinearRing
    error: NDArray[np.float64]  # (K,) largest distance between a loop and its ring


def flatten(outline: Outline, loops: Sequence[int]) -> Flattening:
    """Rings of the loops named (ascending). Assumes that each encloses some area or crosses itself."""
    ring_of = np.full(len(outline.measures), -1)
    ring_of[loops] = np.arange(len(loops))
    ring = ring_of[outline.pi[:, LOOP]]
    pieces = np.flatnonzero(ring >= 0)
    ring = ring[pieces]
    degree = outline.pi[pieces, DEG]
    rows = outline.pi[pieces, CP0]
    most = max(FEWEST_CHORDS, min(MOST_CHORDS, MOST_POINTS // len(pieces)))
    chords = np.ones(len(pieces), dtype=np.int64)
    error = np.zeros(len(pieces))
    curves = []
    for p in set(degree.tolist()) - {1}:
        chosen = np.flatnonzero(degree == p)
        cp = outline.cp[rows[chosen, None] + np.arange(p + 1)]
        bend = bend_bound(cp)
        # One number for all pieces of a degree; extreme weights make the bound infinite.
        wanted = math.sqrt(min(float(bend.max()) / (8.0 * CHORD_ERROR), most**2))
        count = max(FEWEST_CHORDS, math.ceil(wanted))
        chords[chosen] = count
        error[chosen] = bend / (8.0 * count**2)
        curves.append((chosen, basis(p, count), cp))
    start = np.cumsum(chords) - chords
    points = np.empty((int(chords.sum()), 2))
    points[start] = outline.cp[rows, :2]
    for chosen, values, cp in curves:
        cp[..., :2] *= cp[..., 2:]
        sums = values @ cp
        points[start[chosen, None] + np.arange(1, len(values) + 1)] = sums[..., :2] / sums[..., 2:]
    worst = np.maximum.reduceat(error, np.searchsorted(ring, np.arange(len(loops))))
    return Flattening(shapely.linearrings(points, indices=np.repeat(ring, chords)), worst)


def bend_bound(cp: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bounds (k,) of |C''| for k pieces of one degree p >= 2, control points (k, p + 1, 3)."""
    p = cp.shape[1] - 1
    q = cp[..., :2] - cp[:, :1, :2]
    w = cp[..., 2:]
    if (w == w[:, :1]).all():
        return _floats(p * (p - 1) * _longest(q[:, 2:] - 2.0 * q[:, 1:-1] + q[:, :-2]))
    w = w / w.max(axis=1, keepdims=True)
    least = w.min(axis=(1, 2))
    far = _longest(q)
    wq1 = np.diff(w * q, axis=1)
    w1 = np.diff(w, axis=1)
    turn = p * _longest(w1)
    speed = (p * _longest(wq1) + turn * far) / least
    bend = p * (p - 1) * (_longest(np.diff(wq1, axis=1)) + _longest(np.diff(w1, axis=1)) * far)
    return _floats((bend + 2.0 * turn * speed) / least)


def _longest(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest length (k,) among the vectors (k, n, 1 or 2) of each row."""
    return _floats(np.sqrt(np.einsum("kni,kni->kn", vectors, vectors).max(axis=1)))


def _floats(values: Any) -> NDArray[np.float64]:
    """What NumPy is known to return, for the type checker."""
    return np.asarray(values, dtype=np.float64)


@cache
def basis(degree: int, chords: int) -> NDArray[np.float64]:
    """Bernstein polynomials at the inner ends of equal chords: (chords - 1, degree + 1)."""
    t = np.arange(1, chords)[:, None] / chords
    j = np.arange(degree + 1)
    binomials = np.array([float(math.comb(degree, k)) for k in j.tolist()])
    return _floats(binomials * t**j * (1.0 - t) ** (degree - j))


def second_opinion(outline: Outline, loops: Sequence[int]) -> dict[int, str]:
    """What shapely makes of each of these loops, which the exact rule found to meet themselves: half a sentence."""
    flattening = flatten(outline, loops)
    reasons = shapely.is_valid_reason(shapely.polygons(flattening.rings)).tolist()
    words = {}
    for loop, reason, error in zip(loops, reasons, flattening.error.tolist(), strict=True):
        polygon = f"a polygon within {error / outline.frame.scale:.2g} of the loop" if error > 0.0 else "the polygon"
        place = PLACE.fullmatch(reason)
        if place is None:
            words[loop] = f"{polygon} is too coarse to show it"
        else:
            x, y = outline.frame.to_input(float(place[2]), float(place[3]))
            words[loop] = f'shapely finds "{place[1]}" at ({x:.9g}, {y:.9g}) on {polygon}'
    return words
