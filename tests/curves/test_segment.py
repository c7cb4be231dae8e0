"""Tangents, lengths and the slope of the radius of one segment."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.curves.shapes import solved

SHAPES = ("ell", "mixed_holes", "ellipse", "blob_holes", "parabola_cap", "eccentric_ring", "thorn")
T = np.linspace(0.0, 1.0, 23)


def test_the_slope_of_the_radius_into_a_corner_is_the_sine_of_half_its_angle() -> None:
    for s in solved("square").segments:
        assert np.abs(s.dr_ds(T)) == pytest.approx(np.full(len(T), math.sqrt(0.5)), abs=1e-14)
        assert s.arc_length() == pytest.approx(math.sqrt(0.5), abs=1e-14)


@pytest.mark.parametrize("name", SHAPES)
def test_tangents_are_unit_and_the_normals_say_the_same(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for s in solved(name).segments:
        fast = np.column_stack((s.tangent(T), s.dr_ds(T)))
        assert np.hypot(*fast[:, :2].T) == pytest.approx(np.ones(len(T)), abs=1e-12)
        assert np.abs(fast[:, 2]).max() <= 1.0
        # as if the curve stood still everywhere: both footpoints tell the direction
        length = s.length
        monkeypatch.setattr(type(s), "length", property(lambda _: math.inf))
        slow = s._direction(T)
        monkeypatch.undo()
        assert s.length == length
        assert np.abs(fast - slow).max() <= 2e-3


@pytest.mark.parametrize("name", SHAPES)
def test_lengths_add_up_and_are_inverted(name: str) -> None:
    for s in solved(name).segments:
        total = s.length
        assert s.arc_length() == pytest.approx(total, rel=1e-14)
        assert s.arc_length(0.1, 0.63) + s.arc_length(0.63, 1.0) + s.arc_length(0.0, 0.1) == pytest.approx(total, rel=1e-9)
        assert s.arc_length(0.8, 0.3) == -s.arc_length(0.3, 0.8)
        points = s.evaluate(np.linspace(0.0, 1.0, 20001))[:, :2]
        assert np.hypot(*np.diff(points, axis=0).T).sum() == pytest.approx(total, rel=1e-6)
        t = s.parameter_at(total * T)
        assert [s.arc_length(0.0, u) for u in t] == pytest.approx(total * T, abs=1e-9 * total)
        assert (t[0], t[-1]) == pytest.approx((0.0, 1.0), abs=1e-14)
        assert s.parameter_at(-1.0) == 0.0
        assert s.parameter_at(2.0 * total) == pytest.approx(1.0, abs=1e-14)
        assert s.parameter_at(np.full((2, 3), 0.5 * total)).shape == (2, 3)


@pytest.mark.parametrize("name", ["rectangle", "annulus", "blob_holes", "mixed"])
def test_the_curve_by_itself_is_the_curve_of_centres(name: str) -> None:
    axis = solved(name)
    t = np.linspace(0.0, 1.0, 33)
    for segment in axis.segments:
        assert np.abs(segment.curve.evaluate(t) - segment.evaluate(t)[:, :2]).max() <= 1e-13 * axis.domain.size
