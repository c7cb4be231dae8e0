"""A pen that draws loops of edges, moved, turned and stretched as wanted.

An affine map takes the control points of a rational B-spline to those of its image, so that nothing is lost by it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

Edge = dict[str, Any]
Loop = list[Edge]
Point = tuple[float, float]

QUARTER = 0.5 * math.pi
ZERO = 1e-15  # a sine or cosine below is that of a whole number of quarter turns, a rounding of the angle off
WHOLE = 1e-9  # radians: a quarter turn and so much more is still one arc
CLOSED = 1e-9  # of the largest coordinate: sums of relative coordinates miss the start of a loop by less


class Affine(NamedTuple):
    """x' = a x + c y + e, y' = b x + d y + f, the letters of SVG."""

    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = 1.0
    e: float = 0.0
    f: float = 0.0

    def __call__(self, point: Sequence[float]) -> Point:
        """The image of a point."""
        x, y = point
        return self.a * x + self.c * y + self.e, self.b * x + self.d * y + self.f

    def after(self, first: Affine) -> Affine:
        """The map that does `first`, then this one."""
        x, y = self(first[4:])
        a, b, c, d = first[:4]
        return Affine(
            self.a * a + self.c * b, self.b * a + self.d * b, self.a * c + self.c * d, self.b * c + self.d * d, x, y
        )


def bezier(points: Iterable[Sequence[float]], weights: Sequence[float] | None = None) -> Edge:
    """A Bezier edge."""
    control_points = [[float(x), float(y)] for x, y in points]
    edge: Edge = {"degree": len(control_points) - 1, "control_points": control_points}
    if weights is not None:
        edge["weights"] = list(weights)
    return edge


def quarters(ellipse: Affine, start: float, turn: float) -> Iterator[tuple[list[Point], list[float]]]:
    """An arc of the image of the unit circle, as rational quadratics of a quarter turn at most.

    Parameters
    ----------
    ellipse : Affine
        Takes the unit circle to the ellipse.
    start, turn : float
        Angles on the unit circle, radians; a negative turn goes clockwise there.

    Yields
    ------
    (points, weights)
        Pole and end of each arc, and its three weights.
    """
    count = max(1, math.ceil(abs(turn) / QUARTER - WHOLE))
    half = 0.5 * turn / count
    for i in range(count):
        at = start + (2 * i + 1) * half
        pole, end = _polar(at, 1.0 / math.cos(half)), _polar(at + half, 1.0)
        yield [ellipse(pole), ellipse(end)], [1.0, math.cos(half), 1.0]


def _polar(angle: float, radius: float) -> Point:
    c, s = math.cos(angle), math.sin(angle)
    return 0.0 if abs(c) < ZERO else radius * c, 0.0 if abs(s) < ZERO else radius * s


class Pen:
    """Collects edges into loops; a loop is closed by a line when the next one begins, as filling does.

    Parameters
    ----------
    affine : Affine
        Where all that is drawn goes.

    Attributes
    ----------
    loops : list of list of dict
        What was drawn and closed.
    start, here : (x, y)
        Where the loop began, and where the pen is; before the map.
    """

    def __init__(self, affine: Affine = Affine()) -> None:  # noqa: B008 - it is a tuple
        self.loops: list[Loop] = []
        self.start: Point = (0.0, 0.0)
        self.here: Point = (0.0, 0.0)
        self._affine = affine
        self._loop: list[tuple[list[Point], list[float] | None]] = []

    def move(self, to: Point) -> None:
        """Begin a loop."""
        self.close()
        self.start = self.here = to

    def draw(self, points: Sequence[Point], weights: list[float] | None = None) -> None:
        """An edge from here through the other control points; one of no length is left out."""
        if any(p != self.here for p in points):
            self._loop.append(([self.here, *points], weights))
        self.here = points[-1]

    def close(self, gap: float = CLOSED) -> None:
        """End the loop where it began: an end within `gap` of it, as a fraction of the coordinates, is moved there.

        A loop that encloses nothing, a line there and back at the most, is left out.
        """
        if self._loop and self.here != self.start:
            reach = gap * max(abs(c) for points, _ in self._loop for p in points for c in p)
            if math.dist(self.here, self.start) < reach:
                points = self._loop[-1][0]  # a handle of no length stays one
                points[1:] = [self.start if p == self.here else p for p in points[1:]]
            else:
                self.draw([self.start])
        if len(self._loop) > 1 or (self._loop and len(self._loop[0][0]) > 3):
            self.loops.append([bezier([self._affine(p) for p in points], weights) for points, weights in self._loop])
        self._loop, self.here = [], self.start
