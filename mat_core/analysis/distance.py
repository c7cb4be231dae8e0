"""How far curves are from each other: dense points of the one, their nearest points on the other.

The nearest chord of a flattening tells the piece and a parameter to begin with, Newton's method finds the foot of the
perpendicular on the curve itself; so the figure is limited by rounding, not by the flattening.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core.analysis.fitting import bernstein
from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CHORDS = 16  # of a Bezier piece
SAMPLES = 12  # points of a Bezier piece that are measured, its ends among them
STEPS = 12  # of Newton's method


class Pieces(NamedTuple):
    """Bezier pieces of one degree: homogeneous (n, degree + 1, 3)."""

    homogeneous: Floats

    def evaluate(self, piece: Ints, v: Floats) -> tuple[Floats, Floats]:
        """Points and derivatives (n, 2) at v of pieces."""
        rows = self.homogeneous[piece]
        n = rows.shape[1] - 1
        value = np.einsum("nk,nkc->nc", bernstein(n, v), rows)
        rate = n * np.einsum("nk,nkc->nc", bernstein(n - 1, v), np.diff(rows, axis=1))
        p = value[:, :2] / value[:, 2:]
        d: Floats = (rate[:, :2] - p * rate[:, 2:]) / value[:, 2:]
        return p, d


def pieces_of(edges: Iterable[RationalBSpline], origin: Floats) -> list[Pieces]:
    """The Bezier pieces of curves, by degree, about an origin (so that no digits go to where they lie)."""
    by_degree: dict[int, list[Floats]] = {}
    for edge in edges:
        rows = edge.pieces()[0].reshape(-1, edge.degree + 1, 3)
        weight = rows[:, :, 2:]
        by_degree.setdefault(edge.degree, []).append(np.concatenate(((rows[:, :, :2] - origin) * weight, weight), axis=2))
    return [Pieces(np.concatenate(rows)) for rows in by_degree.values()]


def farthest(from_curves: list[Pieces], to_curves: list[Pieces]) -> float:
    """Largest distance of points of the first curves from the second ones."""
    v = np.linspace(0.0, 1.0, SAMPLES)
    points = np.concatenate([_sampled(group, v)[2] for group in from_curves])
    starts, ends, owner, piece, first = [], [], [], [], []
    v = np.linspace(0.0, 1.0, CHORDS + 1)
    for g, group in enumerate(to_curves):
        which, at, found = _sampled(group, v)
        chords = np.flatnonzero(at < 1.0)
        starts.append(found[chords])
        ends.append(found[chords + 1])
        owner.append(np.full(len(chords), g))
        piece.append(which[chords])
        first.append(at[chords])
    a, b = np.concatenate(starts), np.concatenate(ends)
    tree = shapely.STRtree(shapely.linestrings(np.stack((a, b), axis=1)))
    near = tree.nearest(shapely.points(points))
    chord = b[near] - a[near]
    length = np.maximum((chord**2).sum(axis=1), np.finfo(float).tiny)
    share = np.clip(((points - a[near]) * chord).sum(axis=1) / length, 0.0, 1.0)
    v0 = np.concatenate(first)[near] + share / CHORDS
    groups, pieces = np.concatenate(owner)[near], np.concatenate(piece)[near]
    worst = 0.0
    for g, group in enumerate(to_curves):
        own = groups == g
        if own.any():
            worst = max(worst, float(_foot_distance(group, pieces[own], v0[own], points[own]).max()))
    return worst


def _sampled(group: Pieces, v: Floats) -> tuple[Ints, Floats, Floats]:
    """(piece, v, point) of all pieces of a group at the same parameters."""
    which = np.repeat(np.arange(len(group.homogeneous)), len(v))
    at = np.tile(v, len(group.homogeneous))
    return which, at, group.evaluate(which, at)[0]


def _foot_distance(group: Pieces, piece: Ints, v: Floats, q: Floats) -> Floats:
    """Distance of points q (n, 2) from pieces, from near v on."""
    best = np.full(len(v), np.inf)
    for _ in range(STEPS):
        p, d = group.evaluate(piece, v)
        off = q - p
        best = np.minimum(best, np.hypot(off[:, 0], off[:, 1]))
        speed = np.maximum((d**2).sum(axis=1), np.finfo(float).tiny)
        v = np.clip(v + (off * d).sum(axis=1) / speed, 0.0, 1.0)
    return best
