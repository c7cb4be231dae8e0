"""Rounding, msgpack and compression of documents."""

from __future__ import annotations

import gzip
import json
import math
from typing import Any

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.http.compression import LEAST_BYTES
from service.workers.encode import PARTS, compressed, encode, rounded, text

finite = st.floats(-1e100, 1e100)


def grid(points: Any, digits: int, size: float) -> tuple[Any, float]:
    document = rounded({"result": {"points": points}}, digits, size)
    return document["result"]["points"], document["rounding"]["step"]


@pytest.mark.parametrize(
    ("size", "digits", "step"),
    [(1.0, 6, 1e-5), (9.99, 6, 1e-5), (10.0, 6, 1e-4), (1000.0, 4, 1.0), (12345.0, 3, 100.0), (1e-3, 3, 1e-5)],
)
def test_digits_are_those_of_the_size(size: float, digits: int, step: float) -> None:
    assert grid([], digits, size)[1] == step


def test_a_small_domain_far_from_the_origin_keeps_its_shape() -> None:
    points, _ = grid([[123456.123456, 0.0], [123457.123456, 1.0]], 4, 1.0)
    assert points == [[123456.123, 0.0], [123457.123, 1.0]]


@given(st.lists(st.tuples(finite, finite), max_size=9), st.integers(3, 15), st.floats(1e-30, 1e100))
def test_nothing_moves_by_more_than_half_a_step_nor_becomes_no_number(points: Any, digits: int, size: float) -> None:
    near, step = grid([list(point) for point in points], digits, size)
    for old, new in zip(np.ravel(points), np.ravel(near), strict=True):
        assert math.isfinite(new)
        assert abs(new - old) <= 0.5 * step * (1 + 1e-9) + 4 * math.ulp(old)


@given(st.lists(finite, max_size=9).map(sorted), st.integers(3, 15))
def test_the_order_of_numbers_stays(values: list[float], digits: int) -> None:
    near = rounded({"segments": [{"radii": values}]}, digits, 1.0)["segments"][0]["radii"]
    assert near == sorted(near)


def test_the_same_point_is_the_same_wherever_it_stands() -> None:
    point = [0.1 + 0.2, 1 / 3]
    document = {
        "segments": [{"axis": {"control_points": [[0.0, 0.0], point]}}],
        "graph": {"nodes": [{"point": point}]},
        "features": [{"geometry": {"coordinates": [[point, [1.0, 2.0]], [point]]}}],
        "result": {"start": point, "regions": [{"outer": [{"control_points": [point]}]}]},
    }
    near = rounded(document, 5, 1.0)
    assert near["graph"]["nodes"][0]["point"] == [0.3, 0.3333]
    assert near["segments"][0]["axis"]["control_points"][1] == [0.3, 0.3333]
    assert near["features"][0]["geometry"]["coordinates"] == [[[0.3, 0.3333], [1.0, 2.0]], [[0.3, 0.3333]]]
    assert near["result"]["start"] == [0.3, 0.3333]
    assert near["result"]["regions"][0]["outer"][0]["control_points"] == [[0.3, 0.3333]]


def test_only_coordinates_and_radii_are_rounded() -> None:
    third = 1 / 3
    kept = {"t": [third], "knots": [third], "weights": [third], "u": third, "max_error": third, "length": third, "id": 3}
    document = {
        "segments": [{**kept, "radius": {**kept, "control_values": [third]}}],
        "graph": {"nodes": [{**kept, "radius": third}]},
        "certificate": {"point": [third]},
        "domain": {"bbox": [third]},
        "arguments": {"points": [[third, third]]},
    }
    near = rounded(document, 3, 1.0)
    assert near["segments"] == [{**kept, "radius": {**kept, "control_values": [0.33]}}]
    assert near["graph"]["nodes"] == [{**kept, "radius": 0.33}]
    assert {name: near[name] for name in document if name not in PARTS} == {
        name: value for name, value in document.items() if name not in PARTS
    }


def test_no_negative_zero() -> None:
    assert encode(b'{"result":{"point":[-1e-9,0.0]}}', "json", 3, 1.0).startswith(b'{"result":{"point":[0.0,0.0]}')


def test_integers_and_nulls_among_coordinates() -> None:
    document = {"result": {"points": [[1, 2.5]], "point": None, "bbox": []}}
    assert rounded(document, 3, 1.0)["result"] == {"points": [[1.0, 2.5]], "point": None, "bbox": []}


def test_msgpack_is_the_json_document() -> None:
    document = {"a": np.linspace(0, 1, 5), "b": [1, None, True, "ü"], "c": math.nan}
    content = text(document)
    assert encode(content, "json", None, 1.0) == content
    assert msgpack.unpackb(encode(content, "msgpack", None, 1.0)) == json.loads(content)
    assert json.loads(content)["c"] is None


def test_compressed_where_it_pays() -> None:
    short, long = b"x" * (LEAST_BYTES - 1), b"x" * LEAST_BYTES
    assert compressed(short) == (short, False)
    content, zipped = compressed(long)
    assert zipped
    assert gzip.decompress(content) == long
