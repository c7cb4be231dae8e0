"""Large members of families: certified, with the counts that their construction gives."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from mat_core import Domain, MedialAxis, medial_axis, pipeline
from tests.families import bezier, comb, gear, hole_grid, line, ngon, plate, polar, polygon_hole, polyline, shape, star

Json = dict[str, Any]


def solve(shaped: Json) -> MedialAxis:
    """Certified, or an error."""
    return medial_axis(Domain.from_dict({"outer": shaped["outer"], "holes": shaped["holes"]}))


def counts(axis: MedialAxis) -> tuple[int, int, int]:
    """(leaves, branch points, cycles)."""
    branches = int((axis.runs.node_kind == 0).sum())
    return len(axis.runs.node_kind) - branches, branches, axis.runs.cycles


def wave(edges: int, per_turn: int, height: float, width: float) -> Json:
    """A corridor between two sine waves of smooth cubic edges, one above the other."""
    steps = edges // 2 - 1
    rate = 2.0 * math.pi / per_turn

    def wall(offset: float) -> list[Json]:
        t = np.arange(steps + 1.0)
        point = np.column_stack((t, offset + height * np.sin(rate * t)))
        third = np.column_stack((np.ones_like(t), height * rate * np.cos(rate * t))) / 3.0
        return [bezier([tuple(p), tuple(p + d), tuple(q - e), tuple(q)])
                for p, d, q, e in zip(point, third, point[1:], third[1:], strict=False)]

    lower = wall(0.0)
    upper = [{**e, "control_points": e["control_points"][::-1]} for e in wall(width)[::-1]]
    ends = [line(lower[-1]["control_points"][-1], upper[0]["control_points"][0]),
            line(upper[-1]["control_points"][-1], lower[0]["control_points"][0])]
    return shape("wave", [*lower, ends[0], *upper, ends[1]])


def coast(doublings: int, seed: int = 1) -> Json:
    """An octagon whose sides are broken at a displaced middle, again and again."""
    rng = np.random.default_rng(seed)
    points = np.array([polar(1.0, math.pi * i / 4) for i in range(8)])
    for _ in range(doublings):
        side = np.roll(points, -1, axis=0) - points
        middle = points + 0.5 * side + rng.uniform(-0.18, 0.18, (len(points), 1)) * np.column_stack((-side[:, 1], side[:, 0]))
        points = np.stack((points, middle), axis=1).reshape(-1, 2)
    return shape("coast", polyline([(float(x), float(y)) for x, y in points]))


def cluster(count: int, seed: int = 1) -> Json:
    """A corner of a square crowded with small square holes."""
    rng = np.random.default_rng(seed)
    side = math.ceil(math.sqrt(count))
    holes = []
    for i in range(count):
        x, y = ((divmod(i, side) + rng.uniform(0.3, 0.7, 2)) * 50.0 / side).tolist()
        radius, turn = float(rng.uniform(5.0, 14.0)) / side, float(rng.uniform(0.0, 1.5))
        holes.append(polygon_hole([polar(radius, turn + 0.5 * math.pi * j, (100.0 + x, 700.0 + y)) for j in range(4)]))
    return shape("cluster", polyline([(0.0, 0.0), (1000.0, 0.0), (1000.0, 1000.0), (0.0, 1000.0)]), holes)


def square_spiral(turns: int) -> Json:
    """A corridor of width 1.2 around itself, four straight sides a turn."""
    steps = 4 * turns
    heading = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])[np.arange(steps) % 4]
    path = np.vstack(((0.0, 0.0), np.cumsum(heading * (2.0 + 2.0 * (np.arange(steps) // 2))[:, None], axis=0)))
    normal = np.column_stack((-heading[:, 1], heading[:, 0]))
    left = path + 0.6 * (np.vstack((normal, np.zeros(2))) + np.vstack((np.zeros(2), normal)))
    right = 2.0 * path - left
    return shape("square_spiral", polyline([(float(x), float(y)) for x, y in np.vstack((right, left[::-1]))]))


def ellipse_polygon(n: int) -> Json:
    """One face of n arcs: the axis has a spine with a rib to every vertex."""
    return shape("ellipse_polygon", polyline([(2.0 * x, y) for x, y in (polar(1.0, 2.0 * math.pi * i / n) for i in range(n))]))


def cog(teeth: int) -> Json:
    """A gear without a bore: all roots of its teeth lie on the inscribed circle."""
    return {**gear(teeth), "holes": []}


CASES = {
    "comb": (lambda: comb(500), (1002, 1000, 0)),
    "star": (lambda: star(300, 0.8), (300, 1, 0)),
    "ngon": (lambda: ngon(2000), (2000, 1, 0)),
    "gear": (lambda: gear(400), (800, 800, 1)),
    "cog": (lambda: cog(500), (1000, 501, 0)),
    "cog_fine": (lambda: cog(2500), (5000, 2501, 0)),
    "hole_grid": (lambda: hole_grid(16, 16), (4, 289, 256)),
    "plate": (lambda: plate(16, 16), (4, 289, 256)),
    "wave": (lambda: wave(2000, 8, 0.5, 1.0), (4, 2, 0)),
    "wave_long": (lambda: wave(2000, 100, 1.0, 2.0), None),
    "coast": (lambda: coast(9), None),
    "cluster": (lambda: cluster(300), (4, 602, 300)),
    "square_spiral": (lambda: square_spiral(150), (603, 601, 0)),
    "ellipse_polygon": (lambda: ellipse_polygon(2000), (2000, 999, 0)),
}


@pytest.mark.parametrize("name", CASES)
def test_large_shapes_are_certified(name: str) -> None:
    build, expected = CASES[name]
    shaped = build()
    axis = solve(shaped)
    found = counts(axis)
    if expected is not None:
        assert found == expected
    assert found[2] == len(shaped["holes"])


def test_convex_vertices_of_a_large_polygon_are_its_leaves() -> None:
    shaped = coast(10)
    points = np.array([e["control_points"][0] for e in shaped["outer"]])
    side = np.roll(points, -1, axis=0) - points
    before = np.roll(side, 1, axis=0)
    convex = int((before[:, 0] * side[:, 1] - before[:, 1] * side[:, 0] > 0.0).sum())
    assert counts(solve(shaped))[0] == convex


@pytest.mark.parametrize("n", [5000, 20000])
def test_regular_polygon_of_many_sides(n: int) -> None:
    """Its branch points may be told apart by rounding, but all lie at the centre."""
    axis = solve(ngon(n))
    inner = axis.skeleton.disc[axis.runs.node_disc[axis.runs.node_kind == 0]]
    centre = -axis.table.origin * axis.table.scale
    assert len(axis.runs.node_kind) - len(inner) == n
    assert np.hypot(*(inner[:, :2] - centre).T).max() < 1e-9
    assert axis.runs.cycles == 0


@pytest.mark.parametrize("flat", [1.0, 0.6, 0.1])
@pytest.mark.parametrize(("n", "shortest"), [(30, 1e-6), (100, 1e-6), (400, 1e-5), (1500, 1e-4), (10000, 1e-2)])
def test_convex_polygons_pass_on_the_first_rung(n: int, shortest: float, flat: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Sides of very different lengths on an ellipse, some shorter than what they turn by: nothing ties, each vertex is a leaf."""
    monkeypatch.setattr(pipeline, "LADDER", pipeline.LADDER[:1])
    for seed in range(3):
        gap = 10.0 ** np.random.default_rng((n, seed)).uniform(math.log10(shortest), 0.0, n)
        t = np.cumsum(gap) * (2.0 * math.pi / gap.sum())
        axis = solve(shape("convex", polyline([(float(x), float(y)) for x, y in zip(np.cos(t), flat * np.sin(t), strict=True)])))
        leaves, branches, cycles = counts(axis)
        assert leaves == n
        assert branches > 0
        assert cycles == 0


def test_regular_polygon_of_65000_passes_on_the_first_rung(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sides beside the one walked along tell their disc by 1e-16 over the square of their distance: that is how they tie."""
    monkeypatch.setattr(pipeline, "LADDER", pipeline.LADDER[:1])
    assert counts(solve(ngon(65000)))[0] == 65000
