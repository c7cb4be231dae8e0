"""The web side of the service, with workers that do as they are told: every error, and the frame of every answer."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from service import __version__
from service.app import create_app
from service.errors import ERRORS, MEDIA_TYPE, OGC
from service.http.negotiation import FORMATS
from service.operations import OPERATIONS
from service.settings import KIB, MIB, Settings

JSON = {"Content-Type": "application/json"}
HANDLER = "tests.service.handlers"


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    settings = Settings(workers=1, deadline_seconds=1.0, queue_limit=1, max_body_bytes=MIB, result_cache_bytes=0)
    with TestClient(create_app(settings, HANDLER), raise_server_exceptions=False) as client:
        wait_until_ready(client)
        yield client


def wait_until_ready(client: TestClient) -> None:
    end = time.monotonic() + 20
    while client.get("/readyz").status_code != 200:
        assert time.monotonic() < end
        time.sleep(0.05)


def order(do: str, **content: Any) -> bytes:
    return json.dumps({"do": do, **content}).encode()


def problem(response: Any, code: str) -> dict[str, Any]:
    """Hold that a response is a complete problem document of a code, and return the document."""
    kind = ERRORS[code]
    document: dict[str, Any] = response.json()
    assert response.status_code == kind.status
    assert response.headers["content-type"] == MEDIA_TYPE
    assert document["type"] in (kind.uri, f"urn:mat:problem:{code}", f"{OGC}/no-such-job")
    assert (document["title"], document["status"], document["code"]) == (kind.title, kind.status, code)
    assert document["detail"]
    assert isinstance(document["problems"], list)
    assert ("retry-after" in response.headers) == (kind.retry_after_seconds is not None) == (kind.status in (429, 503))
    assert response.headers["cache-control"] == "no-store"
    assert document["request_id"] == response.headers["x-request-id"]
    return document


@pytest.mark.parametrize("path", ["/", "/healthz", "/readyz", "/version", "/docs", "/openapi.json"])
def test_what_is_there_answers(client: TestClient, path: str) -> None:
    assert client.get(path).status_code == 200


def test_versions(client: TestClient) -> None:
    assert client.get("/version").json() == {"service": __version__, "algorithm": "test"}


@pytest.mark.parametrize("path", ["/nope", "/v1", "/v1/mat/", "/static/nope.js", "/static/../app.py", "/docs/"])
def test_what_is_not_there_is_a_problem(client: TestClient, path: str) -> None:
    problem(client.get(path), "not-found")


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", "/v1/mat"),
        ("DELETE", "/v1/mat"),
        ("POST", "/healthz"),
        ("PUT", "/docs"),
        ("POST", "/static/favicon.png"),
    ],
)
def test_the_wrong_method_is_a_problem_that_names_the_right_ones(client: TestClient, method: str, path: str) -> None:
    response = client.request(method, path)
    problem(response, "method-not-allowed")
    assert response.headers["allow"]


def test_an_answer_carries_its_times(client: TestClient) -> None:
    response = client.post("/v1/mat", content=order("echo"), headers=JSON)
    assert response.status_code == 200
    assert response.headers["content-type"] == "application/json"
    assert response.headers["server-timing"].startswith("queue;dur=")
    assert response.headers["vary"] == "Accept, Accept-Encoding"


@pytest.mark.parametrize("request_id", ["abc-123", "0af7651916cd43dd8448eb211c80319c", "a" * 128])
def test_a_request_id_comes_back(client: TestClient, request_id: str) -> None:
    response = client.get("/nope", headers={"X-Request-ID": request_id})
    assert response.headers["x-request-id"] == response.json()["request_id"] == request_id


@pytest.mark.parametrize("request_id", ["", "a" * 129, "a b", 'a"b', "<script>"])
def test_an_id_that_could_do_harm_is_replaced(client: TestClient, request_id: str) -> None:
    response = client.get("/healthz", headers={"X-Request-ID": request_id})
    assert response.headers["x-request-id"] != request_id
    assert len(response.headers["x-request-id"]) == 32


@pytest.mark.parametrize(
    "content_type",
    [
        "application/json",
        "application/json; charset=utf-8",
        'Application/JSON; charset="UTF-8"',
        "application/vnd.mat+json",
    ],
)
def test_json_by_any_of_its_names(client: TestClient, content_type: str) -> None:
    response = client.post("/v1/mat", content=order("echo"), headers={"Content-Type": content_type})
    assert response.status_code == 200


def test_no_content_type_is_taken_as_json(client: TestClient) -> None:
    request = client.build_request("POST", "/v1/mat", content=order("echo"))
    request.headers.pop("content-type", None)
    assert client.send(request).status_code == 200


@pytest.mark.parametrize(
    "headers",
    [
        {"Content-Type": "application/x-www-form-urlencoded"},
        {"Content-Type": "multipart/form-data; boundary=x"},
        {"Content-Type": "text/plain"},
        {"Content-Type": "text/json"},
        {"Content-Type": ""},
        {"Content-Type": ";;;"},
        {"Content-Type": "application/json; charset=utf-16"},
        {"Content-Type": "application/json", "Content-Encoding": "deflate"},
        {"Content-Type": "application/json", "Content-Encoding": "br, gzip"},
    ],
)
def test_other_bodies_are_refused(client: TestClient, headers: dict[str, str]) -> None:
    problem(client.post("/v1/mat", content=order("echo"), headers=headers), "unsupported-media-type")


@pytest.mark.parametrize("accept", ["text/html", "application/xml", "image/png", "application/*;q=0, image/*;q=0"])
def test_a_format_that_there_is_not(client: TestClient, accept: str) -> None:
    problem(client.post("/v1/mat", content=order("echo"), headers=JSON | {"Accept": accept}), "not-acceptable")


@pytest.mark.parametrize(("path", "f"), [(f"/v1/{o.name}", f) for o in OPERATIONS.values() for f in o.formats])
def test_every_route_answers_in_its_formats(client: TestClient, path: str, f: str) -> None:
    for choice in ({"params": {"f": f}}, {"headers": {"Accept": FORMATS[f]}}):
        response = client.post(path, content=order("echo"), **choice)
        assert response.status_code == 200
        assert response.headers["content-type"] == FORMATS[f]
        assert response.headers["vary"] == "Accept, Accept-Encoding"


def test_a_format_of_another_route(client: TestClient) -> None:
    document = problem(client.post("/v1/width", params={"f": "dxf"}, content=order("echo"), headers=JSON), "invalid-parameter")
    assert "json" in document["detail"]
    problem(client.post("/v1/width", content=order("echo"), headers=JSON | {"Accept": "image/vnd.dxf"}), "not-acceptable")


@pytest.mark.parametrize("f", ["xml", "", "JSON", "json\x00"])
def test_an_unknown_format_parameter(client: TestClient, f: str) -> None:
    problem(client.post("/v1/mat", params={"f": f}, content=order("echo"), headers=JSON), "invalid-parameter")


def test_a_body_announced_as_too_large(client: TestClient) -> None:
    document = problem(client.post("/v1/mat", content=b" " * (MIB + 1), headers=JSON), "body-too-large")
    assert str(MIB) in document["detail"]


def test_a_body_that_turns_out_too_large(client: TestClient) -> None:
    chunks = (b" " * (64 * KIB) for _ in range(17))
    problem(client.post("/v1/mat", content=chunks, headers=JSON), "body-too-large")


def test_a_chunked_body_within_the_limit(client: TestClient) -> None:
    content = order("echo")
    chunks = (content[i : i + 1] for i in range(len(content)))
    assert client.post("/v1/mat", content=chunks, headers=JSON).status_code == 200


@pytest.mark.parametrize("code", ["not-json", "invalid-domain", "too-complex", "not-certified", "internal-error"])
def test_what_a_worker_refuses(client: TestClient, code: str) -> None:
    extra = {"problems": [{"code": "open-loop", "pointer": "/outer"}]}
    document = problem(client.post("/v1/mat", content=order("refuse", code=code, extra=extra), headers=JSON), code)
    assert document["detail"] == "as ordered"
    assert document["problems"] == extra["problems"]


def test_a_worker_that_crashes(client: TestClient) -> None:
    problem(client.post("/v1/mat", content=order("crash"), headers=JSON), "worker-crashed")
    assert client.post("/v1/mat", content=order("echo"), headers=JSON).status_code == 200


def test_a_full_queue_and_a_deadline_while_health_answers(client: TestClient) -> None:
    """One request works until its deadline, one waits, one is refused; nothing of it slows the health check."""
    results: list[Any] = []

    def send() -> None:
        results.append(client.post("/v1/mat", content=order("sleep", seconds=30), headers=JSON))

    threads = [threading.Thread(target=send) for _ in range(2)]
    for thread in threads:
        thread.start()
        time.sleep(0.15)
    begun = time.monotonic()
    assert client.get("/healthz").status_code == 200
    assert time.monotonic() - begun < 0.2
    problem(client.get("/readyz"), "queue-full")
    problem(client.post("/v1/mat", content=order("echo"), headers=JSON), "queue-full")
    for thread in threads:
        thread.join()
    for response in results:
        problem(response, "deadline-exceeded")
    assert client.post("/v1/mat", content=order("echo"), headers=JSON).status_code == 200


def test_a_service_that_is_still_loading_lives_but_is_not_ready() -> None:
    settings = Settings(workers=1, deadline_seconds=0.2)
    with TestClient(create_app(settings, "tests.service.no_such_module")) as client:
        assert client.get("/healthz").status_code == 200
        assert client.get("/version").json()["algorithm"] == "unknown"
        document = problem(client.get("/readyz"), "not-ready")
        assert document["failed"] or document["detail"] == "Loading the library."
        problem(client.post("/v1/mat", content=order("echo"), headers=JSON), "deadline-exceeded")


def test_a_defect_of_the_web_side_is_a_problem_too(monkeypatch: pytest.MonkeyPatch, client: TestClient) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("service.routes.solve.check_content", broken)
    document = problem(client.post("/v1/mat", content=order("echo"), headers=JSON), "internal-error")
    assert "ZeroDivision" not in json.dumps(document)


def test_the_documentation_needs_nothing_from_elsewhere(client: TestClient) -> None:
    page = client.get("/docs").text
    assert "http://" not in page
    assert "https://" not in page
    for name in ("swagger-ui-bundle.js", "swagger-ui.css", "favicon.png"):
        assert f"static/{name}" in page
        assert client.get(f"/static/{name}").status_code == 200
    folder = Path(__file__).resolve().parents[2] / "service" / "static"
    assert (folder / "swagger-ui.LICENSE.txt").read_text().lstrip().startswith("Apache License")
