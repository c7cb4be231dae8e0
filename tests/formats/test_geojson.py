"""GeoJSON: the form of RFC 7946, and chords that keep their promise."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
import shapely

from mat_core import UnsupportedOption
from tests.curves.shapes import solved
from tests.formats.test_beziers import distances

SHAPES = ("rectangle", "ell", "annulus", "circle", "mixed", "blob_holes", "mixed_holes", "square_one_edge", "lens", "gear")


def layers(content: dict[str, Any], layer: str) -> list[dict[str, Any]]:
    return [feature for feature in content["features"] if feature["properties"]["layer"] == layer]


@pytest.mark.parametrize("name", SHAPES)
def test_the_form(name: str) -> None:
    axis = solved(name)
    content = axis.to_geojson()
    assert json.loads(json.dumps(content, allow_nan=False)) == content
    assert content["type"] == "FeatureCollection"
    assert "not longitude" in content["coordinate_space"]
    ids = [feature["id"] for feature in content["features"]]
    assert len(set(ids)) == len(ids) == 1 + len(axis.segments) + len(axis.nodes)
    for feature in content["features"]:
        assert set(feature) == {"type", "id", "geometry", "properties"}
        assert shapely.from_geojson(json.dumps(feature["geometry"])).is_valid


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("name", SHAPES)
def test_the_boundary_is_the_domain(name: str, tolerance: float) -> None:
    axis = solved(name)
    content = axis.to_geojson(tolerance)
    (feature,) = layers(content, "boundary")
    rings = feature["geometry"]["coordinates"]
    assert len(rings) == 1 + len(axis.domain.holes)
    assert content["flattening_tolerance"] == tolerance * axis.domain.size
    for number, (ring, edges) in enumerate(zip(rings, (axis.domain.outer, *axis.domain.holes), strict=True)):
        corners = np.array(ring)
        assert len(ring) >= 4
        assert ring[0] == ring[-1]
        assert shapely.LinearRing(corners).is_ccw == (number == 0)
        points = np.vstack([edge.evaluate(np.linspace(*edge.domain, 40)) for edge in edges])
        assert distances(points, corners).max() <= content["flattening_tolerance"] * (1 + 1e-9) + 1e-14
    polygon = shapely.from_geojson(json.dumps(feature["geometry"]))
    assert abs(polygon.area - axis.domain.area) <= tolerance * axis.domain.size * polygon.length


@pytest.mark.parametrize("tolerance", [1e-2, 1e-5])
@pytest.mark.parametrize("name", SHAPES)
def test_segments_with_their_radii(name: str, tolerance: float) -> None:
    axis = solved(name)
    content = axis.to_geojson(tolerance)
    features = layers(content, "segment")
    assert len(features) == len(axis.segments)
    for segment, feature in zip(axis.segments, features, strict=True):
        told = feature["properties"]
        assert (told["id"], told["kind"]) == (segment.id, segment.kind)
        assert (told["start_node"], told["end_node"]) == (segment.start_node, segment.end_node)
        assert (told["length"], told["max_error"]) == (segment.length, segment.max_error)
        corners = np.column_stack((feature["geometry"]["coordinates"], told["radii"]))
        assert distances(segment.evaluate(np.linspace(0, 1, 60)), corners).max() <= tolerance * axis.domain.size * (1 + 1e-9)
        if segment.kind == "line" and segment.degree == 1:
            assert len(corners) == 2


@pytest.mark.parametrize("name", SHAPES)
def test_nodes(name: str) -> None:
    axis = solved(name)
    found = [(f["geometry"]["coordinates"], f["properties"]) for f in layers(axis.to_geojson(), "node")]
    told = [(list(n.point), {"layer": "node", "id": n.id, "kind": n.kind, "radius": n.radius}) for n in axis.nodes]
    assert found == told


def test_few_chords() -> None:
    """A circle within e of its size needs pi / sqrt(4 e) chords at the least; twice as many are allowed."""
    (boundary,) = layers(solved("circle").to_geojson(1e-4), "boundary")
    least = np.pi / np.sqrt(4e-4)
    assert least <= len(boundary["geometry"]["coordinates"][0]) - 1 <= 2 * least


@pytest.mark.parametrize("tolerance", [0.0, 1e-10, 0.2, float("nan"), -1.0])
def test_a_tolerance_out_of_range(tolerance: float) -> None:
    with pytest.raises(UnsupportedOption, match="tolerance"):
        solved("rectangle").to_geojson(tolerance)
