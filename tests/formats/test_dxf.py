"""The drawing, read back by ezdxf: the same curves to rounding, on their layers, and nothing to repair."""

from __future__ import annotations

import builtins
import io
from collections import Counter
from typing import Any

import ezdxf
import numpy as np
import pytest

from mat_core import MedialAxis, UnsupportedOption
from mat_core.formats.dxf import COLOURS, to_dxf
from mat_core.model.curve import RationalBSpline
from tests.curves.shapes import solved

SHAPES = ("rectangle", "ell", "annulus", "circle", "mixed", "blob_holes", "mixed_holes", "square_one_edge", "ellipse", "gear",
          "flat_arcs", "keyhole", "spiral")  # fmt: skip
EXACT = 1e-12  # of the size
T = np.linspace(0.0, 1.0, 41)


def read(text: str) -> Any:
    return ezdxf.read(io.StringIO(text))


def on(drawing: Any, layer: str) -> list[Any]:
    return [entity for entity in drawing.modelspace() if entity.dxf.layer == layer]


def off(entity: Any, points: np.ndarray, u: np.ndarray) -> float:
    """Largest distance of points of a curve, at its parameters u, from an entity."""
    if entity.dxftype() == "SPLINE":
        tool = entity.construction_tool()
        return float(np.abs(np.array([tuple(tool.point(v))[:2] for v in u.tolist()]) - points).max())
    if entity.dxftype() == "LINE":
        a, b = np.array(entity.dxf.start)[:2], np.array(entity.dxf.end)[:2]
        share = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        return float(np.hypot(*(a + share[:, None] * (b - a) - points).T).max())
    away = points - np.array(entity.dxf.center)[:2]
    error = float(np.abs(np.hypot(*away.T) - entity.dxf.radius).max())
    if entity.dxftype() == "ARC":
        turned = (np.degrees(np.arctan2(away[:, 1], away[:, 0])) - entity.dxf.start_angle + 1e-7) % 360.0
        assert turned.max() <= (entity.dxf.end_angle - entity.dxf.start_angle) % 360.0 + 2e-7
        ends = np.array([tuple(entity.start_point)[:2], tuple(entity.end_point)[:2]])
        gaps = np.linalg.norm(ends[:, None] - points[[0, -1]], axis=2)
        error = max(error, float(gaps.min(axis=1).max()))
    return error


def compare(entities: list[Any], curves: list[RationalBSpline], size: float) -> None:
    """Every curve is an entity, or one for each side of a polyline, in order."""
    waiting = iter(entities)
    for curve in curves:
        u = curve.domain[0] + T * (curve.domain[1] - curve.domain[0])
        sides = len(curve.control_points) - 1 if curve.degree == 1 else 1
        if sides == 1:
            assert off(next(waiting), curve.evaluate(u), u) <= EXACT * size
            continue
        for a, b in zip(curve.control_points, curve.control_points[1:], strict=False):
            assert off(next(waiting), a + T[:, None] * (b - a), T) <= EXACT * size
    assert next(waiting, None) is None


def centres(axis: MedialAxis) -> list[RationalBSpline]:
    return [RationalBSpline(s.degree, s.knots, s.control_points, s.weights) for s in axis.segments]


@pytest.mark.parametrize("name", SHAPES)
def test_everything_comes_back(name: str) -> None:
    axis = solved(name)
    drawing = read(axis.to_dxf())
    report = drawing.audit()
    assert not report.errors
    assert not report.fixes
    assert drawing.units == 0
    compare(on(drawing, "boundary"), [e for loop in (axis.domain.outer, *axis.domain.holes) for e in loop], axis.domain.size)
    compare(on(drawing, "axis"), centres(axis), axis.domain.size)
    points = [tuple(entity.dxf.location)[:2] for entity in on(drawing, "nodes")]
    assert points == [node.point for node in axis.nodes]
    assert {entity.dxf.layer for entity in drawing.modelspace()} <= set(COLOURS)


@pytest.mark.parametrize(
    ("name", "layer", "kinds"),
    [
        ("rectangle", "boundary", {"LINE": 4}),
        ("square_one_edge", "boundary", {"LINE": 4}),
        ("circle", "boundary", {"CIRCLE": 1}),
        ("annulus", "axis", {"CIRCLE": 1}),
        ("stadium", "boundary", {"LINE": 2, "ARC": 4}),
        ("gear", "boundary", {"LINE": 24, "ARC": 24, "CIRCLE": 1}),
        ("ellipse", "boundary", {"SPLINE": 1}),
        ("pipe_bend", "axis", {"LINE": 4, "ARC": 1}),
    ],
)
def test_kinds_of_entities(name: str, layer: str, kinds: dict[str, int]) -> None:
    found = Counter(entity.dxftype() for entity in on(read(solved(name).to_dxf()), layer))
    if name == "pipe_bend":
        assert found["ARC"] == kinds["ARC"]
    else:
        assert found == kinds


def test_splines_keep_weights_and_clamped_knots_bit_for_bit() -> None:
    axis = solved("ellipse")
    (edge,) = axis.domain.outer
    (spline,) = on(read(axis.to_dxf()), "boundary")
    assert list(spline.knots) == edge.knots.tolist()
    assert list(spline.weights) == edge.weights.tolist()
    assert [list(p)[:2] for p in spline.control_points] == edge.control_points.tolist()
    assert spline.dxf.flags & spline.RATIONAL
    assert spline.dxf.degree == 2


@pytest.mark.parametrize("layer", ["offset", "centerline"])
def test_further_curves_have_their_layer(layer: str) -> None:
    axis = solved("rectangle")
    ring = [axis.domain.outer, solved("circle").domain.outer]
    drawing = read(to_dxf(axis, ring, layer))
    assert Counter(entity.dxftype() for entity in on(drawing, layer)) == {"LINE": 4, "CIRCLE": 1}
    assert not drawing.audit().errors


@pytest.mark.parametrize(
    ("own", "layers"),
    [
        (None, {"boundary", "offset"}),
        ((), {"offset"}),
        (("axis", "nodes"), {"axis", "nodes", "offset"}),
        (tuple(COLOURS), {*COLOURS, "offset"}),
    ],
)
def test_a_result_is_drawn_over_the_boundary_unless_told_otherwise(own: tuple[str, ...] | None, layers: set[str]) -> None:
    axis = solved("ell")
    drawing = read(to_dxf(axis, [axis.domain.outer], own=own))
    assert {entity.dxf.layer for entity in drawing.modelspace()} == layers
    assert {layer.dxf.name for layer in drawing.layers} >= layers
    assert not {layer.dxf.name for layer in drawing.layers} & (COLOURS.keys() - layers)
    # an empty result is a result
    assert {entity.dxf.layer for entity in read(to_dxf(axis, [])).modelspace()} == {"boundary"}


def test_layers_that_are_none() -> None:
    with pytest.raises(UnsupportedOption, match="own"):
        to_dxf(solved("ell"), own=("axes",))


def test_one_axis_one_text() -> None:
    axis = solved("mixed")
    assert axis.to_dxf() == axis.to_dxf()


def test_without_ezdxf_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    without(monkeypatch, "ezdxf")
    with pytest.raises(ImportError, match=r"mat-core\[dxf\]"):
        solved("rectangle").to_dxf()


def without(monkeypatch: pytest.MonkeyPatch, package: str) -> None:
    """Let imports of a package fail."""
    real = builtins.__import__

    def refuse(name: str, *args: Any, **kwargs: Any) -> Any:
        if name.split(".")[0] == package:
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", refuse)


def test_paths_by_layer_keep_their_order() -> None:
    axis = solved("ell")
    first, second = ([[edge] for edge in axis.domain.outer[i : i + 2]] for i in (2, 0))
    drawing = read(to_dxf(axis, {"deep": first, "shallow": second, "none": []}))
    compare(on(drawing, "deep"), [c for path in first for c in path], axis.domain.size)
    compare(on(drawing, "shallow"), [c for path in second for c in path], axis.domain.size)
    assert [e.dxf.layer for e in drawing.modelspace()][-4:] == ["deep", "deep", "shallow", "shallow"]
