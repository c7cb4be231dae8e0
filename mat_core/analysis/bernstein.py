"""Polynomials in Bernstein form, many at a time: products, values, and where they change sign.

    p(s) = sum c_i binomial(n, i) s^i (1 - s)^(n - i),   s in [0, 1]

A row of an array is one polynomial. Its number of roots in (0, 1) is at most that of the sign changes of its
coefficients, and of the same parity (Descartes' rule in Bernstein form): none means none, one means one. Halving [0, 1]
until that decides finds all of them; nothing is sampled.
"""

from __future__ import annotations

from math import comb

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NOISE = 4e-15  # coefficients below this share of the largest carry no sign
MAX_DEPTH = 44  # halvings before a cluster of sign changes is taken as one place
BISECTIONS = 50  # of an interval with one sign change: to the last digit


def binomials(n: int) -> Floats:
    """(n + 1,) binomial coefficients of degree n."""
    return np.array([comb(n, i) for i in range(n + 1)], dtype=float)


def product(a: Floats, b: Floats) -> Floats:
    """Products of rows (m, p + 1) and (m, q + 1): (m, p + q + 1)."""
    p, q = a.shape[1] - 1, b.shape[1] - 1
    left, right = a * binomials(p), b * binomials(q)
    out = np.zeros((len(a), p + q + 1), dtype=np.result_type(a, b))
    for i in range(p + 1):
        out[:, i : i + q + 1] += left[:, i : i + 1] * right
    out /= binomials(p + q)
    return out


def derivative(c: Floats) -> Floats:
    """Derivatives of rows (m, n + 1), n >= 1: (m, n)."""
    out: Floats = (c.shape[1] - 1) * np.diff(c, axis=1)
    return out


def value(c: Floats, s: Floats) -> Floats:
    """(m,) values of rows (m, n + 1) at s (m,), by de Casteljau's convex steps."""
    at = s[:, None]
    while c.shape[1] > 1:
        c = (1.0 - at) * c[:, :-1] + at * c[:, 1:]
    return c.reshape(-1)


def halve(c: Floats) -> tuple[Floats, Floats]:
    """Rows over [0, 1/2] and over [1/2, 1]; any trailing axes are carried along."""
    left, right = np.empty_like(c), np.empty_like(c)
    n = c.shape[1] - 1
    for level in range(n + 1):
        left[:, level] = c[:, 0]
        right[:, n - level] = c[:, -1]
        c = 0.5 * (c[:, :-1] + c[:, 1:])
    return left, right


def restrict(c: Floats, a: Floats, b: Floats) -> Floats:
    """Rows over [a, b] of [0, 1], a < b (m,) each, by convex steps; any trailing axes are carried along."""
    out = c.copy()
    n = c.shape[1] - 1
    shape = (-1, *[1] * (c.ndim - 1))
    upper = b.reshape(shape)
    lower = (a / b).reshape(shape)
    for level in range(1, n + 1):
        out[:, level:] = (1.0 - upper) * out[:, level - 1 : -1] + upper * out[:, level:]
    for level in range(1, n + 1):
        out[:, : n + 1 - level] = (1.0 - lower) * out[:, : n + 1 - level] + lower * out[:, 1 : n + 2 - level]
    return out


def variations(c: Floats, noise: Floats) -> tuple[Ints, Floats]:
    """Sign changes (m,) of the coefficients that stand out of the noise (m,), and the first such sign (0: none)."""
    sign = np.where(np.abs(c) > noise[:, None], np.sign(c), 0.0)
    changes = np.zeros(len(c), dtype=np.int64)
    first = np.zeros(len(c))
    last = np.zeros(len(c))
    for column in sign.T:
        changes += column * last < 0.0
        last = np.where(column != 0.0, column, last)
        first = np.where(first != 0.0, first, column)
    return changes, first


def sign_changes(c: Floats, floor: Floats | float = 0.0) -> tuple[Ints, Floats]:
    """Where polynomials change sign inside (0, 1).

    Parameters
    ----------
    c : (m, n + 1) float64
        Bernstein coefficients, one polynomial a row.
    floor : float or (m,) float64
        Coefficients up to here are rounding and carry no sign.

    Returns
    -------
    row : (k,) int64
        Whose change it is, in increasing order.
    s : (k,) float64
        Where, increasing within a row. Each sign change is listed. So is a place where a polynomial only touches zero to
        within rounding, perhaps more than once: who must know which it is compares values on both sides.
    """
    noise = np.maximum(NOISE * np.abs(c).max(axis=1, initial=0.0), floor)
    row = np.arange(len(c))
    low = np.zeros(len(c))
    width = 1.0
    found: list[tuple[Ints, Floats]] = []
    for depth in range(MAX_DEPTH + 1):
        count, first = variations(c, noise[row])
        one = count == 1
        if one.any():
            found.append((row[one], low[one] + width * _bisect(c[one], first[one])))
        more = count > 1
        if not more.any():
            break
        row, low = row[more], low[more]
        if depth == MAX_DEPTH:
            found.append((row, low + 0.5 * width))
            break
        left, right = halve(c[more])
        width *= 0.5
        # a root at the common end is seen by neither half
        met = np.abs(right[:, 0]) <= noise[row]
        found.append((row[met], low[met] + width))
        row, low, c = np.tile(row, 2), np.concatenate((low, low + width)), np.concatenate((left, right))
    if not found:
        return np.empty(0, dtype=np.int64), np.empty(0)
    rows = np.concatenate([r for r, _ in found])
    places = np.concatenate([s for _, s in found])
    order = np.lexsort((places, rows))
    return rows[order], places[order]


def _bisect(c: Floats, first: Floats) -> Floats:
    """(m,) the one sign change of each row; `first` is the sign before it."""
    low, high = np.zeros(len(c)), np.ones(len(c))
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        before = value(c, middle) * first > 0.0
        low = np.where(before, middle, low)
        high = np.where(before, high, middle)
    return 0.5 * (low + high)
