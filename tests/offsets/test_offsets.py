"""The short form: some shapes of the repository, inward and outward; and that the reference itself is right, and can refuse."""

from __future__ import annotations

import dataclasses
import math

import pytest

from mat_core import Domain, medial_axis
from mat_core.analysis import offset
from tests.families import CATALOGUE
from tests.offsets.buffering import Flattened
from tests.offsets.check import AGREES, OUTWARD, check, compared
from tests.offsets.shapes import shapes

SHORT = ("mixed", "annulus", "a/DejaVuSans/B#0", "b/mdi/battery-charging-wireless-40#1", "splines/2")


@pytest.mark.parametrize("name", SHORT)
def test_offsets_agree_with_what_shapely_leaves(name: str) -> None:
    shape = dict(shapes())[name]
    for found in check(name, shape, (0.1, 0.9, OUTWARD[1])):
        assert not found.problems
        assert abs(found.miss) <= AGREES


@pytest.mark.parametrize("share", [0.3, 0.8, -0.5])
def test_straight_edges_have_the_plain_buffer(share: float) -> None:
    domain = Domain.from_dict(CATALOGUE["star_7"]())
    region = Flattened(domain.outer, (), 1e-7)
    distance = share * 0.25 * domain.size
    plain = region.polygon.buffer(-distance, quad_segs=1024)
    between = region.at(distance)
    assert between.least.area * (1.0 - 1e-12) <= plain.area <= between.most.area * (1.0 + 1e-12)
    assert between.doubt <= 1e-6 * domain.area


@pytest.mark.parametrize("distance", [0.2, 0.9, -0.5])
def test_the_reference_knows_a_circle(distance: float) -> None:
    domain = Domain.from_dict(CATALOGUE["circle"]())
    radius = math.sqrt(domain.area / math.pi)
    exact = math.pi * (radius - distance * radius) ** 2
    between = Flattened(domain.outer, (), 1e-7).at(distance * radius)
    assert between.least.area < exact < between.most.area
    assert between.doubt < 1e-6 * domain.area


def test_a_wrong_distance_is_noticed() -> None:
    shape = CATALOGUE["mixed"]()
    domain = Domain.from_dict({"outer": shape["outer"]})
    axis = medial_axis(domain, tolerance=1e-9)
    right = offset(axis, 0.1 * domain.size)
    wrong = dataclasses.replace(right, distance=right.distance * (1.0 + 1e-4))
    assert not compared("mixed", 0.1, domain, right).problems
    assert compared("mixed", 0.1, domain, wrong).problems
