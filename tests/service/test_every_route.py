"""What holds for every address of the service, those that are added later included."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
from fastapi.routing import iter_route_contexts
from starlette.testclient import TestClient

from service.app import create_app
from service.http.keys import is_open
from service.settings import KIB, MIB, Settings
from tests.service.http.test_keys import digest
from tests.service.test_app import HANDLER, problem, wait_until_ready

JSON, LINES = ({"Content-Type": f"application/{name}"} for name in ("json", "x-ndjson"))
PARAMETERS = {"process_id": "mat"}
"""What stands for the parameters of an address; anything else is called `unknown`."""


def addresses() -> dict[str, set[str]]:
    """Every address with its methods."""
    found: dict[str, set[str]] = {}
    for route in iter_route_contexts(create_app(Settings()).routes):
        assert route.path is not None
        if route.methods is not None:  # mounted files have none
            path = re.sub(r"\{([a-z_]+)[^}]*\}", lambda match: PARAMETERS.get(match[1], "unknown"), route.path)
            found.setdefault(path, set()).update(route.methods)
    return found


ADDRESSES = addresses()
EVERY = [(method, path) for path, methods in ADDRESSES.items() for method in sorted(methods - {"HEAD"})]
GETS = [path for method, path in EVERY if method == "GET"]
POSTS = [path for method, path in EVERY if method == "POST"]


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    settings = Settings(workers=1, max_body_bytes=MIB, max_batch_bytes=MIB, role="api")
    with TestClient(create_app(settings, HANDLER), raise_server_exceptions=False, follow_redirects=False) as client:
        wait_until_ready(client)
        yield client


@pytest.fixture(scope="module")
def guarded() -> Iterator[TestClient]:
    """The same with a key."""
    settings = Settings.from_environment({"MAT_WORKERS": "1", "MAT_ROLE": "api", "MAT_API_KEYS": f"cam:{digest('secret')}"})
    with TestClient(create_app(settings, HANDLER), raise_server_exceptions=False, follow_redirects=False) as client:
        wait_until_ready(client)
        yield client


def test_there_are_some() -> None:
    assert {"/", "/healthz", "/docs", "/openapi.json", "/processes/mat", "/conformance"} <= set(GETS)
    assert {"/v1/mat", "/v1/offset", "/processes/mat/execution"} <= set(POSTS)


def kind_of(path: str) -> dict[str, str]:
    """The media type of the bodies of an address."""
    return LINES if path == "/v1/batches" else JSON


def send(client: TestClient, method: str, path: str, **more: Any) -> Any:
    """One request; POSTs have a body that the test's worker echoes."""
    content = {"content": b'{"do": "echo"}'} if method == "POST" else {}
    headers = {**(kind_of(path) if method == "POST" else {}), **more.pop("headers", {})}
    return client.request(method, path, headers=headers, **(content | more))


@pytest.mark.parametrize(("method", "path"), EVERY)
def test_an_unknown_parameter_is_refused_and_the_known_ones_named(client: TestClient, method: str, path: str) -> None:
    document = problem(send(client, method, path, params={"nonsense": "1"}), "invalid-parameter")
    assert document["detail"].startswith("nonsense: not a parameter; ")


@pytest.mark.parametrize(("method", "path"), EVERY)
def test_ids_and_traces_come_back(client: TestClient, method: str, path: str) -> None:
    trace = "0af7651916cd43dd8448eb211c80319c"
    headers = {"X-Request-ID": "an-id", "Traceparent": f"00-{trace}-b7ad6b7169203331-01"}
    response = send(client, method, path, headers=headers)
    assert response.headers["x-request-id"] == "an-id"
    assert response.headers["traceresponse"].split("-")[1] == trace


BAD_HEADERS: dict[str, dict[str, str | bytes]] = {
    "an id of other letters": {"X-Request-ID": "ä".encode("latin-1")},
    "an id with a line break": {"X-Request-ID": "a\nb"},
    "a trace of nonsense": {"Traceparent": "\xff".encode("latin-1")},
    "an Accept of nonsense": {"Accept": b"\x01;;;q=,,=\xff, */*"},
    "a quality that is no number": {"Accept": "*/*;q=nan"},
    "a Content-Length of other digits": {"Content-Length": "²".encode("latin-1")},
    "tags of nonsense": {"If-None-Match": b'W/", \xff"', "If-Modified-Since": "yesterday"},
    "a range": {"Range": "bytes=0-0"},
    "a preference of nonsense": {"Prefer": "\xff=;,,=".encode("latin-1")},
    "a host of nonsense": {"Host": "a b"},
}


@pytest.mark.parametrize("headers", BAD_HEADERS.values(), ids=BAD_HEADERS)
@pytest.mark.parametrize(("method", "path"), EVERY)
def test_bad_headers_do_no_harm(client: TestClient, method: str, path: str, headers: dict[str, str | bytes]) -> None:
    response = send(client, method, path, headers=headers)
    assert response.status_code < 500
    if response.status_code >= 400:
        problem(response, response.json()["code"])


@pytest.mark.parametrize(("method", "path"), EVERY)
def test_a_header_field_that_is_too_long(client: TestClient, method: str, path: str) -> None:
    problem(send(client, method, path, headers={"Accept": "*/*," * (3 * KIB)}), "header-too-large")


@pytest.mark.parametrize("path", ADDRESSES)
@pytest.mark.parametrize("method", ["PUT", "PATCH", "TRACE", "BREW"])
def test_other_methods_are_refused_and_the_right_ones_named(client: TestClient, method: str, path: str) -> None:
    response = client.request(method, path)
    problem(response, "method-not-allowed")
    assert ADDRESSES[path] <= set(response.headers["allow"].split(", "))


@pytest.mark.parametrize("path", ADDRESSES)
def test_options_names_the_methods(client: TestClient, path: str) -> None:
    response = client.options(path)
    assert (response.status_code, response.content) == (204, b"")
    allowed = set(response.headers["allow"].split(", "))
    assert allowed - {"HEAD", "OPTIONS"} == ADDRESSES[path] - {"HEAD"}
    assert ("HEAD" in allowed) == ("GET" in allowed)


@pytest.mark.parametrize("path", GETS)
def test_head_is_get_without_the_body(client: TestClient, path: str) -> None:
    whole, head = client.get(path), client.head(path)
    assert head.status_code == whole.status_code
    assert head.content == b""
    if path != "/metrics":  # whose figures count these very requests
        assert head.headers.get("content-length") == whole.headers.get("content-length")
    assert head.headers.get("etag") == whole.headers.get("etag")


@pytest.mark.parametrize("path", [path for path in POSTS if path not in GETS])
def test_head_of_what_is_only_posted_to(client: TestClient, path: str) -> None:
    response = client.head(path)
    assert (response.status_code, response.content) == (405, b"")
    assert "POST" in response.headers["allow"]


@pytest.mark.parametrize("path", [path for path in ADDRESSES if path != "/"])
@pytest.mark.parametrize("more", ["/", "/more", "%00", "\N{SNOWMAN}"])
def test_what_is_not_there(client: TestClient, path: str, more: str) -> None:
    response = client.get(path + more)
    document = problem(response, response.json()["code"])
    assert response.status_code == 404
    assert (document["code"] == "not-found") or (path, more) in ALSO_THERE or path == "/processes/mat"


ALSO_THERE = {("/processes", "/more"), ("/jobs", "/more"), ("/v1/jobs", "/more")}
"""Addresses that a parameter stands for, without what it asks for."""


@pytest.mark.parametrize("path", POSTS)
def test_a_body_that_is_too_large(client: TestClient, path: str) -> None:
    problem(client.post(path, content=b" " * (MIB + 1), headers=kind_of(path)), "body-too-large")


@pytest.mark.parametrize("path", POSTS)
@pytest.mark.parametrize("headers", [{"Content-Type": "text/xml"}, {"Content-Encoding": "br"}, {"Content-Type": "\xff"}])
def test_a_body_of_another_kind(client: TestClient, path: str, headers: dict[str, str]) -> None:
    given = {name: value.encode("latin-1") for name, value in (kind_of(path) | headers).items()}
    problem(client.post(path, content=b"{}", headers=given), "unsupported-media-type")


@pytest.mark.parametrize("path", POSTS)
def test_a_body_that_is_no_gzip(client: TestClient, path: str) -> None:
    problem(client.post(path, content=b"{}", headers=kind_of(path) | {"Content-Encoding": "gzip"}), "not-gzip")


@pytest.mark.parametrize(("method", "path"), EVERY)
def test_without_a_key_only_what_is_open_answers(guarded: TestClient, method: str, path: str) -> None:
    response = send(guarded, method, path)
    if is_open(path, metrics_open=False):
        assert method == "GET"
        assert response.status_code in (200, 307)
    else:
        problem(response, "unauthorized")
        assert response.headers["www-authenticate"].startswith("Bearer")


@pytest.mark.parametrize(("method", "path"), EVERY)
def test_with_a_key_everything_answers(guarded: TestClient, method: str, path: str) -> None:
    assert send(guarded, method, path, headers={"X-API-Key": "secret"}).status_code != 401


def test_an_unknown_address_needs_a_key_too(guarded: TestClient) -> None:
    problem(guarded.get("/nope"), "unauthorized")
    problem(guarded.get("/nope", headers={"Authorization": "Bearer secret"}), "not-found")
