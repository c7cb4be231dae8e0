"""Random domains judged by shapely on a fine flattening, and outlines of real fonts.

A flattening of N chords an edge cannot see what happens within its first and last chord; there alone the exact answer
may differ, and then it must be a refusal.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from mat_core.errors import InvalidDomain, Problem
from mat_core.model.domain import Domain
from tests.model.builders import Json, bezier, codes, domain

shapely = pytest.importorskip("shapely")

CHORDS = 200


def flattened(loop: list[Json]) -> np.ndarray:
    t = np.linspace(0, 1, CHORDS, endpoint=False)[:, None]
    points = []
    for edge in loop:
        p = edge["degree"]
        weights = np.array(edge.get("weights", [1.0] * (p + 1)))
        basis = np.column_stack([math.comb(p, j) * t**j * (1 - t) ** (p - j) for j in range(p + 1)]) * weights
        points.append(basis @ np.array(edge["control_points"]) / basis.sum(axis=1, keepdims=True))
    return np.vstack(points)


def random_loop(rng: np.random.Generator, centre: np.ndarray, radius: float, wild: float) -> list[Json]:
    count = int(rng.integers(3, 7))
    angles = np.sort(rng.random(count)) * 2 * math.pi
    corners = [centre + radius * (1 + wild * rng.normal()) * np.array([math.cos(a), math.sin(a)]) for a in angles]
    loop = []
    for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
        degree = int(rng.integers(1, 5))
        inner = [a + (b - a) * j / degree + wild * radius * rng.normal(size=2) for j in range(1, degree)]
        weights = [1.0, *np.exp(rng.normal(size=degree - 1)), 1.0] if rng.random() < 0.4 else None
        loop.append(bezier(a, *inner, b, weights=weights))
    return loop


def verdict(outer: list[Json], holes: list[list[Json]]) -> tuple[Domain | None, tuple[Problem, ...]]:
    try:
        return Domain.from_dict(domain(outer, *holes)), ()
    except InvalidDomain as error:
        return None, error.problems


def expected_codes(outer: shapely.Polygon, holes: list[shapely.Polygon]) -> set[str]:
    if not all(loop.is_valid for loop in (outer, *holes)):
        return {"self-intersection"}
    found = set()
    for i, hole in enumerate(holes):
        if hole.disjoint(outer) or hole.contains(outer):
            found.add("hole-outside")
        elif not outer.contains_properly(hole):
            found.add("loops-cross")
        for other in holes[:i]:
            if other.contains(hole) or hole.contains(other):
                found.add("hole-in-hole")
            elif other.intersects(hole):
                found.add("loops-cross")
    return found


@pytest.mark.parametrize("seed", range(6))
def test_random_domains(seed: int) -> None:
    rng = np.random.default_rng(seed)
    accepted = 0
    for _ in range(150):
        wild = float(rng.choice([0.05, 0.2, 0.5]))
        outer = random_loop(rng, np.zeros(2), 1.0, wild)
        holes = [random_loop(rng, rng.normal(size=2) * 0.4, 0.2, wild) for _ in range(rng.integers(0, 3))]
        polygons = [shapely.Polygon(flattened(loop)) for loop in (outer, *holes)]
        expected = expected_codes(polygons[0], polygons[1:])
        found, problems = verdict(outer, holes)
        if found is None:
            unseen = {p.code for p in problems if p.u is not None and min(p.u % 1, -p.u % 1) < 2 / CHORDS}
            # Loops that meet themselves are no longer asked whether they meet others or where they lie.
            if "self-intersection" in expected:
                assert "self-intersection" in codes(problems)
            else:
                assert expected <= codes(problems) <= expected | unseen
            continue
        assert expected == set()
        accepted += 1
        area = polygons[0].area - sum(p.area for p in polygons[1:])
        assert found.area == pytest.approx(area, rel=2e-3)
        assert found.bbox == pytest.approx(polygons[0].bounds, abs=2e-3)
        for polygon, loop, reverse in zip(polygons, range(9), found.arrays.reversed, strict=False):
            assert reverse == (shapely.is_ccw(polygon.exterior) == (loop > 0))
    assert accepted > 15


def contours(glyphs: object, name: str) -> list[list[Json]]:
    """The closed contours of a glyph as loops of lines, quadratics and cubics."""
    pens = pytest.importorskip("fontTools.pens.recordingPen")
    quadratics = pytest.importorskip("fontTools.pens.basePen").decomposeQuadraticSegment
    pen = pens.DecomposingRecordingPen(glyphs)
    glyphs[name].draw(pen)  # type: ignore[index]
    loops: list[list[Json]] = []
    here = start = (0.0, 0.0)
    for operator, points in pen.value:
        if operator == "moveTo":
            loops.append([])
            here = start = points[0]
        elif operator == "qCurveTo" and points[-1] is not None:
            for handle, end in quadratics(points):
                loops[-1].append(bezier(here, handle, end))
                here = end
        elif operator in ("lineTo", "curveTo"):
            if operator == "curveTo" or points[-1] != here:
                loops[-1].append(bezier(here, *points))
            here = points[-1]
        elif operator in ("closePath", "endPath") and here != start:
            loops[-1].append(bezier(here, start))
    return [loop for loop in loops if loop]


@pytest.mark.parametrize("font", ["DejaVuSans", "DejaVuSerif-Italic", "STIXGeneral", "STIXGeneralBol", "cmmi10"])
def test_glyphs_of_real_fonts(font: str) -> None:
    """Letters, digits and signs are valid; a quarter of all others is judged as shapely does."""
    matplotlib = pytest.importorskip("matplotlib")
    ttf = pytest.importorskip("fontTools.ttLib").TTFont(Path(matplotlib.get_data_path()) / "fonts/ttf" / f"{font}.ttf")
    glyphs = ttf.getGlyphSet()
    names = ttf.getGlyphOrder()
    seen = 0
    for name in [*names[4:100], *names[100:1500:11]]:
        loops = contours(glyphs, name)
        if any(len(loop) < 2 for loop in loops):
            continue
        polygons = [shapely.Polygon(flattened(loop)) for loop in loops]
        inside = [p.representative_point() if p.is_valid else None for p in polygons]
        for i, outer in enumerate(polygons):
            depth = sum(p.contains(inside[i]) for p in polygons if p is not outer and inside[i] is not None)
            if depth % 2 or inside[i] is None:
                continue
            own = [k for k, q in enumerate(polygons) if q is not outer and inside[k] is not None and outer.contains(q)]
            nested = [k for k in own if not any(polygons[j].contains(polygons[k]) for j in own if j != k)]
            expected = expected_codes(outer, [polygons[k] for k in nested])
            found, problems = verdict(loops[i], [loops[k] for k in nested])
            seen += 1
            if found is None and not expected:
                assert all(min(p.u % 1, -p.u % 1) < 2 / CHORDS for p in problems if p.u is not None), name
            else:
                assert (found is None) == bool(expected), (name, problems)
    assert seen > 70
