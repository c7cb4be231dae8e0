"""Families after what people draw in their trades: gears, wings, boards, plans, coasts, foams, lettering.

As in `draw`: a random generator says the domain, which is valid by construction and of size about one.
"""

from __future__ import annotations

import gzip
import json
import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.spatial import Voronoi
from shapely.geometry import Polygon

from tests import families as F
from tests.families import Edge, Json, Point
from tests.hunt.curves import hermite
from tests.hunt.reduce import joined
from tests.transforms import rotated, scaled, shifted

Rng = np.random.Generator
OUTLINES = Path(__file__).parents[1] / "corpus" / "outlines.jsonl.gz"
PRESSURE = math.radians(20.0)  # pressure angle of gears


def _decades(rng: Rng, low: float, high: float) -> float:
    return float(10.0 ** rng.uniform(low, high))


def ring_of(points: Sequence[Point], edges: Sequence[Edge | None]) -> list[Edge]:
    """A loop of edges, with lines from each point to the next where None is given."""
    around = [*points[1:], points[0]]
    return joined([F.line(a, b) if e is None else e for a, b, e in zip(points, around, edges, strict=True)])


# Machines ------------------------------------------------------------------------------------------------------------
def involute_gear(seed: int, rng: Rng) -> Json:
    """A spur gear with involute flanks as cubic B-splines, which start without speed on the base circle, and a keyed bore."""
    teeth = int(rng.integers(8, 40))
    base = math.cos(PRESSURE)
    half = math.pi / (2 * teeth) + math.tan(PRESSURE) - PRESSURE  # half a tooth, at the base circle
    root, tip = base * float(rng.uniform(0.9, 0.98)), 1.0 + 1.6 / teeth
    roll = np.linspace(0.0, math.sqrt((tip / base) ** 2 - 1.0), int(rng.integers(3, 8)))
    flank = base * np.column_stack([np.cos(roll) + roll * np.sin(roll), np.sin(roll) - roll * np.cos(roll)])
    speed = base * roll[:, None] * np.column_stack([np.cos(roll), np.sin(roll)])
    edges: list[Edge] = []
    for i in range(teeth):
        a, b = 2 * math.pi * i / teeth - half, 2 * math.pi * i / teeth + half
        rise = hermite(flank @ _turn(a).T, speed @ _turn(a).T, roll)
        fall = hermite(_mirror(flank[::-1]) @ _turn(b).T, -_mirror(speed[::-1]) @ _turn(b).T, roll[-1] - roll[::-1])
        swing = float(roll[-1] - math.atan(roll[-1]))
        edges += [F.line(F.polar(root, a), F.polar(base, a)), rise, F.arc((0.0, 0.0), tip, a + swing, b - swing), fall]
        edges += [F.line(F.polar(base, b), F.polar(root, b)), F.arc((0.0, 0.0), root, b, a + 2 * math.pi / teeth)]
    return {"outer": joined(edges), "holes": [keyed_bore(0.4 * root, float(rng.uniform(0.1, 0.6)))]}


def _turn(angle: float) -> F.Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


def _mirror(points: F.Floats) -> F.Floats:
    return np.asarray(points * np.array([1.0, -1.0]))


def keyed_bore(radius: float, width: float) -> list[Edge]:
    """A bore with a keyway, `width` of its radius wide."""
    angle = math.asin(0.5 * width)
    stops = np.linspace(angle, 2 * math.pi - angle, 5)
    arcs = [F.arc((0.0, 0.0), radius, float(a), float(b)) for a, b in pairwise(stops)]
    x, y = 1.2 * radius, radius * 0.5 * width
    key = [F.polar(radius, -angle), (x, -y), (x, y), F.polar(radius, angle)]
    return joined([*arcs, *(F.line(a, b) for a, b in pairwise(key))])


def airfoil(seed: int, rng: Rng) -> Json:
    """A wing's section with round holes in it, or a cascade of them in a channel; trailing edges sharp or blunt."""
    thickness, camber = float(rng.uniform(0.06, 0.24)), float(rng.uniform(0.0, 0.06))
    blunt = bool(rng.random() < 0.5)
    if seed % 2:
        pitch, count = thickness + _decades(rng, -4, -0.5), int(rng.integers(1, 5))
        foils = [_foil(thickness, camber, blunt, (0.0, i * pitch)) for i in range(count)]
        low, high = -thickness - 0.2, (count - 1) * pitch + thickness + 0.2
        return {"outer": F.polyline([(-0.3, low), (1.4, low), (1.4, high), (-0.3, high)]), "holes": foils}
    spars = [((x, camber * (1 - (2 * x - 1) ** 2)), 0.25 * thickness * math.sqrt(1.2 - x)) for x in (0.2, 0.35, 0.5)]
    holes = [F.circle_hole(place, radius) for place, radius in spars]
    return {"outer": _foil(thickness, camber, blunt, (0.0, 0.0)), "holes": holes[: int(rng.integers(0, 4))]}


def _foil(thickness: float, camber: float, blunt: bool, place: Point) -> list[Edge]:
    """NACA's thickness about a parabola, as one smooth cubic B-spline round the nose; x = (1 - cos b) / 2."""
    b = np.linspace(math.pi, -math.pi, 31)
    root, x = np.sin(0.5 * b), np.sin(0.5 * b) ** 2
    last = -0.1015 if blunt else -0.1036
    side = np.sign(b) + (b == 0)
    y = 5 * thickness * (0.2969 * root + side * (-0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 + last * x**4))
    dx = root * np.cos(0.5 * b)
    slope = 0.2969 * 0.5 * np.cos(0.5 * b)
    dy = 5 * thickness * (slope + side * dx * (-0.126 - 2 * 0.3516 * x + 3 * 0.2843 * x**2 + 4 * last * x**3))
    y, dy = y + 4 * camber * x * (1 - x), dy + 4 * camber * (1 - 2 * x) * dx
    if not blunt:
        y[0] = y[-1] = 0.0
    edge = hermite(np.column_stack([place[0] + x, place[1] + y]), -np.column_stack([dx, dy]), -b)
    ends = edge["control_points"][-1], edge["control_points"][0]
    return joined([edge, F.line(*ends)] if blunt else [edge])


def board(seed: int, rng: Rng) -> Json:
    """A circuit board: round corners, drill holes, slots, and pads with thermal reliefs."""
    columns, rows = int(rng.integers(2, 5)), int(rng.integers(1, 4))
    holes: list[list[Edge]] = []
    wall = _decades(rng, -4, -1.3)
    for place in [(i + 0.5, j + 0.5) for i in range(columns) for j in range(rows)]:
        kind, turn = int(rng.integers(0, 4)), float(rng.choice([0.0, math.pi / 2, rng.uniform(0, 3)]))
        if kind == 1:
            holes.append(F.circle_hole(place, float(rng.uniform(0.05, 0.5 - wall))))
        elif kind == 2:
            reach = 0.5 - wall
            radius = float(rng.uniform(0.02, 0.4)) * reach
            holes.append(_slot(place, 2 * (reach - radius), radius, turn))
        elif kind == 3:
            holes += _relief(place, float(rng.uniform(0.15, 0.3)), 0.5 - wall, _decades(rng, -3, -0.3), turn)
    plate = F.rounded_rectangle(float(columns), float(rows), 0.3)
    middle = 0.5 * columns, 0.5 * rows
    outer = shifted({"outer": plate["outer"]}, middle[0] - _middle(plate, 0), middle[1] - _middle(plate, 1))["outer"]
    return scaled({"outer": outer, "holes": holes}, 1.0 / columns)


def _middle(shape: Json, axis: int) -> float:
    values = [p[axis] for e in shape["outer"] for p in e["control_points"]]
    return float(0.5 * (min(values) + max(values)))


def _slot(place: Point, length: float, radius: float, turn: float) -> list[Edge]:
    shape = F.stadium(length, radius)
    centred = shifted({"outer": shape["outer"]}, -_middle(shape, 0), -_middle(shape, 1))
    return list(shifted(rotated(centred, turn), *place)["outer"])


def _relief(place: Point, inner: float, outer: float, spoke: float, turn: float) -> list[list[Edge]]:
    """Four sectors of a ring, with spokes between them, and the drill hole."""
    holes = [F.circle_hole(place, 0.6 * inner)]
    for k in range(4):
        a, b = turn + math.pi / 2 * (k + 0.5 * spoke), turn + math.pi / 2 * (k + 1 - 0.5 * spoke)
        corners = [F.polar(inner, a, place), F.polar(outer, a, place), F.polar(outer, b, place), F.polar(inner, b, place)]
        holes.append(ring_of(corners, [None, F.arc(place, outer, a, b), None, F.arc(place, inner, b, a)]))
    return holes


# Land and buildings --------------------------------------------------------------------------------------------------
def floor_plan(seed: int, rng: Rng) -> Json:
    """The walls of a house: rooms are holes, walls between them equally thin."""
    wall = _decades(rng, -4, -1.7)
    rooms, width, height = [], 1.0, float(rng.uniform(0.5, 1.0))
    waiting = [(0.0, 0.0, width, height)]
    while waiting:
        x0, y0, x1, y1 = waiting.pop()
        long = max(x1 - x0, y1 - y0)
        if long < 0.2 or (long < 0.5 and rng.random() < 0.3):
            rooms.append((x0 + wall / 2, y0 + wall / 2, x1 - wall / 2, y1 - wall / 2))
            continue
        f = float(rng.choice([0.5, rng.uniform(0.35, 0.65)]))
        if x1 - x0 == long:
            waiting += [(x0, y0, x0 + f * long, y1), (x0 + f * long, y0, x1, y1)]
        else:
            waiting += [(x0, y0, x1, y0 + f * long), (x0, y0 + f * long, x1, y1)]
    holes = [F.polygon_hole([(a, b), (c, b), (c, d), (a, d)]) for a, b, c, d in rooms]
    w = wall / 2
    return {"outer": F.polyline([(-w, -w), (width + w, -w), (width + w, height + w), (-w, height + w)]), "holes": holes}


def coast(seed: int, rng: Rng) -> Json:
    """A fractal shore round a lake with islands."""
    islands: list[tuple[float, float, float]] = []
    for _ in range(int(rng.integers(0, 12))):
        r, (x, y) = float(rng.uniform(0.02, 0.15)), rng.uniform(-0.4, 0.4, 2)
        clear = all(math.hypot(x - a, y - b) > 1.01 * (r + s) for a, b, s in islands)
        if clear and math.hypot(x, y) + r < 0.59:
            islands.append((float(x), float(y), r))
    outer = F.polyline(_shore(rng, int(rng.integers(5, 9)), 0.6, 1.0))
    shores = [_shore(rng, int(rng.integers(3, 7)), 0.5, 1.0) for _ in islands]
    holes = [[(x + r * a, y + r * b) for a, b in shore] for (x, y, r), shore in zip(islands, shores, strict=True)]
    return {"outer": outer, "holes": [F.polygon_hole(h) for h in holes]}


def _shore(rng: Rng, halvings: int, low: float, high: float) -> list[Point]:
    """A star-shaped polygon whose radius is the sum of noise of ever shorter waves."""
    radii = rng.uniform(0, 1, 4)
    for step in range(halvings):
        middles = 0.5 * (radii + np.roll(radii, -1)) + 0.6**step * rng.uniform(-0.5, 0.5, len(radii))
        radii = np.column_stack([radii, middles]).ravel()
    radii = low + (high - low) * (radii - radii.min()) / np.ptp(radii)
    return [F.polar(float(r), 2 * math.pi * i / len(radii)) for i, r in enumerate(radii)]


def foam(seed: int, rng: Rng) -> Json:
    """Cells of a foam as holes, the walls between them of one thickness, down to 2e-6."""
    half = _decades(rng, -6, -2.3)
    points = rng.uniform(0, 1, (int(rng.integers(3, 40)), 2))
    mirrors = [([1, 1], [0, 0]), ([-1, 1], [0, 0]), ([-1, 1], [2, 0]), ([1, -1], [0, 0]), ([1, -1], [0, 2])]  # in the four sides
    cells = Voronoi(np.vstack([points * flip + shift for flip, shift in mirrors]))
    holes = []
    for i in range(len(points)):
        whole = Polygon(cells.vertices[cells.regions[cells.point_region[i]]])
        cell = whole.buffer(-half, join_style="mitre", mitre_limit=100.0)
        if isinstance(cell, Polygon) and cell.area > 1e-3 / len(points):
            holes.append(F.polygon_hole([(float(x), float(y)) for x, y in cell.exterior.normalize().coords[:-1]][::-1]))
    return {"outer": F.polyline([(-half, -half), (1 + half, -half), (1 + half, 1 + half), (-half, 1 + half)]), "holes": holes}


# Lettering -----------------------------------------------------------------------------------------------------------
def lettering(seed: int, rng: Rng) -> Json:
    """Glyphs and icons cut into a round plate, along a circle."""
    with gzip.open(OUTLINES, "rt", encoding="utf-8") as lines:
        shapes = [json.loads(row)["outer"] for row in lines]
    count = int(rng.integers(3, 11))
    room = math.sin(math.pi / count) / (1 + math.sin(math.pi / count))  # radius that each has round its middle
    holes = []
    for i in range(count):
        shape = {"outer": shapes[int(rng.integers(len(shapes)))]}
        points = np.array([p for e in shape["outer"] for p in e["control_points"]])
        middle = 0.5 * (points.min(0) + points.max(0))
        size = float(np.linalg.norm(points - middle, axis=1).max())
        shape = scaled(shifted(shape, -middle[0], -middle[1]), (1 - 0.5 * _decades(rng, -3, -1)) * room / size)
        holes.append(list(rotated(shifted(shape, 1 - room, 0.0), 2 * math.pi * i / count)["outer"]))
    return {"outer": [F.conic_loop(1.001, 1.001)], "holes": holes}


TRADES: dict[str, Callable[[int, Rng], Json]] = {
    f.__name__: f for f in (involute_gear, airfoil, board, floor_plan, coast, foam, lettering)
}
