"""Batches: how much of what bare processes reach is left when chunks go through the pool, and through jobs over HTTP."""

from __future__ import annotations

import asyncio
import contextlib
import json
import multiprocessing
import os
import time
from collections.abc import Sequence
from dataclasses import replace
from multiprocessing.synchronize import Barrier

from service.jobs.executor import BEYOND_WORKERS
from service.settings import Settings
from service.workers import solve
from service.workers.pool import Pool
from service.workers.process import give_way
from tests.load.client import connected
from tests.load.report import Report
from tests.load.scale import Scale
from tests.load.server import serving
from tests.load.traffic import Piece, small

CHUNK = 500
SHARE = 0.85
HEADER = {"operation": "mat", "format": "json", "keep": None}
WAIT_SECONDS = 1200.0
LEAST_CHUNKS = 30
KILLED_AT = (30, 60)  # percent


async def batch(scale: Scale, report: Report) -> None:
    """The same lines by bare processes, by the pool, and as a batch over HTTP."""
    pieces = small()
    asked = [pieces[k % len(pieces)] for k in range(scale.lines)]
    bare = await asyncio.to_thread(_bare, asked, scale.workers)
    pooled, right = await _pooled(asked, scale)
    report.figure("batch", f"{scale.workers} bare processes", f"{len(asked) / bare:.0f} domains a second")
    report.figure("batch", "the pool", f"{len(asked) / pooled:.0f} domains a second")
    report.promise("batch", f"{right} of {len(asked)} result lines right, in order", right == len(asked))
    text = f"the pool reaches {bare / pooled:.0%} of bare processes; {SHARE:.0%} or more"
    report.promise("batch", text, pooled <= scale.slack * bare / SHARE)
    async with serving(scale.folder, workers=scale.workers, batch_chunk=CHUNK) as server:
        seconds, right = await _over_http(server.port, asked)
    report.figure("batch", "over HTTP", f"{len(asked) / seconds:.0f} domains a second, from the request to its results")
    report.promise("batch", f"{right} of {len(asked)} result lines over HTTP right, in order", right == len(asked))
    report.promise("batch", "no process stays behind", not server.orphans())


async def resumed(scale: Scale, report: Report) -> None:
    """A batch whose server is killed twice on the way: what is computed again, and whether the result is right."""
    pieces = small()
    asked = [pieces[k % len(pieces)] for k in range(scale.lines)]
    chunk = min(CHUNK, max(1, scale.lines // LEAST_CHUNKS))
    settings = {"workers": scale.workers, "batch_chunk": chunk, "log_level": "debug"}
    async with serving(scale.folder, **settings) as server:
        begun = time.monotonic()
        job = await _make(server.port, asked)
        for part in KILLED_AT:
            await _over(server.port, job, part)
            server.kill()
            server.start_again()
            await server.ready()
        await _over(server.port, job)
        right = await _right_lines(server.port, job, asked)
        seconds = time.monotonic() - begun
        computed = server.log().count(f"of job {job} is begun")
    chunks = -(-len(asked) // chunk)
    most = chunks + len(KILLED_AT) * (scale.workers + BEYOND_WORKERS)
    report.figure("resumed", f"{len(asked)} domains, {len(KILLED_AT)} kills", f"{seconds:.0f} s, starts of the server included")
    report.promise("resumed", f"{right} of {len(asked)} result lines right, in order", right == len(asked))
    text = f"{chunks} chunks of {chunk} were begun {computed} times; what was open at a kill again: {most} at most"
    report.promise("resumed", text, chunks <= computed <= most)
    report.promise("resumed", "no process stays behind", not server.orphans())


def _bare(asked: Sequence[Piece], processes: int) -> float:
    """Seconds that processes take which do nothing else; at the priority that workers have for long work."""
    context = multiprocessing.get_context("spawn")
    start = context.Barrier(processes + 1)
    bodies = [piece.body for piece in asked]
    family = [context.Process(target=_solve_all, args=(bodies[k::processes], start)) for k in range(processes)]
    for process in family:
        process.start()
    start.wait()
    begun = time.monotonic()
    for process in family:
        process.join()
    assert not any(process.exitcode for process in family)
    return time.monotonic() - begun


def _solve_all(bodies: Sequence[bytes], start: Barrier) -> None:
    """One bare process; warm before it starts."""
    for body in set(bodies):
        solve.handle(HEADER, body)
    give_way(os.getpid(), Settings.from_environment().long_priority)
    start.wait()
    for body in bodies:
        solve.handle(HEADER, body)


async def _pooled(asked: Sequence[Piece], scale: Scale) -> tuple[float, int]:
    """Seconds that the pool takes, and how many result lines are right."""
    pool = Pool(replace(Settings.from_environment(), workers=scale.workers))
    rest = [asked[k : k + CHUNK] for k in range(0, len(asked), CHUNK)][::-1]
    right = 0

    async def chunks() -> None:
        nonlocal right
        while rest:
            chunk = rest.pop()
            body = b"\n".join(piece.body for piece in chunk)
            async with contextlib.aclosing(pool.lines(HEADER, body)) as found:
                results = [line async for line in found]
            right += sum(line == piece.answer for line, piece in zip(results, chunk, strict=True))

    async with pool.running():
        await pool.solve(HEADER, asked[0].body)
        begun = time.monotonic()
        await asyncio.gather(*(chunks() for _ in range(scale.workers)))
        return time.monotonic() - begun, right


async def _make(port: int, asked: Sequence[Piece]) -> str:
    """Have a batch accepted; the job's id."""
    body = b"\n".join(piece.body for piece in asked) + b"\n"
    async with connected(port) as connection:
        answer = await connection.request("POST", "/v1/batches", body, {"Content-Type": "application/x-ndjson"})
    assert answer.status == 201, answer.body
    return str(json.loads(answer.body)["jobID"])


async def _over(port: int, job: str, percent: int = 100) -> None:
    """Wait until a job has come so far, or is over."""
    async with connected(port) as connection, asyncio.timeout(WAIT_SECONDS):
        while True:
            document = json.loads((await connection.request("GET", f"/v1/jobs/{job}")).body)
            if document["status"] not in ("accepted", "running") or document["progress"] >= percent:
                return
            await asyncio.sleep(0.05)


async def _right_lines(port: int, job: str, asked: Sequence[Piece]) -> int:
    """How many result lines of a batch are what the library says, in order."""
    async with connected(port) as connection:
        results = await connection.request("GET", f"/v1/jobs/{job}/results")
    lines = results.body.splitlines()
    return sum(line == piece.answer for line, piece in zip(lines, asked, strict=True)) if len(lines) == len(asked) else 0


async def _over_http(port: int, asked: Sequence[Piece]) -> tuple[float, int]:
    """Seconds from the request to the results, and how many of them are right."""
    begun = time.monotonic()
    job = await _make(port, asked)
    await _over(port, job)
    right = await _right_lines(port, job, asked)
    return time.monotonic() - begun, right
