"""Cutting B-splines into Bezier pieces, evaluating and subdividing them, against SciPy and by identities."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline

from mat_core.kernels import bezier as kernel
from mat_core.model.curve import RationalBSpline

Floats = np.ndarray


def random_spline(rng: np.random.Generator, degree: int, shift: float) -> tuple[Floats, Floats]:
    """Clamped knots with inner ones of multiplicity up to the degree, and rows x, y, w."""
    inner, counts = np.unique(np.round(rng.random(6) * 5) / 5, return_counts=True)
    keep = (inner > 0) & (inner < 1)
    inner = np.repeat(inner[keep], np.minimum(counts[keep], degree))
    knots = np.concatenate((np.zeros(degree + 1), inner, np.ones(degree + 1)))
    n = len(knots) - degree - 1
    return knots, np.column_stack((rng.normal(size=(n, 2)) + shift, np.exp(rng.normal(size=n))))


def decomposed(degree: int, knots: Floats, cp: Floats) -> tuple[int, Floats, Floats]:
    n = len(cp)
    rows = np.full((n * (degree + 1), 3), np.nan)
    breaks = np.full(n + 1, np.nan)
    return kernel.decompose(degree, knots, 0, len(knots), cp, 0, n, rows, breaks), rows, breaks


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5, 8, 13, 25])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_pieces_are_the_curve(degree: int, shift: float) -> None:
    rng = np.random.default_rng(degree)
    for _ in range(5):
        knots, cp = random_spline(rng, degree, shift)
        homogeneous = np.column_stack(((cp[:, :2] - shift) * cp[:, 2:], cp[:, 2]))
        spline = BSpline(knots, homogeneous, degree)
        spans, rows, breaks = decomposed(degree, knots, cp)
        assert breaks[: spans + 1].tolist() == np.unique(knots).tolist()
        for k in range(spans):
            for t in (0.01, 0.3, 0.5, 0.77, 0.99):
                u = breaks[k] + t * (breaks[k + 1] - breaks[k])
                x, y, w = spline(u)
                found = kernel.point(rows, k * (degree + 1), degree, t)
                assert found == pytest.approx((x / w + shift, y / w + shift), abs=1e-12 if shift == 0 else 2e-9)


def test_a_bezier_curve_passes_through_bit_for_bit() -> None:
    rng = np.random.default_rng(0)
    for degree in range(1, 26):
        cp = np.column_stack((rng.normal(size=(degree + 1, 2)) * 1e6, rng.random(degree + 1) + 1e-3))
        knots = np.repeat([-3.0, 11.0], degree + 1)
        spans, rows, breaks = decomposed(degree, knots, cp)
        assert spans == 1
        assert breaks[:2].tolist() == [-3, 11]
        assert np.array_equal(rows[: degree + 1], cp)


def test_full_multiplicity_lets_pieces_part() -> None:
    cp = np.array([[0, 0, 1], [1, 0, 1], [5, 5, 2], [6, 5, 2]], dtype=float)
    spans, rows, breaks = decomposed(1, np.array([0, 0, 1, 1, 2, 2.0]), cp)
    assert spans == 2
    assert np.array_equal(rows[:4], cp)
    assert breaks[:3].tolist() == [0, 1, 2]


def test_neighbouring_pieces_share_their_joint_exactly() -> None:
    rng = np.random.default_rng(5)
    for degree in (2, 3, 7):
        knots, cp = random_spline(rng, degree, 1e6)
        spans, rows, _ = decomposed(degree, knots, cp)
        for k in range(1, spans):
            assert rows[k * (degree + 1), :2].tolist() == rows[k * (degree + 1) - 1, :2].tolist()


@pytest.mark.parametrize("degree", [1, 2, 3, 6, 25])
def test_derivatives_against_differences(degree: int) -> None:
    rng = np.random.default_rng(degree)
    weights = np.exp(rng.normal(size=degree + 1) * 0.3)
    points = rng.normal(size=(degree + 1, 2))
    curve = RationalBSpline(degree, np.repeat([0.0, 2.0], degree + 1), points, weights)
    step = 1e-5
    u = np.array([0.2, 1.0, 1.8])
    for order in (1, 2):
        central = (curve.evaluate(u + step, order - 1) - curve.evaluate(u - step, order - 1)) / (2 * step)
        assert curve.evaluate(u, order) == pytest.approx(central, rel=1e-5, abs=1e-4)
    rows = np.column_stack((points, weights))
    for t in (0.1, 0.5, 0.9):
        assert curve.evaluate(2 * t) == pytest.approx(kernel.point(rows, 0, degree, t), abs=1e-13)
    assert curve.evaluate([0, 2]) == pytest.approx(points[[0, -1]], abs=1e-15)


@pytest.mark.parametrize("degree", [1, 2, 3, 25])
def test_parts_of_a_piece(degree: int) -> None:
    rng = np.random.default_rng(degree)
    cp = np.column_stack((rng.normal(size=(degree + 1, 2)), np.exp(rng.normal(size=degree + 1))))
    part = np.empty((degree + 1, 3))
    for t0, t1 in ((0.0, 1.0), (0.2, 0.7), (0.0, 0.1), (0.5, 1.0)):
        kernel.restrict(cp, 0, degree, t0, t1, part, 0)
        for t in np.linspace(0, 1, 7):
            expected = kernel.point(cp, 0, degree, t0 + t * (t1 - t0))
            assert kernel.point(part, 0, degree, t) == pytest.approx(expected, abs=1e-12)
