"""What is checked, against which limit, and how the figures become the answer's `certificate`."""

from __future__ import annotations

import math
import sys
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
        LENGTH, 1e-9, "largest gap between neighbouring boundary pieces, or between a piece and the input's edge"
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

ROUNDING = 16 * float(
    np.finfo(float).eps
)  # granted to lengths, relative to the largest coordinate: the input is not known better


class Report:
    """The worst figure of each check so far and its place; lengths and places in normalised coordinates."""

    def __init__(self) -> None:
        self.figures: dict[str, tuple[float, tuple[float, float] | None]] = {}

    def worst(self, name: str, figures: NDArray[np.float64], points: NDArray[np.float64]) -> None:
        """Take the largest of (n,) figures and its place, row of (n, 2 or more) points; NaN counts as infinite."""
        measured = 0.0
        place = None
        if len(figures):
            i = int(figures.argmax())
            measured = float(figures[i])
            if measured != measured:
                measured = np.inf
            point = points[i]
            place = (float(point[0]), float(point[1]))
        if name not in self.figures or measured > self.figures[name][0]:
            self.figures[name] = (max(measured, 0.0), place)

    def faults(self, name: str, wrong: ArrayLike, points: NDArray[np.float64]) -> None:
        """Add (n,) numbers of faults (or flags); the place is that of the first one, row of (n, 2 or more) points."""
        number = np.asarray(wrong)
        total = int(np.count_nonzero(number)) if number.dtype == np.bool_ else int(np.abs(number).sum())
        before, place = self.figures.get(name, (0.0, None))
        if total and place is None and len(points):
            point = points[min(int((number != 0).argmax()), len(points) - 1)]
            place = (float(point[0]), float(point[1]))
        self.figures[name] = (before + total, place)

    def to_dict(self, size: float, origin: NDArray[np.float64], scale: float, tolerance: float) -> dict[str, Any]:
        """The certificate: every check with figure, limit and place in the caller's coordinates; all numbers finite.

        size: larger side of the bounding box, normalised.
        """
        ox, oy = origin.tolist()
        rounding = ROUNDING * (max(abs(ox), abs(oy)) * scale + 1.0)
        checks: dict[str, dict[str, Any]] = {}
        for name, (measured, place) in self.figures.items():
            check = CHECKS[name]
            limit = tolerance if name == "curves_tolerance" else check.limit
            if check.unit == LENGTH:
                limit += rounding
                measured /= size
            where = None
            if place is not None and math.isfinite(place[0]) and math.isfinite(place[1]):
                where = [place[0] / scale + ox, place[1] / scale + oy]
            checks[name] = {
                "passed": measured <= limit,
                "measured": min(measured, sys.float_info.max),
                "limit": limit,
                "unit": check.unit,
                "place": where,
                "detail": check.detail,
            }
        return {"passed": all(check["passed"] for check in checks.values()), "checks": checks}
