"""Load without faults: small requests alone, beside huge ones, and more of everything than there is room for."""

from __future__ import annotations

import asyncio
import contextlib
import random
from collections import Counter
from typing import Any

from tests.load.client import Answer, connected
from tests.load.crowd import crowd
from tests.load.drive import HEALTH_SECONDS, Tally, busy, health, paced, problem_code
from tests.load.report import Report, quantile
from tests.load.scale import Scale
from tests.load.server import serving
from tests.load.traffic import endless, huge, small

PAUSE_AFTER_REFUSAL = 0.2
LET_IN_SECONDS = 0.5
BEGUN = b"was stopped"  # what is told to one that was let in, took long, and found no room in the next lane
REFUSAL_SECONDS = 0.05
LATE_SECONDS = 0.25
RATIO = 3.0
HUGE_CLIENTS = 4
ENDLESS_CLIENTS = 6
ENDLESS_PATIENCE = 1.5
ENDLESS_PAUSE = 0.1
ENDLESS_SECONDS = 0.5


async def calm(scale: Scale, report: Report) -> None:
    """Small requests alone."""
    pieces = small()
    async with serving(scale.folder, workers=scale.workers) as server:
        await busy(server.port, pieces, 2, 1.0)
        alone, rate = await busy(server.port, pieces, 1, scale.seconds)
        report.figure("calm", "one client", f"{rate:.0f} a second")
        report.times("calm", "one client, a request", alone.all_seconds)
        _shares(alone, report)
        before = server.processor_seconds()
        many, rate = await busy(server.port, pieces, 2 * scale.workers, scale.seconds)
        web, workers = (after - earlier for after, earlier in zip(server.processor_seconds(), before, strict=True))
        count = len(many.all_seconds)
        text = f"web process {1000 * web / count:.2f} ms, workers {1000 * workers / count:.2f} ms a request"
        report.figure("calm", "processor time", f"{text}: {web / (web + workers):.1%} for HTTP and passing on")
        report.figure("calm", f"{2 * scale.workers} clients", f"{rate:.0f} a second")
        for kind, seconds in sorted(many.seconds.items()):
            report.times("calm", f"{2 * scale.workers} clients, {kind}s", seconds)
    _right("calm", report, alone, many)
    report.promise("calm", "no process stays behind", not server.orphans())


def _shares(tally: Tally, report: Report) -> None:
    """Where the time of a request goes when nothing else is asked."""
    whole = sum(seconds for seconds, _ in tally.timings)
    spent: Counter[str] = Counter()
    for _, timing in tally.timings:
        spent.update(timing)
    parts = {name: milliseconds / 1000 for name, milliseconds in spent.items()}
    parts["HTTP, sockets, client"] = whole - sum(parts.values())
    text = ", ".join(f"{name} {seconds / whole:.1%}" for name, seconds in parts.items())
    report.figure("calm", "one client, where its time goes", text)
    report.figure("calm", "share that is not solving", f"{1 - parts.get('solve', 0.0) / whole:.1%}")


async def beside_huge(scale: Scale, report: Report) -> None:
    """Small requests at a pace, before, while and after four huge domains are being solved."""
    pieces = small()
    body = await asyncio.to_thread(huge, scale.huge_edges)
    settings = {"workers": scale.workers, "deadline_seconds": 300, "worker_memory_bytes": 4 << 30}
    async with serving(scale.folder, **settings) as server:
        await busy(server.port, pieces, 2, 1.0)
        async with health(server.port) as healthy:
            before = await paced(server.port, pieces, scale.rate, scale.seconds / 2)
            async with crowd(server.port, body, HUGE_CLIENTS) as answers:
                await asyncio.sleep(0.5)
                beside = await paced(server.port, pieces, scale.rate, scale.seconds)
                during = list(healthy)
            after = await paced(server.port, pieces, scale.rate, scale.seconds / 2)
    quiet = before.all_seconds + after.all_seconds
    report.times("huge", "small requests, quiet", quiet)
    report.times("huge", "small requests, beside", beside.all_seconds)
    report.times("huge", f"huge ones, {scale.huge_edges} edges", [seconds for _, seconds in answers])
    report.times("huge", "/healthz", during)
    ratio = quantile(beside.all_seconds, 0.99) / quantile(quiet, 0.99)
    _right("huge", report, before, beside, after)
    report.promise("huge", "every huge domain is solved", bool(answers) and all(status == 200 for status, _ in answers))
    report.promise("huge", f"small p99 {ratio:.2f} times the quiet one; under {RATIO:g}", ratio < RATIO * scale.slack)
    late = quantile(during, 0.99)
    text = f"/healthz in {1000 * late:.0f} ms (p99), {1000 * max(during):.0f} ms (longest); under {1000 * HEALTH_SECONDS:.0f}"
    report.promise("huge", text, late < HEALTH_SECONDS * scale.slack)
    report.promise("huge", "no process stays behind", not server.orphans())


async def beside_endless(scale: Scale, report: Report) -> None:
    """Small requests at a pace, alone and beside a flow of small bodies that would take half a minute each."""
    pieces = small()
    async with serving(scale.folder, workers=scale.workers) as server:
        await busy(server.port, pieces, 2, 1.0)
        quiet = await paced(server.port, pieces, scale.rate, scale.seconds / 2)
        flow = [asyncio.create_task(_flow(server.port, seed)) for seed in range(ENDLESS_CLIENTS)]
        async with health(server.port) as healthy:
            beside = await paced(server.port, pieces, scale.rate, scale.seconds)
        for task in flow:
            task.cancel()
        await asyncio.gather(*flow, return_exceptions=True)
    report.times("endless", "small requests, quiet", quiet.all_seconds)
    report.times("endless", "small requests, beside", beside.all_seconds)
    report.times("endless", "/healthz", healthy)
    late = quantile(beside.all_seconds, 0.99)
    text = f"small requests in {1000 * late:.0f} ms (p99); under {1000 * ENDLESS_SECONDS:.0f}"
    report.promise("endless", text, late < ENDLESS_SECONDS * scale.slack)
    _right("endless", report, quiet, beside)
    report.promise("endless", "no process stays behind", not server.orphans())


async def _flow(port: int, seed: int) -> None:
    """Ask for endless work, leave it, and ask for the next."""
    chance = random.Random(seed)
    while True:
        with contextlib.suppress(TimeoutError, ConnectionError):
            async with asyncio.timeout(chance.uniform(0.0, ENDLESS_PATIENCE)), connected(port) as connection:
                await connection.request("POST", "/v1/mat", endless(chance.randrange(1000)))
        await asyncio.sleep(ENDLESS_PAUSE)


async def overload(scale: Scale, report: Report) -> None:
    """Both small lane and its queue are full of long work: one more is refused at once, and served when there is room again."""
    limit = 4
    async with serving(scale.folder, workers=scale.workers, queue_limit=limit, deadline_seconds=60) as server:
        seeds = range(4 * (scale.workers + limit))
        crowd: list[asyncio.Task[Any]] = [asyncio.create_task(_hold(server.port, endless(seed))) for seed in seeds]
        refused: list[float] = []
        stopped: list[float] = []
        codes: Counter[str] = Counter()
        for seed in range(scale.events // 5):
            probe = asyncio.create_task(_ask(server.port, endless(seed)))
            await asyncio.wait({probe}, timeout=LET_IN_SECONDS)
            if probe.done():
                answer = probe.result()
                codes[problem_code(answer)] += 1
                (stopped if BEGUN in answer.body else refused).append(answer.seconds)
            else:
                crowd.append(probe)  # there was room for it: it stays, so that there is less
            await asyncio.sleep(0.01)
        for task in crowd:
            task.cancel()
        await asyncio.gather(*crowd, return_exceptions=True)
        tally = await paced(server.port, small(), scale.rate, 1.0)
    report.times("overload", "a refusal", refused)
    if stopped:
        report.times("overload", "one that was let in and stopped", stopped)
    report.promise("overload", f"refused as queue-full: {dict(codes)}", set(codes) == {"queue-full"})
    late = quantile(refused, 0.99)
    text = f"refused in {1000 * late:.0f} ms (p99); under {1000 * REFUSAL_SECONDS:.0f}"
    report.promise("overload", text, late < REFUSAL_SECONDS * scale.slack)
    _right("overload", report, tally)
    report.promise("overload", "no process stays behind", not server.orphans())


async def _ask(port: int, body: bytes) -> Answer:
    """One request on a connection of its own."""
    async with connected(port) as connection:
        return await connection.request("POST", "/v1/mat", body)


async def _hold(port: int, body: bytes) -> None:
    """Keep a place in the queue: ask until let in."""
    async with connected(port) as connection:
        while True:
            await connection.request("POST", "/v1/mat", body)
            await asyncio.sleep(PAUSE_AFTER_REFUSAL)


async def deadlines(scale: Scale, report: Report) -> None:
    """Work that takes longer than it may, more of it at a time than there are workers."""
    limit = 1.6

    async with serving(scale.folder, workers=scale.workers, deadline_seconds=limit) as server:
        answers: list[Answer] = []
        for turn in range(max(1, scale.events // 100)):
            seeds = range(4 * turn * scale.workers, 4 * (turn + 1) * scale.workers)
            answers += await asyncio.gather(*(_ask(server.port, endless(seed)) for seed in seeds))
            await asyncio.sleep(0.3)
        tally = await paced(server.port, small(), scale.rate, 1.0)
    codes = Counter(problem_code(answer) for answer in answers)
    late = [answer.seconds - limit for answer in answers]
    report.times("deadlines", f"after a deadline of {limit:g} s", late)
    report.promise("deadlines", f"ended as deadline-exceeded: {dict(codes)}", set(codes) == {"deadline-exceeded"})
    text = f"ended {1000 * max(late):.0f} ms after the deadline at the latest; under {1000 * LATE_SECONDS:.0f}"
    report.promise("deadlines", text, min(late) > -0.01 and max(late) < LATE_SECONDS * scale.slack)
    _right("deadlines", report, tally)
    report.promise("deadlines", "no process stays behind", not server.orphans())


def _right(part: str, report: Report, *tallies: Tally) -> None:
    """Promise that nothing was wrong or stuck."""
    wrong = [fault for tally in tallies for fault in tally.wrong]
    right = sum(len(tally.all_seconds) for tally in tallies)
    report.promise(part, f"{right} right answers, {len(wrong)} wrong {wrong[:3] or ''}", right > 0 and not wrong)
    stuck = sum(tally.stuck for tally in tallies)
    report.promise(part, f"{stuck} stuck requests", not stuck)
