"""Many domains in one body, one a line: cut into chunks on their way to the disk.

A chunk holds up to MAT_BATCH_CHUNK domains and CHUNK_BYTES, so that neither a worker nor this process ever holds much of a
batch. Blank lines stay where they are (they count as lines of the body and give no result), so a place in a problem is the
caller's own line number.
"""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import AsyncIterator
from dataclasses import replace
from pathlib import Path

from service.jobs.blobs import Blobs
from service.jobs.calls import Calls
from service.jobs.port import BatchRefused
from service.jobs.store import Chunk
from service.settings import MIB, Settings

MAX_DOMAINS = 1_000_000
"""Of one batch: more rows of chunks than this makes would slow down every look at the job."""

MAX_LINES = 2 * MAX_DOMAINS
"""Blank ones included."""

CHUNK_BYTES = 8 * MIB
"""A chunk is closed beyond this size, however few domains it holds."""


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
        self._writing: asyncio.Task[str] | None = None  # of the last of them, while the next one is being filled
        self._hash = hashlib.sha256()
        self._open: list[bytes] = []  # complete lines of the open chunk
        self._open_bytes = self._domains = self._lines = self._total = self._stored_lines = self._all_domains = 0

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
            await self._written()
        finally:
            if self._writing is not None:
                await asyncio.wait([self._writing])  # a thread would write into a folder that is being removed
        if not self._all_domains:
            raise BatchRefused("not-json", "The body holds no line with a domain.", 1)
        return self._hash.hexdigest()

    async def _read(self, body: AsyncIterator[bytes]) -> None:
        """Cut a body into lines, and these into chunks."""
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
                for line in (b"".join(begun), *lines):
                    await self._take(line)
                begun, begun_bytes = [last], len(last)
        if begun_bytes:
            await self._take(b"".join(begun))
        await self._close()

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

    async def _take(self, line: bytes) -> None:
        """Put a line into the open chunk."""
        self._check_line(len(line))
        self._lines += 1
        self._open.append(line)
        self._open_bytes += len(line) + 1
        if line.strip():
            self._domains += 1
            self._all_domains += 1
        if self._all_domains > MAX_DOMAINS or self._lines > MAX_LINES:
            raise self._too_large(f"The limit of a batch is {MAX_DOMAINS} domains in {MAX_LINES} lines.")
        if self._domains >= self._settings.batch_chunk or self._open_bytes >= CHUNK_BYTES:
            await self._close()

    async def _close(self) -> None:
        """Have the open chunk written, if there is a domain in it, while the next one comes in."""
        if self._domains:
            await self._written()
            written = self._folder / f"{len(self._files):06d}"
            content = b"\n".join(self._open)
            self._writing = asyncio.create_task(self._calls.file(self._blobs.write, written, content))
            self._files.append(written)
            self.chunks.append(Chunk(len(self.chunks), self._stored_lines, self._domains, ""))
            self._open, self._open_bytes, self._domains = [], 0, 0
            self._stored_lines = self._lines

    async def _written(self) -> None:
        """Wait until the last chunk is on disk."""
        if self._writing is not None:
            self.chunks[-1] = replace(self.chunks[-1], body=await asyncio.shield(self._writing))
            self._writing = None

    def _check_line(self, size: int) -> None:
        """Refuse a line that is too long, as soon as it is known to be."""
        if size > self._settings.max_body_bytes:
            limit = self._settings.max_body_bytes
            raise self._too_large(f"The limit of a line is {limit} bytes; line {self._lines + 1} is longer.")

    def _too_large(self, detail: str) -> BatchRefused:
        return BatchRefused("body-too-large", detail, self._lines + 1)
