"""``mat batch``: many domains, one a line, by the same workers as the service's, without the service.

::

    input ──lines──> chunks ──> several at once in the pool ──> results, put in order again ──> output

A chunk is as many lines as take about `CHUNK_SECONDS`, judged by those before it: large enough that handing it over costs
nothing, small enough that an interruption loses little and that no worker is left with the rest of the work at the end.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import dataclasses
import logging
import os
import signal
import sys
import time
from collections import Counter, deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, NamedTuple

import orjson
from tqdm import tqdm

from service.cli import files
from service.cli.exits import FAILED, OK, SOME_FAILED, TERMINATED, USAGE, Failure, tell
from service.cli.request import additions, header, with_additions
from service.errors import PROBLEM_LINE
from service.settings import InvalidSetting, Settings, variable
from service.workers.chunks import Lines
from service.workers.pool import Pool, Unwritten
from service.workers.result_lines import Written

CHUNK_SECONDS = 0.5
CHUNK_LINES = 500
"""Most lines of a chunk."""

CHUNK_BYTES = 1 << 20
"""A chunk ends with the line that makes it larger than this."""

AHEAD = 4
"""Chunks under way for each worker: while one long domain holds up the order of the output, the other workers go on."""


PRIORITY = "low"
"""Of the workers, unless the settings say otherwise. There are no small requests here for which to take only what is left."""


class Results(NamedTuple):
    """The result lines of a chunk."""

    content: bytes
    written: Written


@dataclass(slots=True)
class Tally:
    """What became of the domains: how many were answered, and how many not, by code."""

    lines: int = 0
    failed: Counter[str] = field(default_factory=Counter)

    def add(self, results: Results) -> None:
        """Count result lines."""
        self.lines += results.written.lines
        if results.written.failed:
            lines = results.content.splitlines()
            self.failed.update(orjson.loads(line)["code"] for line in lines if line.startswith(PROBLEM_LINE))

    def __str__(self) -> str:
        kinds = ", ".join(f"{count} {code}" for code, count in self.failed.most_common())
        return f"{self.failed.total()} of {self.lines} domains were not solved ({kinds}); their lines say why"


def batch(asked: argparse.Namespace) -> int:
    """Solve every line of the input that the output does not answer yet."""
    _log_plainly()
    told, members = header(asked, asked.format), additions(asked)
    settings = settings_of(asked)
    _spare(asked)
    tally = Tally()
    out = files.LinesOut(asked.output, resume=asked.resume)
    try:
        with files.reading(asked.input) as source, _bar(asked, out.kept) as bar:
            chunks = Chunks(source, members, out.kept)
            with files.scratch() as folder:
                asyncio.run(_run(Pool(settings), told, chunks, settings.workers, folder, out, tally, bar))
    except asyncio.CancelledError:
        raise Failure(TERMINATED, "told to end") from None
    finally:
        out.close()
    if tally.failed:
        tell(str(tally))
    return SOME_FAILED if tally.failed else OK


class _Plain(logging.Formatter):
    """For people; a worker's traceback comes with its line."""

    def format(self, record: logging.LogRecord) -> str:
        """The lines, without the last end."""
        return "\n".join(filter(None, (f"mat: {super().format(record)}", getattr(record, "exception", None))))


def _log_plainly() -> None:
    """Show warnings of the pool and its workers as a command does."""
    handler = logging.StreamHandler()
    handler.setFormatter(_Plain())
    logging.basicConfig(level=logging.WARNING, handlers=[handler])


def settings_of(asked: argparse.Namespace) -> Settings:
    """The service's settings, with what the command line says."""
    try:
        settings = Settings.from_environment({variable("long_priority"): PRIORITY, **os.environ})
    except InvalidSetting as error:
        raise Failure(USAGE, str(error)) from error
    deadline = settings.deadline_seconds if asked.deadline is None else asked.deadline
    return dataclasses.replace(settings, workers=asked.workers, deadline_seconds=deadline)


def _spare(asked: argparse.Namespace) -> None:
    """Refuse to overwrite hours of work, and to resume what cannot be read back."""
    if asked.output == files.STANDARD:
        if asked.resume:
            raise Failure(USAGE, "--resume needs an output that can be read back, not standard output")
        return
    with contextlib.suppress(FileNotFoundError):
        if os.path.samefile(asked.input, asked.output):
            raise Failure(USAGE, f"{asked.output} is the input")
    if not (asked.resume or asked.force) and os.path.isfile(asked.output) and os.path.getsize(asked.output) > 0:
        raise Failure(USAGE, f"{asked.output} is there; --resume goes on after its last line, --force overwrites it")


@contextlib.contextmanager
def _bar(asked: argparse.Namespace, done: int) -> Iterator[tqdm[Any]]:
    """A progress bar on standard error, if that is a terminal."""
    total = None
    if sys.stderr.isatty() and os.path.isfile(asked.input) and not asked.input.endswith(files.PACKED):
        with open(asked.input, "rb") as lines:
            total = sum(1 for line in lines if line.strip())
    with tqdm(total=total, initial=done, unit=" domains", disable=None) as bar:
        yield bar


class Chunks:
    """The lines of an input, in chunks.

    Parameters
    ----------
    source : binary file
    members : dict
        What goes into every document, see `service.cli.request.with_additions`.
    skip : int
        How many domains have their answer already.
    """

    def __init__(self, source: IO[bytes], members: dict[str, Any], skip: int) -> None:
        self._source = source
        self._members = members
        self._skip = skip
        self._line = 0
        self.size = 1

    def next(self) -> tuple[int, bytes] | None:
        """How many lines of the input stand before the next chunk, and its lines; None at the end."""
        while self._skip:
            line = self._source.readline()
            if not line:
                raise Failure(USAGE, "the output has more lines than the input has domains: it belongs to another input")
            self._line += 1
            self._skip -= bool(line.strip())
        first, total = self._line, 0
        lines: list[bytes] = []
        while len(lines) < self.size and total < CHUNK_BYTES and (line := self._source.readline()):
            self._line += 1
            lines.append(with_additions(line, self._members).rstrip(b"\r\n") + b"\n")
            total += len(line)
        return (first, b"".join(lines)) if lines else None

    def took(self, seconds: float, lines: int) -> None:
        """Learn from a chunk how large the next may be."""
        if lines:
            self.size = max(1, min(CHUNK_LINES, 2 * self.size, int(CHUNK_SECONDS * lines / max(seconds, 1e-6))))


async def _run(
    pool: Pool,
    told: dict[str, Any],
    chunks: Chunks,
    workers: int,
    folder: Path,
    out: files.LinesOut,
    tally: Tally,
    bar: tqdm[Any],
) -> None:
    """Keep the workers busy, and write what they answer in the order of the input."""
    this = asyncio.current_task()
    assert this is not None, "it is run as one"
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, this.cancel)
    under_way: deque[asyncio.Task[Results]] = deque()
    async with pool.running():
        await _loaded(pool, bar)
        try:
            more = True
            while True:
                while more and len(under_way) < AHEAD * workers:
                    chunk = await asyncio.to_thread(chunks.next)
                    more = chunk is not None
                    if chunk is not None:
                        under_way.append(asyncio.create_task(_results(pool, told, chunks, folder, *chunk)))
                if not under_way:
                    return
                results = await under_way.popleft()
                await asyncio.to_thread(out.add, results.content)
                tally.add(results)
                bar.update(results.written.lines)
                bar.set_postfix(failed=tally.failed.total(), refresh=False)
        finally:
            for task in under_way:
                task.cancel()
            await asyncio.gather(*under_way, return_exceptions=True)


async def _loaded(pool: Pool, bar: tqdm[Any]) -> None:
    """Wait until the workers can work, and say how far they are."""
    while not pool.ready:
        if pool.load_failed:
            raise Failure(FAILED, "the workers could not be loaded, see above")
        name, done, total = pool.progress
        bar.set_description(f"kernels {done}/{total}: {name}" if total else "loading")
        await asyncio.sleep(0.05)
    bar.set_description("")


async def _results(pool: Pool, told: dict[str, Any], chunks: Chunks, folder: Path, first: int, body: bytes) -> Results:
    """The result lines of a chunk."""
    begun = time.monotonic()
    written = folder / str(first)
    lines = Lines(told, body, written, first)
    try:
        await pool.solve_lines(lines)
    except Unwritten as error:
        raise Failure(FAILED, f"cannot write {written}: {error}; what is in the output can be resumed") from error
    content = await asyncio.to_thread(written.read_bytes)
    written.unlink()
    chunks.took(time.monotonic() - begun, lines.written.lines)
    return Results(content, lines.written)
