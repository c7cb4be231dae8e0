"""Loops written by hand: areas and lengths in closed form, tangents that meet, faults by name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from mat_core.analysis.outline import measure
from mat_core.errors import UnsupportedOption
from mat_core.model.domain import Domain
from mat_core.outlines import circle, polygon

ELL = [(0, 0), (4, 0), (4, 1), (1.5, 1), (1.5, 3), (0, 3)]
TRIANGLE = [(0, 0), (5, 0.5), (1, 4)]


def area(points: Sequence[Sequence[float]]) -> float:
    x, y = np.array(points, dtype=float).T
    return float(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def turns(points: Sequence[Sequence[float]]) -> list[float]:
    """How far a polygon turns at each corner, positive to the left."""
    p = np.array(points, dtype=float)
    on, back = np.roll(p, -1, axis=0) - p, p - np.roll(p, 1, axis=0)
    return [math.atan2(a[0] * b[1] - a[1] * b[0], a @ b) for a, b in zip(back, on, strict=True)]


@pytest.mark.parametrize("points", [ELL, TRIANGLE, ELL[::-1], [(0, 0), (9, 0), (9, 4), (5, 4), (5, 4.8), (0.5, 4)]])
@pytest.mark.parametrize("radius", [0.0, 0.1, 0.35])
def test_the_area_of_a_rounded_polygon(points: list[tuple[float, float]], radius: float) -> None:
    edges = Domain.from_dict({"outer": polygon(points, rounding=radius)}).outer
    # a corner turning by a keeps a sector of its kite: tan(a / 2) - a / 2 of the radius squared goes, or comes if reflex
    taken = sum(math.tan(0.5 * a) - 0.5 * a for a in turns(points))
    assert measure(edges)[0] == pytest.approx(area(points) - radius**2 * taken, rel=1e-13)


def test_arcs_are_arcs_of_the_radius_and_meet_the_sides_with_their_tangents() -> None:
    edges = Domain.from_dict({"outer": polygon(TRIANGLE, rounding=0.5)}).outer
    assert [e.degree for e in edges] == [2, 1] * 3
    for before, after in pairwise([*edges, edges[0]]):
        a, b = before.evaluate(before.domain[1], 1), after.evaluate(after.domain[0], 1)
        assert abs(a[0] * b[1] - a[1] * b[0]) <= 1e-13 * math.hypot(*a) * math.hypot(*b)
        assert a @ b > 0.0
    for arc in edges[::2]:
        u = np.linspace(*arc.domain, 9)
        first, second = arc.evaluate(u, 1), arc.evaluate(u, 2)
        curvature = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / np.hypot(*first.T) ** 3
        assert curvature == pytest.approx(2.0, rel=1e-12)


def test_rounding_may_use_up_a_side() -> None:
    edges = Domain.from_dict({"outer": polygon([(0, 0), (5, 0), (5, 2), (0, 2)], rounding=1.0)}).outer
    assert [e.degree for e in edges] == [2, 1, 2, 2, 1, 2]
    assert measure(edges)[0] == pytest.approx(6.0 + math.pi, rel=1e-14)


def test_a_corner_that_does_not_turn_is_not_rounded() -> None:
    assert len(polygon([(0, 0), (1, 0), (2, 0), (2, 2), (0, 2)], rounding=0.2)) == 9


def test_a_circle() -> None:
    edges = Domain.from_dict({"outer": circle((3, -1), 2.5)}).outer
    assert measure(edges) == pytest.approx((math.pi * 6.25, math.pi * 5.0), rel=1e-14)
    points = np.vstack([e.evaluate(np.linspace(0, 1, 9)) for e in edges])
    assert np.hypot(*(points - (3, -1)).T) == pytest.approx(2.5, rel=1e-15)


@pytest.mark.parametrize(("points", "rounding", "name"), [
    (ELL[:2], 0.0, "points"), (ELL, -1.0, "rounding"), (ELL, math.nan, "rounding"), (ELL, math.inf, "rounding"),
    (ELL, 0.6, "rounding"),
])
def test_faults_of_a_polygon(points: list[tuple[float, float]], rounding: float, name: str) -> None:
    with pytest.raises(UnsupportedOption) as refusal:
        polygon(points, rounding)
    assert refusal.value.option == name


@pytest.mark.parametrize("radius", [0.0, -1.0, math.nan, math.inf])
def test_faults_of_a_circle(radius: float) -> None:
    with pytest.raises(UnsupportedOption):
        circle((0, 0), radius)
