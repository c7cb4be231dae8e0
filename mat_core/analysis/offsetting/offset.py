"""Offsets of a domain by its medial axis, inward and outward: the entry. `inward` tells how."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mat_core.analysis.offsetting.inward import InwardOffsets
from mat_core.analysis.offsetting.outward import OutwardOffsets
from mat_core.analysis.offsetting.regions import Offset
from mat_core.analysis.options import real
from mat_core.axis import MedialAxis
from mat_core.errors import UnsupportedOption

FARTHEST = 1e6  # of the size, outward: seen from farther away the domain loses its shape to rounding
CLOSEST = 1e-14  # of the size: nearer, a curve and its parallel are one to doubles
TOLERANCE_RANGE = (1e-13, 0.1)  # relative, of fitted edges


def offset(axis: MedialAxis, distance: float, tolerance: float | None = None) -> Offset:
    """All points at a distance from the boundary.

    Parameters
    ----------
    axis : MedialAxis
        Of the domain to be offset.
    distance : float
        In the caller's unit, at least 1e-14 of the domain's size; positive inward, negative outward. Beyond the largest
        maximal disc the result is empty.
        Outward the exterior is solved, too: as long as an axis takes.
    tolerance : float, optional
        Largest error of fitted edges, relative to the larger side of the bounding box, 1e-13 to 0.1; the axis's own if left
        out. Parallels of lines, circular arcs and reflex vertices are exact.

    Returns
    -------
    Offset

    Raises
    ------
    UnsupportedOption
        The distance is zero, not finite, too small, or outward by more than a million times the size, or the tolerance is
        out of range.
    NotCertified
        Outward: the exterior has no certified axis. Inward: the loops do not fit the axis (a defect of the
        axis), or the error of a fitted edge could not be bounded.
    """
    return offsets(axis, (distance,), tolerance)[0]


def offsets(axis: MedialAxis, distances: Sequence[float], tolerance: float | None = None) -> tuple[Offset, ...]:
    """`offset` for several distances at once: what they share is done once, the exterior too."""
    values = [_checked(distance, axis.domain.size) for distance in distances]
    wanted = axis.tolerance if tolerance is None else real("tolerance", tolerance)
    if not TOLERANCE_RANGE[0] <= wanted <= TOLERANCE_RANGE[1]:
        raise UnsupportedOption("tolerance", f"{tolerance} is not between {TOLERANCE_RANGE[0]} and {TOLERANCE_RANGE[1]}")
    accuracy = wanted * axis.domain.size
    inside = InwardOffsets(axis)
    farthest = -min(values, default=0.0)
    if farthest <= 0.0:
        return tuple(Offset(d, inside.regions(d, accuracy)) for d in values)
    if farthest > FARTHEST * axis.domain.size:
        raise UnsupportedOption("distance", f"{-farthest} is outward by more than {FARTHEST:g} times the size of the domain")
    outside = OutwardOffsets(axis, farthest)
    return tuple(
        Offset(d, inside.regions(d, accuracy) if d > 0.0 else (outside.region(-d, accuracy),)) for d in values
    )


def _checked(distance: float, size: float) -> float:
    """The distance as a float, if it may be one."""
    value = real("distance", distance)
    if value == 0.0 or not math.isfinite(value):
        raise UnsupportedOption("distance", f"{distance} is not a finite number other than 0")
    if abs(value) < CLOSEST * size:
        raise UnsupportedOption("distance", f"{distance} is less than {CLOSEST:g} times the size of the domain, {size:g}")
    return value
