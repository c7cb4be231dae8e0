"""Processes that solve domains and can be killed: compiled loops stop for nothing else.

A worker is forked when the kernels are loaded, so a new one costs milliseconds. It answers twice when the oracle is asked:
first what the solution was worth, then what the oracle says.
"""

from __future__ import annotations

import contextlib
import math
import multiprocessing
import os
import signal
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, Protocol

from tests.hunt.judge import Outcome, compared, pieces, solved

Json = dict[str, Any]
ORACLE_LIMIT = 60.0  # seconds the oracle may take, at least


@dataclass
class Job:
    """A domain to be solved and what to do with the outcome.

    Parameters
    ----------
    name : str
        Family and seed.
    domain : dict
    oracle : bool
        Compare it with the oracle.
    purpose : object
        Whatever the owner wants back with the outcome.
    """

    name: str
    domain: Json
    oracle: bool = False
    purpose: Any = None


class Solver(Protocol):
    """Stands for `judge.solved`, so that tests can plant failures."""

    def __call__(self, domain: Json) -> tuple[Outcome, Json | None]: ...


def work(pipe: Connection, solver: Solver, parent: int) -> None:
    """The life of a worker; it ends with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with contextlib.suppress(EOFError, OSError):
        while True:
            while not pipe.poll(5.0):
                if os.getppid() != parent:
                    return
            domain, oracle = pipe.recv()
            outcome, answer = solver(domain)
            more = oracle and answer is not None
            pipe.send((outcome, more))
            if not more:
                continue
            assert answer is not None
            try:
                outcome = compared(domain, answer, outcome)
            except Exception as error:  # the oracle is a program, too
                outcome.text = f"the oracle gave up: {type(error).__name__}: {error}"
            pipe.send((outcome, False))


def processor_time(pid: int) -> float:
    """Seconds that a process was at work so far; NaN where the system does not tell."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError):
        return math.nan


@dataclass
class Worker:
    """One process and what it is doing."""

    solver: Solver
    job: Job | None = None
    until: float = 0.0
    worked: float = 0.0  # processor time when the job began
    first: Outcome | None = None  # of the solution, while the oracle is at work
    pipe: Connection = field(init=False)
    process: Any = field(init=False)

    def __post_init__(self) -> None:
        self.start()

    def start(self) -> None:
        """Fork."""
        context = multiprocessing.get_context("fork")
        self.pipe, child = context.Pipe()
        self.process = context.Process(target=work, args=(child, self.solver, os.getpid()), daemon=True)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # forking beside threads: numerical libraries have idle ones
            self.process.start()
        child.close()

    def stop(self) -> None:
        """Kill and wait."""
        self.process.kill()
        self.process.join()
        self.pipe.close()


class Team:
    """Workers with a time limit per domain, in seconds.

    Parameters
    ----------
    size : int
    limit : float
        Over it a worker is killed and the outcome is "slow".
    solver : Solver
    """

    def __init__(self, size: int, limit: float, solver: Solver = solved) -> None:
        self.limit = limit
        self.workers = [Worker(solver) for _ in range(size)]

    def idle(self) -> Worker | None:
        """A worker that waits for a job."""
        return next((w for w in self.workers if w.job is None), None)

    def busy(self) -> bool:
        """True while something is being solved."""
        return any(w.job is not None for w in self.workers)

    def give(self, worker: Worker, job: Job) -> None:
        """Begin a job."""
        worker.job, worker.first, worker.until = job, None, time.monotonic() + self.limit
        worker.worked = processor_time(worker.process.pid)
        worker.pipe.send((job.domain, job.oracle))

    def finished(self, timeout: float) -> Iterator[tuple[Job, Outcome]]:
        """The jobs that ended, after waiting so long (seconds) at most."""
        at_work = [w for w in self.workers if w.job is not None]
        until = min([time.monotonic() + timeout, *(w.until for w in at_work)])
        ready = wait([w.pipe for w in at_work], max(0.0, until - time.monotonic()))
        for worker in at_work:
            outcome = self._outcome(worker, worker.pipe in ready)
            if outcome is not None and worker.job is not None:
                job, worker.job = worker.job, None
                yield job, outcome

    def _outcome(self, worker: Worker, ready: bool) -> Outcome | None:
        """What a worker has to say, or None while it is at work."""
        assert worker.job is not None
        if ready:
            try:
                outcome, more = worker.pipe.recv()
            except (EOFError, OSError):
                worker.stop()
                size, code = pieces(worker.job.domain), worker.process.exitcode
                worker.start()
                return Outcome("failed", "worker died", f"the worker died with exit code {code}", pieces=size)
            if not more:
                return outcome
            worker.first, worker.until = outcome, time.monotonic() + max(ORACLE_LIMIT, self.limit)
        elif time.monotonic() > worker.until:
            worked = processor_time(worker.process.pid) - worker.worked
            worker.stop()
            worker.start()
            if worker.first is not None:
                worker.first.text = "the oracle was over its time limit"
                return worker.first
            # a hunt on a busy machine, or one that was asleep, says so: such a domain need not be slow
            text = f"over {self.limit:g} s, {worked:.1f} s of them at work"
            return Outcome("slow", "slow", text, 1e3 * self.limit, pieces=pieces(worker.job.domain))
        return None

    def stop(self) -> None:
        """End all workers."""
        for worker in self.workers:
            with contextlib.suppress(OSError):
                worker.stop()


