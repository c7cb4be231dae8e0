"""Drawings are read curve for curve: areas in closed form, ends that are joined, and what is left out told."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

import mat_core
from mat_core.errors import UnreadableInput, UnsupportedOption
from mat_core.model.domain import Domain
from mat_core.outlines import Outlines, circle, from_dxf, polygon
from mat_core.outlines.dxf import clamped


@pytest.fixture
def drawing() -> Any:
    return ezdxf.new("R2010")


@pytest.fixture
def read(drawing: Any, tmp_path: Path) -> Any:
    def reader(**options: Any) -> Outlines:
        drawing.saveas(tmp_path / "drawing.dxf")
        return from_dxf(tmp_path / "drawing.dxf", **options)

    return reader


def areas(found: Outlines) -> list[float]:
    return [Domain.from_dict(d).area for d in found.domains]


def test_a_plate_with_holes(drawing: Any, read: Any) -> None:
    space = drawing.modelspace()
    space.add_lwpolyline([(0, 0), (60, 0), (60, 40), (0, 40)], close=True)
    space.add_circle((20, 20), 8)
    space.add_ellipse((45, 20), (6, 0), 0.5)
    found = read()
    assert areas(found) == pytest.approx([2400 - 64 * math.pi - 18 * math.pi], rel=1e-14)
    assert [len(d["holes"]) for d in found.domains] == [2]
    assert found.left_out == []


def test_bulges_are_arcs(drawing: Any, read: Any) -> None:
    """A bulge is the tangent of a quarter of the arc's angle: half a circle swells out, less than half a circle swells in."""
    angle = 4 * math.atan(0.5)
    drawing.modelspace().add_lwpolyline([(0, 0, 1), (4, 0, 0), (4, 3, -0.5), (0, 3, 0)], format="xyb", close=True)
    radius = 2 / math.sin(angle / 2)
    swell = 0.5 * radius**2 * (angle - math.sin(angle))
    assert areas(read()) == pytest.approx([12 + 2 * math.pi - swell], rel=1e-12)


def test_lines_and_arcs_in_any_order_and_direction(drawing: Any, read: Any) -> None:
    """A slot: two lines and two half circles, one line drawn backwards."""
    space = drawing.modelspace()
    space.add_line((0, 2), (6, 2))
    space.add_arc((6, 0), 2, 270, 90)
    space.add_line((0, -2), (6, -2))
    space.add_arc((0, 0), 2, 90, 270)
    found = read()
    assert areas(found) == pytest.approx([24 + 4 * math.pi], rel=1e-12)
    assert mat_core.medial_axis(Domain.from_dict(found.domains[0])).certificate["passed"]


@pytest.mark.parametrize(("miss", "joined"), [(1e-9, True), (9e-6, True), (1e-3, False)])
def test_ends_within_the_gap_are_joined(drawing: Any, read: Any, miss: float, joined: bool) -> None:
    space = drawing.modelspace()
    space.add_line((0, 0), (10, 0))
    space.add_line((10 + miss, 0), (5, 8))
    space.add_line((5, 8), (0, 0))
    found = read()
    assert len(found.domains) == joined
    assert len(found.left_out) == (0 if joined else 2)
    assert len(read(gap=1e-2).domains) == 1


def test_ends_where_several_meet_are_told(drawing: Any, read: Any) -> None:
    space = drawing.modelspace()
    for a, b in [((0, 0), (4, 0)), ((4, 0), (2, 3)), ((2, 3), (0, 0)), ((4, 0), (8, 0))]:
        space.add_line(a, b)
    found = read()
    assert found.domains == []
    assert [text.split(":")[0] for text in found.left_out] == ["3 ends meet at (4, 0)", "an end meets no other at (8, 0)"]


def test_splines_stay_what_they_are(drawing: Any, read: Any) -> None:
    points = [(0, 0, 0), (4, 0, 0), (5, 4, 0), (2, 6, 0), (-2, 3, 0), (0, 0, 0)]
    spline = drawing.modelspace().add_rational_spline(points, [1, 2, 1, 0.5, 1, 1], degree=3)
    (domain,) = read().domains
    (edge,) = domain["outer"]
    assert edge["degree"] == 3
    assert edge["weights"] == [1, 2, 1, 0.5, 1, 1]
    assert edge["knots"] == list(spline.construction_tool().knots())
    assert edge["control_points"] == [[x, y] for x, y, _ in points]


def test_periodic_splines_are_clamped(drawing: Any, read: Any) -> None:
    corners = [(0, 0, 0), (8, 0, 0), (8, 8, 0), (0, 8, 0), (-3, 4, 0)]
    spline = drawing.modelspace().add_spline()
    spline.set_closed(corners, degree=3)
    (domain,) = read().domains
    (edge,) = domain["outer"]
    assert edge["control_points"][0] == pytest.approx(edge["control_points"][-1], abs=1e-14)
    curve = Domain.from_dict(domain).loops[0][0]
    tool = spline.construction_tool()
    u = np.linspace(edge["knots"][0], edge["knots"][-1], 50)
    there = np.array([tuple(p)[:2] for p in tool.points(u)])
    assert np.allclose(curve.evaluate(u), there, atol=1e-13)


def test_clamping_leaves_a_clamped_curve_alone() -> None:
    knots, h = np.array([0.0, 0, 0, 1, 2, 2, 2]), np.array([[0.0, 0, 1], [1, 2, 1], [3, 2, 1], [4, 0, 1]])
    again, same = clamped(2, knots, h)
    assert again.tolist() == knots.tolist()
    assert same.tolist() == h.tolist()


def test_blocks_are_drawn_where_they_stand_and_stretched(drawing: Any, read: Any) -> None:
    block = drawing.blocks.new("WASHER")
    block.add_circle((0, 0), 2)
    block.add_circle((0, 0), 1)
    outer = drawing.blocks.new("PAIR")
    outer.add_blockref("WASHER", (0, 0))
    outer.add_blockref("WASHER", (10, 0), dxfattribs={"xscale": 2.0})
    drawing.modelspace().add_blockref("PAIR", (100, 0), dxfattribs={"rotation": 90})
    found = read()
    assert areas(found) == pytest.approx([3 * math.pi, 6 * math.pi], rel=1e-12)
    assert Domain.from_dict(found.domains[1]).bbox == pytest.approx((98, 6, 102, 14))


def test_blocks_that_multiply_are_refused(drawing: Any, read: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mat_core.outlines.dxf.MOST_BLOCKS", 1000)
    drawing.blocks.new("B0").add_circle((0, 0), 1)
    for i in range(12):
        block = drawing.blocks.new(f"B{i + 1}")
        block.add_blockref(f"B{i}", (0, 0))
        block.add_blockref(f"B{i}", (1, 0))
    drawing.modelspace().add_blockref("B12", (0, 0))
    with pytest.raises(UnreadableInput, match="more than 1000 references"):
        read()


def test_mirrored_entities_stand_where_they_are_seen(drawing: Any, read: Any) -> None:
    drawing.modelspace().add_circle((5, 0), 1, dxfattribs={"extrusion": (0, 0, -1)})
    assert Domain.from_dict(read().domains[0]).bbox == pytest.approx((-6, -1, -4, 1))


def test_layers(drawing: Any, read: Any) -> None:
    for i, name in enumerate(["cut", "mark", "off"]):
        drawing.layers.add(name)
        drawing.modelspace().add_circle((10 * i, 0), i + 1, dxfattribs={"layer": name})
    drawing.layers.get("off").off()
    assert areas(read()) == pytest.approx([math.pi, 4 * math.pi])
    assert read().left_out == ["1 of type CIRCLE, on layers that are not read"]
    assert areas(read(layers=["off"])) == pytest.approx([9 * math.pi])
    with pytest.raises(UnsupportedOption, match="layers: the drawing has no layer 'nope'; it has 0, Defpoints, cut, mark, off"):
        read(layers=["nope"])


def test_what_bounds_nothing_or_leaves_the_plane_is_told(drawing: Any, read: Any) -> None:
    space = drawing.modelspace()
    space.add_text("hi")
    space.add_point((0, 0))
    space.add_circle((0, 0), 1, dxfattribs={"extrusion": (1, 0, 0)})
    space.add_spline([(0, 0, 0), (1, 0, 1), (1, 1, 2)])
    assert sorted(read().left_out) == [
        "1 of type CIRCLE, not in the plane of the drawing",
        "1 of type POINT, which bounds nothing here",
        "1 of type SPLINE, not in the plane of the drawing",
        "1 of type TEXT, which bounds nothing here",
    ]


def test_our_own_drawings_come_back(tmp_path: Path) -> None:
    """What `to_dxf` writes as boundary is read as the same domain."""
    domain = Domain.from_dict({"outer": polygon([(0, 0), (6, 0), (6, 4), (0, 4)], rounding=1), "holes": [circle((3, 2), 0.5)]})
    (tmp_path / "own.dxf").write_text(mat_core.medial_axis(domain).to_dxf())
    (again,) = from_dxf(tmp_path / "own.dxf", layers=["boundary"]).domains
    assert Domain.from_dict(again).area == pytest.approx(domain.area, rel=1e-12)


@pytest.mark.parametrize("gap", [-1e-6, 0.1, math.nan])
def test_a_gap_out_of_range(tmp_path: Path, gap: float) -> None:
    with pytest.raises(UnsupportedOption, match="gap"):
        from_dxf(tmp_path / "any.dxf", gap=gap)


def test_what_is_no_drawing(tmp_path: Path) -> None:
    for name, content in [("a.dxf", b"no drawing"), ("b.dxf", b""), ("c.dxf", b"\x00\xff" * 50)]:
        (tmp_path / name).write_bytes(content)
        with pytest.raises(UnreadableInput, match=name):
            from_dxf(tmp_path / name)
    (tmp_path / "cut.dxf").write_text("0\nSECTION\n2\n")
    assert from_dxf(tmp_path / "cut.dxf") == Outlines()
    with pytest.raises(FileNotFoundError):
        from_dxf(tmp_path / "none.dxf")


@pytest.mark.parametrize("bulge", [1.0, -1.0])
def test_two_bulges_are_a_circle_either_way_round(drawing: Any, read: Any, bulge: float) -> None:
    drawing.modelspace().add_lwpolyline([(-2, 0, bulge), (2, 0, bulge)], format="xyb", close=True)
    assert areas(read()) == pytest.approx([4 * math.pi], rel=1e-14)
