"""openapi.json may not break what clients of a release rely on, unless the version says so."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from service import __version__
from tools.breaking import breaks

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = json.loads((ROOT / "openapi" / "openapi.json").read_text(encoding="utf-8"))
RELEASED = {tuple(map(int, path.stem.split("."))): path for path in (ROOT / "openapi" / "released").glob("*.json")}
CURRENT = tuple(map(int, __version__.split(".")[:3]))

Json = dict[str, Any]


def may_break(old: tuple[int, ...], new: tuple[int, ...]) -> bool:
    """Semantic Versioning: a new first number, or while that is 0 a new second one."""
    return new[0] > old[0] or (old[0] == new[0] == 0 and new[1] > old[1])


@pytest.mark.parametrize(
    ("old", "new", "may"),
    [
        ((0, 1, 0), (0, 1, 1), False),
        ((0, 1, 0), (0, 2, 0), True),
        ((1, 2, 3), (1, 3, 0), False),
        ((1, 2, 3), (2, 0, 0), True),
        ((0, 9, 0), (1, 0, 0), True),
        ((1, 0, 0), (1, 0, 0), False),
    ],
)
def test_when_a_version_may_break_another(old: tuple[int, ...], new: tuple[int, ...], may: bool) -> None:
    assert may_break(old, new) == may


def test_the_last_release_is_not_broken_unless_the_version_says_so() -> None:
    last = max(version for version in RELEASED if version <= CURRENT)
    found = breaks(json.loads(RELEASED[last].read_text(encoding="utf-8")), DOCUMENT)
    hint = "raise the version; or, if it is not out yet, keep the new document: python tools/write_openapi.py --release"
    assert found == [] or may_break(last, CURRENT), "\n".join([*found, hint])


def test_every_release_is_kept() -> None:
    """And the version that is being worked on, once its contract is to hold."""
    versions = re.findall(r"^## (\d+)\.(\d+)\.(\d+)", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert set(RELEASED) == {tuple(map(int, version)) for version in versions}


def test_nothing_breaks_itself() -> None:
    assert breaks(DOCUMENT, DOCUMENT) == []


SCHEMAS = ("components", "schemas")
MAT = ("paths", "/v1/mat", "post")
JOBS = ("paths", "/v1/jobs", "get")

Change = Callable[[Json], object]


def at(document: Json, *steps: Any) -> Any:
    for step in steps:
        document = document[step]
    return document


BREAKING: dict[str, Change] = {
    "a route is gone": lambda d: d["paths"].pop("/v1/width"),
    "a method is gone": lambda d: d["paths"]["/v1/jobs/{job_id}"].pop("delete"),
    "an operation has another name": lambda d: at(d, *MAT).update(operationId="mat"),
    "a key is needed": lambda d: at(d, *MAT).update(security=[{"bearer": []}]),
    "a parameter is gone": lambda d: at(d, *MAT, "parameters").pop(0),
    "a format is gone": lambda d: at(d, *MAT, "parameters", 0, "schema", "enum").remove("svg"),
    "a range is narrower": lambda d: at(d, *MAT, "parameters", 1, "schema").update(maximum=10),
    "a page is smaller": lambda d: at(d, *JOBS, "parameters", 0, "schema").update(maximum=10),
    "a parameter must be given": lambda d: at(d, *JOBS, "parameters", 0).update(required=True),
    "a new parameter must be given": lambda d: at(d, *MAT, "parameters").append(
        {"in": "query", "name": "unit", "required": True, "schema": {"type": "string"}}
    ),
    "a media type is not taken": lambda d: at(d, "paths", "/v1/batches", "post", "requestBody", "content").clear(),
    "a media type is not answered": lambda d: at(d, *MAT, "responses", "200", "content").pop("image/svg+xml"),
    "a status is not answered": lambda d: at(d, *MAT, "responses").pop("201"),
    "a member of a request is gone": lambda d: at(d, *SCHEMAS, "DomainRequest", "properties").pop("note"),
    "a member of a request must be given": lambda d: at(d, *SCHEMAS, "DomainRequest", "required").append("holes"),
    "a new member of a request must be given": lambda d: (
        at(d, *SCHEMAS, "Edge", "properties").update(kind={"type": "string"}), at(d, *SCHEMAS, "Edge", "required").append("kind")
    ),
    "a member of a request has a lower bound": lambda d: at(d, *SCHEMAS, "Edge", "properties", "degree").update(maximum=5),
    "a member of a request has another type": lambda d: at(d, *SCHEMAS, "Edge", "properties", "degree").update(type="string"),
    "null is not taken": lambda d: at(d, *SCHEMAS, "DomainRequest", "properties", "holes", "anyOf").pop(),
    "a choice is gone": lambda d: at(d, *SCHEMAS, "Options", "properties", "method", "enum").remove("march"),
    "a member of an answer is gone": lambda d: (
        at(d, *SCHEMAS, "Node", "properties").pop("radius"), at(d, *SCHEMAS, "Node", "required").remove("radius")
    ),
    "a member of an answer may be missing": lambda d: at(d, *SCHEMAS, "Segment", "required").remove("kind"),
    "a member of an answer may be null": lambda d: at(d, *SCHEMAS, "Node", "properties").update(
        radius={"anyOf": [{"type": "number"}, {"type": "null"}]}
    ),
    "an answer has a new kind": lambda d: at(d, *SCHEMAS, "JobStatus", "properties", "status", "enum").append("paused"),
    "a number of an answer may be negative": lambda d: at(d, *SCHEMAS, "Node", "properties", "radius").pop("minimum"),
    "an answer is a list": lambda d: at(d, *SCHEMAS, "Graph").update(type="array"),
    "items of an answer are others": lambda d: at(d, *SCHEMAS, "Footpoint", "properties", "u").update(type="string"),
}  # fmt: skip

HARMLESS: dict[str, Change] = {
    "a new route": lambda d: d["paths"].update({"/v1/new": {"get": {"responses": {}}}}),
    "a new parameter": lambda d: at(d, *MAT, "parameters").append({"in": "query", "name": "unit", "schema": {"type": "string"}}),
    "a new format": lambda d: (
        at(d, *MAT, "parameters", 0, "schema", "enum").append("pdf"),
        at(d, *MAT, "responses", "200", "content").update({"application/pdf": {}}),
    ),
    "a wider range": lambda d: at(d, *MAT, "parameters", 1, "schema").update(maximum=17),
    "a new member of a request": lambda d: at(d, *SCHEMAS, "Options", "properties").update(unit={"type": "string"}),
    "a new choice": lambda d: at(d, *SCHEMAS, "Options", "properties", "method", "enum").append("power"),
    "a higher bound": lambda d: at(d, *SCHEMAS, "Options", "properties", "tolerance").update(maximum=0.5),
    "a new member of an answer": lambda d: at(d, *SCHEMAS, "MatAnswer", "properties").update(unit={"type": "string"}),
    "an answer that always has a member": lambda d: at(d, *SCHEMAS, "MatAnswer", "required").append("rounding"),
    "an answer of fewer kinds": lambda d: at(d, *SCHEMAS, "JobStatus", "properties", "status", "enum").remove("failed"),
    "a whole number where any was": lambda d: at(d, *SCHEMAS, "Node", "properties", "radius").update(type="integer"),
    "other words": lambda d: at(d, *MAT).update(summary="Solve", description="Solve"),
    "another failure": lambda d: at(d, *MAT, "responses").pop("413"),
}


@pytest.mark.parametrize("change", BREAKING.values(), ids=BREAKING)
def test_what_breaks_clients_is_found(change: Change) -> None:
    changed = copy.deepcopy(DOCUMENT)
    change(changed)
    assert breaks(DOCUMENT, changed)


@pytest.mark.parametrize("change", HARMLESS.values(), ids=HARMLESS)
def test_what_breaks_nobody_is_passed(change: Change) -> None:
    changed = copy.deepcopy(DOCUMENT)
    change(changed)
    assert changed != DOCUMENT
    assert breaks(DOCUMENT, changed) == []
