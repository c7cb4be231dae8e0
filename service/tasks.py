"""The end of tasks that run beside the service."""

from __future__ import annotations

import asyncio
from typing import Any

AGAIN_SECONDS = 1.0
"""Pause before tasks are told again to end."""


async def end(*tasks: asyncio.Task[Any]) -> None:
    """Cancel tasks and wait until they are done.

    A cancellation that meets the end of what it waits for can be lost, so it is said until it is heard.
    """
    while not all(task.done() for task in tasks):
        for task in tasks:
            task.cancel()
        await asyncio.wait(tasks, timeout=AGAIN_SECONDS)
