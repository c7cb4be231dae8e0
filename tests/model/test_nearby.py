"""The search for pieces that may meet: it leaves nothing out, and it does not look at every pair."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import shapely

from mat_core.kernels.bezier import restrict
from mat_core.kernels.meeting import compare
from mat_core.kernels.nearby import TREE_WIDTH
from mat_core.kernels.outline import CP0, DEG, LOOP, XMIN, YMAX
from mat_core.model.loop import Outline, arranged, halved, tree_rows
from mat_core.model.problems import check
from mat_core.model.reading import CONTROL_POINT_LIMIT
from tests.model.builders import SQUARE, Json, accept, bezier, circle, codes, domain, mapped, polygon, rectangle, refuse


def outline_of(outer: list[Json], *holes: list[Json]) -> Outline:
    return check(domain(outer, *holes), CONTROL_POINT_LIMIT).outline


def petals(count: int, turn: float) -> list[Json]:
    """A closed chain of cubics with deep bays, turned."""
    angles = np.linspace(0, 2 * math.pi, count + 1)
    corners = [(math.cos(a), math.sin(a)) for a in angles[:-1]]
    loop = []
    for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
        loop.append(bezier((ax, ay), (0.3 * ax, 0.3 * ay), (0.3 * bx, 0.3 * by), (bx, by)))
    return mapped(loop, 1.0, turn=turn)


def comb(teeth: int, turn: float) -> list[Json]:
    """A square comb, turned."""
    corners: list[tuple[float, float]] = []
    for i in range(teeth):
        corners += [(i, 0), (i + 0.5, 0), (i + 0.5, teeth), (i + 1, teeth)]
    return mapped(polygon(*corners[:-1], (teeth, 1.1 * teeth), (0, 1.1 * teeth)), 1.0, turn=turn)


def star(spikes: int) -> list[Json]:
    angles = np.arange(2 * spikes) * math.pi / spikes
    return polygon(*[(r * math.cos(a), r * math.sin(a)) for a, r in zip(angles, [1, 0.2] * spikes, strict=True)])


def spiral_of_arcs(turns: int) -> list[Json]:
    """A band between two spirals of quarter circles."""

    def run(radius: float) -> list[Json]:
        arcs = []
        for k in range(4 * turns):
            start = k % 4 * math.pi / 2
            x = 0.0 if k % 4 < 2 else 0.5
            (ax, ay), (bx, by) = [(radius * math.cos(a), radius * math.sin(a)) for a in (start, start + math.pi / 2)]
            points = [(x + ax, ay), (x + ax + bx, ay + by), (x + bx, by)]
            arcs.append(bezier(*points, weights=[1, math.sqrt(0.5), 1]))
            radius += 0.5 * (k % 2)
        return arcs

    inner, outer = run(2.0), [edge | {"control_points": edge["control_points"][::-1]} for edge in run(2.5)[::-1]]

    def link(a: Json, b: Json) -> Json:
        return bezier(a["control_points"][-1], b["control_points"][0])

    return [*inner, link(inner[-1], outer[0]), *outer, link(outer[-1], inner[0])]


def neighbours_first(outline: Outline) -> np.ndarray:
    return arranged(outline.pf[:, XMIN : YMAX + 1], outline.piece_start)


def compared(outline: Outline, gap: float, piece: np.ndarray, part: np.ndarray) -> tuple[np.ndarray, int]:
    """The tasks of pairs of parts within `gap`, and how many pairs of nodes were looked at."""
    tree, tasks, hits = np.empty((tree_rows(len(piece)), TREE_WIDTH)), np.empty((100_000, 8)), np.empty((256, 5))
    _, planned, looked = compare(
        outline.pi, outline.pf, outline.cp, outline.piece_start, gap, 0.0, 0.0, piece, part, tree,
        np.empty((256, 2), dtype=np.int64), 0, False, outline.work, outline.stack, tasks, hits,
    )  # fmt: skip
    return tasks[:planned], looked


@pytest.mark.parametrize("halvings", [0, 2])
@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_no_pair_is_left_out(turn: float, halvings: int) -> None:
    outline = outline_of(petals(9, turn), *[mapped(circle(x, 0.05, 0.02), 1.0) for x in (0.1, -0.1, 0.0, 0.05)])
    piece = neighbours_first(outline)
    part = np.tile((0.0, 1.0), (len(piece), 1))
    for _ in range(halvings):
        piece, part = halved(piece, part, outline.pi[piece, DEG] > 1)
    # A gap as wide as a wall, so that there is much to find.
    gap = 0.05
    tasks, _ = compared(outline, gap, piece, part)
    listed = {tuple(row) for row in tasks[:, :6].tolist()}
    assert 10 < len(listed) == len(tasks)
    hulls = []
    for k in range(len(piece)):
        first, degree = outline.pi[piece[k], CP0], outline.pi[piece[k], DEG]
        restrict(outline.cp, first, degree, *part[k], outline.work, 0)
        hulls.append(shapely.MultiPoint(outline.work[: degree + 1, :2]).convex_hull)
    for a, b in itertools.product(range(len(piece)), repeat=2):
        i, j = int(piece[a]), int(piece[b])
        loop = outline.pi[i, LOOP]
        start, end = outline.piece_start[loop : loop + 2]
        if i >= j or (loop == outline.pi[j, LOOP] and (j == i + 1 or (i == start and j == end - 1))):
            continue
        if hulls[a].distance(hulls[b]) <= gap:
            assert (float(i), *part[a].tolist(), *part[b].tolist(), float(j)) in listed


@pytest.mark.parametrize("loop", [comb(500, 0.5), comb(500, 1.1), star(1000)])
def test_slanted_pieces_do_not_all_look_near(loop: list[Json]) -> None:
    outline = outline_of(loop)
    order = neighbours_first(outline)
    _, looked = compared(outline, outline.frame.gap, order, np.tile((0.0, 1.0), (len(order), 1)))
    assert len(order) < looked < 60 * len(order)


def test_the_order_of_holes_does_not_matter() -> None:
    holes = [rectangle(i, j, i + 0.6, j + 0.6) for i in range(20) for j in range(20)]
    shuffled = [holes[k] for k in np.random.default_rng(3).permutation(400)]
    outer = rectangle(-1, -1, 21, 21)
    assert accept(outer, *shuffled).area == pytest.approx(accept(outer, *holes).area, rel=1e-13)
    (problem,) = refuse(outer, *shuffled, rectangle(5.8, 5.8, 5.9, 5.9 + 1e-9), rectangle(5.89, 5.7, 5.95, 5.75), SQUARE)[:1]
    assert problem.code in {"loops-touch", "loops-cross", "hole-in-hole"}


@pytest.mark.parametrize("turns", [3, 30, 150])
def test_a_spiral_of_arcs_is_not_too_complex(turns: int) -> None:
    band = spiral_of_arcs(turns)
    accept(band)
    # One hole on the wall, seen whatever the parts are.
    x, y = band[5]["control_points"][2]
    assert codes(refuse(band, circle(x, y, 0.01))) == {"loops-cross"}
