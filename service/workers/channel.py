"""The web process's end of the socket to one worker: whole messages in, whole messages out, on the event loop.

A half message is never handed on. Waiting for a message may be cancelled without losing any, so a caller can look at a clock
and go on waiting.

The body of a large message is never in one piece here. It is kept as it came from the socket and sent as the socket takes it:
to copy, or to give back, a hundred megabytes at once would hold up the event loop, and with it every other request.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Iterator
from typing import cast

import orjson

from service.workers import wire

Pieces = tuple[bytes, ...]
"""A body, as it came: one piece after the other."""

Message = tuple[wire.Header, Pieces]

PIECE_BYTES = 256 * 1024
"""Of a body that is handed to the socket at a time."""


class ChannelClosed(Exception):
    """The worker ended.

    Attributes
    ----------
    unread : bool
        It ended without having read all that was sent: what was sent cannot be what ended it.
    """

    def __init__(self, unread: bool) -> None:
        super().__init__(unread)
        self.unread = unread


class Channel(asyncio.Protocol):
    """Messages from and to a worker.

    Attributes
    ----------
    rehearsed : float or None
        Seconds of processor time that the worker took before it could read its first message; None until it says so.
    """

    def __init__(self) -> None:
        self.rehearsed: float | None = None
        self._transport: asyncio.Transport | None = None
        self._incoming = Incoming()
        self._messages: deque[Message] = deque()
        self._arrival: asyncio.Future[None] | None = None
        self._room: asyncio.Future[None] | None = None  # while the socket takes no more
        self._end: ChannelClosed | None = None

    @property
    def closed(self) -> bool:
        """Nothing more will come, from whichever side it was closed."""
        return self._end is not None or self._transport is None or self._transport.is_closing()

    @property
    def pending(self) -> bool:
        """Whether a message can be had without waiting."""
        return bool(self._messages)

    async def send(self, header: wire.Header, body: bytes) -> None:
        """Send one message, at the pace of the worker; that it has ended is found by `receive`."""
        head = wire.pack(header, len(body))
        if len(body) <= wire.JOINED_BYTES:
            self._write(head + body)
            return
        self._write(head)
        with memoryview(body) as view:
            for begin in range(0, len(body), PIECE_BYTES):
                if self._room is not None:
                    await self._room
                self._write(view[begin : begin + PIECE_BYTES])

    async def receive(self) -> Message:
        """The next message.

        Raises
        ------
        ChannelClosed
            After the last whole message; what came of another one is dropped.
        """
        while not self._messages:
            if self._end is not None:
                raise self._end
            self._arrival = asyncio.get_running_loop().create_future()
            await self._arrival
        return self._messages.popleft()

    def close(self) -> None:
        """Close this end; an idle worker takes it as its dismissal."""
        if self._transport is not None:
            self._transport.abort()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Called by the event loop."""
        self._transport = cast("asyncio.Transport", transport)  # by what it does: not every loop's is one by its class

    def data_received(self, data: bytes) -> None:
        """Called by the event loop: keep the whole messages, and the beginning of the next."""
        for header, body in self._incoming.feed(data):
            if self.rehearsed is None and header.keys() == {wire.REHEARSED}:
                self.rehearsed = header[wire.REHEARSED]
            else:
                self._messages.append((header, body))
        if self._messages:
            _wake(self._arrival)

    def pause_writing(self) -> None:
        """Called by the event loop: the worker does not read as fast as it is written to."""
        self._room = asyncio.get_running_loop().create_future()

    def resume_writing(self) -> None:
        """Called by the event loop."""
        _wake(self._room)
        self._room = None

    def connection_lost(self, error: Exception | None) -> None:
        """Called by the event loop. An error, other than a mere end, means that something sent was not read."""
        self._end = ChannelClosed(unread=error is not None)
        self._incoming = Incoming()
        _wake(self._arrival)
        self.resume_writing()

    def _write(self, data: bytes | memoryview) -> None:
        if self._transport is not None and not self.closed:
            self._transport.write(data)


class Incoming:
    """Messages put together from what a socket gives."""

    def __init__(self) -> None:
        self._head = bytearray()  # of the next message, until it is whole
        self._header: wire.Header | None = None  # of the message whose body is coming
        self._pieces: list[bytes] = []
        self._missing = 0  # bytes of that body

    def feed(self, data: bytes) -> Iterator[Message]:
        """The messages that are whole now."""
        begin = 0
        while begin < len(data) or (self._header is not None and not self._missing):
            if self._header is None:
                begin = self._feed_head(data, begin)
            elif self._missing:
                piece = data[begin : begin + self._missing]  # no copy where it is all of the data
                self._pieces.append(piece)
                self._missing -= len(piece)
                begin += len(piece)
            else:
                yield self._header, tuple(self._pieces)
                self._header, self._pieces = None, []

    def _feed_head(self, data: bytes, begin: int) -> int:
        """Take what belongs to the head of a message; where the rest begins."""
        end = begin + max(0, wire.FRAME.size - len(self._head))
        self._head += data[begin:end]
        if len(self._head) < wire.FRAME.size:
            return len(data)
        header_size, body_size = cast("tuple[int, int]", wire.FRAME.unpack_from(self._head))
        begin, end = end, end + wire.FRAME.size + header_size - len(self._head)
        self._head += data[begin:end]
        if len(self._head) == wire.FRAME.size + header_size:
            self._header = orjson.loads(memoryview(self._head)[wire.FRAME.size :])
            self._missing = body_size
            self._head = bytearray()
        return end


def _wake(waiter: asyncio.Future[None] | None) -> None:
    if waiter is not None and not waiter.done():
        waiter.set_result(None)
