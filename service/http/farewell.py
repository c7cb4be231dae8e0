"""The end of a connection whose client may still be sending.

A socket that is closed with bytes unread resets the connection, and a client that is reset loses the answer which it had not read
yet: the refusal of a body that is too large, say, would reach nobody who sends the whole of it first. So this side says that it
sends no more, and drops what comes until the client has seen it.
"""

from __future__ import annotations

import asyncio
import socket
from asyncio.trsock import TransportSocket
from collections.abc import Callable

LONGEST_SECONDS = 5.0
"""How long what comes is dropped."""

MOST_BYTES = 64 << 20
"""How much of it; to drop that takes some 10 ms."""

PIECE_BYTES = 256 << 10


def take_leave(loop: asyncio.AbstractEventLoop, end: TransportSocket, gone: Callable[[], object]) -> None:
    """Part from a client; `end` is this end of a connection that its transport is about to close. `gone` is called at last."""
    try:
        Farewell(loop, end.dup(), gone)
    except OSError:  # the client was faster, or there is no file left to do it with
        gone()


class Farewell:
    """One parting.

    Parameters
    ----------
    loop : asyncio.AbstractEventLoop
    end : socket.socket
        This end of the connection; closed when all is said.
    gone : callable
        Called then.

    Raises
    ------
    OSError
        The connection is gone already.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop, end: socket.socket, gone: Callable[[], object]) -> None:
        self._loop, self._end, self._gone = loop, end, gone
        self._left = MOST_BYTES
        end.setblocking(False)
        end.shutdown(socket.SHUT_WR)
        self._deadline = loop.call_later(LONGEST_SECONDS, self._over)
        loop.add_reader(end, self._drop)

    def _drop(self) -> None:
        try:
            count = len(self._end.recv(PIECE_BYTES))
        except (BlockingIOError, InterruptedError):
            return
        except OSError:
            count = 0
        self._left -= count
        if not count or self._left < 0:
            self._over()

    def _over(self) -> None:
        self._deadline.cancel()
        self._loop.remove_reader(self._end)
        self._end.close()
        self._gone()
