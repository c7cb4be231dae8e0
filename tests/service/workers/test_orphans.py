"""No process outlives the one that started it, however that one ends and whatever the process is doing."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest

from service.workers.failures import PoolError
from service.workers.pool import Pool
from tests.service.live import ROOT
from tests.service.processes import alive, descendants, eventually, status
from tests.service.workers.scenarios import eventually_in_loop, order, pid_of, with_pool

WEB_PROCESS = """
import asyncio, sys
from service.workers.pool import Pool
from service.settings import Settings

async def main():
    pool = Pool(Settings(), sys.argv[1])
    async with pool.running():
        while not (pool.ready or pool.progress[1]):
            await asyncio.sleep(0.01)
        spin = b'{"do": "spin", "seconds": 60}'
        tasks = [asyncio.create_task(pool.solve({}, spin, job=job)) for job in (False, True, True)]
        await asyncio.sleep(0.3)
        print("working", flush=True)
        await asyncio.gather(*tasks)

asyncio.run(main())
"""


@contextlib.contextmanager
def web_process(handler: str) -> Iterator[tuple[subprocess.Popen[bytes], set[int]]]:
    """A process with a pool, and the processes that belong to it."""
    command = [sys.executable, "-c", WEB_PROCESS, handler]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as web:
        try:
            assert web.stdout is not None
            assert web.stdout.readline() == b"working\n"
            yield web, descendants(web.pid)
        finally:
            web.kill()


@pytest.mark.parametrize("signal_number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_nothing_outlives_the_web_process(signal_number: signal.Signals) -> None:
    with web_process("tests.service.handlers") as (web, family):
        assert len(family) >= 5  # the nursery, three at work and a spare one
        web.send_signal(signal_number)
        eventually(lambda: not any(alive(pid) for pid in family))


def test_nothing_outlives_a_web_process_that_is_killed_while_kernels_are_compiled() -> None:
    with web_process("tests.service.slow_loading") as (web, family):
        assert len(family) == 3  # the nursery and two processes that compile
        web.kill()
        eventually(lambda: not any(alive(pid) for pid in family))


def test_no_worker_outlives_its_nursery() -> None:
    async def scenario(pool: Pool) -> None:
        _, nursery = status(await pid_of(pool))
        tasks = [asyncio.create_task(pool.solve({}, order("spin", seconds=60), job=job)) for job in (False, True)]
        await asyncio.sleep(0.2)
        workers = descendants(nursery)
        os.kill(nursery, signal.SIGKILL)
        await eventually_in_loop(lambda: not any(alive(pid) for pid in workers))
        answers = await asyncio.gather(*tasks, return_exceptions=True)
        assert all(isinstance(answer, PoolError) for answer in answers)
        assert await pid_of(pool) not in workers

    with_pool(scenario)


def test_a_process_whose_parent_has_gone_before_it_looks_does_not_stay() -> None:
    program = "import os; from service.workers.process import die_with_parent; die_with_parent(os.getpid())"
    assert subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=False).returncode == 1
