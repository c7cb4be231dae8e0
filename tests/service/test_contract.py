"""Formats, precision, compression, entity tags and the routes of OGC API - Processes, by the service as it is started."""

from __future__ import annotations

import gzip
import json
from typing import Any

import httpx2
import msgpack
import numpy as np
import pytest
from jsonschema import Draft202012Validator
from referencing import Registry, Resource

from mat_core import Domain, medial_axis
from service.errors import ERRORS, MEDIA_TYPE
from service.http.negotiation import FORMATS
from service.operations import OPERATIONS
from service.schemas import ProblemDocument
from tests.service.live import serving
from tests.service.test_operations import EXAMPLES, PLATE

JSON = {"Content-Type": "application/json"}
ROUTES = [f"/v1/{name}" for name in OPERATIONS]
EXECUTIONS = [f"/processes/{name}/execution" for name in OPERATIONS]
OPTIONS = PLATE.get("options", {})


def body_of(path: str) -> Any:
    """A body that a route answers 200."""
    name = path.split("/")[2]
    arguments = OPERATIONS[name].arguments
    domain = {key: value for key, value in PLATE.items() if key in ("outer", "holes")}
    body = domain | ({"arguments": arguments} if arguments else {})
    return {"inputs": body} if path.endswith("/execution") else body


def send(live: httpx2.Client, path: str, body: Any, headers: dict[str, str] | None = None, **params: Any) -> httpx2.Response:
    content = body if isinstance(body, bytes) else json.dumps(body).encode()
    return live.post(path, content=content, headers=JSON | (headers or {}), params=params)


def refused(response: httpx2.Response, code: str) -> ProblemDocument:
    assert response.headers["content-type"] == MEDIA_TYPE, response.text
    document = ProblemDocument.model_validate_json(response.text)
    assert (response.status_code, document.code) == (ERRORS[code].status, code)
    assert document.request_id == response.headers["x-request-id"]
    return document


@pytest.mark.parametrize("path", ROUTES)
def test_msgpack_holds_the_json_document(live: httpx2.Client, path: str) -> None:
    packed = send(live, path, body_of(path), {"Accept": FORMATS["msgpack"]})
    assert packed.headers["content-type"] == FORMATS["msgpack"]
    assert msgpack.unpackb(packed.content) == send(live, path, body_of(path)).json()


def numbers(node: Any, path: str = "") -> dict[str, float]:
    """Every number of a document by its place."""
    items = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    found = {place: value for key, child in items for place, value in numbers(child, f"{path}/{key}").items()}
    return found | ({path: node} if isinstance(node, int | float) else {})


@pytest.mark.parametrize("path", ROUTES)
@pytest.mark.parametrize("digits", [3, 7])
def test_rounded_answers_are_near_and_say_so(live: httpx2.Client, path: str, digits: int) -> None:
    exact = send(live, path, body_of(path)).json()
    near = send(live, path, body_of(path), precision=digits).json()
    assert OPERATIONS[path.split("/")[2]].answer.model_validate(near)
    rounding = near.pop("rounding")
    assert rounding["digits"] == digits
    assert near["certificate"] == exact["certificate"]
    before, after = numbers(exact), numbers(near)
    assert before.keys() == after.keys()
    moved = [place for place in before if before[place] != after[place]]
    words = ("/radius", "/radii/", "/point", "/points/", "/control_points/", "/control_values/", "/start/", "/end/")
    assert all(any(word in place for word in words) for place in moved), moved
    assert all(abs(before[place] - after[place]) <= 0.5000001 * rounding["step"] for place in moved)
    assert moved or path not in ("/v1/mat", "/v1/prune", "/v1/reconstruct")


def test_a_rounded_offset_is_still_a_domain(live: httpx2.Client) -> None:
    for path in EXAMPLES:
        domain = json.loads(path.read_text())
        size = Domain.from_dict(domain).size
        answer = send(live, "/v1/offset", domain | {"arguments": {"distance": 0.01 * size}}, precision=7).json()
        for region in answer["result"]["regions"]:
            Domain.from_dict(region)
            for loop in (region["outer"], *region["holes"]):
                ends = [edge["control_points"][-1] for edge in loop]
                starts = [edge["control_points"][0] for edge in loop]
                assert ends == starts[1:] + starts[:1]


def test_geojson_is_rounded_to_the_same_grid(live: httpx2.Client) -> None:
    near = send(live, "/v1/mat", body_of("/v1/mat"), f="geojson", precision=4).json()
    step = near["rounding"]["step"]
    for feature in near["features"]:
        for value in numbers(feature["geometry"]).values():
            assert abs(value / step - round(value / step)) < 1e-6


@pytest.mark.parametrize("precision", ["2", "16", "-1", "6.5", "six", "", "1e1"])
def test_a_precision_out_of_its_range(live: httpx2.Client, precision: str) -> None:
    refused(send(live, "/v1/mat", body_of("/v1/mat"), precision=precision), "invalid-parameter")


@pytest.mark.parametrize("f", ["svg", "dxf"])
def test_a_drawing_has_no_precision(live: httpx2.Client, f: str) -> None:
    assert f in refused(send(live, "/v1/mat", body_of("/v1/mat"), f=f, precision=6), "invalid-parameter").detail


def test_a_parameter_that_is_given_twice(live: httpx2.Client) -> None:
    response = live.post("/v1/mat?f=json&f=svg", content=json.dumps(PLATE), headers=JSON)
    assert "2 times" in refused(response, "invalid-parameter").detail


@pytest.mark.parametrize("f", OPERATIONS["mat"].formats)
def test_answers_are_compressed_for_who_takes_that(live: httpx2.Client, f: str) -> None:
    plain = send(live, "/v1/mat", body_of("/v1/mat"), {"Accept-Encoding": "identity"}, f=f)
    assert "content-encoding" not in plain.headers
    request = live.build_request(
        "POST", "/v1/mat", content=json.dumps(body_of("/v1/mat")), headers=JSON | {"Accept-Encoding": "gzip"}, params={"f": f}
    )
    response = live.send(request, stream=True)
    raw = b"".join(response.iter_raw())
    response.close()
    assert response.headers["content-encoding"] == "gzip"
    assert int(response.headers["content-length"]) == len(raw) < 0.6 * len(plain.content)
    assert gzip.decompress(raw) == plain.content
    assert response.headers["vary"] == plain.headers["vary"] == "Accept, Accept-Encoding"


def test_the_same_request_is_answered_again_without_solving(live: httpx2.Client) -> None:
    body = body_of("/v1/mat") | {"note": "asked for the first time here"}
    first, second = send(live, "/v1/mat", body), send(live, "/v1/mat", body)
    assert (first.headers["cache-status"], second.headers["cache-status"]) == ("mat; fwd=miss", "mat; hit")
    assert first.content == second.content
    for name in ("content-type", "etag", "vary"):
        assert first.headers[name] == second.headers[name]
    assert send(live, "/v1/mat", body, precision=6).headers["cache-status"] == "mat; fwd=miss"
    assert send(live, "/v1/mat", body, f="svg").headers["cache-status"] == "mat; fwd=miss"


def test_a_failure_is_not_kept(live: httpx2.Client) -> None:
    for _ in range(2):
        response = send(live, "/v1/mat", {"outer": []})
        refused(response, "invalid-domain")
        assert "cache-status" not in response.headers
        assert "etag" not in response.headers


@pytest.mark.parametrize("path", [*ROUTES, *EXECUTIONS])
def test_what_the_client_has_is_not_sent_again(live: httpx2.Client, path: str) -> None:
    body = body_of(path)
    tag = send(live, path, body).headers["etag"]
    assert tag.startswith('W/"')
    refused(send(live, path, body, {"If-None-Match": tag}), "precondition-failed")
    assert send(live, path, body, {"If-None-Match": '"another"'}).status_code == 200
    refused(send(live, path, body, {"If-Match": tag}), "precondition-failed")
    other = json.loads(json.dumps(body)) | ({} if "inputs" in body else {"note": 1})
    if other != body:
        assert send(live, path, other, {"If-None-Match": tag}).status_code == 200


@pytest.mark.parametrize("path", ["/", "/openapi.json", "/conformance", "/processes", "/processes/mat"])
def test_documents_are_asked_for_again_by_their_tags(live: httpx2.Client, path: str) -> None:
    first = live.get(path)
    again = live.get(path, headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    assert again.headers["etag"] == first.headers["etag"]
    assert again.headers["vary"] == first.headers["vary"]
    assert live.head(path, headers={"If-None-Match": first.headers["etag"]}).status_code == 304
    assert live.get(path, headers={"If-None-Match": 'W/"other"'}).status_code == 200


# the routes of OGC API - Processes


def test_every_link_leads_somewhere(live: httpx2.Client) -> None:
    pages = ["/", "/processes?limit=3&offset=0"]
    seen = set()
    while pages:
        page = pages.pop()
        seen.add(page)
        found = live.get(page)
        assert found.status_code == 200, page
        if found.headers["content-type"] != "application/json" or page.endswith("openapi.json"):
            continue
        document = found.json()
        links = [*document.get("links", ()), *(link for each in document.get("processes", ()) for link in each["links"])]
        for link in links:
            if link["rel"].endswith("/execute"):
                assert live.get(link["href"]).headers["allow"] == "OPTIONS, POST"
            elif link["href"] not in seen:
                pages.append(link["href"])
    assert {f"/processes/{name}" for name in OPERATIONS} <= seen
    assert {"/docs", "/openapi.json", "/conformance"} <= seen


def test_a_browser_is_led_to_the_documentation(live: httpx2.Client) -> None:
    response = live.get("/", headers={"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"}, follow_redirects=False)
    assert (response.status_code, response.headers["location"]) == (307, "docs")
    assert response.headers["vary"] == "Accept"


def test_the_list_has_pages(live: httpx2.Client) -> None:
    names: list[str] = []
    href: str | None = "/processes?limit=3"
    while href:
        page = live.get(href).json()
        assert len(page["processes"]) <= 3
        names += [each["id"] for each in page["processes"]]
        href = next((link["href"] for link in page["links"] if link["rel"] == "next"), None)
    assert names == list(OPERATIONS)


@pytest.mark.parametrize("query", ["limit=0", "limit=1001", "limit=x", "offset=-1", "page=2"])
def test_pages_that_there_are_not(live: httpx2.Client, query: str) -> None:
    refused(live.get(f"/processes?{query}"), "invalid-parameter")


def test_a_process_that_there_is_not(live: httpx2.Client) -> None:
    for response in (live.get("/processes/nope"), send(live, "/processes/nope/execution", {"inputs": {}})):
        document = refused(response, "no-such-process")
        assert document.type.startswith("http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/")


@pytest.mark.parametrize("name", OPERATIONS)
def test_a_description_describes_the_inputs(live: httpx2.Client, name: str) -> None:
    """Each schema resolves against the OpenAPI document, fits the example and refuses nonsense."""
    described = live.get(f"/processes/{name}").json()
    registry = Registry().with_resource(
        "/openapi.json", Resource.from_contents(live.get("/openapi.json").json(), default_specification=_specification())
    )
    body = body_of(f"/v1/{name}")
    assert set(body) <= set(described["inputs"])
    for member, given in body.items():
        schema = described["inputs"][member]["schema"]
        Draft202012Validator(schema, registry=registry).validate(given)
        assert not Draft202012Validator(schema, registry=registry).is_valid("nonsense")
    assert {each for each, one in described["inputs"].items() if one["minOccurs"]} <= set(body)
    media_types = {each["contentMediaType"] for each in described["outputs"]["result"]["schema"]["oneOf"]}
    assert media_types == {FORMATS[form] for form in OPERATIONS[name].formats}


def _specification() -> Any:
    from referencing.jsonschema import DRAFT202012

    return DRAFT202012


@pytest.mark.parametrize("name", OPERATIONS)
def test_executing_answers_what_the_route_below_v1_does(live: httpx2.Client, name: str) -> None:
    body = body_of(f"/v1/{name}")
    expected = send(live, f"/v1/{name}", body)
    path = f"/processes/{name}/execution"
    assert send(live, path, {"inputs": body}).content == expected.content
    qualified = {key: {"value": value} for key, value in body.items()}
    assert send(live, path, {"inputs": qualified}).content == expected.content
    whole = send(live, path, {"inputs": body, "response": "document"})
    assert whole.headers["content-type"] == "application/json"
    assert whole.json() == {"result": {"mediaType": "application/json", "value": expected.json()}}
    for form in OPERATIONS[name].formats:
        outputs = {"result": {"format": {"mediaType": FORMATS[form]}}}
        drawn = send(live, path, {"inputs": body, "outputs": outputs})
        assert drawn.headers["content-type"] == FORMATS[form]
        assert drawn.content == send(live, f"/v1/{name}", body, f=form).content
        kept = send(live, path, {"inputs": body, "outputs": outputs})
        assert (kept.content, kept.headers["content-type"]) == (drawn.content, FORMATS[form])


def test_places_of_problems_are_those_of_the_execute_request(live: httpx2.Client) -> None:
    inputs = {"outer": [{"degree": 1, "control_points": [[0, 0]]}], "options": {"value": {"step": -1}}, "arguments": {"x": 1}}
    problems = refused(send(live, "/processes/width/execution", {"inputs": inputs}), "invalid-domain").problems
    pointers = {problem.pointer for problem in problems}
    assert {"/inputs/options/value/step", "/inputs/arguments/x"} <= pointers
    assert any(pointer.startswith("/inputs/outer/0") for pointer in pointers)


# bodies that are no domain, to every route that takes one

BAD = {
    "nothing": (b"", "not-json"),
    "a word": (b"domain", "not-json"),
    "cut off": (b'{"outer": [', "not-json"),
    "invalid UTF-8": (b'{"outer": "\xff"}', "not-json"),
    "a deep nest": (b"[" * 100_000, "not-json"),
    "a deep nest, closed": (b'{"outer":' + b"[" * 100_000 + b"]" * 100_000 + b"}", "not-json"),
    "a list": (b"[]", "invalid-domain"),
    "null": (b"null", "invalid-domain"),
    "a number": (b"1e308", "invalid-domain"),
    "an unknown member": (b'{"outer": [], "inner": []}', "invalid-domain"),
    "a boolean for a list": (b'{"outer": true}', "invalid-domain"),
}


@pytest.mark.parametrize(("body", "code"), BAD.values(), ids=BAD)
@pytest.mark.parametrize("path", [*ROUTES, *EXECUTIONS])
def test_a_body_that_is_no_request(live: httpx2.Client, path: str, body: bytes, code: str) -> None:
    document = refused(send(live, path, body), code)
    assert document.problems or code == "not-json"


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-1e999", "true", '"1"', "null", "[]", "1e300"])
@pytest.mark.parametrize("path", [*ROUTES, *EXECUTIONS])
def test_a_coordinate_that_is_none(live: httpx2.Client, path: str, number: str) -> None:
    body = body_of(path)
    domain = body.get("inputs", body)
    first = domain["outer"][0]["control_points"]
    damaged = [*first[:-1], ["here", first[-1][1]]]
    domain = domain | {"outer": [domain["outer"][0] | {"control_points": damaged}, *domain["outer"][1:]]}
    text = json.dumps({"inputs": domain} if "inputs" in body else domain).replace('"here"', number)
    document = refused(send(live, path, text.encode()), "invalid-domain")
    prefix = "/inputs" if "inputs" in body else ""
    assert any(problem.pointer.startswith(f"{prefix}/outer/0") for problem in document.problems)


def test_limits_of_edges_and_control_points() -> None:
    edges = sum(len(loop) for loop in (PLATE["outer"], *PLATE.get("holes", [])))
    points = sum(len(edge["control_points"]) for loop in (PLATE["outer"], *PLATE.get("holes", [])) for edge in loop)
    for name, most in (("MAT_MAX_EDGES", edges), ("MAT_MAX_CONTROL_POINTS", points)):
        with serving(environment={name: str(most - 1), "MAT_WORKERS": "1"}) as client:
            for path in ("/v1/mat", "/processes/mat/execution"):
                document = refused(send(client, path, body_of(path)), "too-complex")
                assert str(most) in document.problems[0].message
                assert document.problems[0].pointer == ("/inputs" if "execution" in path else "")
        with serving(environment={name: str(most), "MAT_WORKERS": "1"}) as client:
            assert send(client, "/v1/mat", body_of("/v1/mat")).status_code == 200


def test_no_answer_has_a_number_that_is_none(live: httpx2.Client) -> None:
    """Of all examples, in msgpack, which could hold one where JSON cannot; the models refuse null in its place."""
    for path in EXAMPLES:
        domain = json.loads(path.read_text())
        for name, operation in OPERATIONS.items():
            body = domain | ({"arguments": operation.arguments} if operation.arguments else {})
            document = msgpack.unpackb(send(live, f"/v1/{name}", body, f="msgpack").content)
            assert all(np.isfinite(value) for value in numbers(document).values())
            operation.answer.model_validate(document)


def test_rounding_leaves_the_axis_of_the_library(live: httpx2.Client) -> None:
    domain = Domain.from_dict(body_of("/v1/mat"))
    own = {node.id: node for node in medial_axis(domain).nodes}
    answer = send(live, "/v1/mat", body_of("/v1/mat"), precision=15).json()
    for node in answer["graph"]["nodes"]:
        assert node["point"] == pytest.approx(own[node["id"]].point, rel=1e-13, abs=1e-13)
