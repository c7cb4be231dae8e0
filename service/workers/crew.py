"""The worker processes there are: forked ahead of need, handed out, taken back, replaced.

There is always one more than works, idle and warm, so that a killed worker's place is taken at once. A worker that has done long
work runs at a lower priority from then on (a process cannot raise its own again), and is kept for long work.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections import Counter, deque
from typing import Any, Literal, NoReturn

from service.settings import Settings
from service.tasks import end
from service.workers.channel import Channel
from service.workers.nursery_link import NurseryLink
from service.workers.process import processor_seconds

RESTART_SECONDS = (0.5, 30.0)
"""First and longest pause before a nursery that ended is started again."""

RESPAWN_SECONDS = 0.2
"""Pause before an idle worker that ended by itself is replaced: the next one may do the same."""

Reason = Literal["deadline", "disconnect", "dismissed", "memory", "crash", "recycled", "preempted"]
"""Why a worker was ended: its request's time ran out, its client went away or its job was dismissed; it had grown, or memory was
denied to it; it ended by itself; it had done its number of requests; or a small request took too long for its lane."""

_log = logging.getLogger("service.workers.crew")


class Worker:
    """One worker process as seen from here.

    Attributes
    ----------
    number : int
    channel : Channel
    lowered : bool
        It runs at a lower priority.
    used : bool
        It has been given work, so its memory is not what it began with.
    """

    def __init__(self, number: int, channel: Channel) -> None:
        self.number = number
        self.channel = channel
        self.lowered = False
        self.used = False


class Crew:
    """The workers of one pool.

    Attributes
    ----------
    about, progress, load_failed
        See `service.workers.pool.Pool`.
    kills : collections.Counter
        How many workers were ended, by `Reason`.
    """

    def __init__(self, settings: Settings, handler: str) -> None:
        self._settings = settings
        self._handler = handler
        self.about: dict[str, Any] = {}
        self.progress: tuple[str, int, int] = ("starting", 0, 0)
        self.load_failed = False
        self.kills: Counter[Reason] = Counter()
        self._link: NurseryLink | None = None  # while it is loaded
        self._arrived = asyncio.Event()  # a worker has become idle
        self._workers: dict[int, Worker] = {}
        self._pids: dict[int, int] = {}  # of workers, once the nursery has told
        self._idle: deque[Worker] = deque()
        self._idle_lowered: deque[Worker] = deque()
        self._numbers = 0
        self._forks: set[asyncio.Task[None]] = set()  # that will make an idle worker

    @property
    def ready(self) -> bool:
        """True while the workers are loaded."""
        return self._link is not None

    @property
    def size(self) -> int:
        """How many workers there are."""
        return len(self._workers)

    @property
    def idle(self) -> int:
        """How many of them have nothing to do."""
        return len(self._idle) + len(self._idle_lowered)

    async def supervise(self) -> NoReturn:
        """Start the nursery, and again whenever it ends, with growing pauses while it fails to load; cancel to end it."""
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

    async def take(self, *, lowered: bool, unused: bool = False) -> Worker:
        """A worker for one request, at the lower priority or not; wait while there is no nursery.

        Parameters
        ----------
        lowered : bool
        unused : bool
            One that has not worked before, with all the memory that the settings allow.
        """
        while True:
            worker = self._take_idle(lowered, unused)
            if worker is None and self._link is not None and (unused or not self._forks):
                worker = await self._fork()
            if worker is not None:
                break
            self._arrived.clear()
            await self._arrived.wait()
        worker.used = True
        if lowered and not worker.lowered and self._link is not None:
            worker.lowered = True
            self._link.lower(worker.number)
        self._keep_spare()
        return worker

    def worked(self, worker: Worker) -> float:
        """Seconds of processor time that a worker has used."""
        return processor_seconds(self._pids.get(worker.number))

    def lower(self, worker: Worker) -> None:
        """Let a worker that turns out to have long work give way to others."""
        if self._link is not None and worker.number in self._workers and not worker.lowered:
            worker.lowered = True
            self._link.lower(worker.number)

    def give_back(self, worker: Worker, resident: int, served: int) -> None:
        """Take back a worker that has answered; end it if it has grown, has done its number, or is one too many."""
        settings = self._settings
        idle, most = (self._idle_lowered, settings.workers) if worker.lowered else (self._idle, settings.workers + 1)
        if worker.number not in self._workers:
            return  # it went with its nursery
        if resident > settings.worker_recycle_bytes:
            self.kill(worker, "memory")
        elif 0 < settings.worker_recycle_requests <= served:
            self.kill(worker, "recycled")
        elif len(idle) >= most:
            self._forget(worker)
        else:
            idle.append(worker)
            self._arrived.set()

    def kill(self, worker: Worker, reason: Reason, *, listen: bool = False) -> None:
        """End a worker whatever it is doing. Its channel is closed, or, for who listens to it, closes with the worker's end."""
        if worker.number not in self._workers:
            return  # with its nursery
        self.kills[reason] += 1
        self._forget(worker, listen)
        if self._link is not None:
            self._link.kill(worker.number)
            self._keep_spare()

    def _take_idle(self, lowered: bool, unused: bool) -> Worker | None:
        """An idle worker, if one will do: the one that has waited least, whose memory is the warmest.

        Long work leaves that to the others: of those that it would lower it takes the one that has waited longest.
        """
        for worker in [*reversed(self._idle_lowered), *self._idle] if lowered else [*reversed(self._idle)]:
            if not (unused and worker.used) and not worker.channel.closed:
                (self._idle_lowered if worker.lowered else self._idle).remove(worker)
                return worker
        return None

    def _keep_spare(self) -> None:
        """Have workers forked until one is idle, and as many are there as the settings say and one more."""
        standing = self._settings.workers + 1
        missing = max(standing - len(self._workers), 1 - len(self._idle)) - len(self._forks)
        for _ in range(missing):
            self._begin_fork()

    def _begin_fork(self, pause: float = 0.0) -> None:
        task = asyncio.create_task(self._fork_idle(pause))
        self._forks.add(task)
        task.add_done_callback(self._forked)

    async def _fork_idle(self, pause: float) -> None:
        await asyncio.sleep(pause)
        worker = await self._fork()
        if worker is not None:
            self._idle.append(worker)

    def _forked(self, task: asyncio.Task[None]) -> None:
        """Who waits for a worker looks again, also where there is none."""
        self._forks.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            _log.error("no worker could be asked for: %s", error)
        self._arrived.set()

    async def _fork(self) -> Worker | None:
        """A new worker; None when the nursery has gone in the meantime."""
        link = self._link
        if link is None:
            return None
        self._numbers += 1
        number = self._numbers
        worker = Worker(number, await link.spawn(number))
        if self._link is not link:
            worker.channel.close()
            return None
        self._workers[number] = worker
        return worker

    async def _nursery_life(self) -> None:
        """One nursery from its start to its end."""
        async with NurseryLink.running(self._handler, self._settings) as link:
            try:
                async for event in link.events():
                    self._on_event(link, event)
            finally:
                self._link = None
                for worker in list(self._workers.values()):
                    self._forget(worker)
                for task in list(self._forks):
                    task.cancel()

    def _on_event(self, link: NurseryLink, event: dict[str, Any]) -> None:
        """React to what the nursery reports."""
        if event["event"] == "progress":
            self.progress = (event["name"], event["done"], event["total"])
        elif event["event"] == "ready":
            self.about = event["about"]
            self.load_failed = False
            self._link = link
            self._keep_spare()
        elif event["event"] == "born":
            self._pids[event["worker"]] = event["pid"]
        elif event["event"] == "gone":
            self._on_gone(event["worker"], event["exit_code"])

    def _on_gone(self, number: int, exit_code: int) -> None:
        """A worker ended. If it was working, its request finds out by itself, and says why."""
        worker = self._workers.get(number)
        if worker is None:  # ended from here
            return
        _log.warning("worker %d ended by itself with exit code %d", number, exit_code)
        if worker in self._idle or worker in self._idle_lowered:
            self.kills["crash"] += 1
            self._forget(worker)
            self._begin_fork(RESPAWN_SECONDS)

    def _forget(self, worker: Worker, listen: bool = False) -> None:
        """Take a worker out of use; an idle one ends when its channel closes."""
        if not listen:
            worker.channel.close()
        self._workers.pop(worker.number, None)
        self._pids.pop(worker.number, None)
        for idle in (self._idle, self._idle_lowered):
            if worker in idle:
                idle.remove(worker)


async def stop(supervisor: asyncio.Task[NoReturn]) -> None:
    """End a supervisor, and raise what it failed with."""
    await end(supervisor)
    if not supervisor.cancelled() and (error := supervisor.exception()) is not None:
        raise error
