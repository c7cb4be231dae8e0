"""Domains from GeoJSON (RFC 7946): Polygon and MultiPolygon, by themselves or in features and collections.

Coordinates are taken as plane ones, in whatever unit they have: project longitudes and latitudes first. A third coordinate is
dropped.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from mat_core.errors import UnreadableInput
from mat_core.outlines.nesting import Json, Outlines
from mat_core.outlines.pen import Loop
from mat_core.outlines.shapes import polygon

PARTS = {"FeatureCollection": "features", "GeometryCollection": "geometries"}
FEWEST = 3


def from_geojson(document: Mapping[str, Any] | str | bytes) -> Outlines:
    """A domain for each polygon.

    Parameters
    ----------
    document : mapping, str or bytes
        A GeoJSON object, or its text.

    Returns
    -------
    Outlines
        Domains with the ``id`` of their feature, or its property ``name``, as name. Points and lines are left out.

    Raises
    ------
    UnreadableInput
        It is not JSON, or not GeoJSON; a JSON pointer tells where.
    """
    if isinstance(document, str | bytes):
        try:
            document = json.loads(document)
        except (ValueError, RecursionError) as error:
            raise UnreadableInput(f"not JSON that can be read: {error}") from error
    found, others = Outlines(), Counter[str]()
    for pointer, name, geometry in _geometries(document, "", ""):
        kind, coordinates = geometry["type"], geometry.get("coordinates")
        if kind == "Polygon":
            parts = [(pointer + "/coordinates", coordinates)]
        elif kind == "MultiPolygon":
            all_parts = _listed(coordinates, pointer + "/coordinates")
            parts = [(f"{pointer}/coordinates/{i}", part) for i, part in enumerate(all_parts)]
        else:
            others[kind] += 1
            continue
        for number, (where, part) in enumerate(parts):
            if domain := _domain(part, where):
                label = f"{name}#{number}" if len(parts) > 1 else name
                found.domains.append({"name": label, **domain} if name else domain)
    found.left_out.extend(f"{count} of type {kind}, which bounds nothing" for kind, count in sorted(others.items()))
    return found


def _geometries(item: Any, pointer: str, name: str) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
    """(JSON pointer, name, geometry) of every geometry."""
    if not isinstance(item, Mapping) or not isinstance(item.get("type"), str):
        raise UnreadableInput(f"{pointer or 'the document'} is not a GeoJSON object: it has no type")
    kind = item["type"]
    if kind == "Feature":
        properties = item.get("properties")
        told = item.get("id", properties.get("name") if isinstance(properties, Mapping) else None)
        if item.get("geometry") is not None:
            yield from _geometries(item["geometry"], pointer + "/geometry", str(told) if told is not None else "")
    elif kind in PARTS:
        where = f"{pointer}/{PARTS[kind]}"
        for i, part in enumerate(_listed(item.get(PARTS[kind]), where)):
            yield from _geometries(part, f"{where}/{i}", name)
    else:
        yield pointer, name, item


def _listed(value: Any, pointer: str) -> list[Any]:
    if not isinstance(value, list):
        raise UnreadableInput(f"{pointer} is not a list")
    return value


def _domain(rings: Any, pointer: str) -> Json | None:
    """The domain of a polygon's rings; None of an empty one."""
    loops = [_loop(ring, f"{pointer}/{i}") for i, ring in enumerate(_listed(rings, pointer))]
    return {"outer": loops[0], "holes": loops[1:]} if loops else None


def _loop(ring: Any, pointer: str) -> Loop:
    """The edges of a ring; points that repeat the one before are passed over."""
    points: list[tuple[float, float]] = []
    for i, position in enumerate(_listed(ring, pointer)):
        try:
            point = float(position[0]), float(position[1])
        except (TypeError, ValueError, IndexError, KeyError) as error:
            raise UnreadableInput(f"{pointer}/{i} is not a position of two numbers") from error
        if not points or points[-1] != point:
            points.append(point)
    if len(points) > 1 and points[0] == points[-1]:
        points.pop()
    if len(points) < FEWEST:
        raise UnreadableInput(f"{pointer} is a ring of {len(points)} different points, which encloses nothing; give at least 3")
    return polygon(points)
