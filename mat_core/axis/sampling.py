"""Where the axis is sampled: evenly in t, and as closely as a step asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from mat_core.axis import MedialAxis

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAMPLES = 17  # points sampled on a segment when no step is asked for
CLOSE_CURVE = 0.1  # of the spacing of samples: a curve this near to the axis stands for it where they are spaced
T_ROUNDING = 1e-14  # samples of parameters nearer than this are not told apart


def spaced_parameters(axis: MedialAxis) -> tuple[Ints, Floats]:
    """(segment, t) of the standard samples; see `MedialAxis.sample_parameters`."""
    count = np.full(len(axis.curves.degree), SAMPLES)
    if axis.step is not None:
        count = np.maximum(count, np.ceil(axis.lengths / (axis.step * axis.domain.size)).astype(np.int64) + 1)
    segment = np.repeat(np.arange(len(count)), count)
    first = np.cumsum(count) - count
    t = (np.arange(len(segment)) - first[segment]) / np.maximum(count - 1, 1)[segment]
    # t runs only nearly in proportion to length: what is still too wide is divided until nothing is
    while axis.step is not None:
        parts = _parts_needed(axis, segment, t, axis.step * axis.domain.size)
        if not (parts > 1).any():
            break
        before = np.repeat(np.arange(len(parts)), parts - 1)
        place = np.arange(len(before)) - np.repeat(np.cumsum(parts - 1) - (parts - 1), parts - 1) + 1
        between = t[before] + place / parts[before] * (t[before + 1] - t[before])
        segment, t = np.insert(segment, before + 1, segment[before]), np.insert(t, before + 1, between)
    return segment, t


def _parts_needed(axis: MedialAxis, segment: Ints, t: Floats, spacing: float) -> Ints:
    """Into how many parts each interval between neighbouring samples must be divided so that none is wider than `spacing`."""
    error = float(axis.curves.max_error.max(initial=0.0)) / axis.table.scale
    if error <= CLOSE_CURVE * spacing:
        # true axis points lie within the stated error of the curve
        points = axis.evaluate(segment, t)[:, :2]
        spacing -= 2.0 * error
    else:
        points = axis.sample(segment, t).points
    wide = np.hypot(*np.diff(points, axis=0).T)
    inside = (segment[1:] == segment[:-1]) & (np.diff(t) > T_ROUNDING)
    return np.where(inside, np.maximum(np.ceil(wide / spacing), 1.0), 1.0).astype(np.int64)
