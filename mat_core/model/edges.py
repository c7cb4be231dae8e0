"""One edge of a document looked at by itself: every fault of its form is named."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from numbers import Integral
from typing import Any

from mat_core.errors import Problem
from mat_core.model.values import as_list, as_number, describe, edge_pointer, pointer_to, short

HIGHEST_DEGREE = 25
EDGE_KEYS = frozenset({"degree", "control_points", "knots", "weights"})

Edge = dict[str, Any]
Fault = Callable[..., None]


def read_edge(edge: object, loop: int, index: int, problems: list[Problem]) -> Edge | None:
    """One edge, cleaned, or None after its faults have been noted."""
    at = edge_pointer(loop, index)
    before = len(problems)

    def fault(pointer: str, text: str, code: str = "invalid-request") -> None:
        problems.append(Problem(code, pointer, text, loop, index))

    if not isinstance(edge, Mapping):
        fault(at, f"an edge is an object with degree and control_points, not {describe(edge)}")
        return None
    for key in edge:
        if key not in EDGE_KEYS:
            fault(
                pointer_to(at, key), f"unknown key {short(key)}; an edge has degree, control_points, knots and weights"
            )
    degree = _read_degree(edge, at, fault)
    points = _read_points(edge, at, fault)
    knots = _read_numbers(edge.get("knots"), f"{at}/knots", "knot", fault)
    weights = _read_numbers(edge.get("weights"), f"{at}/weights", "weight", fault)
    if len(problems) > before or degree is None or points is None:
        return None
    n = len(points)
    if n <= degree:
        text = f"a curve of degree {degree} needs at least {degree + 1} control points, here are {n}"
        fault(f"{at}/control_points", text, "invalid-spline")
    elif knots is None and n != degree + 1:
        text = (
            f"knots may be left out only for {degree + 1} control points (a Bezier curve); here are {n}, give the knots"
        )
        fault(f"{at}/knots", text, "invalid-spline")
    elif knots is not None and len(knots) != n + degree + 1:
        text = f"{n} control points of degree {degree} need {n + degree + 1} knots, here are {len(knots)}"
        fault(f"{at}/knots", text, "invalid-spline")
    if weights is not None and len(weights) != n:
        fault(f"{at}/weights", f"{len(weights)} weights for {n} control points; give one each", "invalid-spline")
    if len(problems) > before:
        return None
    clean: Edge = {"degree": degree, "control_points": points}
    if knots is not None:
        clean["knots"] = knots
    if weights is not None:
        clean["weights"] = weights
    return clean


def _read_degree(edge: Mapping[Any, Any], at: str, fault: Fault) -> int | None:
    if "degree" not in edge:
        fault(f"{at}/degree", "degree is missing")
        return None
    value = edge["degree"]
    if isinstance(value, bool) or not isinstance(value, Integral):
        fault(f"{at}/degree", f"degree must be an integer, not {describe(value)}")
        return None
    degree = int(value)
    if not 1 <= degree <= HIGHEST_DEGREE:
        fault(f"{at}/degree", f"degree must be 1 to {HIGHEST_DEGREE}, not {short(degree)}", "invalid-spline")
        return None
    return degree


def _read_points(edge: Mapping[Any, Any], at: str, fault: Fault) -> list[list[float]] | None:
    at = f"{at}/control_points"
    if "control_points" not in edge:
        fault(at, "control_points is missing")
        return None
    value = as_list(edge["control_points"])
    if value is None:
        fault(at, f"control_points must be a list of [x, y], not {describe(edge['control_points'])}")
        return None
    points = []
    for i, item in enumerate(value):
        pair = as_list(item)
        if pair is None:
            fault(f"{at}/{i}", f"a control point is [x, y], not {describe(item)}")
            return None
        if len(pair) != 2:
            fault(f"{at}/{i}", f"a control point has two coordinates, here are {len(pair)}", "invalid-spline")
            return None
        point = [as_number(c) for c in pair]
        for k, c in enumerate(point):
            if c is None:
                fault(f"{at}/{i}/{k}", f"a coordinate must be a number, not {describe(pair[k])}")
                return None
        points.append(point)
    return points  # type: ignore[return-value]


def _read_numbers(value: object, at: str, noun: str, fault: Fault) -> list[float] | None:
    if value is None:
        return None
    items = as_list(value)
    if items is None:
        fault(at, f"{noun}s must be a list of numbers, not {describe(value)}")
        return None
    numbers = [as_number(item) for item in items]
    for i, number in enumerate(numbers):
        if number is None:
            fault(f"{at}/{i}", f"a {noun} must be a number, not {describe(items[i])}")
            return None
    return numbers  # type: ignore[return-value]
