"""What is done with a chunk of a job: read its body, have the pool solve it, store what comes, end the job with its last chunk.

It may be done twice (a killed server, an executor that was thought dead), so every step can be repeated: files are named by
content, a chunk keeps its first result, and a job that is over stays what it is. While the store is away the work goes on, and
waits only to be recorded.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
import uuid
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import orjson

from service.errors import RequestError
from service.http.negotiation import Format
from service.jobs.blobs import Blobs
from service.jobs.calls import Calls
from service.jobs.port import Job, StoreUnavailable
from service.jobs.store import Chunk, Enqueue, Store
from service.orders import Order
from service.settings import Settings
from service.workers.chunks import Lines
from service.workers.pool import DeadlineExceeded, Pool, Reply, Unwritten, WorkerCrashed

PROGRESS_SECONDS = 0.5
"""Pause between two notes of a job's progress."""

CRASHES = 3
"""A job whose worker ends without an answer this often fails."""

STORING_SECONDS = 60.0
"""How long storing a result is tried, where the disk is full, say; then the job fails, honestly, as store-unavailable."""

STORING_PAUSE = 1.0
"""Between two attempts."""

READING_SECONDS = 10.0
"""How long the file of a body is waited for."""

MESSAGE_CHARACTERS = 300
"""Of a failure's detail in the status; the whole is in the results."""

P = ParamSpec("P")
T = TypeVar("T")

_log = logging.getLogger("service.jobs")


class Work:
    """The work of one process. `store` is set once it is open."""

    def __init__(self, settings: Settings, pool: Pool, blobs: Blobs, calls: Calls, enqueue: Enqueue) -> None:
        self._settings, self._pool, self._blobs, self._calls, self._enqueue = settings, pool, blobs, calls, enqueue
        self.store: Store | None = None

    async def __call__(self, job_id: str, number: int) -> None:
        """Work on one chunk. Cancelling the call kills the worker."""
        assert self.store is not None, "work comes from the store"
        begun = await self._calls.insist(self.store.begin, job_id, number)
        if begun is None:
            return
        job, chunk = begun
        try:
            if chunk.result is None:
                _log.debug("chunk %d of job %s is begun", number, job_id)
                await self._finish_chunk(self.store, job, chunk)
            await self._finish_job(self.store, job)
        except RequestError as error:
            await self._fail(self.store, job, error)
        except StoreUnavailable as error:
            failure = RequestError("store-unavailable", f"The results could not be stored: {error}.")
            await self._fail(self.store, job, failure)
        except Exception:
            _log.exception("job %s failed where it must not", job_id)
            await self._fail(self.store, job, RequestError("internal-error", "An unexpected failure, logged."))

    async def _finish_chunk(self, store: Store, job: Job, chunk: Chunk) -> None:
        """Compute a chunk's result, store it, and note it."""
        body = await self._read(chunk.body)
        written = self._blobs.incoming / uuid.uuid4().hex
        try:
            if job.batch:
                digest, failed = await self._solve_lines(job, chunk, body, written)
            else:
                digest, failed = None, 0
                await self._patiently(_write, written, (await self._solve(store, job, body)).pieces)
            digest = await self._patiently(self._blobs.adopt, written, digest)
            noted = await self._calls.insist(store.finish_chunk, job.id, chunk.number, digest, failed, self._enqueue)
            if not noted:  # the job is gone, or another executor was first
                with contextlib.suppress(StoreUnavailable):
                    await self._calls.ask_much(self._blobs.remove, [digest], store.referenced)
            elif not await self._patiently(self._blobs.has, digest):
                await self._patiently(self._blobs.adopt, written, digest)  # it was removed with a job that had the same result
        finally:
            written.unlink(missing_ok=True)

    async def _read(self, digest: str) -> bytes:
        """The body of a chunk, which a shared file system may show here a little later than where it was written."""
        end = time.monotonic() + READING_SECONDS
        while True:
            try:
                return await self._calls.file(self._blobs.read, digest)
            except StoreUnavailable as error:
                if time.monotonic() > end:
                    detail = "The body of the job cannot be read: all executors need the same MAT_DATA_DIR."
                    raise RequestError("internal-error", detail) from error
                await asyncio.sleep(1.0)

    async def _solve(self, store: Store, job: Job, body: bytes) -> Reply:
        """The pool's answer to the one request of a job."""
        notes = asyncio.Queue[tuple[str, float]]()
        noting = asyncio.create_task(self._note(store, job, notes))
        seconds = self._settings.job_deadline_seconds
        header = self._header(job)
        try:
            for crashes in range(1, CRASHES + 1):
                try:
                    reply = await self._pool.solve(
                        header, body, deadline_seconds=seconds, progress=lambda *note: notes.put_nowait(note), job=True
                    )
                    break
                except WorkerCrashed:
                    if crashes == CRASHES:
                        raise
        except DeadlineExceeded:
            raise RequestError("deadline-exceeded", f"The job took longer than {seconds:g} s and was stopped.") from None
        except WorkerCrashed:
            raise RequestError("worker-crashed", f"The work ended without an answer, {CRASHES} times.") from None
        finally:
            noting.cancel()
        if "error" in reply.header:
            raise RequestError(**reply.header["error"])
        return reply

    async def _note(self, store: Store, job: Job, notes: asyncio.Queue[tuple[str, float]]) -> None:
        """Write a worker's reports into the row, the latest only."""
        while True:
            stage, fraction = await notes.get()
            while not notes.empty():
                stage, fraction = notes.get_nowait()
            with contextlib.suppress(StoreUnavailable):
                await self._calls.ask(store.progress, job.id, int(99 * fraction), f"Being worked on: {stage}.")
            await asyncio.sleep(PROGRESS_SECONDS)

    async def _solve_lines(self, job: Job, chunk: Chunk, body: bytes, written: Path) -> tuple[str, int]:
        """Have the result lines of a chunk written; the digest of the file, and how many of them are problems."""
        lines = Lines(self._header(job), body, written, chunk.first)
        done, end = -1, 0.0
        while lines.digest is None:
            try:
                await self._pool.solve_lines(lines)
            except Unwritten as error:
                if lines.written.lines > done:
                    done, end = lines.written.lines, time.monotonic() + STORING_SECONDS
                elif time.monotonic() > end:
                    raise StoreUnavailable(str(error)) from error
                await asyncio.sleep(STORING_PAUSE)
        return lines.digest, lines.written.failed

    def _header(self, job: Job) -> dict[str, Any]:
        order = Order(job.operation, cast("Format", job.format), job.options)
        return {**order.header(self._settings), "ids": {"job_id": job.id}}

    async def _patiently(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """The value of a call that stores a result, made again while it fails, for a while."""
        end = time.monotonic() + STORING_SECONDS
        while True:
            try:
                return await self._calls.file(function, *args, **kwargs)
            except StoreUnavailable:
                if time.monotonic() > end:
                    raise
                await asyncio.sleep(STORING_PAUSE)

    async def _finish_job(self, store: Store, job: Job) -> None:
        """Note the progress of a batch, and the end of a job when this was its last chunk."""
        chunks, finished, domains, failed = await self._calls.insist(store.tally, job.id)
        if chunks:
            told = f"{finished} of {domains} domains are finished."
            await self._calls.insist(store.progress, job.id, 99 * finished // max(domains, 1), told)
            return
        told = f"{domains} domains, {failed} of them failed." if job.batch else "Finished."
        await self._calls.insist(store.finish, job.id, "successful", told)

    async def _fail(self, store: Store, job: Job, error: RequestError) -> None:
        """End a job with the reason."""
        content = orjson.dumps({"code": error.code, "detail": error.detail, "extra": error.extra})
        try:
            digest = await self._patiently(self._blobs.put, content)
        except StoreUnavailable:
            digest = None  # the message says what can be said
        message = f"{error.code}: {error.detail}"[:MESSAGE_CHARACTERS]
        await self._calls.insist(store.finish, job.id, "failed", message, digest)
        if digest is not None and not self._blobs.has(digest):
            await self._patiently(self._blobs.put, content)


def _write(file: Path, pieces: Sequence[bytes]) -> None:
    """Write a file, whatever an attempt before left of it."""
    with file.open("wb") as opened:
        opened.writelines(pieces)
