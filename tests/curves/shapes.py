"""Domains for the tests of curves, solved once each."""

from __future__ import annotations

import functools
import math
from typing import Any

from mat_core import Domain, MedialAxis, medial_axis
from tests.families import CATALOGUE, arc, bezier, circle_hole, line, polygon_hole, polyline

Json = dict[str, Any]


def _circle(radius: float) -> list[Json]:
    quarter = 0.5 * math.pi
    return [arc((0.0, 0.0), radius, q * quarter, (q + 1) * quarter) for q in range(4)]


def mixed_holes() -> Json:
    """Round outside, polygons and circles of unlike sizes inside: arcs of both signs, points and lines meet."""
    holes = [
        polygon_hole([(-1.1, -0.9), (-0.4, -1.0), (-0.7, -0.3)]),
        circle_hole((0.8, 0.7), 0.45),
        circle_hole((-0.7, 0.9), 0.3),
        polygon_hole([(0.6, -0.9), (1.1, -0.6), (0.7, -0.3), (0.4, -0.6)]),
    ]
    return {"outer": _circle(2.0), "holes": holes}


def equal_holes() -> Json:
    """Two equal circles and two points of polygons facing each other, all symmetric: straight bisectors."""
    holes = [
        circle_hole((-1.0, 0.0), 0.4),
        circle_hole((1.0, 0.0), 0.4),
        polygon_hole([(-0.3, 1.5), (0.3, 1.5), (0.0, 1.0)]),
        polygon_hole([(-0.3, -1.5), (0.0, -1.0), (0.3, -1.5)]),
    ]
    return {"outer": polyline([(-3.0, -2.5), (3.0, -2.5), (3.0, 2.5), (-3.0, 2.5)]), "holes": holes}


def flat_arcs() -> Json:
    """A channel between an arc and a line, and two arcs of nearly one radius: curvature from 1e-6 up."""
    top, bottom = 1e-6, 0.4

    def shallow(a: tuple[float, float], b: tuple[float, float], k: float) -> Json:
        half = math.asin(0.5 * k * math.dist(a, b))
        mx, my = 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])
        reach = 0.5 * math.tan(half)
        return bezier([a, (mx + reach * (b[1] - a[1]), my - reach * (b[0] - a[0])), b], [1.0, math.cos(half), 1.0])

    return {
        "outer": [
            shallow((0.0, 0.0), (2.0, 0.0), bottom),
            line((2.0, 0.0), (2.0, 1.0)),
            shallow((2.0, 1.0), (0.0, 1.0), top),
            line((0.0, 1.0), (0.0, 0.0)),
        ],
        "holes": [circle_hole((1.0, 0.45), 0.2)],
    }


def two_arcs(first: float, second: float) -> Json:
    """A lens of two convex arcs of sweeps `first` and `second` over one chord."""

    def over(a: tuple[float, float], b: tuple[float, float], sweep: float) -> Json:
        mx, my = 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])
        reach = 0.5 * math.tan(0.5 * sweep)
        middle = (mx + reach * (b[1] - a[1]), my - reach * (b[0] - a[0]))
        return bezier([a, middle, b], [1.0, math.cos(0.5 * sweep), 1.0])

    return {"outer": [over((0.0, 0.0), (1.0, 0.2), first), over((1.0, 0.2), (0.0, 0.0), second)]}


OWN: dict[str, Json] = {
    "mixed_holes": mixed_holes(),
    "equal_holes": equal_holes(),
    "flat_arcs": flat_arcs(),
    "lens_equal_arcs": two_arcs(1.2, 1.2),
    "lens_unlike_arcs": two_arcs(1.2, 0.5),
}


def shape(name: str) -> Json:
    """A shape of this module or of the catalogue."""
    found = OWN.get(name)
    return found if found is not None else CATALOGUE[name]()


@functools.cache
def solved(name: str, tolerance: float = 1e-6) -> MedialAxis:
    """Its axis."""
    content = shape(name)
    domain = Domain.from_dict({"outer": content["outer"], "holes": content.get("holes", [])})
    return medial_axis(domain, tolerance=tolerance)
