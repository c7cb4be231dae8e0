"""Servers of the tests: processes of their own that can be killed, with workers that do as they are told."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import httpx2

from service.cli.serve import listen
from service.server import ENDING_SECONDS, run
from service.settings import Settings
from tests.service.jobs.handlers import DONE
from tests.service.live import ROOT, free_port, wait_until_ready

DRAIN_SECONDS = 5

NOISE_SECONDS = 10.0
"""What a busy machine may add to the time in which a server has promised to end."""

LINES = {"Content-Type": "application/x-ndjson"}
ASYNC = {"Prefer": "respond-async", "Content-Type": "application/json"}


class Server:
    """A server that is started, killed and started again over one folder (and one database)."""

    def __init__(self, folder: Path, **environment: str) -> None:
        self.folder = folder
        usual = {"MAT_DATA_DIR": str(folder / "data"), "MAT_WORKERS": "1", "MAT_EXECUTOR_ID": "server", "MAT_LOG_LEVEL": "error"}
        usual |= {"MAT_SHUTDOWN_DRAIN_SECONDS": str(DRAIN_SECONDS), DONE: str(folder / "done")}
        usual |= {"MAT_LONG_PRIORITY": "normal"}  # jobs that give way would wait for the tests beside them
        self._environment = {**usual, **environment}
        self._port = free_port()
        self.client = httpx2.Client(base_url=f"http://127.0.0.1:{self._port}", timeout=60)
        self._process: subprocess.Popen[bytes] | None = None

    def start(self, ready: bool = True) -> Server:
        command = (sys.executable, "-m", __name__, str(self._port))
        self._process = subprocess.Popen(command, cwd=ROOT, env={**os.environ, **self._environment})
        if ready:
            wait_until_ready(self.client, self._process)
        return self

    def kill(self) -> None:
        """As by the kernel: nothing is said to anybody."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None

    def stop(self) -> float:
        """Ask it to end, which it must do by itself, with code 0 and in the time that it has promised; the seconds it took."""
        begun = time.monotonic()
        if self._process is not None:
            try:
                self._process.send_signal(signal.SIGTERM)
                assert self._process.wait(DRAIN_SECONDS + ENDING_SECONDS + NOISE_SECONDS) == 0
            finally:
                self.kill()
        return time.monotonic() - begun

    def __enter__(self) -> Server:
        return self.start()

    def __exit__(self, *_: object) -> None:
        try:
            self.stop()
        finally:
            self.client.close()

    def post(self, order: dict[str, Any], **headers: str) -> httpx2.Response:
        return self.client.post("/v1/mat", content=json.dumps(order), headers=ASYNC | headers)

    def job(self, order: dict[str, Any]) -> str:
        """Have a job accepted; its id."""
        response = self.post(order)
        assert response.status_code == 201, response.text
        return str(response.json()["jobID"])

    def batch(self, lines: Iterable[Any]) -> str:
        body = b"".join(json.dumps(line).encode() + b"\n" for line in lines)
        response = self.client.post("/v1/batches", content=body, headers=LINES)
        assert response.status_code == 201, response.text
        return str(response.json()["jobID"])

    def status(self, job: str) -> dict[str, Any]:
        document: dict[str, Any] = self.client.get(f"/v1/jobs/{job}").json()
        return document

    def until(self, job: str, *states: str, seconds: float = 60.0) -> dict[str, Any]:
        """Wait until a job is in one of some states."""
        end = time.monotonic() + seconds
        while (document := self.status(job)).get("status") not in states:
            assert time.monotonic() < end, document
            time.sleep(0.02)
        return document

    def done(self) -> list[str]:
        """The names of what was worked on to its end, once for each time."""
        file = self.folder / "done"
        return file.read_text().split() if file.exists() else []


def code(server: Server) -> str:
    """Why a server is not ready; nothing while it does not answer."""
    try:
        return str(server.client.get("/readyz").json().get("code"))
    except httpx2.TransportError:
        return ""


if __name__ == "__main__":
    run(Settings.from_environment(), listen("127.0.0.1", int(sys.argv[1])), "tests.service.jobs.handlers")
