"""Parts of a rebuilt loop joined head to tail."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.fitting import join
from mat_core.analysis.rebuilding.folds import split
from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]

LONGEST_LEAD = 0.5  # of a Bezier's parameter: how far its end may be drawn out along itself
ILL_POSED = 1e-3  # directions told apart less than this, relative, do not move a vertex
GAUSS_STEPS = 3
NEWTON_STEPS = 4  # to the point of a Bezier nearest to a place, which is hardly farther from it than from its end


class Vertex(NamedTuple):
    """A point of the boundary, and discs (n, 3) that pass through it."""

    place: Floats
    discs: Floats


class Part(NamedTuple):
    """A part of a loop: Beziers in a row, or an arc, or nothing but a vertex that its neighbours meet in."""

    pieces: list[Floats]
    arc: RationalBSpline | None
    vertex: Vertex | None


def common_point(start: Floats, discs: Floats) -> Floats:
    """The point that discs (n, 3) pass through, |c - V| = r, by least squares from a point near it."""
    vertex = start
    for _ in range(GAUSS_STEPS):
        away = vertex - discs[:, :2]
        distance = np.maximum(np.hypot(away[:, 0], away[:, 1]), np.finfo(float).tiny)
        vertex = vertex - np.linalg.lstsq(away / distance[:, None], distance - discs[:, 2], rcond=ILL_POSED)[0]
    return vertex


def closed(edges: list[Part]) -> list[RationalBSpline]:
    """Splines of the edges; each ends where the next begins, at the vertex between them or halfway."""
    drawn = [edge for edge in edges if edge.vertex is None]
    vertices = _vertices_after(edges)
    curves = [edge.arc for edge in drawn]
    ends = [(c.control_points[0], c.control_points[-1]) if c else (e.pieces[0][0], e.pieces[-1][-1])
            for c, e in zip(curves, drawn, strict=True)]
    places = [vertex if vertex is not None else 0.5 * (ends[n][1] + ends[(n + 1) % len(ends)][0])
              for n, vertex in enumerate(vertices)]
    out = []
    for n, (edge, curve) in enumerate(zip(drawn, curves, strict=True)):
        start, end = places[n - 1], places[n]
        if curve is None:
            backwards = _led_end([piece[::-1] for piece in reversed(edge.pieces)], start)
            pieces = _led_end([piece[::-1] for piece in reversed(backwards)], end)
            for a, b in pairwise(pieces):
                a[-1] = b[0] = 0.5 * (a[-1] + b[0])
            knots, control, _ = join(pieces)
            curve = RationalBSpline(len(pieces[0]) - 1, knots, control, np.ones(len(control)))
        curve.control_points[0], curve.control_points[-1] = start, end
        out.append(curve)
    return out


def _vertices_after(edges: list[Part]) -> list[Floats | None]:
    """For each edge that is drawn the vertex that follows it, if one does."""
    first = next(i for i, edge in enumerate(edges) if edge.vertex is None)
    found: list[list[Vertex]] = []
    for edge in edges[first:] + edges[:first]:
        if edge.vertex is None:
            found.append([])
        else:
            found[-1].append(edge.vertex)
    return [_one_of(vertices) if vertices else None for vertices in found]


def _one_of(vertices: list[Vertex]) -> Floats:
    """Where vertices in a row are: at one point, with nothing between them.

    One that its discs hardly turn about is poorly placed, more so than the axis's errors; the discs of all place it well.
    """
    start: Floats = np.mean([vertex.place for vertex in vertices], axis=0)
    discs = np.concatenate([vertex.discs for vertex in vertices])
    return common_point(start, discs) if len(discs) else start


def _led_end(pieces: list[Floats], place: Floats) -> list[Floats]:
    """Beziers in a row, the last one of which ends at a place; those that lie beyond it are left out.

    So far may sides overlap: the axis beside the centre of an arc moves by little more than its errors, and tells no direction.
    """
    kept = len(pieces)
    while kept > 1 and _lies_beyond(pieces[kept - 1], place):
        kept -= 1
    return [*pieces[: kept - 1], _led_to(pieces[kept - 1], place).copy()]


def _lies_beyond(control: Floats, place: Floats) -> bool:
    """Whether a Bezier starts ahead of a place, and goes on from there."""
    back = place - control[0]
    ahead = place - control[-1]
    return float(back @ (control[1] - control[0])) < 0.0 and float(back @ back) < float(ahead @ ahead)


def _led_to(control: Floats, place: Floats) -> Floats:
    """A Bezier cut off or drawn out along itself to where it is nearest to a place: both sides of a disc's joint meet so.

    A slow end drawn out could turn round beyond where it ends; then, as where the place is far, the Bezier stays as it is.
    """
    leave = control[-1] - control[-2]
    led, at = control, 1.0
    for _ in range(NEWTON_STEPS):
        rate = (len(led) - 1) * (led[-1] - led[-2])  # by the led one's own parameter, of which 1 is `at`
        speed_sq = float(rate @ rate)
        more = float((place - led[-1]) @ rate) / speed_sq if speed_sq > 0.0 else 0.0
        if more == 0.0:
            break
        at *= 1.0 + more
        if not 0.0 < at < 1.0 + LONGEST_LEAD:
            return control
        led = split(control, at)[0]
    return led if float((led[-1] - led[-2]) @ leave) > 0.0 else control
