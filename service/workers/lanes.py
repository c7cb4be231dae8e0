"""Who may run now and who waits: three lanes, so that work of milliseconds never stands behind work of minutes.

::

    lane    what takes it                                               runs at once, of N workers
    small   a small body, until it has run for a second                 what the other two leave of N, and always one
    long    a large body, and what has left the small lane              what jobs leave of N, and always one
    job     jobs and batches, whatever their size                       N

So the processors are used whatever is asked of the service, nothing keeps the worker of the lanes before it, and no lane
starves. More than N processes may run for a while; those of the long lanes give way to the others (`process.give_way`).

The size of a body says little: a small one may ask for a tiny step. A small request that has run for a second therefore
becomes a long one where it is, if the long lane has room; else it is stopped, and begins again when its turn comes there. It is
refused if too many wait there: no more work is let in by small bodies than by large ones.

Nothing here knows of processes. Everything runs on the event loop of one process; there is no lock because there is no
second thread.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import AsyncIterator, Mapping
from enum import Enum

from service.settings import KIB
from service.workers.failures import QueueFull

LARGE_BODY_BYTES = 256 * KIB
"""Bodies above this are long from the beginning (about 500 edges; a solve of a tenth of a second)."""

LONG_SECONDS = 1.0
"""A small request that has run for so long is a long one."""


class Lane(Enum):
    """Where a request waits; in the order in which a free place is given away."""

    SMALL = "small"
    LONG = "long"
    JOB = "job"

    @classmethod
    def of(cls, body_bytes: int, job: bool) -> Lane:
        """The lane that a request begins in."""
        if job:
            return cls.JOB
        return cls.SMALL if body_bytes <= LARGE_BODY_BYTES else cls.LONG


class Turn:
    """The right of one request to run."""

    def __init__(self, lanes: Lanes, lane: Lane) -> None:
        self._lanes = lanes
        self.lane = lane

    def become_long(self) -> bool:
        """Leave the small lane for the long one while running; False if there is no room."""
        if not self._lanes.room(Lane.LONG):
            return False
        self._lanes.move(self.lane, Lane.LONG)
        self.lane = Lane.LONG
        return True


class Lanes:
    """The lanes of one pool.

    Parameters
    ----------
    workers : int
        N above.
    limit : int
        How many requests may wait in the small lane, and how many in the long one. Jobs wait elsewhere, by their own limits.
    """

    def __init__(self, workers: int, limit: int) -> None:
        self._workers = workers
        self._limit = limit
        self._running = dict.fromkeys(Lane, 0)
        self._waiting: dict[Lane, deque[asyncio.Future[None]]] = {lane: deque() for lane in Lane}

    def room(self, lane: Lane) -> bool:
        """Whether one more may run in a lane."""
        jobs, long = self._running[Lane.JOB], self._running[Lane.LONG]
        most = {
            Lane.JOB: self._workers,
            Lane.LONG: max(1, self._workers - jobs),
            Lane.SMALL: max(1, self._workers - jobs - long),
        }
        return self._running[lane] < most[lane]

    def full(self, lane: Lane) -> bool:
        """Whether one more would be refused."""
        return lane is not Lane.JOB and not self._runs_at_once(lane) and len(self._waiting[lane]) >= self._limit

    @property
    def running(self) -> Mapping[Lane, int]:
        """How many run in each lane."""
        return dict(self._running)

    @property
    def waiting(self) -> Mapping[Lane, int]:
        """How many wait in each lane."""
        return {lane: len(queue) for lane, queue in self._waiting.items()}

    @contextlib.asynccontextmanager
    async def turn(self, lane: Lane, again: bool = False) -> AsyncIterator[Turn]:
        """Wait in a lane, and hold a place to run in for the duration.

        Parameters
        ----------
        lane : Lane
        again : bool
            It was let in before and stopped: it is not refused, and waits before all others.

        Raises
        ------
        QueueFull
        """
        if self.full(lane) and not again:
            raise QueueFull
        if self._runs_at_once(lane):
            self._running[lane] += 1
        else:
            await self._wait(lane, again)
        turn = Turn(self, lane)
        try:
            yield turn
        finally:
            self._running[turn.lane] -= 1
            self._let_in()

    def move(self, lane: Lane, other: Lane) -> None:
        """Count one that runs in a lane as running in another."""
        self._running[lane] -= 1
        self._running[other] += 1
        self._let_in()

    def _runs_at_once(self, lane: Lane) -> bool:
        return not self._waiting[lane] and self.room(lane)

    async def _wait(self, lane: Lane, first: bool) -> None:
        """Wait until let in; who lets in has counted it as running."""
        entry: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        queue = self._waiting[lane]
        if first:
            queue.appendleft(entry)
        else:
            queue.append(entry)
        try:
            await entry
        except asyncio.CancelledError:
            if entry.done() and not entry.cancelled():  # let in and cancelled in the same turn of the loop
                self._running[lane] -= 1
                self._let_in()
            else:
                with contextlib.suppress(ValueError):  # passed over already
                    queue.remove(entry)
            raise

    def _let_in(self) -> None:
        """Let in as many as there is room for."""
        for lane in Lane:
            while self._waiting[lane] and self.room(lane):
                entry = self._waiting[lane].popleft()
                if not entry.cancelled():
                    self._running[lane] += 1
                    entry.set_result(None)
