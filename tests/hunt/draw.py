"""Families of random domains that are valid by construction; a family's name and a seed say one domain, anywhere.

Outlines are star-shaped about the origin: control points whose polar angles rise make curves whose angles rise (variation
diminution, for positive weights, too), so nothing crosses itself. Shapes have size about one.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np

from tests import families as F
from tests.families import Edge, Json, Point
from tests.hunt import noise
from tests.hunt.curves import CURVES
from tests.hunt.reduce import joined
from tests.hunt.trades import TRADES
from tests.transforms import bezier_pieces, insert_knot

Rng = np.random.Generator


def _plain(outer: list[Edge], holes: list[list[Edge]] | None = None) -> Json:
    return {"outer": outer, "holes": holes or []}


def _pick(rng: Rng, low: int, high: int) -> int:
    """A whole number, both ends included."""
    return int(rng.integers(low, high + 1))


def _decades(rng: Rng, low: float, high: float) -> float:
    """A number whose logarithm is uniform between two powers of ten."""
    return float(10.0 ** rng.uniform(low, high))


# Splines -------------------------------------------------------------------------------------------------------------
def closed_spline(points: F.Floats, degree: int) -> Edge:
    """The closed uniform B-spline of a degree as one clamped edge, as smooth where it closes as elsewhere."""
    n = len(points)
    ring = points[np.arange(-1, n + degree - 1) % n]
    edge: Edge = {"degree": degree, "control_points": ring.tolist(), "knots": [float(i) for i in range(-degree, n + degree + 1)]}
    for u in [0.0] * (degree - 1) + [float(n)] * (degree - 1):
        edge = insert_knot(edge, u)
    inner = edge["control_points"][degree - 1 : len(edge["control_points"]) - degree + 1]
    inner[-1] = inner[0]
    return {
        "degree": degree,
        "control_points": inner,
        "knots": [0.0] * (degree + 1) + [float(i) for i in range(1, n)] + [float(n)] * (degree + 1),
    }


def smooth(seed: int, rng: Rng) -> Json:
    """A closed smooth spline of degree 2 to 5, as one edge or as its Bezier pieces."""
    n, degree = _pick(rng, 5, 16), _pick(rng, 2, 5)
    angles = 2 * math.pi * (np.arange(n) + rng.uniform(-0.3, 0.3, n)) / n
    radii = rng.uniform(_pick(rng, 3, 9) / 10, 1.2, n)
    edge = closed_spline(np.column_stack([radii * np.cos(angles), radii * np.sin(angles)]), degree)
    return _plain(joined(bezier_pieces(edge)) if seed % 2 else [edge])


def smooth_holes(seed: int, rng: Rng) -> Json:
    """Cubic blobs in a cubic blob."""
    shaped = F.smooth(int(rng.integers(1 << 30)), _pick(rng, 8, 14), 1 + seed % 6)
    return _plain(shaped["outer"], shaped["holes"])


def _wedge_spline(rng: Rng, a: Point, b: Point, spread: float) -> Edge:
    """A B-spline of degree 1 to 5 with up to four inner knots between two polar points (radius, angle); weights by `spread`."""
    degree, inner = _pick(rng, 1, 5), max(0, _pick(rng, -2, 4))
    count = degree + 1 + inner
    f = np.concatenate([[0.0], (np.arange(1, count - 1) + rng.uniform(-0.4, 0.4, count - 2)) / (count - 1), [1.0]])
    radii = a[0] + f * (b[0] - a[0])
    radii[1:-1] *= rng.uniform(0.7, 1.3, count - 2)
    points = [list(F.polar(float(r), float(t))) for r, t in zip(radii, a[1] + f * (b[1] - a[1]), strict=True)]
    knots = np.sort(rng.uniform(0.05, 0.95, inner))
    if inner > 1 and degree > 1 and rng.random() < 0.3:
        knots[1] = knots[0]
    ends = [0.0] * (degree + 1), [1.0] * (degree + 1)
    edge: Edge = {"degree": degree, "control_points": points, "knots": [*ends[0], *knots.tolist(), *ends[1]]}
    if spread:
        edge["weights"] = [_decades(rng, -spread, spread) for _ in points]
    return edge


def splines(seed: int, rng: Rng, spread: float = 0.0) -> Json:
    """Corners joined by B-splines of mixed degrees; weights within 10^-spread and 10^spread."""
    n = _pick(rng, 4, 9)
    angles = 2 * math.pi * (np.arange(n) + rng.uniform(0.25, 0.75, n)) / n
    polar = list(zip(rng.uniform(0.7, 1.2, n).tolist(), angles.tolist(), strict=True))
    around = [*polar[1:], (polar[0][0], polar[0][1] + 2 * math.pi)]
    return _plain(joined([_wedge_spline(rng, a, b, spread) for a, b in zip(polar, around, strict=True)]))


# Lines and arcs ------------------------------------------------------------------------------------------------------
def star_shaped(seed: int, rng: Rng, kinds: str) -> Json:
    """Lines, arcs, quadratics, cubics as in `tests.families`, with holes."""
    shaped = F.star_shaped(int(rng.integers(1 << 30)), _pick(rng, 5, 24), kinds, seed % 4)
    return _plain(shaped["outer"], shaped["holes"])


def polygon(seed: int, rng: Rng) -> Json:
    """A star-shaped polygon with random radii."""
    return _plain(F.polygon_random(int(rng.integers(1 << 30)), _pick(rng, 4, 60))["outer"])


def stairs(seed: int, rng: Rng) -> Json:
    """Right angles on an integer grid, steps above and below."""
    n = _pick(rng, 2, 9)
    top, low = rng.integers(1, 5, n), -rng.integers(0, 4, n)
    path = [(float(x), float(y)) for i, y in enumerate(low) for x, y in ((i, y), (i + 1, y))]
    path += [(float(x), float(top[i])) for i in range(n - 1, -1, -1) for x in (i + 1, i)]
    kept = [p for i, p in enumerate(path) if not _straight(path[i - 1], p, path[(i + 1) % len(path)])]
    return _plain(F.polyline(kept))


def _straight(a: Point, b: Point, c: Point) -> bool:
    return (b[0] - a[0]) * (c[1] - b[1]) == (b[1] - a[1]) * (c[0] - b[0])


def star(seed: int, rng: Rng) -> Json:
    """A regular star of random sharpness."""
    return _plain(F.star(_pick(rng, 3, 40), float(rng.uniform(0.05, 0.95)))["outer"])


def gear(seed: int, rng: Rng) -> Json:
    """A gear with a round bore."""
    shaped = F.gear(_pick(rng, 4, 40), float(rng.uniform(0.1, 0.7)))
    return _plain(shaped["outer"], shaped["holes"])


def comb(seed: int, rng: Rng) -> Json:
    """A comb with teeth of one width and gap, shallow to deep."""
    return _plain(F.comb(_pick(rng, 2, 30), float(rng.uniform(0.05, 0.95)), _decades(rng, -3, 1))["outer"])


def thin(seed: int, rng: Rng) -> Json:
    """Rectangles, triangles and ellipses up to a hundred thousand times longer than wide."""
    width = _decades(rng, -5, 0)
    return _plain([F.rectangle(1.0, width), F.sliver(width), F.ellipse(1.0, 0.99 * width)][seed % 3]["outer"])


# Holes ---------------------------------------------------------------------------------------------------------------
def clusters(seed: int, rng: Rng) -> Json:
    """Round and square holes of very different sizes, often hardly apart."""
    discs: list[tuple[float, float, float]] = []
    least = _decades(rng, -6, -1.5)
    for _ in range(_pick(rng, 2, 24)):
        r, (x, y) = _decades(rng, -2.5, -0.6), rng.uniform(-0.9, 0.9, 2)
        if discs and rng.random() < 0.6:  # right beside another one
            ox, oy, other = discs[_pick(rng, 0, len(discs) - 1)]
            x, y = F.polar(other + r + 2 * least, float(rng.uniform(0, 6.28)), (ox, oy))
        clear = all(math.hypot(x - a, y - b) > r + s + least for a, b, s in discs)
        if clear and max(abs(x), abs(y)) + r < 1 - least:
            discs.append((float(x), float(y), r))
    turns = [float(t) for t in rng.uniform(0, 1.5, len(discs))]
    holes = [
        F.circle_hole((x, y), r) if t < 1 else F.polygon_hole([F.polar(r, t + math.pi * i / 2, (x, y)) for i in range(4)])
        for (x, y, r), t in zip(discs, turns, strict=True)
    ]
    return _plain(F.polyline([(-1, -1), (1, -1), (1, 1), (-1, 1)]), holes)


def nested(seed: int, rng: Rng) -> Json:
    """C-shaped holes one inside another round a middle hole: long walls of equal thickness."""
    count = _pick(rng, 1, 4)
    band = 1.0 / (count + 1)
    holes = [F.circle_hole((0.0, 0.0), 0.4 * band)]
    for k in range(1, count + 1):
        low, high = (k - 0.25) * band, (k + float(rng.choice([0.25, rng.uniform(0.0, 0.4)]))) * band
        start, gap = float(rng.uniform(0, 6.28)), float(rng.uniform(0.2, 2.0))
        stops = [start + (2 * math.pi - gap) * i / 4 for i in range(5)]
        out = [F.arc((0.0, 0.0), low, a, b) for a, b in pairwise(stops)]
        back = [F.arc((0.0, 0.0), high, a, b) for a, b in pairwise(stops[::-1])]
        caps = [
            F.line(out[-1]["control_points"][-1], back[0]["control_points"][0]),
            F.line(back[-1]["control_points"][-1], out[0]["control_points"][0]),
        ]
        holes.append(joined([*out, caps[0], *back, caps[1]]))
    square = F.polyline([(-1.1, -1.1), (1.1, -1.1), (1.1, 1.1), (-1.1, 1.1)])
    return _plain([F.conic_loop(1.1, 1.1)] if seed % 2 else square, holes)


# Joints that are nearly smooth ---------------------------------------------------------------------------------------
def tangent_lines(seed: int, rng: Rng) -> Json:
    """A rectangle whose sides are chains of segments that turn by 1e-9 to 1e-3 rad."""
    corners = [(0.0, 0.0), (2.0, 0.0), (2.0, float(rng.choice([1.0, 2.0]))), (0.0, 0.0)]
    corners[3] = (0.0, corners[2][1])
    points: list[Point] = []
    for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
        n = _pick(rng, 1, 6)
        points.append((ax, ay))
        for i in range(1, n):
            off = _decades(rng, -9, -3) * float(rng.choice([-1.0, 1.0])) / (2 * n)
            points.append((ax + (bx - ax) * i / n - off * (by - ay), ay + (by - ay) * i / n + off * (bx - ax)))
    return _plain(F.polyline(points))


def tangent_cubics(seed: int, rng: Rng) -> Json:
    """The Bezier pieces of a smooth cubic, each beginning 1e-9 to 1e-3 rad beside the direction the one before ends with."""
    n = _pick(rng, 5, 12)
    corners = [F.polar(float(r), 2 * math.pi * i / n) for i, r in enumerate(rng.uniform(0.7, 1.2, n))]
    edges = joined(bezier_pieces(F.closed_spline(np.array(corners))))
    for e in edges:
        (ax, ay), (bx, by) = e["control_points"][:2]
        t = _decades(rng, -9, -3) * float(rng.choice([-1.0, 1.0]))
        c, s = math.cos(t), math.sin(t)
        e["control_points"][1] = [ax + c * (bx - ax) - s * (by - ay), ay + s * (bx - ax) + c * (by - ay)]
    return _plain(edges)


def tangent_arcs(seed: int, rng: Rng) -> Json:
    """A stadium or a rounded rectangle whose arcs swell 1e-9 to 1e-3 more or less than smoothly."""
    shaped = F.stadium(2.0) if seed % 2 else F.rounded_rectangle(3.0, 2.0, float(rng.uniform(0.1, 0.9)))
    edges = []
    for e in shaped["outer"]:
        if e["degree"] == 1:
            edges.append(e)
            continue
        bulge = math.tan(math.pi / 8) + _decades(rng, -9, -3) * float(rng.choice([-1.0, 1.0]))
        edges.append(F.arc_between(e["control_points"][0], e["control_points"][-1], bulge))
    return _plain(joined(edges))


# All of them ---------------------------------------------------------------------------------------------------------
FAMILIES: dict[str, Callable[[int, Rng], Json]] = {
    **{f"noise_{name}": partial(noise.noisy, maker) for name, maker in noise.SHAPES.items()},
    "smooth": smooth,
    "smooth_holes": smooth_holes,
    "splines": splines,
    "rationals": partial(splines, spread=3.0),
    "rationals_wide": partial(splines, spread=6.0),
    "rationals_mild": partial(splines, spread=0.7),
    "line_arc": partial(star_shaped, kinds="la"),
    "mixed": partial(star_shaped, kinds="laqc"),
    "polygon": polygon,
    "stairs": stairs,
    "star": star,
    "gear": gear,
    "comb": comb,
    "thin": thin,
    "clusters": clusters,
    "nested": nested,
    "tangent_lines": tangent_lines,
    "tangent_cubics": tangent_cubics,
    "tangent_arcs": tangent_arcs,
    **TRADES,
    **CURVES,
}


def draw(family: str, seed: int) -> Json:
    """The domain of a family and a seed."""
    return FAMILIES[family](seed, np.random.default_rng([zlib.crc32(family.encode()), seed]))
