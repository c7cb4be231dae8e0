"""Load from a process of its own: who measures must not wait for those who make the load."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import sys
from collections.abc import AsyncIterator, Callable

from service.workers.process import give_way
from tests.service.live import ROOT


@contextlib.asynccontextmanager
async def aside(module: str, *arguments: object, given: bytes = b"") -> AsyncIterator[list[bytes]]:
    """Such a process for the duration, which begins by a line and ends by SIGTERM; what it said besides is there afterwards."""
    lines: list[bytes] = []
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", module, *map(str, arguments)),
        stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, cwd=ROOT,
    )  # fmt: skip
    try:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(given)
        process.stdin.close()
        await process.stdout.readline()  # it has begun
        yield lines
        process.terminate()
        said, _ = await process.communicate()
        lines.extend(said.splitlines())
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()


def begin(leave: Callable[[], object]) -> None:
    """Called in such a process before it begins: it gives way to others, as a worker does."""
    signal.signal(signal.SIGTERM, lambda *_: leave())
    give_way(os.getpid(), "low")


def tell(line: str) -> None:
    """Say a line to the process that measures."""
    os.write(sys.stdout.fileno(), line.encode() + b"\n")
