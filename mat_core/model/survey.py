"""What the rules of a valid domain ask of all edges at once, measured in one go.

A domain that keeps the rules is proved to do so by comparing a few figures; only where that proof fails is every edge looked at,
to find and to word what is wrong.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

LARGEST = 1e150  # coordinates: areas, their squares, still are floats
WIDEST = 1e16  # largest weight over smallest: beyond, whole stretches of a curve fall between two floats
HALF_RANGE = 8e307  # half of a parameter range that still is a float


class Survey(NamedTuple):
    """Lengths of E edges along x or y, in the caller's unit; no numbers where coordinates are none."""

    extent: NDArray[np.float64]  # (E,) largest distance of an edge's control points from its first one
    gaps: NDArray[np.float64]  # (E,) by how much the end of each edge misses the start of the next one
    largest: float  # magnitude of a coordinate, of those that are usable: not beyond LARGEST
    size: float  # the larger side of the box of all points with usable coordinates
    box: tuple[float, float, float, float]  # xmin, ymin, xmax, ymax of all control points; meaningless if not usable
    sound: bool  # all coordinates are usable, all weights and knots keep their rules, for sure
    least_extent: float
    widest_gap: float


def surveyed(
    facts: NDArray[np.float64], extent: NDArray[np.float64], gaps: NDArray[np.float64], cp: NDArray[np.float64]
) -> Survey:
    """What `mat_core.kernels.survey` measured, the rules on sizes applied."""
    reach, x0, y0, x1, y1, least_extent, lightest, heaviest, widest_gap, sound_knots = facts.tolist()
    usable = reach <= LARGEST
    sound = usable and sound_knots == 1.0 and lightest > 0.0 and heaviest <= WIDEST * lightest < math.inf
    largest, size = (reach, max(x1 - x0, y1 - y0)) if usable else _usable_extremes(cp)
    return Survey(extent, gaps, largest, size, (x0, y0, x1, y1), sound, least_extent, widest_gap)


def _usable_extremes(cp: NDArray[np.float64]) -> tuple[float, float]:
    """`largest` and `size` where some coordinates are not usable."""
    magnitudes = np.abs(cp[:, :2])
    fits = magnitudes <= LARGEST
    points = cp[fits.all(axis=1), :2]
    size = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    return float(magnitudes.max(initial=0.0, where=fits)), size
