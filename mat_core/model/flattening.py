"""Loops as polygons of known error (`mat_core.kernels.flattening`), for the questions shapely answers.

A loop can be moved onto its polygon without leaving that distance, so a point farther from the polygon than that lies inside the
one just when it lies inside the other.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core.kernels.flattening import FEWEST_CHORDS, flatten_loops
from mat_core.kernels.outline import BLOCK
from mat_core.model.loop import Outline

CHORD_ERROR = 1e-3  # normalised, aimed at: most loops are farther apart, those that are not are decided exactly
MOST_CHORDS = 64  # of a curve
MOST_POINTS = 500_000  # about; beyond it curves get fewer chords, and the error grows
PLACE = re.compile(r"(.*)\[(\S+) (\S+)\]")


class Flattening(NamedTuple):
    """Polygons of some loops of an outline, in normalised coordinates."""

    rings: NDArray[Any]  # (K,) shapely.LinearRing
    error: NDArray[np.float64]  # (K,) largest distance between a loop and its ring


def flatten(outline: Outline, loops: Sequence[int] | NDArray[np.int64]) -> Flattening:
    """Rings of the loops named (ascending). Assumes that each encloses some area or crosses itself."""
    chosen = np.asarray(loops, dtype=np.int64)
    pieces = int((outline.piece_start[chosen + 1] - outline.piece_start[chosen]).sum())
    most = max(FEWEST_CHORDS, min(MOST_CHORDS, MOST_POINTS // pieces))
    points, ring = np.empty((most * pieces, 2)), np.empty(most * pieces, dtype=np.int64)
    bend, worst, error = np.empty(len(outline.pi)), np.empty(BLOCK), np.empty(len(chosen))
    n = flatten_loops(
        outline.pi, outline.cp, outline.piece_start, chosen, CHORD_ERROR, most, bend, worst, points, ring, error
    )
    return Flattening(shapely.linearrings(points[:n], indices=ring[:n]), error)


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
