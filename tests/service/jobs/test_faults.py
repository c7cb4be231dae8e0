"""Servers that are killed, stopped, cut off and left without their store: nothing accepted is lost, nothing else stops."""

from __future__ import annotations

import contextlib
import json
import random
import socket
import sqlite3
import time
from collections import Counter
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from service.errors import ERRORS
from tests.service.jobs.servers import LINES, Server, code
from tests.service.processes import eventually


def test_no_accepted_job_is_lost_when_the_server_is_killed(tmp_path: Path) -> None:
    chance = random.Random(1)
    accepted: dict[str, int] = {}
    with Server(tmp_path) as server:
        for kill in range(2):
            for k in range(5):
                accepted[server.job({"name": 5 * kill + k, "seconds": 0.05})] = 5 * kill + k
            time.sleep(chance.uniform(0, 0.3))
            server.kill()
            server.start()
        for job, name in accepted.items():
            assert server.until(job, "successful", "failed")["status"] == "successful"
            assert server.client.get(f"/v1/jobs/{job}/results").json()["did"]["name"] == name


def test_a_batch_goes_on_after_a_kill_with_its_open_chunks_only(tmp_path: Path) -> None:
    count, chunk, open_chunks = 60, 5, 2  # one worker, and one chunk fetched beyond it
    with Server(tmp_path, MAT_BATCH_CHUNK=str(chunk)) as server:
        job = server.batch({"name": k, "seconds": 0.02} for k in range(count))
        eventually(lambda: len(server.done()) >= count // 3, seconds=60)
        server.kill()
        assert len(server.done()) < count
        server.start()
        server.until(job, "successful")
        results = [json.loads(line) for line in server.client.get(f"/v1/jobs/{job}/results").text.splitlines()]
        assert [result["did"]["name"] for result in results] == list(range(count))
        times = Counter(server.done())
        assert len(times) == count
        again = {int(name) // chunk for name, often in times.items() if often > 1}
        assert len(again) <= open_chunks
        assert max(times.values()) <= 2


def test_a_server_that_is_stopped_hands_its_jobs_back_in_good_time(tmp_path: Path) -> None:
    with Server(tmp_path) as server:
        running = server.job({"name": "running", "seconds": 3})
        waiting = server.job({"name": "waiting"})
        server.until(running, "running")
        begun = time.monotonic()
        server.stop()
        assert time.monotonic() - begun < 10
        assert server.done() == []
        server.start()
        for job in (running, waiting):
            server.until(job, "successful")
        assert sorted(server.done()) == ["running", "waiting"]


def test_a_server_whose_database_is_locked_ends_in_time_and_loses_nothing(tmp_path: Path) -> None:
    with Server(tmp_path) as server:
        jobs = [server.job({"name": "running", "seconds": 3}), server.job({"name": "waiting"})]
        server.until(jobs[0], "running")
        with contextlib.closing(sqlite3.connect(tmp_path / "data" / "jobs.sqlite", isolation_level=None)) as other:
            other.execute("BEGIN EXCLUSIVE")
            server.stop()
        server.start()
        for job in jobs:
            assert server.until(job, "successful", "failed")["status"] == "successful"


@pytest.mark.parametrize("chunked", [False, True], ids=["short of its length", "without its last chunk"])
def test_a_batch_that_is_cut_off_makes_no_job_and_leaves_no_file(tmp_path: Path, chunked: bool) -> None:
    with Server(tmp_path, MAT_BATCH_CHUNK="1") as server:
        address = urlsplit(str(server.client.base_url))
        lines = b'{"name": 1}\n' * 100
        size = b"Transfer-Encoding: chunked" if chunked else b"Content-Length: 100000"
        head = b"POST /v1/batches HTTP/1.1\r\nHost: x\r\nContent-Type: application/x-ndjson\r\n" + size + b"\r\n\r\n"
        part = b"%x\r\n%s\r\n" % (len(lines), lines) if chunked else lines
        with socket.create_connection((address.hostname, address.port)) as connection:
            connection.sendall(head + part)
            incoming = tmp_path / "data" / "incoming"
            eventually(lambda: bool(list(incoming.rglob("0000*"))))
        eventually(lambda: not list(incoming.iterdir()))
        assert server.client.get("/v1/jobs").json()["jobs"] == []
        assert not [path for path in (tmp_path / "data" / "blobs").rglob("*") if path.is_file()]


def test_without_its_store_the_service_serves_everything_else(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("a file where the folder should be")
    server = Server(tmp_path)
    try:
        server.start(ready=False)
        eventually(lambda: code(server) == "store-unavailable", seconds=60)
        sync = server.client.post("/v1/mat", content=b'{"name": "sync"}', headers={"Content-Type": "application/json"})
        assert sync.json() == {"did": {"name": "sync"}}
        refused = [server.post({}), server.client.post("/v1/batches", content=b"{}\n", headers=LINES)]
        some = f"/v1/jobs/{'0' * 32}"
        refused += [server.client.get("/v1/jobs"), server.client.get(some), server.client.delete(some)]
        for response in refused:
            assert (response.status_code, response.json()["code"]) == (503, "store-unavailable")
            assert response.headers["retry-after"] == str(ERRORS["store-unavailable"].retry_after_seconds)
        (tmp_path / "data").unlink()
        eventually(lambda: server.client.get("/readyz").status_code == 200, seconds=60)
        server.until(server.job({"name": "later"}), "successful")
    finally:
        server.stop()


def test_an_api_and_a_worker_share_a_folder_and_a_dismissal_reaches_the_worker(tmp_path: Path) -> None:
    with Server(tmp_path, MAT_ROLE="api") as api:
        job = api.job({"name": "endless", "seconds": 600})
        time.sleep(0.5)
        assert api.status(job)["status"] == "accepted"
        with Server(tmp_path, MAT_ROLE="worker"):
            api.until(job, "running")
            assert api.client.delete(f"/v1/jobs/{job}").json()["status"] == "dismissed"
            api.until(api.job({"name": "next"}), "successful")
            assert api.status(job)["status"] == "dismissed"


def test_two_servers_of_one_name_take_names_of_their_own(tmp_path: Path) -> None:
    with Server(tmp_path) as first, Server(tmp_path) as second:
        assert {path.name for path in (tmp_path / "data" / "executors").iterdir()} == {"server.lock", "server.1.lock"}
        jobs = [first.job({"name": k, "seconds": 0.3}) for k in range(6)]
        for job in jobs:
            second.until(job, "successful")
        assert sorted(first.done()) == sorted(map(str, range(6)))


def test_jobs_go_with_their_files_when_they_have_been_kept_long_enough(tmp_path: Path) -> None:
    with Server(tmp_path, MAT_JOB_RETENTION_SECONDS="1") as server:
        job = server.job({"name": "short-lived"})
        eventually(lambda: server.client.get(f"/v1/jobs/{job}").status_code == 404, seconds=60)
        blobs = tmp_path / "data" / "blobs"
        eventually(lambda: not [path for path in blobs.rglob("*") if path.is_file()], seconds=60)
