"""Disks that are full and rows that were written before: what becomes of a job."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from service.app import create_app
from service.jobs import calls, executor, work
from service.jobs.blobs import Blobs
from service.jobs.store import CHUNKS_AHEAD, Store
from service.settings import Settings
from tests.service.jobs.test_routes import HANDLER, post, send, until
from tests.service.processes import eventually
from tests.service.test_app import problem, wait_until_ready


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    settings = Settings(workers=2, data_dir=tmp_path_factory.mktemp("jobs"), batch_chunk=1, long_priority="normal")
    with TestClient(create_app(settings, HANDLER)) as client:
        wait_until_ready(client)
        yield client


def no_space(*_: object) -> str:
    raise OSError(28, "No space left on device")


def test_what_cannot_be_stored_is_refused(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(Blobs, "adopt_all", no_space)
        problem(post(client, {}), "store-unavailable")
        problem(send(client, b"{}\n"), "store-unavailable")
    assert client.get("/v1/jobs").json()["jobs"] == []
    until(client, post(client, {}).json()["jobID"], "successful")


@pytest.mark.parametrize("batch", [False, True], ids=["one domain", "a batch"])
def test_a_job_that_the_database_does_not_take_in_time_is_refused_and_not_made_twice(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, batch: bool
) -> None:
    def make() -> Any:
        key = {"Idempotency-Key": f"late {batch}"}
        return send(client, b"{}\n", **key) if batch else post(client, {}, **key)

    before = len(client.get("/v1/jobs").json()["jobs"])
    insert, thawed = Store.insert, threading.Event()
    with monkeypatch.context() as patch:
        patch.setattr(calls, "MUCH_SECONDS", 0.2)
        patch.setattr(Store, "insert", lambda *given: thawed.wait() and insert(*given))
        try:
            problem(make(), "store-unavailable")
        finally:
            thawed.set()
    eventually(lambda: len(client.get("/v1/jobs").json()["jobs"]) == before + 1)
    until(client, make().json()["jobID"], "successful")
    assert len(client.get("/v1/jobs").json()["jobs"]) == before + 1


def test_a_result_that_cannot_be_stored_is_tried_again(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    job = post(client, {"name": "patient", "seconds": 0.5}).json()["jobID"]
    tried: list[object] = []
    with monkeypatch.context() as patch:
        patch.setattr(Blobs, "adopt_all", lambda *given: tried.append(given) or no_space())
        eventually(lambda: bool(tried))
    assert client.get(f"/v1/jobs/{job}").json()["status"] == "running"
    until(client, job, "successful")
    assert client.get(f"/v1/jobs/{job}/results").json() == {"did": {"name": "patient", "seconds": 0.5}}


def test_a_result_that_still_cannot_be_stored_fails_its_job(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(work, "STORING_SECONDS", 0.0)
    job = post(client, {"seconds": 0.5}).json()["jobID"]
    monkeypatch.setattr(Blobs, "adopt_all", no_space)
    until(client, job, "failed")
    problem(client.get(f"/v1/jobs/{job}/results"), "store-unavailable")


def test_a_batch_of_more_chunks_than_are_enqueued_at_a_time_comes_to_its_end(client: TestClient) -> None:
    count = 2 * CHUNKS_AHEAD + 7
    job = send(client, b"".join(b'{"name": %d}\n' % k for k in range(count))).json()["jobID"]
    assert until(client, job, "successful", "failed").message == f"{count} domains, 0 of them failed."
    results = [json.loads(line)["did"]["name"] for line in client.get(f"/v1/jobs/{job}/results").text.splitlines()]
    assert results == list(range(count))


def test_small_jobs_do_not_wait_for_a_poll(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those made here begin at once: the way round DBOS's own loop still works with the version that is installed."""
    jobs = client.app.state.jobs._keeper._executor  # type: ignore[attr-defined]
    claimed: list[Any] = []
    begin = executor.execute_dequeued_workflow
    monkeypatch.setattr(executor, "execute_dequeued_workflow", lambda *given: claimed.append(given) or begin(*given))
    for k in range(20):
        until(client, post(client, {"name": k}).json()["jobID"], "successful")
    assert jobs is not None
    assert len(claimed) > 10  # a poll may come first now and then


def test_a_second_application_of_the_process_waits_for_the_first(client: TestClient, tmp_path: Path) -> None:
    with TestClient(create_app(Settings(workers=1, data_dir=tmp_path), HANDLER)) as second:
        assert second.get("/readyz").status_code == 503
        problem(second.get("/v1/jobs"), "store-unavailable")
    assert client.get("/v1/jobs").status_code == 200
