"""Parts of a rebuilt loop joined head to tail."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.fitting import join
from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]

LONGEST_LEAD = 0.5  # of a Bezier's parameter: how far its end may be led along itself


class Part(NamedTuple):
    """A part of a loop: Beziers in a row, or an arc, or nothing but a vertex that its neighbours meet in."""

    pieces: list[Floats]
    arc: RationalBSpline | None
    vertex: Floats | None


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
            pieces = edge.pieces
            pieces[0] = _led_to(pieces[0][::-1], start)[::-1]
            pieces[-1] = _led_to(pieces[-1], end)
            for a, b in pairwise(pieces):
                a[-1] = b[0] = 0.5 * (a[-1] + b[0])
            knots, control, _ = join(pieces)
            curve = RationalBSpline(len(pieces[0]) - 1, knots, control, np.ones(len(control)))
        curve.control_points[0], curve.control_points[-1] = start, end
        out.append(curve)
    return out


def _vertices_after(edges: list[Part]) -> list[Floats | None]:
    """For each edge that is drawn the vertex that follows it, if one does."""
    found: list[Floats | None] = []
    leading: Floats | None = None
    for edge in edges:
        if edge.vertex is None:
            found.append(None)
        elif found:
            found[-1] = edge.vertex
        else:
            leading = edge.vertex
    if leading is not None and found[-1] is None:
        found[-1] = leading
    return found


def _led_to(control: Floats, place: Floats) -> Floats:
    """A Bezier cut off or drawn out along itself to where it is nearest to a place: both sides of a disc's joint meet so.

    A slow end drawn out could turn round beyond where it ends; then, as where the place is far, the Bezier stays as it is.
    """
    leave = (len(control) - 1) * (control[-1] - control[-2])
    speed_sq = float(leave @ leave)
    more = float((place - control[-1]) @ leave) / speed_sq if speed_sq > 0.0 else 0.0
    if not 0.0 < abs(more) < LONGEST_LEAD:
        return control
    out = control.copy()
    row = control
    for i in range(1, len(control)):
        row = row[:-1] + (1.0 + more) * (row[1:] - row[:-1])
        out[i] = row[0]
    return out if float((out[-1] - out[-2]) @ leave) > 0.0 else control
