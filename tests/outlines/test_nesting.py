"""Which loop fills, which is a hole and of what, whatever the order, also where loops nearly touch; crossing loops are told."""

from __future__ import annotations

import random

import numpy as np
import pytest
import shapely

from mat_core.outlines import circle, nested, path_loops, polygon
from mat_core.outlines.nesting import Rule, flattened

RINGS = "M0 0h9v9h-9z M1 1h7v7h-7z M2 2h5v5h-5z"
TURNED = "M0 0h9v9h-9z M1 1v7h7v-7z M2 2h5v5h-5z"


@pytest.mark.parametrize(
    ("data", "rule", "holes"),
    [(RINGS, "evenodd", [1, 0]), (RINGS, "nonzero", [0]), (TURNED, "evenodd", [1, 0]), (TURNED, "nonzero", [1, 0])],
)
def test_nesting(data: str, rule: Rule, holes: list[int]) -> None:
    assert [len(d["holes"]) for d in nested(path_loops(data), rule).domains] == holes


@pytest.mark.parametrize(
    ("data", "pair"),
    [
        ("M0 0h2v2h-2z M1 1h2v2h-2z", "0 and 1"),
        ("M0 0h100v100h-100z M99.9 99.9h100v100h-100z", "1 and 0"),  # a millionth of both is shared
        ("M0 0h9v9h-9z M3 -1h1v11h-1z", "0 and 1"),
    ],
)
def test_loops_that_cross_bound_no_domain(data: str, pair: str) -> None:
    found = nested(path_loops(data), "nonzero")
    assert found.domains == []
    assert len(found.left_out) == 1
    first, _, second = pair.split()
    assert found.left_out[0].startswith((f"loops {first} and {second} cross", f"loops {second} and {first} cross"))


def test_what_stands_apart_from_loops_that_cross_stays() -> None:
    found = nested(path_loops("M0 0h2v2h-2z M1 1h2v2h-2z M10 0h4v4h-4z M11 1h1v1h-1z"))
    assert [len(d["holes"]) for d in found.domains] == [1]


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_circles_that_nearly_touch_are_nested(gap: float) -> None:
    around, inner, beside = circle((0, 0), 1), circle((0, 0), 1 - gap), circle((2 + gap, 0), 1)
    found = nested([inner, beside, around])
    assert found.left_out == []
    assert [(d["outer"] is around, len(d["holes"])) for d in found.domains] == [(False, 0), (True, 1)]


def test_the_order_of_loops_does_not_matter() -> None:
    loops = [polygon([(i, i), (100 - i, i), (100 - i, 100 - i), (i, 100 - i)]) for i in range(12)]
    random.Random(1).shuffle(loops)
    found = nested(loops)
    assert sorted(d["outer"][0]["control_points"][0][0] for d in found.domains) == [0, 2, 4, 6, 8, 10]
    for d in found.domains:
        (hole,) = d["holes"]
        assert hole[0]["control_points"][0][0] == d["outer"][0]["control_points"][0][0] + 1


def test_a_hole_belongs_to_the_innermost_loop_around_it() -> None:
    loops = [circle((0, 0), r) for r in (10, 9, 8)] + [circle((x, 0), 1) for x in (-5, 0, 5)]
    found = nested(loops)
    assert [len(d["holes"]) for d in found.domains] == [1, 3]


def test_a_loop_that_crosses_itself_is_left_to_the_domain() -> None:
    bow = path_loops("M0 0L2 2V0L0 2Z")
    assert [d["outer"] for d in nested(bow).domains] == bow


def test_no_loops() -> None:
    assert nested([]).domains == nested([]).left_out == []


def test_a_spline_is_flattened_along_its_curve_within_the_error() -> None:
    """A circle as one closed spline with doubled knots: every point lies on it, the area is off by less than said."""
    s = 0.5**0.5
    points = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]]
    weights, knots = [1, s, 1, s, 1, s, 1, s, 1], [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
    p, error = flattened([{"degree": 2, "control_points": points, "weights": weights, "knots": knots}])
    assert np.allclose(np.linalg.norm(p, axis=1), 1.0, atol=1e-15)
    missed = np.pi - shapely.Polygon(p).area
    assert 0 < missed < error < 5 * missed


def test_ten_thousand_holes_are_nested_in_no_time_of_their_square() -> None:
    side = 100
    outer = polygon([(0, 0), (side, 0), (side, side), (0, side)])
    holes = [polygon([(x + 0.2, y + 0.2), (x + 0.8, y + 0.2), (x + 0.5, y + 0.8)]) for x in range(side) for y in range(side)]
    (domain,) = nested([*holes, outer]).domains
    assert len(domain["holes"]) == side * side
