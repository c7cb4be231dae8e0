"""Requests at a pace, health checks beside them, and what became of each."""

from __future__ import annotations

import asyncio
import contextlib
import json
import random
import time
from collections import Counter
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass, field

from tests.load.client import Answer, Connection, connected
from tests.load.traffic import Piece

STUCK_SECONDS = 60.0
"""A request without an answer for so long, which is longer than any deadline here, is stuck."""

HEALTH_PAUSE = 0.02
HEALTH_SECONDS = 0.05
"""Within which /healthz answers, whatever else is asked."""


@dataclass
class Tally:
    """What became of requests.

    Attributes
    ----------
    seconds : dict of str to list of float
        How long the right answers took, by kind.
    timings : list of (float, dict of str to float)
        Of each right answer the seconds it took, and what the service said of them, in milliseconds.
    refused : collections.Counter
        Codes of problem documents.
    wrong : list of str
        Answers that were neither right nor a problem document that had to be expected.
    stuck : int
        Requests without any answer.
    """

    seconds: dict[str, list[float]] = field(default_factory=dict)
    timings: list[tuple[float, dict[str, float]]] = field(default_factory=list)
    refused: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)
    stuck: int = 0

    @property
    def all_seconds(self) -> list[float]:
        """How long all right answers took."""
        return [second for kind in self.seconds.values() for second in kind]

    def take(self, piece: Piece, answer: Answer, allowed: Sequence[str] = (), seconds: float | None = None) -> None:
        """Judge an answer."""
        if answer.status == 200:
            if answer.body != piece.answer:
                self.wrong.append(f"{piece.name}: another answer than the library's")
                return
            took = answer.seconds if seconds is None else seconds
            self.seconds.setdefault(piece.kind, []).append(took)
            self.timings.append((answer.seconds, server_timing(answer)))
            return
        code = problem_code(answer)
        self.refused[code] += 1
        if code not in allowed:
            self.wrong.append(f"{piece.name}: {answer.status} {code}")


def problem_code(answer: Answer) -> str:
    """The code of a problem document."""
    try:
        return str(json.loads(answer.body)["code"])
    except (ValueError, KeyError):
        return f"no problem document with status {answer.status}"


def server_timing(answer: Answer) -> dict[str, float]:
    """Milliseconds of each stage, as the service tells them."""
    entries = (entry.strip().split(";dur=") for entry in answer.headers.get("server-timing", "").split(","))
    return {name: float(value) for name, value in (entry for entry in entries if len(entry) == 2)}


async def ask(connection: Connection, tally: Tally, piece: Piece, allowed: Sequence[str] = (), due: float = 0.0) -> None:
    """Send a piece and judge the answer; its time counts from when it was due, if that was earlier."""
    try:
        async with asyncio.timeout(STUCK_SECONDS):
            answer = await connection.request("POST", "/v1/mat", piece.body)
    except TimeoutError:
        tally.stuck += 1
        return
    except ConnectionError:
        tally.wrong.append(f"{piece.name}: the connection ended without an answer")
        return
    tally.take(piece, answer, allowed, time.monotonic() - due if due else None)


async def busy(port: int, pieces: Sequence[Piece], clients: int, seconds: float) -> tuple[Tally, float]:
    """Clients that send the next request as soon as they have an answer; right answers a second."""
    tally = Tally()
    begun = time.monotonic()

    async def client(seed: int) -> None:
        chance = random.Random(seed)
        async with connected(port) as connection:
            while time.monotonic() < begun + seconds:
                await ask(connection, tally, chance.choice(pieces))

    await asyncio.gather(*(client(seed) for seed in range(clients)))
    return tally, len(tally.all_seconds) / (time.monotonic() - begun)


async def paced(
    port: int, pieces: Sequence[Piece], rate: float, seconds: float, allowed: Sequence[str] = (), clients: int = 16
) -> Tally:
    """Requests at random moments, `rate` of them a second, whether or not the ones before have been answered."""
    tally = Tally()
    chance = random.Random(7)
    idle: asyncio.Queue[Connection] = asyncio.Queue()
    async with contextlib.AsyncExitStack() as stack, asyncio.TaskGroup() as requests:
        for _ in range(clients):
            idle.put_nowait(await stack.enter_async_context(connected(port)))

        async def send(piece: Piece, due: float) -> None:
            connection = await idle.get()
            await ask(connection, tally, piece, allowed, due)
            idle.put_nowait(connection)

        due = time.monotonic()
        end = due + seconds
        while due < end:
            await asyncio.sleep(max(0.0, due - time.monotonic()))
            requests.create_task(send(chance.choice(pieces), due))
            due += chance.expovariate(rate)
    return tally


@contextlib.asynccontextmanager
async def health(port: int, *, anew: bool = False) -> AsyncIterator[list[float]]:
    """Ask for the health of the service all the while, on one connection or each time on a new one; seconds of each answer."""
    seconds: list[float] = []

    async def check() -> None:
        async with connected(port) as connection:
            while True:
                begun = time.monotonic()
                answer = await connection.request("GET", "/healthz")
                assert answer.status == 200
                seconds.append(time.monotonic() - begun)
                if anew:
                    connection.close()
                await asyncio.sleep(HEALTH_PAUSE)

    task = asyncio.create_task(check())
    try:
        yield seconds
    finally:
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task
