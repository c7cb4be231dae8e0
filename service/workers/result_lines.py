"""Result lines of a chunk: a file that one worker after the other adds to, without anything passing through the web process.

Each line is written at once, in one call as a rule. So whatever ends a worker, all that it had finished is in the file, and at
most the beginning of one line more, which the next one cuts off. The file's digest is made on the way, while a line is at hand.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import socket
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType

import orjson

from service.errors import PROBLEM_LINE
from service.workers import wire

NOTE_SECONDS = 0.1
"""A worker on a chunk gives a sign of life after a line if it gave none for so long."""

BLOCK = 1 << 20
"""Bytes of a file that are read at a time."""


@dataclass(frozen=True, slots=True)
class Written:
    """The whole lines of a file: their bytes, how many they are, and how many of them are problem documents."""

    size: int = 0
    lines: int = 0
    failed: int = 0


class Unwritten(Exception):
    """The file system does not take a result line; what is there stays."""


class Results:
    """The file, open in a worker.

    Parameters
    ----------
    path : Path
        Made if it is not there.
    kept : Written
        What is left of it; anything after that is cut off.
    """

    def __init__(self, path: Path, kept: Written) -> None:
        self._size, self._lines, self._failed = kept.size, kept.lines, kept.failed
        self._hash = hashlib.sha256()
        try:
            self._file = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
            os.ftruncate(self._file, kept.size)
            while block := os.read(self._file, BLOCK):
                self._hash.update(block)
        except OSError as error:
            raise Unwritten(error.strerror) from error

    @property
    def written(self) -> Written:
        """What is in it."""
        return Written(self._size, self._lines, self._failed)

    @property
    def digest(self) -> str:
        """SHA-256 of what is in it."""
        return self._hash.hexdigest()

    def add(self, line: bytes) -> None:
        """Write a line, given without its end. Raises `Unwritten`, and then nothing of it stays."""
        size = len(line) + 1
        try:
            taken = os.writev(self._file, (line, b"\n"))
            while taken < size:  # the disk is all but full
                taken += os.write(self._file, (line + b"\n")[taken:])
        except OSError as error:
            with contextlib.suppress(OSError):
                os.ftruncate(self._file, self._size)
                os.lseek(self._file, self._size, os.SEEK_SET)
            raise Unwritten(error.strerror) from error
        self._hash.update(line)
        self._hash.update(b"\n")
        self._size += size
        self._lines += 1
        self._failed += line.startswith(PROBLEM_LINE)

    def close(self) -> None:
        """Give the file back."""
        os.close(self._file)


def whole(path: Path) -> Written:
    """What is whole of a file whose worker has ended."""
    size = lines = failed = 0
    with contextlib.suppress(FileNotFoundError), path.open("rb") as file:
        for line in file:
            if line.endswith(b"\n"):
                size += len(line)
                lines += 1
                failed += line.startswith(PROBLEM_LINE)
    return Written(size, lines, failed)


def answer_lines(handler: ModuleType, channel: socket.socket, header: wire.Header, body: bytes) -> wire.Header:
    """What a worker does with a message that has ``results``: write the result line of each line of the body.

    A sign of life goes out before a line is written, never after it. So where none came, the worker was ended at the first line
    that has no result.

    Returns
    -------
    dict
        ``written`` of the file, and its ``digest`` once all lines have their result. Else what the handler's ``handle_lines``
        returned, or ``unwritten``: why the file system did not take a line.
    """
    kept = Written(**header["kept"])
    try:
        results = Results(Path(header["results"]), kept)
    except Unwritten as error:
        return {"unwritten": str(error), "written": asdict(kept)}
    noted = time.monotonic()

    def add(line: bytes) -> None:
        nonlocal noted
        if (now := time.monotonic()) - noted >= NOTE_SECONDS:
            wire.send(channel, {})
            noted = now
        results.add(line)

    with contextlib.closing(results):
        try:
            if "instead" in header:
                add(orjson.dumps(header["instead"]))
            told = handler.handle_lines(header, body, add) or {"digest": results.digest}
        except Unwritten as error:
            told = {"unwritten": str(error)}
        return {**told, "written": asdict(results.written)}
