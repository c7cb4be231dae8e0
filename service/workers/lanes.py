"""Who may run now and who waits: four lanes, so that work of milliseconds never stands behind work of minutes.

::

    lane    what takes it                                    until it has worked for  runs at once, of N workers
    small   a small body                                     a twentieth of a second  N
    middle  what has left the small lane                     a second                 what long ones and jobs leave of N, or one
    long    a large body, and what has left the middle lane  it is done               what jobs leave of N, or one
    job     jobs and batches, whatever their size            it is done               N

So the processors are used whatever is asked of the service, nothing keeps the worker of the lanes before it, and no lane
starves. More than N processes may run for a while; those of the lanes after the first give way to it (`process.give_way`).

The size of a body says little: a small one may ask for a tiny step. What has worked for as long as its lane allows (in processor
time: on a busy machine nobody pays for the others) therefore goes on in the next one where it is, if there is room. If not, and
somebody waits for its place, it is stopped, and begins again when its turn comes in the next lane; it is refused if too many wait
there: no more work is let in by small bodies than by large ones. So whoever waits in the small lane waits for a twentieth of a
second for each one before it at most, whatever that one asks for. Beside a flow of small bodies that would take half a minute
each, small requests take 20 ms (p50) and 0.2 s (p99) on two processors; they took 1.0 and 1.6 s when each had a second.

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

class Lane(Enum):
    """Where a request waits; in the order in which a free place is given away."""

    SMALL = "small"
    MIDDLE = "middle"
    LONG = "long"
    JOB = "job"

    @classmethod
    def of(cls, body_bytes: int, job: bool) -> Lane:
        """The lane that a request begins in."""
        if job:
            return cls.JOB
        return cls.SMALL if body_bytes <= LARGE_BODY_BYTES else cls.LONG

    @property
    def next(self) -> Lane:
        """Where a request goes on that has used its `seconds`."""
        return _NEXT.get(self, self)

    @property
    def seconds(self) -> float | None:
        """Processor time that a request may use in the lane; None: as much as it takes."""
        return _SECONDS.get(self)


_NEXT = {Lane.SMALL: Lane.MIDDLE, Lane.MIDDLE: Lane.LONG}
_SECONDS = {Lane.SMALL: 0.05, Lane.MIDDLE: 1.0}


_ORDER = tuple(Lane)


class Turn:
    """The right of one request to run."""

    def __init__(self, lanes: Lanes, lane: Lane) -> None:
        self._lanes = lanes
        self.lane = lane

    @property
    def wanted(self) -> bool:
        """Whether somebody waits for the place."""
        return bool(self._lanes.waiting[self.lane])

    def go_on(self) -> bool:
        """Leave the lane for the next one while running; False if there is no room."""
        if not self._lanes.room(self.lane.next):
            return False
        self._lanes.move(self.lane, self.lane.next)
        self.lane = self.lane.next
        return True


class Lanes:
    """The lanes of one pool.

    Parameters
    ----------
    workers : int
        N above.
    limit : int
        How many requests may wait in each lane but that of jobs. These wait elsewhere, by their own limits.
    """

    def __init__(self, workers: int, limit: int) -> None:
        self._workers = workers
        self._limit = limit
        self._running = dict.fromkeys(Lane, 0)
        self._waiting: dict[Lane, deque[asyncio.Future[None]]] = {lane: deque() for lane in Lane}

    def room(self, lane: Lane) -> bool:
        """Whether one more may run in a lane."""
        after = 0 if lane is Lane.SMALL else sum(self._running[other] for other in _ORDER[_ORDER.index(lane) + 1 :])
        return self._running[lane] < max(1, self._workers - after)

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
