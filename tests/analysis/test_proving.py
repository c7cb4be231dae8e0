"""What is proved of fitted curves: that it is true, sharp, and cannot be had for curves that are off."""

from __future__ import annotations

import dataclasses
import functools
import json

import numpy as np
import pytest

from mat_core import Domain, MedialAxis, medial_axis
from mat_core.analysis import ProvenErrors, prove_errors
from mat_core.analysis.bernstein import derivative, product, value
from mat_core.analysis.proving.polynomials import compose, largest, least_and_most, over_power, places, through, values, wide
from mat_core.analysis.proving.sides import least_places
from tests.analysis.shapes import outlines
from tests.curves.oracle import off_axis
from tests.families import CATALOGUE, smooth
from tests.hunt.draw import draw

SHAPES = ("ellipse", "lens", "smooth", "a/DejaVuSans/B#0", "b/mdi/battery-charging-wireless-40#1")
EACH = 400  # places a part at which the true error is taken
SHARP = 1.5  # what is proved over the largest error found, at most
ROUNDING = 1e-12  # normalised: errors this small are not told from it


def solve(name: str, tolerance: float) -> MedialAxis:
    drawn = {shape["name"]: shape for shape in outlines()}
    shape = smooth(3, 9) if name == "smooth" else drawn[name] if name in drawn else CATALOGUE[name]()
    return medial_axis(Domain.from_dict({"outer": shape["outer"], "holes": shape.get("holes", [])}), tolerance=tolerance)


@functools.cache
def proved(name: str, tolerance: float) -> tuple[MedialAxis, ProvenErrors]:
    axis = solve(name, tolerance)
    return axis, prove_errors(axis)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-9])
@pytest.mark.parametrize("name", SHAPES)
def test_what_is_proved_is_true_and_sharp(name: str, tolerance: float) -> None:
    axis, proof = proved(name, tolerance)
    c = axis.curves
    part = np.flatnonzero(c.part_i[:, 3] == 4)
    at = np.linspace(0.003, 0.997, EACH)
    t = c.part_f[part, :1] + (c.part_f[part, 1:2] - c.part_f[part, :1]) * at
    off = off_axis(axis, np.repeat(proof.segment, EACH), t.reshape(-1)).reshape(len(part), EACH) / axis.table.scale
    found = np.where(np.isfinite(off), off, 0.0).max(axis=1)
    floor = ROUNDING / axis.table.scale
    assert (found <= proof.bound + floor).all()
    known = np.isfinite(proof.bound)
    # the norm |(x, y)| + |r| of the bound is up to sqrt(2) times the distance that the oracle gives
    assert (proof.bound <= SHARP * np.sqrt(2.0) * found + floor)[known].mean() >= 0.75


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
@pytest.mark.parametrize("name", [*SHAPES[:2], *SHAPES[3:], "b/mdi/table-eye#2"])
def test_what_is_stated_is_proved(name: str, tolerance: float) -> None:
    _, proof = proved(name, tolerance)
    assert len(proof.bound)
    assert proof.proved.all()


def test_errors_near_rounding_are_proved_at_centres_of_curvature() -> None:
    # once enclosed 10 and 400 times too loosely: what rounding left of the misses was divided by v^4 with them
    shape = draw("smooth", 5)
    proof = prove_errors(medial_axis(Domain.from_dict({"outer": shape["outer"]}), tolerance=1e-9))
    known = np.isfinite(proof.bound)
    assert known.mean() > 0.85
    assert proof.proved[known].all()
    assert proof.stated.min() < 1e-11


def test_a_curve_that_is_off_is_not_proved() -> None:
    axis, proof = proved("ellipse", 1e-6)
    moved = axis.curves.cp.copy()
    moved[3:5, 2] += 1e-5
    damaged = prove_errors(dataclasses.replace(axis, curves=axis.curves._replace(cp=moved)))
    assert not damaged.proved.all()
    assert damaged.bound.max() > 2.0 * proof.bound.max()
    modest = axis.curves._replace(max_error=0.25 * axis.curves.max_error)
    assert not prove_errors(dataclasses.replace(axis, curves=modest)).proved.all()


def test_an_axis_of_conics_has_nothing_to_prove() -> None:
    proof = prove_errors(solve("stadium", 1e-6))
    assert len(proof.bound) == 0
    assert json.loads(json.dumps(proof.to_dict())) == {"segment": [], "bound": [], "stated": []}


# Polynomials ---------------------------------------------------------------------------------------------------------
def test_polynomials_are_put_into_each_other() -> None:
    rng = np.random.default_rng(1)
    outer, inner, v = rng.normal(size=(5, 4)), rng.random((5, 7)), rng.random(5)
    assert value(compose(outer, inner), v) == pytest.approx(value(outer, value(inner, v)), rel=1e-12)
    assert values(inner, v[:, None])[:, 0] == pytest.approx(value(inner, v), rel=1e-13)
    assert through(values(inner, np.tile(places(6), (5, 1)))) == pytest.approx(inner, rel=1e-9)


def test_powers_are_divided_out_where_they_are_there() -> None:
    cube = np.array([[0.0, 0.0, 0.0, 1.0], [1e-3, 0.0, 0.0, 1.0]])
    rest, good = over_power(cube, 2)
    assert rest[0] == pytest.approx([0.0, 1.0])
    assert good.tolist() == [True, False]


def test_what_rounding_left_is_not_divided_with_them() -> None:
    v = np.array([[0.0, 1.0]])
    power = wide(np.array([[1.0]]))
    for _ in range(4):
        power = product(power, v)
    noisy = product(power, np.ones((1, 41))) + 5e-14 * product(np.array([[1.0, 0.0]]), np.ones((1, 44)))
    rest, good = over_power(noisy, 4)
    assert good.all()
    assert np.abs(rest - 1.0).max() < 1e-9


def test_a_foot_is_where_the_distance_is_least_not_at_a_vertex_as_near() -> None:
    x, y = np.array([[0.0, 1.0, 1.0, 0.0]]), np.array([[0.0, 0.0, 2.0, 2.0]])
    grid = np.linspace(0.0, 1.0, 101)[None]
    cx, cy = np.array([[-0.2]]), np.array([[0.9]])
    apart = np.hypot(values(x, grid) - cx, values(y, grid) - cy)[0]
    assert apart.argmin() == 0
    found = int(least_places([x, y], np.ones((1, 1)), [derivative(x), derivative(y)], grid, cx, cy)[0, 0])
    assert 0 < found < 100
    assert apart[found] < min(apart[found - 1], apart[found + 1])


def test_values_are_enclosed() -> None:
    rows = np.random.default_rng(2).normal(size=(20, 9))
    at = np.tile(np.linspace(0.0, 1.0, 501), (20, 1))
    seen = values(rows, at)
    low, high = least_and_most(rows)
    assert (low <= seen.min(axis=1)).all()
    assert (high >= seen.max(axis=1)).all()
    assert (largest(rows) >= np.abs(seen).max(axis=1)).all()
    assert (high - low <= 1.3 * np.ptp(seen, axis=1)).all()
