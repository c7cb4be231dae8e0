"""One attempt to have a request answered: the worker's messages, and how much it works for them."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from dataclasses import dataclass

from service.workers import wire
from service.workers.channel import Message
from service.workers.crew import Reason, Worker
from service.workers.lanes import Lane

LEAST_WAIT = 0.01
"""Seconds between two looks at how long a worker has worked."""

Progress = Callable[[str, float], None]


class Stopped(Exception):
    """A worker was ended, and the request begins again; `reason` says why."""

    def __init__(self, reason: Reason) -> None:
        super().__init__(reason)
        self.reason: Reason = reason


@dataclass(slots=True)
class Request:
    """One call of `Pool.solve` on its way."""

    header: wire.Header
    body: bytes
    lane: Lane
    progress: Progress | None
    clock: asyncio.Timeout
    seconds: float
    arrived: float
    unused: bool = False  # it wants a worker that has not worked before


async def answer_within(
    seconds: float | None, request: Request, worker: Worker, worked: Callable[[Worker], float]
) -> Message | None:
    """The answer, unless the worker uses more processor time than this for it; None: as much as it takes.

    What a new worker takes to get ready (10 ms, and several times that on a busy machine) is not the request's.
    """
    begun = worked(worker)
    left = seconds
    while left is None or left > 0.0:
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(None if left is None else max(left, LEAST_WAIT)):
                return await last_message(request, worker)
        if seconds is not None:
            ready = worker.channel.rehearsed
            left = seconds - (0.0 if ready is None else worked(worker) - max(begun, ready))
    return None


async def last_message(request: Request, worker: Worker) -> Message:
    """The answer, after any reports of progress."""
    while True:
        header, body = await worker.channel.receive()
        if header.get("again"):
            raise Stopped("memory")
        if "resident_bytes" in header:
            return header, body
        if request.progress is not None:
            request.progress(header["stage"], header["fraction"])
