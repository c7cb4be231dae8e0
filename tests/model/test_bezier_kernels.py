"""Cutting B-splines into Bezier pieces, evaluating and subdividing them, against SciPy and by identities."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline

from mat_core.kernels import bezier as kernel

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
    cp = np.column_stack((rng.normal(size=(degree + 1, 2)), np.exp(rng.normal(size=degree + 1) * 0.3)))
    step = 1e-5
    for t in (0.1, 0.5, 0.9):
        x, y, dx, dy, ddx, ddy = kernel.derivatives(cp, 0, degree, t, 0.25, -0.5)
        assert (x + 0.25, y - 0.5) == pytest.approx(kernel.point(cp, 0, degree, t), abs=1e-13)
        before = kernel.derivatives(cp, 0, degree, t - step, 0.25, -0.5)
        after = kernel.derivatives(cp, 0, degree, t + step, 0.25, -0.5)
        central = [(b - a) / (2 * step) for a, b in zip(before[:4], after[:4], strict=True)]
        assert (dx, dy, ddx, ddy) == pytest.approx(central, rel=1e-5, abs=1e-4)
    for t, end in ((0.0, 0), (1.0, degree)):
        assert kernel.derivatives(cp, 0, degree, t, 0.0, 0.0)[:2] == pytest.approx(tuple(cp[end, :2]), abs=1e-15)


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
    block = np.zeros((3 * (degree + 1), 3))
    block[: degree + 1] = cp
    kernel.halve(block, 0, degree, degree + 1, 0)
    for t in np.linspace(0, 1, 7):
        assert kernel.point(block, degree + 1, degree, t) == pytest.approx(
            kernel.point(cp, 0, degree, t / 2), abs=1e-12
        )
        assert kernel.point(block, 0, degree, t) == pytest.approx(kernel.point(cp, 0, degree, 0.5 + t / 2), abs=1e-12)
