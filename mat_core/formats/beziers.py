"""Bezier pieces of any dimension as one array: points on them, their halves, chords within a tolerance.

A stack of S pieces of degree p in k dimensions is ``(S, p + 1, k + 1)``: rows of Euclidean coordinates followed by a
positive weight. Everything is vectorised over the stack; nothing here is compiled.
"""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np
from numpy.typing import NDArray

from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]

MOST_HALVINGS = 24  # of one piece; a chord is then a sixteen-millionth of it


def pieces_of(curve: RationalBSpline) -> Floats:
    """The pieces (S, p + 1, 3) of a curve: x, y and weight."""
    return curve.pieces()[0].reshape(-1, curve.degree + 1, 3)


@cache
def _binomials(degree: int) -> Floats:
    return np.array([float(comb(degree, i)) for i in range(degree + 1)])


def points_at(pieces: Floats, t: Floats) -> Floats:
    """Points (S, T, k) of every piece at the parameters t (T,) in [0, 1]; the ends are met exactly."""
    degree = pieces.shape[1] - 1
    i = np.arange(degree + 1)
    basis = _binomials(degree) * t[:, None] ** i * (1.0 - t[:, None]) ** (degree - i)
    weights = pieces[..., -1]
    shares = basis * weights[:, None, :]
    shares /= shares.sum(axis=2, keepdims=True)
    first = pieces[:, :1, :-1]
    # from the first control point, so that coordinates far from the origin keep their digits
    points: Floats = first + shares @ (pieces[..., :-1] - first)
    points[:, t == 1.0] = pieces[:, -1:, :-1]
    return points


def slopes_at_ends(pieces: Floats) -> tuple[Floats, Floats]:
    """Derivatives (S, k) by the parameter at the two ends of every piece."""
    degree = pieces.shape[1] - 1
    w = pieces[..., -1:]
    at_start = degree * (w[:, 1] / w[:, 0]) * (pieces[:, 1, :-1] - pieces[:, 0, :-1])
    at_end = degree * (w[:, -2] / w[:, -1]) * (pieces[:, -1, :-1] - pieces[:, -2, :-1])
    return at_start, at_end


def halves(pieces: Floats) -> tuple[Floats, Floats]:
    """Left and right halves of every piece, by convex steps between Euclidean points (see `mat_core.kernels.bezier`)."""
    left, right = pieces.copy(), pieces.copy()
    for level in range(1, pieces.shape[1]):
        w = right[:, :-level, -1:] + right[:, 1 : pieces.shape[1] - level + 1, -1:]
        share = right[:, 1 : pieces.shape[1] - level + 1, -1:] / w
        step = right[:, 1 : pieces.shape[1] - level + 1, :-1] - right[:, :-level, :-1]
        right[:, :-level, :-1] += share * step
        right[:, :-level, -1:] = 0.5 * w
        left[:, level] = right[:, 0]
    return left, right


def flatness(pieces: Floats) -> Floats:
    """Bounds (S,) of how far each piece and its chord are apart, either way.

    A piece lies in the hull of its control points, and the points within a distance of a chord are a convex set: no point of
    the piece is farther from the chord than the farthest control point.
    """
    start = pieces[:, :1, :-1]
    chord = pieces[:, -1:, :-1] - start
    away = pieces[:, 1:-1, :-1] - start
    square = np.einsum("sik,sik->si", chord, chord)
    along = np.einsum("sik,sjk->sj", chord, away) / np.where(square > 0.0, square, 1.0)
    off = away - np.clip(along, 0.0, 1.0)[..., None] * chord
    bounds: Floats = np.sqrt(np.einsum("sik,sik->si", off, off)).max(axis=1, initial=0.0)
    return bounds


def chain(pieces: Floats, tolerance: float) -> tuple[Floats, NDArray[np.int64]]:
    """Vertices of chords that stray from the pieces by at most `tolerance`, in all coordinates together.

    Pieces are halved, all of one generation at once, until every chord is within the tolerance.

    Returns
    -------
    vertices : (n, k) float64
        Start of each chord in the order of the pieces; the end of the last piece is not among them.
    piece : (n,) int64
        The piece on which each chord lies.
    """
    number = np.arange(len(pieces))
    at = np.zeros(len(pieces))
    done: list[tuple[NDArray[np.int64], Floats, Floats]] = []
    for generation in range(MOST_HALVINGS + 1):
        flat = flatness(pieces) <= tolerance
        if generation == MOST_HALVINGS:
            flat[:] = True
        done.append((number[flat], at[flat], pieces[flat, 0, :-1]))
        bent = ~flat
        if not bent.any():
            break
        left, right = halves(pieces[bent])
        pieces = np.concatenate((left, right))
        number = np.tile(number[bent], 2)
        at = np.concatenate((at[bent], at[bent] + 0.5 ** (generation + 1)))
    piece, where, vertices = (np.concatenate(column) for column in zip(*done, strict=True))
    order = np.lexsort((where, piece))
    return vertices[order], piece[order]


def chains(stacks: list[Floats], tolerance: float) -> list[Floats]:
    """`chain` for many curves at once: the vertices (n, k) of each, its last one included."""
    of_degree: dict[int, list[int]] = {}
    for i, pieces in enumerate(stacks):
        of_degree.setdefault(pieces.shape[1], []).append(i)
    found = list(stacks)
    for members in of_degree.values():
        vertices, piece = chain(np.concatenate([stacks[i] for i in members]), tolerance)
        owner = np.repeat(np.arange(len(members)), [len(stacks[i]) for i in members])
        bounds = np.searchsorted(owner[piece], np.arange(len(members) + 1)).tolist()
        for first, last, i in zip(bounds[:-1], bounds[1:], members, strict=True):
            found[i] = np.vstack((vertices[first:last], stacks[i][-1, -1:, :-1]))
    return found
