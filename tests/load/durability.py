"""What was accepted is done: jobs while the server is killed, while the database is away, while the disk is full."""

from __future__ import annotations

import asyncio
import contextlib
import json
import random
import secrets
import shutil
import subprocess
import time
from collections import Counter
from collections.abc import AsyncIterator, Iterator, Sequence
from pathlib import Path

from tests.load.client import Answer, connected
from tests.load.drive import Tally, paced, problem_code
from tests.load.report import Report
from tests.load.scale import Scale
from tests.load.server import Server, serving
from tests.load.traffic import Piece, endless, small
from tests.service.jobs.postgres import Postgres, programs
from tests.service.processes import alive

ASYNC = {"Prefer": "respond-async"}
JOBS_SECONDS = 300.0
"""How long accepted jobs may take altogether, kills included."""

FREE_SECONDS = 0.25

DISK_BYTES = 32 << 20
LETTERS = 64 << 10


async def _submit(port: int, piece: Piece, key: str) -> Answer:
    """Ask for a job on a connection of its own: the server may be gone the next moment."""
    async with connected(port) as connection:
        return await connection.request("POST", "/v1/mat", piece.body, ASYNC | {"Idempotency-Key": key})


async def accepted(server: Server, piece: Piece) -> str:
    """Have a job accepted, however often it takes; its id. A key makes it one job."""
    key = secrets.token_hex(8)
    while True:
        with contextlib.suppress(ConnectionError):
            answer = await _submit(server.port, piece, key)
            if answer.status == 201:
                return str(json.loads(answer.body)["jobID"])
        await asyncio.sleep(0.05)


async def finished(port: int, jobs: dict[str, Piece], report: Report, part: str) -> None:
    """Wait for accepted jobs and judge their results."""
    faults: list[str] = []
    done: Counter[str] = Counter()
    end = time.monotonic() + JOBS_SECONDS
    async with connected(port) as connection:
        for job, piece in jobs.items():
            state = "lost"
            while time.monotonic() < end:
                answer = await connection.request("GET", f"/v1/jobs/{job}")
                state = json.loads(answer.body).get("status", problem_code(answer) if answer.status != 200 else "?")
                if state not in ("accepted", "running"):
                    break
                await asyncio.sleep(0.05)
            done[state] += 1
            if state == "successful":
                results = await connection.request("GET", f"/v1/jobs/{job}/results")
                if results.status != 200 or results.body != piece.answer:
                    faults.append(f"{piece.name}: another answer than the library's")
    complete = done["successful"]
    report.promise(part, f"{complete} of {len(jobs)} accepted jobs complete: {dict(done)}", complete == len(jobs))
    report.promise(part, f"{len(faults)} wrong results {faults[:3] or ''}", not faults)


async def killed(scale: Scale, report: Report) -> None:
    """The server is killed at random moments and started again, with jobs in flight."""
    pieces = small()
    chance = random.Random(11)
    async with serving(scale.folder, workers=scale.workers) as server:
        jobs: dict[str, Piece] = {}

        count, times = max(20, scale.events // 5), max(2, scale.events // 50)
        kills = 0

        async def submit() -> None:
            while kills < times or len(jobs) < count:
                piece = chance.choice(pieces)
                jobs[await accepted(server, piece)] = piece
                await asyncio.sleep(chance.uniform(0.0, 8.0 * times / count))

        submitters = [asyncio.create_task(submit()) for _ in range(4)]
        while kills < times:
            await asyncio.sleep(chance.uniform(0.1, 2.0))
            server.kill()
            kills += 1
            server.start_again()
            await server.ready()
        await asyncio.gather(*submitters)
        report.figure("killed", "the server", f"killed {kills} times while {len(jobs)} jobs were accepted")
        await finished(server.port, jobs, report, "killed")
    report.promise("killed", "no process stays behind", not server.orphans())


async def dismissed(scale: Scale, report: Report) -> None:
    """Running jobs are dismissed: how soon their processor is free."""
    answered: list[float] = []
    freed: list[float] = []
    async with serving(scale.folder, workers=scale.workers) as server, connected(server.port) as connection:
        for seed in range(max(5, scale.events // 20)):
            answer = await connection.request("POST", "/v1/mat", endless(seed), ASYNC)
            job = f"/v1/jobs/{json.loads(answer.body)['jobID']}"
            while json.loads((await connection.request("GET", job)).body)["status"] != "running":
                await asyncio.sleep(0.01)
            await asyncio.sleep(random.Random(seed).uniform(0.0, 0.5))
            workers = server.workers()
            begun = time.monotonic()
            answered.append((await connection.request("DELETE", job)).seconds)
            while all(alive(pid) for pid in workers) and time.monotonic() < begun + JOBS_SECONDS:
                await asyncio.sleep(0.001)
            freed.append(time.monotonic() - begun)
        tally = await paced(server.port, small(), scale.rate, 1.0)
    report.times("dismissed", "DELETE of a running job, answered", answered)
    report.times("dismissed", "its worker has ended", freed)
    text = f"the processor is free {1000 * max(freed):.0f} ms after it at the latest; under {1000 * FREE_SECONDS:.0f}"
    report.promise("dismissed", text, max(freed) < FREE_SECONDS * scale.slack)
    _undisturbed("dismissed", tally, report)
    report.promise("dismissed", "no process stays behind", not server.orphans())


@contextlib.asynccontextmanager
async def database_of_our_own(report: Report, part: str) -> AsyncIterator[Postgres | None]:
    """A PostgreSQL of our own, where its programs are installed; a visible line where not."""
    folder = programs()
    if folder is None:
        report.figure(part, "left out", "PostgreSQL is not installed")
        yield None
        return
    postgres = await asyncio.to_thread(Postgres, folder)
    try:
        await asyncio.to_thread(postgres.start)
        yield postgres
    finally:
        await asyncio.to_thread(postgres.remove)


async def database(scale: Scale, report: Report) -> None:
    """The database goes away while jobs are in flight, and comes back."""
    pieces = small()
    async with database_of_our_own(report, "database") as postgres:
        if postgres is None:
            return
        async with serving(scale.folder, workers=scale.workers, database_url=postgres.url) as server:
            jobs = {await accepted(server, piece): piece for piece in pieces}
            await asyncio.to_thread(postgres.stop)
            away = min(10.0, scale.seconds)
            refusing = asyncio.create_task(_refusals(server.port, pieces, away))
            tally = await paced(server.port, pieces, scale.rate, away)
            codes = await refusing
            await asyncio.to_thread(postgres.start)
            await server.ready()
            jobs |= {await accepted(server, piece): piece for piece in pieces}
            await finished(server.port, jobs, report, "database")
    report.times("database", f"small requests, {away:.0f} s without it", tally.all_seconds)
    report.promise("database", f"jobs are refused meanwhile: {dict(codes)}", set(codes) <= {"store-unavailable"})
    _undisturbed("database", tally, report)
    report.promise("database", "no process stays behind", not server.orphans())


def _undisturbed(part: str, tally: Tally, report: Report) -> None:
    good = bool(tally.all_seconds) and not tally.wrong and not tally.stuck
    report.promise(part, f"{len(tally.all_seconds)} small requests answered right {tally.wrong[:3] or ''}", good)


async def _refusals(port: int, pieces: Sequence[Piece], seconds: float) -> Counter[str]:
    """What jobs are answered for a while; 'accepted' where they are."""
    codes: Counter[str] = Counter()
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        answer = await _submit(port, random.choice(pieces), secrets.token_hex(8))
        codes["accepted" if answer.status == 201 else problem_code(answer)] += 1
        await asyncio.sleep(0.2)
    return codes


async def disk(scale: Scale, report: Report) -> None:
    """The disk of bodies and results is full for a while, jobs in flight."""
    before, meanwhile, after = small(), small(1e-5), small(1e-4)  # what is stored already takes no room
    with _small_disk(scale.folder / "disk") as folder:
        if folder is None:
            report.figure("disk", "left out", "no small file system may be mounted here")
            return
        async with serving(scale.folder, workers=scale.workers, data_dir=folder) as server:
            jobs = {await accepted(server, piece): piece for piece in before}
            _fill(folder / "filler")
            codes = await _refusals(server.port, meanwhile, min(5.0, scale.seconds))
            tally = await paced(server.port, before, scale.rate, 1.0)
            (folder / "filler").unlink()
            await server.ready()
            jobs |= {await accepted(server, piece): piece for piece in after}
            await finished(server.port, jobs, report, "disk")
    report.promise("disk", f"jobs are refused meanwhile: {dict(codes)}", set(codes) == {"store-unavailable"})
    _undisturbed("disk", tally, report)
    report.promise("disk", "no process stays behind", not server.orphans())


@contextlib.contextmanager
def _small_disk(folder: Path) -> Iterator[Path | None]:
    """A file system in memory of a few megabytes, where this process may mount one."""
    folder.mkdir(exist_ok=True)
    mount = shutil.which("mount")
    command = [mount or "mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "tmpfs", str(folder)]
    if mount is None or subprocess.run(command, check=False, capture_output=True).returncode != 0:
        yield None
        return
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", str(folder)], check=True)


def _fill(filler: Path) -> None:
    """Write until there is no room."""
    with contextlib.suppress(OSError), filler.open("wb", buffering=0) as file:
        while True:
            file.write(bytes(LETTERS))
    with contextlib.suppress(OSError), filler.open("ab", buffering=0) as file:
        while True:
            file.write(bytes(512))
