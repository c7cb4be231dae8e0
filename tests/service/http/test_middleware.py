"""What surrounds the routes: other origins, keys, defects; with workers that do as they are told."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from starlette.testclient import TestClient

from service.app import create_app
from service.http.middleware import REQUEST_HEADERS
from service.observability.logs import JsonLines
from service.settings import Settings
from tests.service.http.test_keys import digest
from tests.service.test_app import HANDLER, JSON, order, problem, wait_until_ready

PAGE = "https://tools.example"


@contextmanager
def running(**environment: str) -> Iterator[TestClient]:
    # role api: one application of a process may run jobs
    settings = Settings.from_environment({"MAT_WORKERS": "2", "MAT_ROLE": "api", **environment})
    with TestClient(create_app(settings, HANDLER), raise_server_exceptions=False) as client:
        wait_until_ready(client)
        yield client


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    with running(MAT_CORS_ORIGINS=f"{PAGE}, http://localhost:5173", MAT_API_KEYS=digest("secret")) as client:
        yield client


def preflight(client: TestClient, origin: str, method: str = "POST", headers: str = "content-type") -> Any:
    asked = {"Origin": origin, "Access-Control-Request-Method": method, "Access-Control-Request-Headers": headers}
    return client.options("/v1/mat", headers=asked)


def test_a_preflight_is_answered_without_a_key(client: TestClient) -> None:
    response = preflight(client, PAGE, headers=", ".join(REQUEST_HEADERS).lower() + ", content-type")
    assert (response.status_code, response.content) == (204, b"")
    assert response.headers["access-control-allow-origin"] == PAGE
    assert {"GET", "POST", "DELETE"} <= set(response.headers["access-control-allow-methods"].split(", "))
    allowed = {name.lower() for name in response.headers["access-control-allow-headers"].split(", ")}
    assert {name.lower() for name in REQUEST_HEADERS} | {"content-type"} <= allowed
    assert "origin" in response.headers["vary"].lower()
    assert response.headers["x-request-id"]


@pytest.mark.parametrize(
    ("origin", "method", "headers"),
    [("https://evil.example", "POST", "content-type"), (PAGE, "PATCH", "content-type"), (PAGE, "POST", "x-other")],
)
def test_another_preflight_is_a_problem(client: TestClient, origin: str, method: str, headers: str) -> None:
    response = preflight(client, origin, method, headers)
    problem(response, "origin-not-allowed")
    assert response.headers.get("access-control-allow-origin") != "https://evil.example"


def test_a_page_may_read_the_answer_and_our_headers(client: TestClient) -> None:
    headers = JSON | {"Origin": PAGE, "X-API-Key": "secret"}
    response = client.post("/v1/mat", content=order("echo"), headers=headers)
    assert response.status_code == 200
    assert response.headers["access-control-allow-origin"] == PAGE
    assert {"X-Request-ID", "ETag", "Retry-After"} <= set(response.headers["access-control-expose-headers"].split(", "))
    assert [part.strip() for part in response.headers["vary"].split(",")] == ["Accept", "Accept-Encoding", "Origin"]


def test_a_page_may_read_why_it_was_refused(client: TestClient) -> None:
    response = client.post("/v1/mat", content=order("echo"), headers=JSON | {"Origin": PAGE})
    problem(response, "unauthorized")
    assert response.headers["access-control-allow-origin"] == PAGE


def test_another_page_may_not(client: TestClient) -> None:
    response = client.get("/healthz", headers={"Origin": "https://evil.example"})
    assert "access-control-allow-origin" not in response.headers
    assert "Origin" in response.headers["vary"]


def test_without_the_setting_no_origin_is_named() -> None:
    with running() as client:
        assert "access-control-allow-origin" not in client.get("/healthz", headers={"Origin": PAGE}).headers
        response = preflight(client, PAGE)
        assert response.status_code == 204
        assert not any(name.startswith("access-control") for name in response.headers)


def test_any_origin() -> None:
    with running(MAT_CORS_ORIGINS="*") as client:
        assert preflight(client, PAGE).headers["access-control-allow-origin"] == "*"
        response = client.get("/healthz", headers={"Origin": PAGE})
        assert response.headers["access-control-allow-origin"] == "*"
        assert "access-control-allow-credentials" not in response.headers


def test_so_many_requests_of_one_key_and_no_more(caplog: pytest.LogCaptureFixture) -> None:
    """One key is at its limit, the other is served; when the first request ends, the next one is."""
    keys = f"a:{digest('one')},b:{digest('two')}"
    with running(MAT_API_KEYS=keys, MAT_KEY_CONCURRENCY="1", MAT_RESULT_CACHE_BYTES="0") as client:
        one, two = ({"X-API-Key": key} | JSON for key in ("one", "two"))
        answers: list[Any] = []
        thread = threading.Thread(
            target=lambda: answers.append(client.post("/v1/mat", content=order("spin", seconds=1.5), headers=one))
        )
        thread.start()
        time.sleep(0.4)
        with caplog.at_level("INFO", "service.access"):
            refused = client.post("/v1/mat", content=order("echo"), headers=one)
        problem(refused, "too-many-requests")
        line = vars(caplog.records[-1])
        assert (line["client"], line["code"]) == ("a", "too-many-requests")
        assert client.post("/v1/mat", content=order("echo"), headers=two).status_code == 200
        thread.join()
        assert answers[0].status_code == 200
        assert client.post("/v1/mat", content=order("echo"), headers=one).status_code == 200


def test_the_log_knows_the_trace_and_the_key_by_its_name_only(client: TestClient, caplog: pytest.LogCaptureFixture) -> None:
    trace = "0af7651916cd43dd8448eb211c80319c"
    headers = JSON | {"X-API-Key": "secret", "Traceparent": f"00-{trace}-b7ad6b7169203331-01"}
    with caplog.at_level("INFO", "service.access"):
        caplog.handler.setFormatter(JsonLines())
        response = client.post("/v1/mat", content=order("echo", once="logged"), headers=headers)
        client.post("/v1/mat", content=order("echo", once="logged"), headers=headers)
    first, second = map(json.loads, caplog.text.splitlines()[-2:])
    assert (first["trace_id"], first["client"], first["cache"]) == (trace, digest("secret")[:8], None)
    assert second["cache"] == "hit"
    assert response.headers["traceresponse"] == f"00-{trace}-{first['span_id']}-01"
    assert "secret" not in caplog.text


def test_a_defect_anywhere_is_a_problem_with_its_id(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("service.http.middleware.identify", broken)
    response = client.post("/v1/mat", headers={"X-Request-ID": "broken", "Origin": PAGE})
    problem(response, "internal-error")
    assert response.headers["x-request-id"] == "broken"
