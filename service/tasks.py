"""What runs beside the service: the end of tasks, and calls in threads that nobody must wait for."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")

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


async def in_own_thread(function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
    """The value of a call that may hang, a database's, say: neither the event loop's end nor the process's waits for its thread.

    Both wait without a limit for the threads of `asyncio.to_thread`. Cancelling this leaves the thread to itself.
    """
    outcome: Future[T] = Future()
    outcome.set_running_or_notify_cancel()

    def call() -> None:
        try:
            outcome.set_result(function(*args, **kwargs))
        except BaseException as error:
            outcome.set_exception(error)

    threading.Thread(target=call, name=getattr(function, "__name__", None), daemon=True).start()
    return await asyncio.wrap_future(outcome)
