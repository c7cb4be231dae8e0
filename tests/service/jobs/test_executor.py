"""The end of what runs workflows: it does not wait for what DBOS tries for ever."""

from __future__ import annotations

import asyncio
import threading
import time
from types import SimpleNamespace
from typing import Any

import pytest

from service.jobs import executor
from service.jobs.port import StoreUnavailable
from tests.service.jobs.servers import NOISE_SECONDS

AWAY_SECONDS = 4 * NOISE_SECONDS


class Away:
    """A database that goes away when workflows have been claimed and not begun, for longer than the test has patience."""

    def __init__(self) -> None:
        self.claimed, self.back = threading.Event(), threading.Event()

    def start_queued_workflows(self, *_: Any, **__: Any) -> tuple[list[str], None]:
        self.claimed.set()
        return ["a-0"], None

    def get_workflow_statuses(self, _: list[str]) -> list[Any]:
        self.back.wait(AWAY_SECONDS)
        return []


async def nothing(*_: Any) -> None:
    """The work."""


def test_a_claim_that_is_tried_for_ever_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(executor, "_one_a_process", threading.Lock())
    monkeypatch.setattr(executor, "DBOS", SimpleNamespace(destroy=lambda **_: None))
    loop, database = asyncio.new_event_loop(), Away()
    try:
        made = executor.Executor("", "name", "all", 1, nothing, loop)
        assert executor._one_a_process.acquire(blocking=False)
        made._queue, made._dbos = None, SimpleNamespace(_sys_db=database)
        made.wake()
        assert database.claimed.wait(NOISE_SECONDS)
        begun = time.monotonic()
        with pytest.raises(StoreUnavailable):
            made.stop(None)
        assert time.monotonic() - begun < executor.CANCEL_SECONDS + executor.CLAIM_SECONDS + NOISE_SECONDS
        assert executor._one_a_process.acquire(blocking=False)
    finally:
        database.back.set()
        loop.close()
