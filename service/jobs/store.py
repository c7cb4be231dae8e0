"""Rows of jobs: every question and every change is one function and one transaction.

A job and its chunks are written together with their DBOS workflows, so either all of it is accepted or nothing. A job ends by
an UPDATE that applies only while it is unfinished: whoever comes second (an executor that was thought dead, say) changes nothing.

Everything here blocks; it is called in threads.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa

from service.jobs.port import UNFINISHED, Job, State, StoreUnavailable
from service.jobs.tables import CHUNKS, JOBS, LEASES, METADATA
from service.orders import Order

SLICE = 500
"""Values in one IN list."""

CHUNKS_AHEAD = 64
"""Chunks of one batch that wait or are worked on at a time; each that is finished brings the next. More would only make a
small job wait behind a large batch, and the request that makes a large batch slow."""

Enqueue = Callable[[sa.Connection, str, int], None]
"""Makes the workflow of a job's chunk, as a part of a transaction."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """A part of a job: one body to be worked on at a time; a job that is no batch has one."""

    number: int
    first: int
    domains: int
    body: str
    result: str | None = None


@dataclass(frozen=True, slots=True)
class NewJob:
    """What is known of a job before it is stored."""

    id: str
    order: Order
    fingerprint: str
    key: str | None
    owner: str | None
    batch: bool
    chunks: Sequence[Chunk]


class Store:
    """The rows behind `engine`."""

    def __init__(self, engine: sa.Engine) -> None:
        self.engine = engine
        self._sqlite = engine.dialect.name == "sqlite"

    def create_tables(self) -> None:
        """Make what is missing; two machines may try at once."""
        with self.engine.begin() as c:
            if not self._sqlite:
                c.execute(sa.select(sa.func.pg_advisory_xact_lock(_LOCK)))
            METADATA.create_all(c)
            there = {table: {column["name"] for column in sa.inspect(c).get_columns(table)} for table in METADATA.tables}
        for name, table in METADATA.tables.items():
            if missing := {column.name for column in table.columns} - there[name]:
                raise StoreUnavailable(f"table {name} was made by another version of the service: it has no {missing}")

    def now(self) -> sa.ColumnElement[float]:
        """The time by the clock that all executors share."""
        if self._sqlite:
            return sa.literal(time.time())
        return sa.cast(sa.func.extract("epoch", sa.func.clock_timestamp()), sa.Float)

    # jobs

    def insert(self, new: NewJob, enqueue: Enqueue) -> Job:
        """Write a job, its chunks and its first workflows. IntegrityError when its key is taken."""
        with self.engine.begin() as c:
            now = self.now()
            given = {name: getattr(new, name) for name in ("id", "key", "fingerprint", "batch")}
            given |= {"operation": new.order.operation, "format": new.order.form, "options": dict(new.order.options)}
            begun = {"state": "accepted", "progress": 0, "message": "Waiting for a worker.", "created": now, "updated": now}
            row = c.execute(sa.insert(JOBS).values(**given, **begun, owner=new.owner or "").returning(JOBS)).one()
            rows = [
                {"job": new.id, "number": k.number, "first": k.first, "domains": k.domains, "body": k.body}
                for k in new.chunks
            ]
            c.execute(sa.insert(CHUNKS), rows)
            for chunk in new.chunks[:CHUNKS_AHEAD]:
                enqueue(c, new.id, chunk.number)
        return _job(row)

    def get(self, job_id: str) -> Job | None:
        """A job by its id."""
        with self.engine.connect() as c:
            row = c.execute(sa.select(JOBS).where(JOBS.c.id == job_id)).one_or_none()
        return None if row is None else _job(row)

    def by_key(self, owner: str | None, key: str) -> tuple[Job, str] | None:
        """The job made with an Idempotency-Key, and its fingerprint."""
        mine = (JOBS.c.owner == (owner or "")) & (JOBS.c.key == key)
        with self.engine.connect() as c:
            row = c.execute(sa.select(JOBS).where(mine)).one_or_none()
        return None if row is None else (_job(row), row.fingerprint)

    def page(self, limit: int, after: tuple[float, str] | None, owner: str | None) -> tuple[list[Job], tuple[float, str] | None]:
        """Some jobs of an owner, newest first, and where the next page begins."""
        query = sa.select(JOBS).where(JOBS.c.owner == (owner or ""))
        if after is not None:
            query = query.where(sa.tuple_(JOBS.c.created, JOBS.c.id) < sa.tuple_(*map(sa.literal, after)))
        with self.engine.connect() as c:
            rows = c.execute(query.order_by(JOBS.c.created.desc(), JOBS.c.id.desc()).limit(limit + 1)).all()
        last = rows[limit - 1] if len(rows) > limit else None
        return [_job(row) for row in rows[:limit]], None if last is None else (last.created, last.id)

    def begin(self, job_id: str, number: int) -> tuple[Job, Chunk] | None:
        """Note that a job is being worked on, and hand out one of its chunks; None when it need not be.

        One transaction, so that work which is noted as begun needs nothing more of the database until it is done.
        """
        now = self.now()
        started = sa.func.coalesce(JOBS.c.started, now)
        message = sa.case((JOBS.c.state == "accepted", "Being worked on."), else_=JOBS.c.message)
        change = {"state": "running", "started": started, "updated": now, "message": message}
        with self.engine.begin() as c:
            job = _change(c, job_id, change)
            return None if job is None else (job, _chunk(c, job_id, number))

    def progress(self, job_id: str, percent: int, message: str) -> None:
        """Note how far a job has come; it never goes back."""
        higher = sa.case((JOBS.c.progress > percent, JOBS.c.progress), else_=percent)
        with self.engine.begin() as c:
            _change(c, job_id, {"progress": higher, "updated": self.now(), "message": message})

    def finish(self, job_id: str, state: State, message: str, failure: str | None = None) -> Job | None:
        """End a job; None when it was over already, and stays what it is."""
        now = self.now()
        done = {"progress": 100} if state == "successful" else {}
        change = {"state": state, "updated": now, "finished": now, "message": message, "failure": failure, **done}
        with self.engine.begin() as c:
            return _change(c, job_id, change)

    def over(self, job_ids: Iterable[str]) -> set[str]:
        """Those of some jobs that are over or gone."""
        asked = set(job_ids)
        unfinished = JOBS.c.id.in_(asked) & JOBS.c.state.in_(UNFINISHED)
        with self.engine.connect() as c:
            return asked - set(c.execute(sa.select(JOBS.c.id).where(unfinished)).scalars())

    def expired(self, retention_seconds: float, limit: int) -> list[Job]:
        """Some jobs that were over a while ago."""
        old = JOBS.c.finished < self.now() - retention_seconds
        with self.engine.connect() as c:
            return [_job(row) for row in c.execute(sa.select(JOBS).where(old).limit(limit))]

    def untouched(self, seconds: float, limit: int) -> list[Job]:
        """Some unfinished jobs whose row has not changed for a while."""
        quiet = JOBS.c.state.in_(UNFINISHED) & (JOBS.c.updated < self.now() - seconds)
        with self.engine.connect() as c:
            return [_job(row) for row in c.execute(sa.select(JOBS).where(quiet).limit(limit))]

    def delete(self, job_id: str) -> set[str]:
        """Delete a job's rows; the digests they named."""
        with self.engine.begin() as c:
            chunks = c.execute(sa.select(CHUNKS.c.body, CHUNKS.c.result).where(CHUNKS.c.job == job_id)).all()
            failures = c.execute(sa.delete(JOBS).where(JOBS.c.id == job_id).returning(JOBS.c.failure)).scalars().all()
        named = {digest for row in chunks for digest in row} | set(failures)
        return {digest for digest in named if digest is not None}

    def counts(self) -> dict[str, int]:
        """How many jobs there are in each state."""
        with self.engine.connect() as c:
            rows = c.execute(sa.select(JOBS.c.state, sa.func.count()).group_by(JOBS.c.state)).all()
        return {row[0]: row[1] for row in rows}

    def failure(self, job_id: str) -> str | None:
        """The digest of why a job failed."""
        with self.engine.connect() as c:
            return c.execute(sa.select(JOBS.c.failure).where(JOBS.c.id == job_id)).scalar_one_or_none()

    # chunks

    def chunks(self, job_id: str) -> list[Chunk]:
        """The chunks of a job, in order."""
        with self.engine.connect() as c:
            return [Chunk(*row) for row in c.execute(_CHUNK.where(CHUNKS.c.job == job_id).order_by(CHUNKS.c.number))]

    def finish_chunk(self, job_id: str, number: int, result: str, failed: int, enqueue: Enqueue) -> bool:
        """Note a chunk's result, and enqueue the chunk that is next in its row. False where there is a result, or no chunk."""
        mine = (CHUNKS.c.job == job_id) & (CHUNKS.c.number == number) & CHUNKS.c.result.is_(None)
        later = (CHUNKS.c.job == job_id) & (CHUNKS.c.number == number + CHUNKS_AHEAD)
        with self.engine.begin() as c:
            changed = c.execute(sa.update(CHUNKS).where(mine).values(result=result, failed=failed)).rowcount
            if changed and c.execute(sa.select(CHUNKS.c.number).where(later)).one_or_none() is not None:
                enqueue(c, job_id, number + CHUNKS_AHEAD)
        return bool(changed)

    def tally(self, job_id: str) -> tuple[int, int, int, int]:
        """Of a job: chunks that are not finished; domains finished, in all, and failed."""
        done = CHUNKS.c.result.is_not(None)
        sums = (
            sa.func.sum(sa.case((done, 0), else_=1)),
            sa.func.sum(sa.case((done, CHUNKS.c.domains), else_=0)),
            sa.func.sum(CHUNKS.c.domains),
            sa.func.coalesce(sa.func.sum(CHUNKS.c.failed), 0),
        )
        with self.engine.connect() as c:
            chunks, finished, domains, failed = c.execute(sa.select(*sums).where(CHUNKS.c.job == job_id)).one()
        return int(chunks or 0), int(finished or 0), int(domains or 0), int(failed)

    def referenced(self, digests: set[str]) -> set[str]:
        """Those of some digests that rows name."""
        columns = (CHUNKS.c.body, CHUNKS.c.result, JOBS.c.failure)
        found: set[str] = set()
        asked = sorted(digests)
        with self.engine.connect() as c:
            for k in range(0, len(asked), SLICE):
                some = asked[k : k + SLICE]
                for column in columns:
                    found.update(c.execute(sa.select(column).where(column.in_(some)).distinct()).scalars())
        return found

    # leases

    def renew(self, executor: str, seconds: float) -> None:
        """Say that an executor lives, until so many seconds from now."""
        expires = self.now() + seconds
        with self.engine.begin() as c:
            changed = c.execute(sa.update(LEASES).where(LEASES.c.executor == executor).values(expires=expires))
            if changed.rowcount == 0:
                c.execute(sa.insert(LEASES).values(executor=executor, expires=expires))

    def take_expired(self, seconds: float) -> str | None:
        """An executor whose lease has run out; its lease is renewed on behalf of the caller, who sees to its jobs alone."""
        ran_out = LEASES.c.expires < self.now()
        with self.engine.begin() as c:
            for executor in c.execute(sa.select(LEASES.c.executor).where(ran_out)).scalars().all():
                taken = sa.update(LEASES).where((LEASES.c.executor == executor) & ran_out)
                if c.execute(taken.values(expires=self.now() + seconds)).rowcount:
                    return str(executor)
        return None

    def release(self, executor: str) -> None:
        """Drop a lease."""
        with self.engine.begin() as c:
            c.execute(sa.delete(LEASES).where(LEASES.c.executor == executor))


_CHUNK = sa.select(CHUNKS.c.number, CHUNKS.c.first, CHUNKS.c.domains, CHUNKS.c.body, CHUNKS.c.result)

_LOCK = 0x6D61745F
"""Any number, the same on all machines: the lock under which tables are made ("mat_")."""


def _change(c: sa.Connection, job_id: str, values: dict[str, Any]) -> Job | None:
    """Change a job that is not over; None when it is."""
    mine = (JOBS.c.id == job_id) & JOBS.c.state.in_(UNFINISHED)
    row = c.execute(sa.update(JOBS).where(mine).values(values).returning(JOBS)).one_or_none()
    return None if row is None else _job(row)


def _chunk(c: sa.Connection, job_id: str, number: int) -> Chunk:
    return Chunk(*c.execute(_CHUNK.where(CHUNKS.c.job == job_id, CHUNKS.c.number == number)).one())


def _job(row: Any) -> Job:
    names = ("id", "operation", "format", "state", "progress", "message", "batch", "options")
    given: dict[str, Any] = {name: getattr(row, name) for name in names}
    given |= {name: _time(getattr(row, name)) for name in ("created", "started", "updated", "finished")}
    return Job(**given, owner=row.owner or None)


def _time(seconds: float | None) -> datetime | None:
    return None if seconds is None else datetime.fromtimestamp(seconds, UTC)
