"""The pool under every way a worker can fail, with real processes."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import time

import pytest

from service.settings import MIB
from service.workers.lanes import LARGE_BODY_BYTES
from service.workers.pool import DeadlineExceeded, Pool, QueueFull, Reply, WorkerCrashed
from service.workers.process import LOW_PRIORITY, give_way
from tests.service.handlers import scheduling
from tests.service.processes import alive, descendants, status
from tests.service.workers.scenarios import eventually_in_loop, order, pid_of, with_pool


def test_an_answer_comes_back_with_its_body_and_times() -> None:
    async def scenario(pool: Pool) -> None:
        body = order("echo", padding=3 * MIB)
        reply = await pool.solve({}, body)
        assert reply.body == body
        assert "resident_bytes" not in reply.header
        assert reply.queue_seconds >= 0
        assert reply.work_seconds > 0
        assert pool.about == {"service": "test", "algorithm": "test"}
        assert pool.progress == ("nothing to compile", 1, 1)

    with_pool(scenario)


def test_two_workers_work_at_the_same_time_in_processes_of_their_own() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        tasks = [asyncio.create_task(pool.solve({}, order("spin", seconds=0.6))) for _ in range(2)]
        await eventually_in_loop(lambda: pool.stats().busy == 2)
        replies = await asyncio.gather(*tasks)
        assert len({reply.header["pid"] for reply in replies} | {os.getpid()}) == 3

    with_pool(scenario)


def test_a_deadline_kills_the_deaf_worker_and_the_next_answer_is_soon_there() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        begun = time.monotonic()
        with pytest.raises(DeadlineExceeded):
            await pool.solve({}, order("spin", seconds=60), deadline_seconds=0.3)
        assert time.monotonic() - begun < 5.0
        begun = time.monotonic()
        await pid_of(pool)
        assert time.monotonic() - begun < 5.0

    with_pool(scenario, workers=1)


def test_time_in_the_queue_counts() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        first = asyncio.create_task(pool.solve({}, order("spin", seconds=0.8)))
        await eventually_in_loop(lambda: pool.stats().running["small"] == 1)
        with pytest.raises(DeadlineExceeded):
            await pool.solve({}, order("spin", seconds=0.8), deadline_seconds=0.7)
        assert isinstance(await first, Reply)

    with_pool(scenario, workers=1)


def test_cancelling_kills_the_worker() -> None:
    async def scenario(pool: Pool) -> None:
        before = await pid_of(pool)
        task = asyncio.create_task(pool.solve({}, order("spin", seconds=60)))
        await asyncio.sleep(0.1)
        task.cancel()
        await asyncio.wait([task])
        await eventually_in_loop(lambda: not alive(before))
        assert await pid_of(pool) != before

    with_pool(scenario, workers=1)


@pytest.mark.parametrize("action", ["crash", "fail"])
def test_a_worker_that_dies_is_reported_and_replaced(action: str) -> None:
    async def scenario(pool: Pool) -> None:
        for _ in range(3):
            with pytest.raises(WorkerCrashed):
                await pool.solve({}, order(action))
        assert (await pool.solve({}, order("echo"))).body

    with_pool(scenario)


def test_an_idle_worker_that_is_killed_from_outside_is_replaced_unnoticed() -> None:
    async def scenario(pool: Pool) -> None:
        pids = {await pid_of(pool) for _ in range(4)}
        for pid in pids:
            os.kill(pid, signal.SIGKILL)
        await eventually_in_loop(lambda: not any(alive(pid) for pid in pids))
        await asyncio.sleep(0.1)
        assert await pid_of(pool) not in pids

    with_pool(scenario)


def test_a_nursery_that_is_killed_is_started_again_and_its_workers_do_not_linger() -> None:
    async def scenario(pool: Pool) -> None:
        worker = await pid_of(pool)
        _, parent = status(worker)
        workers = descendants(parent) | {worker}  # one that is still dying may take the next request with it
        os.kill(parent, signal.SIGKILL)
        await eventually_in_loop(lambda: not any(alive(pid) for pid in workers))
        assert await pid_of(pool) != worker

    with_pool(scenario)


def test_one_more_than_may_wait_is_refused_at_once() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        tasks = [asyncio.create_task(pool.solve({}, order("sleep", seconds=0.5))) for _ in range(3)]
        await asyncio.sleep(0.1)
        assert pool.full
        begun = time.monotonic()
        with pytest.raises(QueueFull):
            await pool.solve({}, order("echo"))
        assert time.monotonic() - begun < 1.0
        assert all(isinstance(reply, Reply) for reply in await asyncio.gather(*tasks))
        assert not pool.full

    with_pool(scenario, workers=1, queue_limit=2)


def test_large_bodies_leave_a_worker_free_for_small_ones() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        large = order("spin", seconds=1.0, padding=LARGE_BODY_BYTES)
        tasks = [asyncio.create_task(pool.solve({}, large)) for _ in range(5)]
        await eventually_in_loop(lambda: pool.stats().running["long"] == 2)
        await pid_of(pool)
        assert not all(task.done() for task in tasks)
        await asyncio.gather(*tasks)

    with_pool(scenario)


def test_memory_beyond_the_limit_is_an_error_inside_the_worker_only() -> None:
    async def scenario(pool: Pool) -> None:
        assert (await pool.solve({}, order("grow", bytes=64 * MIB))).header["refused"] is False
        assert (await pool.solve({}, order("grow", bytes=8192 * MIB))).header["refused"] is True

    with_pool(scenario, worker_memory_bytes=256 * MIB)


def test_a_worker_that_has_grown_is_replaced_after_its_answer() -> None:
    async def scenario(pool: Pool) -> None:
        before = await pid_of(pool)
        grown = await pool.solve({}, order("grow", bytes=128 * MIB))
        assert grown.header["pid"] == before
        assert await pid_of(pool) != before

    with_pool(scenario, workers=1, worker_recycle_bytes=96 * MIB)


def test_an_answer_that_is_cut_off_is_no_answer() -> None:
    async def scenario(pool: Pool) -> None:
        with pytest.raises(WorkerCrashed):
            await pool.solve({}, order("half"))
        assert (await pool.solve({}, order("echo"))).body

    with_pool(scenario)


def test_a_worker_is_replaced_after_its_number_of_requests() -> None:
    async def scenario(pool: Pool) -> None:
        pids = [await pid_of(pool) for _ in range(9)]
        assert pids == [pids[0]] * 3 + [pids[3]] * 3 + [pids[6]] * 3
        assert len(set(pids)) == 3
        assert pool.stats().kills["recycled"] == 3

    with_pool(scenario, worker_recycle_requests=3)


def test_memory_that_ran_out_in_a_used_worker_is_tried_again_in_another() -> None:
    async def scenario(pool: Pool) -> None:
        before = await pid_of(pool)
        assert (await pool.solve({}, order("again"))).header["pid"] != before
        await eventually_in_loop(lambda: not alive(before))
        assert pool.stats().kills["memory"] == 1

    with_pool(scenario, workers=1)


def test_progress_is_told_to_who_asks() -> None:
    async def scenario(pool: Pool) -> None:
        told: list[tuple[str, float]] = []
        reply = await pool.solve({}, order("echo"), progress=lambda *what: told.append(what))
        assert told == [("working", 0.25), ("finishing", 0.75)]
        assert reply.body == order("echo")

    with_pool(scenario)


def test_a_small_request_that_takes_long_leaves_the_small_lane_and_the_next_one_too() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        # so long that a busy machine has both at it at the same time; they are dismissed when that was seen
        long = [asyncio.create_task(pool.solve({}, order("work", seconds=60.0))) for _ in range(2)]
        await eventually_in_loop(lambda: pool.stats().running["middle"] == 2, 60.0)
        await pid_of(pool)
        await eventually_in_loop(lambda: pool.stats().running["long"] == 2, 60.0)
        await pid_of(pool)
        assert not any(task.done() for task in long)
        assert pool.stats().kills["preempted"] == 0
        for task in long:
            task.cancel()
        await asyncio.gather(*long, return_exceptions=True)

    with_pool(scenario, deadline_seconds=200.0)


def test_who_does_not_work_does_not_leave_its_lane() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        waiting = asyncio.create_task(pool.solve({}, order("sleep", seconds=1.0)))
        await asyncio.sleep(0.5)
        assert pool.stats().running == {"small": 1, "middle": 0, "long": 0, "job": 0}
        await waiting

    with_pool(scenario)


def test_one_too_many_of_them_begins_again_when_its_turn_comes() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        long = [asyncio.create_task(pool.solve({}, order("work", seconds=0.9)))]
        await eventually_in_loop(lambda: pool.stats().running["middle"] == 1)
        long.append(asyncio.create_task(pool.solve({}, order("work", seconds=0.9))))
        await asyncio.sleep(0.3)
        assert pool.stats().kills["preempted"] == 0  # as long as nobody wants its place
        await pid_of(pool)
        assert pool.stats().kills["preempted"] == 1
        assert not all(task.done() for task in long)
        replies = await asyncio.gather(*long)
        assert all(reply.body == order("work", seconds=0.9) for reply in replies)

    with_pool(scenario, workers=1, deadline_seconds=200.0)


@pytest.mark.parametrize("priority", ["idle", "low", "normal"])
def test_jobs_take_every_worker_but_one_for_small_requests_and_give_way_to_them(priority: str) -> None:
    policy, nice = usual = scheduling()
    giving_way = {"idle": [os.SCHED_IDLE, nice], "low": [policy, max(nice, LOW_PRIORITY)], "normal": usual}[priority]

    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        jobs = [asyncio.create_task(pool.solve({}, order("spin", seconds=0.8), job=True)) for _ in range(5)]
        await eventually_in_loop(lambda: pool.stats().running["job"] == 2)
        small = await pool.solve({}, order("echo"))
        assert not all(job.done() for job in jobs)
        assert small.header["scheduling"] == usual
        assert [job.header["scheduling"] for job in await asyncio.gather(*jobs)] == [giving_way] * 5
        assert (await pool.solve({}, order("echo"))).header["scheduling"] == usual

    with_pool(scenario, long_priority=priority)


def test_each_worker_rehearses_once() -> None:
    async def scenario(pool: Pool) -> None:
        for do in ("echo", "echo", "crash", "echo"):
            with contextlib.suppress(WorkerCrashed):
                header = (await pool.solve({}, order(do))).header
                assert header["rehearsed"] == [header["pid"]]

    with_pool(scenario, workers=1)


def test_workers_are_in_this_session_where_priorities_count_and_out_of_the_terminal_s_reach() -> None:
    async def scenario(pool: Pool) -> None:
        worker = await pid_of(pool)
        assert os.getsid(worker) == os.getsid(0)
        assert os.getpgid(worker) != os.getpgid(0)

    with_pool(scenario, workers=1)


@pytest.mark.parametrize("how", ["idle", "low", "normal"])
def test_who_gives_way_where_the_sandbox_forbids_to_be_idle(monkeypatch: pytest.MonkeyPatch, how: str) -> None:
    def forbidden(*_: object) -> None:
        raise PermissionError

    lowered: list[int] = []
    monkeypatch.setattr(os, "sched_setscheduler", forbidden)
    monkeypatch.setattr(os, "setpriority", lambda _which, process, _priority: lowered.append(process))
    give_way(42, how)
    assert lowered == ([] if how == "normal" else [42])


def test_a_job_s_deadline_begins_when_a_worker_takes_it() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        sleep = order("sleep", seconds=0.4)
        jobs = [asyncio.create_task(pool.solve({}, sleep, job=True, deadline_seconds=3.0)) for _ in range(10)]
        assert all(isinstance(reply, Reply) for reply in await asyncio.gather(*jobs))
        with pytest.raises(DeadlineExceeded):
            await pool.solve({}, order("spin", seconds=60), job=True, deadline_seconds=0.3)
        assert pool.stats().kills["deadline"] == 1

    with_pool(scenario, workers=1)


def test_the_kills_are_counted_by_reason() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        for job in (False, True):
            task = asyncio.create_task(pool.solve({}, order("spin", seconds=60), job=job))
            await asyncio.sleep(0.2)
            task.cancel()
            await asyncio.wait([task])
        with pytest.raises(WorkerCrashed):
            await pool.solve({}, order("crash"))
        stats = pool.stats()
        assert {reason: count for reason, count in stats.kills.items() if count} == {"disconnect": 1, "dismissed": 1, "crash": 1}
        assert stats.busy == 0
        assert stats.waiting == stats.running == {"small": 0, "middle": 0, "long": 0, "job": 0}
        await eventually_in_loop(lambda: pool.stats().idle == 3)

    with_pool(scenario)


def test_a_full_long_lane_refuses_no_small_request() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        large = order("spin", seconds=0.5, padding=LARGE_BODY_BYTES)
        tasks = [asyncio.create_task(pool.solve({}, large)) for _ in range(2)]
        await eventually_in_loop(lambda: pool.refuses(LARGE_BODY_BYTES + 1))
        assert not pool.full
        with pytest.raises(QueueFull):
            await pool.solve({}, large)
        await pid_of(pool)
        await asyncio.gather(*tasks)

    with_pool(scenario, workers=1, queue_limit=1)


def test_requests_wait_while_a_nursery_that_cannot_load_is_tried_again() -> None:
    async def scenario(pool: Pool) -> None:
        assert not pool.ready
        with pytest.raises(DeadlineExceeded):
            await pool.solve({}, order("echo"))

    with_pool(scenario, handler="tests.service.no_such_module", deadline_seconds=1.5)
