"""Files by name, ``-`` for the standard streams, and ``.gz`` packed or unpacked on the way."""

from __future__ import annotations

import contextlib
import fcntl
import gzip
import os
import shutil
import sys
import tempfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO, cast

from service.cli.exits import FAILED, INVALID_INPUT, USAGE, Failure
from service.http.compression import compress

STANDARD = "-"
PACKED = ".gz"
BLOCK = 1 << 20
SCRATCH = "mat-batch-"
"""How the names of folders of temporary files begin."""

_GZIP_WINDOW = 31
"""zlib's parameter for gzip's own frame."""


def shown(name: str, stream: str) -> str:
    """What to call a file in a message."""
    return f"standard {stream}" if name == STANDARD else name


def read(name: str) -> bytes:
    """All of a file."""
    with reading(name) as lines:
        return lines.read()


@contextlib.contextmanager
def reading(name: str) -> Iterator[IO[bytes]]:
    """A file open for reading; failures to read it, now or later, are told by name."""
    where = shown(name, "input")
    try:
        if name == STANDARD:
            yield sys.stdin.buffer
        elif name.endswith(PACKED):
            with gzip.open(name) as unpacked:
                yield cast(IO[bytes], unpacked)
        else:
            with open(name, "rb") as plain:
                yield plain
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise Failure(INVALID_INPUT, f"{where} is not a whole gzip file: {error}") from error
    except (FileNotFoundError, PermissionError, IsADirectoryError) as error:
        if error.filename != name:
            raise
        raise Failure(USAGE, f"cannot read {where}: {error.strerror}") from error


def write(name: str, content: bytes) -> None:
    """Write a whole file, or leave what was there: it appears under its name when all of it is on disk."""
    if name == STANDARD:
        sys.stdout.buffer.write(content)
        sys.stdout.buffer.flush()
        return
    path = Path(name)
    if path.exists() and not path.is_file():  # a device or a pipe
        path.write_bytes(content)
        return
    try:
        descriptor, draft = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    except OSError as error:
        raise Failure(USAGE, f"cannot write {name}: {error.strerror}") from error
    try:
        with open(descriptor, "wb") as file:
            file.write(compress(content) if name.endswith(PACKED) else content)
        os.chmod(draft, 0o666 & ~_umask())
        os.replace(draft, path)
    except OSError as error:
        raise Failure(FAILED, f"cannot write {name}: {error.strerror}") from error
    finally:
        with contextlib.suppress(OSError):
            os.unlink(draft)


def _umask() -> int:
    """The mask for the permissions of new files, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


@contextlib.contextmanager
def scratch() -> Iterator[Path]:
    """A folder among the temporary files. What a process left there that was killed is removed by the next one.

    Who uses a folder holds a lock on it, which ends with the process however that ends.
    """
    for left in Path(tempfile.gettempdir()).glob(f"{SCRATCH}*"):
        with contextlib.suppress(OSError), _held(left):
            shutil.rmtree(left)
    with contextlib.ExitStack() as stack:
        folder = None
        while folder is None:
            made = Path(tempfile.mkdtemp(prefix=SCRATCH))
            with contextlib.suppress(OSError):  # another process may find it before it is locked
                stack.enter_context(_held(made))
                folder = made if made.is_dir() else None
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def _held(folder: Path) -> Iterator[None]:
    """Hold a folder's lock. Raises OSError where somebody else does, or where it is gone."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    finally:
        os.close(descriptor)


class LinesOut:
    """The output of a batch: lines are added in groups, and only whole lines stay there whatever happens.

    A group goes out in one call of the system; where that fails half way, its beginning is taken back. A packed file gets a
    member of its own for each group.

    Parameters
    ----------
    name : str
        The file, or ``-``.
    resume : bool
        Keep the whole lines that are there; anything after them is cut off.

    Attributes
    ----------
    kept : int
        How many there were.
    """

    def __init__(self, name: str, *, resume: bool) -> None:
        self._name = name
        self._packed = name.endswith(PACKED)
        self.kept = 0
        if name == STANDARD:
            self._descriptor = os.dup(sys.stdout.fileno())
            return
        flags = os.O_RDWR | os.O_CREAT | (0 if resume else os.O_TRUNC)
        try:
            self._descriptor = os.open(name, flags, 0o666)
        except OSError as error:
            raise Failure(USAGE, f"cannot write {name}: {error.strerror}") from error
        if resume:
            with open(name, "rb") as file:
                self.kept, whole = (_whole_members if self._packed else _whole_lines)(file)
            os.ftruncate(self._descriptor, whole)
            os.lseek(self._descriptor, whole, os.SEEK_SET)

    def add(self, content: bytes) -> None:
        """Write whole lines."""
        left = memoryview(compress(content) if self._packed else content)
        before = 0 if self._name == STANDARD else os.lseek(self._descriptor, 0, os.SEEK_CUR)
        try:
            while left:
                left = left[os.write(self._descriptor, left) :]
        except BrokenPipeError:
            raise
        except OSError as error:
            with contextlib.suppress(OSError):
                os.ftruncate(self._descriptor, before)
            raise Failure(FAILED, f"cannot write {self._name}: {error.strerror}; what is there can be resumed") from error

    def close(self) -> None:
        """Give the file back."""
        os.close(self._descriptor)


def _whole_lines(file: IO[bytes]) -> tuple[int, int]:
    """How many lines of a file are whole, and where the last of them ends."""
    count = end = position = 0
    while block := file.read(BLOCK):
        count += block.count(b"\n")
        if (last := block.rfind(b"\n")) >= 0:
            end = position + last + 1
        position += len(block)
    return count, end


def _whole_members(file: IO[bytes]) -> tuple[int, int]:
    """The same for a packed file, whose members hold whole lines."""
    count = end = position = 0
    member, lines = zlib.decompressobj(_GZIP_WINDOW), 0
    while block := file.read(BLOCK):
        position += len(block)
        while block:
            try:
                lines += member.decompress(block).count(b"\n")
            except zlib.error:
                return count, end
            block = member.unused_data
            if member.eof:
                count, end = count + lines, position - len(block)
                member, lines = zlib.decompressobj(_GZIP_WINDOW), 0
    return count, end
