"""gzip both ways: bodies of requests are expanded under a limit, answers are compressed where it pays.

A bomb is the danger on the way in: 16 KB can hold 16 MB. So a body is expanded piece by piece and never further than its
limit, in a thread, whatever it promises; zlib works without the interpreter's lock, so the event loop goes on meanwhile.

On the way out ISA-L does the work, in a third of zlib's time.
"""

from __future__ import annotations

import asyncio
import zlib
from collections.abc import AsyncIterator

from isal import igzip, isal_zlib

from service.errors import RequestError

LEVEL = 1
"""Of ISA-L's 0 to 3. It takes a third of zlib's time for its level 1, and leaves less."""

LEAST_BYTES = 2048
"""Answers below it fit into two packets either way."""

MOST_MEMBERS = 1000
"""Of one body; each costs a new decompressor, and an empty one takes 20 bytes."""

PIECE_BYTES = 16 * 1024
"""Expanded at a time; no piece becomes more than a thousand times larger."""

_GZIP_WINDOW = 16 + zlib.MAX_WBITS


def compress(content: bytes) -> bytes:
    """The content as one gzip member; the same bytes for the same content."""
    return igzip.compress(content, LEVEL, mtime=0)


class Expander:
    """The body of a request as it was before gzip, fed piece by piece.

    Parameters
    ----------
    limit : int
        Bytes that all of it may expand to.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._member = zlib.decompressobj(_GZIP_WINDOW)
        self._members = 0
        self._total = 0

    def feed(self, piece: bytes) -> bytes:
        """What a piece expands to; members of a file that has several follow each other.

        Raises
        ------
        RequestError
            ``body-too-large`` beyond the limit, ``not-gzip`` for what is no gzip.
        """
        expanded = bytearray()
        while piece:
            if self._member.eof or not self._members:
                self._next_member()
            room = self._limit - self._total + 1
            try:
                part = self._member.decompress(piece, room)
            except zlib.error as error:
                raise RequestError("not-gzip", f"The body cannot be expanded: {error}.") from None
            self._total += len(part)
            if self._total > self._limit:
                detail = f"The limit is {self._limit} bytes; it expands to more."
                raise RequestError("body-too-large", detail, headers={"Connection": "close"})
            expanded += part
            piece = self._member.unused_data if self._member.eof else self._member.unconsumed_tail
        return bytes(expanded)

    def finish(self) -> None:
        """Hold that the end has come, and where it should.

        Raises
        ------
        RequestError
            ``not-gzip`` when the last member is cut off.
        """
        if not self._member.eof:
            raise RequestError("not-gzip", "The body ends before its gzip stream does.")

    def _next_member(self) -> None:
        self._members += 1
        if self._members > MOST_MEMBERS:
            raise RequestError("not-gzip", f"The body has more than {MOST_MEMBERS} gzip members.")
        self._member = zlib.decompressobj(_GZIP_WINDOW)


async def expanded(pieces: AsyncIterator[bytes], limit: int) -> AsyncIterator[bytes]:
    """A compressed body as it comes, expanded. RequestError as of `Expander`."""
    expander = Expander(limit)
    async for piece in pieces:
        for begin in range(0, len(piece), PIECE_BYTES):
            yield await asyncio.to_thread(expander.feed, piece[begin : begin + PIECE_BYTES])
    expander.finish()


async def compressed(pieces: AsyncIterator[bytes]) -> AsyncIterator[bytes]:
    """A stream of any length as one gzip member."""
    stream = isal_zlib.compressobj(LEVEL, wbits=_GZIP_WINDOW)
    async for piece in pieces:
        if part := await asyncio.to_thread(stream.compress, piece):
            yield part
    yield stream.flush()
