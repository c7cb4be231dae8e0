"""Payloads and results in files named by the SHA-256 of their content, so that equal ones are kept once.

::

    MAT_DATA_DIR/blobs/3f/3fa4...      complete files, never written to again
    MAT_DATA_DIR/incoming/<random>     files being written; moved to their name when they are on disk

Rows hold digests. A file may be wanted again at the moment it is removed, by another process, too; so there are two rules in
place of a lock: who stores a digest in a row looks afterwards whether the file is still there (and puts it again if not), and
who removes a file moves it aside first, asks once more whether a row has its digest, and moves it back if so. In whichever
order the steps of both fall, a file that a row names is there in the end.

The rest of the jobs knows no more of files than the methods here: an object store that has these, and `incoming` on a disk of
this machine, can take the folder's place. Everything here blocks; it is called in threads.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import time
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

STALE_SECONDS = 24 * 3600.0
"""Unfinished and unclaimed files older than this belong to nobody: no upload lasts a day."""


class Blobs:
    """The files below one folder.

    Attributes
    ----------
    incoming : Path
        Where files are written before they have a name; on the same file system as their place.
    """

    def __init__(self, folder: Path) -> None:
        self._blobs = folder / "blobs"
        self.incoming = folder / "incoming"

    def open(self) -> None:
        """Make the folders. OSError where that cannot be done."""
        for folder in (self._blobs, self.incoming):
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)

    def path(self, digest: str) -> Path:
        """Where the file of a digest is, or would be."""
        return self._blobs / digest[:2] / digest

    def has(self, digest: str) -> bool:
        """Whether it is there."""
        return self.path(digest).is_file()

    def read(self, digest: str) -> bytes:
        """The content. FileNotFoundError when it is not there."""
        return self.path(digest).read_bytes()

    def size(self, digest: str) -> int:
        """Bytes of the content. FileNotFoundError when it is not there."""
        return self.path(digest).stat().st_size

    def reading(self, digest: str) -> BinaryIO:
        """The content, opened to be read. FileNotFoundError when it is not there."""
        return self.path(digest).open("rb")

    def put(self, content: bytes) -> str:
        """Store bytes, durably; the digest is their name."""
        digest = hashlib.sha256(content).hexdigest()
        if not self.has(digest):
            written = self.incoming / uuid.uuid4().hex
            try:
                self.adopt_all({self.write(written, content): written})
            finally:
                written.unlink(missing_ok=True)
        return digest

    def adopt(self, written: Path, digest: str | None = None) -> str:
        """Store a file of the incoming folder, durably; it may be removed there. The digest may be known already."""
        if digest is None:
            with written.open("rb") as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
        _sync(written)
        self.adopt_all({digest: written})
        return digest

    def write(self, written: Path, content: bytes) -> str:
        """Write a file of the incoming folder, durably, for `adopt_all`; the digest."""
        written.write_bytes(content)
        _sync(written)
        return hashlib.sha256(content).hexdigest()

    def adopt_all(self, written: Mapping[str, Path]) -> None:
        """Store files of the incoming folder, by their digests, whose bytes are on disk; they may be removed there."""
        for digest, file in written.items():
            place = self.path(digest)
            place.parent.mkdir(mode=0o700, exist_ok=True)
            with contextlib.suppress(FileExistsError):  # the same content
                os.link(file, place)
        for folder in {self.path(digest).parent for digest in written} | {self._blobs}:
            _sync(folder)  # the names are as durable as the files

    @contextlib.contextmanager
    def folder(self) -> Iterator[Path]:
        """A folder for incoming files, gone afterwards with all that is still in it."""
        folder = self.incoming / uuid.uuid4().hex
        folder.mkdir(mode=0o700)
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def remove(self, digests: Iterable[str], referenced: Callable[[set[str]], set[str]]) -> None:
        """Remove files that no row names.

        Parameters
        ----------
        digests : iterable of str
            Candidates.
        referenced : callable
            Which of a set of digests are named by rows at this moment.
        """
        unused = set(digests) - referenced(set(digests))
        aside = {digest: self.incoming / f"{digest}.{uuid.uuid4().hex}" for digest in unused}
        for digest, place in list(aside.items()):
            try:
                self.path(digest).rename(place)
            except FileNotFoundError:
                del aside[digest]
        wanted = referenced(set(aside))
        for digest, place in aside.items():
            with contextlib.suppress(FileNotFoundError):  # a sweep elsewhere has seen to it
                if digest in wanted:
                    place.rename(self.path(digest))
                else:
                    place.unlink()

    def sweep(self, referenced: Callable[[set[str]], set[str]]) -> None:
        """Remove what a killed process left behind: unfinished files, and complete ones that no row came to name."""
        for entry in self.incoming.iterdir():
            if _stale(entry):
                digest = entry.name.partition(".")[0]
                if entry.is_dir():
                    shutil.rmtree(entry, ignore_errors=True)
                elif digest != entry.name and referenced({digest}) and not self.has(digest):
                    entry.rename(self.path(digest))  # moved aside by a process that died before its second look
                else:
                    entry.unlink(missing_ok=True)
        for folder in self._blobs.iterdir():
            self.remove([entry.name for entry in folder.iterdir() if _stale(entry)], referenced)


def _sync(path: Path) -> None:
    """Have a file's bytes, or a folder's names, on disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _stale(entry: Path) -> bool:
    try:
        return time.time() - entry.stat().st_mtime > STALE_SECONDS
    except FileNotFoundError:
        return False
