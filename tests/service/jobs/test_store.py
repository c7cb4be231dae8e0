"""Rows: who comes second changes nothing."""

from __future__ import annotations

from typing import Any

import pytest
import sqlalchemy as sa

from service.jobs.port import StoreUnavailable
from service.jobs.store import CHUNKS_AHEAD, Chunk, NewJob, Store
from service.orders import Order


def nothing(*_: Any) -> None:
    """Enqueue nothing."""


def new(job: str, chunks: int = 1) -> NewJob:
    parts = [Chunk(k, k, 1, f"body {k}") for k in range(chunks)]
    return NewJob(job, Order("mat", "json"), "fingerprint", None, None, chunks > 1, parts)


def test_a_job_ends_once(store: Store) -> None:
    store.insert(new("a"), nothing)
    assert store.finish("a", "dismissed", "Dismissed.") is not None
    assert store.finish("a", "successful", "Finished.") is None  # by an executor that did not know
    assert store.begin("a", 0) is None
    store.progress("a", 50, "half")
    job = store.get("a")
    assert job is not None
    assert (job.state, job.progress, job.message) == ("dismissed", 0, "Dismissed.")


def test_a_chunk_keeps_its_first_result_and_brings_one_more(store: Store) -> None:
    enqueued: list[int] = []

    def enqueue(_: sa.Connection, job: str, number: int) -> None:
        enqueued.append(number)

    store.insert(new("a", CHUNKS_AHEAD + 2), enqueue)
    assert enqueued == list(range(CHUNKS_AHEAD))
    assert store.finish_chunk("a", 1, "first", 0, enqueue)
    assert not store.finish_chunk("a", 1, "second", 0, enqueue)
    assert not store.finish_chunk("gone", 1, "second", 0, enqueue)
    begun = store.begin("a", 1)
    assert begun is not None
    assert (begun[0].state, begun[1].result) == ("running", "first")
    assert enqueued[CHUNKS_AHEAD:] == [CHUNKS_AHEAD + 1]
    store.finish_chunk("a", CHUNKS_AHEAD + 1, "last", 1, enqueue)
    assert len(enqueued) == CHUNKS_AHEAD + 1
    assert store.tally("a") == (CHUNKS_AHEAD, 2, CHUNKS_AHEAD + 2, 1)


def test_a_job_that_could_not_be_enqueued_was_never_made(store: Store) -> None:
    def away(*_: Any) -> None:
        raise RuntimeError

    with pytest.raises(RuntimeError):
        store.insert(new("a"), away)
    assert store.get("a") is None
    assert store.referenced({"body 0"}) == set()


def test_progress_never_goes_back(store: Store) -> None:
    store.insert(new("a"), nothing)
    for percent, expected in ((10, 10), (60, 60), (30, 60)):
        store.progress("a", percent, "on the way")
        job = store.get("a")
        assert job is not None
        assert job.progress == expected


def test_jobs_of_one_moment_are_all_listed_once(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Store, "now", lambda _: sa.literal(1000.0))
    names = [f"{k:02d}" for k in range(10)]
    for name in names:
        store.insert(new(name), nothing)
    listed, after = [], None
    while True:
        page, after = store.page(3, after, None)
        listed += [job.id for job in page]
        if after is None:
            break
    assert listed == names[::-1]


def test_tables_of_another_version_are_refused_with_what_they_lack(store: Store) -> None:
    with store.engine.begin() as c:
        c.execute(sa.text("ALTER TABLE mat_jobs DROP COLUMN message"))
    with pytest.raises(StoreUnavailable, match="message"):
        store.create_tables()
