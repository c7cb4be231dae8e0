"""Batches: how much of what bare processes reach is left when chunks go through the pool, and through jobs over HTTP."""

from __future__ import annotations

import asyncio
import contextlib
import http.client
import io
import json
import multiprocessing
import os
import re
import shutil
import time
from collections.abc import Sequence
from dataclasses import replace
from multiprocessing.queues import SimpleQueue
from multiprocessing.synchronize import Barrier
from statistics import median
from typing import Protocol

from service.jobs.executor import BEYOND_WORKERS
from service.settings import Settings
from service.workers import solve
from service.workers.chunks import Lines
from service.workers.pool import Pool
from service.workers.process import give_way
from tests.load.client import connected
from tests.load.report import Report
from tests.load.scale import Scale
from tests.load.server import serving, used_by_all
from tests.load.traffic import Piece, small

CHUNK = 500
SHARE = 0.85
HEADER = {"operation": "mat", "format": "json", "keep": None}
WAIT_SECONDS = 1200.0
LEAST_CHUNKS = 30
KILLED_AT = (30, 60)  # percent
POLL_SECONDS = (0.5, 0.05)
NEAR = 95  # percent
READ_BYTES = 1 << 20
NEWLINE = ord("\n")


async def batch(scale: Scale, report: Report) -> None:
    """The same lines by bare processes, by the pool, and as a batch over HTTP, one after the other, some times."""
    pieces = small()
    asked = [pieces[k % len(pieces)] for k in range(scale.lines)]
    pool_shares, shares = [], []
    for number in range(1, scale.rounds + 1):
        bare, bare_used, others = await asyncio.to_thread(_bare, asked, scale.workers)
        pooled, pool_right = await _pooled(asked, scale)
        async with serving(scale.folder, workers=scale.workers, batch_chunk=CHUNK) as server:
            before = (used_by_all(), *server.processor_seconds())
            visit = await asyncio.to_thread(Visit, server.port, asked)
            after = (used_by_all(), *server.processor_seconds())
            everything, web, workers = (b - a for a, b in zip(before, after, strict=True))
            others += everything - web - workers - visit.processor_seconds
        pool_shares.append(bare / pooled)
        shares.append(bare / visit.seconds)
        rates = " / ".join(f"{len(asked) / seconds:.0f}" for seconds in (bare, pooled, visit.seconds))
        report.figure("batch", f"round {number}, domains a second", f"{rates} ({scale.workers} bare processes / the pool / HTTP)")
        costs = {"a bare process": bare_used, "a worker": workers, "the web process": web, "the client": visit.processor_seconds}
        report.figure("batch", "over HTTP", str(visit))
        told = ", ".join(f"{_each(seconds, asked)} in {name}" for name, seconds in costs.items())
        report.figure("batch", "processor time of a domain", told)
        report.figure("batch", "other programs meanwhile", f"{others / (bare + visit.seconds):.1%} of a processor")
        for name, right in (("the pool", pool_right), ("HTTP", visit.right)):
            text = f"{right} of {len(asked)} result lines of {name} right, in order"
            report.promise("batch", text, right == len(asked))
        report.promise("batch", "no process stays behind", not server.orphans())
    for name, found in (("the pool", pool_shares), ("HTTP", shares)):
        share = median(found)
        text = f"{name} reaches {share:.0%} of bare processes, the median of {len(found)}; {SHARE:.0%} or more"
        report.promise("batch", text, share * scale.slack >= SHARE)


def _each(seconds: float, asked: Sequence[Piece]) -> str:
    return f"{1000 * seconds / len(asked):.3f} ms"


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
        begun_chunks = re.findall(rf"chunk (\d+) of job {job} is begun", server.log())
    computed, chunks = len(begun_chunks), len(set(begun_chunks))
    most = chunks + len(KILLED_AT) * (scale.workers + BEYOND_WORKERS)
    report.figure("resumed", f"{len(asked)} domains, {len(KILLED_AT)} kills", f"{seconds:.0f} s, starts of the server included")
    report.promise("resumed", f"{right} of {len(asked)} result lines right, in order", right == len(asked))
    text = f"{chunks} chunks of up to {chunk} were begun {computed} times; what was open at a kill again: {most} at most"
    report.promise("resumed", text, len(asked) // chunk <= chunks <= computed <= most)
    report.promise("resumed", "no process stays behind", not server.orphans())


def _bare(asked: Sequence[Piece], processes: int) -> tuple[float, float, float]:
    """Seconds that processes take which do nothing else, at the priority of workers with long work.

    And seconds of processor time: theirs, and other programs'.
    """
    context = multiprocessing.get_context("spawn")
    start = context.Barrier(processes + 1)
    used = context.SimpleQueue()
    bodies = [piece.body for piece in asked]
    family = [context.Process(target=_solve_all, args=(bodies[k::processes], start, used)) for k in range(processes)]
    for process in family:
        process.start()
    start.wait()
    begun, before = time.monotonic(), used_by_all()
    for process in family:
        process.join()
    seconds, everything = time.monotonic() - begun, used_by_all() - before
    assert not any(process.exitcode for process in family)
    ours = sum(used.get() for _ in family)
    return seconds, ours, everything - ours


def _solve_all(bodies: Sequence[bytes], start: Barrier, used: SimpleQueue[float]) -> None:
    """One bare process; warm before it starts."""
    for body in set(bodies):
        solve.handle(HEADER, body)
    give_way(os.getpid(), Settings.from_environment().long_priority)
    start.wait()
    begun = time.process_time()
    for body in bodies:
        solve.handle(HEADER, body)
    used.put(time.process_time() - begun)


async def _pooled(asked: Sequence[Piece], scale: Scale) -> tuple[float, int]:
    """Seconds that the pool takes, and how many result lines are right."""
    pool = Pool(replace(Settings.from_environment(), workers=scale.workers))
    places = list(range(0, len(asked), CHUNK))
    folder = scale.folder / "results"
    folder.mkdir(exist_ok=True)

    async def chunks(left: list[int]) -> None:
        while left:
            place = left.pop()
            body = b"\n".join(piece.body for piece in asked[place : place + CHUNK])
            await pool.solve_lines(Lines(HEADER, body, folder / str(place)))

    async with pool.running():
        await pool.solve(HEADER, asked[0].body)
        begun = time.monotonic()
        left = places[::-1]
        await asyncio.gather(*(chunks(left) for _ in range(scale.workers)))
        seconds = time.monotonic() - begun
    right = 0
    for place in places:
        with (folder / str(place)).open("rb") as file:
            right += right_lines(asked[place : place + CHUNK], file)
    shutil.rmtree(folder)
    return seconds, right


class Source(Protocol):
    """What results are read from."""

    def readinto(self, room: memoryview, /) -> int:
        """Put what comes next into a room; how many bytes, 0 at the end."""
        ...


def right_lines(asked: Sequence[Piece], source: Source) -> int:
    """How many result lines are what the library says, in order, up to the first that is not; the last is not if more follows."""
    room = bytearray(READ_BYTES + 1 + max(len(piece.answer) for piece in asked))
    right = filled = 0
    with memoryview(room) as view:
        while read := source.readinto(view[filled:]):
            filled, place = filled + read, 0
            while right < len(asked) and (end := place + len(asked[right].answer)) < filled:
                if not room.startswith(asked[right].answer, place) or room[end] != NEWLINE:
                    return right
                right, place = right + 1, end + 1
            view[: filled - place] = view[place:filled]
            filled -= place
    return right - (right == len(asked) and filled > 0)


class Visit:
    """A client that has a batch solved, takes its results and looks whether they are right.

    It has neither a processor nor memory to spare, which the service would miss: to find 660 MB for all of the results may take
    a system a second. So they pass through a small room, and are compared there by one call a line.

    Attributes
    ----------
    seconds : float
        From the request to the last byte of the results.
    right : int
        Result lines that are what the library says, in order.
    processor_seconds : float
        What it used itself.
    """

    def __init__(self, port: int, asked: Sequence[Piece]) -> None:
        body = b"\n".join(piece.body for piece in asked) + b"\n"
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=WAIT_SECONDS)
        used, begun = time.thread_time(), time.monotonic()
        with contextlib.closing(connection):
            connection.request("POST", "/v1/batches", body, {"Content-Type": "application/x-ndjson"})
            job = json.load(connection.getresponse())["jobID"]
            self._upload_seconds = time.monotonic() - begun
            self._wait(connection, job)
            waited = time.monotonic()
            connection.request("GET", f"/v1/jobs/{job}/results")
            response = connection.getresponse()
            self.right = right_lines(asked, response)
        self.seconds = time.monotonic() - begun
        self.processor_seconds = time.thread_time() - used
        self._download_seconds = time.monotonic() - waited

    def _wait(self, connection: http.client.HTTPConnection, job: str) -> None:
        """Look now and then until it is over, and often when that is near."""
        while True:
            connection.request("GET", f"/v1/jobs/{job}")
            document = json.load(connection.getresponse())
            if document["status"] not in ("accepted", "running"):
                return
            time.sleep(POLL_SECONDS[document["progress"] >= NEAR])

    def __str__(self) -> str:
        return f"{self._upload_seconds:.2f} s to send, {self._download_seconds:.2f} to receive, {self.seconds:.2f} in all"


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
    """How many result lines of a batch are what the library says, in order, up to the first that is not."""
    async with connected(port) as connection:
        results = await connection.request("GET", f"/v1/jobs/{job}/results")
    return right_lines(asked, io.BytesIO(results.body))
