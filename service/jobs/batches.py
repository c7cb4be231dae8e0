"""Many domains in one body, one a line: cut into chunks on their way to the disk.

A chunk holds up to MAT_BATCH_CHUNK domains and CHUNK_BYTES, so that neither a worker nor this process ever holds much of a
batch. The end of a batch is cut finer, so that all workers are done at about the same time, and a small batch has work for each.
Blank lines stay where they are (they count as lines of the body and give no result), so a place in a problem is the caller's own
line number.
"""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import AsyncIterator, Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path

from service.jobs.blobs import Blobs
from service.jobs.calls import Calls
from service.jobs.port import BatchRefused
from service.jobs.store import Chunk
from service.settings import KIB, MIB, Settings

MAX_DOMAINS = 1_000_000
"""Of one batch: more rows of chunks than this makes would slow down every look at the job."""

MAX_LINES = 2 * MAX_DOMAINS
"""Blank ones included."""

CHUNK_BYTES = 8 * MIB
"""A chunk is closed beyond this size, however few domains it holds."""

HELD_BYTES = 3 * CHUNK_BYTES
"""What is held of a batch, however long it is: the chunk that is being filled, the one before, and as much on its way."""

AT_ONCE = 4
"""Chunks on their way to the disk; to bring several there takes hardly longer than one."""

LAST_PARTS = 4
"""The last chunks together are cut into so many for each worker."""

LEAST_DOMAINS, LEAST_BYTES = 25, 128 * KIB
"""No chunk is made smaller than this for that: handing one over takes as long as solving half a dozen glyphs."""

TURN_LINES = 2000
"""Lines that are looked at before the event loop does something else; a millisecond."""


@dataclass(slots=True)
class Cut:
    """Lines that follow each other.

    Attributes
    ----------
    first : int
        How many lines of the batch come before.
    lines : list of bytes
    domains, size : int
        How many of them are not blank, and their bytes.
    """

    first: int
    lines: list[bytes] = field(default_factory=list)
    domains: int = 0
    size: int = 0

    def add(self, line: bytes) -> bool:
        """Add a line; whether there is a domain in it."""
        domain = bool(line.strip())
        self.lines.append(line)
        self.size += len(line) + 1
        self.domains += domain
        return domain

    def full(self, domains: int, size: int) -> bool:
        """Whether it is a chunk by these limits. One without a domain never is."""
        return self.domains > 0 and (self.domains >= domains or self.size >= size)


class Reader:
    """Takes the bytes of a batch as they come, and writes chunks.

    Attributes
    ----------
    chunks : list of Chunk
        What is stored.
    """

    def __init__(self, settings: Settings, blobs: Blobs, calls: Calls, folder: Path) -> None:
        self._settings, self._blobs, self._calls, self._folder = settings, blobs, calls, folder
        self.chunks: list[Chunk] = []
        self._files: list[Path] = []
        self._writing: dict[int, tuple[asyncio.Task[str], int]] = {}  # by number: chunks on their way, and their bytes
        self._hash = hashlib.sha256()
        self._before = Cut(0)  # a whole chunk, which may turn out to be one of the last
        self._open = Cut(0)
        self._total = self._lines = self._domains = 0

    async def read(self, body: AsyncIterator[bytes]) -> str:
        """Read to the end; the digest of the whole body.

        Raises
        ------
        BatchRefused
            A line or the whole is too large, or there is no domain in it.
        StoreUnavailable
            The disk does not take it.
        """
        try:
            await self._read(body)
            await self._write_last()
            await self._written()
        finally:  # a thread would write into a folder that is being removed
            await asyncio.gather(*(task for task, _ in self._writing.values()), return_exceptions=True)
        if not self._domains:
            raise BatchRefused("not-json", "The body holds no line with a domain.", 1)
        return self._hash.hexdigest()

    async def store(self) -> None:
        """Give the chunks' files their names, once the body has come to its end."""
        await self._calls.file(self._blobs.adopt_all, self._by_digest())

    async def look_again(self) -> None:
        """Put back what was removed with another job before this one's rows were written; see `service.jobs.blobs`."""
        for digest, written in self._by_digest().items():
            if not await self._calls.file(self._blobs.has, digest):
                await self._calls.file(self._blobs.adopt_all, {digest: written})

    def _by_digest(self) -> dict[str, Path]:
        return {chunk.body: written for chunk, written in zip(self.chunks, self._files, strict=True)}

    async def _read(self, body: AsyncIterator[bytes]) -> None:
        """Cut a body into lines."""
        begun: list[bytes] = []  # pieces of a line whose end has not come yet
        begun_bytes = 0
        async for piece in body:
            self._hash.update(piece)
            self._total += len(piece)
            if self._total > self._settings.max_batch_bytes:
                raise self._too_large(f"The limit of a batch is {self._settings.max_batch_bytes} bytes.")
            first, *others = piece.split(b"\n")
            begun.append(first)
            begun_bytes += len(first)
            self._check_line(begun_bytes)
            if others:
                *lines, last = others
                await self._take([b"".join(begun), *lines])
                begun, begun_bytes = [last], len(last)
        if begun_bytes:
            await self._take([b"".join(begun)])

    async def _take(self, lines: Iterable[bytes]) -> None:
        """Put lines into the open chunk, and then into the next."""
        for number, line in enumerate(lines, 1):
            self._check_line(len(line))
            self._lines += 1
            self._domains += self._open.add(line)
            if self._domains > MAX_DOMAINS or self._lines > MAX_LINES:
                raise self._too_large(f"The limit of a batch is {MAX_DOMAINS} domains in {MAX_LINES} lines.")
            if self._open.full(self._settings.batch_chunk, CHUNK_BYTES):
                await self._write(self._before)
                self._before, self._open = self._open, Cut(self._lines)
            if number % TURN_LINES == 0:
                await asyncio.sleep(0)

    async def _write_last(self) -> None:
        """Cut what is left anew, and write it."""
        last = self._before.lines + self._open.lines
        parts = LAST_PARTS * self._settings.workers
        domains = min(self._settings.batch_chunk, max(LEAST_DOMAINS, -(-(self._before.domains + self._open.domains) // parts)))
        size = min(CHUNK_BYTES, max(LEAST_BYTES, (self._before.size + self._open.size) // parts))
        part = Cut(self._before.first)
        for number, line in enumerate(last, part.first + 1):
            part.add(line)
            if part.full(domains, size):
                await self._write(part)
                part = Cut(number)
            if number % TURN_LINES == 0:
                await asyncio.sleep(0)
        await self._write(part)

    async def _write(self, cut: Cut) -> None:
        """Have a chunk written, if there is a domain in it, while more is coming in."""
        if cut.domains:
            await self._written(max(0, CHUNK_BYTES - cut.size), AT_ONCE - 1)
            number, written = len(self.chunks), self._folder / f"{len(self._files):06d}"
            writing = asyncio.create_task(self._calls.file(self._blobs.write, written, b"\n".join(cut.lines)))
            self._writing[number] = writing, cut.size
            self._files.append(written)
            self.chunks.append(Chunk(number, cut.first, cut.domains, ""))

    async def _written(self, size: int = 0, chunks: int = 0) -> None:
        """Wait until no more bytes and chunks than these are on their way to the disk."""
        while len(self._writing) > chunks or sum(each for _, each in self._writing.values()) > size:
            number, (writing, _) = next(iter(self._writing.items()))
            self.chunks[number] = replace(self.chunks[number], body=await asyncio.shield(writing))
            del self._writing[number]

    def _check_line(self, size: int) -> None:
        """Refuse a line that is too long, as soon as it is known to be."""
        if size > self._settings.max_body_bytes:
            limit = self._settings.max_body_bytes
            raise self._too_large(f"The limit of a line is {limit} bytes; line {self._lines + 1} is longer.")

    def _too_large(self, detail: str) -> BatchRefused:
        return BatchRefused("body-too-large", detail, self._lines + 1)
