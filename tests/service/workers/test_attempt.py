"""How long one attempt may take: processor time of the request, and not of the worker that gets ready for it."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest

from service.workers.attempt import Request, answer_within
from service.workers.channel import Message
from service.workers.crew import Worker
from service.workers.lanes import Lane

ANSWER: Message = ({"resident_bytes": 1}, (b"answer",))
ALLOWED, PATIENCE = 0.05, 0.3


def outcome(rehearsed: float | None, used: list[float]) -> Message | None:
    """What becomes of a request whose worker answers after a while, and has used so much each time that it is looked at."""

    there = asyncio.Event()

    async def receive() -> Message:
        await there.wait()
        return ANSWER

    async def run() -> Message | None:
        asyncio.get_running_loop().call_later(PATIENCE, there.set)
        async with asyncio.timeout(60) as clock:
            request = Request({}, b"", Lane.SMALL, None, clock, 60.0, 0.0)
            worker = cast("Worker", SimpleNamespace(channel=SimpleNamespace(receive=receive, rehearsed=rehearsed)))
            return await answer_within(ALLOWED, request, worker, lambda _: next(figures))

    figures: Iterator[Any] = iter([*used, *[used[-1]] * 100])
    return asyncio.run(run())


@pytest.mark.parametrize(
    ("rehearsed", "used", "answered"),
    [
        (0.0, [5.0, 5.01], True),  # an old worker that waits for something
        (0.0, [5.0, 5.1], False),
        (0.9, [0.2, 0.91], True),  # it was still getting ready
        (0.9, [0.2, 0.96], False),
        (None, [0.0, 0.9], True),  # it still is
    ],
)
def test_only_the_request_is_counted(rehearsed: float | None, used: list[float], answered: bool) -> None:
    assert (outcome(rehearsed, used) == ANSWER) == answered
