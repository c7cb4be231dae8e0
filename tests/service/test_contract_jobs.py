"""The contract of jobs: execution by OGC API - Processes, precision, and results that are asked for again."""

from __future__ import annotations

import gzip
import json
import time
from typing import Any

import httpx2
import pytest

from service.errors import OGC
from service.http.negotiation import FORMATS
from service.schemas import JobStatus
from service.workers.lanes import LARGE_BODY_BYTES
from tests.service.test_contract import body_of, refused, send

ASYNC = {"Prefer": "respond-async"}
LINES = {"Content-Type": "application/x-ndjson"}
EXECUTION = "/processes/offset/execution"


def finished(live: httpx2.Client, response: httpx2.Response) -> JobStatus:
    """The status of a job that a request made, once it is over."""
    assert response.status_code == 201, response.text
    end = time.monotonic() + 60
    while True:
        status = JobStatus.model_validate_json(live.get(response.headers["location"]).text)
        if status.status in ("successful", "failed"):
            return status
        assert time.monotonic() < end, status
        time.sleep(0.02)


def results(live: httpx2.Client, response: httpx2.Response, **headers: str) -> httpx2.Response:
    status = finished(live, response)
    return live.get(f"/v1/jobs/{status.jobID}/results", headers=headers)


@pytest.mark.parametrize("response", ["raw", "document"])
@pytest.mark.parametrize("form", ["json", "svg", "msgpack"])
def test_an_execution_by_a_job_is_that_without(live: httpx2.Client, form: str, response: str) -> None:
    outputs = {"result": {"format": {"mediaType": FORMATS[form]}}}
    body = body_of(EXECUTION) | {"outputs": outputs, "response": response}
    at_once = send(live, EXECUTION, body)
    later = results(live, send(live, EXECUTION, body, ASYNC))
    assert later.status_code == 200, later.text
    assert later.headers["content-type"] == at_once.headers["content-type"]
    assert later.content == at_once.content


def test_a_bad_frame_makes_no_job(live: httpx2.Client) -> None:
    document = refused(send(live, EXECUTION, {"inputs": {}, "outputs": 3}, ASYNC), "invalid-domain")
    assert document.problems[0].pointer == "/outputs"


ROOM = {"small": "", "large": " " * LARGE_BODY_BYTES}
BAD_BODIES = {
    "not JSON": '{"outer": [',
    "no object": "[1]",
    "not a number": '{"outer": [{"degree": 1, "control_points": [[0, NaN], [1, 0]]}]}',
    "an open loop": '{"outer": [{"degree": 1, "control_points": [[0, 0], [1, 0]]}]}',
    "unknown options": '{"outer": [], "options": {"colour": 3}}',
}


@pytest.mark.parametrize("room", ROOM.values(), ids=ROOM)
@pytest.mark.parametrize("body", BAD_BODIES.values(), ids=BAD_BODIES)
def test_a_small_body_s_faults_are_told_at_once_and_a_large_one_s_by_its_job(live: httpx2.Client, body: str, room: str) -> None:
    def ask(**headers: str) -> httpx2.Response:
        return live.post("/v1/mat", content=body + room, headers={"Content-Type": "application/json"} | headers)

    at_once, later = ask().json(), ask(**ASYNC)
    if room:
        later = results(live, later)
    told = later.json()
    assert later.status_code == at_once["status"]
    assert told | {"request_id": ""} == at_once | {"request_id": ""}


@pytest.mark.parametrize("room", ROOM.values(), ids=ROOM)
def test_problems_of_a_job_have_the_places_of_the_execute_request(live: httpx2.Client, room: str) -> None:
    body = {"inputs": {"outer": 3, "holes": [room], "arguments": {"value": {"distance": 0}}}}
    response = send(live, EXECUTION, body, ASYNC)
    problem = refused(results(live, response) if room else response, "invalid-domain")
    assert {"/inputs/outer", "/inputs/arguments/value/distance"} <= {each.pointer for each in problem.problems}


def test_jobs_at_the_addresses_of_the_standard(live: httpx2.Client) -> None:
    made = send(live, EXECUTION, body_of(EXECUTION), ASYNC)
    status = finished(live, made)
    assert live.get(f"/jobs/{status.jobID}").json() == live.get(f"/v1/jobs/{status.jobID}").json()
    assert status.processID == "offset"
    assert live.get(f"/jobs/{status.jobID}/results").status_code == 200
    assert status.jobID in [job["jobID"] for job in live.get("/jobs").json()["jobs"]]
    assert live.delete(f"/jobs/{status.jobID}").json()["status"] == "dismissed"
    missing = refused(live.get(f"/jobs/{status.jobID}"), "not-found")
    assert missing.type == f"{OGC}/no-such-job"


def test_a_job_has_the_precision_that_it_was_asked_for(live: httpx2.Client) -> None:
    at_once = send(live, "/v1/mat", body_of("/v1/mat"), precision=5)
    later = results(live, send(live, "/v1/mat", body_of("/v1/mat"), ASYNC, precision=5))
    assert later.json() == at_once.json()
    assert later.json()["rounding"]["digits"] == 5


def test_another_precision_is_another_request(live: httpx2.Client) -> None:
    key = ASYNC | {"Idempotency-Key": "precision"}
    first = send(live, "/v1/mat", body_of("/v1/mat"), key, precision=5)
    assert send(live, "/v1/mat", body_of("/v1/mat"), key, precision=5).json()["jobID"] == first.json()["jobID"]
    refused(send(live, "/v1/mat", body_of("/v1/mat"), key, precision=6), "idempotency-key-reused")


@pytest.mark.parametrize("key", ["", "ä", "x" * 256])
def test_a_key_that_is_none_is_refused_of_every_request(live: httpx2.Client, key: str) -> None:
    content = json.dumps(body_of("/v1/mat"))
    headers = {"Content-Type": b"application/json", "Idempotency-Key": key.encode("latin-1")}
    refused(live.post("/v1/mat", content=content, headers=headers), "invalid-parameter")


def test_results_are_asked_for_again_by_their_tag(live: httpx2.Client) -> None:
    made = send(live, "/v1/mat", body_of("/v1/mat"), ASYNC)
    found = results(live, made)
    tag = found.headers["etag"]
    again = results(live, made, **{"If-None-Match": tag})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag)
    assert results(live, made, **{"If-None-Match": '"other"'}).content == found.content
    job = made.json()["jobID"]
    head = live.head(f"/v1/jobs/{job}/results")
    assert (head.status_code, head.content, head.headers["etag"]) == (200, b"", tag)


def raw(live: httpx2.Client, path: str, **headers: str) -> tuple[httpx2.Response, bytes]:
    """An answer with its bytes as they came."""
    response = live.send(live.build_request("GET", path, headers=headers), stream=True)
    content = b"".join(response.iter_raw())
    response.close()
    return response, content


def test_results_are_compressed_for_who_takes_that(live: httpx2.Client) -> None:
    status = finished(live, send(live, "/v1/mat", body_of("/v1/mat"), ASYNC))
    path = f"/v1/jobs/{status.jobID}/results"
    plain, whole = raw(live, path, **{"Accept-Encoding": "identity"})
    packed, content = raw(live, path, **{"Accept-Encoding": "gzip"})
    assert "content-encoding" not in plain.headers
    assert packed.headers["content-encoding"] == "gzip"
    assert gzip.decompress(content) == whole
    assert len(content) < 0.6 * len(whole)
    assert plain.headers["vary"] == packed.headers["vary"] == "Accept-Encoding"
    assert plain.headers["etag"] == packed.headers["etag"]


def test_a_compressed_batch_with_a_precision(live: httpx2.Client) -> None:
    domain = json.dumps(body_of("/v1/mat")).encode()
    lines = b"\n".join([domain, b"{}", domain])
    headers = LINES | {"Content-Encoding": "gzip"}
    made = live.post("/v1/batches", content=gzip.compress(lines), headers=headers, params={"precision": 4})
    answers: list[dict[str, Any]] = [json.loads(line) for line in results(live, made).text.splitlines()]
    expected = send(live, "/v1/mat", body_of("/v1/mat"), precision=4).json()
    assert answers[0] == answers[2] == expected
    assert (answers[1]["code"], answers[1]["line"]) == ("invalid-domain", 2)


@pytest.mark.parametrize("cut", [1, 9, 30])
def test_a_compressed_batch_that_is_cut_off_makes_no_job(live: httpx2.Client, cut: int) -> None:
    before = len(live.get("/v1/jobs", params={"limit": 1000}).json()["jobs"])
    content = gzip.compress(json.dumps(body_of("/v1/mat")).encode())[:-cut]
    refused(live.post("/v1/batches", content=content, headers=LINES | {"Content-Encoding": "gzip"}), "not-gzip")
    assert len(live.get("/v1/jobs", params={"limit": 1000}).json()["jobs"]) == before
