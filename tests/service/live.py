"""The service as its operators start it: one more process on a free port of this machine, and its end."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

import httpx2

ROOT = Path(__file__).resolve().parents[2]
START_SECONDS = 180
PATIENCE = 30.0  # seconds for which a slow client goes on
COMMAND = (sys.executable, "-m", "uvicorn", "--factory", "service.app:create_app", "--log-level", "warning")


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextlib.contextmanager
def serving(
    command: tuple[str, ...] = COMMAND, environment: Mapping[str, str] | None = None
) -> Iterator[httpx2.Client]:
    """A client of a service that is ready, and whose process must end with code 0 when asked to."""
    port = free_port()
    where = ("--host", "127.0.0.1", "--port", str(port))
    state = tempfile.TemporaryDirectory()
    given = {**os.environ, "XDG_STATE_HOME": state.name, "MAT_LOG_LEVEL": "warning", **(environment or {})}
    process = subprocess.Popen(command + where, cwd=ROOT, env=given)
    try:
        with httpx2.Client(base_url=f"http://127.0.0.1:{port}", timeout=90) as client:
            wait_until_ready(client, process)
            yield client
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        state.cleanup()
    # uvicorn ends by the signal that it was asked with, after an orderly shutdown
    assert process.returncode in (0, -signal.SIGTERM)


def wait_until_ready(client: httpx2.Client, process: subprocess.Popen[bytes]) -> None:
    end = time.monotonic() + START_SECONDS
    while time.monotonic() < end:
        assert process.poll() is None, "the service ended while starting"
        with contextlib.suppress(httpx2.TransportError):
            if client.get("/readyz").status_code == 200:
                return
        time.sleep(0.05)
    raise AssertionError("the service was not ready in time")


def trickled(client: socket.socket, drops: bytes) -> tuple[bytes, float]:
    """What is answered to drops, the last of them again and again, and the seconds until the connection was closed."""
    begun = time.monotonic()
    answer = b""
    client.settimeout(0.1)
    for place in range(int(PATIENCE / 0.1)):
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):
            client.sendall(drops[place : place + 1] or drops[-1:])
        try:
            piece = client.recv(65536)
        except TimeoutError:
            continue
        except ConnectionResetError:
            break
        if not piece:
            break
        answer += piece
    return answer, time.monotonic() - begun
