"""What is checked, against which limit, and how the figures become the answer's `certificate`."""

from __future__ import annotations

import math
import sys
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
    "partners_right": Check(LENGTH, 1e-8, "the same two figures for discs found anew from the right sides of strips"),
    "partners_left": Check(LENGTH, 1e-8, "the same two figures for discs found anew from the left sides of strips"),
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


class Figures(NamedTuple):
    """The worst figure of each check so far and its place; lengths and places in normalised coordinates.

    figure (checks,): UNSEEN where a check was not made; place (checks, 2): NaN where none was noted.
    """

    figure: NDArray[np.float64]
    place: NDArray[np.float64]

    @classmethod
    def unseen(cls) -> Figures:
        """None made yet."""
        return cls(np.full(len(CHECKS), UNSEEN), np.full((len(CHECKS), 2), np.nan))

    def take(self, other: Figures) -> None:
        """The larger figure of each check with its place; of equal ones it stays as it was, as in `worst`."""
        larger = other.figure > self.figure
        self.figure[larger] = other.figure[larger]
        self.place[larger] = other.place[larger]


@inner
def made(figures, check):
    """Note that a check is made, whether or not there is anything to look at."""
    if figures.figure[check] < LOWEST:
        figures.figure[check] = LOWEST


@inner
def worst(figures, check, value, x, y):
    """Take a figure at a place if it is the largest so far; NaN counts as infinite."""
    if value != value:
        value = math.inf
    if value > figures.figure[check]:
        figures.figure[check] = value
        figures.place[check, 0] = x
        figures.place[check, 1] = y


@inner
def fault(figures, check, number, x, y):
    """Add a number of faults; the place is that of the first."""
    if figures.figure[check] < 0.0:
        figures.figure[check] = 0.0
    if number > 0 and figures.figure[check] == 0.0:
        figures.place[check, 0] = x
        figures.place[check, 1] = y
    figures.figure[check] += number


def to_dict(
    figures: Figures, size: float, origin: NDArray[np.float64], scale: float, tolerance: float
) -> dict[str, Any]:
    """The certificate: every check with figure, limit and place in the caller's coordinates; all numbers finite.

    size: larger side of the bounding box, normalised.
    """
    ox, oy = origin.tolist()
    rounding = ROUNDING * (max(abs(ox), abs(oy)) * scale + 1.0)
    checks: dict[str, dict[str, Any]] = {}
    passed = True
    for (name, check), measured, (x, y) in zip(
        CHECKS.items(), figures.figure.tolist(), figures.place.tolist(), strict=True
    ):
        if measured == UNSEEN:
            continue
        measured = max(measured, 0.0)
        limit = tolerance if name == "curves_tolerance" else check.limit
        if check.unit == LENGTH:
            limit += rounding
            measured /= size
        passed = passed and measured <= limit
        checks[name] = {
            "passed": measured <= limit,
            "measured": min(measured, sys.float_info.max),
            "limit": limit,
            "unit": check.unit,
            "place": [x / scale + ox, y / scale + oy] if math.isfinite(x) and math.isfinite(y) else None,
            "detail": check.detail,
        }
    return {"passed": passed, "checks": checks}
