"""A chunk of a batch on its way through workers: which lines are done, and whose fault it is when a worker ends.

A worker writes results into a file (`service.workers.result_lines`), and says now and then that it is alive; so a domain costs
this process nothing. When a worker ends without having said how it went, the file tells how far it came: the first line without
a result is the one that it was at.
"""

from __future__ import annotations

import asyncio
import contextlib
from pathlib import Path
from typing import Any

from service.errors import RequestError
from service.workers import wire
from service.workers.channel import Channel, ChannelClosed
from service.workers.crew import Reason
from service.workers.result_lines import NOTE_SECONDS, Written, whole

ATTEMPTS = 2
"""Workers that a line may end before it is held to be its fault: a worker may also be ended from outside."""


class Lines:
    """The lines of a chunk, and how far they are answered.

    Parameters
    ----------
    header : dict
        What is to be done with each; see `service.workers.solve.handle_lines`. Its format must be one without newlines.
    body : bytes
        JSON lines.
    results : Path
        The file of the result lines, made if it is not there.
    first : int
        The number of lines of the batch before this chunk; problem documents name the line of the batch, counted from 1.

    Attributes
    ----------
    written : Written
        What is in the file.
    digest : str or None
        SHA-256 of the file, once every line has its result.
    unwritten : str or None
        Why the last worker could not write a line.
    unused : bool
        The next line wants a worker that has not worked before.
    resident_bytes, served : int
        What the last worker said about itself.
    """

    def __init__(self, header: wire.Header, body: bytes, results: Path, first: int = 0) -> None:
        self._header, self._body, self._first = header, body, first
        self._results = results.absolute()
        self._tried = 0  # workers that ended at the first line without a result
        self._given_up: tuple[int, RequestError] | None = None  # how many results stand before it, and why
        self.written = Written()
        self.digest: str | None = None
        self.unwritten: str | None = None
        self.unused = False
        self.resident_bytes = self.served = 0

    async def work(self, channel: Channel, seconds: float) -> Reason | None:
        """Hand the rest to a worker, which may use so many seconds for each line.

        Returns
        -------
        str or None
            Why it must be ended; None when it may be used again.
        """
        self.unused = False
        header, rest = self._rest()
        await channel.send({**self._header, **header}, rest)
        while True:
            try:
                async with asyncio.timeout(seconds + NOTE_SECONDS):
                    answer, _ = await channel.receive()
            except TimeoutError:
                if channel.pending:  # this process was busy meanwhile
                    continue
                return "deadline"
            except ChannelClosed:
                return "crash"
            if "resident_bytes" in answer:
                return self._take(answer)

    async def find_out(self, channel: Channel, reason: Reason, seconds: float) -> None:
        """Wait for the end of a worker that did not come to its own, and see what it leaves.

        Parameters
        ----------
        channel : Channel
            Still open, if the worker was told to end.
        reason : str
            deadline or crash.
        seconds : float
            The deadline.
        """
        alive = False  # when it was thought to hang
        with contextlib.suppress(ChannelClosed):
            while True:
                await channel.receive()
                alive = True
        before, self.written = self.written, await asyncio.to_thread(whole, self._results)
        if reason == "deadline":
            if not alive:
                self._give_up("deadline-exceeded", f"It took longer than {seconds:g} s and was stopped.")
            return
        self._tried = self._tried + 1 if self.written.lines == before.lines else 1
        if self._tried == ATTEMPTS:
            self._give_up("worker-crashed", "The process that worked on it ended, and so did the next one.")

    def _take(self, answer: wire.Header) -> Reason | None:
        """Note how it went for a worker that says so."""
        self.resident_bytes, self.served = answer["resident_bytes"], answer["served"]
        self.written = Written(**answer["written"])
        self.digest, self.unwritten = answer.get("digest"), answer.get("unwritten")
        self.unused = bool(answer.get("again"))
        self._tried = 0
        return "memory" if self.unused else None

    def _rest(self) -> tuple[wire.Header, bytes]:
        """What a worker has to know, and the lines without a result."""
        done = self.written
        header: dict[str, Any] = {
            "results": str(self._results),
            "kept": {"size": done.size, "lines": done.lines, "failed": done.failed},
            "first": self._first,
        }
        if not done.lines and self._given_up is None:
            return header, self._body
        lines = self._body.split(b"\n")
        left = [place for place, line in enumerate(lines) if line.strip()][done.lines :]
        begin = left[0] if left else len(lines)
        if left and self._given_up is not None and self._given_up[0] == done.lines:
            error = self._given_up[1]
            begin += 1
            error.extra["line"] = self._first + begin
            header["instead"] = error.document()
        return header | {"first": self._first + begin}, b"\n".join(lines[begin:])

    def _give_up(self, code: str, detail: str) -> None:
        """Let the next worker write a problem as the result of the line that is next."""
        self._tried = 0
        self._given_up = self.written.lines, RequestError(code, detail)
