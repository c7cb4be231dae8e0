"""Rebuilt boundaries never run back along themselves: where the envelope of an axis folds, the fold is cut out.

    -------------->+  A        The derivatives of an axis within eps of the true one are wrong by more, and move the envelope
             +<----'           along itself. Where the boundary's own way along the axis is slow (its point moves like t^2 beside
          B  '----------->     a curvature centre at a jump of curvature) that may turn it round: from A back to B, on one line.

1. `forward`: of each Bezier only what runs ahead is kept, told by its derivative's share in the direction that the disc's
   normal gives, a polynomial; and nothing beyond where the first one starts and the last one ends.
2. `follow`: what of the Beziers before lies ahead of where the next ones start (from B to A) is cut off.

All that is cut off is covered by what follows, but for the error of the axis.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Headings = Callable[[Floats], Floats]  # v (n,) -> (n, 2), the direction of travel there

LEAST = 1e-15  # normalised: a way back this short is rounding of coordinates
GENTLE = 0.5  # cosine of the turn between the ends of a Bezier up to which its mean direction tells forwards from back
HALVINGS = 8  # at most, until turns are gentle
NEARLY_REAL = 1e-7  # imaginary share of a root up to which it may be half of a double one; a pair more does no harm


def forward(pieces: list[Floats], ends: Floats, headings: Headings) -> list[Floats]:
    """Step 1 for Beziers (n + 1, 2) in a row.

    Parameters
    ----------
    pieces : list of (n + 1, 2) float64
    ends : (len(pieces), 2) float64
        Their parameters v.
    headings : callable

    Returns
    -------
    list of (n + 1, 2) float64
        The same arrays where nothing runs back; empty when all does.
    """
    middle = headings(ends.mean(axis=1))
    ahead = np.einsum("kjc,kc->kj", np.diff(np.array(pieces), axis=1), middle).min(axis=1) >= -LEAST
    if ahead.all():
        return pieces
    kept: list[Floats] = []
    for piece, (v0, v1), whole in zip(pieces, ends.tolist(), ahead.tolist(), strict=True):
        found = [(piece, v0)] if whole else _ahead(piece, v0, v1, headings, HALVINGS)
        for part, v in found:
            follow(kept, [part], headings(np.array([v]))[0])
    start, end = headings(ends[[0, -1], [0, 1]])
    retreat(kept, pieces[-1][-1], end)
    backwards = [piece[::-1] for piece in reversed(kept)]
    retreat(backwards, pieces[0][0], -start)
    return [piece[::-1] for piece in reversed(backwards)]


def _ahead(piece: Floats, v0: float, v1: float, headings: Headings, halvings: int) -> list[tuple[Floats, float]]:
    """Parts of one Bezier that run ahead, each with the v where it starts."""
    start, end = headings(np.array([v0, v1]))
    if float(start @ end) < GENTLE and halvings:
        middle = 0.5 * (v0 + v1)
        first, second = split(piece, 0.5)
        return _ahead(first, v0, middle, headings, halvings - 1) + _ahead(second, middle, v1, headings, halvings - 1)
    share = np.diff(piece, axis=0) @ (start + end)
    if share.min() >= -LEAST:
        return [(piece, v0)]
    parts = []
    for a, b in pairwise([0.0, *_zeros(share), 1.0]):
        if _value(share, 0.5 * (a + b)) > 0.0:
            parts.append((split(split(piece, b)[0], a / b)[1], v0 + a * (v1 - v0)))
    return parts


def follow(pieces: list[Floats], more: list[Floats], heading: Floats) -> None:
    """Step 2: add `more`, which start with a heading, to `pieces`."""
    if more:
        retreat(pieces, more[0][0], heading)
    pieces.extend(more)


def retreat(pieces: list[Floats], place: Floats, heading: Floats) -> None:
    """Cut off what lies ahead of a place; it may be all."""
    while pieces:
        ahead = (pieces[-1] - place) @ heading
        if ahead[-1] <= LEAST:
            break
        crossed = _zeros(ahead)
        last = pieces.pop()
        if crossed:
            pieces.append(split(last, crossed[-1])[0])
            break


def split(control: Floats, t: float) -> tuple[Floats, Floats]:
    """Both parts of a Bezier (de Casteljau)."""
    left, right = control.copy(), control.copy()
    row = control
    for i in range(1, len(control)):
        row = row[:-1] + t * (row[1:] - row[:-1])
        left[i], right[-1 - i] = row[0], row[-1]
    return left, right


def _value(coefficients: Floats, t: float) -> float:
    """Of a polynomial in Bernstein form."""
    n = len(coefficients) - 1
    return math.fsum(c * math.comb(n, j) * t**j * (1.0 - t) ** (n - j) for j, c in enumerate(coefficients.tolist()))


def _zeros(coefficients: Floats) -> list[float]:
    """Where in (0, 1) a polynomial in Bernstein form changes its sign, in order."""
    n = len(coefficients) - 1
    odds = [math.comb(n, j) * c for j, c in enumerate(coefficients.tolist())]  # in z = t / (1 - t)
    roots = np.roots(odds[::-1])
    z = roots[(roots.real > 0.0) & (np.abs(roots.imag) <= NEARLY_REAL * np.abs(roots))].real
    return sorted((z / (1.0 + z)).tolist())
