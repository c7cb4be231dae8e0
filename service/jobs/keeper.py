"""Keeps the job store open, the executor running and the shelves clean.

The store is opened beside the service, never before it: while the database is away or the folder cannot be written, the
service answers everything else. DBOS (a second of imports) is loaded when the store is opened.
"""

from __future__ import annotations

import asyncio
import contextlib
import gc
import importlib
import logging
import socket
import threading
from collections.abc import AsyncIterator
from typing import TYPE_CHECKING, Any

from service.jobs.blobs import Blobs
from service.jobs.calls import Calls, first_line
from service.jobs.engine import completed, engine_for
from service.jobs.leases import LEASE_SECONDS, RENEW_SECONDS, Reaper, Slot
from service.jobs.port import StoreUnavailable
from service.jobs.store import SLICE, Store
from service.jobs.work import Work
from service.settings import Settings
from service.tasks import end, in_own_thread
from service.workers.pool import Pool

if TYPE_CHECKING:
    from dbos import DBOSClient

    from service.jobs.executor import Executor

OPEN_SECONDS = 1.0
"""Pause before opening a store that could not be opened is tried again."""

CLOSING_SECONDS = 8.0
"""Longest time for handing back what is not finished, a second where the database answers. What could not be handed back by
then is begun anew at the next start, or elsewhere once this executor's lease has run out."""

WATCH_SECONDS = 0.15
"""Pause between two looks at whether jobs that run here were dismissed elsewhere."""

SWEEP_SECONDS = 30.0
"""Longest pause between two removals of what has been kept long enough."""

SWEEP_JOBS = 200
"""Jobs removed at a time."""

STRAY_SWEEPS = 120
"""Of so many sweeps, one goes through all files."""

STRANDED_SECONDS = 120.0
"""An unfinished job whose row was not touched for this long is looked up in DBOS, which may have given it up."""

_log = logging.getLogger("service.jobs")


class Keeper:
    """What stands behind the jobs of one process.

    Attributes
    ----------
    blobs : Blobs
        The files.
    calls : Calls
        The way to rows and files from the event loop.
    """

    def __init__(self, settings: Settings, pool: Pool) -> None:
        self._settings = settings
        self.blobs = Blobs(settings.data_dir)
        self.calls = Calls()
        self._work = Work(settings, pool, self.blobs, self.calls, self.enqueue)
        self._url = completed(settings.database_url or f"sqlite:///{settings.data_dir.absolute() / 'jobs.sqlite'}")
        self._opening = threading.Lock()
        self._closed = False
        self._store: Store | None = None
        self._client: DBOSClient | None = None
        self._executor: Executor | None = None
        self._slot: Slot | None = None
        self._reaper: Reaper | None = None

    @property
    def ready(self) -> bool:
        """True when the store is open and answered last time."""
        return self._store is not None and self.calls.up

    def open_store(self) -> Store:
        """The store. StoreUnavailable while it is not open."""
        if self._store is None:
            raise StoreUnavailable("the job store could not be opened yet")
        return self._store

    def enqueue(self, connection: Any, job_id: str, number: int) -> None:
        """Make the workflow of a chunk, as a part of a transaction."""
        _dbos().enqueue(self._client, connection, job_id, number)

    def wake(self) -> None:
        """Have what was enqueued begin at once, where this process runs jobs."""
        if self._executor is not None:
            self._executor.wake()

    async def cancel(self, job_id: str) -> None:
        """Stop the work on a job, here at once, elsewhere within moments, and take what waits out of the queue."""
        if self._executor is not None:
            self._executor.cancel(job_id)
        await self.calls.ask_much(self._cancel_workflows, job_id)

    async def remove(self, job_id: str) -> None:
        """Remove a job that is over, its workflows, and its files unless another job has the same."""
        await self.calls.ask_much(self._remove, job_id)

    @contextlib.asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Keep everything going for the duration, then hand back what is not finished."""
        tasks = [asyncio.create_task(self._keep()), asyncio.create_task(self._watch())]
        try:
            yield
        finally:
            await end(*tasks)
            await self._close_in_time()

    # the life of the store

    async def _keep(self) -> None:
        """Open the store as soon as that is possible, then renew the lease, look for dead executors, and sweep."""
        told = ""
        while self._store is None:
            try:
                await in_own_thread(self._open, asyncio.get_running_loop())
            except Exception as error:
                if (reason := first_line(error)) != told:
                    _log.error("the job store cannot be opened, which is tried again and again: %s", reason)
                    told = reason
                await asyncio.sleep(OPEN_SECONDS)
        gc.freeze()  # what was loaded stays: a full collection that goes through it holds up everything for a tenth of a second
        sweeps = beats = 0
        pause = min(SWEEP_SECONDS, max(RENEW_SECONDS, self._settings.job_retention_seconds / 2))
        while True:
            try:
                await self.calls.ask(self._beat)
                if beats * RENEW_SECONDS >= pause:
                    beats = 0
                    await self._sweep(strays=sweeps % STRAY_SWEEPS == 0)
                    sweeps += 1
            except StoreUnavailable:
                pass  # said once, by the calls
            except Exception:  # without its lease this executor would be taken for dead
                _log.exception("keeping the job store failed where it must not")
            beats += 1
            await asyncio.sleep(RENEW_SECONDS)

    def _open(self, loop: asyncio.AbstractEventLoop) -> None:
        """Folders, tables, and DBOS where this process runs jobs."""
        with self._opening:  # the service may be told to end meanwhile
            if not self._closed:
                self._open_all(loop)

    def _open_all(self, loop: asyncio.AbstractEventLoop) -> None:
        self.blobs.open()
        dbos = _dbos()
        engine = engine_for(self._url)
        try:
            engine.connect().close()  # to fail within moments where the database is away; DBOS would wait
            dbos.migrate(self._url)
            store = Store(engine)
            store.create_tables()
            self._client = dbos.client_for(engine)
            self._work.store = store
            if self._settings.role != "api":
                self._launch(dbos, store, loop)
        except BaseException:
            engine.dispose()
            if self._slot is not None:
                self._slot.release()
                self._slot = None
            raise
        self._store = store

    def _launch(self, dbos: Any, store: Store, loop: asyncio.AbstractEventLoop) -> None:
        """Start to run jobs, under a name that no living executor has."""
        settings = self._settings
        self._slot = Slot(settings.data_dir / "executors", settings.executor_id or socket.gethostname())
        name = self._slot.name
        store.renew(name, LEASE_SECONDS)
        executor = dbos.Executor(self._url, name, settings.role, settings.workers, self._work, loop)
        executor.launch()
        self._reaper = Reaper(store, name, lambda dead: dbos.resume(self._client, dead))
        self._executor = executor
        _log.info("jobs are run here under the name %s", name)

    def _beat(self) -> None:
        store = self.open_store()
        if self._reaper is not None:
            self._reaper.beat()
        else:
            store.engine.connect().close()

    async def _close_in_time(self) -> None:
        """Close, unless that hangs."""
        try:
            async with asyncio.timeout(CLOSING_SECONDS):
                await in_own_thread(self._close)
        except TimeoutError:
            _log.error("jobs could not be handed back within %g s; they go on at the next start", CLOSING_SECONDS)

    def _close(self) -> None:
        """Hand back what is not finished, and leave nothing open."""
        with self._opening:
            self._closed = True
        try:
            if self._executor is not None:
                self._executor.stop(self._client)
            if self._slot is not None and self._store is not None:
                self._store.release(self._slot.name)
        except Exception as error:
            _log.error("jobs could not be handed back; they go on at the next start: %s", first_line(error))
        finally:
            if self._slot is not None:
                self._slot.release()
            if self._client is not None:
                self._client.destroy()
            if self._store is not None:
                self._store.engine.dispose()
            self._store = self._executor = self._client = self._slot = None
            self.calls.close()

    # what runs beside it

    async def _watch(self) -> None:
        """Stop work on jobs that were dismissed in another process."""
        while True:
            await asyncio.sleep(WATCH_SECONDS)
            if self._executor is None or self._store is None or not (here := self._executor.jobs()):
                continue
            try:
                for job_id in await self.calls.ask(self._store.over, here):
                    self._executor.cancel(job_id)
            except StoreUnavailable:
                pass  # said once, by the calls
            except Exception:
                _log.exception("looking for dismissed jobs failed where it must not")

    async def _sweep(self, strays: bool) -> None:
        """Remove what was kept long enough; end what DBOS has given up; look for files that nobody names."""
        store = self.open_store()
        while old := await self.calls.ask(store.expired, self._settings.job_retention_seconds, SWEEP_JOBS):
            for job in old:
                await self.remove(job.id)
        for job in await self.calls.ask(store.untouched, STRANDED_SECONDS, SWEEP_JOBS):
            if await self.calls.ask(self._given_up, job.id):
                await self.calls.ask(store.finish, job.id, "failed", "internal-error: begun too often, never ended.")
        if strays:
            await self.calls.ask_long(self.blobs.sweep, store.referenced)

    def _workflows(self, job_id: str, **more: Any) -> list[Any]:
        assert self._client is not None, "there is a store"
        return self._client.list_workflows(workflow_id_prefix=f"{job_id}-", load_input=False, load_output=False, **more)

    def _given_up(self, job_id: str) -> bool:
        """Whether DBOS will not begin any of a job's workflows again."""
        return bool(self._workflows(job_id, status=["ERROR", "CANCELLED", "MAX_RECOVERY_ATTEMPTS_EXCEEDED"]))

    def _cancel_workflows(self, job_id: str) -> None:
        waiting = [status.workflow_id for status in self._workflows(job_id, status=["ENQUEUED", "PENDING"])]
        if waiting and self._client is not None:
            self._client.cancel_workflows(waiting)  # no more than are enqueued ahead

    def _remove(self, job_id: str) -> None:
        store = self.open_store()
        digests = store.delete(job_id)
        workflows = [status.workflow_id for status in self._workflows(job_id)]
        for k in range(0, len(workflows), SLICE):
            assert self._client is not None, "there is a store"
            self._client.delete_workflows(workflows[k : k + SLICE])
        self.blobs.remove(digests, store.referenced)


def _dbos() -> Any:
    """The module that imports DBOS, which takes a second; the service starts without waiting for it."""
    return importlib.import_module("service.jobs.executor")
