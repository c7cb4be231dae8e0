"""The web process's side of the workers: who is idle, who waits, and who is killed.

A request waits for an idle worker, hands it the body and waits for the answer. If the deadline passes or the client
goes away first, the worker is killed (nothing less stops a compiled loop) and the nursery forks another; the same
happens when a worker dies by itself or has grown too large. Requests with large bodies never take the last worker, so
that a small one does not wait behind minutes of work.

Everything here runs on the event loop of one process; there is no lock because there is no second thread.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import os
import socket
import sys
import time
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import orjson

from service.settings import KIB, Settings
from service.workers import wire
from service.workers.nursery import COMMAND, KILL, SPAWN

LARGE_BODY_BYTES = 256 * KIB
"""Bodies above this take the lane that leaves one worker free (about 500 edges; a solve of a tenth of a second)."""

READ_BUFFER_BYTES = 1024 * KIB
"""Read ahead from a worker; an answer of 12 MB at the default of 64 KiB would take some 200 turns of the event loop."""

RESTART_SECONDS = (0.5, 30.0)
"""First and longest pause before a nursery that ended is started again."""

GOODBYE_SECONDS = 0.5
"""How long a nursery may take to end by itself."""

_log = logging.getLogger("service.workers.pool")


class PoolError(Exception):
    """A request was not answered; its class says why."""


class QueueFull(PoolError):
    """As many requests wait as the settings allow."""


class DeadlineExceeded(PoolError):
    """The time from arrival to answer, waiting included, ran out; the worker was killed."""


class WorkerCrashed(PoolError):
    """The worker ended without an answer."""


class _WorkerWasDead(WorkerCrashed):
    """The worker had ended before the request reached it (with its nursery, say): another one may have it."""


@dataclass(frozen=True, slots=True)
class Reply:
    """What a worker answered, and how long the request waited and was worked on."""

    header: wire.Header
    body: bytes
    queue_seconds: float
    work_seconds: float


@dataclass(slots=True, eq=False)
class _Worker:
    """One worker process as seen from here."""

    number: int
    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter
    gone: bool = False

    async def exchange(self, header: wire.Header, body: bytes) -> tuple[wire.Header, bytes]:
        """One message there, one back."""
        try:
            self.writer.writelines(wire.pack(header, body))
            await self.writer.drain()
        except ConnectionError:
            raise _WorkerWasDead from None
        try:
            head_size, body_size = wire.FRAME.unpack(await self.reader.readexactly(wire.FRAME.size))
            answer = orjson.loads(await self.reader.readexactly(head_size))
            return answer, await self.reader.readexactly(body_size)
        except (asyncio.IncompleteReadError, ConnectionError):
            raise WorkerCrashed from None


class Pool:
    """Workers behind a queue. Use as ``async with pool.running(): await pool.solve(...)``.

    Attributes
    ----------
    about : dict
        What the handler said about itself once loaded (versions); empty until then.
    progress : tuple of (str, int, int)
        The last step of loading: its name, how many are done, how many there are (0: not known yet).
    load_failed : bool
        True while the last attempt to load the handler has failed; the next one is under way or due.
    """

    def __init__(self, settings: Settings, handler: str = "service.workers.solve") -> None:
        self._settings = settings
        self._handler = handler
        self.about: dict[str, Any] = {}
        self.progress: tuple[str, int, int] = ("starting", 0, 0)
        self.load_failed = False
        self._control: socket.socket | None = None
        self._workers: dict[int, _Worker] = {}
        self._idle: asyncio.Queue[_Worker] = asyncio.Queue()
        self._large = asyncio.Semaphore(max(1, settings.workers - 1))
        self._waiting = 0
        self._next_number = 0

    @property
    def ready(self) -> bool:
        """True when the workers are loaded."""
        return bool(self._workers)

    @property
    def full(self) -> bool:
        """True when a request sent now would be refused: no worker is idle, and no more requests may wait."""
        return self._idle.empty() and self._waiting >= self._settings.queue_limit

    @contextlib.asynccontextmanager
    async def running(self) -> AsyncIterator[Pool]:
        """Keep the nursery and its workers alive for the duration; leave no process behind."""
        supervisor = asyncio.create_task(self._supervise())
        try:
            yield self
        finally:
            # a cancellation that meets the end of what it waits for can be lost: it is said again until it is heard
            while not supervisor.done():
                supervisor.cancel()
                await asyncio.wait([supervisor], timeout=2 * GOODBYE_SECONDS)
            if not supervisor.cancelled() and (error := supervisor.exception()) is not None:
                raise error

    async def solve(self, header: wire.Header, body: bytes) -> Reply:
        """Have one request worked on.

        Raises
        ------
        QueueFull, DeadlineExceeded, WorkerCrashed
            See there. Cancelling the call kills the worker, too.
        """
        arrived = time.monotonic()
        try:
            async with asyncio.timeout(self._settings.deadline_seconds):
                while True:
                    try:
                        async with self._worker(len(body)) as worker:
                            begun = time.monotonic()
                            answer, content = await worker.exchange(header, body)
                        break
                    except _WorkerWasDead:
                        continue
        except TimeoutError:
            raise DeadlineExceeded from None
        if answer.pop("resident_bytes") > self._settings.worker_recycle_bytes:
            self._discard(worker)
        else:
            self._idle.put_nowait(worker)
        return Reply(answer, content, begun - arrived, time.monotonic() - begun)

    @contextlib.asynccontextmanager
    async def _worker(self, body_size: int) -> AsyncIterator[_Worker]:
        """An idle worker; the caller returns it to the idle ones, unless the block fails, which costs it its life."""
        if self.full:
            raise QueueFull
        self._waiting += 1
        waiting = True
        try:
            async with self._large if body_size > LARGE_BODY_BYTES else contextlib.nullcontext():
                worker = await self._idle_worker()
                self._waiting -= 1
                waiting = False
                try:
                    yield worker
                except BaseException:
                    self._discard(worker)
                    raise
        finally:
            self._waiting -= waiting

    async def _idle_worker(self) -> _Worker:
        while True:
            worker = await self._idle.get()
            if not worker.gone and not worker.reader.at_eof():
                return worker

    async def _supervise(self) -> None:
        """Start the nursery, and again whenever it ends, with growing pauses while it fails to load."""
        pause, longest = RESTART_SECONDS
        while True:
            started = time.monotonic()
            self.about = {}
            await self._nursery_life()
            self.load_failed = not self.about
            if time.monotonic() - started > longest:
                pause = RESTART_SECONDS[0]
            _log.error("the nursery of the workers ended; starting it again in %.1f s", pause)
            await asyncio.sleep(pause)
            pause = min(2 * pause, longest)

    async def _nursery_life(self) -> None:
        """One nursery from its start to its end."""
        control, its_control = socket.socketpair()
        event_read, event_write = os.pipe()
        reader = asyncio.StreamReader()
        pipe = os.fdopen(event_read, "rb", 0)
        protocol = asyncio.StreamReaderProtocol(reader)
        events, _ = await asyncio.get_running_loop().connect_read_pipe(lambda: protocol, pipe)
        process = None
        try:
            process = await asyncio.create_subprocess_exec(
                *(sys.executable, "-P", "-m", "service.workers.nursery", self._handler),
                *(str(its_control.fileno()), str(event_write), str(self._settings.worker_memory_bytes)),
                stdin=asyncio.subprocess.DEVNULL,
                pass_fds=(its_control.fileno(), event_write),
                env=_nursery_environment(),
                start_new_session=True,  # Ctrl-C on a terminal is for the web process to handle
            )
            its_control.close()
            os.close(event_write)
            self._control = control
            async for line in reader:
                await self._on_event(json.loads(line))
        finally:
            self._control = None
            for worker in list(self._workers.values()):
                self._forget(worker)
            control.close()
            events.close()
            if process is not None:
                await _end(process)

    async def _on_event(self, event: dict[str, Any]) -> None:
        """React to what the nursery reports."""
        if event["event"] == "progress":
            self.progress = (event["name"], event["done"], event["total"])
        elif event["event"] == "ready":
            self.about = event["about"]
            self.load_failed = False
            for _ in range(self._settings.workers):
                await self._spawn()
        elif event["event"] == "gone":
            worker = self._workers.get(event["worker"])
            if worker is not None:  # not one that was killed from here
                _log.warning("worker %d ended by itself with exit code %d", worker.number, event["exit_code"])
                self._forget(worker)
            await self._spawn()

    async def _spawn(self) -> None:
        """Have the nursery fork a worker, and make it available."""
        if self._control is None:
            return
        self._next_number += 1
        ours, its = socket.socketpair()
        with its, contextlib.suppress(OSError):  # a nursery that has gone is noticed at the end of its events
            socket.send_fds(self._control, [COMMAND.pack(SPAWN, self._next_number)], [its.fileno()])
        reader, writer = await asyncio.open_connection(sock=ours, limit=READ_BUFFER_BYTES)
        worker = _Worker(self._next_number, reader, writer)
        self._workers[worker.number] = worker
        self._idle.put_nowait(worker)

    def _discard(self, worker: _Worker) -> None:
        """Kill a worker; its end, reported by the nursery, brings its successor."""
        if worker.gone:
            return
        self._forget(worker)
        if self._control is not None:
            with contextlib.suppress(OSError):
                self._control.send(COMMAND.pack(KILL, worker.number))

    def _forget(self, worker: _Worker) -> None:
        """Take a worker out of use here."""
        worker.gone = True
        worker.writer.close()
        self._workers.pop(worker.number, None)


async def _end(process: asyncio.subprocess.Process) -> None:
    """Wait for a nursery to kill its workers and go; kill one that is loading and so does not see its stream's end."""
    try:
        await asyncio.wait_for(process.wait(), GOODBYE_SECONDS)
    except TimeoutError:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()


def _nursery_environment() -> dict[str, str]:
    """What this process was given, with this package importable and one thread a worker (they are the parallelism)."""
    root = str(Path(__file__).resolve().parents[2])
    paths = [path for path in (os.environ.get("PYTHONPATH"), root) if path]
    single = dict.fromkeys(("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    return {**os.environ, **single, "PYTHONPATH": os.pathsep.join(paths)}
