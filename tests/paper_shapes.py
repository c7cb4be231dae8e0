"""Shapes after the figures of the paper, which tell of their domains in words only; for its report and for tests."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.families import arc, bezier, circle_hole, line, polar, polyline, shape, spiral

Json = dict[str, Any]
Edge = dict[str, Any]
Points = list[tuple[float, float]]


def free_form(points: Points, degree: int = 3) -> Edge:
    """A B-spline with these control points and even, clamped knots."""
    inner = np.arange(1, len(points) - degree) / (len(points) - degree)
    return {
        "degree": degree,
        "control_points": [[float(x), float(y)] for x, y in points],
        "knots": [0.0] * (degree + 1) + inner.tolist() + [1.0] * (degree + 1),
    }


def illustration() -> Json:
    """Fig. 12: A ... G anticlockwise, B a reflex vertex, C a smooth corner, the others convex; straight but for CD."""
    a, b, c, d, e, f, g = (0, 1), (2, 1), (2, 0.2), (1.7, -1.2), (3.4, -1.2), (3.4, 2.2), (0, 2.2)
    edges = [line(a, b), line(b, c), bezier([c, (2, -0.5), d]), line(d, e), line(e, f), line(f, g), line(g, a)]
    return shape("illustration", edges, leaves=5)


def object_1() -> Json:
    """Fig. 14: free-form edges with a complex profile; four corners and a wave along each side."""
    south = [(0, 0), (0.6, 0.5), (1.3, -0.7), (2.1, 0.9), (2.9, -0.6), (3.6, 0.4), (4.2, -0.1)]
    east = [(4.2, -0.1), (3.7, 0.7), (5.0, 1.2), (3.5, 1.9), (4.6, 2.4), (4.0, 3.1)]
    north = [(4.0, 3.1), (3.3, 2.5), (2.7, 3.9), (2.0, 2.2), (1.3, 3.7), (0.6, 2.5), (0.1, 3.0)]
    west = [(0.1, 3.0), (0.6, 2.2), (-0.8, 1.7), (0.7, 1.1), (-0.5, 0.7), (0, 0)]
    return shape("object_1", [free_form(side) for side in (south, east, north, west)])


def object_2() -> Json:
    """Fig. 15: constricted passages and sharp changes of curvature."""
    below = [(0, 0), (0.8, -0.6), (1.5, -0.3), (1.75, 0.85), (1.95, 0.85)]
    below += [(2.2, -0.5), (3.2, -0.7), (3.6, 0.75), (3.8, 0.75), (4.1, -0.2), (5.2, 0.2)]
    above = [(5.2, 0.2), (5.5, 1.1), (4.4, 1.9), (3.8, 1.0), (3.55, 1.0), (3.0, 2.2)]
    above += [(2.2, 1.9), (1.95, 1.1), (1.75, 1.1), (1.4, 2.1), (0.4, 1.8), (0, 0)]
    return shape("object_2", [free_form(below), free_form(above)])


def object_3() -> Json:
    """Fig. 16: concave vertices between free-form edges; five arms."""
    reach = [1.9, 0.75, 1.5, 0.6, 2.1, 0.8, 1.6, 0.7, 1.8, 0.65]
    corners = [polar(radius, 0.3 + math.pi * k / 5) for k, radius in enumerate(reach)]
    sway = [0.06, -0.08, 0.05, 0.08, -0.07, 0.06, -0.05, 0.07, 0.06, -0.06]
    edges = []
    for k, (x0, y0) in enumerate(corners):
        x1, y1 = corners[(k + 1) % len(corners)]
        nx, ny = (y1 - y0) * sway[k], (x0 - x1) * sway[k]
        inner = [(x0 + m * (x1 - x0) / 3 + (3 - 2 * m) * nx, y0 + m * (y1 - y0) / 3 + (3 - 2 * m) * ny) for m in (1, 2)]
        edges.append(bezier([(x0, y0), *inner, (x1, y1)]))
    return shape("object_3", edges)


def rolled() -> Json:
    """Fig. 17: a spiral."""
    return spiral()


def multiply_connected() -> Json:
    """Figs. 13 and 18: four convex corners A ... D, curved sides, two holes."""
    sides = [
        bezier([(0, 0), (1.5, -0.4), (3, 0.4), (4.5, 0)]),
        bezier([(4.5, 0), (4.9, 1.0), (4.1, 2.0), (4.5, 3)]),
        bezier([(4.5, 3), (3, 3.4), (1.5, 2.6), (0, 3)]),
        bezier([(0, 3), (-0.4, 2.0), (0.4, 1.0), (0, 0)]),
    ]
    triangle = polyline([(2.9, 1.1), (3.1, 2.1), (3.7, 1.4)])
    return shape("multiply_connected", sides, [circle_hole((1.4, 1.5), 0.55), triangle], cycles=2)


def tangential() -> Json:
    """Fig. 19: edges that meet smoothly; a bracket of lines and arcs with two sharp corners."""
    half = math.pi / 2
    edges = [
        line((0, 0), (3.0, 0)),
        arc((3.0, 0.8), 0.8, -half, 0.0),
        line((3.8, 0.8), (3.8, 2.4)),
        arc((3.2, 2.4), 0.6, 0.0, half),
        line((3.2, 3.0), (2.6, 3.0)),
        arc((2.6, 2.6), 0.4, half, 2 * half),
        line((2.2, 2.6), (2.2, 1.9)),
        arc((1.9, 1.9), 0.3, 0.0, -half),
        line((1.9, 1.6), (0.0, 1.6)),
        line((0.0, 1.6), (0.0, 0.0)),
    ]
    return shape("tangential", edges)


def small_hole() -> Json:
    """A corridor with a small hole: discs of steps far enough apart stand on both sides of it."""
    return shape("small_hole", polyline([(0, 0), (4, 0), (4, 0.5), (0, 0.5)]), [circle_hole((2.3, 0.25), 0.04)], cycles=1)


def pocket() -> Json:
    """A hole in the pocket of a convex corner, beyond the reach of the branch disc beside it: Proposition 2."""
    return shape("pocket", polyline([(0, 0), (4, 0), (4, 1), (0, 1)]), [circle_hole((3.93, 0.07), 0.04)], cycles=1)


def twice() -> Json:
    """A bay in one edge: the axis of this edge and the one opposite has a branch in between, so the pair has two segments."""
    top = [(4, 1.0), (2.6, 1.0), (2.5, 1.0), (2.0, 2.6), (1.5, 1.0), (1.4, 1.0), (0, 1.0)]
    return shape("twice", [line((0, 0), (4, 0)), line((4, 0), (4, 1)), free_form(top), line((0, 1), (0, 0))])


PAPER_SHAPES = {
    "12": illustration,
    "14": object_1,
    "15": object_2,
    "16": object_3,
    "17": rolled,
    "18": multiply_connected,
    "19": tangential,
}
