"""A short form of the load: every promise, with so much time to spare that a busy machine breaks none."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.load.__main__ import PARTS, run
from tests.load.report import Report, quantile
from tests.load.scale import short


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
