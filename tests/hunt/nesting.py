"""Domains from loops: which loop fills, which one is a hole, and of what."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

Edge = dict[str, Any]
Loop = list[Edge]
Json = dict[str, Any]
PER_EDGE = 12  # points of the polygons that nesting is decided on


def domains(loops: list[Loop], rule: str = "nonzero") -> list[Json]:
    """Every outer loop with its holes, by the rule "nonzero" or "evenodd"; none where loops cross each other.

    A loop that crosses itself stays: to refuse it is for the domain to do.
    """
    rings = [polygon(loop) for loop in loops]
    lines = [shapely.LinearRing(r) for r in rings]
    if any(shapely.intersects(a, b) for i, a in enumerate(lines) for b in lines[:i]):
        return []
    inside = np.array([[i != j and _contains(outer, inner[0]) for j, outer in enumerate(rings)] for i, inner in enumerate(rings)])
    inside = inside.reshape(len(loops), len(loops))
    signs = np.array([1 if _area(r) > 0 else -1 for r in rings], dtype=int)
    around = inside.sum(axis=1) if rule == "evenodd" else inside.astype(int) @ signs
    within = around + (1 if rule == "evenodd" else signs)
    filled = (lambda n: n % 2 == 1) if rule == "evenodd" else (lambda n: n != 0)
    outers = [i for i in range(len(loops)) if filled(within[i]) and not filled(around[i])]
    holes = [i for i in range(len(loops)) if filled(around[i]) and not filled(within[i])]
    depth = inside.sum(axis=1)
    result = {i: {"outer": loops[i], "holes": []} for i in outers}
    for hole in holes:
        parents = [i for i in outers if inside[hole, i]]
        if parents:
            result[max(parents, key=lambda i: depth[i])]["holes"].append(loops[hole])
    return list(result.values())


def polygon(loop: Loop) -> np.ndarray[Any, Any]:
    """Points along a loop of Bezier edges, (n, 2)."""
    points = []
    for edge in loop:
        weights = np.array(edge.get("weights") or np.ones(len(edge["control_points"])))
        h = np.column_stack([np.array(edge["control_points"], dtype=float) * weights[:, None], weights])
        for t in np.arange(PER_EDGE if len(h) > 2 else 1) / PER_EDGE:
            row = h
            while len(row) > 1:
                row = (1 - t) * row[:-1] + t * row[1:]
            points.append(row[0, :2] / row[0, 2])
    if len(points) < 3:
        points += [points[-1]] * (3 - len(points))
    return np.array(points)


def _area(p: np.ndarray[Any, Any]) -> float:
    q = np.roll(p, -1, axis=0)
    return float(np.sum(p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]) / 2)


def _contains(ring: np.ndarray[Any, Any], point: np.ndarray[Any, Any]) -> bool:
    """True when a ray from the point crosses the ring an odd number of times."""
    a, b = ring, np.roll(ring, -1, axis=0)
    spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a, b = a[spans], b[spans]
    crossing = a[:, 0] + (point[1] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return bool(np.count_nonzero(crossing > point[0]) % 2)
