"""Arguments of a JSON document: every fault at once, each with its pointer; nothing unsound gets through."""

from __future__ import annotations

import inspect
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mat_core import Problem
from mat_core.analysis.arguments import Argument, number, point_list, read_arguments, truth_value
from mat_core.analysis.operations import OPERATIONS, Operation

RULES = {
    "distance": number(other_than=0.0, required=True, unit="a length"),
    "angle": number(0.0, math.pi),
    "above": number(above=0.0),
    "extend": truth_value(),
    "points": point_list(),
}
SOUND: dict[str, Any] = {"distance": 2, "angle": 1.0, "above": 0.5, "extend": True, "points": [[0, 1], [2.5, 3]]}


def read(value: object, rules: dict[str, Argument] = RULES) -> tuple[dict[str, Any], list[Problem]]:
    problems: list[Problem] = []
    return read_arguments(rules, value, problems), problems


def test_sound_arguments_come_through() -> None:
    found, problems = read(SOUND)
    assert problems == []
    assert found.pop("points").tolist() == [[0.0, 1.0], [2.5, 3.0]]
    assert found == {"distance": 2.0, "angle": 1.0, "above": 0.5, "extend": True}
    assert type(found["distance"]) is float


@pytest.mark.parametrize(
    ("name", "value", "pointer"),
    [
        ("distance", 0, "/arguments/distance"),
        ("distance", None, "/arguments/distance"),
        ("distance", "1", "/arguments/distance"),
        ("distance", True, "/arguments/distance"),
        ("distance", math.nan, "/arguments/distance"),
        ("distance", math.inf, "/arguments/distance"),
        ("distance", 10**400, "/arguments/distance"),
        ("angle", -0.1, "/arguments/angle"),
        ("angle", 3.2, "/arguments/angle"),
        ("above", 0.0, "/arguments/above"),
        ("extend", 1, "/arguments/extend"),
        ("points", [], "/arguments/points"),
        ("points", {}, "/arguments/points"),
        ("points", [0, 0], "/arguments/points/0"),
        ("points", [[0, 0], [0, 0, 0]], "/arguments/points/1"),
        ("points", [[0, 0], [0, "0"]], "/arguments/points/1"),
        ("points", [[0, math.inf]], "/arguments/points/0"),
        ("points", [[0, 1e200]], "/arguments/points/0"),
        ("points", [[True, 0]], "/arguments/points/0"),
        ("a/b", 1, "/arguments/a~1b"),
    ],
)
def test_a_fault_is_named_with_its_place(name: str, value: Any, pointer: str) -> None:
    found, problems = read({**SOUND, name: value})
    assert pointer in [problem.pointer for problem in problems]
    assert {problem.code for problem in problems} == {"invalid-request"}
    assert name not in found
    assert all(name.split("/")[0] in problem.message for problem in problems)


def test_all_faults_come_at_once() -> None:
    _, problems = read({"angle": 9, "extend": "yes", "no": 1, "points": [[1], [2]]})
    pointers = ["no", "distance", "angle", "extend", "points/0", "points/1"]
    assert [problem.pointer for problem in problems] == [f"/arguments/{name}" for name in pointers]
    assert "distance is missing" in problems[1].message


@pytest.mark.parametrize("value", [3, "x", [], True])
def test_arguments_are_an_object(value: object) -> None:
    found, (problem,) = read(value)
    assert (found, problem.pointer) == ({}, "/arguments")


def test_null_is_absence_where_nothing_is_required() -> None:
    assert read(None, {"angle": number()}) == ({}, [])
    assert read({"angle": None}, {"angle": number()}) == ({}, [])


@pytest.mark.parametrize("value", [None, {}, {"angle": None}])
def test_some_operations_want_at_least_one(value: object) -> None:
    problems: list[Problem] = []
    rules = {"angle": number(), "length": number()}
    assert read_arguments(rules, value, problems, at_least_one=True) == {}
    assert [(p.pointer, p.message[-34:]) for p in problems] == [("/arguments", "give at least one of angle, length")]
    assert read_arguments(rules, {"length": 1}, [], at_least_one=True) == {"length": 1.0}


def test_an_operation_without_arguments_says_so() -> None:
    _, (problem,) = read({"x": 1}, {})
    assert problem.message.endswith("this operation takes none")


scalars = st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=3)
anything = st.recursive(scalars, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner))


@given(value=st.dictionaries(st.sampled_from([*RULES, "x"]), anything, max_size=6) | anything)
def test_whatever_comes_is_refused_or_sound(value: Any) -> None:
    found, problems = read(value)
    assert problems or isinstance(value, dict)
    for name, content in found.items():
        assert np.isfinite(content).all()
        assert RULES[name].check(content.tolist() if isinstance(content, np.ndarray) else content) == []


@pytest.mark.parametrize("operation", OPERATIONS.values(), ids=OPERATIONS)
def test_the_rules_are_those_of_the_function(operation: Operation) -> None:
    parameters = dict(inspect.signature(operation.call).parameters)
    assert next(iter(parameters)) == "axis"
    del parameters["axis"]
    assert set(operation.arguments) == set(parameters)
    for name, rule in operation.arguments.items():
        assert rule.required == (parameters[name].default is inspect.Parameter.empty)
