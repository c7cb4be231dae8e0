"""Calls that block (rows, files) from the event loop: in threads of their own, never for long, with one way to fail."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import ParamSpec, TypeVar

from sqlalchemy import exc

from service.jobs.port import StoreUnavailable

P = ParamSpec("P")
T = TypeVar("T")

THREADS = 8
"""A database that hangs must not take the threads that files and the framework need."""

ANSWER_SECONDS = 5.0
"""A question that takes longer counts as not answered; what it changes may still happen."""

MUCH_SECONDS = 30.0
"""The same for a call that changes many rows or files: longer than the database lets one of its statements take
(`service.jobs.engine`), and no longer than most clients wait."""

RETRY_SECONDS = 0.5
"""Pause of work that must be recorded, while it cannot be."""

_log = logging.getLogger("service.jobs")


def first_line(error: BaseException | None) -> str:
    """What is wrong, without the advice that libraries add; the kind of error where it says nothing."""
    return (str(error) or type(error).__name__).partition("\n")[0]


class Calls:
    """The threads, and whether the last call reached the store."""

    def __init__(self) -> None:
        self._threads = ThreadPoolExecutor(THREADS, thread_name_prefix="jobs-store")
        self.up = False

    async def ask(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """The value of a call.

        Raises
        ------
        StoreUnavailable
            The database or the file system refused, or did not answer in time.
        """
        return await self._call(ANSWER_SECONDS, partial(function, *args, **kwargs))

    async def ask_much(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Like `ask`, for a call that changes many rows or files and takes its time."""
        return await self._call(MUCH_SECONDS, partial(function, *args, **kwargs))

    async def ask_long(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Like `ask`, for a call that nobody waits for and that takes as long as there are files."""
        return await self._call(None, partial(function, *args, **kwargs))

    async def file(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """The value of a call that reads or writes files, however long they are. StoreUnavailable where that fails."""
        try:
            return await asyncio.to_thread(function, *args, **kwargs)
        except OSError as error:
            raise StoreUnavailable(first_line(error)) from error

    async def insist(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """The value of a call that is made until it reaches the store."""
        while True:
            try:
                return await self.ask(function, *args, **kwargs)
            except StoreUnavailable:
                await asyncio.sleep(RETRY_SECONDS)

    async def _call(self, seconds: float | None, function: Callable[[], T]) -> T:
        future = asyncio.get_running_loop().run_in_executor(self._threads, function)
        try:
            async with asyncio.timeout(seconds):  # wait_for of Python 3.11 loses a cancellation that meets the answer
                value = await future
        except exc.IntegrityError:
            raise  # an answer, too
        except (exc.OperationalError, exc.InterfaceError, exc.InternalError, exc.TimeoutError, TimeoutError, OSError) as error:
            self._note(False, error)
            raise StoreUnavailable(first_line(error)) from error
        self._note(True)
        return value

    def close(self) -> None:
        """End the threads that are idle; one that hangs is not waited for."""
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _note(self, up: bool, error: BaseException | None = None) -> None:
        if up != self.up:
            self.up = up
            if up:
                _log.info("the job store answers")
            else:
                _log.error("the job store does not answer: %s", first_line(error))
