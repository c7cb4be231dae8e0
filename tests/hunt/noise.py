"""Degenerate shapes, moved a little: ties, tangencies and concentric arcs that hold only nearly.

Shapes have size about one, so the noise levels (the largest move of a coordinate) are relative to it. The level is told by
the seed: eleven seeds in a row see each level once, the next eleven see them with the shape turned.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from tests import families as F
from tests.families import Edge, Json, Point
from tests.transforms import each_loop, rotated

LEVELS = (0.0, *(10.0**-k for k in range(12, 2, -1)))  # largest move of a coordinate
KAPPA = 0.5522847498307936  # handle of a cubic that looks like a quarter of a circle
FRAGILE = {"thorn", "heart", "sliver", "annulus_thin"}  # noise may make these cross themselves


def moved(domain: Json, noise: float, rng: np.random.Generator) -> Json:
    """Every control point moved by up to `noise` in x and y; points that were one point before stay one."""

    def loop(edges: list[Edge]) -> list[Edge]:
        starts = [_near(e["control_points"][0], noise, rng) for e in edges]
        ends = [*starts[1:], starts[0]]
        return [
            {**e, "control_points": [a, *(_near(p, noise, rng) for p in e["control_points"][1:-1]), b]}
            for e, a, b in zip(edges, starts, ends, strict=True)
        ]

    return each_loop(domain, loop)


def _near(p: Point, noise: float, rng: np.random.Generator) -> list[float]:
    dx, dy = rng.uniform(-1.0, 1.0, 2)
    return [float(p[0] + noise * dx), float(p[1] + noise * dy)]


# Circles of polynomials ----------------------------------------------------------------------------------------------
def quadratics(n: int, radius: float = 1.0, center: Point = (0.0, 0.0), clockwise: bool = False) -> list[Edge]:
    """A smooth ring of n parabolas, nearly a circle."""
    step, reach = 2 * math.pi / n, radius / math.cos(math.pi / n)
    points = [
        [F.polar(radius, i * step, center), F.polar(reach, (i + 0.5) * step, center), F.polar(radius, (i + 1) % n * step, center)]
        for i in range(n)
    ]
    return [F.bezier(p[::-1]) for p in points[::-1]] if clockwise else [F.bezier(p) for p in points]


def quarter(center: Point, radius: float, turns: int) -> Edge:
    """A quarter of a circle as one cubic, beginning at `turns` quarter turns."""
    axes = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    (ax, ay), (bx, by) = axes[turns % 4], axes[(turns + 1) % 4]
    local = [(ax, ay), (ax + KAPPA * bx, ay + KAPPA * by), (bx + KAPPA * ax, by + KAPPA * ay), (bx, by)]
    return F.bezier([(center[0] + radius * x, center[1] + radius * y) for x, y in local])


def cubics(radius: float = 1.0, clockwise: bool = False) -> list[Edge]:
    """A smooth ring of four cubics, nearly a circle round the origin."""
    ring = [quarter((0.0, 0.0), radius, i) for i in range(4)]
    return [{**e, "control_points": e["control_points"][::-1]} for e in ring[::-1]] if clockwise else ring


def cubic_stadium(length: float) -> Json:
    """Two sides and four cubics."""
    x = length / 2
    outer = [F.line((-x, -1.0), (x, -1.0)), quarter((x, 0.0), 1.0, 3), quarter((x, 0.0), 1.0, 0), F.line((x, 1.0), (-x, 1.0))]
    return F.shape("cubic_stadium", [*outer, quarter((-x, 0.0), 1.0, 1), quarter((-x, 0.0), 1.0, 2)])


def round_grid(m: int) -> Json:
    """Holes of eight parabolas each on a square grid."""
    outer = F.polyline([(0.0, 0.0), (float(m), 0.0), (float(m), float(m)), (0.0, float(m))])
    return F.shape("round_grid", outer, [quadratics(8, 0.3, (i + 0.5, j + 0.5), True) for i in range(m) for j in range(m)])


def nested_squares(turn: float) -> Json:
    """A square in a square: walls of equal thickness, or a turned one."""
    hole = F.polygon_hole([F.polar(0.5 * math.sqrt(2), turn + math.pi * (i + 0.5) / 2) for i in range(4)])
    return F.shape("nested_squares", F.polyline([(-1, -1), (1, -1), (1, 1), (-1, 1)]), [hole])


def rings(edges: Sequence[list[Edge]]) -> Json:
    """The first loop with the others as holes."""
    return F.shape("rings", edges[0], list(edges[1:]))


# All of them ---------------------------------------------------------------------------------------------------------
Maker = Callable[[np.random.Generator], Json]


def _pick(rng: np.random.Generator, low: int, high: int) -> int:
    """A whole number, both ends included."""
    return int(rng.integers(low, high + 1))


def _any(rng: np.random.Generator) -> Json:
    names = sorted(set(F.CATALOGUE) - FRAGILE)
    return F.CATALOGUE[names[_pick(rng, 0, len(names) - 1)]]()


SHAPES: dict[str, Maker] = {
    "rectangle": lambda r: F.rectangle(2.0, (1.0, 2.0, 0.25)[_pick(r, 0, 2)]),
    "ngon": lambda r: F.ngon(_pick(r, 3, 14), 0.0),
    "ell": lambda r: F.ell(1.0, 1.5 + 0.5 * _pick(r, 1, 4)),
    "tee": lambda r: F.tee(),
    "plus": lambda r: F.cross(_pick(r, 3, 6)),
    "star": lambda r: F.star(_pick(r, 4, 9), 0.1 * _pick(r, 3, 7)),
    "comb": lambda r: F.comb(_pick(r, 2, 8)),
    "square_grid": lambda r: F.plate(_pick(r, 1, 4), _pick(r, 1, 4), (0.25, 0.3, 0.4)[_pick(r, 0, 2)]),
    "nested_squares": lambda r: nested_squares((0.0, math.pi / 4)[_pick(r, 0, 1)] * 0.8),
    "quad_circle": lambda r: rings([quadratics(_pick(r, 4, 12))]),
    "quad_annulus": lambda r: rings([quadratics(k := _pick(r, 5, 10), 2.0), quadratics(k, 1.0, clockwise=True)]),
    "cubic_circle": lambda r: rings([cubics()]),
    "cubic_annulus": lambda r: rings([cubics(2.0), cubics(0.4 * _pick(r, 1, 4), True)]),
    "cubic_stadium": lambda r: cubic_stadium(float(_pick(r, 1, 4))),
    "arc_circle": lambda r: F.circle(_pick(r, 3, 9)),
    "arc_annulus": lambda r: F.annulus(0.2 * _pick(r, 1, 4), 0.1 * _pick(r, 0, 1)),
    "arc_stadium": lambda r: F.stadium(float(_pick(r, 1, 4))),
    "rounded": lambda r: F.rounded_rectangle((2.0, 3.0)[_pick(r, 0, 1)], 2.0, 0.2 * _pick(r, 1, 4)),
    "gear": lambda r: F.gear(_pick(r, 5, 16)),
    "round_grid": lambda r: round_grid(_pick(r, 2, 3)),
    "hole_grid": lambda r: F.hole_grid(_pick(r, 1, 4), _pick(r, 1, 4), 0.1 * _pick(r, 1, 4)),
    "any": _any,
}


def noisy(maker: Maker, seed: int, rng: np.random.Generator) -> Json:
    """A degenerate shape with the noise level of this seed, turned for every second eleven of seeds."""
    noise, turn = LEVELS[seed % len(LEVELS)], float(rng.uniform(0.1, 6.0))
    domain: dict[str, Any] = maker(rng)
    domain = {"outer": domain["outer"], "holes": domain["holes"]}
    if seed // len(LEVELS) % 2:
        domain = rotated(domain, turn)
    moved_ = moved(domain, noise, rng)
    return {"outer": moved_["outer"], "holes": moved_["holes"], "note": f"noise {noise:g}"}
