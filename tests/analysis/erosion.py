"""What shapely makes of an offset, without the liberty that its own buffer takes.

GEOS simplifies what it buffers by up to 1 % of the distance, so its buffer of a fine polygon is no reference for areas
where the boundary is concave. Here a polygon is eroded by what its chords and reflex corners sweep, and only
the union and difference of polygons are left to shapely.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]

FAN_STEP = 1e-3  # radians between the corners of a swept fan
OVERLAP = 1e-7  # radians by which a fan reaches into its neighbours
RUN_TURN = 0.5  # radians that chords swept in one go may turn by
RUN_CHORDS = 64


def flatten(edges: list[RationalBSpline] | tuple[RationalBSpline, ...], chords: int = 400) -> Floats:
    """Points of a loop, `chords` a Bezier piece of each curve."""
    points = []
    for edge in edges:
        n = 1 if edge.degree == 1 else chords
        breaks = np.unique(edge.knots)
        u = (breaks[:-1, None] + np.diff(breaks)[:, None] * np.arange(n) / n).reshape(-1)
        points.append(evaluated(edge, u))
    return np.concatenate(points)


def evaluated(edge: RationalBSpline, u: Floats) -> Floats:
    """Points of an edge, by de Boor's algorithm for all parameters at once."""
    p, knots = edge.degree, edge.knots
    span = np.clip(np.searchsorted(knots, u, side="right") - 1, p, len(knots) - p - 2)
    homogeneous = np.column_stack((edge.control_points * edge.weights[:, None], edge.weights))
    rows = homogeneous[span[:, None] + np.arange(-p, 1)]
    for level in range(1, p + 1):
        for i in range(p, level - 1, -1):
            left = knots[span - p + i]
            a = ((u - left) / (knots[span + 1 + i - level] - left))[:, None]
            rows[:, i] = (1.0 - a) * rows[:, i - 1] + a * rows[:, i]
    return rows[:, p, :2] / rows[:, p, 2:]


def polygon(
    outer: tuple[RationalBSpline, ...], holes: tuple[tuple[RationalBSpline, ...], ...], chords: int = 400
) -> shapely.Polygon:
    """A domain as a fine polygon, outer loop counter-clockwise."""
    return shapely.geometry.polygon.orient(shapely.Polygon(flatten(outer, chords), [flatten(hole, chords) for hole in holes]))


def eroded(shape: shapely.Polygon, distance: float) -> list[shapely.Polygon]:
    """The parts of a polygon farther than a distance from its boundary."""
    swept: list[shapely.Polygon] = []
    shape = shapely.geometry.polygon.orient(shape)
    for ring in (shape.exterior, *shape.interiors):
        swept += _swept(np.asarray(ring.coords)[:-1], distance)
    left = shape.difference(shapely.union_all(swept))
    least = 1e-6 * distance * distance  # crumbs between polygons that nearly fit
    return [part for part in shapely.get_parts(left) if part.area > least]


def _swept(p: Floats, d: float) -> list[shapely.Polygon]:
    """Bands along the chords of a ring, on its left, and fans at its reflex corners."""
    p = p[np.hypot(*(p - np.roll(p, 1, axis=0)).T) > 0.0]
    chord = np.roll(p, -1, axis=0) - p
    angle = np.arctan2(chord[:, 1], chord[:, 0])
    turn = np.remainder(angle - np.roll(angle, 1) + np.pi, 2.0 * np.pi) - np.pi
    normal = d * np.column_stack((-np.sin(angle), np.cos(angle)))
    q = np.roll(p, -1, axis=0)
    out = []
    begin = 0
    for i in range(1, len(p) + 1):
        own = turn[begin + 1 : i + 1]
        if i == len(p) or abs(own[-1]) > 0.2 or abs(own.sum()) > RUN_TURN or i - begin >= RUN_CHORDS:
            out += _bands(p, q, normal, begin, i)
            begin = i
    for i in np.flatnonzero(turn < 0.0):
        steps = max(int(np.ceil(-turn[i] / FAN_STEP)), 1)
        # a little wide and circumscribed, so that no sliver is left between fan and band
        at = angle[i] - turn[i] * (1.0 - np.arange(steps + 1) / steps)
        at[0] += OVERLAP
        at[-1] -= OVERLAP
        radius = d / np.cos(0.5 * turn[i] / steps)
        fan = p[i] + radius * np.column_stack((-np.sin(at), np.cos(at)))
        out.append(shapely.Polygon(np.vstack((p[i : i + 1], fan))))
    return out


def _bands(p: Floats, q: Floats, normal: Floats, begin: int, end: int) -> list[shapely.Polygon]:
    """What chords begin .. end sweep: one polygon if it is simple, else those of both halves."""
    rows = slice(begin, end)
    offset = np.stack((p[rows] + normal[rows], q[rows] + normal[rows]), axis=1).reshape(-1, 2)
    band = shapely.Polygon(np.vstack((p[rows], q[end - 1 : end], offset[::-1])))
    if band.is_valid or end - begin == 1:
        return [band]
    middle = (begin + end) // 2
    return _bands(p, q, normal, begin, middle) + _bands(p, q, normal, middle, end)
