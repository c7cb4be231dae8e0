"""Who is alive: names, leases, and who takes over from whom."""

from __future__ import annotations

from pathlib import Path

import pytest
import sqlalchemy as sa
from sqlalchemy.exc import OperationalError

from service.jobs import leases
from service.jobs.leases import LEASE_SECONDS, RENEW_SECONDS, Reaper, Slot
from service.jobs.store import Store
from service.jobs.tables import LEASES


class Clock:
    def __init__(self) -> None:
        self.now = 1000.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(leases.time, "monotonic", made.monotonic)
    monkeypatch.setattr(Store, "now", lambda _: sa.literal(made.now))
    return made


def names(store: Store) -> set[str]:
    with store.engine.connect() as c:
        return set(c.execute(sa.select(LEASES.c.executor)).scalars())


def beats(reapers: list[Reaper], clock: Clock, seconds: float) -> None:
    for _ in range(round(seconds / RENEW_SECONDS)):
        clock.now += RENEW_SECONDS
        for reaper in reapers:
            reaper.beat()


def test_a_dead_executor_is_resumed_once_by_one_of_the_living(store: Store, clock: Clock) -> None:
    resumed: list[str] = []
    a, b, c = (Reaper(store, name, resumed.append) for name in "abc")
    beats([a, b, c], clock, 2 * LEASE_SECONDS)
    assert resumed == []
    beats([a, b], clock, 3 * LEASE_SECONDS)
    assert resumed == ["c"]
    assert names(store) == {"a", "b"}


def test_after_the_database_was_away_nobody_is_taken_for_dead(
    store: Store, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    resumed: list[str] = []
    a, b = (Reaper(store, name, resumed.append) for name in "ab")
    beats([a, b], clock, 2 * LEASE_SECONDS)

    def away(*_: object) -> None:
        raise OperationalError("", None, Exception("away"))

    with monkeypatch.context() as patch:
        patch.setattr(store, "renew", away)
        for reaper in (a, b):
            with pytest.raises(OperationalError):
                reaper.beat()
        clock.now += 10 * LEASE_SECONDS
    a.beat()  # sees the lease of b, which has not had its turn yet
    assert resumed == []
    beats([a, b], clock, 3 * LEASE_SECONDS)
    assert resumed == []


def test_a_reaper_that_dies_while_it_resumes_is_followed_by_another(store: Store, clock: Clock) -> None:
    def die(_: str) -> None:
        raise KeyboardInterrupt

    resumed: list[str] = []
    a, b, c = Reaper(store, "a", die), Reaper(store, "b", resumed.append), Reaper(store, "c", resumed.append)
    beats([a, b, c], clock, 2 * LEASE_SECONDS)
    clock.now += LEASE_SECONDS + 1
    store.renew("b", LEASE_SECONDS)
    with pytest.raises(KeyboardInterrupt):
        a.beat()
    beats([b], clock, 3 * LEASE_SECONDS)
    assert sorted(resumed) == ["a", "c"]


def test_names_are_free_again_when_their_process_has_gone(tmp_path: Path) -> None:
    first, second = Slot(tmp_path, "x"), Slot(tmp_path, "x")
    assert (first.name, second.name) == ("x", "x.1")
    first.release()
    third = Slot(tmp_path, "x")
    assert third.name == "x"
    for slot in (second, third):
        slot.release()
