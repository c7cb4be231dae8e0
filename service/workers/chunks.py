"""A chunk of a batch on its way through workers: which lines are done, and whose fault it is when a worker ends.

A worker sends each result line as soon as it has it, and this side reads what has gathered every few milliseconds. So the event
loop is not woken for each line, and yet everything a worker had finished when it ended is in the socket: the first line without a
result is the one it was at.
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator

import orjson

from service.errors import RequestError
from service.workers import wire
from service.workers.channel import Channel, ChannelClosed, Message
from service.workers.crew import Reason

GATHER_SECONDS = 0.05
"""How long result lines gather before they are read."""

FEW_BYTES = 128 << 10
"""Half of what asyncio reads at a time: where as much came, there is more, and to wait would only hold up the worker."""

ATTEMPTS = 2
"""Workers that a line may end before it is held to be its fault: a worker may also be ended from outside."""


class Chunk:
    """The lines of a chunk that have no result yet.

    Attributes
    ----------
    done : bool
    unused : bool
        The next line wants a worker that has not worked before.
    reason : str or None
        Why the last worker must be ended; None when it may be used again.
    resident_bytes, served : int
        What the last worker said about itself.
    """

    def __init__(self, header: wire.Header, body: bytes, first: int, seconds: float) -> None:
        self._header = header
        self._first = first
        self._seconds = seconds
        self._lines = body.split(b"\n")
        self._next = 0
        self._tried = 0  # workers that ended at the next line
        self._gathered = self._bytes = 0  # messages read since they were last waited for
        self.unused = False
        self.reason: Reason | None = None
        self.resident_bytes = self.served = 0
        self._skip_blank()

    @property
    def done(self) -> bool:
        """Whether every line has its result."""
        return self._next == len(self._lines)

    async def work(self, channel: Channel) -> AsyncIterator[bytes]:
        """Hand the rest to a worker; the result lines as far as this one comes."""
        self.reason = None
        self.unused = False
        self._gathered = self._bytes = 0
        header = {**self._header, "lines": True, "first": self._first + self._next}
        await channel.send(header, b"\n".join(self._lines[self._next :]))
        channel.pause()
        while True:
            try:
                answer, pieces = await self._message(channel)
            except TimeoutError:
                self.reason = "deadline"
                yield self._give_up("deadline-exceeded", f"It took longer than {self._seconds:g} s and was stopped.")
                return
            except ChannelClosed:
                self.reason = "crash"
                self._tried += 1
                if self._tried == ATTEMPTS:
                    yield self._give_up("worker-crashed", "The process that worked on it ended, and so did the next one.")
                return
            if "resident_bytes" in answer:
                self.resident_bytes, self.served = answer["resident_bytes"], answer["served"]
                if answer.get("again"):
                    self.reason, self.unused = "memory", True
                channel.resume()
                return
            self._advance()
            yield b"".join(pieces)

    async def _message(self, channel: Channel) -> Message:
        """The next message. It is read from the socket only while it is waited for, so a slow reader here slows the worker."""
        if channel.pending:
            return self._count(await channel.receive())
        if self._bytes < FEW_BYTES and len(self._lines) - self._next > 2 * self._gathered > 0:  # nor need it wait at its end
            await asyncio.sleep(GATHER_SECONDS)
        channel.resume()
        async with asyncio.timeout(self._seconds):
            message = await channel.receive()
        channel.pause()
        self._gathered = self._bytes = 0
        return self._count(message)

    def _count(self, message: Message) -> Message:
        """Note that a message was read."""
        self._gathered += 1
        self._bytes += sum(map(len, message[1]))
        return message

    def _give_up(self, code: str, detail: str) -> bytes:
        """The result of a line that gets no other."""
        number = self._first + self._next + 1
        self._advance()
        return orjson.dumps(RequestError(code, detail, {"line": number}).document())

    def _advance(self) -> None:
        self._tried = 0
        self._next += 1
        self._skip_blank()

    def _skip_blank(self) -> None:
        while self._next < len(self._lines) and not self._lines[self._next].strip():
            self._next += 1
