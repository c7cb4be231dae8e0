"""What the service calls: have a domain solved, or a chunk of a batch, by a worker that can be killed.

A request waits for its turn (`lanes`), is handed to a worker (`crew`), and its answer is waited for. If the deadline passes or
nobody wants the answer any more, the worker is killed: nothing less stops a compiled loop.

Everything here runs on the event loop of one process; there is no lock because there is no second thread.
"""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections.abc import AsyncIterator, Mapping
from dataclasses import dataclass
from typing import Any, get_args

from service.settings import Settings
from service.workers import wire
from service.workers.attempt import Progress, Request, Stopped, answer_within
from service.workers.channel import ChannelClosed, Message, Pieces
from service.workers.chunks import Lines
from service.workers.crew import Crew, Reason, Worker, stop
from service.workers.failures import DeadlineExceeded, PoolError, QueueFull, WorkerCrashed
from service.workers.lanes import Lane, Lanes, Turn
from service.workers.result_lines import Unwritten

__all__ = ["DeadlineExceeded", "Pool", "PoolError", "QueueFull", "Reply", "Stats", "Unwritten", "WorkerCrashed"]

ATTEMPTS = 3
"""Workers that a request is handed to when each ended before it had read the request."""

@dataclass(frozen=True, slots=True)
class Reply:
    """What a worker answered, and how long the request waited and was worked on."""

    header: wire.Header
    pieces: Pieces
    queue_seconds: float
    work_seconds: float

    @property
    def body(self) -> bytes:
        """The answer in one piece; what may be large is better passed on in those that it came in."""
        return b"".join(self.pieces)


@dataclass(frozen=True, slots=True)
class Stats:
    """The pool at one moment.

    Attributes
    ----------
    busy, idle : int
        Workers with a request, and without.
    running, waiting : mapping of str to int
        Requests by lane: small, long, job.
    kills : mapping of str to int
        Workers ended since the start, by reason; see `service.workers.crew.Reason`.
    """

    busy: int
    idle: int
    running: Mapping[str, int]
    waiting: Mapping[str, int]
    kills: Mapping[str, int]


class Pool:
    """Workers behind queues. Use as ``async with pool.running(): await pool.solve(...)``.

    Parameters
    ----------
    settings : Settings
    handler : str
        The module that the workers run.
    """

    def __init__(self, settings: Settings, handler: str = "service.workers.solve") -> None:
        self._settings = settings
        self._lanes = Lanes(settings.workers, settings.queue_limit)
        self._crew = Crew(settings, handler)

    @property
    def about(self) -> dict[str, Any]:
        """What the handler said about itself once loaded (versions); empty until then."""
        return self._crew.about

    @property
    def progress(self) -> tuple[str, int, int]:
        """The last step of loading: its name, how many are done, how many there are (0: not known yet)."""
        return self._crew.progress

    @property
    def load_failed(self) -> bool:
        """True while the last attempt to load the handler has failed; the next one is under way or due."""
        return self._crew.load_failed

    @property
    def ready(self) -> bool:
        """True when the workers are loaded."""
        return self._crew.ready

    @property
    def full(self) -> bool:
        """True when even a small request sent now would be refused."""
        return self.refuses(0)

    def refuses(self, body_bytes: int) -> bool:
        """Whether a synchronous request with a body of this size, sent now, would be refused: so many wait in its lane."""
        return self._lanes.full(Lane.of(body_bytes, job=False))

    def stats(self) -> Stats:
        """Figures for the metrics."""
        crew, lanes = self._crew, self._lanes
        return Stats(
            busy=crew.size - crew.idle,
            idle=crew.idle,
            running={lane.value: count for lane, count in lanes.running.items()},
            waiting={lane.value: count for lane, count in lanes.waiting.items()},
            kills={reason: crew.kills[reason] for reason in get_args(Reason)},
        )

    @contextlib.asynccontextmanager
    async def running(self) -> AsyncIterator[Pool]:
        """Keep the nursery and its workers alive for the duration; leave no process behind."""
        supervisor = asyncio.create_task(self._crew.supervise())
        try:
            yield self
        finally:
            await stop(supervisor)

    async def solve(
        self,
        header: wire.Header,
        body: bytes,
        *,
        deadline_seconds: float | None = None,
        progress: Progress | None = None,
        job: bool = False,
    ) -> Reply:
        """Have one request worked on. Cancelling the call kills the worker.

        Parameters
        ----------
        header : dict
            What the handler is to do with the body; see `service.workers.solve.handle`.
        body : bytes
        deadline_seconds : float, optional
            Instead of the setting's. It begins when the request arrives; that of a job, when a worker takes it.
        progress : callable, optional
            Called on the event loop with the stage that the work is in and the fraction (0 to 1) that is done. Work that begins
            again (in another lane, say) begins at 0 again.
        job : bool
            It is a job's: it never takes what is kept for synchronous requests, and is never refused.

        Raises
        ------
        QueueFull, DeadlineExceeded, WorkerCrashed
        """
        seconds = self._settings.deadline_seconds if deadline_seconds is None else deadline_seconds
        try:
            async with asyncio.timeout(None if job else seconds) as clock:
                lane = Lane.of(len(body), job)
                request = Request(header, body, lane, progress, clock, seconds, time.monotonic())
                return await self._solve(request)
        except TimeoutError:
            raise DeadlineExceeded from None

    async def solve_lines(self, lines: Lines, *, deadline_seconds: float | None = None) -> None:
        """Have a chunk of a batch worked on until each line that is not blank has its result line. Cancelling kills the worker.

        A result line is an answer document or a problem document, in order. A line that ends its worker, or takes too long or too
        much memory, costs itself only: its result says so, and the lines after it go on in another worker.

        Parameters
        ----------
        lines : Lines
        deadline_seconds : float, optional
            For each line, instead of the setting's.

        Raises
        ------
        Unwritten
            The file system did not take a line. When called again, it goes on there.
        """
        seconds = self._settings.deadline_seconds if deadline_seconds is None else deadline_seconds
        while lines.digest is None:
            async with self._lanes.turn(Lane.JOB):
                worker = await self._crew.take(lowered=True, unused=lines.unused)
                try:
                    reason = await lines.work(worker.channel, seconds)
                except BaseException:
                    self._crew.kill(worker, "dismissed")
                    raise
                if reason is None:
                    self._crew.give_back(worker, lines.resident_bytes, lines.served)
                elif reason == "memory":
                    self._crew.kill(worker, reason)
                else:
                    self._crew.kill(worker, reason, listen=True)
                    await lines.find_out(worker.channel, reason, seconds)
            if lines.unwritten is not None:
                raise Unwritten(lines.unwritten)

    async def _solve(self, request: Request) -> Reply:
        """Hand the request to workers until one has answered it."""
        again = False
        unread = 0
        while True:
            try:
                async with self._lanes.turn(request.lane, again) as turn:
                    return await self._attempt(request, turn)
            except Stopped as stopped:
                again = stopped.reason != "preempted"  # else it is the last of the lane that it goes on in
                request.unused = request.unused or again
                if not again and self._lanes.full(request.lane):
                    raise QueueFull(begun=True) from None
            except ChannelClosed as end:
                again = True
                unread += 1
                if not end.unread or unread == ATTEMPTS:
                    raise WorkerCrashed from None

    async def _attempt(self, request: Request, turn: Turn) -> Reply:
        """Hand the request to one worker, which pays with its life for everything but an answer."""
        worker = await self._crew.take(lowered=turn.lane is not Lane.SMALL, unused=request.unused)
        begun = time.monotonic()
        if turn.lane is Lane.JOB and request.clock.when() is None:
            request.clock.reschedule(asyncio.get_running_loop().time() + request.seconds)
        try:
            await worker.channel.send({**request.header, "progress": request.progress is not None}, request.body)
            answer, content = await self._answer(request, turn, worker)
        except BaseException as error:
            self._crew.kill(worker, _reason(error, request))
            raise
        self._crew.give_back(worker, answer.pop("resident_bytes"), answer.pop("served"))
        return Reply(answer, content, begun - request.arrived, time.monotonic() - begun)

    async def _answer(self, request: Request, turn: Turn, worker: Worker) -> Message:
        """Wait for the answer; on the way, take a request that is not small after all from lane to lane."""
        while (answer := await answer_within(turn.lane.seconds, request, worker, self._crew.worked)) is None:
            if turn.go_on():
                self._crew.lower(worker)
            elif turn.wanted:
                request.lane = turn.lane.next
                raise Stopped("preempted")
        return answer


def _reason(error: BaseException, request: Request) -> Reason:
    """Why a worker is killed whose request ended in an error."""
    if isinstance(error, Stopped):
        return error.reason
    if isinstance(error, ChannelClosed):
        return "crash"
    if request.clock.expired():
        return "deadline"
    return "dismissed" if request.lane is Lane.JOB else "disconnect"
