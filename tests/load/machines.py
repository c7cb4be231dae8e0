"""Several machines on one PostgreSQL: killed again and again, and one of them for good."""

from __future__ import annotations

import asyncio
import contextlib
import random
from collections.abc import Sequence

from tests.load.durability import accepted, database_of_our_own, finished
from tests.load.report import Report
from tests.load.scale import Scale
from tests.load.server import Server, serving
from tests.load.traffic import Piece, small

SUBMITTERS = 4
PAUSE_SECONDS = (0.1, 2.0)
"""Between one kill and the next, at random."""


async def machines(scale: Scale, report: Report) -> None:
    """Jobs are accepted by one machine and run by two, all killed at random moments; one of the two does not come back."""
    async with database_of_our_own(report, "machines") as postgres, contextlib.AsyncExitStack() as stack:
        if postgres is None:
            return
        common = {"database_url": postgres.url, "data_dir": scale.folder / "machines", "workers": scale.workers}
        door, doomed, heir = [
            await stack.enter_async_context(serving(scale.folder, role=role, executor_id=name, **common))
            for role, name in (("api", "door"), ("worker", "doomed"), ("worker", "heir"))
        ]
        jobs: dict[str, Piece] = {}
        count, times = max(20, scale.events // 5), max(2, scale.events // 50)
        killing = asyncio.create_task(_kill_all_but_for_good(door, doomed, heir, times))
        pieces = small()
        await asyncio.gather(*(_submit(door, pieces, jobs, count, killing, seed) for seed in range(SUBMITTERS)))
        await killing
        text = f"killed {times} times in turn, the second one's last for good, while {len(jobs)} jobs were accepted"
        report.figure("machines", "api and two workers", text)
        await finished(door.port, jobs, report, "machines")
    left = [pid for server in (door, doomed, heir) for pid in server.orphans()]
    report.promise("machines", "no process stays behind", not left)


async def _submit(
    door: Server, pieces: Sequence[Piece], jobs: dict[str, Piece], count: int, killing: asyncio.Task[None], seed: int
) -> None:
    """Have jobs accepted until there are enough of them and nobody is killed any more."""
    chance = random.Random(seed)
    while len(jobs) < count or not killing.done():
        piece = chance.choice(pieces)
        jobs[await accepted(door, piece)] = piece
        await asyncio.sleep(chance.uniform(*PAUSE_SECONDS))


async def _kill_all_but_for_good(door: Server, doomed: Server, heir: Server, times: int) -> None:
    """Kill one after the other and start it again, but for the last time that it is the turn of `doomed`."""
    chance = random.Random(13)
    turns = [(door, doomed, heir)[turn % 3] for turn in range(times)]
    last = max(turn for turn, server in enumerate(turns) if server is doomed)
    for turn, server in enumerate(turns):
        await asyncio.sleep(chance.uniform(*PAUSE_SECONDS))
        server.kill()
        if turn != last:
            server.start_again()
            await server.ready()
