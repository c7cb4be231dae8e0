"""The table of operations on an axis: by name, with the rules of their arguments; what the service routes are made from.

An entry is all that a new operation needs here. Arguments go to the function by their own names.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from mat_core.analysis.arguments import Argument, number, point_list, truth_value
from mat_core.analysis.centerline import Centerline, centerline
from mat_core.analysis.inscribed import inscribed_discs
from mat_core.analysis.nearest import nearest
from mat_core.analysis.offset import TOLERANCE_RANGE, offset
from mat_core.analysis.prune import prune
from mat_core.analysis.pruned import PrunedAxis
from mat_core.analysis.reconstruct import Reconstruction, reconstruct
from mat_core.analysis.regions import Offset
from mat_core.analysis.spans import stretch
from mat_core.analysis.width import width
from mat_core.axis import Point
from mat_core.model.curve import RationalBSpline


class Result(Protocol):
    """What an operation gives."""

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        ...


@dataclass(frozen=True, slots=True)
class Operation:
    """An operation on an axis.

    Attributes
    ----------
    name : str
        Its address in the service, below /v1.
    call : callable
        The function: an axis and keyword arguments in, a `Result` out.
    arguments : mapping
        The rules of its arguments by name.
    paths : callable or None
        The curves in a result, head to tail along each path, where it can be drawn.
    encloses : bool
        Whether these paths bound regions.
    at_least_one : bool
        Whether some argument must be given, whichever.
    """

    name: str
    call: Callable[..., Result]
    arguments: Mapping[str, Argument] = field(default_factory=dict)
    paths: Callable[[Any], list[list[RationalBSpline]]] | None = None
    encloses: bool = False
    at_least_one: bool = False


def _loops(result: Offset) -> list[list[RationalBSpline]]:
    return [[edge.curve for edge in loop.edges] for loop in result.loops]


def _path(result: Centerline) -> list[list[RationalBSpline]]:
    """The path with its extensions, from its start to its end."""
    segments = (result.axis.segments[g] for g, _ in result.path)
    curves = [RationalBSpline(s.degree, s.knots, s.control_points, s.weights) for s in segments]
    turned = [c if forward else _reversed(c) for c, (_, forward) in zip(curves, result.path, strict=True)]
    before = [_line(result.before.end, result.before.start)] if result.before else []
    after = [_line(result.after.start, result.after.end)] if result.after else []
    return [[*before, *turned, *after]]


def _reversed(curve: RationalBSpline) -> RationalBSpline:
    first, last = curve.domain
    return RationalBSpline(curve.degree, (first + last - curve.knots)[::-1], curve.control_points[::-1], curve.weights[::-1])


def _line(start: Point, end: Point) -> RationalBSpline:
    return RationalBSpline(1, np.array([0.0, 0.0, 1.0, 1.0]), np.array([start, end]), np.ones(2))


def _kept(result: PrunedAxis) -> list[list[RationalBSpline]]:
    """Each segment that is kept."""
    curves = []
    for s in result.segments:
        degree, knots, rows = stretch(result.axis, s.segment, s.t0, s.t1)
        curves.append([RationalBSpline(degree, knots, rows[:, :2], rows[:, 3])])
    return curves


def _boundary(result: Reconstruction) -> list[list[RationalBSpline]]:
    return [list(loop) for loop in (result.outer, *result.holes)]


OPERATIONS = {
    operation.name: operation
    for operation in (
        Operation(
            "offset",
            offset,
            {
                "distance": number(other_than=0.0, required=True, unit="a length in the caller's unit, inward if positive"),
                "tolerance": number(*TOLERANCE_RANGE),
            },
            _loops,
            encloses=True,
        ),
        Operation("inscribed-disc", inscribed_discs, {"prominence": number(0.0)}),
        Operation("width", width, {"limit": number(0.0), "angle": number(0.0, math.pi, unit="radians")}),
        Operation(
            "prune",
            prune,
            {
                "angle": number(0.0, math.pi, unit="radians"),
                "length": number(0.0),
                "radius_ratio": number(1.0),
                "scale": number(1.0),
            },
            _kept,
            at_least_one=True,
        ),
        Operation("reconstruct", reconstruct, paths=_boundary, encloses=True),
        Operation("centerline", centerline, {"extend": truth_value()}, _path),
        Operation("nearest", nearest, {"points": point_list()}),
    )
}
