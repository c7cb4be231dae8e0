"""Load with faults: whatever clients, operators and processes can do to the service while others use it."""

from __future__ import annotations

import asyncio
import contextlib
import os
import random
import signal
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from tests.load.client import Answer, Connection, connected, head, read_answer
from tests.load.drive import STUCK_SECONDS, Tally, ask, health, paced, problem_code
from tests.load.report import Report
from tests.load.scale import Scale
from tests.load.server import Server, serving
from tests.load.traffic import BROKEN, Piece, endless, huge, small
from tests.service.processes import alive

KILL_PAUSE = 1.0
CLIENTS = 6
MEMORY_BYTES = 128 << 20
"""What a worker may claim: enough for every small domain, and too little for a hog."""

HOG_EDGES = 60_000
UPLOAD_SECONDS = 4.0
HEAD_SECONDS = 3.0
DOWNLOAD_SECONDS = 3.0
UNREAD = 60
"""Answers of a sixth of a megabyte that are asked for and not read: more than the kernel keeps."""

DROP_SECONDS = 0.25
EXCUSED = ("worker-crashed", "queue-full")
"""What a small request may be answered while workers are killed."""


@dataclass
class Events:
    """What was done to the service, and what of it went wrong."""

    done: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)
    stuck: int = 0

    def judge(self, name: str, answer: Answer, *expected: tuple[int, str]) -> None:
        """Hold that an answer is one of those expected, or one that a killed worker excuses."""
        found = (answer.status, problem_code(answer) if answer.status != 200 else "")
        if found not in expected and found[1] not in EXCUSED:
            self.wrong.append(f"{name}: {found[0]} {found[1]}")


async def faults(scale: Scale, report: Report) -> None:
    """Everything at once, beside small requests at a pace."""
    pieces = small()
    hog = await asyncio.to_thread(huge, HOG_EDGES)
    settings = {"worker_memory_bytes": MEMORY_BYTES, "deadline_seconds": 10}
    settings |= {"upload_seconds": UPLOAD_SECONDS, "head_seconds": HEAD_SECONDS, "download_seconds": DOWNLOAD_SECONDS}
    async with serving(scale.folder, workers=scale.workers, **settings) as server:
        events = Events()
        left = iter(range(scale.events))
        async with health(server.port) as healthy:
            beside = asyncio.create_task(_small_ones(server.port, pieces, scale))
            killer = asyncio.create_task(_kill(server, events))
            troublers = [asyncio.create_task(_trouble(server.port, pieces, hog, left, events, seed)) for seed in range(CLIENTS)]
            await asyncio.gather(*troublers)
            killer.cancel()
            beside.cancel()
            tally = await beside
        await _wait_for_quiet(server)
        after = await paced(server.port, pieces, scale.rate, scale.seconds / 3)
        workers = len(server.workers())
    report.figure("faults", "what was done", ", ".join(f"{count} {name}" for name, count in sorted(events.done.items())))
    report.figure("faults", "small requests beside them", f"{len(tally.all_seconds)} answered, excused: {dict(tally.refused)}")
    report.times("faults", "small requests beside them", tally.all_seconds)
    report.times("faults", "/healthz", healthy)
    wrong = events.wrong + tally.wrong + after.wrong
    report.promise("faults", f"{len(wrong)} wrong answers {wrong[:3] or ''}", not wrong)
    stuck = events.stuck + tally.stuck + after.stuck
    report.promise("faults", f"{stuck} stuck requests", not stuck)
    most = 2 * scale.workers + 1
    report.promise("faults", f"{workers} workers are left in the end; at most {most}", scale.workers <= workers <= most)
    report.promise("faults", "no process stays behind", not server.orphans())


async def _small_ones(port: int, pieces: Sequence[Piece], scale: Scale) -> Tally:
    """Small requests until cancelled."""
    tally = Tally()
    chance = random.Random(3)
    async with connected(port) as connection:
        with contextlib.suppress(asyncio.CancelledError):
            while True:
                await ask(connection, tally, chance.choice(pieces), EXCUSED)
                await asyncio.sleep(1.0 / scale.rate)
    return tally


async def _kill(server: Server, events: Events) -> None:
    """Kill a worker, whichever it is, again and again."""
    chance = random.Random(5)
    while True:
        await asyncio.sleep(KILL_PAUSE)
        if workers := server.workers():
            with contextlib.suppress(ProcessLookupError):
                os.kill(chance.choice(workers), signal.SIGKILL)
                events.done["workers killed"] += 1


async def _trouble(
    port: int, pieces: Sequence[Piece], hog: bytes, left: Sequence[int], events: Events, seed: int
) -> None:
    """One client that misbehaves, as long as there are events left."""
    chance = random.Random(seed)
    deeds = {"left": 8, "left long work": 4, "cut off": 5, "slow": 2, "trickle": 1, "trickled head": 1, "unread": 1}
    deeds |= {"broken": 4, "hog": 1}
    for number in left:
        deed = chance.choices(list(deeds), list(deeds.values()))[0]
        events.done[deed] += 1
        connection = Connection(port)
        try:
            async with asyncio.timeout(STUCK_SECONDS):
                await DEEDS[deed](connection, chance, pieces, hog, events, number)
        except TimeoutError:
            events.stuck += 1
        except ConnectionError as error:
            events.wrong.append(f"{deed}: {error}")
        finally:
            connection.close()


async def _leave(connection: Connection, chance: random.Random, pieces: Sequence[Piece], *_: object) -> None:
    """Go away at some moment between the request and its answer."""
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(chance.uniform(0.0, 0.03)):
            await connection.request("POST", "/v1/mat", chance.choice(pieces).body)


async def _leave_long_work(
    connection: Connection, chance: random.Random, _p: object, _h: object, _e: object, number: int
) -> None:
    """Go away from work that would take half a minute, often when it has changed its lane already."""
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(chance.uniform(0.0, 1.5)):
            await connection.request("POST", "/v1/mat", endless(number))


async def _cut_off(connection: Connection, chance: random.Random, pieces: Sequence[Piece], *_: object) -> None:
    """Promise a body and send a part of it."""
    _, writer = await connection.open()
    body = chance.choice(pieces).body
    writer.write(head("POST", "/v1/mat", len(body)) + body[: chance.randrange(len(body))])
    await writer.drain()
    await asyncio.sleep(chance.uniform(0.0, 0.05))


async def _slow(
    connection: Connection, chance: random.Random, pieces: Sequence[Piece], _h: object, events: Events, _n: int
) -> None:
    """Send a body in drops; the answer is as good as any."""
    piece = chance.choice(pieces)
    reader, writer = await connection.open()
    writer.write(head("POST", "/v1/mat", len(piece.body)))
    drops = 10
    for drop in range(drops):
        writer.write(piece.body[drop * len(piece.body) // drops : (drop + 1) * len(piece.body) // drops])
        await asyncio.sleep(chance.uniform(0.0, 0.2))
    answer = await read_answer(reader, 0.0)
    if answer.status == 200 and answer.body != piece.answer:
        events.wrong.append(f"slow {piece.name}: another answer than the library's")
    events.judge("slow", answer, (200, ""))


async def _trickle(
    connection: Connection, chance: random.Random, pieces: Sequence[Piece], _h: object, events: Events, _n: int
) -> None:
    """Send a body that would never end; the client is told to go, and the connection is closed."""
    _, writer = await connection.open()
    body = chance.choice(pieces).body
    writer.write(head("POST", "/v1/mat", len(body)))
    await _in_drops(connection, body, UPLOAD_SECONDS, "trickle", events)


async def _trickle_head(
    connection: Connection, _c: object, pieces: Sequence[Piece], _h: object, events: Events, _n: int
) -> None:
    """The same with the head of a request."""
    await connection.open()
    await _in_drops(connection, head("POST", "/v1/mat", len(pieces[0].body)), HEAD_SECONDS, "trickled head", events)


async def _in_drops(connection: Connection, content: bytes, seconds: float, name: str, events: Events) -> None:
    """Send what would take far longer than the service waits for it."""
    reader, writer = await connection.open()
    answering = asyncio.create_task(read_answer(reader, time.monotonic()))
    try:
        for drop in range(int(2 * seconds / DROP_SECONDS)):
            if answering.done():
                break
            writer.write(content[drop : drop + 1])
            await asyncio.sleep(DROP_SECONDS)
        events.judge(name, await answering, (408, "upload-timeout"))
        if await reader.read():
            events.wrong.append(f"{name}: the connection goes on")
    except ConnectionResetError:
        events.done[f"{name}, met the closing with a drop"] += 1  # which is how TCP tells of it
    finally:
        answering.cancel()


async def _leave_unread(
    connection: Connection, _c: object, _p: object, _h: object, events: Events, _n: int
) -> None:
    """Ask for much and take nothing of it: the connection is ended, whatever is still to be sent."""
    reader, writer = await connection.open()
    writer.transport.pause_reading()
    writer.write(head("GET", "/openapi.json", 0) * UNREAD)
    await asyncio.sleep(2 * DOWNLOAD_SECONDS)
    writer.transport.resume_reading()
    read = 0
    with contextlib.suppress(ConnectionError):
        while piece := await reader.read(1 << 20):
            read += piece.count(b"HTTP/1.1 200 OK")
    if read == UNREAD:
        events.wrong.append("unread: the answers were kept")


async def _broken(connection: Connection, chance: random.Random, _p: object, _h: object, events: Events, _n: int) -> None:
    """Send what is no domain."""
    name, (body, status, code) = chance.choice(list(BROKEN.items()))
    events.judge(name, await connection.request("POST", "/v1/mat", body), (status, code))


async def _hog(connection: Connection, _c: object, _p: object, hog: bytes, events: Events, _n: int) -> None:
    """Ask for more memory than there is for one request."""
    answer = await connection.request("POST", "/v1/mat", hog)
    events.judge("hog", answer, (422, "too-complex"), (503, "deadline-exceeded"))


DEEDS = {
    "left": _leave,
    "left long work": _leave_long_work,
    "cut off": _cut_off,
    "slow": _slow,
    "trickle": _trickle,
    "trickled head": _trickle_head,
    "unread": _leave_unread,
    "broken": _broken,
    "hog": _hog,
}


async def _wait_for_quiet(server: Server) -> None:
    """Give the kernel and the service a moment after the last event."""
    await asyncio.sleep(1.5)
    assert all(alive(pid) for pid in [server.process.pid]), "the service itself has ended"
