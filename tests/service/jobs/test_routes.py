"""The routes of jobs, with workers that do as they are told: what they answer, and what they refuse."""

from __future__ import annotations

import gzip
import json
import logging
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from starlette.testclient import TestClient

from service.app import create_app
from service.jobs.blobs import Blobs
from service.jobs.dbos_jobs import DbosJobs
from service.orders import Order
from service.schemas import JobList, JobStatus
from service.settings import KIB, Settings
from tests.service.jobs.servers import ASYNC, LINES
from tests.service.processes import eventually
from tests.service.test_app import JSON, problem, wait_until_ready

HANDLER = "tests.service.jobs.handlers"
UNKNOWN = "0" * 32


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("jobs")


@pytest.fixture(scope="module")
def client(folder: Path) -> Iterator[TestClient]:
    settings = Settings(
        workers=1, data_dir=folder, max_body_bytes=64 * KIB, max_batch_bytes=256 * KIB, batch_chunk=2, deadline_seconds=20,
        long_priority="normal",
    )  # fmt: skip
    with TestClient(create_app(settings, HANDLER), raise_server_exceptions=False) as client:
        wait_until_ready(client)
        yield client


def post(client: TestClient, order: Any, **headers: str) -> Any:
    return client.post("/v1/mat", content=json.dumps(order), headers=ASYNC | headers)


def until(client: TestClient, job: str, *states: str) -> JobStatus:
    end = time.monotonic() + 30
    while True:
        document = JobStatus.model_validate_json(client.get(f"/v1/jobs/{job}").text)
        if document.status in states:
            return document
        assert time.monotonic() < end, document
        time.sleep(0.01)


def finished(client: TestClient, order: Any) -> str:
    job = str(post(client, order).json()["jobID"])
    until(client, job, "successful", "failed")
    return job


def test_a_job_is_made_and_its_results_are_the_answer(client: TestClient) -> None:
    made = post(client, {"name": "first"})
    assert made.status_code == 201
    assert made.headers["preference-applied"] == "respond-async"
    document = JobStatus.model_validate_json(made.text)
    assert made.headers["location"] == f"/v1/jobs/{document.jobID}"
    assert (document.type, document.processID, document.status) == ("process", "mat", "accepted")
    over = until(client, document.jobID, "successful")
    assert over.progress == 100
    assert over.started is not None
    assert over.finished is not None
    assert over.created <= over.started <= over.finished == over.updated
    (results,) = (link.href for link in over.links if link.rel.endswith("/results"))
    answer = client.get(results)
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "application/json"
    assert answer.content == client.post("/v1/mat", content=json.dumps({"name": "first"}), headers=JSON).content


def test_results_keep_the_format_that_was_asked_for(client: TestClient) -> None:
    job = post(client, {"name": "drawn"}, Accept="image/svg+xml").json()["jobID"]
    until(client, job, "successful")
    assert client.get(f"/v1/jobs/{job}/results").headers["content-type"] == "image/svg+xml"


def test_an_answer_that_comes_in_time_needs_no_job(client: TestClient) -> None:
    response = post(client, {"name": "quick"}, Prefer="respond-async, wait=20")
    assert response.status_code == 200
    assert response.headers["preference-applied"] == "respond-async, wait=20"
    assert response.json() == {"did": {"name": "quick"}}


def test_an_answer_that_does_not_come_in_time_becomes_a_job(client: TestClient) -> None:
    response = post(client, {"seconds": 1.5}, Prefer="respond-async, wait=1")
    assert response.status_code == 201
    assert response.headers["location"]
    until(client, response.json()["jobID"], "successful")


def test_a_failure_that_comes_in_time_is_answered_as_such(client: TestClient) -> None:
    problem(post(client, {"error": "invalid-domain"}, Prefer="respond-async, wait=20"), "invalid-domain")


def test_to_wait_alone_is_a_deadline(client: TestClient) -> None:
    assert client.post("/v1/mat", content=b"{}", headers=JSON | {"Prefer": "wait=9"}).headers["preference-applied"] == "wait=9"
    late = client.post("/v1/mat", content=b'{"seconds": 5}', headers=JSON | {"Prefer": "wait=1"})
    problem(late, "deadline-exceeded")


@pytest.mark.parametrize("wish", ["wait=0", "respond-async=yes", "nonsense", ";;;", "return=minimal"])
def test_other_wishes_are_passed_over(client: TestClient, wish: str) -> None:
    response = client.post("/v1/mat", content=b"{}", headers=JSON | {"Prefer": wish})
    assert response.status_code == 200
    assert "preference-applied" not in response.headers


def test_a_failed_job_answers_with_its_own_problem(client: TestClient) -> None:
    fault = {"code": "open-loop", "pointer": "/outer/0", "message": "it is open"}
    job = finished(client, {"error": "invalid-domain", "problems": [fault]})
    document = until(client, job, "failed")
    assert document.message.startswith("invalid-domain: ")
    assert problem(client.get(f"/v1/jobs/{job}/results"), "invalid-domain")["problems"] == [fault]


def test_what_is_wrong_with_a_body_is_told_at_once_and_is_no_job(client: TestClient) -> None:
    before = client.get("/v1/jobs").json()["jobs"]
    problem(client.post("/v1/mat", content=b"{]", headers=ASYNC | {"Idempotency-Key": "mend it"}), "not-json")
    assert client.get("/v1/jobs").json()["jobs"] == before
    assert post(client, {}, **{"Idempotency-Key": "mend it"}).status_code == 201


def test_a_body_that_workers_have_no_time_to_look_at_is_left_to_its_job(client: TestClient) -> None:
    made = post(client, {"name": "unseen", "look_seconds": 30})
    assert made.status_code == 201
    until(client, made.json()["jobID"], "successful")


def test_a_worker_that_dies_each_time_fails_its_job(client: TestClient) -> None:
    job = finished(client, {"crash": True})
    problem(client.get(f"/v1/jobs/{job}/results"), "worker-crashed")


def test_what_async_requests_are_refused_for(client: TestClient) -> None:
    problem(client.post("/v1/mat", content=b"x" * 65 * KIB, headers=ASYNC), "body-too-large")
    problem(client.post("/v1/mat", content=b"{}", headers=ASYNC | {"Content-Type": "text/plain"}), "unsupported-media-type")
    problem(client.post("/v1/mat?f=png", content=b"{}", headers=ASYNC), "invalid-parameter")


def test_a_running_job_has_no_results_and_is_stopped_by_its_dismissal(client: TestClient) -> None:
    job = post(client, {"name": "endless", "seconds": 600}).json()["jobID"]
    until(client, job, "running")
    problem(client.get(f"/v1/jobs/{job}/results"), "result-not-ready")
    assert client.delete(f"/v1/jobs/{job}").json()["status"] == "dismissed"
    assert post(client, {}, Prefer="respond-async, wait=20").status_code == 200  # the one worker is free again
    assert until(client, job, "dismissed").finished is not None
    problem(client.get(f"/v1/jobs/{job}/results"), "job-dismissed")
    assert client.delete(f"/v1/jobs/{job}").status_code == 200
    problem(client.get(f"/v1/jobs/{job}"), "not-found")


def test_a_waiting_job_is_dismissed_before_it_begins(client: TestClient, folder: Path) -> None:
    first = post(client, {"seconds": 600}).json()["jobID"]
    until(client, first, "running")
    jobs = [post(client, {"name": f"waiting {k}"}).json()["jobID"] for k in range(4)]
    for job in (*jobs, first):
        assert client.delete(f"/v1/jobs/{job}").json()["status"] == "dismissed"
    assert post(client, {}, Prefer="respond-async, wait=20").status_code == 200
    assert {client.get(f"/v1/jobs/{job}").json()["status"] for job in jobs} == {"dismissed"}


def test_progress_is_told_and_never_goes_back(client: TestClient) -> None:
    job = post(client, {"seconds": 1}).json()["jobID"]
    until(client, job, "running")
    seen: list[int] = []

    def over() -> bool:
        seen.append(client.get(f"/v1/jobs/{job}").json()["progress"])
        return seen[-1] == 100

    eventually(over, seconds=30)
    assert seen == sorted(seen)
    assert set(seen) & {49}


@pytest.mark.parametrize("job", [UNKNOWN, "x", "..%2F..", "%00", "é", "'; DROP TABLE mat_jobs;--"])
@pytest.mark.parametrize(("method", "rest"), [("GET", ""), ("GET", "/results"), ("DELETE", "")])
def test_a_job_that_is_unknown(client: TestClient, method: str, rest: str, job: str) -> None:
    problem(client.request(method, f"/v1/jobs/{job}{rest}"), "not-found")


@pytest.mark.parametrize(("method", "path"), [("POST", "/v1/jobs"), ("PUT", f"/v1/jobs/{UNKNOWN}"), ("GET", "/v1/batches")])
def test_what_jobs_do_not_take(client: TestClient, method: str, path: str) -> None:
    problem(client.request(method, path), "method-not-allowed")


def test_the_list_has_every_job_once_and_the_newest_first(client: TestClient) -> None:
    made = [post(client, {"name": k}).json()["jobID"] for k in range(5)]
    pages, path = [], "/v1/jobs?limit=2"
    while path:
        page = JobList.model_validate_json(client.get(path).text)
        assert len(page.jobs) <= 2
        pages += [job.jobID for job in page.jobs]
        following = [link.href for link in page.links if link.rel == "next"]
        assert [parse_qs(urlsplit(link).query)["next"][0] for link in following] == ([page.next] if page.next else [])
        path = following[0] if following else ""
    assert pages[:5] == made[::-1]
    assert len(pages) == len(set(pages))
    assert pages == [job["jobID"] for job in client.get("/v1/jobs?limit=1000").json()["jobs"]]


BAD_TOKENS = ("x", "%F0", "bnVsbA", "WzEsIDJd", "", "x" * 201)


@pytest.mark.parametrize("query", ["limit=0", "limit=1001", "limit=ten", *(f"next={token}" for token in BAD_TOKENS)])
def test_a_list_that_cannot_be(client: TestClient, query: str) -> None:
    problem(client.get(f"/v1/jobs?{query}"), "invalid-parameter")


def test_the_same_key_and_body_is_the_same_job(client: TestClient) -> None:
    key = {"Idempotency-Key": "once"}
    jobs = {post(client, {"name": "once"}, **key).json()["jobID"] for _ in range(3)}
    assert len(jobs) == 1
    until(client, jobs.pop(), "successful")
    assert post(client, {"name": "once"}, **key).json()["status"] == "successful"


@pytest.mark.parametrize("change", ["body", "route", "format", "batch"])
def test_the_same_key_for_another_request_is_refused(client: TestClient, change: str) -> None:
    key = {"Idempotency-Key": f"other {change}"}
    assert post(client, {"name": "one"}, **key).status_code == 201
    body = json.dumps({"name": "two" if change == "body" else "one"})
    headers = ASYNC | key | ({"Accept": "image/svg+xml"} if change == "format" else {})
    route = "/v1/batches" if change == "batch" else "/v1/prune" if change == "route" else "/v1/mat"
    problem(client.post(route, content=body, headers=headers | (LINES if change == "batch" else {})), "idempotency-key-reused")


def test_a_key_in_flight_is_told_from_one_that_was_used(client: TestClient) -> None:
    jobs: DbosJobs = client.app.state.jobs  # type: ignore[attr-defined]
    with jobs._receive(None, "slow"):
        problem(post(client, {}, **{"Idempotency-Key": "slow"}), "idempotency-key-in-flight")
    assert post(client, {}, **{"Idempotency-Key": "slow"}).status_code == 201


@pytest.mark.parametrize("key", [b"", b" ", b"x" * 256, "é".encode(), b"a\tb"])
def test_a_key_that_is_none(client: TestClient, key: bytes) -> None:
    headers = [*((name.encode(), value.encode()) for name, value in ASYNC.items()), (b"Idempotency-Key", key)]
    problem(client.post("/v1/mat", content=b"{}", headers=headers), "invalid-parameter")


def test_jobs_and_keys_belong_to_their_owner(client: TestClient) -> None:
    jobs: DbosJobs = client.app.state.jobs  # type: ignore[attr-defined]
    call: Callable[..., Any] = client.portal.call  # type: ignore[union-attr]
    alices = call(jobs.submit, Order("mat", "json"), b"{}", "key", "alice")
    bobs = call(jobs.submit, Order("mat", "json"), b'{"name": 1}', "key", "bob")
    assert alices.id != bobs.id
    assert call(jobs.get, alices.id, "alice").id == alices.id
    assert call(jobs.get, alices.id, "bob") is None
    assert call(jobs.get, alices.id, None) is None
    assert [job.id for job in call(jobs.list, 10, None, "bob")[0]] == [bobs.id]
    problem(client.get(f"/v1/jobs/{alices.id}"), "not-found")


def blobs(folder: Path) -> int:
    return sum(1 for path in (folder / "blobs").rglob("*") if path.is_file())


def test_a_removed_job_takes_its_files_unless_another_has_the_same(client: TestClient, folder: Path) -> None:
    before = blobs(folder)
    same = [finished(client, {"name": "same"}) for _ in range(2)]
    assert blobs(folder) == before + 2  # one body, one result
    client.delete(f"/v1/jobs/{same[0]}")
    assert blobs(folder) == before + 2
    assert client.get(f"/v1/jobs/{same[1]}/results").json() == {"did": {"name": "same"}}
    client.delete(f"/v1/jobs/{same[1]}")
    assert blobs(folder) == before


def test_results_whose_files_are_gone_or_cannot_be_read(
    client: TestClient, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = finished(client, {"name": "gone"})
    with monkeypatch.context() as patch:
        patch.setattr(Blobs, "size", unreadable)
        problem(client.get(f"/v1/jobs/{job}/results"), "store-unavailable")
    result = client.get(f"/v1/jobs/{job}/results").content
    (blob,) = (path for path in (folder / "blobs").rglob("*") if path.is_file() and path.read_bytes() == result)
    blob.unlink()
    problem(client.get(f"/v1/jobs/{job}/results"), "not-found")


def unreadable(*_: object) -> int:
    raise PermissionError(13, "Permission denied")


def test_counts_are_by_state(client: TestClient) -> None:
    counts = client.portal.call(client.app.state.jobs.counts)  # type: ignore[attr-defined, union-attr]
    assert counts["successful"] >= 1


def send(client: TestClient, body: bytes, query: str = "", **headers: str) -> Any:
    return client.post(f"/v1/batches{query}", content=body, headers=LINES | headers)


def test_a_batch_has_one_line_a_domain_in_order(client: TestClient) -> None:
    names = list(range(7))
    lines = [json.dumps({"name": name}).encode() for name in names]
    lines[2] = b"{]"
    lines[4] = b'{"error": "invalid-domain"}'
    body = b"\n".join([b"", *lines[:3], b"  ", *lines[3:]])  # no newline at its end
    made = send(client, body)
    assert made.status_code == 201
    job = made.json()["jobID"]
    assert until(client, job, "successful", "failed").message == "7 domains, 2 of them failed."
    response = client.get(f"/v1/jobs/{job}/results")
    assert response.headers["content-type"] == "application/x-ndjson"
    assert response.text.endswith("\n")
    results = [json.loads(line) for line in response.text.splitlines()]
    assert [result.get("code") or result["did"]["name"] for result in results] == [0, 1, "not-json", 3, "invalid-domain", 5, 6]
    assert [result["line"] for result in results if "line" in result] == [4, 7]


def test_a_domain_that_ends_its_worker_costs_only_its_line(client: TestClient) -> None:
    job = send(client, b'{"name": 0}\n{"crash": 1}\n{"name": 2}\n').json()["jobID"]
    until(client, job, "successful")
    results = [json.loads(line) for line in client.get(f"/v1/jobs/{job}/results").text.splitlines()]
    assert [result.get("code", "fine") for result in results] == ["fine", "worker-crashed", "fine"]


def test_a_batch_is_dismissed_in_the_middle(client: TestClient, folder: Path) -> None:
    before = blobs(folder)
    job = send(client, b'{"seconds": 0.2}\n' * 400).json()["jobID"]
    eventually(lambda: client.get(f"/v1/jobs/{job}").json()["progress"] > 0, seconds=30)
    assert client.delete(f"/v1/jobs/{job}").json()["status"] == "dismissed"
    assert post(client, {}, Prefer="respond-async, wait=20").status_code == 200
    client.delete(f"/v1/jobs/{job}")
    assert blobs(folder) <= before + 2


@pytest.mark.parametrize(
    ("body", "code"),
    [
        (b"", "not-json"),
        (b"\n \n\r\n", "not-json"),
        (b"{}\n" + b"x" * 65 * KIB, "body-too-large"),
        (b"{}\n" * 90_000, "body-too-large"),
    ],
)
def test_batches_that_are_refused(client: TestClient, folder: Path, body: bytes, code: str) -> None:
    before = blobs(folder)
    problem(send(client, body), code)
    assert blobs(folder) == before
    assert not list((folder / "incoming").iterdir())


def test_a_line_that_is_too_long_is_named(client: TestClient) -> None:
    assert problem(send(client, b"{}\n{}\n" + b"x" * 65 * KIB), "body-too-large")["line"] == 3


def test_what_a_batch_is_not(client: TestClient) -> None:
    problem(send(client, b"{}", "?operation=nope"), "invalid-parameter")
    problem(client.post("/v1/batches", content=b"{}", headers=JSON), "unsupported-media-type")
    problem(client.post("/v1/batches", content=b"{}"), "unsupported-media-type")
    problem(send(client, b"{}", **{"Content-Encoding": "br"}), "unsupported-media-type")
    problem(send(client, b"{}", **{"Content-Encoding": "gzip"}), "not-gzip")


def test_a_compressed_batch_that_is_cut_off_makes_no_job(client: TestClient, folder: Path) -> None:
    lines = b"".join(b'{"name": %d}\n' % k for k in range(1000))
    packed, jobs = gzip.compress(lines), client.get("/v1/jobs?limit=1000").json()["jobs"]
    response = send(client, packed[: len(packed) // 2], **{"Content-Encoding": "gzip"})
    assert 400 <= response.status_code < 500
    assert client.get("/v1/jobs?limit=1000").json()["jobs"] == jobs
    assert not list((folder / "incoming").iterdir())
    assert send(client, packed, **{"Content-Encoding": "gzip"}).status_code == 201


def test_a_batch_is_sent_again_with_its_key(client: TestClient) -> None:
    jobs = {send(client, b"{}\n{}\n", **{"Idempotency-Key": "lines"}).json()["jobID"] for _ in range(2)}
    assert len(jobs) == 1
    problem(send(client, b"{}\n", **{"Idempotency-Key": "lines"}), "idempotency-key-reused")


@pytest.mark.parametrize("removed", [False, True])
def test_work_that_ends_after_its_job_was_dismissed_is_no_news(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, removed: bool
) -> None:
    """As it happens when a job is dismissed in the moment in which it begins: nobody stops the work."""
    monkeypatch.setattr("service.jobs.executor.Executor.cancel", lambda *_: None)
    monkeypatch.setattr("service.jobs.executor.QUIET_SECONDS", 0.0)
    stats = client.app.state.pool.stats  # type: ignore[attr-defined]
    job = post(client, {"name": "late", "seconds": 1.0}).json()["jobID"]
    until(client, job, "running")
    eventually(lambda: stats().running["job"] == 1)
    for _ in range(1 + removed):
        assert client.delete(f"/v1/jobs/{job}").status_code == 200
    eventually(lambda: stats().running["job"] == 0)
    time.sleep(0.5)  # what is said is said by another thread
    told = [record for record in caplog.records if record.name.startswith("service") and record.levelno >= logging.WARNING]
    assert not [record.getMessage() for record in told]
