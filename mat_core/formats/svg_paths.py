"""Curves as the path commands of SVG: lines, circular arcs, quadratics and cubics are themselves.

Rational and higher curves, which SVG has not, become cubics that meet them with their tangents at both ends, cut until they
are within a fiftieth of a pixel: coordinates are written to a hundredth.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from mat_core.formats.beziers import halves, pieces_of, points_at, slopes_at_ends
from mat_core.formats.primitives import Arc, Line, Primitive
from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]

MARGIN = 16.0  # pixels around the domain
NEAR = 0.02  # pixels: largest distance between a curve and the cubic in its place
MOST_CUTS = 10  # of one piece
QUARTER = 0.5 * math.pi  # longest arc of one command: the centre of a longer one would feel its rounded ends
SIXTHS = np.array([1.0, 2.0, 3.0, 4.0, 5.0]) / 6.0  # where a cubic is compared with the curve


class Frame:
    """The map from the caller's coordinates to pixels, y upwards."""

    def __init__(self, bbox: tuple[float, float, float, float], width: int) -> None:
        xmin, ymin, xmax, ymax = bbox
        inner = max(width - 2 * MARGIN, 1.0)
        self.scale = inner / max(xmax - xmin, ymax - ymin)
        self.left, self.top = xmin, ymax
        self.width = (xmax - xmin) * self.scale + 2 * MARGIN
        self.height = (ymax - ymin) * self.scale + 2 * MARGIN

    def points(self, points: Floats) -> Floats:
        """Pixels of points (..., 2)."""
        pixels: Floats = self.vectors(points - np.array([self.left, self.top])) + MARGIN
        return pixels

    def vectors(self, vectors: Floats) -> Floats:
        """Pixels of differences (..., 2)."""
        pixels: Floats = vectors * np.array([self.scale, -self.scale])
        return pixels


def numbers(points: Floats) -> str:
    """Pixels to a hundredth, separated by blanks."""
    return " ".join(f"{v:.2f}".rstrip("0").rstrip(".") for v in points.reshape(-1).tolist())


def path_of(shapes: Iterable[Primitive], frame: Frame, closed: bool = True) -> str:
    """One sub-path of shapes that run head to tail."""
    listed = list(shapes)
    start = frame.points(np.array([_start(listed[0])]))
    return f"M{numbers(start)}{''.join(_commands(shape, frame) for shape in listed)}{'Z' if closed else ''}"


def _start(shape: Primitive) -> tuple[float, float]:
    if isinstance(shape, Line):
        return shape.start
    if isinstance(shape, Arc):
        return shape.ends[0]
    x, y = shape.control_points[0].tolist()
    return x, y


def _commands(shape: Primitive, frame: Frame) -> str:
    """The commands of one shape, from its start."""
    if isinstance(shape, Line):
        return "L" + numbers(frame.points(np.array([shape.end])))
    if isinstance(shape, Arc):
        return "".join(_arc(shape, frame))
    pieces = pieces_of(shape)
    letter = {2: "Q", 3: "C"}.get(shape.degree)
    if letter and not shape.is_rational:
        return "".join(letter + numbers(frame.points(piece[1:, :2])) for piece in pieces)
    return "".join("C" + numbers(cubic[1:]) for piece in pieces for cubic in _cubics(piece[None], frame, MOST_CUTS))


def _arc(arc: Arc, frame: Frame) -> Iterator[str]:
    """A command for each quarter turn at most."""
    count = max(1, math.ceil(abs(arc.sweep) / QUARTER - 1e-9))
    angles = arc.start + arc.sweep * np.arange(1, count + 1) / count
    points = np.array(arc.center) + arc.radius * np.column_stack((np.cos(angles), np.sin(angles)))
    points[-1] = arc.ends[1]
    radius = f"{arc.radius * frame.scale:.4f}".rstrip("0").rstrip(".")
    clockwise = int(arc.sweep < 0.0)  # y points down on the screen, so a turn to the left is SVG's sweep 0
    for point in frame.points(points):
        yield f"A{radius} {radius} 0 0 {clockwise} {numbers(point)}"


def hermite(start: Floats, end: Floats, slope_start: Floats, slope_end: Floats) -> Floats:
    """Control points (n, 4, 2) of the cubics with given ends and derivatives (n, 2)."""
    return np.stack((start, start + slope_start / 3.0, end - slope_end / 3.0, end), axis=1)


def _cubics(piece: Floats, frame: Frame, cuts: int) -> list[Floats]:
    """Cubics in pixels for a stack of one piece."""
    slope_start, slope_end = slopes_at_ends(piece)
    ends = frame.points(piece[:, [0, -1], :2])
    cubic = hermite(ends[:, 0], ends[:, 1], frame.vectors(slope_start), frame.vectors(slope_end))
    weights = np.ones((1, 4, 1))
    off = points_at(np.concatenate((cubic, weights), axis=2), SIXTHS) - frame.points(points_at(piece, SIXTHS))
    if cuts == 0 or float(np.abs(off).max()) <= NEAR:
        return [cubic[0]]
    left, right = halves(piece)
    return [*_cubics(left, frame, cuts - 1), *_cubics(right, frame, cuts - 1)]


def hull_box(curves: Iterable[RationalBSpline], bbox: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """`bbox`, widened so that it holds the control points of curves."""
    points = [curve.control_points for curve in curves]
    corners = np.vstack((np.array(bbox).reshape(2, 2), *points))
    xmin, ymin = corners.min(axis=0).tolist()
    xmax, ymax = corners.max(axis=0).tolist()
    return xmin, ymin, xmax, ymax
