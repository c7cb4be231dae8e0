"""The web process's end of the socket to one worker: whole messages in, whole messages out, on the event loop.

A half message is never handed on. Waiting for a message may be cancelled without losing any, so a caller can look at a clock
and go on waiting.
"""

from __future__ import annotations

import asyncio
from collections import deque

import orjson

from service.workers import wire

Message = tuple[wire.Header, bytes]


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
    """Messages from and to a worker."""

    def __init__(self) -> None:
        self._transport: asyncio.Transport | None = None
        self._buffer = bytearray()
        self._messages: deque[Message] = deque()
        self._arrival: asyncio.Future[None] | None = None
        self._end: ChannelClosed | None = None

    @property
    def closed(self) -> bool:
        """Nothing more will come, from whichever side it was closed."""
        return self._end is not None or self._transport is None or self._transport.is_closing()

    @property
    def pending(self) -> bool:
        """Whether a message can be had without waiting."""
        return bool(self._messages)

    def send(self, header: wire.Header, body: bytes) -> None:
        """Send one message; that the worker has ended is found by `receive`."""
        if self._transport is not None and not self.closed:
            self._transport.writelines(wire.pack(header, body))

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

    def pause(self) -> None:
        """Let messages gather in the socket; its size is their limit."""
        if self._transport is not None and not self.closed:
            self._transport.pause_reading()

    def resume(self) -> None:
        """Read again."""
        if self._transport is not None and not self.closed:
            self._transport.resume_reading()

    def close(self) -> None:
        """Close this end; an idle worker takes it as its dismissal."""
        if self._transport is not None:
            self._transport.abort()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Called by the event loop."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport

    def data_received(self, data: bytes) -> None:
        """Called by the event loop: keep the whole messages, and the beginning of the next."""
        self._buffer += data
        begin = 0
        while len(self._buffer) - begin >= wire.FRAME.size:
            head_size, body_size = wire.FRAME.unpack_from(self._buffer, begin)
            body_begin = begin + wire.FRAME.size + head_size
            end = body_begin + body_size
            if len(self._buffer) < end:
                break
            with memoryview(self._buffer) as view:
                header = orjson.loads(view[begin + wire.FRAME.size : body_begin])
                self._messages.append((header, bytes(view[body_begin:end])))
            begin = end
        del self._buffer[:begin]
        if self._messages:
            self._wake()

    def connection_lost(self, error: Exception | None) -> None:
        """Called by the event loop. An error, other than a mere end, means that something sent was not read."""
        self._end = ChannelClosed(unread=error is not None)
        self._buffer.clear()
        self._wake()

    def _wake(self) -> None:
        if self._arrival is not None and not self._arrival.done():
            self._arrival.set_result(None)
