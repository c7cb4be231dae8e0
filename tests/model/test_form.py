"""Documents whose form is wrong: types, keys, counts, numbers that are none."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from mat_core.errors import InvalidDomain
from mat_core.model.domain import Domain
from mat_core.model.problems import CODES
from tests.model.builders import SQUARE, Json, bezier, circle, codes, domain, polygon, problems_of, rectangle

ARC = bezier((1, -1), (1.5, 0), (1, 1))


def with_edge(**changes: Any) -> Json:
    """The square whose right side is a parabola with these members changed; None takes a member away."""
    edge = ARC | {"knots": [0, 0, 0, 1, 1, 1]} | changes
    return domain([SQUARE[0], {k: v for k, v in edge.items() if v is not None}, *SQUARE[2:]])


@pytest.mark.parametrize(
    ("changes", "code", "pointer"),
    [
        ({"degree": 0}, "invalid-spline", "/degree"),
        ({"degree": -3}, "invalid-spline", "/degree"),
        ({"degree": 26}, "invalid-spline", "/degree"),
        ({"degree": 10**9}, "invalid-spline", "/degree"),
        ({"degree": 10**5000}, "invalid-spline", "/degree"),
        ({"degree": 3}, "invalid-spline", "/control_points"),
        ({"degree": "2"}, "invalid-request", "/degree"),
        ({"degree": 2.0}, "invalid-request", "/degree"),
        ({"degree": True}, "invalid-request", "/degree"),
        ({"degree": None}, "invalid-request", "/degree"),
        ({"degree": [2]}, "invalid-request", "/degree"),
        ({"control_points": None}, "invalid-request", "/control_points"),
        ({"control_points": "abc"}, "invalid-request", "/control_points"),
        ({"control_points": {}}, "invalid-request", "/control_points"),
        ({"control_points": []}, "invalid-spline", "/control_points"),
        ({"control_points": [[1, -1]]}, "invalid-spline", "/control_points"),
        ({"control_points": [1, -1, 1]}, "invalid-request", "/control_points/0"),
        ({"control_points": [[1, -1], [1.5], [1, 1]]}, "invalid-spline", "/control_points/1"),
        ({"control_points": [[1, -1, 0], [1.5, 0, 0], [1, 1, 0]]}, "invalid-spline", "/control_points/0"),
        ({"control_points": [[1, -1], ["1.5", 0], [1, 1]]}, "invalid-request", "/control_points/1/0"),
        ({"control_points": [[1, -1], [1.5, True], [1, 1]]}, "invalid-request", "/control_points/1/1"),
        ({"control_points": [[1, -1], [1.5, [0]], [1, 1]]}, "invalid-request", "/control_points/1/1"),
        ({"control_points": [[1, -1], [None, 0], [1, 1]]}, "invalid-request", "/control_points/1/0"),
        ({"control_points": [[1, -1], [math.nan, 0], [1, 1]]}, "non-finite", "/control_points/1"),
        ({"control_points": [[1, -1], [1.5, math.inf], [1, 1]]}, "non-finite", "/control_points/1"),
        ({"control_points": [[1, -1], [-(10**400), 0], [1, 1]]}, "non-finite", "/control_points/1"),
        ({"control_points": [[1, -1], [1e200, 0], [1, 1]]}, "out-of-range", "/control_points/1"),
        ({"knots": [0, 0, 0, 1, 1]}, "invalid-spline", "/knots"),
        ({"knots": [0, 0, 0, 0.5, 1, 1, 1]}, "invalid-spline", "/knots"),
        ({"knots": []}, "invalid-spline", "/knots"),
        ({"knots": 3}, "invalid-request", "/knots"),
        ({"knots": [0, 0, 0, "1", 1, 1]}, "invalid-request", "/knots/3"),
        ({"knots": [False, 0, 0, 1, 1, 1]}, "invalid-request", "/knots/0"),
        ({"knots": [0, 0, 0, math.nan, 1, 1]}, "non-finite", "/knots/3"),
        ({"knots": [0, 0, 0, 1, 1, math.inf]}, "non-finite", "/knots/5"),
        ({"knots": [0, 0, 0, 1, 0.5, 1]}, "invalid-spline", "/knots/4"),
        ({"knots": [1, 1, 1, 0, 0, 0]}, "invalid-spline", "/knots/3"),
        ({"knots": [0, 0, 0, 0, 0, 0]}, "invalid-spline", "/knots/0"),
        ({"knots": [0, 0, 0.5, 1, 1, 1]}, "invalid-spline", "/knots/2"),
        ({"knots": [0, 0, 0, 0.5, 1, 1]}, "invalid-spline", "/knots/3"),
        ({"knots": [-1e308, -1e308, -1e308, 1e308, 1e308, 1e308]}, "invalid-spline", "/knots/0"),
        ({"weights": [1, 1]}, "invalid-spline", "/weights"),
        ({"weights": [1, 0, 1]}, "non-positive-weight", "/weights/1"),
        ({"weights": [1, -2, 1]}, "non-positive-weight", "/weights/1"),
        ({"weights": [1, math.nan, 1]}, "non-finite", "/weights/1"),
        ({"weights": [1, math.inf, 1]}, "non-finite", "/weights/1"),
        ({"weights": [1e-10, 1, 1e10]}, "out-of-range", "/weights/0"),
        ({"weights": [1, "1", 1]}, "invalid-request", "/weights/1"),
        ({"weights": {"0": 1}}, "invalid-request", "/weights"),
        ({"wieghts": [1, 1, 1]}, "invalid-request", "/wieghts"),
        ({"a/b~c": 1}, "invalid-request", "/a~1b~0c"),
    ],
)
def test_one_bad_edge(changes: Json, code: str, pointer: str) -> None:
    (problem,) = problems_of(with_edge(**changes))
    assert problem.code == code
    assert problem.pointer == "/outer/1" + pointer
    assert (problem.loop, problem.edge) == (0, 1)
    json.dumps(problem.to_dict(), allow_nan=False)


@pytest.mark.parametrize(
    ("document", "pointer"),
    [
        (None, ""),
        (3, ""),
        ("outer", ""),
        ([], ""),
        ({}, "/outer"),
        ({"outer": 3}, "/outer"),
        ({"outer": None}, "/outer"),
        ({"outer": {"0": SQUARE[0]}}, "/outer"),
        ({"outer": SQUARE, "holes": 1}, "/holes"),
        ({"outer": SQUARE, "holes": {}}, "/holes"),
        ({"outer": SQUARE, "holes": [1]}, "/holes/0"),
        ({"outer": SQUARE, "holes": [[[]]]}, "/holes/0/0"),
        ({"outer": SQUARE, "hole": []}, "/hole"),
        ({"outer": SQUARE, "name": 7}, "/name"),
        ({"outer": [*SQUARE[:3], "line"]}, "/outer/3"),
        ({"outer": [*SQUARE[:3], None]}, "/outer/3"),
        ({"outer": SQUARE, "options": 1}, "/options"),
        ({"outer": SQUARE, "options": {"tolerance": 0}}, "/options/tolerance"),
        ({"outer": SQUARE, "options": {"tolerance": "1e-6"}}, "/options/tolerance"),
        ({"outer": SQUARE, "options": {"tolerance": True}}, "/options/tolerance"),
        ({"outer": SQUARE, "options": {"tolerance": math.nan}}, "/options/tolerance"),
        ({"outer": SQUARE, "options": {"step": -1}}, "/options/step"),
        ({"outer": SQUARE, "options": {"step": math.inf}}, "/options/step"),
        ({"outer": SQUARE, "options": {"method": "magic"}}, "/options/method"),
        ({"outer": SQUARE, "options": {"method": ["discs"]}}, "/options/method"),
        ({"outer": SQUARE, "options": {"samples": 1}}, "/options/samples"),
        ({"outer": SQUARE, "options": {"step": 0}}, "/options/step"),
        ({"outer": SQUARE, "options": {"step": 9e-7}}, "/options/step"),
        ({"outer": SQUARE, "options": {"smooth_angle": -0.1}}, "/options/smooth_angle"),
        ({"outer": SQUARE, "options": {"smooth_angle": 0.11}}, "/options/smooth_angle"),
        ({"outer": SQUARE, "notes": 1}, "/notes"),
        ({"outer": SQUARE, "options": {"note": 1}}, "/options/note"),
        ({"outer": [SQUARE[0] | {"note": 1}, *SQUARE[1:]]}, "/outer/0/note"),
        ({"outer": SQUARE, "options": {"check_step": 0}}, "/options/check_step"),
        ({"outer": SQUARE, "options": {"speed": 9}}, "/options/speed"),
    ],
)
def test_bad_frame(document: object, pointer: str) -> None:
    (problem,) = problems_of(document)
    assert (problem.code, problem.pointer) == ("invalid-request", pointer)


def test_deep_nesting_is_named_once_and_briefly() -> None:
    nested: list[Any] = []
    for _ in range(500):
        nested = [nested]
    (problem,) = problems_of({"outer": nested})
    assert problem.pointer == "/outer/0"
    assert len(problem.message) < 200


def test_long_values_are_cut_short() -> None:
    (problem,) = problems_of(with_edge(degree="2" * 100_000))
    assert len(problem.message) < 200
    (problem,) = problems_of({"outer": SQUARE, "k" * 100_000: 1})
    assert len(problem.message) + len(problem.pointer) < 300


def test_every_fault_is_named_at_once() -> None:
    outer = [
        SQUARE[0],
        bezier((1, -1), (1.5, 0), (1, 1), weights=[1, 0, 1]) | {"knots": [0, 0, 0, 1, 0.5, 1]},
        bezier((1, 1), (-1, math.nan)),
        bezier((-1, 1), (-1, -1)) | {"degree": True},
    ]
    crossing = polygon((0, 0), (0.2, 0.2), (0.2, 0), (0, 0.2))
    found = problems_of(domain(outer, crossing, [], name=3))
    assert [p.pointer for p in found] == [
        "/name",
        "/holes/1",
        "/outer/1/weights/1",
        "/outer/1/knots/4",
        "/outer/2/control_points/1",
        "/outer/3/degree",
        "/holes/0/0",
    ]
    assert codes(found) == {
        "invalid-request", "empty-domain", "non-positive-weight", "invalid-spline", "non-finite", "self-intersection"
    }  # fmt: skip


def test_all_codes_are_listed_with_their_meaning() -> None:
    promised = """invalid-spline non-finite non-positive-weight open-loop zero-length-edge self-intersection loops-cross
    loops-touch hole-outside hole-in-hole duplicate-loop empty-domain too-complex"""
    assert set(promised.split()) <= set(CODES)
    assert all(CODES.values())


def test_a_jump_inside_an_edge() -> None:
    points = [(1, -1), (1, 0), (1.2, 0), (1, 1)]
    edge = bezier(*points) | {"degree": 1, "knots": [0, 0, 0.5, 0.5, 1, 1]}
    (problem,) = problems_of(domain([SQUARE[0], edge, *SQUARE[2:]]))
    assert (problem.code, problem.pointer, problem.u) == ("invalid-spline", "/outer/1/knots/3", 0.5)
    points[2] = points[1]
    edge = bezier(*points) | {"degree": 1, "knots": [0, 0, 0.5, 0.5, 1, 1]}
    assert Domain.from_dict(domain([SQUARE[0], edge, *SQUARE[2:]])).area == 4.0


def test_too_many_repetitions_of_an_inner_knot() -> None:
    points = [(1, -1), (1, -0.5), (1, 0), (1, 0.5), (1, 1)]
    edge = bezier(*points) | {"degree": 1, "knots": [0, 0, 0.5, 0.5, 0.5, 1, 1]}
    assert "invalid-spline" in codes(problems_of(domain([SQUARE[0], edge, *SQUARE[2:]])))


def test_a_corner_inside_an_edge_is_fine() -> None:
    edge = bezier((1, -1), (1, 0.5), (1, 1), (0.5, 1), (-1, 1)) | {"degree": 2, "knots": [0, 0, 0, 1, 1, 2, 2, 2]}
    assert Domain.from_dict(domain([SQUARE[0], edge, SQUARE[3]])).area == pytest.approx(4.0, rel=1e-15)


def test_size_limit() -> None:
    (problem,) = problems_of(domain(SQUARE), max_control_points=7)
    assert problem.code == "too-complex"
    assert Domain.from_dict(domain(SQUARE), max_control_points=8)


def test_missing_parts_that_may_be_missing() -> None:
    plain = Domain.from_dict({"outer": SQUARE})
    assert plain.options == {}
    nulls = [edge | {"knots": None, "weights": None} for edge in SQUARE]
    assert Domain.from_dict({"outer": nulls, "holes": None, "options": None}).area == plain.area


def test_arrays_and_tuples_are_read_like_lists() -> None:
    edges = tuple(
        {"degree": np.int64(1), "control_points": np.array(edge["control_points"]), "knots": np.array([0, 0, 1, 1])}
        for edge in SQUARE
    )
    assert Domain.from_dict({"outer": edges, "holes": ()}).area == 4.0


def test_options_and_name_are_kept() -> None:
    options = {"tolerance": 1e-8, "step": 1, "method": "march", "smooth_angle": 0, "samples": True, "check_step": 10}
    found = Domain.from_dict(domain(SQUARE, name="part 7", options=options))
    assert found.options == options
    assert found.name == "part 7"
    again = Domain.from_dict(json.loads(json.dumps(found.to_dict())))
    assert again.options == options
    assert "step" not in Domain.from_dict(domain(SQUARE, options={"step": None})).options


def test_a_document_survives_the_round_trip() -> None:
    first = Domain.from_dict(domain(rectangle(0, 0, 3, 2), circle(1, 1, 0.5, clockwise=True)))
    second = Domain.from_dict(first.to_dict())
    for a, b in zip(first.arrays, second.arrays, strict=True):
        assert np.array_equal(a, b)
    assert second.to_dict() == first.to_dict()


def test_the_error_speaks() -> None:
    with pytest.raises(InvalidDomain, match=r"/outer/2 \[open-loop\] outer loop is open") as caught:
        Domain.from_dict(domain(SQUARE[:3]))
    assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize("value", [None, 0, "words", [1, {"a": []}], {"leaves": 3}])
def test_annotations_may_be_anything_and_are_left_alone(value: Any) -> None:
    found = Domain.from_dict(domain(SQUARE, note=value, truth=value))
    assert found.area == 4
    assert not {"note", "truth"} & found.to_dict().keys()
