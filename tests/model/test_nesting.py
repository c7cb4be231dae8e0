"""Loops inside loops: polygons where they are clear of each other, the exact curves where they are not."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from mat_core.model import nesting
from mat_core.model.domain import Domain
from mat_core.model.flattening import CHORD_ERROR, flatten
from mat_core.model.loop import Outline
from mat_core.model.problems import check
from mat_core.model.reading import CONTROL_POINT_LIMIT
from tests.model.builders import SQUARE, Json, accept, bezier, circle, codes, domain, mapped, polygon, rectangle, refuse


def outline_of(outer: list[Json], *holes: list[Json]) -> Outline:
    return check(domain(outer, *holes), CONTROL_POINT_LIMIT).outline


@pytest.fixture
def exact_calls(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, float, float]]:
    calls = []
    decide = nesting.is_inside

    def counted(outline: Outline, loop: int, x: float, y: float) -> bool:
        calls.append((loop, x, y))
        return decide(outline, loop, x, y)

    monkeypatch.setattr(nesting, "is_inside", counted)
    return calls


def test_clear_loops_are_decided_on_polygons(exact_calls: list[object]) -> None:
    accept(SQUARE, circle(0.4, 0, 0.3), circle(-0.4, 0, 0.3))
    assert codes(refuse(SQUARE, circle(3, 0, 0.3))) == {"hole-outside"}
    assert codes(refuse(SQUARE, circle(0, 0, 0.5), circle(0, 0, 0.3))) == {"hole-in-hole"}
    assert not exact_calls


@pytest.mark.parametrize("gap", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("turn", [0.0, 0.3, math.pi / 4])
def test_narrow_gaps_are_decided_on_the_curves(gap: float, turn: float, exact_calls: list[object]) -> None:
    def turned(loop: list[Json]) -> list[Json]:
        return mapped(loop, 1.0, 0.2, -0.1, turn)

    # A ring so thin that no polygon shows which circle is the outer one.
    assert Domain.from_dict(domain(turned(circle(0, 0, 1)), turned(circle(0, 0, 1 - gap)))).area > 0
    assert codes(refuse(turned(circle(0, 0, 1 - gap)), turned(circle(0, 0, 1)))) == {"hole-outside"}
    # Two holes side by side, and one just outside the outer loop.
    accept(turned(circle(0, 0, 3)), turned(circle(1 + gap / 2, 0, 1)), turned(circle(-1 - gap / 2, 0, 1)))
    assert codes(refuse(turned(circle(0, 0, 1)), turned(circle(2 + gap, 0, 1)))) == {"hole-outside"}
    assert exact_calls


def test_a_hole_between_two_walls_is_told_from_one_beyond_them() -> None:
    # A crescent: the chord of its inner side runs through the material.
    outer = [bezier((0, 0), (1, 4), (2, 0)), bezier((2, 0), (1, 3.9), (0, 0))]
    inside = [bezier((0.9, 1.97), (1, 1.98), (1.1, 1.97)), bezier((1.1, 1.97), (0.9, 1.97))]
    accept(outer, mapped(inside, 1, 0, 0.0))
    assert codes(refuse(outer, mapped(inside, 1, 0, -0.1))) == {"hole-outside"}
    assert codes(refuse(outer, mapped(inside, 1, 0, 0.1))) == {"hole-outside"}


def test_rays_through_joints_and_extremes_count_right() -> None:
    outline = outline_of(mapped(circle(0, 0, 1), 1.0))
    frame = outline.frame
    for y in (0.0, 0.5, math.sqrt(0.5), 1.0 - 1e-9, 1.0 + 1e-9, -0.5, -1.0 + 1e-12, -1.0 - 1e-12):
        half = math.sqrt(max(0.0, 1.0 - y * y))
        for x, expected in ((0.0, abs(y) < 1.0), (half + 1e-6, False), (-half - 1e-6, False)):
            q = (x - frame.origin[0]) * frame.scale, (y - frame.origin[1]) * frame.scale
            assert nesting.is_inside(outline, 0, *q) == expected, (x, y)
    outline = outline_of(polygon((0, 0), (1, -1), (2, 0), (1, 1)))
    half = outline.frame.scale
    assert nesting.is_inside(outline, 0, -0.9 * half, 0.0)
    assert not nesting.is_inside(outline, 0, -1.1 * half, 0.0)
    assert not nesting.is_inside(outline, 0, 1.1 * half, 0.0)


@pytest.mark.parametrize("seed", range(20))
def test_polygons_are_as_near_to_the_curves_as_they_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    degree = int(rng.integers(2, 9))
    inner = np.column_stack((np.linspace(0, 1, degree + 1)[1:-1], rng.random(degree - 1) + 0.2))
    weights = np.exp(rng.normal(size=degree + 1) * rng.choice([0.0, 1.0, 3.0]))
    arch = bezier((0, 0), *inner, (1, 0), weights=weights.tolist())
    found = Domain.from_dict(domain([arch, bezier((1, 0), (0.5, -0.5)), bezier((0.5, -0.5), (0, 0))]))
    outline = outline_of([arch, bezier((1, 0), (0.5, -0.5)), bezier((0.5, -0.5), (0, 0))])
    flattening = flatten(outline, [0])
    points = (found.outer[0].evaluate(np.linspace(0, 1, 2000)) - outline.frame.origin) * outline.frame.scale
    off = shapely.distance(flattening.rings[0], shapely.points(points)).max()
    assert off <= flattening.error[0] + 1e-15
    if weights.std() == 0:
        assert flattening.error[0] <= CHORD_ERROR


def test_extreme_weights_leave_everything_to_the_curves() -> None:
    spike = bezier((0, 0), (0.5, 1), (1, 0), weights=[1, 1e-15, 1])
    loop = [spike, bezier((1, 0), (0.5, -0.5)), bezier((0.5, -0.5), (0, 0))]
    accept(loop, rectangle(0.4, -0.2, 0.6, -0.1))
    assert codes(refuse(loop, rectangle(0.4, 0.2, 0.6, 0.3))) == {"hole-outside"}


def test_a_grid_of_holes_is_no_matter_of_pairs(exact_calls: list[object]) -> None:
    holes = [rectangle(i, j, i + 0.9, j + 0.9) for i in range(30) for j in range(30)]
    assert len(accept(rectangle(-1, -1, 31, 31), *holes).holes) == 900
    inner = rectangle(7.2, 11.2, 7.4, 11.4)
    (problem,) = refuse(rectangle(-1, -1, 31, 31), *holes, inner)
    assert (problem.code, problem.pointer, problem.other) == ("hole-in-hole", "/holes/900", f"/holes/{7 * 30 + 11}")
    assert len(exact_calls) == 0


def test_messages_carry_a_second_opinion() -> None:
    (problem,) = refuse(polygon((-1, -1), (1, 1), (1, -1), (-1, 1)))
    assert 'shapely finds "Self-intersection" at (0, 0) on the polygon' in problem.message
    curl = bezier((0, 0), (1 + 1e-6, 1), (-1e-6, 1), (1, 0))
    (problem,) = refuse([curl, bezier((1, 0), (0.5, -1)), bezier((0.5, -1), (0, 0))])
    assert "on a polygon within" in problem.message or "is too coarse to show it" in problem.message
    # A loop of a micrometre on a metre is below what polygons show, and found all the same.
    dent = polygon((0, 0), (1000, 0), (1000, 1000), (500, -1e-4), (0, 1000))
    assert all("shapely finds" in p.message for p in refuse(dent)[:1])


@pytest.mark.parametrize("count", [3, 2000])
def test_loops_that_meet_are_not_compared_pair_by_pair(count: int, exact_calls: list[object]) -> None:
    """Two thousand copies of a hole are two million pairs, and each takes milliseconds on the exact curves."""
    found = refuse(SQUARE, *[circle(0.2, 0.1, 0.3)] * count)
    assert codes(found) == {"duplicate-loop"}
    assert not exact_calls
