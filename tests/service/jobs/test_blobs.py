"""Files by content: kept once, removed with their last row, whatever happens at the same moment."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.jobs.blobs import STALE_SECONDS, Blobs


@pytest.fixture
def blobs(tmp_path: Path) -> Blobs:
    made = Blobs(tmp_path)
    made.open()
    return made


def files(blobs: Blobs) -> list[str]:
    return sorted(path.name for path in blobs.path("").parent.rglob("*") if path.is_file())


def nobody(_: set[str]) -> set[str]:
    return set()


def test_a_file_is_named_by_its_content_and_kept_once(blobs: Blobs, tmp_path: Path) -> None:
    digest = blobs.put(b"content")
    assert digest == hashlib.sha256(b"content").hexdigest() == blobs.put(b"content")
    written = blobs.incoming / "other"
    written.write_bytes(b"content")
    assert blobs.adopt(written) == digest
    written.unlink()
    assert files(blobs) == [digest]
    assert blobs.read(digest) == b"content"


def test_nothing_is_left_of_a_file_that_could_not_be_written(blobs: Blobs, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "link", full)
    with pytest.raises(OSError, match="No space"):
        blobs.put(b"content")
    assert files(blobs) == []
    assert not list(blobs.incoming.iterdir())


def test_only_what_no_row_names_is_removed(blobs: Blobs) -> None:
    kept, gone = blobs.put(b"kept"), blobs.put(b"gone")
    blobs.remove([kept, gone, "0" * 64], lambda asked: asked & {kept})
    assert files(blobs) == [kept]
    assert not list(blobs.incoming.iterdir())


def test_a_row_that_comes_while_its_file_is_removed_keeps_it(blobs: Blobs) -> None:
    """Another job with the same content is stored between the two looks at the rows."""
    digest = blobs.put(b"content")
    answers: Iterator[set[str]] = iter([set(), {digest}])
    blobs.remove([digest], lambda _: next(answers))
    assert blobs.read(digest) == b"content"
    assert not list(blobs.incoming.iterdir())


def test_a_sweep_removes_old_strays_only(blobs: Blobs) -> None:
    named, stray, fresh, aside = (blobs.put(content) for content in (b"named", b"stray", b"fresh", b"aside"))
    blobs.path(aside).rename(blobs.incoming / f"{aside}.0")  # its remover died before the second look
    with blobs.folder() as upload:
        (upload / "000000").write_bytes(b"lines")
        old = time.time() - STALE_SECONDS - 1
        for path in (blobs.path(named), blobs.path(stray), blobs.incoming / f"{aside}.0", upload):
            os.utime(path, (old, old))
        blobs.sweep(lambda asked: asked & {named, aside})
        assert not upload.exists()
    assert files(blobs) == sorted([named, fresh, aside])
    assert not list(blobs.incoming.iterdir())
