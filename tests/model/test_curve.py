"""Parts of a curve and a curve run backwards are the same points."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from mat_core.model.curve import RationalBSpline
from mat_core.model.domain import Domain
from tests.families import CATALOGUE

SHAPES = ("plate", "blob_holes", "mixed", "square_one_edge", "ellipse", "spiral")
SHARES = ((0.0, 1.0), (0.0, 0.3), (0.41, 0.43), (0.2, 1.0), (0.1, 0.9))


def curves(name: str) -> list[RationalBSpline]:
    shape = CATALOGUE[name]()
    domain = Domain.from_dict({"outer": shape["outer"], "holes": shape.get("holes", [])})
    assert domain.loops == (domain.outer, *domain.holes)
    return [curve for loop in domain.loops for curve in loop]


@pytest.mark.parametrize("name", SHAPES)
def test_a_part_is_the_curve_in_the_same_parameter(name: str) -> None:
    for curve in curves(name):
        low, high = curve.domain
        for share in SHARES:
            u0, u1 = (low + s * (high - low) for s in share)
            part = curve.part(u0, u1)
            assert part.domain == (u0, u1)
            assert len(part.knots) == len(part.control_points) + part.degree + 1
            u = np.linspace(u0, u1, 31)
            scale = np.abs(curve.control_points).max()
            assert np.abs(part.evaluate(u) - curve.evaluate(u)).max() <= 1e-14 * scale
            slopes = curve.evaluate(u[1:-1], 1)
            assert np.abs(part.evaluate(u[1:-1], 1) - slopes).max() <= 1e-11 * max(np.abs(slopes).max(), scale)


@pytest.mark.parametrize("name", SHAPES)
def test_a_part_ends_at_knots_of_the_curve(name: str) -> None:
    for curve in curves(name):
        breaks = np.unique(curve.knots)
        for u0, u1 in pairwise(breaks.tolist()):
            assert len(curve.part(u0, u1).control_points) == curve.degree + 1


def test_a_part_reaches_no_farther_than_the_curve() -> None:
    curve = curves("ellipse")[0]
    low, high = curve.domain
    assert curve.part(low - 1.0, high + 1.0).domain == curve.domain
    for u0, u1 in ((high, high + 1.0), (low - 1.0, low), (0.5, 0.5), (0.7, 0.3)):
        with pytest.raises(ValueError, match="nothing of a curve"):
            curve.part(u0, u1)


@pytest.mark.parametrize("name", SHAPES)
def test_a_curve_backwards(name: str) -> None:
    for curve in curves(name):
        low, high = curve.domain
        u = np.linspace(low, high, 31)
        back = curve.reversed()
        assert back.domain == curve.domain
        assert np.abs(back.evaluate(low + high - u) - curve.evaluate(u)).max() <= 1e-14 * np.abs(curve.control_points).max()
