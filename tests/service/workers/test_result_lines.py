"""The file of result lines, as a worker writes it."""

from __future__ import annotations

import errno
import hashlib
import os
from pathlib import Path

import pytest

from service.errors import PROBLEM_LINE
from service.workers import result_lines
from service.workers.result_lines import Results, Unwritten, Written, whole


def test_what_is_told_of_the_file_is_what_is_in_it(tmp_path: Path) -> None:
    results = Results(tmp_path / "results", Written())
    for line in (b"one", PROBLEM_LINE + b"x", b"", b"\xff" * 100_000):
        results.add(line)
    results.close()
    content = (tmp_path / "results").read_bytes()
    assert content == b"one\n" + PROBLEM_LINE + b"x\n\n" + b"\xff" * 100_000 + b"\n"
    assert results.written == Written(len(content), 4, 1) == whole(tmp_path / "results")
    assert results.digest == hashlib.sha256(content).hexdigest()


def test_what_comes_after_the_whole_lines_is_cut_off(tmp_path: Path) -> None:
    file = tmp_path / "results"
    file.write_bytes(PROBLEM_LINE + b"\ntwo\nthr")
    kept = whole(file)
    assert kept == Written(len(PROBLEM_LINE) + 5, 2, 1)
    results = Results(file, kept)
    results.add(b"three")
    results.close()
    assert file.read_bytes() == PROBLEM_LINE + b"\ntwo\nthree\n"
    assert results.written == whole(file)
    assert results.digest == hashlib.sha256(file.read_bytes()).hexdigest()


def test_nothing_is_whole_where_nothing_is(tmp_path: Path) -> None:
    assert whole(tmp_path / "results") == Written()


def test_a_line_that_the_disk_takes_half_of_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "results"
    results = Results(file, Written())
    results.add(b"one")
    write = os.write

    def write_nothing(descriptor: int, content: bytes) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(result_lines.os, "writev", lambda descriptor, parts: write(descriptor, parts[0][:5]))
        patched.setattr(result_lines.os, "write", write_nothing)
        with pytest.raises(Unwritten, match="No space left"):
            results.add(b"two or three")
    assert file.read_bytes() == b"one\n"
    results.add(b"two")
    results.close()
    assert file.read_bytes() == b"one\ntwo\n"
    assert results.digest == hashlib.sha256(b"one\ntwo\n").hexdigest()


def test_a_line_that_is_taken_in_parts_is_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = os.write
    monkeypatch.setattr(result_lines.os, "writev", lambda descriptor, parts: write(descriptor, parts[0][:2]))
    monkeypatch.setattr(result_lines.os, "write", lambda descriptor, content: write(descriptor, content[:3]))
    results = Results(tmp_path / "results", Written())
    results.add(b"one and two and three")
    results.close()
    assert (tmp_path / "results").read_bytes() == b"one and two and three\n"
    assert results.written == whole(tmp_path / "results")


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(Unwritten, match="No such file"):
        Results(tmp_path / "nowhere" / "results", Written())
