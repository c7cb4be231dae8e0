"""Bernstein forms put into each other, divided by powers, and between which values they are; a row is one polynomial."""

from __future__ import annotations

import functools
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.bernstein import binomials, halve, product

Floats = NDArray[np.float64]

HALVINGS = 3  # of [0, 1] before coefficients are taken for values: they are then nearer to them by 64
VANISHES = 1e-13  # a coefficient this small is zero but for rounding; normalised coordinates
WIDEST: Any = np.longdouble  # 80 bits with most processors, nowhere less than 64


def wide(rows: Floats) -> Floats:
    """The same polynomials in the widest floats there are: division by v^k multiplies rounding by binomials, up to 1e6."""
    return np.asarray(rows, dtype=WIDEST)


def raised(rows: Floats, degree: int) -> Floats:
    """The same polynomials with degree + 1 coefficients."""
    more = degree + 1 - rows.shape[1]
    return product(rows, np.ones((1, more + 1))) if more else rows


def total(a: Floats, b: Floats, sign: float = 1.0) -> Floats:
    """a + sign b of rows of any two degrees."""
    degree = max(a.shape[1], b.shape[1]) - 1
    return np.asarray(raised(a, degree) + sign * raised(b, degree))


def compose(outer: Floats, inner: Floats) -> Floats:
    """outer(inner(v)), of rows (R, m + 1) and (R, d + 1): (R, m d + 1), by de Casteljau's steps on polynomials."""
    rest = 1.0 - inner
    rows = [outer[:, i : i + 1] for i in range(outer.shape[1])]
    while len(rows) > 1:
        rows = [product(a, rest) + product(b, inner) for a, b in pairwise(rows)]
    return np.asarray(np.broadcast_to(rows[0], (len(inner), rows[0].shape[1])))


def values(rows: Floats, at: Floats) -> Floats:
    """(R, k) values of rows (R, n + 1) at `at` (R, k)."""
    columns = [rows[:, i : i + 1] for i in range(rows.shape[1])]
    while len(columns) > 1:
        columns = [(1.0 - at) * a + at * b for a, b in pairwise(columns)]
    return np.asarray(np.broadcast_to(columns[0], at.shape))


def places(degree: int) -> Floats:
    """(degree + 1,) where `through` wants its values: Chebyshev's, both ends among them."""
    found: Floats = 0.5 - 0.5 * np.cos(np.pi * np.arange(degree + 1) / degree)
    return found


@functools.cache
def _to_bernstein(degree: int) -> Floats:
    k, t = np.arange(degree + 1), places(degree)[:, None]
    return np.asarray(np.linalg.inv(binomials(degree) * t**k * (1.0 - t) ** (degree - k)))


def through(wanted: Floats) -> Floats:
    """The polynomials (R, d + 1) that have the wanted values (R, d + 1) at `places`."""
    return np.asarray(wanted @ _to_bernstein(wanted.shape[1] - 1).T)


def over_power(rows: Floats, power: int) -> tuple[Floats, NDArray[np.bool_]]:
    """(rows / v^power, whether each vanishes at 0 so often, but for rounding, which is taken off as a constant each time)."""
    good = np.ones(len(rows), dtype=bool)
    for _ in range(power):
        n = rows.shape[1] - 1
        good &= np.abs(rows[:, 0]) <= VANISHES
        rows = (rows[:, 1:] - rows[:, :1]) * (n / np.arange(1, n + 1))
    return rows, good


def least_and_most(rows: Floats) -> tuple[Floats, Floats]:
    """(R,) bounds of the values over [0, 1]."""
    fine = cells(rows).reshape(len(rows), -1)
    return fine.min(axis=1), fine.max(axis=1)


def largest(rows: Floats) -> Floats:
    """(R,) bounds of |values| over [0, 1]."""
    return np.asarray(np.abs(cells(rows)).max(axis=(1, 2)))


def cells(rows: Floats) -> Floats:
    """(R, 2^HALVINGS, n + 1) coefficients over equal parts of [0, 1]."""
    count = len(rows)
    for _ in range(HALVINGS):
        rows = np.stack(halve(rows), axis=1).reshape(-1, rows.shape[1])
    return rows.reshape(count, -1, rows.shape[1])
