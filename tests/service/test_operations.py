"""The analyses as they are served: one mechanism for all of them, held to the library's own table and results."""

from __future__ import annotations

import io
import json
import xml.etree.ElementTree as ElementTree
from typing import Any

import ezdxf
import httpx2
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import BaseModel, ValidationError

from mat_core import Domain, medial_axis
from mat_core.analysis import operations as library
from service.errors import MEDIA_TYPE
from service.http.negotiation import FORMATS
from service.operations import OPERATIONS, Operation
from service.schemas import ProblemDocument
from tests.service.domains import anything
from tests.service.live import ROOT

JSON = {"Content-Type": "application/json"}
EXAMPLES = sorted((ROOT / "openapi" / "examples").glob("*.json"))
PLATE = json.loads((ROOT / "openapi" / "examples" / "plate.json").read_text())
ANALYSES = {name: operation for name, operation in OPERATIONS.items() if name != "mat"}
RELAXED = settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)
TINY = [{"degree": 1, "control_points": [[0, 0], [1, 0]]}]


def post(live: httpx2.Client, name: str, body: Any, **params: str) -> httpx2.Response:
    return live.post(f"/v1/{name}", content=json.dumps(body).encode(), headers=JSON, params=params)


def problems(response: httpx2.Response) -> dict[str, str]:
    """Pointers and codes of a refusal."""
    assert response.status_code == 422, response.text
    assert response.headers["content-type"] == MEDIA_TYPE
    document = ProblemDocument.model_validate_json(response.text)
    assert document.code == "invalid-domain"
    return {problem.pointer: problem.code for problem in document.problems}


def test_the_table_is_that_of_the_library() -> None:
    assert set(ANALYSES) == set(library.OPERATIONS)
    for name, operation in ANALYSES.items():
        own = library.OPERATIONS[name]
        assert ("svg" in operation.formats) == ("dxf" in operation.formats) == (own.paths is not None)
        field = operation.request.model_fields["arguments"]
        model = next(kind for kind in (field.annotation, *getattr(field.annotation, "__args__", ())) if is_model(kind))
        assert set(model.model_fields) == set(own.arguments)
        required = {argument for argument, rule in own.arguments.items() if rule.required}
        assert {key for key, member in model.model_fields.items() if member.is_required()} == required
        assert field.is_required() == (bool(required) or own.at_least_one)


def is_model(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
@pytest.mark.parametrize("operation", ANALYSES.values(), ids=ANALYSES)
def test_the_answer_is_the_library_s(live: httpx2.Client, operation: Operation, path: Any) -> None:
    """Everything that was asked, the very result, and what it was found from."""
    body = json.loads(path.read_text()) | ({"arguments": operation.arguments} if operation.arguments else {})
    response = post(live, operation.name, body)
    assert response.status_code == 200, response.text
    operation.answer.model_validate_json(response.text)
    answer = response.json()
    own = library.OPERATIONS[operation.name]
    domain = Domain.from_dict({key: value for key, value in body.items() if key != "arguments"})
    axis = medial_axis(domain, **{key: value for key, value in domain.options.items() if key != "samples"})
    assert answer["result"] == json.loads(json.dumps(own.call(axis, **operation.arguments).to_dict()))
    assert (answer["operation"], answer["arguments"]) == (operation.name, operation.arguments)
    assert answer["certificate"]["passed"]
    assert answer["domain"]["edges"] == len(domain.arrays.degree)
    assert set(answer["version"]) == {"service", "algorithm"}


@pytest.mark.parametrize("name", ANALYSES)
def test_faults_of_domain_options_and_arguments_come_together(live: httpx2.Client, name: str) -> None:
    body = {"outer": [{"degree": 1, "control_points": [[0, 0]]}], "options": {"step": -1}, "arguments": {"nonsense": 1}}
    found = problems(post(live, name, body))
    assert found["/arguments/nonsense"] == "invalid-request"
    assert found["/options/step"] == "invalid-request"
    assert any(pointer.startswith("/outer/0") for pointer in found)


@pytest.mark.parametrize("arguments", [3, [], "distance", True])
@pytest.mark.parametrize("name", ANALYSES)
def test_arguments_of_the_wrong_kind(live: httpx2.Client, name: str, arguments: Any) -> None:
    assert problems(post(live, name, PLATE | {"arguments": arguments})) == {"/arguments": "invalid-request"}


def test_what_must_be_given(live: httpx2.Client) -> None:
    for name, own in library.OPERATIONS.items():
        required = {f"/arguments/{argument}": "invalid-request" for argument, rule in own.arguments.items() if rule.required}
        if required:
            assert problems(post(live, name, PLATE)) == problems(post(live, name, PLATE | {"arguments": {}})) == required


@pytest.mark.parametrize("body", [{}, {"arguments": {}}, {"arguments": None}, {"arguments": {"angle": None}}])
def test_at_least_one_rule_to_prune_by(live: httpx2.Client, body: Any) -> None:
    assert problems(post(live, "prune", PLATE | body)) == {"/arguments": "invalid-request"}


def test_the_axis_itself_takes_no_arguments(live: httpx2.Client) -> None:
    assert problems(post(live, "mat", PLATE | {"arguments": {}})) == {"/arguments": "invalid-request"}


def test_an_argument_that_does_not_go_with_the_domain_is_named(live: httpx2.Client) -> None:
    body = PLATE | {"arguments": {"distance": -1e30}}
    assert problems(post(live, "offset", body)) == {"/arguments/distance": "unsupported-option"}


def test_a_body_without_a_domain_and_without_arguments(live: httpx2.Client) -> None:
    assert set(problems(post(live, "offset", {}))) == {"/outer", "/arguments/distance"}
    assert problems(post(live, "offset", [])) == {"": "invalid-request"}


@pytest.mark.parametrize("name", ANALYSES)
@given(arguments=st.dictionaries(st.sampled_from([*{a for o in library.OPERATIONS.values() for a in o.arguments}]), anything))
@settings(RELAXED, max_examples=40)
def test_arguments_that_the_model_refuses_are_refused(live: httpx2.Client, name: str, arguments: Any) -> None:
    body = PLATE | {"arguments": arguments}
    response = post(live, name, body)
    assert response.status_code in (200, 422), response.text
    try:
        OPERATIONS[name].request.model_validate_json(json.dumps(body))
    except ValidationError:
        assert all(pointer.startswith("/arguments") for pointer in problems(response))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
@pytest.mark.parametrize("name", [name for name, operation in ANALYSES.items() if "svg" in operation.formats])
def test_loops_as_picture_and_drawing(live: httpx2.Client, name: str, path: Any) -> None:
    body = json.loads(path.read_text()) | {"arguments": ANALYSES[name].arguments}
    picture = post(live, name, body, f="svg")
    assert picture.headers["content-type"] == FORMATS["svg"]
    drawn = ElementTree.fromstring(picture.text)
    assert any("result" in path.get("class", "") for path in drawn.iterfind("{*}path"))
    drawing = ezdxf.read(io.StringIO(post(live, name, body, f="dxf").text))
    assert not drawing.audit().errors
    assert {entity.dxf.layer for entity in drawing.modelspace()} == {"boundary", name}


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_axis_in_every_format(live: httpx2.Client, path: Any) -> None:
    domain = Domain.from_dict(json.loads(path.read_text()))
    axis = medial_axis(domain, **{key: value for key, value in domain.options.items() if key != "samples"})
    answers = {}
    for form, media_type in FORMATS.items():
        by_query = live.post("/v1/mat", content=path.read_bytes(), params={"f": form})
        by_header = live.post("/v1/mat", content=path.read_bytes(), headers=JSON | {"Accept": media_type})
        assert by_query.headers["content-type"] == by_header.headers["content-type"] == media_type
        assert by_query.content == by_header.content
        answers[form] = by_query
    assert answers["geojson"].json() == axis.to_geojson()
    assert answers["svg"].text == axis.to_svg()
    assert answers["dxf"].text == axis.to_dxf()
