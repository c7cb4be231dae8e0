"""DBOS in this process: it hands out what is enqueued, remembers who has what, and gives it back after a crash.

A workflow is a chunk of a job (a job that is no batch has one). DBOS sees ids and numbers only; what is to be done with them is a
coroutine of the event loop, where the pool is. A workflow that ends normally is finished; one whose process dies is given to
the next executor of the same name, or resumed by another (`service.jobs.leases`); one that is handed back at shutdown waits in
the queue again.

DBOS is one a process: a second application in the same process has no executor until the first has stopped. Nothing is sent
anywhere: no conductor, no telemetry; its log lines go to the log of the service.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import logging
import threading
import time
import uuid
from collections.abc import Callable, Coroutine
from typing import Any

import sqlalchemy as sa
from dbos import DBOS, DBOSClient, DBOSConfig
from dbos import error as dbos_error
from dbos._core import execute_dequeued_workflow

from service.jobs.port import StoreUnavailable

APPLICATION = "mat-jobs"
QUEUE = "mat-chunks"
WORKFLOW = "work"
VERSION = "1"
"""Of what a workflow means. Left alone by releases, so that a new one goes on with the jobs of the last."""

POLL_SECONDS = {"all": 0.5, "worker": 0.05}
"""By role. A poll costs 2 to 5 ms. Jobs made in this process are started at once (`wake`), so it may look rarely; one that
works for others looks often."""

MAX_ATTEMPTS = 100
"""A job that was begun this often and never ended is one that brings the server down; DBOS then gives it up."""

BEYOND_WORKERS = 1
"""Workflows begun beyond the number of workers, so that none is idle while the next is being fetched."""

QUIET_SECONDS = 10.0
"""A complaint of DBOS that comes again within this time is left out; while the database is away they come with each poll."""

_one_a_process = threading.Lock()


class HandedBack(BaseException):
    """A workflow ends without an outcome: DBOS records nothing, and it can be begun anew. (It records any `Exception`.)"""


def client_for(engine: sa.Engine) -> DBOSClient:
    """What enqueues and cancels, in transactions of `engine`; it runs nothing."""
    return DBOSClient(
        system_database_engine=engine, application_name=APPLICATION, lazy=True, retry_connection_errors=False
    )


def migrate(url: str) -> None:
    """Make or update DBOS's own tables."""
    _log_to_ours()
    DBOS.migrate(url)


def workflow_id(job_id: str, number: int) -> str:
    """The name of a chunk in DBOS."""
    return f"{job_id}-{number}"


def enqueue(client: DBOSClient, connection: sa.Connection, job_id: str, number: int) -> None:
    """Make the workflow of a chunk, as a part of a transaction."""
    options: Any = {"workflow_name": WORKFLOW, "queue_name": QUEUE, "workflow_id": workflow_id(job_id, number)}
    client.enqueue_in_transaction(connection, options, job_id, number)


def resume(client: DBOSClient, executor: str) -> None:
    """Put back into the queue what an executor has begun and will not end."""
    begun = client.list_workflows(status="PENDING", executor_id=executor, load_input=False, load_output=False)
    if begun:
        client.resume_workflows([status.workflow_id for status in begun], queue_name=QUEUE)


class Executor:
    """DBOS, running workflows under a name.

    Parameters
    ----------
    url : str
        The database.
    name : str
        Of this executor; no living one has the same.
    role : str
        all or worker.
    workers : int
        Processes of the pool.
    work : callable
        The coroutine function of a chunk: job id and number.
    loop : asyncio.AbstractEventLoop
        Where it runs.
    """

    def __init__(
        self,
        url: str,
        name: str,
        role: str,
        workers: int,
        work: Callable[[str, int], Coroutine[Any, Any, None]],
        loop: asyncio.AbstractEventLoop,
    ) -> None:
        self._url, self._name, self._role, self._work, self._loop = url, name, role, work, loop
        self._room = workers + BEYOND_WORKERS
        self._dbos: DBOS | None = None
        self._running: dict[tuple[str, int], concurrent.futures.Future[None]] = {}
        self._claimed: set[str] = set()
        self._lock = threading.Lock()
        self._waker = concurrent.futures.ThreadPoolExecutor(1, thread_name_prefix="jobs-waker")
        self._closing = False

    def launch(self) -> None:
        """Start DBOS; what this name had begun before is begun anew. Blocks; whatever fails, it can be called again."""
        if not _one_a_process.acquire(blocking=False):
            raise StoreUnavailable("another application of this process runs its jobs")
        try:
            _log_to_ours()
            DBOS.destroy(destroy_registry=True)
            config: DBOSConfig = {
                "name": APPLICATION,
                "system_database_url": self._url,
                "executor_id": self._name,
                "application_version": VERSION,
                "log_level": "WARNING",
                "use_listen_notify": False,
                "enable_otlp": False,
            }
            dbos = DBOS(config=config)
            DBOS.workflow(name=WORKFLOW, max_recovery_attempts=MAX_ATTEMPTS)(self._workflow())
            DBOS.listen_queues([QUEUE])
            DBOS.launch()
            poll = POLL_SECONDS[self._role]
            self._queue = DBOS.register_queue(
                QUEUE, worker_concurrency=self._room, polling_interval_sec=poll, on_conflict="always_update"
            )
            self._dbos = dbos
        except BaseException:
            DBOS.destroy(destroy_registry=True)
            _one_a_process.release()
            raise

    def _workflow(self) -> Callable[[str, int], None]:
        """The function that DBOS calls in one of its threads."""

        def work(job_id: str, number: int) -> None:
            name = workflow_id(job_id, number)
            with self._lock:
                if self._closing:
                    raise HandedBack
                self._claimed.add(name)
                future = asyncio.run_coroutine_threadsafe(self._work(job_id, number), self._loop)
                self._running[job_id, number] = future
            try:
                future.result()
            except concurrent.futures.CancelledError:
                raise HandedBack from None
            finally:
                with self._lock:
                    self._running.pop((job_id, number), None)
                    self._claimed.discard(name)
                self.wake()

        return work

    def wake(self) -> None:
        """Have the queue looked at now rather than at the next poll."""
        with self._lock:  # `stop` must not come between the two
            if not self._closing:
                self._waker.submit(self._claim)

    def _claim(self) -> None:
        """What DBOS's own thread does with each poll: claim workflows in a transaction, then begin them.

        DBOS has no public way to say "look now". A claim is good whoever makes it; a failed one is left to the next poll.
        """
        dbos = self._dbos
        if dbos is None or self._closing or len(self._claimed) >= self._room:
            return
        database, token = dbos._sys_db, str(uuid.uuid4())
        claimed: list[str] = []
        try:
            count = len(self._claimed)
            claimed, _ = database.start_queued_workflows(self._queue, self._name, VERSION, None, count, owner_xid=token)
            with self._lock:
                self._claimed.update(claimed)
            for status in database.get_workflow_statuses(claimed):
                execute_dequeued_workflow(dbos, status, token)
        except Exception as error:
            logging.getLogger("dbos").warning("the queue could not be looked at: %s", error)
            with self._lock:
                self._claimed.difference_update(claimed)
            if claimed:
                database.resume_workflows(claimed, queue_name=QUEUE)

    def jobs(self) -> set[str]:
        """The jobs that are being worked on here."""
        with self._lock:
            return {job_id for job_id, _ in self._running}

    def cancel(self, job_id: str) -> None:
        """Stop the work on a job; its worker is killed."""
        with self._lock:
            futures = [future for (running, _), future in self._running.items() if running == job_id]
        self._cancel(futures)

    def _cancel(self, futures: list[concurrent.futures.Future[None]]) -> None:
        """Cancel work in one pass of the event loop: one by one, what waits would get the worker that the first sets free."""
        self._loop.call_soon_threadsafe(lambda: [future.cancel() for future in futures])

    def stop(self, client: DBOSClient | None) -> None:
        """Stop everything and hand back what was begun. Blocks, for about a second."""
        with self._lock:
            self._closing = True
            futures = list(self._running.values())
        self._cancel(futures)
        concurrent.futures.wait(futures, timeout=1.0)
        self._waker.shutdown(wait=True, cancel_futures=True)
        if self._dbos is None:
            return
        try:
            DBOS.destroy(destroy_registry=True)
            if client is not None:
                resume(client, self._name)
        finally:
            self._dbos = None
            _one_a_process.release()


class _Ours(logging.Handler):
    """Sends what DBOS logs to the service's log, without repetitions, and without what is no news.

    That an execution ends whose workflow was cancelled, removed or taken over meanwhile is how a dismissal may look from below.
    """

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._last: dict[tuple[str, int], float] = {}

    def emit(self, record: logging.LogRecord) -> None:
        if record.getMessage().endswith(_OVERTAKEN) or isinstance(record.exc_info and record.exc_info[1], _OVERTAKEN_ERRORS):
            return
        place, now = (record.pathname, record.lineno), time.monotonic()
        if now - self._last.get(place, -QUIET_SECONDS) >= QUIET_SECONDS:
            self._last[place] = now
            logging.getLogger("service.jobs.dbos").log(record.levelno, "%s", _told(record))


def _told(record: logging.LogRecord) -> str:
    """A line of DBOS's log without the traces of where an error came by; its errors are those of the database."""
    text = record.getMessage() + (f"\n{record.exc_info[1]}" if record.exc_info else "")
    lines = [line for line in text.splitlines() if line and not line.startswith(_TRACE)]
    return " ".join(dict.fromkeys(lines))


_OVERTAKEN = "recorded outcome"
"""How each warning ends that an execution is not the one whose outcome counts."""

_OVERTAKEN_ERRORS = (dbos_error.DBOSNonExistentWorkflowError, dbos_error.DBOSAwaitedWorkflowCancelledError)
"""What such an execution then finds out."""

_TRACE = (" ", "\t", "Traceback", "(Background", "The above exception")


def _log_to_ours() -> None:
    """Put a handler on DBOS's log, which it then does not give one of its own."""
    log = logging.getLogger("dbos")
    if not any(isinstance(handler, _Ours) for handler in log.handlers):
        log.handlers = [_Ours()]
        log.propagate = False
