"""Who runs and who waits, without any process."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Awaitable, Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.workers.failures import QueueFull
from service.workers.lanes import LARGE_BODY_BYTES, Lane, Lanes


async def settle() -> None:
    for _ in range(5):
        await asyncio.sleep(0)


class Runner:
    """A request that runs until it is told to end."""

    def __init__(self, lanes: Lanes, lane: Lane) -> None:
        self.ending = asyncio.Event()
        self.running = False
        self._lanes, self._lane = lanes, lane
        self.task = asyncio.create_task(self._run())

    async def _run(self) -> None:
        async with self._lanes.turn(self._lane) as turn:
            self.running = True
            self.turn = turn
            await self.ending.wait()
        self.running = False


def scenario(run: Callable[[Lanes], Awaitable[None]], workers: int = 2, limit: int = 3) -> None:
    async def whole() -> None:
        lanes = Lanes(workers, limit)
        await run(lanes)
        tasks = asyncio.all_tasks() - {asyncio.current_task()}
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        assert not any(lanes.running.values())
        assert not any(lanes.waiting.values())

    asyncio.run(whole())


async def started(lanes: Lanes, lane: Lane, count: int) -> list[Runner]:
    runners = [Runner(lanes, lane) for _ in range(count)]
    await settle()
    return runners


def running(runners: list[Runner]) -> int:
    return sum(runner.running for runner in runners)


def test_the_lane_goes_by_size_unless_it_is_a_job() -> None:
    assert Lane.of(LARGE_BODY_BYTES, job=False) is Lane.SMALL
    assert Lane.of(LARGE_BODY_BYTES + 1, job=False) is Lane.LONG
    assert Lane.of(0, job=True) is Lane.of(LARGE_BODY_BYTES + 1, job=True) is Lane.JOB


@pytest.mark.parametrize("workers", [1, 2, 3])
@pytest.mark.parametrize("lane", Lane)
def test_each_lane_alone_has_every_worker(workers: int, lane: Lane) -> None:
    async def run(lanes: Lanes) -> None:
        assert running(await started(lanes, lane, workers + 2)) == workers

    scenario(run, workers)


def test_jobs_and_long_ones_leave_one_worker_to_the_lanes_before_them_and_all_to_small_ones() -> None:
    async def run(lanes: Lanes) -> None:
        jobs = await started(lanes, Lane.JOB, 5)
        long = await started(lanes, Lane.LONG, 3)
        middle = await started(lanes, Lane.MIDDLE, 3)
        small = await started(lanes, Lane.SMALL, 3)
        assert [running(lane) for lane in (jobs, long, middle, small)] == [2, 1, 1, 2]
        assert lanes.waiting == {Lane.JOB: 3, Lane.LONG: 2, Lane.MIDDLE: 2, Lane.SMALL: 1}

    scenario(run)


def test_no_lane_starves_behind_small_ones() -> None:
    async def run(lanes: Lanes) -> None:
        small = await started(lanes, Lane.SMALL, 5)
        long = await started(lanes, Lane.LONG, 1)
        jobs = await started(lanes, Lane.JOB, 1)
        assert (running(small), running(long), running(jobs)) == (2, 1, 1)
        small[0].ending.set()
        await settle()
        assert running(small) == 2

    scenario(run)


def test_those_who_wait_are_let_in_in_order() -> None:
    async def run(lanes: Lanes) -> None:
        runners = await started(lanes, Lane.SMALL, 4)
        for index in range(4):
            assert [runner.running for runner in runners[:4]] == [index <= i < index + 1 for i in range(4)]
            runners[index].ending.set()
            await settle()

    scenario(run, workers=1)


def test_each_lane_has_its_own_limit_and_jobs_have_none() -> None:
    async def run(lanes: Lanes) -> None:
        for lane in (Lane.LONG, Lane.SMALL):
            assert not lanes.full(lane)
            await started(lanes, lane, 4)
            assert lanes.full(lane)
            with pytest.raises(QueueFull):
                async with lanes.turn(lane):
                    raise AssertionError
        jobs = await started(lanes, Lane.JOB, 50)
        assert running(jobs) == 1
        assert not lanes.full(Lane.JOB)

    scenario(run, workers=1)


@pytest.mark.parametrize(("lane", "after"), [(Lane.SMALL, Lane.MIDDLE), (Lane.MIDDLE, Lane.LONG)])
def test_one_goes_on_in_the_next_lane_where_there_is_room_and_makes_room_in_its_own(lane: Lane, after: Lane) -> None:
    async def run(lanes: Lanes) -> None:
        runners = await started(lanes, lane, 6)
        assert runners[0].turn.go_on()
        assert runners[1].turn.go_on()
        await settle()
        left = 2 if lane is Lane.SMALL else 1  # beside those that went on
        assert running(runners) == 2 + left
        assert not runners[2].turn.go_on()
        assert runners[2].turn.wanted
        assert lanes.running == dict.fromkeys(Lane, 0) | {lane: left, after: 2}

    scenario(run, limit=4)


def test_a_lane_gives_more_time_than_the_one_before_it_and_the_last_ones_give_all() -> None:
    assert Lane.SMALL.seconds is not None
    assert Lane.MIDDLE.seconds is not None
    assert Lane.SMALL.seconds < Lane.MIDDLE.seconds
    assert Lane.LONG.seconds is Lane.JOB.seconds is None


def test_one_that_begins_again_is_never_refused_and_is_the_first() -> None:
    async def run(lanes: Lanes) -> None:
        first = await started(lanes, Lane.LONG, 4)
        order: list[str] = []

        async def again() -> None:
            async with lanes.turn(Lane.LONG, again=True):
                order.append("again")

        task = asyncio.create_task(again())
        await settle()
        first[0].ending.set()
        await task
        assert not first[2].running or order == ["again"]
        await settle()
        assert first[1].running

    scenario(run, workers=1)


steps = st.lists(st.tuples(st.sampled_from(["start", "end", "cancel", "go on"]), st.sampled_from(Lane), st.integers(0, 100)))


@given(steps=steps, workers=st.integers(1, 4))
def test_whatever_happens_places_are_neither_lost_nor_given_twice(
    steps: list[tuple[str, Lane, int]], workers: int
) -> None:
    async def run(lanes: Lanes) -> None:
        runners: list[Runner] = []
        for what, lane, index in steps:
            if what == "start":
                runners.append(Runner(lanes, lane))
            elif runners:
                chosen = runners[index % len(runners)]
                if what == "end":
                    chosen.ending.set()
                elif what == "cancel":
                    chosen.task.cancel()
                elif chosen.running and not chosen.task.done() and chosen.turn.lane.seconds is not None:
                    chosen.turn.go_on()
            if index % 3 == 0:  # otherwise several things happen in one turn of the loop
                await settle()
        await settle()
        counts = dict.fromkeys(Lane, 0)
        for runner in runners:
            if runner.running and not runner.task.done():
                counts[runner.turn.lane] += 1
        assert lanes.running == counts
        assert counts[Lane.JOB] <= workers
        assert counts[Lane.MIDDLE] <= workers
        assert counts[Lane.LONG] <= workers
        for lane in Lane:
            assert not (lanes.waiting[lane] and lanes.room(lane))
        for runner in runners:
            runner.task.cancel()
        await settle()
        with contextlib.suppress(asyncio.CancelledError, QueueFull):
            await asyncio.gather(*(runner.task for runner in runners), return_exceptions=True)

    scenario(run, workers)
