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
    number = np.full(len(outline.measures), -1)
    number[loops] = np.arange(len(loops))
    ring_of = number[outline.pi[:, LOOP]]
    pieces = np.flatnonzero(ring_of >= 0)
    ring_of = ring_of[pieces]
    degree = outline.pi[pieces, DEG]
    rows = outline.pi[pieces, CP0]
    chords = np.ones(len(pieces), dtype=np.int64)
    error = np.zeros(len(pieces))
    most = max(FEWEST_CHORDS, min(MOST_CHORDS, MOST_POINTS // len(pieces)))
    curved = np.unique(degree[degree > 1]).tolist()
    for p in curved:
        chosen = np.flatnonzero(degree == p)
        bend = bend_bound(outline.cp[rows[chosen, None] + np.arange(p + 1)])
        wanted = np.clip(np.sqrt(bend / (8.0 * CHORD_ERROR)), FEWEST_CHORDS, most)
        chords[chosen] = np.exp2(np.ceil(np.log2(wanted)))
        error[chosen] = bend / (8.0 * chords[chosen] ** 2)
    start = np.cumsum(chords) - chords
    points = np.empty((int(chords.sum()), 2))
    points[start] = outline.cp[rows, :2]
    for p in curved:
        for count in np.unique(chords[degree == p]).tolist():
            chosen = np.flatnonzero((degree == p) & (chords == count))
            cp = outline.cp[rows[chosen, None] + np.arange(p + 1)]
            cp[..., :2] *= cp[..., 2:]
            sums = basis(p, count) @ cp
            points[start[chosen, None] + np.arange(1, count)] = sums[..., :2] / sums[..., 2:]
    worst = np.zeros(len(loops))
    np.maximum.at(worst, ring_of, error)
    return Flattening(shapely.linearrings(points, indices=np.repeat(ring_of, chords)), worst)


def bend_bound(cp: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bounds (k,) of |C''| for k pieces of one degree p >= 2, control points (k, p + 1, 3)."""
    p = cp.shape[1] - 1
    w = cp[..., 2:] / cp[..., 2:].max(axis=1, keepdims=True)
    q = cp[..., :2] - cp[:, :1, :2]
    least = w.min(axis=(1, 2))
    far = _longest(q)
    wq1 = np.diff(w * q, axis=1)
    w1 = np.diff(w, axis=1)
    turn = p * _longest(w1)
    speed = (p * _longest(wq1) + turn * far) / least
    bend: NDArray[np.float64] = p * (p - 1) * (_longest(np.diff(wq1, axis=1)) + _longest(np.diff(w1, axis=1)) * far)
    return (bend + 2.0 * turn * speed) / least


def _longest(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest length (k,) among the vectors (k, n, 1 or 2) of each row."""
    found: NDArray[np.float64] = np.sqrt(np.square(vectors).sum(axis=2).max(axis=1))
    return found


@cache
def basis(degree: int, chords: int) -> NDArray[np.float64]:
    """Bernstein polynomials at the inner ends of equal chords: (chords - 1, degree + 1)."""
    t = np.arange(1, chords)[:, None] / chords
    j = np.arange(degree + 1)
    binomials = np.array([float(math.comb(degree, k)) for k in j.tolist()])
    values: NDArray[np.float64] = binomials * t**j * (1.0 - t) ** (degree - j)
    return values


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
