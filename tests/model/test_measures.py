"""Area, bounds, orientation and the curves of a domain."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from mat_core.model.domain import Domain
from tests.model.builders import SQUARE, accept, backwards, bezier, circle, domain, mapped, polygon, rectangle


def test_closed_forms_of_area() -> None:
    assert accept(rectangle(0, 0, 3, 2), rectangle(1, 0.5, 2, 1.5)).area == 5.0
    assert accept(circle(5, -3, 2)).area == pytest.approx(4 * math.pi, rel=1e-15)
    assert accept(polygon((0, 0), (4, 0), (0, 3))).area == pytest.approx(6, rel=1e-15)
    assert accept([bezier((0, 0), (0.5, 1), (1, 0)), bezier((1, 0), (0, 0))]).area == pytest.approx(1 / 3, rel=1e-15)
    # A semicircle as one rational cubic.
    half = bezier((1, 0), (1, 2), (-1, 2), (-1, 0), weights=[1, 1 / 3, 1 / 3, 1])
    assert accept([half, bezier((-1, 0), (1, 0))]).area == pytest.approx(math.pi / 2, rel=1e-14)


def test_bounds_are_those_of_the_curve_not_of_its_control_points() -> None:
    cap = accept([bezier((0, 0), (0.5, 1), (1, 0)), bezier((1, 0), (0, 0))])
    assert cap.bbox == pytest.approx((0, 0, 1, 0.5), abs=1e-15)
    turned = accept(mapped(circle(0, 0, 1), 3, 10, 20, 0.123))
    assert turned.bbox == pytest.approx((7, 17, 13, 23), abs=1e-14)
    assert turned.size == pytest.approx(6)
    wave = bezier((0, 0), (1, 4), (2, -4), (3, 0))
    assert accept([wave, bezier((3, 0), (3, -9)), bezier((3, -9), (0, 0))]).bbox[3] == pytest.approx(
        12 * (x := (3 - 3**0.5) / 6) * (1 - x) * (1 - 2 * x), abs=1e-14
    )


def test_bounds_met_by_an_end_are_its_own_coordinate() -> None:
    corners = [(0.1, 0.7), (1 / 3, -0.2), (1e3 / 7, 0.3)]
    assert accept(polygon(*corners)).bbox == (0.1, -0.2, 1e3 / 7, 0.7)


def test_the_answer_keeps_the_input() -> None:
    hole = backwards(circle(0.2, 0.1, 0.5))
    found = accept(SQUARE, hole)
    arrays = found.arrays
    assert arrays.degree.tolist() == [1, 1, 1, 1, 2]
    assert arrays.cp_start.tolist() == [0, 2, 4, 6, 8, 17]
    assert arrays.knot_start.tolist() == [0, 4, 8, 12, 16, 28]
    assert arrays.loop_start.tolist() == [0, 4, 5]
    assert arrays.cp[8:, :2].tolist() == hole[0]["control_points"]
    assert arrays.cp[8:, 2].tolist() == hole[0]["weights"]
    assert arrays.knots[16:].tolist() == hole[0]["knots"]
    assert arrays.knots[:4].tolist() == [0, 0, 1, 1]


def test_curves_of_a_domain() -> None:
    found = accept(SQUARE, circle(0.2, 0.1, 0.5))
    assert [edge.degree for edge in found.outer] == [1] * 4
    ((ring,),) = found.holes
    u = np.linspace(0, 1, 41)
    points = ring.evaluate(u)
    assert np.hypot(points[:, 0] - 0.2, points[:, 1] - 0.1) == pytest.approx(0.5, abs=1e-15)
    tangents = ring.evaluate(u, 1)
    assert np.sum(tangents * (points - [0.2, 0.1]), axis=1) == pytest.approx(0, abs=1e-14)
    step = 1e-5
    middle = 0.1
    second = (ring.evaluate(middle + step, 1) - ring.evaluate(middle - step, 1)) / (2 * step)
    assert ring.evaluate(middle, 2) == pytest.approx(second, rel=1e-6)
    assert ring.domain == (0, 1)
    assert ring.is_rational
    assert not found.outer[0].is_rational
    assert ring.evaluate(0.125).shape == (2,)
    with pytest.raises(ValueError, match="derivative"):
        ring.evaluate(0.5, 3)


def test_domains_travel_between_processes() -> None:
    found = Domain.from_dict(domain(SQUARE, circle(0, 0, 0.5), name="ring"))
    copy = pickle.loads(pickle.dumps(found))
    assert copy.area == found.area
    assert copy.arrays.reversed.tolist() == found.arrays.reversed.tolist()
    assert repr(copy) == "<Domain 2 loops, 5 edges, area 3.2146, bbox (-1, -1, 1, 1)>"
