"""GeoJSON: a domain for each polygon, wherever it stands; faults by JSON pointer."""

from __future__ import annotations

import json
from typing import Any

import pytest

from mat_core.errors import UnreadableInput
from mat_core.model.domain import Domain
from mat_core.outlines import from_geojson

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
HOLE = [[1, 1], [1, 2], [2, 2], [2, 1], [1, 1]]
LAKE = {"type": "Polygon", "coordinates": [SQUARE, HOLE]}
ISLES = {"type": "MultiPolygon", "coordinates": [[SQUARE], [[[9, 0, 5], [10, 0, 5], [10, 1, 5], [9, 0, 5]]]]}


def feature(geometry: Any, **members: Any) -> dict[str, Any]:
    return {"type": "Feature", "properties": None, "geometry": geometry, **members}


def areas(document: Any) -> list[float]:
    return [Domain.from_dict(d).area for d in from_geojson(document).domains]


def test_polygons_wherever_they_stand() -> None:
    assert areas(LAKE) == areas(json.dumps(LAKE)) == areas(json.dumps(LAKE).encode()) == pytest.approx([15])
    assert areas(ISLES) == pytest.approx([16, 0.5])
    assert areas(feature(LAKE)) == pytest.approx([15])
    features = [feature(LAKE), feature(None), feature(ISLES)]
    assert areas({"type": "FeatureCollection", "features": features}) == pytest.approx([15, 16, 0.5])
    assert areas({"type": "GeometryCollection", "geometries": [LAKE, LAKE]}) == pytest.approx([15, 15])


def test_names_are_those_of_features() -> None:
    features = [feature(LAKE, id=7), feature(ISLES, properties={"name": "Scilly"}), feature(LAKE)]
    found = from_geojson({"type": "FeatureCollection", "features": features})
    assert [d.get("name") for d in found.domains] == ["7", "Scilly#0", "Scilly#1", None]


def test_points_that_repeat_are_passed_over_and_rings_need_not_be_closed() -> None:
    (domain,) = from_geojson({"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [4, 0], [4, 4]]]}).domains
    assert [e["control_points"] for e in domain["outer"]] == [[[0, 0], [4, 0]], [[4, 0], [4, 4]], [[4, 4], [0, 0]]]


def test_what_bounds_nothing_is_told() -> None:
    line, point = {"type": "LineString", "coordinates": [[0, 0], [1, 1]]}, {"type": "Point", "coordinates": [0, 0]}
    empty = {"type": "Polygon", "coordinates": []}
    found = from_geojson({"type": "GeometryCollection", "geometries": [point, line, point, empty]})
    assert found.domains == []
    assert found.left_out == ["1 of type LineString, which bounds nothing", "2 of type Point, which bounds nothing"]


@pytest.mark.parametrize(
    ("document", "told"),
    [
        ("{", "not JSON"),
        ("[" * 100_000, "not JSON"),
        ([], "the document is not a GeoJSON object"),
        ({"outer": []}, "the document is not a GeoJSON object"),
        ({"type": "FeatureCollection"}, "/features is not a list"),
        ({"type": "FeatureCollection", "features": [3]}, "/features/0 is not a GeoJSON object"),
        (feature({"type": "Polygon", "coordinates": 3}), "/geometry/coordinates is not a list"),
        (feature({"type": "Polygon", "coordinates": [SQUARE, [[0, 0], [1]]]}), "/geometry/coordinates/1/1 is not a position"),
        ({"type": "Polygon", "coordinates": [[[0, 0], ["x", 1]]]}, "/coordinates/0/1 is not a position"),
        ({"type": "Polygon", "coordinates": [[[0, 0], [1, 1], [0, 0]]]}, "/coordinates/0 is a ring of 2 different points"),
        ({"type": "MultiPolygon", "coordinates": [[SQUARE], 5]}, "/coordinates/1 is not a list"),
    ],
)
def test_faults_are_told_by_their_place(document: Any, told: str) -> None:
    with pytest.raises(UnreadableInput) as caught:
        from_geojson(document)
    assert str(caught.value).startswith(told)
