"""The figures: what is counted, under which names, and that clients cannot multiply them."""

from __future__ import annotations

import asyncio
import os
import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from prometheus_client.parser import text_string_to_metric_families
from starlette.testclient import TestClient

from service.app import create_app
from service.observability.metrics import LARGEST, SIZE_CLASSES, size_class
from service.observability.processes import resident_bytes
from service.settings import Settings
from tests.service.test_app import wait_until_ready

JSON = {"Content-Type": "application/json"}
HANDLER = "tests.service.handlers"


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    with TestClient(create_app(Settings(workers=2, deadline_seconds=0.5, data_dir=tmp_path), HANDLER)) as client:
        wait_until_ready(client)
        yield client


def figures(client: TestClient) -> dict[str, dict[frozenset[tuple[str, str]], float]]:
    """Every sample by name and labels."""
    found: dict[str, dict[frozenset[tuple[str, str]], float]] = {}
    for family in text_string_to_metric_families(client.get("/metrics").text):
        for sample in family.samples:
            found.setdefault(sample.name, {})[frozenset(sample.labels.items())] = sample.value
    return found


def labels(**given: str) -> frozenset[tuple[str, str]]:
    return frozenset(given.items())


def test_an_answer_is_counted_with_its_time_and_sizes(client: TestClient) -> None:
    body = b'{"do": "echo"}'
    sent = len(client.post("/v1/mat", content=body, headers=JSON).content)
    found = figures(client)
    assert found["mat_requests_total"][labels(route="/v1/mat", method="POST", status="200", code="ok")] == 1
    assert found["mat_request_duration_seconds_count"][labels(route="/v1/mat")] == 1
    assert found["mat_request_body_bytes_total"][labels()] == len(body)
    assert found["mat_response_body_bytes_total"][labels()] > sent
    assert found["mat_queue_wait_seconds_count"][labels()] == 1
    assert found["mat_solve_duration_seconds_count"][labels(size="4KiB")] == 1
    assert found["mat_requests_in_flight"][labels()] == 1  # the one that asks


def test_a_refusal_is_counted_by_its_code_and_an_ended_worker_by_the_reason(client: TestClient) -> None:
    client.post("/v1/mat", content=b'{"do": "spin", "seconds": 9}', headers=JSON)
    client.post("/v1/mat", content=b'{"do": "refuse", "code": "invalid-domain"}', headers=JSON)
    found = figures(client)
    for status, code in (("503", "deadline-exceeded"), ("422", "invalid-domain")):
        assert found["mat_requests_total"][labels(route="/v1/mat", method="POST", status=status, code=code)] == 1
    assert found["mat_worker_kills_total"][labels(reason="deadline")] == 1


def test_clients_cannot_multiply_the_figures(client: TestClient) -> None:
    def size() -> int:
        return sum(len(samples) for samples in figures(client).values())

    for path in ("/nowhere", "/static/nothing"):
        client.request("INVENTED", path)
    client.post("/v1/mat?f=odd", content=b"{}", headers=JSON | {"X-Request-ID": "first"})
    size()  # asking is a request, too
    before = size()
    for number in range(20):
        client.request(f"INVENTED{number}", f"/nowhere/{number}")
        client.request("INVENTED", f"/static/{number}")
        client.post(f"/v1/mat?f=odd{number}", content=b"{}", headers=JSON | {"X-Request-ID": f"{number}"})
    assert size() == before


def test_states_are_read_when_they_are_asked_for(client: TestClient) -> None:
    found = figures(client)
    assert found["mat_ready"][labels()] == 1
    idle = found["mat_workers_idle"][labels()]
    assert idle >= 2
    assert set(found["mat_workers_busy"].values()) == set(found["mat_queue_depth"].values()) == {0}
    (build,) = found["mat_build_info"]
    assert dict(build)["algorithm"] == "test"
    if os.path.exists("/proc/self/statm"):
        # the process of the tests may have started other servers, too
        assert found["mat_processes"][labels(role="nursery")] >= 1
        assert found["mat_processes"][labels(role="worker")] >= idle
        for role in ("web", "nursery", "worker"):
            assert found["mat_resident_memory_bytes"][labels(role=role)] > 1e6


def test_jobs_are_counted_by_state_and_a_store_that_hangs_holds_up_nothing(client: TestClient) -> None:
    def jobs() -> dict[str, float]:
        return {dict(key)["state"]: value for key, value in figures(client)["mat_jobs"].items()}

    assert jobs() == {"accepted": 0, "running": 0, "successful": 0, "failed": 0, "dismissed": 0}
    made = client.post("/v1/mat", content=b'{"do": "echo"}', headers=JSON | {"Prefer": "respond-async"})
    assert made.status_code == 201
    end = time.monotonic() + 20
    while jobs()["successful"] != 1:
        assert time.monotonic() < end
        time.sleep(0.05)
    assert sum(jobs().values()) == 1

    async def hang() -> dict[str, int]:
        await asyncio.sleep(60)
        return {}

    client.app.state.jobs.counts = hang  # type: ignore[attr-defined]
    assert jobs()["successful"] == 1
    assert client.delete(made.headers["location"]).status_code == 200


def test_names_keep_to_the_conventions(client: TestClient) -> None:
    client.post("/v1/mat", content=b'{"do": "echo"}', headers=JSON)
    for family in text_string_to_metric_families(client.get("/metrics").text):
        assert re.fullmatch(r"(mat|process)_[a-z_]+", family.name)
        assert family.documentation.endswith(".") or family.name.startswith("process_")
        if family.type == "histogram":
            assert family.name.endswith("_seconds")


def test_a_scraper_may_ask_for_openmetrics(client: TestClient) -> None:
    response = client.get("/metrics", headers={"Accept": "application/openmetrics-text; version=1.0.0"})
    assert response.headers["content-type"].startswith("application/openmetrics-text")
    assert response.text.endswith("# EOF\n")


def test_sizes_fall_into_few_classes() -> None:
    assert [size_class(limit) for limit, _ in SIZE_CLASSES] == [name for _, name in SIZE_CLASSES]
    assert [size_class(limit + 1) for limit, _ in SIZE_CLASSES] == [*[name for _, name in SIZE_CLASSES][1:], LARGEST]


def test_memory_is_that_of_this_process() -> None:
    if os.path.exists("/proc/self/statm"):
        (own,) = resident_bytes()["web"]
        assert 1e6 < own < 1e11
