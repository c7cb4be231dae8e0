"""What the routes know of jobs: a record, the ways to refuse, and a Protocol. Nothing here knows a database or DBOS.

::

    accepted ──> running ──> successful          a job is accepted once its row is on disk; it ends exactly once
        │           │   └──> failed
        └───────────┴──────> dismissed
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any, Literal, Protocol

from service.orders import Order

State = Literal["accepted", "running", "successful", "failed", "dismissed"]

UNFINISHED: tuple[State, ...] = ("accepted", "running")


@dataclass(frozen=True, slots=True)
class Job:
    """One job as its owner sees it.

    Attributes
    ----------
    id : str
        Part of its address; random, so that it cannot be guessed.
    operation, format : str
        What is done with the domain, and what the results are encoded in.
    state : str
        One of `State`.
    created, started, updated, finished : datetime or None
        In UTC; None where it has not happened.
    progress : int
        0 to 100.
    message : str
        For people: what happens, or why it failed.
    owner : str or None
        The name of the key that made it; None where no keys are in force.
    batch : bool
        True when the results are lines, one a domain.
    options : mapping
        What else was asked for, see `service.orders.Order`.
    """

    id: str
    operation: str
    format: str
    state: State
    created: datetime
    started: datetime | None
    updated: datetime
    finished: datetime | None
    progress: int
    message: str
    owner: str | None
    batch: bool = False
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def over(self) -> bool:
        """True when nothing will change any more."""
        return self.state not in UNFINISHED


@dataclass(frozen=True, slots=True)
class Results:
    """The results of a job: how many bytes, the name of their content, and they themselves, to be read once."""

    size: int
    digest: str
    pieces: AsyncIterator[bytes]


class JobsError(Exception):
    """A job was not made, or not found as it should be; its class says why."""


class KeyReused(JobsError):
    """The Idempotency-Key belongs to a job that was made from another request."""


class KeyInFlight(JobsError):
    """A request with this Idempotency-Key is being received just now."""


class StoreUnavailable(JobsError):
    """Rows or files cannot be read or written now. A change that the store did not answer in time may still be made."""


class ResultsGone(JobsError):
    """The results were removed."""


class BatchRefused(JobsError):
    """The lines of a batch cannot be taken; `code` is one of `service.errors`, `line` counts from 1."""

    def __init__(self, code: str, detail: str, line: int) -> None:
        super().__init__(detail)
        self.code, self.detail, self.line = code, detail, line


class Jobs(Protocol):
    """Everything that routes, health checks and metrics ask of jobs. Any call may raise `StoreUnavailable`."""

    def running(self) -> AbstractAsyncContextManager[Jobs]:
        """Keep the store open, and run jobs where the role says so; starting never waits for the store."""
        ...

    async def submit(self, order: Order, body: bytes, key: str | None, owner: str | None) -> Job:
        """Make a job of one request; when this returns, the job is on disk. Raises `KeyReused`, `KeyInFlight`."""
        ...

    async def submit_batch(self, order: Order, body: AsyncIterator[bytes], key: str | None, owner: str | None) -> Job:
        """Make a job of many domains, one a line. Raises `KeyReused`, `KeyInFlight`, `BatchRefused`."""
        ...

    async def get(self, job_id: str, owner: str | None) -> Job | None:
        """The job, or None when there is none that this owner may see."""
        ...

    async def list(self, limit: int, after: str | None, owner: str | None) -> tuple[list[Job], str | None]:
        """The owner's jobs, newest first, and the token of the page that follows. ValueError for a bad token."""
        ...

    async def results(self, job: Job) -> Results:
        """What a successful job has computed. Raises `ResultsGone`."""
        ...

    async def failure(self, job: Job) -> dict[str, Any]:
        """Why a job failed: code, detail and extra of a `service.errors.RequestError`."""
        ...

    async def dismiss(self, job: Job) -> Job:
        """Stop a job that is not over, and free its processor; remove one that is over, with its files."""
        ...

    async def ready(self) -> bool:
        """Whether jobs can be made now."""
        ...

    async def counts(self) -> dict[str, int]:
        """How many jobs there are in each state."""
        ...
