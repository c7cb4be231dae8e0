"""Shapes with what is known of their axes, as JSON domains of the contract.

A builder returns {"name", "outer", "holes", "truth"}: `truth` may hold the number of "leaves" and "cycles" and, in
"mat", chains of exact discs [x, y, r]. `CATALOGUE` names one or more of each family.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.transforms import backwards, insert_knot

Json = dict[str, Any]
Edge = dict[str, Any]
Point = Sequence[float]
Floats = NDArray[np.float64]


# Edges ---------------------------------------------------------------------------------------------------------------
def bezier(points: Sequence[Point], weights: Sequence[float] | None = None) -> Edge:
    """A Bezier edge with its knots written out."""
    degree = len(points) - 1
    edge: Edge = {
        "degree": degree,
        "control_points": [[float(x), float(y)] for x, y in points],
        "knots": [0.0] * (degree + 1) + [1.0] * (degree + 1),
    }
    if weights is not None:
        edge["weights"] = [float(w) for w in weights]
    return edge


def line(a: Point, b: Point) -> Edge:
    """A straight edge."""
    return bezier([a, b])


def polyline(points: Sequence[Point]) -> list[Edge]:
    """A closed polygon, one edge a side."""
    return [line(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]


def polar(radius: float, angle: float, center: Point = (0.0, 0.0)) -> tuple[float, float]:
    """A point at a distance and an angle (radians)."""
    return center[0] + radius * math.cos(angle), center[1] + radius * math.sin(angle)


def arc(center: Point, radius: float, start: float, stop: float) -> Edge:
    """A circular arc of less than half a turn, as one rational quadratic; clockwise when stop < start."""
    half = 0.5 * (stop - start)
    middle = polar(radius / math.cos(half), 0.5 * (start + stop), center)
    return bezier([polar(radius, start, center), middle, polar(radius, stop, center)], [1.0, math.cos(half), 1.0])


def arc_between(a: Point, b: Point, bulge: float) -> Edge:
    """The arc from a to b that swells to the right by `bulge` = tan(sweep / 4); negative: to the left."""
    sweep = 4 * math.atan(bulge)
    mx, my = 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])
    reach = 0.5 * math.tan(0.5 * sweep)
    middle = (mx + reach * (b[1] - a[1]), my - reach * (b[0] - a[0]))
    return bezier([a, middle, b], [1.0, math.cos(0.5 * sweep), 1.0])


def conic_loop(a: float, b: float, center: Point = (0.0, 0.0), turn: float = 0.0, clockwise: bool = False) -> Edge:
    """A whole ellipse (circle: a = b) as one closed rational quadratic of four spans."""
    q = math.sqrt(0.5)
    square = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    c, s = math.cos(turn), math.sin(turn)
    points = [[center[0] + c * a * x - s * b * y, center[1] + s * a * x + c * b * y] for x, y in square]
    return {
        "degree": 2,
        "control_points": points[::-1] if clockwise else points,
        "knots": [0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0],
        "weights": [1.0, q, 1.0, q, 1.0, q, 1.0, q, 1.0],
    }


def closed_spline(points: Floats) -> Edge:
    """The closed C2 cubic B-spline of control points (n, 2), as one clamped edge with n knot spans.

    A closed control polygon that every line through a point crosses twice gives a curve that it crosses at most twice
    (variation diminution): star-shaped control points make a simple curve.
    """
    n = len(points)
    ring = points[np.arange(-1, n + 2) % n]
    edge: Edge = {"degree": 3, "control_points": ring.tolist(), "knots": [float(i) for i in range(-3, n + 4)]}
    for u in (0.0, 0.0, float(n), float(n)):
        edge = insert_knot(edge, u)
    knots = [0.0] * 4 + [float(i) for i in range(1, n)] + [float(n)] * 4
    return {"degree": 3, "control_points": edge["control_points"][2:-2], "knots": knots}


def circle_hole(center: Point, radius: float) -> list[Edge]:
    """A round hole."""
    return [conic_loop(radius, radius, center, clockwise=True)]


def polygon_hole(points: Sequence[Point]) -> list[Edge]:
    """A hole with straight sides, given counter-clockwise."""
    return polyline(list(points)[::-1])


def shape(name: str, outer: list[Edge], holes: Sequence[list[Edge]] = (), **truth: Any) -> Json:
    """A domain; the number of cycles is always known."""
    return {"name": name, "outer": outer, "holes": list(holes), "truth": {"cycles": len(holes), **truth}}


def domain(shaped: Json, **options: Any) -> Json:
    """What a user would send: without name and truth."""
    sent = {"outer": shaped["outer"], "holes": shaped["holes"]}
    return {**sent, "options": options} if options else sent


def chain(a: Point, b: Point, n: int = 9) -> list[list[float]]:
    """Discs on a straight run in (x, y, r)."""
    return [[p + (q - p) * i / (n - 1) for p, q in zip(a, b, strict=True)] for i in range(n)]


# Straight sides ------------------------------------------------------------------------------------------------------
def rectangle(a: float = 2.0, b: float = 1.0) -> Json:
    """a x b, a >= b: four bisectors and a spine; a square has one node of degree four."""
    x, y, d = a / 2, b / 2, (a - b) / 2
    corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
    mat = [chain((px, py, 0.0), (math.copysign(d, px), 0.0, y)) for px, py in corners]
    return shape(f"rectangle_{a:g}x{b:g}", polyline(corners), leaves=4, mat=[*mat, chain((-d, 0.0, y), (d, 0.0, y))])


def ngon(n: int, turn: float = 0.1) -> Json:
    """A regular n-gon: one node of degree n."""
    corners = [polar(1.0, turn + 2 * math.pi * i / n) for i in range(n)]
    mat = [chain((*p, 0.0), (0.0, 0.0, math.cos(math.pi / n))) for p in corners]
    return shape(f"ngon_{n}", polyline(corners), leaves=n, mat=mat)


def triangle() -> Json:
    """The 3-4-5 triangle: incentre (1, 1), radius 1."""
    corners = [(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)]
    return shape("triangle", polyline(corners), leaves=3, mat=[chain((*p, 0.0), (1.0, 1.0, 1.0)) for p in corners])


def ell(width: float = 1.0, arm: float = 3.0) -> Json:
    """L: five leaves; the two parabolas of the reflex corner meet on the diagonal."""
    w, a = width, arm
    corners = [(0.0, 0.0), (a, 0.0), (a, w), (w, w), (w, a), (0.0, a)]
    # centre on the diagonal: its distance to the reflex corner (w, w) equals its distance to the axes
    r = w * (2 - math.sqrt(2))
    mat = [chain((0.0, 0.0, 0.0), (r, r, r)), chain((w, w / 2, w / 2), (a - w / 2, w / 2, w / 2))]
    bend = [[x, ((x - w) ** 2 + w * w) / (2 * w), ((x - w) ** 2 + w * w) / (2 * w)] for x in np.linspace(r, w, 7)]
    return shape("L", polyline(corners), leaves=5, mat=[*mat, bend])


def tee() -> Json:
    """T: a node of degree three between two reflex corners, where the bar meets the stem."""
    corners = [(-3, 0), (-1, 0), (-1, -3), (1, -3), (1, 0), (3, 0), (3, 2), (-3, 2)]
    # on x = 0: distance to (1, 0) equals the distance 2 - y to the top
    y = 0.75
    return shape("T", polyline(corners), leaves=6, mat=[[[0.0, y, 2 - y]], chain((0.0, -1.9, 1.0), (0.0, -0.01, 1.0))])


def cross(arms: int = 4, reach: float = 3.0) -> Json:
    """A plus of `arms` arms of half width one, round the origin: one node of degree `arms`."""
    inner = 1.0 / math.sin(math.pi / arms)
    corners = []
    for i in range(arms):
        t = 2 * math.pi * i / arms
        ux, uy = math.cos(t), math.sin(t)
        corners += [(reach * ux + uy, reach * uy - ux), (reach * ux - uy, reach * uy + ux)]
        corners.append(polar(inner, t + math.pi / arms))
    return shape(f"cross_{arms}", polyline(corners), leaves=2 * arms, mat=[[[0.0, 0.0, inner]]])


def comb(teeth: int = 8, gap: float = 0.6, depth: float = 2.0) -> Json:
    """A bar with square teeth: two leaves a tooth and two for the ends."""
    points: list[Point] = [(0.0, 0.0), (float(teeth), 0.0)]
    for i in range(teeth - 1, -1, -1):
        left = i + gap if i else 0.0
        points += [(i + 1.0, 1.0 + depth), (left, 1.0 + depth)] + ([(left, 1.0), (float(i), 1.0)] if i else [])
    return shape(f"comb_{teeth}", polyline(points), leaves=2 * teeth + 2)


def star(points: int = 5, inner: float = 0.4) -> Json:
    """A star polygon: one node of degree `points`, or the touching of its reflex corners."""
    corners = [polar(1.0 if i % 2 == 0 else inner, math.pi * i / points) for i in range(2 * points)]
    return shape(f"star_{points}", polyline(corners), leaves=points, mat=[[[0.0, 0.0, inner]]])


def sliver(height: float = 1e-3) -> Json:
    """A thin triangle."""
    return shape(f"sliver_{height:g}", polyline([(0.0, 0.0), (1.0, 0.0), (0.4, height)]), leaves=3)


def polygon_random(seed: int, n: int = 12) -> Json:
    """A star-shaped polygon with random radii: convex and reflex corners."""
    rng = np.random.default_rng(seed)
    angles = 2 * np.pi * (np.arange(n) + rng.uniform(0.1, 0.9, n)) / n
    corners = [polar(float(r), float(t)) for r, t in zip(rng.uniform(0.35, 1.0, n), angles, strict=True)]
    p = np.array(corners)
    before, after = p - np.roll(p, 1, axis=0), np.roll(p, -1, axis=0) - p
    convex = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 0
    return shape(f"polygon_{seed}", polyline(corners), leaves=int(convex.sum()))


# Arcs and conics -----------------------------------------------------------------------------------------------------
def circle(edges: int = 1) -> Json:
    """A disc: its axis is one point."""
    step = 2 * math.pi / edges
    outer = (
        [conic_loop(1.0, 1.0)] if edges == 1 else [arc((0.0, 0.0), 1.0, i * step, (i + 1) * step) for i in range(edges)]
    )
    return shape(f"circle_{edges}", outer, leaves=0, mat=[[[0.0, 0.0, 1.0]]])


def ellipse(a: float = 2.0, b: float = 1.0, edges: int = 1, turn: float = 0.0) -> Json:
    """Axis: y = 0, |x| <= a - b^2 / a, r = b sqrt(1 - x^2 / (a^2 - b^2)): between two centres of curvature."""
    c, s = math.cos(turn), math.sin(turn)
    reach = a - b * b / a
    mat = [[x * c, x * s, b * math.sqrt(1 - x * x / (a * a - b * b))] for x in np.linspace(-reach, reach, 17)]
    whole = conic_loop(a, b, turn=turn)
    outer = [whole] if edges == 1 else [bezier(p, w) for p, w in _quarters(whole)]
    return shape(f"ellipse_{a:g}x{b:g}_{edges}", outer, leaves=2, mat=[mat])


def _quarters(edge: Edge) -> list[tuple[list[Point], list[float]]]:
    points, weights = edge["control_points"], edge["weights"]
    return [(points[i : i + 3], weights[i : i + 3]) for i in (0, 2, 4, 6)]


def stadium(length: float = 2.0, radius: float = 1.0) -> Json:
    """Two half circles (two arcs each) and two sides; its axis is the segment between their centres."""
    x, q, r = length / 2, math.pi / 2, radius
    outer = [
        line((-x, -r), (x, -r)),
        arc((x, 0.0), r, -q, 0),
        arc((x, 0.0), r, 0, q),
        line((x, r), (-x, r)),
        arc((-x, 0.0), r, q, 2 * q),
    ]
    outer.append(arc((-x, 0.0), r, 2 * q, 3 * q))
    return shape("stadium", outer, leaves=2, mat=[chain((-x, 0.0, r), (x, 0.0, r))])


def rounded_rectangle(a: float = 3.0, b: float = 2.0, r: float = 0.5) -> Json:
    """Four corner arcs wholly in contact with the discs at their centres."""
    x, y, q, d = a / 2 - r, b / 2 - r, math.pi / 2, (a - b) / 2
    outer = []
    for i, (cx, cy) in enumerate([(x, -y), (x, y), (-x, y), (-x, -y)]):
        turn = (i - 1) * q
        outer.append(arc((cx, cy), r, turn, turn + q))
        nx, ny = [(x, y), (-x, y), (-x, -y), (x, -y)][i]
        outer.append(line(polar(r, turn + q, (cx, cy)), polar(r, turn + q, (nx, ny))))
    mat = [chain((cx, cy, r), (math.copysign(d, cx), 0.0, b / 2)) for cx, cy in [(x, -y), (x, y), (-x, y), (-x, -y)]]
    return shape("rounded_rectangle", outer, leaves=4, mat=[*mat, chain((-d, 0.0, b / 2), (d, 0.0, b / 2))])


def half_disc() -> Json:
    """Between diameter and half circle (two arcs): the parabola with r = y, x^2 + y^2 = (1 - y)^2."""
    outer = [
        line((-1.0, 0.0), (1.0, 0.0)),
        arc((0.0, 0.0), 1.0, 0.0, math.pi / 2),
        arc((0.0, 0.0), 1.0, math.pi / 2, math.pi),
    ]
    mat = [[x, (1 - x * x) / 2, (1 - x * x) / 2] for x in np.linspace(-1, 1, 17)]
    return shape("half_disc", outer, leaves=2, mat=[mat])


def annulus(inner: float = 0.4, offset: float = 0.0) -> Json:
    """A round hole in a disc: the axis is a circle, or an ellipse with the two centres as foci."""
    mat = []
    for t in np.linspace(0, 2 * math.pi, 24, endpoint=False):
        # on the ray from the outer centre: |c| + r = 1 and |c - (offset, 0)| = r + inner
        rho = ((1 + inner) ** 2 - offset * offset) / (2 * (1 + inner - offset * math.cos(t)))
        mat.append([rho * math.cos(t), rho * math.sin(t), 1 - rho])
    return shape(
        f"annulus_{inner:g}_{offset:g}",
        [conic_loop(1.0, 1.0)],
        [circle_hole((offset, 0.0), inner)],
        leaves=0,
        mat=[mat],
    )


def square_round_hole(radius: float = 0.5) -> Json:
    """A square with a round hole: parabolas, joined to the four corners."""
    k = math.sqrt(2)
    r = (k - radius) / (k + 1)  # on the diagonal from the corner: r sqrt(2) + r = sqrt(2) - radius
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    mat = [chain((x, y, 0.0), (x - r * x, y - r * y, r)) for x, y in corners]
    mat.append([[0.0, (1 + radius) / 2, (1 - radius) / 2], [(1 + radius) / 2, 0.0, (1 - radius) / 2]])
    return shape("square_round_hole", polyline(corners), [circle_hole((0.0, 0.0), radius)], leaves=4, mat=mat)


def lens(half: float = 1.0, height: float = 0.6) -> Json:
    """Two parabolas that meet in two corners."""
    outer = [bezier([(-half, 0.0), (0.0, -height), (half, 0.0)]), bezier([(half, 0.0), (0.0, height), (-half, 0.0)])]
    return shape(f"lens_{height:g}", outer, leaves=2, mat=[[[0.0, 0.0, height / 2]]])


def arc_lens(bulge: float = 0.5) -> Json:
    """Two equal arcs: the axis is the chord between the corners."""
    a, b = (-1.0, 0.0), (1.0, 0.0)
    radius = (1 + bulge * bulge) / (2 * bulge)
    lower = math.sqrt(radius * radius - 1)  # centres at (0, +-lower)
    mat = [[x, 0.0, radius - math.hypot(x, lower)] for x in np.linspace(-1, 1, 9)]
    return shape("arc_lens", [arc_between(a, b, bulge), arc_between(b, a, bulge)], leaves=2, mat=[mat])


def parabola_cap(depth: float = 3.0) -> Json:
    """y = x^2 cut off at y = depth: axis from the focus-side centre of curvature (0, 1/2) up, r = sqrt(y - 1/4)."""
    x = math.sqrt(depth)
    outer = [bezier([(-x, depth), (0.0, -depth), (x, depth)]), line((x, depth), (-x, depth))]
    # the disc on the axis that also touches the lid: depth - y = sqrt(y - 1/4)
    y = depth + 0.5 - math.sqrt(depth)
    mat = [[0.0, t, math.sqrt(t - 0.25)] for t in np.linspace(0.5, y, 9)]
    return shape(f"parabola_cap_{depth:g}", outer, leaves=3, mat=[mat])


def gear(teeth: int = 12, bore: float = 0.4) -> Json:
    """Straight-flanked teeth with arc tips and arc roots, and a bore; two leaves a tooth."""
    step = 2 * math.pi / teeth
    outer = []
    for i in range(teeth):
        t = i * step
        outer.append(arc((0.0, 0.0), 1.0, t, t + 0.45 * step))
        outer.append(line(polar(1.0, t + 0.45 * step), polar(0.8, t + 0.55 * step)))
        outer.append(arc((0.0, 0.0), 0.8, t + 0.55 * step, t + 0.9 * step))
        outer.append(line(polar(0.8, t + 0.9 * step), polar(1.0, t + step)))
    return shape(f"gear_{teeth}", outer, [circle_hole((0.0, 0.0), bore)], leaves=2 * teeth)


def keyhole(mouth: float = 0.6) -> Json:
    """A disc of radius one with a slot: curvature jumps to a reflex corner where they meet."""
    t = math.asin(mouth)
    q = math.pi / 2
    outer = [
        line((-mouth, -3.0), (mouth, -3.0)),
        line((mouth, -3.0), (mouth, -math.cos(t))),
        arc((0.0, 0.0), 1.0, t - q, q / 2),
    ]
    outer += [
        arc((0.0, 0.0), 1.0, q / 2, 3 * q / 2),
        arc((0.0, 0.0), 1.0, 3 * q / 2, 3 * q - t),
        line((-mouth, -math.cos(t)), (-mouth, -3.0)),
    ]
    return shape("keyhole", outer, leaves=3, mat=[chain((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), 2)])


def dumbbell(neck: float = 0.2) -> Json:
    """Two discs joined by a straight neck with reflex corners: two leaves that touch whole arcs."""
    t, x = math.asin(neck), 2.0
    cut = x - math.cos(t)
    outer = []
    for sign, first in ((1.0, math.pi + t), (-1.0, t)):
        outer.append(line((-sign * cut, -sign * neck), (sign * cut, -sign * neck)))
        stops = np.linspace(first, first + 2 * math.pi - 2 * t, 4)
        outer += [arc((sign * x, 0.0), 1.0, float(a), float(b)) for a, b in pairwise(stops)]
    mat = [chain((-cut, 0.0, neck), (cut, 0.0, neck)), [[x, 0.0, 1.0], [-x, 0.0, 1.0]]]
    return shape(f"dumbbell_{neck:g}", outer, leaves=2, mat=mat)


def pipe_bend(inner: float = 1.0, outer_radius: float = 2.0) -> Json:
    """A quarter of a ring: concentric walls, so a circular axis of constant radius between its ends."""
    q, middle, r = math.pi / 2, 0.5 * (inner + outer_radius), 0.5 * (outer_radius - inner)
    outer = [line((inner, 0.0), (outer_radius, 0.0)), arc((0.0, 0.0), outer_radius, 0.0, q)]
    outer += [line((0.0, outer_radius), (0.0, inner)), arc((0.0, 0.0), inner, q, 0.0)]
    mat = [[*polar(middle, float(t)), r] for t in np.linspace(0.45, q - 0.45, 7)]
    return shape("pipe_bend", outer, leaves=4, mat=[mat])


def heart() -> Json:
    """An inward cusp where two half circles meet, in a larger half circle: curvature jumps, two whole-arc leaves."""
    q = math.pi / 2
    outer = [arc((0.0, 0.0), 2.0, 2 * q, 3 * q), arc((0.0, 0.0), 2.0, 3 * q, 4 * q)]
    outer += [arc((1.0, 0.0), 1.0, 0.0, q), arc((1.0, 0.0), 1.0, q, 2 * q)]
    outer += [arc((-1.0, 0.0), 1.0, 0.0, q), arc((-1.0, 0.0), 1.0, q, 2 * q)]
    return shape("heart", outer, leaves=2, mat=[[[1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, -1.0, 1.0]]])


def thorn() -> Json:
    """An outward cusp: between y = 0 and y = x^2."""
    outer = [line((0.0, 0.0), (1.0, 0.0)), line((1.0, 0.0), (1.0, 1.0)), bezier([(1.0, 1.0), (0.5, 0.0), (0.0, 0.0)])]
    return shape("thorn", outer, leaves=3)


# Free forms ----------------------------------------------------------------------------------------------------------
def lens_one_edge(height: float = 0.6) -> Json:
    """The lens as one closed quadratic whose corner is a double knot."""
    edge = {
        "degree": 2,
        "control_points": [[-1.0, 0.0], [0.0, -height], [1.0, 0.0], [0.0, height], [-1.0, 0.0]],
        "knots": [0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0],
    }
    return shape("lens_one_edge", [edge], leaves=2, mat=[[[0.0, 0.0, height / 2]]])


def square_one_edge() -> Json:
    """A square as one edge of degree one: corners at simple inner knots."""
    points = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]
    edge = {"degree": 1, "control_points": points, "knots": [0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0]}
    return shape("square_one_edge", [edge], leaves=4, mat=[[[0.0, 0.0, 1.0]]])


def kidney() -> Json:
    """Smooth and bent: no convex vertex."""
    radii = [1.0, 1.05, 1.1, 1.05, 1.0, 0.9, 0.35, 0.9]
    points = np.array([polar(r, 2 * math.pi * i / 8) for i, r in enumerate(radii)])
    return shape("kidney", [closed_spline(points)])


def smooth(seed: int, n: int = 10, holes: int = 0) -> Json:
    """A random smooth blob, with smooth holes on a ring inside."""
    rng = np.random.default_rng(seed)
    outer = np.array(
        [
            polar(float(r), 2 * math.pi * (i + float(j)) / n)
            for i, (r, j) in enumerate(rng.uniform((0.8, -0.3), (1.3, 0.3), (n, 2)))
        ]
    )
    inside = []
    for k in range(holes):
        reach = 0.36 * math.sin(math.pi / max(holes, 2)) * 0.85
        center = polar(0.38 if holes > 1 else 0.1, 2 * math.pi * (k + 0.5) / holes)
        radii = rng.uniform(0.5 * reach, reach, 7)
        points = np.array([polar(float(r), 2 * math.pi * i / 7, center) for i, r in enumerate(radii)])
        inside.append([closed_spline(points[::-1])])
    return shape(f"smooth_{seed}_{holes}", [closed_spline(outer)], inside)


def spiral(turns: float = 2.5, width: float = 0.5) -> Json:
    """A strip rolled up, of cubic pieces a quarter turn long."""
    count = round(4 * turns)
    angles = np.linspace(0.0, 2 * math.pi * turns, count + 1)

    def wall(offset: float) -> list[Edge]:
        radius = 1.0 + angles / (2 * math.pi) + offset
        step = (angles[1] - angles[0]) / 3
        point = np.column_stack([radius * np.cos(angles), radius * np.sin(angles)])
        rate = np.column_stack([np.cos(angles), np.sin(angles)]) / (2 * math.pi) + np.column_stack(
            [-point[:, 1], point[:, 0]]
        )
        return [
            bezier([point[i], point[i] + step * rate[i], point[i + 1] - step * rate[i + 1], point[i + 1]])
            for i in range(count)
        ]

    out, back = wall(width / 2), [backwards(e) for e in wall(-width / 2)[::-1]]
    caps = [
        line(out[-1]["control_points"][-1], back[0]["control_points"][0]),
        line(back[-1]["control_points"][-1], out[0]["control_points"][0]),
    ]
    return shape(f"spiral_{turns:g}", [*out, caps[0], *back, caps[1]], leaves=4)


def star_shaped(seed: int, n: int = 9, kinds: str = "lacq", holes: int = 0) -> Json:
    """Mixed edges: lines (l), arcs (a), quadratics (q) and cubics (c), each in its own wedge seen from the origin."""
    rng = np.random.default_rng(seed)
    angles = 2 * np.pi * (np.arange(n) + rng.uniform(0.2, 0.8, n)) / n
    corners = [polar(float(r), float(t)) for r, t in zip(rng.uniform(0.7, 1.2, n), angles, strict=True)]
    chosen = [kinds[int(i)] for i in rng.integers(len(kinds), size=n)]
    shapes = rng.uniform(-1.0, 1.0, (n, 2))
    outer = wedge_edges(corners, chosen, [(float(a), float(b)) for a, b in shapes])
    return shape(f"star_shaped_{kinds}_{seed}_{holes}", outer, safe_holes(rng, outer, holes))


def wedge_edges(corners: Sequence[Point], kinds: Sequence[str], shapes: Sequence[tuple[float, float]]) -> list[Edge]:
    """Edges between corners of rising polar angle; two numbers in [-1, 1] shape each."""
    edges = []
    for a, b, kind, (f, g) in zip(corners, [*corners[1:], corners[0]], kinds, shapes, strict=True):
        third = (
            [((2 - i) * a[0] + (1 + i) * b[0]) / 3 for i in (0, 1)],
            [((2 - i) * a[1] + (1 + i) * b[1]) / 3 for i in (0, 1)],
        )
        middle = (0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]))
        if kind == "l":
            edges.append(line(a, b))
        elif kind == "q":
            edges.append(bezier([a, (middle[0] * (1 + 0.4 * f), middle[1] * (1 + 0.4 * f)), b]))
        elif kind == "c":
            inner = [(x * (1 + 0.4 * k), y * (1 + 0.4 * k)) for x, y, k in zip(*third, (f, g), strict=True)]
            edges.append(bezier([a, *inner, b]))
        else:
            bulge = 0.35 * f if abs(f) > 1e-3 else 0.1
            while abs(bulge) > 1e-3 and not in_wedge(arc_between(a, b, bulge)["control_points"][1], a, b):
                bulge *= 0.5
            edges.append(arc_between(a, b, bulge) if abs(bulge) > 1e-3 else line(a, b))
    return edges


def in_wedge(p: Point, a: Point, b: Point) -> bool:
    """True when p lies well between the rays to a and b, and not near the origin."""
    margin = 0.03 * math.hypot(*p)
    left, right = (a[0] * p[1] - a[1] * p[0]) / math.hypot(*a), (p[0] * b[1] - p[1] * b[0]) / math.hypot(*b)
    return left > margin and right > margin and math.hypot(*p) > 0.4 * min(math.hypot(*a), math.hypot(*b))


def safe_holes(rng: np.random.Generator, outer: list[Edge], count: int) -> list[list[Edge]]:
    """Round and square holes in cells of a small grid inside the largest disc round the origin that is surely free."""
    if not count:
        return []
    room = 0.9 * min(hull_distance(np.array(e["control_points"])) for e in outer)
    side = math.ceil(math.sqrt(count))
    pitch = room * math.sqrt(2) / side
    holes = []
    for k in range(count):
        jitter = rng.uniform(-0.1, 0.1, 2) * pitch
        center = tuple(pitch * (i - 0.5 * (side - 1)) + float(j) for i, j in zip(divmod(k, side), jitter, strict=True))
        radius, turn = float(rng.uniform(0.15, 0.33)) * pitch, float(rng.uniform(0, 1))
        square = [polar(radius, turn + math.pi * i / 2, center) for i in range(4)]
        holes.append(circle_hole(center, radius) if rng.random() < 0.5 else polygon_hole(square))
    return holes


def hull_distance(points: Floats) -> float:
    """A lower bound for the distance of the origin from the convex hull of points on one side of it."""
    directions = np.array([polar(1.0, float(t)) for t in np.linspace(0, 2 * math.pi, 180, endpoint=False)])
    return float((points @ directions.T).min(axis=0).max())


# Many holes ----------------------------------------------------------------------------------------------------------
def hole_grid(columns: int = 3, rows: int = 3, radius: float = 0.3) -> Json:
    """Round holes on a grid: nodes of degree four between them, (i, j, sqrt(1/2) - radius)."""
    outer = polyline([(-0.5, -0.5), (columns - 0.5, -0.5), (columns - 0.5, rows - 0.5), (-0.5, rows - 0.5)])
    holes = [circle_hole((float(i), float(j)), radius) for i in range(columns) for j in range(rows)]
    mat = [[i + 0.5, j + 0.5, math.sqrt(0.5) - radius] for i in range(columns - 1) for j in range(rows - 1)]
    mat += [[i + 0.5, float(j), 0.5 - radius] for i in range(columns - 1) for j in range(rows)]
    return shape(f"hole_grid_{columns}x{rows}", outer, holes, leaves=4, mat=[mat] if mat else [])


def plate(columns: int = 3, rows: int = 2, half: float = 0.25) -> Json:
    """Square holes on a grid: parallel walls, nodes that touch four corners."""
    outer = polyline([(-0.5, -0.5), (columns - 0.5, -0.5), (columns - 0.5, rows - 0.5), (-0.5, rows - 0.5)])
    square = [(-half, -half), (half, -half), (half, half), (-half, half)]
    holes = [polygon_hole([(i + x, j + y) for x, y in square]) for i in range(columns) for j in range(rows)]
    mat = [[i + 0.5, j + 0.5, math.sqrt(2) * (0.5 - half)] for i in range(columns - 1) for j in range(rows - 1)]
    return shape(f"plate_{columns}x{rows}", outer, holes, leaves=4, mat=[mat] if mat else [])


CATALOGUE: dict[str, Callable[[], Json]] = {
    "rectangle": rectangle,
    "rectangle_thin": lambda: rectangle(10.0, 0.1),
    "square": lambda: rectangle(1.0, 1.0),
    "triangle": triangle,
    "hexagon": lambda: ngon(6),
    "heptagon": lambda: ngon(7),
    "ngon_32": lambda: ngon(32),
    "ell": ell,
    "tee": tee,
    "cross": cross,
    "cross_5": lambda: cross(5),
    "comb": comb,
    "star": star,
    "star_7": lambda: star(7, 0.7),
    "sliver": sliver,
    "polygon": lambda: polygon_random(3),
    "circle": circle,
    "circle_3": lambda: circle(3),
    "ellipse": ellipse,
    "ellipse_4": lambda: ellipse(3.0, 1.0, 4, 0.3),
    "ellipse_flat": lambda: ellipse(5.0, 0.5),
    "stadium": stadium,
    "rounded_rectangle": rounded_rectangle,
    "rounded_square": lambda: rounded_rectangle(2.0, 2.0, 0.3),
    "half_disc": half_disc,
    "annulus": annulus,
    "annulus_thin": lambda: annulus(0.99),
    "eccentric_ring": lambda: annulus(0.3, 0.35),
    "square_round_hole": square_round_hole,
    "lens": lens,
    "arc_lens": arc_lens,
    "parabola_cap": parabola_cap,
    "gear": gear,
    "keyhole": keyhole,
    "dumbbell": dumbbell,
    "pipe_bend": pipe_bend,
    "heart": heart,
    "thorn": thorn,
    "lens_one_edge": lens_one_edge,
    "square_one_edge": square_one_edge,
    "kidney": kidney,
    "blob": lambda: smooth(1),
    "blob_holes": lambda: smooth(2, 12, 5),
    "spiral": spiral,
    "mixed": lambda: star_shaped(4),
    "line_arc": lambda: star_shaped(5, 11, "la"),
    "mixed_holes": lambda: star_shaped(6, 9, "lacq", 3),
    "hole_grid": hole_grid,
    "plate": plate,
}
