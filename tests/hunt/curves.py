"""Families of curves with names: roses, trochoids, strokes of a pen, whole circles, splines with multiple knots.

As in `draw`: a random generator says the domain, which is valid by construction and of size about one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from tests import families as F
from tests.families import Edge, Json, Point
from tests.hunt.reduce import joined
from tests.transforms import elevated, mapped, reweighted, rotated, united

Rng = np.random.Generator


def _decades(rng: Rng, low: float, high: float) -> float:
    return float(10.0 ** rng.uniform(low, high))


def hermite(points: F.Floats, slopes: F.Floats, u: F.Floats) -> Edge:
    """The cubic B-spline with double knots through points (n, 2) with derivatives (n, 2) at rising parameters (n,)."""
    h = np.diff(u)[:, None] / 3.0
    inner = np.stack([points[:-1] + h * slopes[:-1], points[1:] - h * slopes[1:]], axis=1).reshape(-1, 2)
    return {
        "degree": 3,
        "control_points": [points[0].tolist(), *inner.tolist(), points[-1].tolist()],
        "knots": [float(u[0])] * 4 + np.repeat(u[1:-1], 2).tolist() + [float(u[-1])] * 4,
    }


def trigonometric(terms: dict[int, complex]) -> list[Edge]:
    """The closed curve sum of c exp(i k a), k = -m .. m, as four rational Beziers of degree 2m: t = tan(a / 2) on a quarter."""
    m = max(abs(k) for k in terms)
    weights = _power_to_bernstein(np.polynomial.polynomial.polypow([1.0, 0.0, 1.0], m), 2 * m).real
    edges = []
    for quarter in range(4):
        total = np.zeros(2 * m + 1, dtype=complex)
        for k, c in terms.items():
            # exp(i k a) = (1 + i t)^(m + k) (1 - i t)^(m - k) / (1 + t^2)^m
            one, other = np.polynomial.polynomial.polypow([1, 1j], m + k), np.polynomial.polynomial.polypow([1, -1j], m - k)
            total += c * 1j ** (k * quarter) * np.polynomial.polynomial.polymul(one, other)
        h = _power_to_bernstein(total, 2 * m) / weights
        edges.append(F.bezier(np.column_stack([h.real, h.imag]).tolist(), weights.tolist()))
    return joined(edges)


def _power_to_bernstein(p: Any, degree: int) -> Any:
    """Coefficients of powers of t to control values over [0, 1]."""
    return np.array([sum(math.comb(i, j) / math.comb(degree, j) * p[j] for j in range(i + 1)) for i in range(degree + 1)])


def rose(seed: int, rng: Rng) -> Json:
    """A rose r = 1 + d cos(k a), or a hypotrochoid nearly with cusps: four exact rational Beziers of degree 6 to 12."""
    k = int(rng.integers(2, 6))
    if seed % 2:
        depth = (1 - _decades(rng, -4, 0)) if rng.random() < 0.5 else float(rng.uniform(0.05, 0.9))
        return {"outer": trigonometric({1: 1.0, 1 + k: 0.5 * depth, 1 - k: 0.5 * depth}), "holes": []}
    return {"outer": trigonometric({1: 1.0, -k - 1: (1 - _decades(rng, -4, 0)) / (k + 1)}), "holes": []}


def stroke(seed: int, rng: Rng) -> Json:
    """A cubic drawn with a round pen: its offsets as cubic B-splines, and half circles."""
    y = rng.uniform(-0.6, 0.6, 4)
    control = np.column_stack([[0.0, 1 / 3, 2 / 3, 1.0], y])
    u = np.linspace(0, 1, int(rng.integers(5, 25)))
    differences = [control, 3 * np.diff(control, axis=0), 6 * np.diff(control, 2, axis=0)]
    basis = [np.array([math.comb(n, i) * u**i * (1 - u) ** (n - i) for i in range(n + 1)]).T for n in (3, 2, 1)]
    c, c1, c2 = (b @ d for b, d in zip(basis, differences, strict=True))
    speed = np.linalg.norm(c1, axis=1)[:, None]
    normal = np.column_stack([-c1[:, 1], c1[:, 0]]) / speed
    curvature = (c1[:, :1] * c2[:, 1:] - c1[:, 1:] * c2[:, :1]) / speed**3
    pen = min(0.1, 0.7 / float(np.abs(curvature).max())) * _decades(rng, -3, 0)
    left = hermite((c + pen * normal)[::-1], -((1 - pen * curvature) * c1)[::-1], 1 - u[::-1])
    right = hermite(c - pen * normal, (1 + pen * curvature) * c1, u)
    ways = [math.atan2(v[1], v[0]) for v in (c1[0], c1[-1])]
    last, first = (
        [F.arc(tuple(p), pen, a + turn - math.pi / 2, a + turn) for turn in (0.0, math.pi / 2)]
        for p, a in ((c[-1], ways[1]), (c[0], ways[0] + math.pi))
    )
    return {"outer": joined([right, *last, left, *first]), "holes": []}


def full_circle(rng: Rng, radius: float, center: Point, squeeze: float) -> list[Edge]:
    """A whole circle (or ellipse) as one edge of degree 2 to 5 with arcs of any sweep, each at its own pace."""
    if rng.random() < 0.3:
        half = F.bezier([(1, 0), (1, 2), (-1, 2), (-1, 0)], [1, 1 / 3, 1 / 3, 1])
        edges = [half, *rotated({"outer": [half]}, math.pi)["outer"]]
    else:
        count = int(rng.integers(3, 7))
        angles = (2 * math.pi * (np.arange(count) + rng.uniform(0, 0.3, count)) / count).tolist()
        stops = [*angles, angles[0] + 2 * math.pi]
        edges = [F.arc((0.0, 0.0), 1.0, a, b) for a, b in pairwise(stops)]
    for _ in range(int(rng.integers(0, 3))):
        edges = [elevated(e) for e in edges]
    edges = [reweighted(e, _decades(rng, -0.5, 0.5)) for e in edges] if rng.random() < 0.5 else edges
    placed = mapped({"outer": joined(edges)}, lambda p: p * [radius, radius * squeeze] + np.array(center))
    return united(placed["outer"]) if rng.random() < 0.7 else list(placed["outer"])


def circles(seed: int, rng: Rng) -> Json:
    """Rings and ellipses of full circles: concentric, nearly so, or apart."""
    off, squeeze = float(rng.choice([0.0, _decades(rng, -9, -1)])), float(rng.choice([1.0, 0.5]))
    outer = full_circle(rng, 1.0, (0.0, 0.0), squeeze)
    holes = [full_circle(rng, 0.3, (off, 0.0), squeeze)] if seed % 3 else []
    return {"outer": outer, "holes": holes}


def multiple_knots(seed: int, rng: Rng, spread: float = 3.0, degrees: tuple[int, int] = (2, 6)) -> Json:
    """Rational splines whose knots have any multiplicity up to the degree; weights within 10^-spread and 10^spread."""
    corners, edges = int(rng.integers(3, 6)), []
    radii = [float(r) for r in rng.uniform(0.7, 1.2, corners)]
    for i in range(corners):
        degree = int(rng.integers(degrees[0], degrees[1] + 1))
        inner = [float(u) for u in np.sort(rng.uniform(0.1, 0.9, 3)) for _ in range(int(rng.integers(0, degree + 1)))]
        count = degree + 1 + len(inner)
        f = np.concatenate([[0.0], (np.arange(1, count - 1) + rng.uniform(-0.3, 0.3, count - 2)) / (count - 1), [1.0]])
        r = radii[i] + f * (radii[(i + 1) % corners] - radii[i])
        r[1:-1] *= rng.uniform(0.8, 1.2, count - 2)
        points = [list(F.polar(float(a), 2 * math.pi * (i + float(b)) / corners)) for a, b in zip(r, f, strict=True)]
        knots = [0.0] * (degree + 1) + inner + [1.0] * (degree + 1)
        weights = [_decades(rng, -spread, spread) for _ in points]
        edges.append({"degree": degree, "control_points": points, "knots": knots, "weights": weights})
    return {"outer": joined(edges), "holes": []}


def wide_weights(seed: int, rng: Rng) -> Json:
    """The same with weights from 1e-6 to 1e6, degrees up to 20: tightest bends, nearly all of an edge within 1e-12 of u."""
    return multiple_knots(seed, rng, 6.0, (1, 20) if seed % 8 == 7 else (1, 5))


CURVES: dict[str, Callable[[int, Rng], Json]] = {f.__name__: f for f in (rose, stroke, circles, multiple_knots, wide_weights)}
