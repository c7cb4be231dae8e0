"""Loops as one writes them by hand: polygons, with corners rounded if wanted, and circles.

Arcs are true arcs: rational quadratics of less than half a turn.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from mat_core.errors import UnsupportedOption
from mat_core.outlines.pen import QUARTER, Edge, bezier

Point = Sequence[float]

STRAIGHT = 1e-9  # radians: a corner that turns by less has nothing to round


def polygon(points: Sequence[Point], rounding: float = 0.0) -> list[Edge]:
    """A closed loop of straight edges, its corners rounded by arcs that meet the edges with their tangents.

    Parameters
    ----------
    points : sequence of (x, y)
        At least three corners, either way round; the first one is not repeated.
    rounding : float
        Radius of the arcs, inwards at convex and outwards at reflex corners; 0 leaves the corners sharp.

    Returns
    -------
    list of dict
        Edges head to tail: a loop for `Domain.from_dict`.

    Raises
    ------
    UnsupportedOption
        There are fewer than three points, or the rounding is negative or does not fit an edge.
    """
    corners = [(float(x), float(y)) for x, y in points]
    if len(corners) < 3:
        raise UnsupportedOption("points", f"{len(corners)} are no polygon; give at least 3")
    if not 0.0 <= rounding < math.inf:
        raise UnsupportedOption("rounding", f"{rounding} is not a radius of at least 0")
    following = [*corners[1:], corners[0]]
    rounded = [_rounded(*three, rounding) for three in zip([corners[-1], *corners], corners, following, strict=False)]
    loop: list[Edge] = []
    for i, (corner, after) in enumerate(zip(rounded, [*rounded[1:], rounded[0]], strict=True)):
        side = math.dist(corners[i], following[i])
        taken = math.dist(corners[i], corner.end) + math.dist(after.start, following[i])
        if taken > side * (1.0 + STRAIGHT):
            raise UnsupportedOption("rounding", f"{rounding} takes {taken:.6g} of edge {i}, which is {side:.6g} long")
        if corner.end != corner.start:
            loop.append(_arc(corner.start, corners[i], corner.end, corner.turn))
        if taken < side * (1.0 - STRAIGHT):
            loop.append(bezier([corner.end, after.start]))
    return loop


def circle(center: Point, radius: float) -> list[Edge]:
    """A circle as four arcs.

    Parameters
    ----------
    center : (x, y)
    radius : float
        Positive.

    Returns
    -------
    list of dict
        Edges head to tail, counter-clockwise: a loop for `Domain.from_dict`.

    Raises
    ------
    UnsupportedOption
        The radius is not a positive number.
    """
    if not 0.0 < radius < math.inf:
        raise UnsupportedOption("radius", f"{radius} is not a positive number")
    x, y = float(center[0]), float(center[1])
    ends = [(x + radius, y), (x, y + radius), (x - radius, y), (x, y - radius)]
    poles = [(x + radius, y + radius), (x - radius, y + radius), (x - radius, y - radius), (x + radius, y - radius)]
    return [_arc(ends[i], poles[i], ends[(i + 1) % 4], QUARTER) for i in range(4)]


def _arc(start: Point, pole: Point, end: Point, turn: float) -> Edge:
    """An arc that turns by less than half a turn; its tangents at both ends meet in the pole."""
    return bezier([start, pole, end], [1.0, math.cos(0.5 * turn), 1.0])


class _Corner(NamedTuple):
    """Where the rounding of a corner begins and ends (the corner itself if it stays sharp), and by how much it turns."""

    start: Point
    end: Point
    turn: float


def _rounded(before: Point, at: Point, after: Point, radius: float) -> _Corner:
    """The arc of a radius in the corner `at`: it takes radius tan(turn / 2) of both sides."""
    arriving, leaving = (at[0] - before[0], at[1] - before[1]), (after[0] - at[0], after[1] - at[1])
    cross = arriving[0] * leaving[1] - arriving[1] * leaving[0]
    turn = abs(math.atan2(cross, arriving[0] * leaving[0] + arriving[1] * leaving[1]))
    if radius == 0.0 or turn <= STRAIGHT:
        return _Corner(at, at, turn)
    reach = radius * math.tan(0.5 * turn)
    back, on = reach / math.hypot(*arriving), reach / math.hypot(*leaving)
    start = (at[0] - back * arriving[0], at[1] - back * arriving[1])
    return _Corner(start, (at[0] + on * leaving[0], at[1] + on * leaving[1]), turn)
