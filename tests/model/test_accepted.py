"""Domains that are valid, some only just."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.model.builders import (
    SQUARE,
    Json,
    accept,
    backwards,
    bezier,
    circle,
    mapped,
    polygon,
    rectangle,
)

GAPS = [1e-3, 1e-6, 1e-9, 1e-11]
CAP = [bezier((1, 1), (1, -1))]


@pytest.mark.parametrize("gap", GAPS)
def test_two_walls_very_near(gap: float) -> None:
    accept(SQUARE, rectangle(-0.5, 0, 0.5, 0.5), rectangle(-0.5, -0.5, 0.5, -2 * gap))
    accept(polygon((0, 0), (2, 0), (2, 2), (1, 2 * gap), (0, 2)))
    accept(SQUARE, circle(1 - 0.5 - 2 * gap, 0, 0.5))
    accept(circle(0, 0, 1), circle(0.5 - 2 * gap, 0, 0.5))


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9])
def test_a_thin_ring(gap: float) -> None:
    ring = accept(circle(0, 0, 1), circle(0, 0, 1 - gap))
    assert ring.area == pytest.approx(math.pi * gap * (2 - gap), rel=1e-12 / gap)


@pytest.mark.parametrize("width", [1e-3, 1e-6, 1e-9, 1e-10])
def test_slivers(width: float) -> None:
    accept(polygon((0, 0), (1, 0), (1, 2 * width)))
    accept(rectangle(0, 0, 1, 10 * width))


@pytest.mark.parametrize("width", [1e-2, 1e-6, 1e-9])
def test_lenses(width: float) -> None:
    lens = [bezier((0, 0), (0.5, 0.5), (1, 0)), bezier((1, 0), (0.5, 0.5 - width), (0, 0))]
    assert accept(lens).area == pytest.approx(width / 3, rel=1e-6)
    assert accept([bezier((0, 0), (1, 0)), bezier((1, 0), (0.5, width), (0, 0))]).area == pytest.approx(width / 3)


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_cusps_between_edges(degree: int) -> None:
    """Branches y = x**degree and y = -x**degree leave the origin side by side."""
    upper = bezier(*[(i / degree, 0) for i in range(degree)], (1, 1))
    lower = bezier((1, -1), *[(i / degree, 0) for i in range(degree - 1, -1, -1)])
    assert accept([upper, *CAP, lower]).area == pytest.approx(2 / (degree + 1))
    assert accept([upper, bezier((1, 1), (1, 0)), bezier((1, 0), (0, 0))]).area == pytest.approx(1 / (degree + 1))


def test_branches_of_equal_curvature() -> None:
    """Parabola y = x**2 and cubic y = x**2 + 3 x**3: they part only in the third order."""
    parabola = bezier((0, 0), (0.5, 0), (1, 1))
    cubic = bezier((1, 4), (2 / 3, 1 / 3), (1 / 3, 0), (0, 0))
    accept([parabola, bezier((1, 1), (1, 4)), cubic])


@pytest.mark.parametrize("handle", [0.0, 1e-8, -1e-8, -1e-6, -1e-3])
def test_a_cubic_with_a_cusp_inside(handle: float) -> None:
    cusp = bezier((0, 0), (1 + handle, 1), (-handle, 1), (1, 0))
    accept([cusp, bezier((1, 0), (0.5, -1)), bezier((0.5, -1), (0, 0))])


def test_a_cusp_at_an_odd_parameter() -> None:
    """x = (t - a)**2, y = (t - a)**3, a = 0.3: speed vanishes at t = a, which no halving meets."""
    a = 0.3
    points = [
        (a * a, -(a**3)),
        (a * a - 2 * a / 3, -(a**3) + a * a),
        (a * a - 4 * a / 3 + 1 / 3, -(a**3) + 2 * a * a - a),
        ((1 - a) ** 2, (1 - a) ** 3),
    ]
    accept([bezier(*points), bezier(points[-1], (2, 0)), bezier((2, 0), points[0])])


def test_smooth_joints_of_many_kinds() -> None:
    accept(circle(0, 0, 1))
    stadium = [
        bezier((-1, -1), (1, -1)),
        bezier((1, -1), (2, -1), (2, 0), weights=[1, 0.5**0.5, 1]),
        bezier((2, 0), (2, 1), (1, 1), weights=[1, 0.5**0.5, 1]),
        bezier((1, 1), (-1, 1)),
        bezier((-1, 1), (-2, 1), (-2, 0), weights=[1, 0.5**0.5, 1]),
        bezier((-2, 0), (-2, -1), (-1, -1), weights=[1, 0.5**0.5, 1]),
    ]
    assert accept(stadium).area == pytest.approx(4 + math.pi, rel=1e-15)
    # A side cut at a point in its middle: the two lines go on straight.
    accept(polygon((0, 0), (0.3, 0), (1, 0), (1, 1), (0, 1)))


@pytest.mark.parametrize("length", [1e-6, 1e-9, 1e-11, 1e-12, 1e-13])
def test_very_short_edges(length: float) -> None:
    accept(polygon((0, 0), (1, 0), (1, length), (1, 1), (0, 1)))
    accept(polygon((0, 0), (1 - length, 0), (1, length), (1, 1), (0, 1)))


def test_control_points_on_the_ends() -> None:
    """Handles of length zero: the speed vanishes at the ends, and a line may be written as a cubic."""
    loop = [bezier(a, a, b, b) for a, b in [((0, 0), (1, 0)), ((1, 0), (1, 1)), ((1, 1), (0, 1)), ((0, 1), (0, 0))]]
    assert accept(loop).area == pytest.approx(1)
    handle = bezier((0, 0), (0, 0), (0.5, 1), (1, 0))
    accept([handle, bezier((1, 0), (0.5, -1)), bezier((0.5, -1), (0, 0))])


@pytest.mark.parametrize("gap", [0.0, 1e-11, 9e-11])
def test_ends_may_miss_each_other_by_rounding(gap: float) -> None:
    sides = [bezier((0, 0), (1, 0)), bezier((1 + gap, 0), (1, 1)), bezier((1, 1 - gap), (0, 1)), bezier((0, 1), (0, 0))]
    accept(sides)


def test_rounding_far_from_the_origin() -> None:
    far = 1e6
    sides = [
        bezier((far, far), (far + 1, far)),
        bezier((far + 1 + 5e-10, far), (far + 1, far + 1)),
        bezier((far + 1, far + 1), (far, far + 1)),
        bezier((far, far + 1), (far, far)),
    ]
    accept(sides)
    accept(mapped(SQUARE, 0.7, far, far, 0.3), mapped(circle(0, 0, 0.5), 0.7, far, far, 0.3))


@pytest.mark.parametrize("scale", [1e-150, 1e-9, 1e-6, 1.0, 1e6, 1e9, 1e143])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_scale_and_place_do_not_matter(scale: float, shift: float) -> None:
    at = shift * scale
    found = accept(mapped(rectangle(0, 0, 2, 1), scale, at, at), mapped(circle(1, 0.5, 0.25), scale, at, at))
    expected = (2 - math.pi / 16) * scale * scale
    assert found.area == pytest.approx(expected, rel=1e-14 if shift == 0 else 1e-9)
    assert found.size == pytest.approx(2 * scale, rel=1e-9)


@pytest.mark.parametrize("ratio", [1e-8, 1e-4, 1e4, 1e8])
def test_weights_far_apart(ratio: float) -> None:
    loop = [bezier((0, 0), (0.5, 1), (1, 0), weights=[1, ratio, 1]), bezier((1, 0), (0, 0))]
    assert accept(loop).area == pytest.approx(conic_area(ratio), rel=1e-6)
    loop = [bezier((0, 0), (0.5, 1), (1, 0), weights=[ratio, 1, 1 / ratio]), bezier((1, 0), (0, 0))]
    # A Moebius change of the parameter brings these weights to 1, 1, 1.
    assert accept(loop).area == pytest.approx(1 / 3, rel=1e-9)


def test_a_curve_that_runs_fast_into_its_end() -> None:
    """Its last floats of the parameter are 1e-10 apart, as the next edge bends back 1e-13 from there: they do not touch."""
    fast = bezier((-1, -1), (-0.4, -1), (-0.2, -1), weights=[0.1, 4e4, 0.07])
    bent = bezier((-0.2, -1), (-0.1, -1.2), (0.2, -0.8), (0.9, 0), weights=[2e4, 4e-6, 7e-3, 1e4])
    accept([fast, bent, bezier((0.9, 0), (-1, 1)), bezier((-1, 1), (-1, -1))])


def conic_area(w: float) -> float:
    """Area under the conic with control triangle (0, 0), (1/2, 1), (1, 0) and middle weight w, by fine quadrature."""
    # With t = v / (1 + v) = 1 / (1 + exp(-z)) the integrand is smooth in z whatever the weight.
    z = np.linspace(-60, 60, 400_001)
    v = np.exp(z)
    below = 1 + 2 * w * v + v * v
    x = (w * v + v * v) / below
    y = 2 * w * v / below
    return float(abs(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x))))


@pytest.mark.parametrize("turned", [False, True])
def test_either_orientation(turned: bool) -> None:
    outer, hole = SQUARE, circle(0, 0, 0.5)
    plain = accept(outer, hole)
    assert plain.arrays.reversed.tolist() == [False, True]
    other = accept(backwards(outer), backwards(hole))
    assert other.arrays.reversed.tolist() == [True, False]
    assert other.area == pytest.approx(plain.area, rel=1e-15)


@pytest.mark.parametrize("degree", [5, 12, 25])
def test_one_closed_edge_of_high_degree(degree: int) -> None:
    angles = np.linspace(0, 2 * math.pi, degree + 1)
    ring = [(math.cos(a) * (1 + 0.1 * math.sin(5 * a)), math.sin(a)) for a in angles[:-1]]
    accept([bezier(*ring, ring[0])])


def test_many_holes() -> None:
    holes = [circle(x, y, 0.03) for x in np.linspace(-0.9, 0.9, 14) for y in np.linspace(-0.9, 0.9, 14)]
    assert accept(SQUARE, *holes).area == pytest.approx(4 - 196 * math.pi * 9e-4, rel=1e-13)


def star(count: int) -> list[Json]:
    """A polygon with radii from 1 to 1.03 in a fixed irregular order."""
    corners = []
    for i in range(count):
        radius = 1 + 0.03 * ((i * 7919) % 1009) / 1009
        corners.append((radius * math.cos(2 * math.pi * i / count), radius * math.sin(2 * math.pi * i / count)))
    return polygon(*corners)


def test_many_edges() -> None:
    assert len(accept(star(10_000)).arrays.degree) == 10_000


def test_a_comb_with_narrow_slots() -> None:
    corners: list[tuple[float, float]] = []
    for i in range(200):
        corners += [(i, 0), (i + 1 - 1e-6, 0), (i + 1 - 1e-6, 50), (i + 1, 50)]
    accept(polygon(*corners, (200, 60), (0, 60)))
