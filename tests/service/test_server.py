"""How the process ends: readiness first, then what is in flight, then what will not end, and code 0."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest

from service.errors import ERRORS
from tests.service.live import ROOT, trickled, wait_until_ready
from tests.service.processes import alive, descendants, eventually

PROGRAM = """
import socket, sys
from service.server import run
from service.settings import Settings
run(Settings.from_environment(), socket.socket(fileno=int(sys.argv[1])), "tests.service.handlers")
"""
HANGING = """
import threading, time
threading.Thread(target=time.sleep, args=(3600,)).start()
"""
"""A thread that Python would wait for at the end, as for one that asks a database which does not answer."""

BLOCKED = """
import contextlib, time
from service.workers.pool import Pool
running = Pool.running
@contextlib.asynccontextmanager
async def never_over(pool):
    try:
        async with running(pool):
            yield
    finally:
        time.sleep(3600)
Pool.running = never_over
"""
"""An end of the service that blocks the event loop."""

SOON = """
from service import server
server.ENDING_SECONDS = 2.0
"""

JSON = {"Content-Type": "application/json"}
Serving = tuple[subprocess.Popen[bytes], str]


@contextlib.contextmanager
def serving(folder: Path, before: str = "", **settings: str) -> Iterator[Serving]:
    """A server with workers that do as they are told, and its address; it is killed if it still runs in the end.

    `before` is Python that runs in its process first.
    """
    environment = {**os.environ, "MAT_DATA_DIR": str(folder), "MAT_WORKERS": "1", "MAT_LOG_LEVEL": "warning", **settings}
    with socket.create_server(("127.0.0.1", 0)) as listening:
        address = f"http://127.0.0.1:{listening.getsockname()[1]}"
        command = [sys.executable, "-c", before + PROGRAM, str(listening.fileno())]
        process = subprocess.Popen(command, cwd=ROOT, env=environment, pass_fds=[listening.fileno()])
    try:
        with httpx2.Client(base_url=address) as client:
            wait_until_ready(client, process)
        yield process, address
    finally:
        process.kill()
        process.wait()


class InFlight(threading.Thread):
    """A request that takes a while, on a connection of its own."""

    def __init__(self, address: str, seconds: float) -> None:
        super().__init__()
        self._address, self._seconds = address, seconds
        self.outcome: Any = None
        self.start()
        time.sleep(0.3)  # it is in the worker's hands now

    def run(self) -> None:
        """Send it, and note the status or the failure."""
        body = b'{"do": "spin", "seconds": %g}' % self._seconds
        try:
            self.outcome = httpx2.post(f"{self._address}/v1/mat", content=body, headers=JSON, timeout=60).status_code
        except httpx2.TransportError as error:
            self.outcome = error


def test_a_server_that_is_asked_to_end_says_no_then_drains_then_goes(tmp_path: Path) -> None:
    with serving(tmp_path, MAT_SHUTDOWN_NOTICE_SECONDS="1.5", MAT_WORKERS="2") as (process, address):
        below = descendants(process.pid)
        request = InFlight(address, 4.0)
        asked = time.monotonic()
        process.send_signal(signal.SIGTERM)
        time.sleep(0.2)
        unready = httpx2.get(f"{address}/readyz")
        assert (unready.status_code, unready.json()["code"]) == (ERRORS["not-ready"].status, "not-ready")
        assert httpx2.get(f"{address}/healthz").status_code == 200
        assert httpx2.post(f"{address}/v1/mat", content=b'{"do": "echo"}', headers=JSON).status_code == 200
        time.sleep(max(0.0, asked + 2.2 - time.monotonic()))
        assert request.is_alive()
        with pytest.raises(httpx2.ConnectError):
            httpx2.get(f"{address}/healthz")
        assert process.wait(30) == 0
        request.join()
        assert request.outcome == 200
    eventually(lambda: not any(alive(pid) for pid in below))


def test_what_does_not_end_in_time_is_killed(tmp_path: Path) -> None:
    with serving(tmp_path, MAT_SHUTDOWN_DRAIN_SECONDS="1") as (process, address):
        below = descendants(process.pid)
        request = InFlight(address, 25.0)
        asked = time.monotonic()
        process.send_signal(signal.SIGTERM)
        assert process.wait(20) == 0
        assert 1.0 <= time.monotonic() - asked < 20
        request.join()
        assert request.outcome != 200
    eventually(lambda: not any(alive(pid) for pid in below))


def refuses(address: str) -> bool:
    """Whether nobody listens any more: what is in flight is being drained."""
    try:
        httpx2.get(f"{address}/healthz")
    except httpx2.TransportError:
        return True
    return False


@pytest.mark.parametrize("signals", [[signal.SIGINT], [signal.SIGTERM, signal.SIGINT]], ids=["at first", "after SIGTERM"])
def test_ctrl_c_needs_no_notice_and_a_further_one_no_draining(tmp_path: Path, signals: list[signal.Signals]) -> None:
    with serving(tmp_path, MAT_SHUTDOWN_NOTICE_SECONDS="30", MAT_SHUTDOWN_DRAIN_SECONDS="30") as (process, address):
        below = descendants(process.pid)
        request = InFlight(address, 25.0)
        for sign in signals:
            process.send_signal(sign)
        eventually(lambda: refuses(address))
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 0
        request.join()
    eventually(lambda: not any(alive(pid) for pid in below))


def test_one_more_ctrl_c_ends_the_process_whatever_it_does(tmp_path: Path) -> None:
    with serving(tmp_path, BLOCKED, MAT_SHUTDOWN_DRAIN_SECONDS="60") as (process, address):
        below = descendants(process.pid)
        request = InFlight(address, 60.0)
        end = time.monotonic() + 20
        while process.poll() is None and time.monotonic() < end:
            process.send_signal(signal.SIGINT)
            time.sleep(0.5)
        assert process.returncode == 0
        request.join()
    eventually(lambda: not any(alive(pid) for pid in below))


def test_sigterm_may_be_sent_again_and_again(tmp_path: Path) -> None:
    with serving(tmp_path, MAT_SHUTDOWN_DRAIN_SECONDS="30") as (process, address):
        request = InFlight(address, 3.0)
        while request.is_alive():
            process.send_signal(signal.SIGTERM)
            time.sleep(0.1)
        assert request.outcome == 200
        assert process.wait(20) == 0


@pytest.mark.parametrize("before", [HANGING, SOON + BLOCKED], ids=["a thread", "the event loop"])
def test_a_server_in_which_something_hangs_ends_in_time_all_the_same(tmp_path: Path, before: str) -> None:
    with serving(tmp_path, before, MAT_SHUTDOWN_DRAIN_SECONDS="1") as (process, _):
        below = descendants(process.pid)
        process.send_signal(signal.SIGTERM)
        assert process.wait(20) == 0
    eventually(lambda: not any(alive(pid) for pid in below))


@pytest.mark.parametrize(("path", "media_type"), [("/v1/mat", "application/json"), ("/v1/batches", "application/x-ndjson")])
def test_a_body_that_trickles_is_told_to_go_and_its_connection_is_closed(tmp_path: Path, path: str, media_type: str) -> None:
    with serving(tmp_path, MAT_UPLOAD_SECONDS="0.5") as (_, address):
        url = httpx2.URL(address)
        with socket.create_connection((url.host, url.port), timeout=60) as client:
            head = f"POST {path} HTTP/1.1\r\nHost: x\r\nContent-Type: {media_type}\r\nContent-Length: 1000\r\n\r\n"
            client.sendall(head.encode())
            begun = time.monotonic()
            answer, _ = trickled(client, b" ")  # what comes after the answer is nobody's
        assert time.monotonic() - begun >= 0.5
        told, _, body = answer.partition(b"\r\n\r\n")
        assert told.startswith(b"HTTP/1.1 408 ")
        assert b"connection: close" in told.lower()
        assert json.loads(body)["code"] == "upload-timeout"
        assert not httpx2.get(f"{address}/v1/jobs").json()["jobs"]
