"""A pool with real processes that do as they are told, for the duration of one scenario."""

from __future__ import annotations

import asyncio
import json
import os
from collections.abc import Awaitable, Callable
from typing import Any

from service.settings import Settings
from service.workers.pool import Pool
from tests.service.processes import alive, descendants, eventually

HANDLER = "tests.service.handlers"


def order(do: str, padding: int = 0, **content: Any) -> bytes:
    return json.dumps({"do": do, **content}).encode() + b" " * padding


def with_pool(scenario: Callable[[Pool], Awaitable[None]], handler: str = HANDLER, **settings: Any) -> None:
    """Run a scenario against a running pool, then hold that no process is left.

    Its long work gives way to nobody unless that is what is tested: it would wait for the tests beside it.
    """

    async def run() -> None:
        pool = Pool(Settings(**{"workers": 2, "deadline_seconds": 20.0, "long_priority": "normal", **settings}), handler)
        async with pool.running():
            await scenario(pool)
            seen.update(descendants(os.getpid()) - before)

    before = descendants(os.getpid())
    seen: set[int] = set()
    asyncio.run(run())
    eventually(lambda: not any(alive(pid) for pid in seen))


async def eventually_in_loop(condition: Callable[[], bool], seconds: float = 10.0) -> None:
    async with asyncio.timeout(seconds):
        while not condition():
            await asyncio.sleep(0.005)


async def pid_of(pool: Pool) -> int:
    reply = await pool.solve({}, order("echo"))
    return int(reply.header["pid"])
