"""Domains as peers read them: chords within a tolerance on a grid of integers, curves of their kinds, cubic Beziers.

Loops are turned so that the interior lies on the left; an edge is cut into Bezier pieces (p + 1, 3) of x, y, weight.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core import Domain
from mat_core.formats.beziers import pieces_of, points_at
from mat_core.formats.primitives import Arc, Line, primitives, rounding
from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]

PROBES = 16  # chords from whose distances the number needed is foretold
GRID = 2**31 - 2**20  # steps of the integer grid across the domain: what 32 bits hold
CORNER = 1e-6  # radians: a turn beyond it is a corner of the boundary, as `medial_axis` has it
MOST_CUBICS = 64  # for one rational piece
FINE_CHORDS = 4000  # of a piece: 1e-8 of a quarter circle


class Grid(NamedTuple):
    """Integer coordinates: (point - center) * scale, rounded."""

    center: Floats
    scale: float

    def back(self, points: Floats) -> Floats:
        """Grid points in the caller's coordinates."""
        return points / self.scale + self.center


def grid_of(domain: Domain) -> Grid:
    low, high = np.array(domain.bbox[:2]), np.array(domain.bbox[2:])
    return Grid(0.5 * (low + high), GRID / domain.size)


def loops_of(domain: Domain) -> list[list[RationalBSpline]]:
    """The loops' edges, the interior on their left."""
    loops = [list(loop) for loop in (domain.outer, *domain.holes)]
    return [_backwards(loop) if (_area(loop) > 0.0) != (k == 0) else loop for k, loop in enumerate(loops)]


def _area(loop: list[RationalBSpline]) -> float:
    points = np.concatenate([points_at(pieces_of(edge), np.linspace(0, 1, 9)[:-1]).reshape(-1, 2) for edge in loop])
    points -= points[0]
    after = np.roll(points, -1, axis=0)
    return float((points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]).sum())


def _backwards(loop: list[RationalBSpline]) -> list[RationalBSpline]:
    return [
        RationalBSpline(e.degree, (e.knots[0] + e.knots[-1] - e.knots)[::-1], e.control_points[::-1], e.weights[::-1])
        for e in reversed(loop)
    ]


# Chords --------------------------------------------------------------------------------------------------------------
def flatten(domain: Domain, tolerance: float) -> list[tuple[Floats, NDArray[np.bool_]]]:
    """Per loop the vertices (n, 2) of chords within `tolerance` of the size, and which are corners of the boundary.

    Each piece is cut evenly in its parameter into as few chords as keep the tolerance.
    """
    return [_flatten(loop, tolerance * domain.size) for loop in loops_of(domain)]


def _flatten(loop: list[RationalBSpline], tolerance: float) -> tuple[Floats, NDArray[np.bool_]]:
    pieces = [piece for edge in loop for piece in pieces_of(edge)]
    chains, turning = [], []
    ends = [_directions(piece) for piece in pieces]
    for i, piece in enumerate(pieces):
        count = 1 if len(piece) == 2 else chords_needed(piece, tolerance)
        chains.append(points_at(piece[None], np.arange(count) / count)[0] if count > 1 else piece[:1, :2])
        before, here = ends[i - 1][1], ends[i][0]
        turn = math.atan2(before[0] * here[1] - before[1] * here[0], float(before @ here))
        turning.append(np.arange(count) == 0 if abs(turn) > CORNER else np.zeros(count, dtype=bool))
    return np.concatenate(chains), np.concatenate(turning)


def chords_needed(piece: Floats, tolerance: float) -> int:
    """The fewest even steps whose chords are within a tolerance of the piece, from how far sixteen are."""
    count = PROBES
    for _ in range(3):
        off = _sagitta(piece, count)
        wanted = max(1, math.ceil(count * math.sqrt(off / tolerance)))
        if wanted == count:
            break
        count = wanted
    while _sagitta(piece, count) > tolerance:
        count += 1
    return count


def _sagitta(piece: Floats, count: int) -> float:
    points = points_at(piece[None], np.arange(2 * count + 1) / (2 * count))[0]
    chord = points[2::2] - points[:-2:2]
    off = points[1::2] - points[:-2:2]
    length = np.maximum(np.hypot(chord[:, 0], chord[:, 1]), np.finfo(float).tiny)
    return float((np.abs(chord[:, 0] * off[:, 1] - chord[:, 1] * off[:, 0]) / length).max())


def _directions(piece: Floats) -> tuple[Floats, Floats]:
    """First and last direction of a piece; control points that coincide with an end are passed over."""
    steps = np.diff(piece[:, :2], axis=0)
    steps = steps[np.abs(steps).sum(axis=1) > 0.0]
    return steps[0], steps[-1]


def write_chords(path: Path, domain: Domain, tolerance: float) -> int:
    """The file that boost_voronoi.cpp and run_pyvoronoi.py read; gives the number of chords."""
    grid = grid_of(domain)
    loops = []
    for points, corner in flatten(domain, tolerance):
        rows = np.column_stack([np.rint((points - grid.center) * grid.scale), corner]).astype(np.int32)
        apart = (rows[:, :2] != np.roll(rows[:, :2], 1, axis=0)).any(axis=1)
        loops.append(rows[apart])
    with path.open("wb") as file:
        file.write(np.int64(len(loops)).tobytes())
        for rows in loops:
            file.write(np.int64(len(rows)).tobytes() + rows.tobytes())
    return sum(map(len, loops))


# Curves --------------------------------------------------------------------------------------------------------------
def write_curves(path: Path, domain: Domain) -> None:
    """Lines, arcs and B-splines as run_open_cascade.py reads them, the best a curve can be named."""
    within = rounding(domain)
    loops = [[_entry(p) for p in primitives(loop, within)] for loop in loops_of(domain)]
    path.write_text(json.dumps({"loops": loops, "size": domain.size}), encoding="utf-8")


def _entry(primitive: Line | Arc | RationalBSpline) -> dict[str, Any]:
    if isinstance(primitive, Line):
        return {"kind": "line", "ends": [primitive.start, primitive.end]}
    if isinstance(primitive, Arc):
        own = {"center": primitive.center, "radius": primitive.radius, "start": primitive.start, "sweep": primitive.sweep}
        return {"kind": "arc", "ends": primitive.ends, **own}
    return {"kind": "spline", **primitive.to_dict()}


# Cubics --------------------------------------------------------------------------------------------------------------
def write_cubics(path: Path, domain: Domain, tolerance: float) -> None:
    """Loops of polynomial Beziers up to cubic, as run_flo_mat.mjs reads them; conics are approximated within the tolerance."""
    loops = [
        [part for edge in loop for piece in pieces_of(edge) for part in cubics(piece, tolerance * domain.size)]
        for loop in loops_of(domain)
    ]
    path.write_text(json.dumps({"loops": loops, "size": domain.size}), encoding="utf-8")


def cubics(piece: Floats, tolerance: float) -> list[Any]:
    """A polynomial piece as it is, a rational quadratic as the fewest cubics of equal parameter steps within a tolerance."""
    if len(piece) <= 4 and np.ptp(piece[:, 2]) == 0.0:
        return [piece[:, :2].tolist()]
    if len(piece) != 3:
        raise ValueError(f"a rational piece of degree {len(piece) - 1} has no cubics here")
    for count in range(1, MOST_CUBICS + 1):
        parts = [_cubic(_restrict(piece, i / count, (i + 1) / count)) for i in range(count)]
        if _apart(parts, piece) <= tolerance:
            break
    return [part.tolist() for part in parts]


def _cubic(conic: Floats) -> Floats:
    """The cubic beside a conic, (4, 2): handles 4 w / (3 (1 + w)) of its legs, as for circles, whose affine images these are."""
    w = conic[1, 2] / math.sqrt(conic[0, 2] * conic[2, 2])
    p, q, r = conic[:, :2]
    share = 4.0 * w / (3.0 * (1.0 + w))
    return np.array([p, p + share * (q - p), r + share * (q - r), r])


def _restrict(piece: Floats, a: float, b: float) -> Floats:
    """The part of a rational Bezier between two parameters, by blossoming in homogeneous coordinates."""
    rows = piece.copy()
    rows[:, :2] *= rows[:, 2:]
    degree = len(rows) - 1
    out = np.empty_like(rows)
    for i in range(degree + 1):
        level = rows
        for j in range(degree):
            t = b if j < i else a
            level = (1.0 - t) * level[:-1] + t * level[1:]
        out[i] = level[0]
    out[:, :2] /= out[:, 2:]
    return out


def _apart(parts: list[Floats], piece: Floats) -> float:
    """How far points of the cubics are from the piece's fine chords."""
    fine = shapely.LineString(points_at(piece[None], np.linspace(0, 1, FINE_CHORDS + 1))[0])
    stack = np.concatenate([np.stack(parts), np.ones((len(parts), 4, 1))], axis=2)
    points = points_at(stack, np.linspace(0, 1, 9)).reshape(-1, 2)
    return float(shapely.distance(shapely.points(points), fine).max())
