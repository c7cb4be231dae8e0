"""What a curve is in the words of drawing programs: lines, circular arcs, and splines that are neither.

A curve is named line or arc only when the two agree to rounding, by a bound that covers all of it, so that a drawing made
of primitives is as exact as the curves were.

A piece X/W, Y/W of degree p lies on the circle of radius R about the origin when

    F = X^2 + Y^2 - R^2 W^2

vanishes. F is a polynomial of degree 2 p; its Bernstein coefficients bound it, and min w bounds W from below, hence
|distance from the circle| <= max |F_i| / (R min w^2).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mat_core.formats.beziers import pieces_of, points_at
from mat_core.model.curve import RationalBSpline
from mat_core.model.domain import Domain

Floats = NDArray[np.float64]
Point = tuple[float, float]

EXACT = 1e-13  # of the size: how far a curve may be from the line or arc that it is said to be; rounding leaves about 1e-15
ULPS = 4.0  # of the largest coordinate: what rounding of control points makes of a circle that is far from the origin
SAMPLES = 16  # points on a piece from which its sweep is taken
THREE = np.array([0.0, 0.3, 0.7])  # places on a piece whose circle is tried; a piece may be a whole circle
FULL_TURN = 2.0 * math.pi


@dataclass(frozen=True, slots=True)
class Line:
    """A straight line from start to end."""

    start: Point
    end: Point


@dataclass(frozen=True, slots=True)
class Arc:
    """A circular arc.

    Attributes
    ----------
    center : tuple of float
    radius : float
    start : float
        Angle of its first point, in radians.
    sweep : float
        By how much it turns, positive counter-clockwise; at most a full turn either way.
    ends : tuple of tuple of float
        First and last point.
    """

    center: Point
    radius: float
    start: float
    sweep: float
    ends: tuple[Point, Point]

    @property
    def closed(self) -> bool:
        """Whether it is a whole circle."""
        return self.ends[0] == self.ends[1]


Primitive = Line | Arc | RationalBSpline


def rounding(domain: Domain) -> float:
    """How near a curve of a domain must be to a line or an arc to be one, in the caller's unit."""
    return EXACT * domain.size + ULPS * math.ulp(max(abs(v) for v in domain.bbox))


def primitives(curves: Iterable[RationalBSpline], tolerance: float) -> list[Primitive]:
    """Curves as primitives, in their order; those that are a single point are left out.

    Parameters
    ----------
    curves : iterable of RationalBSpline
        Curves that do not cross themselves.
    tolerance : float
        See `rounding`.
    """
    found: list[Primitive] = []
    for curve in curves:
        points = curve.control_points
        if (points == points[0]).all():
            continue
        if curve.degree == 1:
            found.extend(_sides(points))
        else:
            found.append(as_line(curve, tolerance) or as_arc(curve, tolerance) or curve)
    return found


def _sides(points: Floats) -> list[Primitive]:
    rows = [(x, y) for x, y in points.tolist()]
    return [Line(a, b) for a, b in pairwise(rows) if a != b]


def as_line(curve: RationalBSpline, tolerance: float) -> Line | None:
    """The straight line that the curve is, or None."""
    points = curve.control_points
    (x0, y0), (x1, y1) = points[0].tolist(), points[-1].tolist()
    length = math.hypot(x1 - x0, y1 - y0)
    if length <= tolerance:
        return None
    away = np.abs((x1 - x0) * (points[:, 1] - y0) - (y1 - y0) * (points[:, 0] - x0)) / length
    along = ((x1 - x0) * (points[:, 0] - x0) + (y1 - y0) * (points[:, 1] - y0)) / length
    beside = away.max() > tolerance
    beyond = along.min() < -tolerance or along.max() > length + tolerance
    return None if beside or beyond else Line((x0, y0), (x1, y1))


def as_arc(curve: RationalBSpline, tolerance: float) -> Arc | None:
    """The circular arc that the curve is, or None; a whole circle is one arc."""
    pieces = pieces_of(curve).copy()
    corner = pieces[0, 0, :2].copy()
    pieces[..., :2] -= corner
    center = _circumcenter(points_at(pieces[:1], THREE)[0])
    if center is None:
        return None
    pieces[..., :2] -= center
    center += corner
    radius = float(np.hypot(*pieces[0, 0, :2]))
    if _off_circle(pieces, radius) > tolerance:
        return None
    points = points_at(pieces, np.arange(SAMPLES) / SAMPLES).reshape(-1, 2)
    points = np.vstack((points, pieces[-1, -1, :2]))
    angles = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    steps = np.diff(angles)
    sweep = float(angles[-1] - angles[0])
    if not ((steps > 0.0).all() or (steps < 0.0).all()) or abs(sweep) > FULL_TURN + 1.0:
        return None
    ends = tuple(curve.control_points[[0, -1]].tolist())
    first, last = (ends[0][0], ends[0][1]), (ends[1][0], ends[1][1])
    if first == last:
        sweep = math.copysign(FULL_TURN, sweep)
    arc = Arc((float(center[0]), float(center[1])), radius, float(angles[0]), sweep, (first, last))
    return arc if _ends_agree(arc, tolerance) else None


def _circumcenter(points: Floats) -> Floats | None:
    """Centre of the circle through three points (3, 2); None when they are on a line."""
    a, b = points[1] - points[0], points[2] - points[0]
    cross = 2.0 * float(a[0] * b[1] - a[1] * b[0])
    if cross == 0.0:
        return None
    p, q = float(a @ a), float(b @ b)
    center: Floats = points[0] + np.array([b[1] * p - a[1] * q, a[0] * q - b[0] * p]) / cross
    return center


def _off_circle(pieces: Floats, radius: float) -> float:
    """Bound of the pieces' distance from the circle about the origin."""
    degree = pieces.shape[1] - 1
    binomials = np.array([float(math.comb(degree, i)) for i in range(degree + 1)])
    doubled = np.array([float(math.comb(2 * degree, i)) for i in range(2 * degree + 1)])
    worst = 0.0
    for piece in pieces:
        w = piece[:, 2] / piece[:, 2].max()
        x, y, v = (binomials * w * c for c in (piece[:, 0], piece[:, 1], np.full(degree + 1, radius)))
        f = (np.convolve(x, x) + np.convolve(y, y) - np.convolve(v, v)) / doubled
        worst = max(worst, float(np.abs(f).max()) / (radius * float(w.min()) ** 2))
    return worst


def _ends_agree(arc: Arc, tolerance: float) -> bool:
    """Whether centre, radius and angles in degrees, as they are written, lead back to the ends: not so on nearly flat arcs."""
    for angle, (x, y) in zip((arc.start, arc.start + arc.sweep), arc.ends, strict=True):
        written = math.radians(math.degrees(angle))
        px, py = arc.center[0] + arc.radius * math.cos(written), arc.center[1] + arc.radius * math.sin(written)
        if math.hypot(px - x, py - y) > tolerance:
            return False
    return True
