"""Chunks of a batch: one result line a line, whatever becomes of the workers."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import signal
from pathlib import Path
from typing import Any

from service.settings import MIB
from service.workers.pool import Pool
from tests.service.handlers import scheduling
from tests.service.processes import alive, status
from tests.service.workers.scenarios import eventually_in_loop, order, pid_of, with_pool


async def results(pool: Pool, *lines: bytes, **options: Any) -> list[dict[str, Any]]:
    async with contextlib.aclosing(pool.lines({}, b"\n".join(lines), **options)) as found:
        return [json.loads(line) async for line in found]


def echoes(count: int) -> list[bytes]:
    return [order("echo", index=index) for index in range(count)]


def codes(found: list[dict[str, Any]]) -> list[str]:
    return [result.get("code", "done") for result in found]


def test_each_line_has_its_result_in_order_from_one_worker() -> None:
    async def scenario(pool: Pool) -> None:
        found = await results(pool, *echoes(1000), first=7)
        assert [result["answers"]["index"] for result in found] == list(range(1000))
        assert [result["line"] for result in found] == list(range(8, 1008))
        assert len({result["pid"] for result in found}) == 1

    with_pool(scenario)


def test_blank_lines_have_no_result_but_a_number() -> None:
    async def scenario(pool: Pool) -> None:
        found = await results(pool, b"", *echoes(1), b" \t\r", b"", *echoes(2), b"", b"\r")
        assert [result["line"] for result in found] == [2, 5, 6]
        assert await results(pool, b"") == await results(pool, b"", b" ") == []

    with_pool(scenario)


def test_a_line_that_ends_its_workers_costs_itself_only() -> None:
    async def scenario(pool: Pool) -> None:
        before, after = echoes(20), echoes(20)
        found = await results(pool, *before, order("crash"), b"", *after, order("fail"), first=100)
        assert codes(found) == ["done"] * 20 + ["worker-crashed"] + ["done"] * 20 + ["worker-crashed"]
        assert [result["line"] for result in found] == [*range(101, 122), *range(123, 144)]
        assert found[20]["status"] == 503
        assert found[20]["detail"]
        assert pool.stats().kills["crash"] == 4

    with_pool(scenario)


def test_a_worker_killed_from_outside_costs_no_line(tmp_path: Path) -> None:
    async def scenario(pool: Pool) -> None:
        lines = [*echoes(5), order("crash_once", mark=str(tmp_path / "mark")), *echoes(5)]
        assert codes(await results(pool, *lines)) == ["done"] * 11

    with_pool(scenario)


def test_nothing_is_done_twice_that_was_done_when_a_worker_ended() -> None:
    async def scenario(pool: Pool) -> None:
        found = await results(pool, *echoes(200), order("crash"), *echoes(1))
        assert len({result["pid"] for result in found[:200]}) == 1

    with_pool(scenario)


def test_a_line_that_takes_too_long_costs_itself_only() -> None:
    async def scenario(pool: Pool) -> None:
        found = await results(pool, *echoes(2), order("spin", seconds=60), *echoes(2), deadline_seconds=1.5)
        assert codes(found) == ["done", "done", "deadline-exceeded", "done", "done"]
        assert pool.stats().kills["deadline"] == 1

    with_pool(scenario)


def test_the_deadline_is_a_line_s_not_the_chunk_s() -> None:
    async def scenario(pool: Pool) -> None:
        found = await results(pool, *[order("spin", seconds=0.2)] * 12, deadline_seconds=2.0)
        assert codes(found) == ["done"] * 12

    with_pool(scenario)


def test_memory_that_ran_out_is_tried_again_in_an_unused_worker() -> None:
    async def scenario(pool: Pool) -> None:
        found = await results(pool, *echoes(3), order("again"), *echoes(3))
        assert codes(found) == ["done"] * 7
        assert len({result["pid"] for result in found}) == 2
        assert found[2]["pid"] != found[3]["pid"] == found[4]["pid"]
        assert pool.stats().kills["memory"] == 1

    with_pool(scenario)


def test_a_reader_that_is_slow_is_waited_for() -> None:
    async def scenario(pool: Pool) -> None:
        lines = [order("echo", index=index, size=100_000) for index in range(100)]
        found = []
        async with contextlib.aclosing(pool.lines({}, b"\n".join(lines), deadline_seconds=2.0)) as results:
            async for line in results:
                found.append(json.loads(line)["answers"]["index"])
                if len(found) in (10, 50):
                    await asyncio.sleep(2.5)
        assert found == list(range(100))

    with_pool(scenario)


def test_who_stops_reading_stops_the_worker() -> None:
    async def scenario(pool: Pool) -> None:
        async with contextlib.aclosing(pool.lines({}, b"\n".join([*echoes(1), order("spin", seconds=60)]))) as found:
            worker = json.loads(await anext(found))["pid"]
        await eventually_in_loop(lambda: not alive(worker))
        assert pool.stats().kills["dismissed"] == 1
        assert pool.stats().running["job"] == 0

    with_pool(scenario)


def test_cancelling_who_reads_stops_the_worker() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        task = asyncio.create_task(results(pool, order("spin", seconds=60)))
        await eventually_in_loop(lambda: pool.stats().running["job"] == 1)
        await asyncio.sleep(0.1)
        task.cancel()
        await asyncio.wait([task])
        await eventually_in_loop(lambda: pool.stats().kills["dismissed"] == 1)
        assert pool.stats().running["job"] == 0

    with_pool(scenario)


def test_chunks_use_every_worker_and_leave_one_to_small_requests() -> None:
    async def scenario(pool: Pool) -> None:
        await pid_of(pool)
        chunk = [order("spin", seconds=0.1)] * 6
        tasks = [asyncio.create_task(results(pool, *chunk)) for _ in range(3)]
        await eventually_in_loop(lambda: pool.stats().running["job"] == 2)
        reply = await pool.solve({}, order("echo"))
        assert not all(task.done() for task in tasks)
        assert reply.header["scheduling"] == scheduling()
        assert [codes(found) for found in await asyncio.gather(*tasks)] == [["done"] * 6] * 3

    with_pool(scenario)


def test_a_nursery_that_is_killed_costs_no_line() -> None:
    async def scenario(pool: Pool) -> None:
        task = asyncio.create_task(results(pool, *[order("spin", seconds=0.05)] * 20))
        _, nursery = status(await pid_of(pool))
        await asyncio.sleep(0.3)
        os.kill(nursery, signal.SIGKILL)
        assert codes(await task) == ["done"] * 20

    with_pool(scenario)


def test_a_worker_that_has_grown_in_a_chunk_is_replaced_after_it() -> None:
    async def scenario(pool: Pool) -> None:
        first = await results(pool, order("grow", bytes=128 * MIB), *echoes(1))
        second = await results(pool, *echoes(1))
        assert first[0]["pid"] == first[1]["pid"] != second[0]["pid"]
        assert pool.stats().kills["memory"] == 1

    with_pool(scenario, workers=1, worker_recycle_bytes=96 * MIB)
