"""The picture: well-formed, self-contained, upright, complete."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from scipy.spatial import cKDTree

from mat_core.formats.svg import render_result
from tests.curves.shapes import solved
from tests.formats.test_beziers import distances

NS = {"svg": "http://www.w3.org/2000/svg"}
SHAPES = ("rectangle", "ell", "annulus", "circle", "mixed", "blob_holes", "stadium")


def drawn(name: str, width: int = 640) -> ET.Element:
    return ET.fromstring(solved(name).to_svg(width))


@pytest.mark.parametrize("name", SHAPES)
def test_well_formed_and_complete(name: str) -> None:
    axis = solved(name)
    root = drawn(name)
    nodes = [c for c in root.iterfind("svg:circle", NS) if c.get("class", "").startswith("node")]
    assert len(nodes) == len(axis.nodes)
    assert {c.get("class", "").split()[1] for c in nodes} == {n.kind for n in axis.nodes}
    boundary = next(p for p in root.iterfind("svg:path", NS) if p.get("class") == "boundary")
    assert boundary.get("d", "").count("M") == 1 + len(axis.domain.holes)
    assert bool(axis.segments) == any(p.get("class") == "axis" for p in root.iterfind("svg:path", NS))


@pytest.mark.parametrize("name", [*SHAPES, "ellipse", "spiral"])
def test_everything_is_inside_the_picture(name: str) -> None:
    root = drawn(name)
    w, h = float(root.get("width", "0")), float(root.get("height", "0"))
    assert max(w, h) == pytest.approx(640)
    for path in root.iterfind("svg:path", NS):
        points = np.vstack([piece for run in traced(path.get("d", "")) for piece in run])
        assert points.min() >= 0
        assert (points.max(axis=0) <= (w, h)).all()


def traced(d: str) -> list[list[np.ndarray]]:
    """The path as points: for each sub-path, nine on each of its commands."""
    runs: list[list[np.ndarray]] = []
    t = np.linspace(0.0, 1.0, 9)[:, None]
    at = start = np.zeros(2)
    for letter, text in re.findall(r"([MLQCAZ])([^MLQCAZ]*)", d):
        numbers = np.array([float(v) for v in text.split()])
        if letter == "M":
            at = start = numbers
            runs.append([at[None]])
            continue
        if letter == "A":
            runs[-1].append(arc_points(at, numbers, t))
        else:
            corners = np.vstack((at, start if letter == "Z" else numbers.reshape(-1, 2)))
            p = len(corners) - 1
            runs[-1].append(sum(math.comb(p, i) * t**i * (1 - t) ** (p - i) * c for i, c in enumerate(corners)))
        at = runs[-1][-1][-1]
    return runs


def arc_points(start: np.ndarray, numbers: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Points of an arc command of less than half a turn, by the standard's own construction."""
    radius, _, turn, large, sweep, *end = numbers.tolist()
    assert (turn, large) == (0.0, 0.0)
    chord = np.array(end) - start
    half = 0.5 * np.hypot(*chord)
    reach = math.sqrt(max(radius**2 - half**2, 0.0)) * (1.0 if sweep else -1.0)
    centre = start + 0.5 * chord + reach * np.array([-chord[1], chord[0]]) / (2 * half)
    a = math.atan2(*(start - centre)[::-1])
    b = math.atan2(*(end - centre)[::-1])
    angle = a + ((b - a + math.pi) % (2 * math.pi) - math.pi) * t[:, 0]
    return centre + max(radius, half) * np.column_stack((np.cos(angle), np.sin(angle)))


@pytest.mark.parametrize("name", [*SHAPES, "ellipse", "spiral", "lens", "gear", "keyhole", "flat_arcs"])
def test_the_boundary_is_within_a_few_hundredths_of_a_pixel(name: str) -> None:
    axis = solved(name)
    root = drawn(name)
    (d,) = (p.get("d", "") for p in root.iterfind("svg:path", NS) if p.get("class") == "boundary")
    runs = traced(d)
    scale = (640 - 32) / axis.domain.size
    corner = np.array([axis.domain.bbox[0], axis.domain.bbox[3]])
    for run, loop in zip(runs, (axis.domain.outer, *axis.domain.holes), strict=True):
        dense = np.vstack([edge.evaluate(np.linspace(*edge.domain, 400)) for edge in loop])
        pixels = (dense - corner) * scale * (1, -1) + 16
        assert distances(np.vstack(run), np.vstack((pixels, pixels[:1]))).max() < 0.06


@pytest.mark.parametrize("name", ["ell", "annulus", "mixed", "blob_holes", "ellipse", "mixed_holes", "gear"])
def test_the_axis_is_within_a_few_hundredths_of_a_pixel(name: str) -> None:
    axis = solved(name)
    scale = (640 - 32) / axis.domain.size
    corner = np.array([axis.domain.bbox[0], axis.domain.bbox[3]])
    count = 200
    segment = np.repeat(np.arange(len(axis.segments)), count)
    dense = axis.evaluate(segment, np.tile(np.linspace(0.0, 1.0, count), len(axis.segments)))[:, :2]
    tree = cKDTree((dense - corner) * scale * (1, -1) + 16)
    spacing = scale * axis.lengths.max() / count
    points = [p for path in drawn(name).iterfind("svg:path", NS) if path.get("class") == "axis"
              for run in traced(path.get("d", "")) for p in run]  # fmt: skip
    away, _ = tree.query(np.vstack(points))
    assert np.sqrt(np.maximum(away**2 - spacing**2, 0.0)).max() < 0.1


def test_no_reference_leaves_the_file() -> None:
    text = solved("mixed").to_svg().replace(NS["svg"], "")
    assert not re.search(r"https?:|href|url\(|@import|<script", text)


def test_y_points_up() -> None:
    axis = solved("ell")
    root = drawn("ell")
    pixels = {}
    for circle in root.iterfind("svg:circle", NS):
        title = circle.find("svg:title", NS)
        if title is not None and title.text:
            pixels[int(title.text.split(":")[0].removeprefix("node "))] = float(circle.get("cy", "0"))
    top = max(axis.nodes, key=lambda n: n.point[1])
    assert pixels[top.id] == min(pixels.values())


def test_true_curves_where_svg_has_them() -> None:
    text = solved("parabola_cap").to_svg()
    boundary = re.search(r'class="boundary" d="([^"]*)"', text)
    assert boundary is not None
    assert "Q" in boundary.group(1)


def test_arcs_are_arcs_and_no_longer_than_a_quarter_turn() -> None:
    root = drawn("annulus")
    (d,) = (p.get("d", "") for p in root.iterfind("svg:path", NS) if p.get("class") == "boundary")
    assert re.sub(r"[^A-Z]", "", d) == "MAAAAZMAAAAZ"


@pytest.mark.parametrize("name", ["rectangle_thin", "annulus", "gear", "plate", "circle"])
def test_some_discs_are_shown_but_no_crowd(name: str) -> None:
    discs = [c for c in drawn(name).iterfind("svg:circle", NS) if c.get("class") == "disc"]
    assert len(discs) <= 12
    assert discs or name == "rectangle_thin"


def test_strokes_are_thin_where_the_domain_is() -> None:
    width = {name: float(re.findall(r"\.axis{.*stroke-width:([\d.]+)", solved(name).to_svg())[0]) for name in
             ("rectangle", "rectangle_thin")}  # fmt: skip
    assert 0.5 < width["rectangle_thin"] < width["rectangle"] == 2.0


def test_a_notebook_shows_the_picture() -> None:
    axis = solved("ell")
    assert axis._repr_svg_() == axis.to_svg(480)


def test_paths_are_drawn_even_outside_of_the_domain() -> None:
    """Closed ones are filled, open ones are not; none at all leaves the boundary."""
    axis = solved("rectangle")
    sides, ring = axis.domain.outer, solved("circle").domain.outer
    root = ET.fromstring(render_result(axis, [ring, sides, sides[:2], []], "A < B", 640))
    drawn = {p.get("class", ""): p.get("d", "") for p in root.iterfind("svg:path", NS)}
    assert (drawn["result"].count("M"), drawn["result"].count("Z")) == (2, 2)
    assert (drawn["result line"].count("M"), drawn["result line"].count("Z")) == (1, 0)
    points = np.vstack([piece for d in drawn.values() for run in traced(d) for piece in run])
    assert points.min() >= 0
    assert (points.max(axis=0) <= (float(root.get("width", "0")), float(root.get("height", "0")))).all()
    lines = ET.fromstring(render_result(axis, [ring], fill=False))
    assert [p.get("d", "")[-1] for p in lines.iterfind("svg:path", NS) if p.get("class") == "result line"] == ["Z"]
    bare = ET.fromstring(render_result(axis, []))
    assert {p.get("class") for p in bare.iterfind("svg:path", NS)} == {"fill", "boundary"}
