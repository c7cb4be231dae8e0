"""Clients that send as much as they can, in a process of their own, and the health checks that they must not hold up.

::

    python -m tests.load.flood PORT KIND CLIENTS

    together   requests by the hundred on each connection, without waiting for answers
    storm      all connect at once, ask for one small thing, leave, and come again
    crumbs     bodies in chunks of one byte
    heaps      bodies of some megabytes that are no domains

It goes on until SIGTERM.
"""

from __future__ import annotations

import asyncio
import contextlib
import sys

from tests.load.aside import aside, begin, tell
from tests.load.client import connected, head
from tests.load.drive import HEALTH_SECONDS, health
from tests.load.report import Report, quantile
from tests.load.scale import Scale
from tests.load.server import serving

KINDS = {"together": 20, "storm": 500, "crumbs": 20, "heaps": 8}
"""How many clients of each kind there are."""

AT_A_TIME = 100
CRUMBS = 20_000
HEAP_BYTES = 4 << 20
SETTLE_SECONDS = 0.3


async def flood(scale: Scale, report: Report) -> None:
    """Health checks, on a connection that is kept and on one that is new each time, beside each kind of flood."""
    async with serving(scale.folder, workers=scale.workers) as server:
        for kind, clients in KINDS.items():
            async with aside("tests.load.flood", server.port, kind, clients):
                await asyncio.sleep(SETTLE_SECONDS)
                async with health(server.port) as kept, health(server.port, anew=True) as new:
                    await asyncio.sleep(scale.seconds / len(KINDS))
            for name, seconds in (("a kept connection", kept), ("a new connection", new)):
                report.times("flood", f"/healthz, {kind}, {name}", seconds)
                text = f"{kind}: /healthz on {name} in {1000 * quantile(seconds, 1.0):.0f} ms (longest)"
                kept_promise = bool(seconds) and max(seconds) < HEALTH_SECONDS * scale.slack
                report.promise("flood", f"{text}; under {1000 * HEALTH_SECONDS:.0f}", kept_promise)
    report.promise("flood", "no process stays behind", not server.orphans())


async def _together(port: int) -> None:
    """Send requests, and read whatever is answered."""
    async with connected(port) as connection:
        reader, writer = await connection.open()
        reading = asyncio.create_task(_read(reader))
        try:
            while not reading.done():
                writer.write(head("GET", "/version", 0) * AT_A_TIME)
                await writer.drain()
        finally:
            reading.cancel()


async def _read(reader: asyncio.StreamReader) -> None:
    while await reader.read(1 << 20):
        pass


async def _storm(port: int) -> None:
    """Ask once."""
    async with connected(port) as connection:
        await connection.request("GET", "/version")


async def _crumbs(port: int) -> None:
    """Send a body in chunks of one byte, and wait for the answer."""
    await _body(port, "Transfer-Encoding: chunked", b"1\r\n \r\n" * CRUMBS + b"0\r\n\r\n")


async def _heaps(port: int) -> None:
    """Send a large body that is no domain, and wait for the answer."""
    await _body(port, f"Content-Length: {HEAP_BYTES}", b"[1,." * (HEAP_BYTES // 4))


async def _body(port: int, length: str, body: bytes) -> None:
    async with connected(port) as connection:
        reader, writer = await connection.open()
        writer.write(f"POST /v1/mat HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n{length}\r\n".encode())
        writer.write(b"Connection: close\r\n\r\n" + body)
        await _read(reader)


async def _pour(port: int, kind: str, clients: int) -> None:
    """All clients at once, and again when all have done."""
    one = {"together": _together, "storm": _storm, "crumbs": _crumbs, "heaps": _heaps}[kind]

    async def client() -> None:
        with contextlib.suppress(ConnectionError, asyncio.IncompleteReadError):  # it was refused, or ended by the server
            await one(port)

    loop, work = asyncio.get_running_loop(), asyncio.current_task()
    assert work is not None
    begin(lambda: loop.call_soon_threadsafe(work.cancel))
    tell("begun")
    while True:
        async with asyncio.TaskGroup() as group:
            for _ in range(clients):
                group.create_task(client())


def main() -> None:
    """Pour until told to stop."""
    with contextlib.suppress(asyncio.CancelledError):
        asyncio.run(_pour(int(sys.argv[1]), sys.argv[2], int(sys.argv[3])))


if __name__ == "__main__":
    main()
