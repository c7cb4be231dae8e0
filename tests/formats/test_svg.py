"""The picture: well-formed, self-contained, upright, complete."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import pytest

from tests.curves.shapes import solved

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


@pytest.mark.parametrize("name", SHAPES)
def test_everything_is_inside_the_picture(name: str) -> None:
    root = drawn(name)
    w, h = float(root.get("width", "0")), float(root.get("height", "0"))
    assert max(w, h) == pytest.approx(640)
    for path in root.iterfind("svg:path", NS):
        numbers = [float(v) for v in re.findall(r"-?[\d.]+", path.get("d", ""))]
        assert min(numbers) >= 0
        assert max(numbers[::2]) <= w
        assert max(numbers[1::2]) <= h


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
