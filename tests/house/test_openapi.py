"""openapi/openapi.json is generated; here it is held to the code, and the examples to the document."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from service.app import create_app
from service.errors import ERRORS, MEDIA_TYPE
from service.http.negotiation import FORMATS, PRECISION_RANGE
from service.openapi import OWN_CODES, codes_of
from service.operations import OPERATIONS, Operation
from service.schemas import DomainRequest
from service.settings import Settings

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = json.loads((ROOT / "openapi" / "openapi.json").read_text(encoding="utf-8"))
EXAMPLES = sorted((ROOT / "openapi" / "examples").glob("*.json"))


def test_the_committed_document_is_what_the_code_generates() -> None:
    assert create_app(Settings()).openapi() == DOCUMENT, "openapi/openapi.json is out of date; run: make openapi"


def references(node: Any) -> Iterator[str]:
    if isinstance(node, dict):
        if isinstance(node.get("$ref"), str):
            yield node["$ref"]
        for value in node.values():
            yield from references(value)
    elif isinstance(node, list):
        for value in node:
            yield from references(value)


def test_it_is_version_3_1_and_every_reference_resolves() -> None:
    assert DOCUMENT["openapi"].startswith("3.1")
    there = {f"#/components/{part}/{name}" for part in ("schemas", "examples") for name in DOCUMENT["components"][part]}
    assert set(references(DOCUMENT)) == there


def test_every_error_is_described_as_a_problem_document() -> None:
    for path, methods in DOCUMENT["paths"].items():
        for operation in methods.values():
            told = {status for status in operation["responses"] if int(status) >= 400}
            assert told == {str(ERRORS[code].status) for code in codes_of(path)}
            for code in codes_of(path):
                kind = ERRORS[code]
                response = operation["responses"][str(kind.status)]
                assert list(response["content"]) == [MEDIA_TYPE]
                assert response["content"][MEDIA_TYPE]["examples"][code] == {"$ref": f"#/components/examples/{code}"}
                assert ("headers" in response) == (kind.status in (429, 503))
    examples = DOCUMENT["components"]["examples"]
    assert all(example["value"]["code"] == code for code, example in examples.items())
    assert set(OWN_CODES) <= set(DOCUMENT["paths"])
    nowhere = {"method-not-allowed", "not-http"}  # of requests that are for none of the operations
    assert {code for path in DOCUMENT["paths"] for code in codes_of(path)} | nowhere == set(ERRORS)


def test_only_what_needs_a_key_says_so() -> None:
    for path, methods in DOCUMENT["paths"].items():
        for operation in methods.values():
            assert ("security" in operation) == path.startswith(("/v1/", "/processes/{process_id}/execution"))


def test_no_other_media_type_for_errors_has_slipped_in() -> None:
    for path in DOCUMENT["paths"].values():
        for operation in path.values():
            for status, response in operation["responses"].items():
                if int(status) >= 400:
                    assert list(response["content"]) == [MEDIA_TYPE]


def test_the_examples_are_in_the_document() -> None:
    shown = DOCUMENT["paths"]["/v1/mat"]["post"]["requestBody"]["content"]["application/json"]["examples"]
    assert {name: example["value"] for name, example in shown.items()} == {
        path.stem: json.loads(path.read_text()) for path in EXAMPLES
    }


@pytest.mark.parametrize("operation", OPERATIONS.values(), ids=OPERATIONS)
def test_every_route_has_its_documents_and_formats(operation: Operation) -> None:
    route = DOCUMENT["paths"][f"/v1/{operation.name}"]["post"]
    body = route["requestBody"]["content"]["application/json"]
    assert body["schema"]["$ref"].endswith(f"/{operation.request.__name__}")
    content = route["responses"]["200"]["content"]
    assert set(content) == {FORMATS[form] for form in operation.formats}
    assert content["application/json"]["schema"]["$ref"].endswith(f"/{operation.answer.__name__}")
    queries = [parameter for parameter in route["parameters"] if parameter["in"] == "query"]
    parameters = {parameter["name"]: parameter["schema"] for parameter in queries}
    assert parameters["f"]["enum"] == list(operation.formats)
    assert (parameters["precision"]["minimum"], parameters["precision"]["maximum"]) == PRECISION_RANGE
    assert body["examples"]
    for example in body["examples"].values():
        operation.request.model_validate_json(json.dumps(example["value"]))
        assert example["value"].get("arguments", {}) == operation.arguments


def test_every_solving_route_is_in_the_table() -> None:
    solving = {f"/v1/{name}" for name in OPERATIONS}
    others = ("/v1/jobs", "/v1/batches")
    assert {path for path in DOCUMENT["paths"] if path.startswith("/v1/") and not path.startswith(others)} == solving


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_examples_fit_the_model(path: Path) -> None:
    DomainRequest.model_validate_json(path.read_text())


LINE: dict[str, Any] = {"degree": 1, "control_points": [[0, 0], [1, 0]]}


@pytest.mark.parametrize(
    "body",
    [
        {},
        [],
        None,
        {"outer": []},
        {"outer": 3},
        {"outer": [LINE], "inner": []},
        {"outer": [LINE | {"degree": True}]},
        {"outer": [LINE | {"degree": 1.0}]},
        {"outer": [LINE | {"degree": "1"}]},
        {"outer": [LINE | {"control_points": [[0, 0], [True, 0]]}]},
        {"outer": [LINE | {"control_points": [[0, 0], ["1", 0]]}]},
        {"outer": [LINE | {"control_points": [[0, 0], [1, 0, 0]]}]},
        {"outer": [LINE | {"weights": [1, 0]}]},
        {"outer": [LINE], "options": {"tolerance": 0}},
        {"outer": [LINE], "options": {"method": "voronoi"}},
        {"outer": [LINE], "options": {"samples": 1}},
    ],
)
def test_the_model_is_strict(body: Any) -> None:
    with pytest.raises(ValidationError):
        DomainRequest.model_validate_json(json.dumps(body))
