"""Clients that ask for one huge domain again and again, in a process of their own.

::

    python -m tests.load.crowd PORT CLIENTS < BODY

A line of JSON for each answer, status and seconds; no more is asked for once the process has got SIGTERM.
"""

from __future__ import annotations

import contextlib
import http.client
import json
import sys
import threading
import time
from collections.abc import AsyncIterator

from tests.load.aside import aside, begin, tell
from tests.load.drive import STUCK_SECONDS

_leaving = threading.Event()


@contextlib.asynccontextmanager
async def crowd(port: int, body: bytes, clients: int) -> AsyncIterator[list[tuple[int, float]]]:
    """Such clients for the duration; their answers are there afterwards."""
    answers: list[tuple[int, float]] = []
    async with aside("tests.load.crowd", port, clients, given=body) as lines:
        yield answers
    answers.extend((status, seconds) for status, seconds in map(json.loads, lines))


def _ask_again_and_again(port: int, body: bytes) -> None:
    while not _leaving.is_set():
        begun = time.monotonic()
        status = _ask(port, body)
        tell(json.dumps([status, time.monotonic() - begun]))


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


def main() -> None:
    """Read what to ask for, and ask."""
    port, clients = map(int, sys.argv[1:])
    begin(_leaving.set)
    body = sys.stdin.buffer.read()
    threads = [threading.Thread(target=_ask_again_and_again, args=(port, body)) for _ in range(clients)]
    for thread in threads:
        thread.start()
    tell("begun")
    for thread in threads:
        thread.join()


if __name__ == "__main__":
    main()
