"""What is checked, against which limit, and how the figures become the answer's `certificate`."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.jit import inner

LENGTH, COUNT, ANGLE = "length", "count", "angle"


class Check(NamedTuple):
    """Unit and limit of one check, and what its figure says.

    A length is relative to the larger side of the domain's bounding box; a count is a number of faults; an angle is in
    radians.
    """

    unit: str
    limit: float
    detail: str


CHECKS = {
    "references": Check(COUNT, 0.0, "indices and parameters that point to nothing"),
    "boundary": Check(
        LENGTH,
        1e-9,
        "largest gap between neighbouring boundary pieces, or, beyond the rounding of its parameter, between one and its edge",
    ),
    "turning": Check(ANGLE, 1e-5, "largest difference of a loop's total turning from a full turn"),
    "coverage": Check(LENGTH, 1e-9, "largest part of the boundary that belongs to no strip, or to two"),
    "neighbours": Check(COUNT, 0.0, "points of the boundary where neighbouring strips end at different discs"),
    "whole_arcs": Check(LENGTH, 1e-9, "largest distance of an arc in whole contact from its disc's circle"),
    "faces": Check(COUNT, 0.0, "faces more or less than 1 - holes + sum over discs of (contacts - 1)"),
    "connected": Check(COUNT, 0.0, "components of the axis beyond the first"),
    "cycles": Check(COUNT, 0.0, "cycles of the axis more or less than holes of the domain"),
    "leaves": Check(COUNT, 0.0, "leaves of radius 0 more or less than convex vertices"),
    "segments": Check(COUNT, 0.0, "strips in no segment or in two, and strips of a segment that do not meet"),
    "degrees": Check(
        COUNT, 0.0, "discs whose strips do not fit their contacts, nodes whose segments do not fit their strips"
    ),
    "order": Check(COUNT, 0.0, "segments directed against the topological order, and nodes missing from it"),
    "node_kinds": Check(COUNT, 0.0, "nodes that are not what their kind says"),
    "discs_empty": Check(LENGTH, 1e-9, "how deep the boundary reaches into the disc of a node or of a joint"),
    "discs_touching": Check(
        LENGTH, 1e-9, "largest distance of a disc's centre from where a footpoint's normal puts it"
    ),
    "partners_right": Check(
        LENGTH, 1e-8, "the same two figures for discs found anew from the right sides of strips, or those of conics"
    ),
    "partners_left": Check(
        LENGTH, 1e-8, "the same two figures for discs found anew from the left sides of strips, or those of conics"
    ),
    "curves_continuous": Check(LENGTH, 1e-12, "largest jump of a curve between its pieces"),
    "curves_ends": Check(LENGTH, 1e-9, "distance of curves from the discs they should pass, beyond their stated error"),
    "curves_on_axis": Check(
        LENGTH, 1e-10, "distance to either side less radius, along curves, beyond their stated error"
    ),
    "curves_empty": Check(
        LENGTH, 1e-9, "how deep the boundary reaches into discs along curves, beyond their stated error"
    ),
    "curves_tolerance": Check(
        LENGTH, 0.0, "largest stated error of a curve; the limit is the tolerance asked for, and the rounding of coordinates"
    ),
}

(
    REFERENCES, BOUNDARY, TURNING, COVERAGE, NEIGHBOURS, WHOLE_ARCS, FACES, CONNECTED, CYCLES, LEAVES, SEGMENTS, DEGREES, ORDER,
    NODE_KINDS, DISCS_EMPTY, DISCS_TOUCHING, PARTNERS_RIGHT, PARTNERS_LEFT, CURVES_CONTINUOUS, CURVES_ENDS, CURVES_ON_AXIS,
    CURVES_EMPTY, CURVES_TOLERANCE,
) = range(len(CHECKS))  # rows of the figures, in the order of CHECKS  # fmt: skip

UNSEEN = -math.inf  # figure of a check that was not made
LOWEST = -sys.float_info.max  # of one that was made, and met nothing
ROUNDING = 16 * float(
    np.finfo(float).eps
)  # granted to lengths, relative to the largest coordinate: the input is not known better

# columns of the figures (checks, 4): the worst of each check so far; where, in normalised coordinates; its limit
FIGURE, AT_X, AT_Y, LIMIT = range(4)
_LIMITS = tuple(check.limit for check in CHECKS.values())
_LENGTHS = tuple(check.unit == LENGTH for check in CHECKS.values())
_NONE_MADE = np.array([(UNSEEN, math.nan, math.nan, limit) for limit in _LIMITS])


def no_figures() -> NDArray[np.float64]:
    """The table before any check was made: figure UNSEEN, place NaN."""
    return _NONE_MADE.copy()


def take(figures: NDArray[np.float64], others: NDArray[np.float64]) -> None:
    """The larger figure of each check with its place; of equal ones it stays as it was, as in `worst`."""
    larger = others[:, FIGURE] > figures[:, FIGURE]
    figures[larger] = others[larger]


@inner
def made(figures, check):
    """Note that a check is made, whether or not there is anything to look at."""
    if figures[check, FIGURE] < LOWEST:
        figures[check, FIGURE] = LOWEST


@inner
def worst(figures, check, value, x, y):
    """Take a figure at a place if it is the largest so far; NaN counts as infinite."""
    if value != value:
        value = math.inf
    if value > figures[check, FIGURE]:
        figures[check, FIGURE] = value
        figures[check, AT_X] = x
        figures[check, AT_Y] = y


@inner
def fault(figures, check, number, x, y):
    """Add a number of faults; the place is that of the first."""
    if figures[check, FIGURE] < 0.0:
        figures[check, FIGURE] = 0.0
    if number > 0 and figures[check, FIGURE] == 0.0:
        figures[check, AT_X] = x
        figures[check, AT_Y] = y
    figures[check, FIGURE] += number


@inner
def conclude(figures, size, ox, oy, scale, tolerance):
    """Make lengths relative to the size, places the caller's, and the limits what they are here; 1 if all are kept, else 0.

    size: larger side of the bounding box, normalised. A check that was not made is none that failed.
    """
    rounding = ROUNDING * (max(abs(ox), abs(oy)) * scale + 1.0)
    figures[CURVES_TOLERANCE, LIMIT] = tolerance
    passed = 1
    for check in range(figures.shape[0]):
        if figures[check, FIGURE] == UNSEEN:
            continue
        figures[check, FIGURE] = max(figures[check, FIGURE], 0.0)
        if _LENGTHS[check]:
            figures[check, FIGURE] /= size
            figures[check, LIMIT] += rounding
        figures[check, AT_X] = figures[check, AT_X] / scale + ox
        figures[check, AT_Y] = figures[check, AT_Y] / scale + oy
        if not figures[check, FIGURE] <= figures[check, LIMIT]:
            passed = 0
    return passed


class Certificate(Mapping[str, Any]):
    """The answer's `certificate`: ``passed``, ``checks`` and ``smooth_angle``, if it was told; made when it is read.

    Parameters
    ----------
    figures : (checks, 4) float64
        After `conclude`.
    passed : bool
    smooth_angle : float, optional
        Radians; joints that turn by no more were taken as smooth.
    """

    def __init__(self, figures: NDArray[np.float64], passed: bool, smooth_angle: float | None = None) -> None:
        self._figures = figures
        self.passed = passed
        self._smooth_angle = smooth_angle

    @cached_property
    def _entries(self) -> dict[str, Any]:
        """Every check with figure, limit and place; all numbers finite."""
        checks = {
            name: {
                "passed": measured <= limit,
                "measured": min(measured, sys.float_info.max),
                "limit": limit,
                "unit": check.unit,
                "place": [x, y] if math.isfinite(x) and math.isfinite(y) else None,
                "detail": check.detail,
            }
            for (name, check), (measured, x, y, limit) in zip(CHECKS.items(), self._figures.tolist(), strict=True)
            if measured != UNSEEN
        }
        told = {} if self._smooth_angle is None else {"smooth_angle": self._smooth_angle}
        return {"passed": self.passed, "checks": checks, **told}

    def __getitem__(self, key: str) -> Any:
        return self._entries[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __repr__(self) -> str:
        return repr(self._entries)
