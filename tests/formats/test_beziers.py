"""Stacks of Bezier pieces, held to the library's own evaluation and to chords measured densely."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mat_core.formats.beziers import chain, chains, flatness, halves, pieces_of, points_at, slopes_at_ends
from mat_core.model.curve import RationalBSpline
from tests.curves.shapes import solved

SHAPES = ("ellipse", "lens_one_edge", "square_one_edge", "blob_holes", "spiral", "mixed", "annulus")


@st.composite
def stacks(draw: st.DrawFn) -> np.ndarray:
    """Pieces of one degree with weights of a hundred to one, near or far from the origin."""
    degree, count, dimension = draw(st.integers(1, 6)), draw(st.integers(1, 4)), draw(st.integers(1, 3))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    points = rng.normal(size=(count, degree + 1, dimension)) + draw(st.sampled_from([0.0, 1e3]))
    return np.concatenate((points, 10.0 ** rng.uniform(-1, 1, (count, degree + 1, 1))), axis=2)


@given(pieces=stacks())
@settings(max_examples=80, deadline=None)
def test_halves_are_the_piece(pieces: np.ndarray) -> None:
    left, right = halves(pieces)
    t = np.linspace(0.0, 1.0, 9)
    scale = np.abs(pieces[..., :-1]).max()
    np.testing.assert_allclose(points_at(left, t), points_at(pieces, 0.5 * t), atol=1e-13 * scale)
    np.testing.assert_allclose(points_at(right, t), points_at(pieces, 0.5 + 0.5 * t), atol=1e-13 * scale)


@given(pieces=stacks())
@settings(max_examples=80, deadline=None)
def test_slopes_are_the_derivative(pieces: np.ndarray) -> None:
    h = 1e-7
    first, last = slopes_at_ends(pieces)
    near = points_at(pieces, np.array([0.0, h, 1.0 - h, 1.0]))
    scale = 1.0 + np.abs(first).max() + np.abs(last).max()
    assert np.abs((near[:, 1] - near[:, 0]) / h - first).max() < 1e-3 * scale**2
    assert np.abs((near[:, 3] - near[:, 2]) / h - last).max() < 1e-3 * scale**2


@given(pieces=stacks(), exponent=st.integers(1, 5))
@settings(max_examples=60, deadline=None)
def test_chords_stay_within_their_tolerance(pieces: np.ndarray, exponent: int) -> None:
    tolerance = 10.0**-exponent
    vertices, number = chain(pieces, tolerance)
    t = np.linspace(0.0, 1.0, 200)
    for i, points in enumerate(points_at(pieces, t)):
        corners = np.vstack((vertices[number == i], pieces[i, -1, :-1]))
        assert distances(points, corners).max() <= tolerance + 1e-12 * np.abs(corners).max()
        assert (corners[0] == pieces[i, 0, :-1]).all()


def test_many_curves_at_once_are_each_by_itself() -> None:
    stacks = [pieces_of(edge) for name in ("mixed", "annulus", "blob_holes") for edge in solved(name).domain.outer]
    for pieces, found in zip(stacks, chains(stacks, 1e-3), strict=True):
        assert (found == np.vstack((chain(pieces, 1e-3)[0], pieces[-1, -1:, :2]))).all()
    assert chains([], 1e-3) == []


def distances(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Distance of points (n, k) from a chain (m, k)."""
    a, d = corners[:-1], np.diff(corners, axis=0)
    square = np.maximum(np.einsum("ij,ij->i", d, d), 1e-300)
    share = np.clip(np.einsum("nij,ij->ni", points[:, None] - a, d) / square, 0.0, 1.0)
    nearest = a + share[..., None] * d
    return np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1)


def test_a_line_is_one_chord() -> None:
    piece = np.array([[[0.0, 0.0, 1.0], [1.0, 1.0, 3.0], [2.0, 2.0, 1.0]]])
    assert flatness(piece) == pytest.approx(0.0, abs=1e-15)
    assert len(chain(piece, 1e-9)[0]) == 1


@pytest.mark.parametrize("name", SHAPES)
def test_pieces_are_the_curve(name: str) -> None:
    axis = solved(name)
    for edge in axis.domain.outer:
        breaks = edge.pieces()[1]
        t = np.linspace(0.0, 1.0, 5)
        found = points_at(pieces_of(edge), t)
        u = breaks[:-1, None] + t * np.diff(breaks)[:, None]
        np.testing.assert_allclose(found, edge.evaluate(u), atol=1e-13 * axis.domain.size)


def test_a_closed_piece_is_cut() -> None:
    loop = RationalBSpline(3, np.repeat([0.0, 1.0], 4), np.array([[0.0, 0], [1, 0], [0, 1], [0, 0]]), np.ones(4))
    assert len(chain(pieces_of(loop), 0.05)[0]) > 2
