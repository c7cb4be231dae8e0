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

CHORDS = 16384  # of all Bezier pieces of a degree, about, shared evenly
FEWEST, MOST = 8, 128  # of a piece
SLACK = 1e-14  # relative: of distances that shapely rounds
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
    chords = [_chords(group) for group in to_curves]
    ends, bulge, piece, first, step = (np.concatenate(columns) for columns in zip(*chords, strict=True))
    owner = np.repeat(np.arange(len(chords)), [len(c[1]) for c in chords])
    tree = shapely.STRtree(shapely.linestrings(ends))
    where = shapely.points(points)
    reach = shapely.distance(where, tree.geometries[tree.nearest(where)])
    scale = float(np.abs(ends).max())
    # a curve may be nearer than its chord: all whose bulge could make them the nearest
    point, near = tree.query(where, predicate="dwithin", distance=reach + 2.0 * float(bulge.max()) + SLACK * scale)
    apart = shapely.distance(where[point], tree.geometries[near])
    likely = apart <= reach[point] + bulge[near] + float(bulge.max()) + SLACK * scale
    point, near = point[likely], near[likely]
    chord = ends[near, 1] - ends[near, 0]
    length = np.maximum((chord**2).sum(axis=1), np.finfo(float).tiny)
    share = np.clip(((points[point] - ends[near, 0]) * chord).sum(axis=1) / length, 0.0, 1.0)
    best = np.full(len(points), np.inf)
    for g, group in enumerate(to_curves):
        own = owner[near] == g
        v0 = first[near[own]] + share[own] * step[near[own]]
        np.minimum.at(best, point[own], _foot_distance(group, piece[near[own]], v0, points[point[own]]))
    return float(best.max())


def _chords(group: Pieces) -> tuple[Floats, Floats, Ints, Floats, Floats]:
    """Chords of a flattening: ends (n, 2, 2), how far the curve bulges from each, piece, v at the start, its step."""
    count = int(np.clip(CHORDS // len(group.homogeneous), FEWEST, MOST))
    which, at, found = _sampled(group, np.linspace(0.0, 1.0, count + 1))
    begins = np.flatnonzero(at < 1.0)
    ends = np.stack((found[begins], found[begins + 1]), axis=1)
    middle = group.evaluate(which[begins], at[begins] + 0.5 / count)[0]
    return ends, 2.0 * np.hypot(*(middle - ends.mean(axis=1)).T), which[begins], at[begins], np.full(len(begins), 1.0 / count)


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
