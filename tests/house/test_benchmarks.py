"""What the benchmarks hand to other programs is what it says; nothing here looks at a clock."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from benchmarks import shapes
from benchmarks.fonts import Font
from benchmarks.growth import Family
from benchmarks.peers import exports
from benchmarks.peers.aims import reached, reached_by_processes
from benchmarks.peers.cases import EVERYONE, cases
from benchmarks.peers.environment import BUILDERS
from benchmarks.peers.solve import Answer, Row
from benchmarks.resources import FirstUse, Memory
from benchmarks.shapes import LARGE
from mat_core import Domain
from tests.families import CATALOGUE

TURNED = ("ellipse", "gear", "spiral", "blob_holes", "square_one_edge", "eccentric_ring", "rectangle")


@pytest.mark.parametrize("name", LARGE)
def test_large_shapes_are_valid_and_as_large_as_asked(name: str) -> None:
    shaped = LARGE[name](500)
    domain = Domain.from_dict(shaped)
    assert 0.75 * 500 <= len(domain.arrays.degree) <= 1.25 * 500
    assert shaped == LARGE[name](500)


@pytest.mark.parametrize("seed", [7, 16, 18, 26])
def test_a_coastline_does_not_cross_itself_however_rough(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    # sides that stay where they are may still be crossed by those that do not
    monkeypatch.setattr(shapes, "ROUGHNESS", 2.0)
    ring = [edge["control_points"][0] for edge in shapes.coastline(200, seed)["outer"]]
    assert shapely.LinearRing(ring).is_simple


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
@pytest.mark.parametrize("name", TURNED)
def test_chords_keep_the_tolerance_and_the_interior_on_their_left(name: str, tolerance: float) -> None:
    domain = Domain.from_dict(CATALOGUE[name]())
    loops = exports.flatten(domain, tolerance)
    fine = exports.flatten(domain, 1e-9)
    for k, ((points, _), (exact, _)) in enumerate(zip(loops, fine, strict=True)):
        ring = shapely.LinearRing(points)
        assert ring.is_ccw == (k == 0)
        assert shapely.distance(shapely.points(exact), ring).max() <= 1.001 * tolerance * domain.size
    assert shapely.Polygon(loops[0][0], [h for h, _ in loops[1:]]).area == pytest.approx(domain.area, rel=20 * tolerance)


@pytest.mark.parametrize(("name", "corners"), [("square_one_edge", 4), ("ellipse", 0), ("gear", 48), ("spiral", 4)])
def test_corners_are_those_of_the_boundary_not_of_its_chords(name: str, corners: int) -> None:
    loops = exports.flatten(Domain.from_dict(CATALOGUE[name]()), 1e-4)
    assert sum(int(corner.sum()) for _, corner in loops) == corners


@pytest.mark.parametrize("turned", [False, True])
def test_a_conic_as_cubics_stays_within_the_tolerance(turned: bool) -> None:
    piece = np.array([[1.0, 0.0, 1.0], [1.0, 1.0, 0.3], [0.0, 1.0, 2.0]])
    cubics = exports.cubics(piece[::-1] if turned else piece, 1e-6)
    assert 1 < len(cubics) < 16
    # with barycentric coordinates b in the triangle of control points, the conic is w0 w2 b1^2 = 4 w1^2 b0 b2
    for cubic in cubics:
        for t in np.linspace(0, 1, 5):
            basis = np.array([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3])
            x, y = basis @ np.array(cubic)
            assert 2.0 * (x + y - 1.0) ** 2 == pytest.approx(4 * 0.3**2 * (1.0 - y) * (1.0 - x), abs=2e-5)


def test_peers_are_named_alike_everywhere() -> None:
    assert set(BUILDERS) == set(EVERYONE)
    assert {who for case in cases() for who in case.peers} == set(EVERYONE)


def test_an_aim_without_figures_is_neither_met_nor_missed() -> None:
    assert {r.met for r in reached([], [])} == {None}


def test_aims_of_processes_are_met_or_not_by_their_figures() -> None:
    small, large = Font("a", [4, 5, 6], [0.1, 0.2, 0.3]), Font("b", [7], [9.0])
    lean, heavy = Memory("lean", 1024, 100.0, 100.0, 101.0), Memory("heavy", 1024, 100.0, 100.0, 103.0)
    quick = reached_by_processes([small, large], [lean], FirstUse(0.4, 20.0, 30.0))
    slow = reached_by_processes([large], [heavy], FirstUse(0.6, 30.0, 30.0))
    assert [r.met for r in quick] == [True] * 4
    assert [r.met for r in slow] == [False] * 4



def test_aims_are_decided_by_the_worst_row() -> None:
    slow = Row("polygons", "a", 1e-6, 4, Answer("mat-core", ms=2.0), peers=[Answer("Boost.Polygon", ms=1.0)])
    fast = Row("polygons", "b", 1e-6, 4, Answer("mat-core", ms=1.0), peers=[Answer("Boost.Polygon", ms=9.0)])
    of_polygons = [next(r for r in reached(rows, []) if r.aim.startswith("polygons")) for rows in ([fast], [fast, slow])]
    assert [r.met for r in of_polygons] == [True, False]
    assert of_polygons[1].figure == "0.5 (a) to 9 (b)"


def test_the_exponent_is_that_of_the_power() -> None:
    family = Family("square", [10, 100, 1000], [{"medial_axis": n**2.0, "rungs": 1} for n in (10, 100, 1000)], "")
    assert family.exponent() == pytest.approx(2.0)
