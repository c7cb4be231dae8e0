"""Clients that ask for one huge domain again and again, in a process of their own: who measures must not wait for them.

::

    python -m tests.load.crowd PORT CLIENTS < BODY

A line of JSON for each answer, status and seconds; no more is asked for once the process has got SIGTERM. It gives way to others
as a worker does, so that what is measured beside it is the service.
"""

from __future__ import annotations

import asyncio
import contextlib
import http.client
import json
import os
import signal
import sys
import threading
import time
from collections.abc import AsyncIterator

from service.workers.process import give_way
from tests.load.drive import STUCK_SECONDS
from tests.service.live import ROOT

_leaving = threading.Event()


@contextlib.asynccontextmanager
async def crowd(port: int, body: bytes, clients: int) -> AsyncIterator[list[tuple[int, float]]]:
    """Such clients for the duration; their answers are there afterwards."""
    answers: list[tuple[int, float]] = []
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "tests.load.crowd", str(port), str(clients)),
        stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, cwd=ROOT,
    )  # fmt: skip
    try:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(body)
        process.stdin.close()
        await process.stdout.readline()  # they have begun
        yield answers
        process.terminate()
        said, _ = await process.communicate()
        answers.extend((status, seconds) for status, seconds in map(json.loads, said.splitlines()))
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()


def _ask_again_and_again(port: int, body: bytes) -> None:
    while not _leaving.is_set():
        begun = time.monotonic()
        status = _ask(port, body)
        _tell(json.dumps([status, time.monotonic() - begun]))


def _ask(port: int, body: bytes) -> int:
    """The status of a request whose answer nobody here has the memory for."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=STUCK_SECONDS * 10)
    try:
        connection.request("POST", "/v1/mat", body, {"Content-Type": "application/json"})
        response = connection.getresponse()
        buffer = bytearray(1 << 20)
        while response.readinto(buffer):
            pass
        return response.status
    finally:
        connection.close()


def _tell(line: str) -> None:
    os.write(sys.stdout.fileno(), line.encode() + b"\n")


def main() -> None:
    """Read what to ask for, and ask."""
    port, clients = map(int, sys.argv[1:])
    signal.signal(signal.SIGTERM, lambda *_: _leaving.set())
    give_way(os.getpid(), "low")
    body = sys.stdin.buffer.read()
    threads = [threading.Thread(target=_ask_again_and_again, args=(port, body)) for _ in range(clients)]
    for thread in threads:
        thread.start()
    _tell("begun")
    for thread in threads:
        thread.join()


if __name__ == "__main__":
    main()
