"""Chunks of a batch: one result line a line, whatever becomes of the workers."""

from __future__ import annotations

import asyncio
import hashlib
import json
import os
import signal
import tempfile
from pathlib import Path
from typing import Any

import pytest

from service.settings import MIB
from service.workers.channel import Channel, ChannelClosed
from service.workers.chunks import Lines
from service.workers.pool import Pool
from service.workers.result_lines import Unwritten, Written, whole
from tests.service.handlers import scheduling
from tests.service.processes import status
from tests.service.workers.scenarios import eventually_in_loop, order, pid_of, with_pool


async def results(pool: Pool, *lines: bytes, first: int = 0, **options: Any) -> list[dict[str, Any]]:
    """What becomes of lines; what is told of the file of results is true of it."""
    with tempfile.TemporaryDirectory() as folder:
        chunk = Lines({}, b"\n".join(lines), Path(folder) / "results", first)
        await pool.solve_lines(chunk, **options)
        return read(chunk, Path(folder) / "results")


def read(chunk: Lines, file: Path) -> list[dict[str, Any]]:
    content = file.read_bytes()
    found = [json.loads(line) for line in content.splitlines()]
    assert chunk.digest == hashlib.sha256(content).hexdigest()
    assert chunk.written == whole(file) == Written(len(content), len(found), sum("code" in result for result in found))
    return found


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


def test_cancelling_stops_the_worker() -> None:
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


def test_a_line_that_was_half_written_is_written_anew(tmp_path: Path) -> None:
    async def scenario(pool: Pool) -> None:
        file = tmp_path / "results"
        lines = [*echoes(5), order("crash_in_line", mark=str(tmp_path / "mark"), file=str(file)), *echoes(5)]
        chunk = Lines({}, b"\n".join(lines), file)
        await pool.solve_lines(chunk)
        found = read(chunk, file)
        assert codes(found) == ["done"] * 11
        assert found[0]["pid"] == found[4]["pid"] != found[5]["pid"]

    with_pool(scenario)


def test_what_cannot_be_written_is_gone_on_with_once_it_can(tmp_path: Path) -> None:
    async def scenario(pool: Pool) -> None:
        chunk = Lines({}, b"\n".join(echoes(3)), tmp_path / "later" / "results")
        for _ in range(2):
            with pytest.raises(Unwritten, match="No such file"):
                await pool.solve_lines(chunk)
        assert not any(pool.stats().kills.values()), "it is no worker's fault"
        (tmp_path / "later").mkdir()
        await pool.solve_lines(chunk)
        assert len(read(chunk, tmp_path / "later" / "results")) == 3

    with_pool(scenario)


class _Ended(Channel):
    """A channel on which a worker said so much before its end."""

    def __init__(self, messages: int) -> None:
        super().__init__()
        self._left = messages

    async def receive(self) -> tuple[dict[str, Any], tuple[bytes, ...]]:
        self._left -= 1
        if self._left < 0:
            raise ChannelClosed(unread=False)
        return {}, ()


@pytest.mark.parametrize(("said", "given_up"), [(0, True), (1, False)])
def test_a_line_is_blamed_only_if_the_worker_was_silent_to_its_end(tmp_path: Path, said: int, given_up: bool) -> None:
    """One that came on just before it was ended was at another line then, which has not had its time."""
    chunk = Lines({}, b"1\n\n2\n3", tmp_path / "results", first=10)
    (tmp_path / "results").write_bytes(b"one\nhal")
    asyncio.run(chunk.find_out(_Ended(said), "deadline", 1.0))
    assert chunk.written == Written(4, 1, 0)
    header, rest = chunk._rest()
    assert ("instead" in header) == given_up
    if given_up:
        assert (header["instead"]["code"], header["instead"]["line"]) == ("deadline-exceeded", 13)
    assert (header["first"], rest) == ((13, b"3") if given_up else (12, b"2\n3"))


def test_a_worker_that_ends_after_its_last_line_leaves_nothing_to_be_blamed(tmp_path: Path) -> None:
    chunk = Lines({}, b"1\n2\n", tmp_path / "results")
    (tmp_path / "results").write_bytes(b"one\ntwo\n")
    for _ in range(3):
        asyncio.run(chunk.find_out(_Ended(0), "crash", 1.0))
    header, rest = chunk._rest()
    assert "instead" not in header
    assert rest.strip() == b""
