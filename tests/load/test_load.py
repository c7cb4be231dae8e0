"""A short form of the load: every promise, with so much time to spare that a busy machine breaks none."""

from __future__ import annotations

import asyncio
import io
from pathlib import Path

import pytest

from tests.load.__main__ import PARTS, run
from tests.load.batch import READ_BYTES, right_lines
from tests.load.report import Report, quantile
from tests.load.scale import short
from tests.load.traffic import Piece


@pytest.mark.slow
@pytest.mark.parametrize("part", PARTS)
def test_promises_are_kept(part: str, tmp_path: Path) -> None:
    report = asyncio.run(run([part], short(tmp_path)))
    assert report.promises or any(name == "left out" for _, name, _ in report.figures)
    assert not report.broken, report.table()


def test_a_broken_promise_is_told() -> None:
    report = Report()
    report.promise("part", "this", True)
    assert not report.broken
    report.promise("part", "that", False)
    assert report.broken == ["part: that"]
    assert "BROKEN that" in report.table()


def test_quantiles() -> None:
    values = [float(value) for value in range(1, 101)]
    assert [quantile(values, q) for q in (0.0, 0.5, 0.99, 1.0)] == [1.0, 50.0, 99.0, 100.0]
    assert quantile([3.0], 0.99) == 3.0


class _Slow(io.BytesIO):
    """Gives no more than so many bytes at a time."""

    most = READ_BYTES

    def readinto(self, room: memoryview) -> int:  # type: ignore[override]
        return super().readinto(room[: self.most])


@pytest.mark.parametrize("most", [1_000, READ_BYTES - 1, 10 * READ_BYTES])
def test_right_lines_are_counted_up_to_the_first_wrong_one(most: int) -> None:
    answers = [b"one", b"", b"three" * READ_BYTES, b"four"]
    asked = [Piece(answer.decode()[:5], "part", b"", answer) for answer in answers] * 2
    content = b"".join(piece.answer + b"\n" for piece in asked)

    def count(content: bytes) -> int:
        source = _Slow(content)
        source.most = most
        return right_lines(asked, source)

    assert count(content) == 8
    assert count(b"") == 0
    assert count(content[:-1]) == count(content + b" ") == count(content + content) == 7
    assert count(content.replace(b"four", b"fore")) == 3
    assert count(content.replace(b"four", b"fourth")) == 3
    assert count(b"\n" + content) == 0
