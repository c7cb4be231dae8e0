"""The web process's side of one nursery: the process, its commands and its events."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import socket
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

from service.observability import logs
from service.settings import Settings
from service.workers.channel import Channel
from service.workers.nursery import COMMAND, KILL, LOWER, SPAWN

GOODBYE_SECONDS = 0.5
"""How long a nursery may take to end by itself."""


class NurseryLink:
    """A running nursery."""

    def __init__(self, process: asyncio.subprocess.Process, control: socket.socket, events: asyncio.StreamReader) -> None:
        self._process = process
        self._control = control
        self._events = events

    @classmethod
    @contextlib.asynccontextmanager
    async def running(cls, handler: str, settings: Settings) -> AsyncIterator[NurseryLink]:
        """Start a nursery for the duration; it and all of its workers are gone afterwards."""
        control, its_control = socket.socketpair()
        event_read, event_write = os.pipe()
        reader = asyncio.StreamReader()
        pipe = os.fdopen(event_read, "rb", 0)
        protocol = asyncio.StreamReaderProtocol(reader)
        events, _ = await asyncio.get_running_loop().connect_read_pipe(lambda: protocol, pipe)
        process = None
        printed = None
        try:
            with its_control, os.fdopen(event_write, "wb", 0):
                process = await asyncio.create_subprocess_exec(
                    *(sys.executable, "-P", "-m", "service.workers.nursery", handler),
                    *(str(its_control.fileno()), str(event_write), str(settings.worker_memory_bytes), str(os.getpid())),
                    settings.long_priority,
                    stdin=asyncio.subprocess.DEVNULL,
                    stderr=asyncio.subprocess.PIPE,
                    pass_fds=(its_control.fileno(), event_write),
                    env=_environment(),
                )
            assert process.stderr is not None
            printed = asyncio.create_task(logs.forward(process.stderr))
            control.setblocking(False)
            yield cls(process, control, reader)
        finally:
            control.close()
            events.close()
            if process is not None:
                await _end(process)
            if printed is not None:
                await asyncio.wait([printed], timeout=GOODBYE_SECONDS)
                printed.cancel()

    async def events(self) -> AsyncIterator[dict[str, Any]]:
        """What the nursery reports, until it ends."""
        async for line in self._events:
            yield json.loads(line)

    async def spawn(self, number: int) -> Channel:
        """Have a worker forked; it is there when it answers, and its channel is closed if it never was."""
        ours, its = socket.socketpair()
        with its:
            self._command(SPAWN, number, its.fileno())
        _, channel = await asyncio.get_running_loop().create_connection(Channel, sock=ours)
        return channel

    def kill(self, number: int) -> None:
        """Have a worker killed."""
        self._command(KILL, number)

    def lower(self, number: int) -> None:
        """Have a worker give way to others for the rest of its life."""
        self._command(LOWER, number)

    def _command(self, command: bytes, number: int, *descriptors: int) -> None:
        """Send a command. A nursery that takes no more of them is of no use any longer; its end is seen in its events."""
        try:
            socket.send_fds(self._control, [COMMAND.pack(command, number)], descriptors)
        except BlockingIOError:
            self._process.kill()
        except OSError:
            pass


async def _end(process: asyncio.subprocess.Process) -> None:
    """Wait for a nursery to kill its workers and go; kill one that is loading and so does not see its stream's end."""
    try:
        await asyncio.wait_for(process.wait(), GOODBYE_SECONDS)
    except TimeoutError:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()


def _environment() -> dict[str, str]:
    """What this process was given, with this package importable and one thread a worker (they are the parallelism)."""
    root = str(Path(__file__).resolve().parents[2])
    paths = [path for path in (os.environ.get("PYTHONPATH"), root) if path]
    single = dict.fromkeys(("MAT_CORE_THREADS", "NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    return {**os.environ, **single, "PYTHONPATH": os.pathsep.join(paths)}
