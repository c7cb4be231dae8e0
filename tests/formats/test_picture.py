"""Pictures in layers: well-formed, in order, where they should be."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from mat_core import Domain, UnsupportedOption
from mat_core.analysis import offset
from mat_core.formats.picture import SCALE_STEPS, Picture
from mat_core.formats.svg import colour_scale
from mat_core.outlines import circle, polygon
from tests.curves.shapes import solved

SVG = "{http://www.w3.org/2000/svg}"
PLATE = Domain.from_dict({"outer": polygon([(0, 0), (6, 0), (6, 4), (0, 4)]), "holes": [circle((2, 2), 1)]})
WIDTH = 632  # pixels, of which 600 for the domain: 100 a unit
SIZE = (632, 432)


def tree(picture: Picture) -> ET.Element:
    return ET.fromstring(picture.to_svg())


def test_an_empty_picture_is_the_domain() -> None:
    root = tree(Picture(PLATE, WIDTH))
    assert (float(root.get("width", "")), float(root.get("height", ""))) == SIZE
    (path,) = root
    assert path.get("fill-rule") == "evenodd"
    assert path.get("d", "").count("M") == 2


@pytest.mark.parametrize("name", ["rectangle", "ell", "annulus", "circle", "mixed", "blob_holes"])
def test_every_layer_of_every_shape(name: str) -> None:
    axis = solved(name)
    inside = offset(axis, 0.02 * axis.domain.size)
    rows = axis.node_discs if len(axis.nodes) else axis.evaluate(np.zeros(3, dtype=int), np.array([0.0, 0.3, 0.6]))[:, :3]
    x, y = np.linspace(*axis.domain.bbox[::2], 11), np.linspace(*axis.domain.bbox[1::2], 7)
    picture = Picture(axis.domain).region(label="all").region(inside.paths).field(x, y, np.add.outer(y, x), label="field")
    picture.axis(axis).discs(rows).brush(rows).lines([[s.curve] for s in axis.segments]).boundary()
    root = tree(picture)
    assert [e.tag.removeprefix(SVG) for e in root][:8] == ["path", "path", "path", "clipPath", "g", "g", "g", "g"]
    assert len(root.findall(f"{SVG}g/{SVG}text")) == 2


def test_discs_and_strokes_are_where_they_are() -> None:
    root = tree(Picture(PLATE, WIDTH).discs([[4.5, 1, 0.5]]).brush([[3.5, 1, 0.2], [5.5, 1, 0.4]]).brush([4, 3, 0.3]))
    (circle_,) = root.iter(f"{SVG}circle")
    assert [float(circle_.get(k, "")) for k in ("cx", "cy", "r")] == [466.0, 316.0, 50.0]
    strokes = [(p.get("stroke-width"), p.get("d")) for g in root.findall(f"{SVG}g") for p in g.findall(f"{SVG}path")]
    assert strokes == [("60.00", "M366 316L566 316"), ("60.00", "M416 116L416 116")]


def test_a_path_of_points() -> None:
    root = tree(Picture(PLATE, WIDTH).lines([np.array([[0, 0], [6, 4], [6, 0]]), np.zeros((1, 2)), np.empty((0, 2))]))
    assert [p.get("d") for p in root.findall(f"{SVG}path")][1] == "M16 416L616 16 616 416"


def test_nothing_to_draw_is_no_layer() -> None:
    assert len(tree(Picture(PLATE).lines([]).region([]))) == 1


def test_curves_outside_get_room() -> None:
    outward = offset(solved("rectangle"), -1.0)
    domain = solved("rectangle").domain
    picture = Picture(domain, WIDTH, around=outward.paths).lines(outward.paths)
    numbers = [float(v) for v in re.findall(r"-?\d+\.?\d*", tree(picture).findall(f"{SVG}path")[1].get("d", ""))]
    assert min(numbers) >= 0.0
    assert picture.frame.scale < Picture(domain, WIDTH).frame.scale


def test_a_field_has_a_cell_for_each_value_and_holes_are_left_out() -> None:
    values = np.array([[0.0, 1.0, 1.0], [math.nan, 0.5, 0.0]])
    root = tree(Picture(PLATE, WIDTH).field([1, 3, 5], [1, 3], values))
    cells = {p.get("fill"): p.get("d") for group in root.findall(f"{SVG}g") for p in group}
    colours = colour_scale(SCALE_STEPS)
    assert cells == {
        colours[0]: "M16.0 416.0h200.5v-200.5h-200.5zM416.0 216.0h200.5v-200.5h-200.5z",
        colours[-1]: "M216.0 416.0h400.5v-200.5h-400.5z",
        colours[SCALE_STEPS // 2]: "M216.0 216.0h200.5v-200.5h-200.5z",
    }
    clip = next(root.iter(f"{SVG}clipPath"))
    outer, hole = (sub for sub in re.split(r"(?=M)", clip[0].get("d", "")) if sub)
    assert "L" in outer
    assert re.findall(r"A\S+ \S+ 0 0 (\d)", hole) == ["1"] * 4  # on the screen the outer loop runs with sweep 0


def test_equal_values_are_one_colour() -> None:
    root = tree(Picture(PLATE).field([0, 3, 6], [0, 4], np.ones((2, 3))))
    assert len([p for g in root.findall(f"{SVG}g") for p in g]) == 1


def test_labels_are_told_under_the_picture_and_wrap() -> None:
    picture = Picture(PLATE, WIDTH)
    for i in range(12):
        picture.lines([PLATE.outer], label=f"line <{i}>")
    root = tree(picture)
    texts = [e.text for e in root.iter(f"{SVG}text")]
    assert texts == [f"line <{i}>" for i in range(12)]
    places = [tuple(map(float, re.findall(r"[\d.]+", e.get("transform", "")))) for e in root.findall(f"{SVG}g")]
    assert all(y > SIZE[1] for _, y in places)
    assert len({y for _, y in places}) == 3
    assert float(root.get("height", "")) > max(y for _, y in places) + 10


@pytest.mark.parametrize(("x", "y", "values"), [
    ([0, 1], [0, 1], [[1, 2]]), ([0], [0, 1], [[1], [2]]), ([[0, 1]], [0, 1], [[1, 2], [3, 4]]),
    ([0, 1], [0, 1], [[math.nan] * 2] * 2),
])
def test_faults_of_a_field(x: list[float], y: list[float], values: list[list[float]]) -> None:
    with pytest.raises(UnsupportedOption) as refusal:
        Picture(PLATE).field(x, y, values)
    assert refusal.value.option == "values"


@pytest.mark.parametrize("rows", [[[1, 2]], [[1, 2, math.nan]], [[[1, 2, 3]]]])
def test_faults_of_discs(rows: list[list[float]]) -> None:
    for draw in (Picture(PLATE).discs, Picture(PLATE).brush):
        with pytest.raises(UnsupportedOption):
            draw(rows)


def test_a_picture_is_saved_and_shown(tmp_path: Path) -> None:
    picture = Picture(PLATE).boundary()
    picture.save(tmp_path / "plate.svg")
    assert (tmp_path / "plate.svg").read_text(encoding="utf-8") == picture.to_svg() == picture._repr_svg_()
