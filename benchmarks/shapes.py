"""Large domains for timing, each from a fixed seed; those that tests know already come from `tests.families`.

Sizes are numbers of edges, met exactly or nearly.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from tests.families import arc, bezier, comb, gear, hole_grid, line, polyline, shape

Json = dict[str, Any]
Floats = NDArray[np.float64]

ROUGHNESS = 0.28  # of a side: how far its middle is moved at most
CORNERS = 12  # of the polygon that a coastline begins as; at most twice as many
RETREAT = 0.5  # of a displacement whose sides cross others, until they do not
RETREATS = 7  # then the middle stays on its side


def coastline(edges: int, seed: int = 1) -> Json:
    """A polygon by midpoint displacement: every side's middle is moved across it at random, again and again.

    Middles whose new sides would cross others are moved half as far, in the end not at all: the polygon stays simple.
    """
    rng = np.random.default_rng(seed)
    levels = max(0, int(math.log2(edges / CORNERS)))
    count = round(edges / 2**levels)
    angles = 2 * math.pi * np.arange(count) / count
    radii = rng.uniform(0.7, 1.3, count)
    points = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    for _ in range(levels):
        points = _displaced(points, rng)
    return shape(f"coastline_{len(points)}", polyline(points.tolist()))


def _displaced(points: Floats, rng: np.random.Generator) -> Floats:
    """Twice as many points, the sides still apart.

    A side that stays may be crossed by one that is still moved, which then stays, too: in the end no two cross, as before.
    """
    side = np.roll(points, -1, axis=0) - points
    across = np.column_stack([-side[:, 1], side[:, 0]]) * rng.uniform(-ROUGHNESS, ROUGHNESS, len(side))[:, None]
    share = np.ones(len(points))
    ring = np.empty((2 * len(points), 2))
    ring[::2] = points
    for attempt in itertools.count():
        ring[1::2] = points + 0.5 * side + share[:, None] * across
        crossing = _crossing(ring) // 2
        if not np.any(share[crossing]):
            break
        share[crossing] *= RETREAT if attempt < RETREATS else 0.0
    return ring


def _crossing(ring: Floats) -> NDArray[np.int64]:
    """The sides that meet another one, apart from the ends that neighbours share."""
    sides = shapely.linestrings(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1))
    one, other = shapely.STRtree(sides).query(sides, predicate="intersects")
    apart = np.abs(one - other)
    return np.unique(one[(apart > 1) & (apart < len(ring) - 1)])


def wave(edges: int) -> Json:
    """A long band between two wavy walls of smooth cubic arcs (smooth from one to the next), and two ends."""
    count = max(1, (edges - 2) // 2)
    x = np.arange(count + 1, dtype=float)

    def wall(height: float, amplitude: float, phase: float) -> Any:
        y = height + amplitude * np.sin(1.1 * x + phase)
        slope = 1.1 * amplitude * np.cos(1.1 * x + phase)
        knots = np.column_stack([x, y])
        handles = np.column_stack([np.full(count + 1, 1 / 3), slope / 3])
        return np.stack([knots[:-1], knots[:-1] + handles[:-1], knots[1:] - handles[1:], knots[1:]], axis=1).tolist()

    floor, roof = wall(-1.0, 0.4, 0.3), wall(1.0, 0.3, 2.0)
    outer = [bezier(p) for p in floor]
    outer.append(line(floor[-1][3], roof[-1][3]))
    outer += [bezier(p[::-1]) for p in roof[::-1]]
    outer.append(line(roof[0][0], floor[0][0]))
    return shape(f"wave_{len(outer)}", outer)


def round_plate(edges: int, seed: int = 1) -> Json:
    """A square plate with round holes of four arcs, each of its own radius and off its place on the grid."""
    rng = np.random.default_rng(seed)
    columns = max(1, round(math.sqrt((edges - 4) / 4)))
    holes = []
    for k in range(columns * columns):
        i, j = divmod(k, columns)
        center = (i + float(rng.uniform(-0.1, 0.1)), j + float(rng.uniform(-0.1, 0.1)))
        radius = float(rng.uniform(0.2, 0.35))
        turns = np.linspace(2 * math.pi, 0.0, 5).tolist()
        holes.append([arc(center, radius, turns[q], turns[q + 1]) for q in range(4)])
    far = columns - 0.5
    outer = polyline([(-0.5, -0.5), (far, -0.5), (far, far), (-0.5, far)])
    return shape(f"round_plate_{4 * len(holes) + 4}", outer, holes)


def square_grid_of_holes(edges: int) -> Json:
    """Equal round holes on a square grid, one edge each: every node between them touches four."""
    columns = max(1, round(math.sqrt(edges - 4)))
    return hole_grid(columns, columns)


LARGE: dict[str, Callable[[int], Json]] = {
    "comb": lambda n: comb(n // 4),
    "gear": lambda n: gear(n // 4),
    "plate with round holes": round_plate,
    "grid of holes": square_grid_of_holes,
    "wave of smooth curves": wave,
    "coastline": coastline,
}
