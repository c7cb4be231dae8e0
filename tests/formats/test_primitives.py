"""Lines and arcs are found where they are, however they are written, and nowhere else."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from mat_core import Domain
from mat_core.formats.primitives import FULL_TURN, Arc, Line, primitives, rounding
from mat_core.model.curve import RationalBSpline
from tests.families import arc, bezier, conic_loop, line, polyline
from tests.transforms import backwards, insert_knot

Json = dict[str, Any]


def curve(edge: Json) -> RationalBSpline:
    degree, points = edge["degree"], np.array(edge["control_points"], dtype=float)
    knots = np.array(edge.get("knots") or [0.0] * (degree + 1) + [1.0] * (degree + 1), dtype=float)
    return RationalBSpline(degree, knots, points, np.array(edge.get("weights") or np.ones(len(points)), dtype=float))


def found(edge: Json, tolerance: float = 1e-13) -> list[Any]:
    return primitives([curve(edge)], tolerance)


def elevated(edge: Json) -> Json:
    """A Bezier edge, one degree higher."""
    p = edge["degree"]
    w = np.array(edge.get("weights") or [1.0] * (p + 1))
    rows = np.column_stack((np.array(edge["control_points"]) * w[:, None], w))
    share = np.arange(p + 2)[:, None] / (p + 1)
    rows = share * np.vstack((rows[:1], rows)) + (1 - share) * np.vstack((rows, rows[-1:]))
    return bezier((rows[:, :2] / rows[:, 2:]).tolist(), rows[:, 2].tolist())


ARCS = {
    "quarter": arc((1.0, 2.0), 3.0, 0.3, 1.9),
    "clockwise": arc((1.0, 2.0), 3.0, 1.9, 0.3),
    "short": arc((0.0, 0.0), 1.0, 0.0, 0.01),
    "far from the origin": arc((1e3, -1e3), 1.0, 0.1, 2.0),
    "over the branch cut": arc((0.0, 0.0), 1.0, 3.0, 4.0),
    "of degree 4": elevated(elevated(arc((0.5, 0.0), 1.0, 0.2, 2.8))),
    "with inner knots": insert_knot(arc((0.5, 0.0), 1.0, 0.2, 2.8), 0.3),
    "backwards": backwards(arc((0.5, 0.0), 1.0, 0.2, 2.8)),
}


@pytest.mark.parametrize("edge", ARCS.values(), ids=ARCS)
def test_arcs_are_arcs(edge: Json) -> None:
    tolerance = 4 * np.spacing(np.abs(edge["control_points"]).max()) + 1e-13
    (shape,) = found(edge, tolerance)
    assert isinstance(shape, Arc)
    u = np.linspace(*curve(edge).domain, 33)
    points = curve(edge).evaluate(u) - shape.center
    assert np.abs(np.hypot(*points.T) - shape.radius).max() <= 2 * tolerance
    turned = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    assert turned[-1] - turned[0] == pytest.approx(shape.sweep, abs=1e-9)
    assert math.cos(turned[0] - shape.start) == pytest.approx(1.0)


@pytest.mark.parametrize("clockwise", [False, True])
def test_a_whole_circle_is_one(clockwise: bool) -> None:
    (shape,) = found(conic_loop(2.0, 2.0, (1.0, 1.0), 0.4, clockwise))
    assert isinstance(shape, Arc)
    assert shape.closed
    assert shape.sweep == (-FULL_TURN if clockwise else FULL_TURN)
    assert shape.center == pytest.approx((1.0, 1.0), abs=1e-14)


def test_what_is_no_arc_stays_a_spline() -> None:
    nearly = arc((0.0, 0.0), 1.0, 0.0, 1.5)
    nearly["weights"][1] *= 1.0 + 1e-10
    flat = arc((0.0, -1e6), 1e6, math.pi / 2 - 5e-7, math.pi / 2 + 5e-7)
    for edge in (nearly, flat, conic_loop(2.0, 2.0 + 1e-10), bezier([(0, 0), (1, 1), (2, 0)])):
        assert [type(shape) for shape in found(edge)] == [RationalBSpline]


@pytest.mark.parametrize(
    "edge",
    [
        line((0, 0), (3, 1)),
        elevated(line((0, 0), (3, 1))),
        bezier([(0, 0), (0.3, 0.1), (3, 1)], [1.0, 5.0, 0.1]),
        bezier([(0, 0), (0.3, 0.1), (2.7, 0.9), (3, 1)]),
    ],
)
def test_straight_curves_are_lines(edge: Json) -> None:
    assert found(edge) == [Line((0.0, 0.0), (3.0, 1.0))]


def test_a_polyline_is_its_sides_without_repeated_points() -> None:
    edge = bezier([(0, 0), (1, 0)]) | {"control_points": [[0, 0], [1, 0], [1, 0], [1, 1]], "knots": [0, 0, 1, 2, 3, 3]}
    assert found(edge) == [Line((0.0, 0.0), (1.0, 0.0)), Line((1.0, 0.0), (1.0, 1.0))]


def test_single_points_are_left_out() -> None:
    assert found(bezier([(1, 1), (1, 1), (1, 1)])) == []


def test_rounding_grows_with_the_coordinates() -> None:
    def at(x: float) -> Domain:
        return Domain.from_dict({"outer": polyline([(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)])})

    assert rounding(at(0.0)) == pytest.approx(1e-13, rel=1e-2)
    assert rounding(at(1e6)) > 1e-10
