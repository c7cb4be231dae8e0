"""What is checked, against which limit, and how the figures become the answer's `certificate`.

Kernels write the worst figure of each check and the place where it occurs to a table; a check passes when its figure does not
exceed its limit (a figure that is not a number never passes).
"""

from __future__ import annotations

import sys
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.jit import jit

# rows of the table of figures
(
    REFERENCES, BOUNDARY, TURNING, COVERAGE, NEIGHBOURS, WHOLE_ARCS, FACES, CONNECTED, CYCLES, LEAVES, SEGMENTS, DEGREES, ORDER,
    NODE_KINDS, DISCS_EMPTY, DISCS_TOUCHING, PARTNERS_RIGHT, PARTNERS_LEFT, CURVES_CONTINUOUS, CURVES_ENDS, CURVES_ON_AXIS,
    CURVES_EMPTY, CURVES_TOLERANCE,
) = range(23)

MEASURED, PLACE_X, PLACE_Y = range(3)  # columns

LENGTH, COUNT, ANGLE = "length", "count", "angle"


class Check(NamedTuple):
    """Name, unit and limit of one check, and what its figure says.

    A length is relative to the larger side of the domain's bounding box; a count is a number of faults.
    """

    name: str
    unit: str
    limit: float
    detail: str


CHECKS = (
    Check("references", COUNT, 0.0, "indices and parameters that point to nothing"),
    Check("boundary", LENGTH, 1e-9, "largest gap between neighbouring boundary pieces, and between pieces and the input's edges"),
    Check("turning", ANGLE, 1e-5, "largest difference of a loop's total turning from a full turn"),
    Check("coverage", LENGTH, 1e-9, "largest part of the boundary that belongs to no strip, or to two"),
    Check("neighbours", COUNT, 0.0, "points of the boundary where neighbouring strips end at different discs"),
    Check("whole_arcs", LENGTH, 1e-9, "largest distance of an arc in whole contact from its disc's circle"),
    Check("faces", COUNT, 0.0, "difference of the number of faces from 1 - holes + sum over discs of (contacts - 1)"),
    Check("connected", COUNT, 0.0, "components of the axis beyond the first"),
    Check("cycles", COUNT, 0.0, "difference of the number of cycles from the number of holes"),
    Check("leaves", COUNT, 0.0, "difference of the number of leaves of radius 0 from the number of convex vertices"),
    Check("segments", COUNT, 0.0, "strips that are in no segment or in two, and segments whose strips do not meet"),
    Check("degrees", COUNT, 0.0, "discs whose strips do not fit their contacts, and nodes whose segments do not fit their strips"),
    Check("order", COUNT, 0.0, "segments directed against the topological order, and nodes missing from it"),
    Check("node_kinds", COUNT, 0.0, "nodes that are not what their kind says"),
    Check("discs_empty", LENGTH, 1e-9, "how deep the boundary reaches into the disc of a node or of a joint"),
    Check("discs_touching", LENGTH, 1e-9, "largest distance of a disc's centre from where a footpoint's normal puts it"),
    Check("partners_right", LENGTH, 1e-8, "the same two figures for discs found anew from footpoints on the right of strips"),
    Check("partners_left", LENGTH, 1e-8, "the same two figures for discs found anew from footpoints on the left of strips"),
    Check("curves_continuous", LENGTH, 1e-12, "largest jump of a fitted curve between its pieces"),
    Check("curves_ends", LENGTH, 1e-9, "distance of fitted curves from the discs they should pass, beyond their stated error"),
    Check("curves_on_axis", LENGTH, 1e-10, "radius less distance to either claimed side, on fitted curves, beyond their stated error"),
    Check("curves_empty", LENGTH, 1e-9, "how deep the boundary reaches into discs of fitted curves, beyond their stated error"),
    Check("curves_tolerance", LENGTH, 0.0, "largest stated error of a fitted curve; the limit is the tolerance asked for"),
)


@jit
def note(report, row, measured, x, y):
    """Keep the larger figure and its place; what is not a number counts as infinite."""
    if measured != measured:
        measured = np.inf
    if measured > report[row, MEASURED]:
        report[row, MEASURED] = measured
        report[row, PLACE_X] = x
        report[row, PLACE_Y] = y


@jit
def count_fault(report, row, x, y):
    """One fault more; the place is the first one's."""
    if report[row, MEASURED] == 0.0:
        report[row, PLACE_X] = x
        report[row, PLACE_Y] = y
    report[row, MEASURED] += 1.0


def new_report() -> NDArray[np.float64]:
    """A table without any figure yet: all 0, no place."""
    report = np.full((len(CHECKS), 3), np.nan)
    report[:, MEASURED] = 0.0
    return report


def to_dict(
    report: NDArray[np.float64], size: float, origin: NDArray[np.float64], scale: float, tolerance: float, rows: range
) -> dict[str, Any]:
    """The certificate: every check with its figure, limit and place, in the caller's coordinates; all numbers finite."""
    checks: dict[str, dict[str, Any]] = {}
    figures = report.tolist()
    ox, oy = origin.tolist()
    passed = True
    for row in rows:
        check = CHECKS[row]
        measured, x, y = figures[row]
        if check.unit == LENGTH:
            measured /= size
        limit = tolerance if row == CURVES_TOLERANCE else check.limit
        good = measured <= limit
        passed = passed and good
        place = None if x != x or y != y else [x / scale + ox, y / scale + oy]
        checks[check.name] = {
            "passed": good,
            "measured": min(measured, sys.float_info.max),
            "limit": limit,
            "unit": check.unit,
            "place": place,
            "detail": check.detail,
        }
    return {"passed": passed, "checks": checks}
