"""Domains from loops: which loop fills, which one is a hole, and of what.

Decided on polygons through points of the loops, by areas: where loops nearly touch, polygons may overlap that the loops do not,
but by no more than the polygons are off, and most of a loop still lies on its own side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core.outlines.pen import Edge, Loop

Json = dict[str, Any]
Floats = NDArray[np.float64]
Rule = Literal["nonzero", "evenodd"]

PER_SPAN = 12
"""Chords of a polygon on each span of a curve, where its polynomial does not change; an even number."""

ROUNDING = 1e-12
"""Of the smaller area: what areas of polygons are off."""


@dataclass(frozen=True, slots=True)
class Outlines:
    """What was read.

    Attributes
    ----------
    domains : list of dict
        JSON domains, in the order of their outer loops; ``name`` tells where each came from, where that has a name.
    left_out : list of str
        What was there but is no outline, and why, a sentence each.
    """

    domains: list[Json] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)

    def add(self, name: str, outlines: Outlines) -> None:
        """Take in what something of this name gave: its domains as `name`, or `name#i` where they are several."""
        several = len(outlines.domains) > 1
        self.domains.extend({"name": f"{name}#{i}" if several else name, **d} for i, d in enumerate(outlines.domains))
        self.left_out.extend(f"{name}: {text}" for text in outlines.left_out)


def nested(loops: Sequence[Loop], rule: Rule = "evenodd") -> Outlines:
    """Every outer loop with its holes.

    Parameters
    ----------
    loops : sequence of list of dict
        Closed loops of edges, in any order.
    rule : "evenodd" or "nonzero"
        What is inside, as in SVG: by the number of loops around, or by how often they turn around it, counter-clockwise ones
        less clockwise ones.

    Returns
    -------
    Outlines
        Loops that cross others are left out, and so is what they touch: which side is inside is not theirs alone to say. A loop
        that crosses itself stays; to refuse it is for `mat_core.Domain`.
    """
    flat = [flattened(loop) for loop in loops]
    polygons = [shapely.Polygon(points) for points, _ in flat]
    signs = np.array([1 if shapely.is_ccw(p.exterior) else -1 for p in polygons], dtype=np.int64)
    around, crossing = _relations(polygons, np.array([error for _, error in flat]))
    left_out = [f"loops {i} and {j} cross, so that neither bounds a domain; unite or part them first" for i, j in crossing]
    lost = {i for pair in crossing for i in pair}
    windings = np.array([signs[a].sum() if rule == "nonzero" else len(a) for a in around], dtype=np.int64)
    within = windings + (signs if rule == "nonzero" else 1)
    filled, around_filled = (n != 0 if rule == "nonzero" else n % 2 == 1 for n in (within, windings))
    outer = filled & ~around_filled
    domains: dict[int, Json] = {i: {"outer": loops[i], "holes": []} for i in np.flatnonzero(outer).tolist() if i not in lost}
    for hole in np.flatnonzero(around_filled & ~filled).tolist():
        parents = [i for i in around[hole] if outer[i]]
        parent = max(parents, key=lambda i: len(around[i]), default=-1)
        if hole not in lost and parent in domains:
            domains[parent]["holes"].append(loops[hole])
    return Outlines(list(domains.values()), left_out)


def _relations(polygons: list[Any], errors: Floats) -> tuple[list[list[int]], list[tuple[int, int]]]:
    """The loops around each loop, and the pairs that cross: that share some of the smaller one, but not all of it."""
    sound = np.array([p if p.is_valid else shapely.make_valid(p, method="structure") for p in polygons], dtype=object)
    areas = shapely.area(sound)
    shapely.prepare(sound)
    inner, outer = shapely.STRtree(sound).query(sound, predicate="intersects")
    ordered = (areas[inner] < areas[outer]) | ((areas[inner] == areas[outer]) & (inner > outer))
    inner, outer = inner[ordered], outer[ordered]
    outside = np.zeros(len(inner))
    unclear = ~shapely.contains_properly(sound[outer], sound[inner])
    outside[unclear] = shapely.area(shapely.difference(sound[inner[unclear]], sound[outer[unclear]]))
    around: list[list[int]] = [[] for _ in polygons]
    within = outside < 0.5 * areas[inner]
    for i, j in zip(inner[within].tolist(), outer[within].tolist(), strict=True):
        around[i].append(j)
    doubt = errors[inner] + errors[outer] + ROUNDING * areas[inner]
    across = (outside > doubt) & (areas[inner] - outside > doubt)
    return around, sorted(zip(outer[across].tolist(), inner[across].tolist(), strict=True))


def flattened(loop: Loop) -> tuple[Floats, float]:
    """Points along a loop, (n, 2), and by how much area the polygon through them may be off."""
    pieces = [_points(edge) for edge in loop]
    error = sum(_error(piece) for piece, edge in zip(pieces, loop, strict=True) if edge["degree"] > 1)
    points = np.concatenate([piece[:-1] for piece in pieces])
    if len(points) < 3:
        points = np.concatenate([points, np.repeat(points[-1:], 3 - len(points), axis=0)])
    return points, error


def _error(points: Floats) -> float:
    """Area between the polyline through every second point and the one through all: four times what the latter still misses."""
    first, middle, last = points[:-2:2], points[1:-1:2], points[2::2]
    a, b = middle - first, last - first
    return 0.5 * float(np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())


def _points(edge: Edge) -> Floats:
    """Points on an edge from its start to its end, (n, 2)."""
    p, control_points = edge["degree"], np.asarray(edge["control_points"], dtype=float)
    if p == 1:
        return control_points
    weights = np.asarray(edge.get("weights", np.ones(len(control_points))), dtype=float)
    knots = np.asarray(edge.get("knots", [0.0] * (p + 1) + [1.0] * (p + 1)), dtype=float)
    spans = np.unique(knots[p : len(control_points) + 1])
    share = np.arange(PER_SPAN) / PER_SPAN
    u = (spans[:-1, None] + share * np.diff(spans)[:, None]).ravel()
    first = np.searchsorted(knots, u, side="right") - 1
    h = np.column_stack([control_points * weights[:, None], weights])
    return np.concatenate([_de_boor(p, knots, h, u, first), control_points[-1:]])


def _de_boor(
    p: int, knots: Floats, h: Floats, u: Floats, first: NDArray[np.int64]
) -> Floats:
    """Points of homogeneous control points h (n, 3) at u (m,), each in the span that begins with knot `first`."""
    rows = h[first[:, None] - p + np.arange(p + 1)]
    for r in range(1, p + 1):
        i = first[:, None] - p + np.arange(r, p + 1)
        low, high = knots[i], knots[i + p - r + 1]
        share = ((u[:, None] - low) / (high - low))[:, :, None]
        rows = (1.0 - share) * rows[:, :-1] + share * rows[:, 1:]
    points: Floats = rows[:, 0, :2] / rows[:, 0, 2:]
    return points
