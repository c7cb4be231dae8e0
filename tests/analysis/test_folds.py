"""Folds of a rebuilt boundary, on curves whose folds are known."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from mat_core.analysis.fitting import bernstein
from mat_core.analysis.rebuilding.folds import follow, forward, split

Floats = NDArray[np.float64]

EAST = np.array([1.0, 0.0])
UPWARD = np.array([0.0, 1.0])


def east(v: Floats) -> Floats:
    return np.tile(EAST, (len(v), 1))


def bezier(*x: float) -> Floats:
    """Along the x axis, slightly bent."""
    at = np.array(x)
    return np.column_stack((at, 0.1 * at**2))


def traced(pieces: list[Floats]) -> Floats:
    v = np.linspace(0.0, 1.0, 101)
    return np.concatenate([bernstein(len(piece) - 1, v) @ piece for piece in pieces])


def rows(count: int) -> Floats:
    return np.column_stack((np.arange(count), np.arange(1, count + 1))) / count


def test_what_runs_ahead_stays_as_it_is() -> None:
    pieces = [bezier(0.0, 0.1, 0.2, 0.4), bezier(0.4, 0.5, 0.8, 1.0)]
    assert forward(pieces, rows(2), east) is pieces


@pytest.mark.parametrize(
    "x",
    [
        [(0.0, 0.5, 1.2, 1.0), (1.0, 1.4, 1.7, 2.0)],  # turned at the end
        [(0.0, 0.4, 0.7, 1.0), (1.0, 0.8, 1.5, 2.0)],  # turned at the start
        [(0.0, 1.9, 0.1, 2.0)],  # a fold inside
        [(0.0, 0.4, 0.7, 1.0), (1.0, 0.9, 0.8, 0.7), (0.7, 1.0, 1.5, 2.0)],  # all of one piece runs back
        [(0.0, 0.3, 0.6, 0.9), (0.9, 0.95, 1.0, 1.1), (1.1, 1.0, 0.9, 0.8), (0.8, 1.0, 1.5, 2.0)],  # past a whole piece
    ],
)
def test_a_fold_is_cut_out(x: list[tuple[float, ...]]) -> None:
    kept = forward([bezier(*row) for row in x], rows(len(x)), east)
    path = traced(kept)
    assert (np.diff(path[:, 0]) >= -1e-12).all()
    assert path[0, 0] == 0.0
    assert path[-1, 0] == 2.0
    for before, after in pairwise(kept):
        assert np.hypot(*(before[-1] - after[0])) <= 0.05  # how far both branches of these folds are from each other


def test_nothing_is_left_of_what_only_runs_back() -> None:
    assert forward([bezier(1.0, 0.7, 0.4, 0.0)], rows(1), east) == []


def test_a_turn_of_half_a_circle_is_no_fold() -> None:
    x = np.array([[0.0, 0.0], [1.4, 0.0], [1.4, 1.0], [0.0, 1.0]])
    angles = [0.0, np.pi]

    def headings(v: Floats) -> Floats:
        a = np.interp(v, [0.0, 1.0], angles)
        return np.column_stack((np.cos(a), np.sin(a)))

    kept = forward([x], rows(1), headings)
    lengths = [np.hypot(*np.diff(traced(pieces), axis=0).T).sum() for pieces in (kept, [x])]
    assert lengths[0] == pytest.approx(lengths[1], rel=1e-3)  # of polygons
    assert kept[0][0].tolist() == [0.0, 0.0]
    assert kept[-1][-1].tolist() == [0.0, 1.0]
    assert all((a[-1] == b[0]).all() for a, b in pairwise(kept))


def test_what_follows_without_overlap_is_only_added() -> None:
    before, after = bezier(0.0, 0.3, 0.6, 1.0), bezier(1.0, 1.3, 1.6, 2.0)
    pieces = [before]
    follow(pieces, [after], EAST)
    assert pieces[0] is before
    assert pieces[1] is after


def test_an_overlap_across_the_heading_is_none() -> None:
    pieces = [np.array([[0.0, 0.0], [1.0, 0.0]])]
    follow(pieces, [np.array([[1.0, 0.0], [1.0, 1.0]])], UPWARD)
    assert pieces[0][-1].tolist() == [1.0, 0.0]


def test_split_gives_both_parts_of_a_curve() -> None:
    whole = bezier(0.0, 0.3, 0.9, 1.0)
    left, right = split(whole, 0.3)
    v = np.linspace(0.0, 1.0, 11)
    assert bernstein(3, v) @ left == pytest.approx(bernstein(3, 0.3 * v) @ whole, abs=1e-15)
    assert bernstein(3, v) @ right == pytest.approx(bernstein(3, 0.3 + 0.7 * v) @ whole, abs=1e-15)
