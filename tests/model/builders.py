"""Edges, loops and domains written down in a line."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import pytest

from mat_core.errors import InvalidDomain, Problem
from mat_core.model.domain import Domain

Json = dict[str, Any]
Point = Sequence[float]

QUARTER = math.sqrt(0.5)
RING = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]


def bezier(*points: Point, weights: Sequence[float] | None = None) -> Json:
    """One Bezier edge; two points make a line."""
    edge: Json = {"degree": len(points) - 1, "control_points": [[float(x), float(y)] for x, y in points]}
    if weights is not None:
        edge["weights"] = list(weights)
    return edge


def polygon(*points: Point) -> list[Json]:
    """A loop of lines through the points."""
    return [bezier(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[Json]:
    """A counter-clockwise rectangle."""
    return polygon((x0, y0), (x1, y0), (x1, y1), (x0, y1))


def circle(x: float, y: float, radius: float, clockwise: bool = False) -> list[Json]:
    """A circle as one closed rational edge."""
    ring = RING[::-1] if clockwise else RING
    edge = bezier(*[(x + radius * a, y + radius * b) for a, b in ring])
    weights = [1.0 if i % 2 == 0 else QUARTER for i in range(9)]
    knots = [0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1]
    return [edge | {"degree": 2, "weights": weights, "knots": knots}]


def domain(outer: list[Json], *holes: list[Json], **more: Any) -> Json:
    """A domain document."""
    return {"outer": outer, "holes": list(holes), **more}


SQUARE = rectangle(-1, -1, 1, 1)


def accept(outer: list[Json], *holes: list[Json]) -> Domain:
    """The checked domain; fails with the problems when there are any."""
    return Domain.from_dict(domain(outer, *holes))


def problems_of(document: object, **options: Any) -> tuple[Problem, ...]:
    """The problems of a document that must be refused."""
    with pytest.raises(InvalidDomain) as caught:
        Domain.from_dict(document, **options)
    assert caught.value.problems
    return caught.value.problems


def refuse(outer: list[Json], *holes: list[Json]) -> tuple[Problem, ...]:
    """The problems of a domain that must be refused."""
    return problems_of(domain(outer, *holes))


def codes(problems: Iterable[Problem]) -> set[str]:
    """The codes of problems."""
    return {problem.code for problem in problems}


def mapped(loop: list[Json], scale: float, dx: float = 0.0, dy: float = 0.0, turn: float = 0.0) -> list[Json]:
    """A loop turned by `turn` radians, scaled and moved."""
    c, s = math.cos(turn), math.sin(turn)
    return [
        edge
        | {
            "control_points": [
                [dx + scale * (c * x - s * y), dy + scale * (s * x + c * y)] for x, y in edge["control_points"]
            ]
        }
        for edge in loop
    ]


def backwards(loop: list[Json]) -> list[Json]:
    """The same loop run the other way round."""
    out = []
    for edge in reversed(loop):
        turned = edge | {"control_points": edge["control_points"][::-1]}
        if "weights" in edge:
            turned["weights"] = edge["weights"][::-1]
        if "knots" in edge:
            turned["knots"] = [edge["knots"][0] + edge["knots"][-1] - k for k in reversed(edge["knots"])]
        out.append(turned)
    return out
