"""The process that serves: uvicorn, with an end in good order.

::

    SIGTERM ──> /readyz says no ──notice──> no new connections ──drain──> what still runs is killed ──ENDING──> exit code 0
                requests are taken          requests in flight end       workers go, jobs are handed back

A load balancer learns from /readyz that it must send requests elsewhere, and needs a moment for it: the notice. Ctrl-C needs
none, and each further Ctrl-C ends what is going on: the notice, the draining, at last the process. SIGTERM again changes nothing:
machines send it, sometimes twice, and have SIGKILL for those that they will not wait for.

No stage waits without a limit, and should one hang all the same (a database that neither answers nor refuses can hold any
thread that asks it), the process ends when its time is over. What it had accepted is kept: jobs that were not handed back are
begun anew.
"""

from __future__ import annotations

import logging
import math
import os
import queue
import resource
import signal
import socket
import threading
import time
from types import FrameType

import uvicorn
from fastapi import FastAPI

from service.app import create_app
from service.http.connections import protocol
from service.settings import KIB, Settings

FILES_BESIDE = 512
"""Files that may be open beside connections: sockets of workers, bodies and results of jobs, the database."""

HEAD_BYTES = 64 * KIB
"""Longest head of a request."""

BACKLOG = 2048
"""Connections that may wait to be accepted."""

ENDING_SECONDS = 12.0
"""Longest time from when the draining must be over to the end of the process: jobs are handed back (`service.jobs.keeper`),
workers go, and the last spans are sent, which take a second or two where everybody answers."""

LINGER_SECONDS = 1.0
"""How long threads are waited for when all is done; one that is left asks a database that does not answer. Also how long the
log may take to tell of an end that was not in good order."""

ACCEPTED_AT_ONCE = 16
"""Connections that are accepted in a pass of the event loop, a tenth of a millisecond each."""

_log = logging.getLogger("service.server")


class Server(uvicorn.Server):
    """A server whose process ends with code 0 when it was asked to end.

    Parameters
    ----------
    app : FastAPI
        Its ``state.leaving`` becomes true with the first signal.
    settings : Settings
    """

    def __init__(self, app: FastAPI, settings: Settings) -> None:
        drain = math.ceil(settings.shutdown_drain_seconds)
        # httptools, which uvicorn would take where it is there, saves an eighth of a small request here, and has no limit to
        # the size of a request's head
        http = protocol(app.state.connections)
        config = uvicorn.Config(
            app, http=http, ws="none", log_config=None, access_log=False, timeout_graceful_shutdown=drain,
            h11_max_incomplete_event_size=HEAD_BYTES, backlog=ACCEPTED_AT_ONCE,
        )  # fmt: skip
        super().__init__(config)
        self._drain_seconds = drain
        self._app = app
        self._notice_seconds = settings.shutdown_notice_seconds
        self._leave_at: float | None = None
        self._seconds_left = queue.SimpleQueue[float]()  # of the kind that a signal's handler may put into, wherever it runs

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to serve. To asyncio the backlog says also how many are accepted at once, so the kernel is told its own anew."""
        await super().startup(sockets)
        for listening in sockets or []:
            listening.listen(BACKLOG)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Begin to leave, or hurry; unlike uvicorn's own, the signal is not raised again at the end."""
        if self._leave_at is None:
            self._app.state.leaving = True
            notice = 0.0 if sig == signal.SIGINT else self._notice_seconds
            self._leave_at = time.monotonic() + notice
            self._seconds_left.put(notice + self._drain_seconds + ENDING_SECONDS)
            _log.info("leaving, asked to by %s", signal.Signals(sig).name)
        elif sig == signal.SIGINT:
            if self.force_exit:
                os._exit(0)
            self.force_exit = self.should_exit
            self.should_exit = True

    async def on_tick(self, counter: int) -> bool:
        """Called ten times a second: whether it is time to go."""
        if self._leave_at is not None and time.monotonic() >= self._leave_at:
            self.should_exit = True
        return await super().on_tick(counter)

    def end_in_time(self) -> None:
        """End the process when its time is over, whatever hangs.

        For a thread that is begun before a signal can come: a handler which begins one may wait for itself.
        """
        time.sleep(self._seconds_left.get() - LINGER_SECONDS)
        told = threading.Thread(target=_log.error, args=("ending now, which was not done in good order in time",), daemon=True)
        told.start()  # in a thread, as the log may be what hangs
        told.join(LINGER_SECONDS)
        os._exit(0)


def allow_files(connections: int) -> None:
    """Raise this process's limit of open files, where it would be met before that of connections."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = connections + FILES_BESIDE
    if soft == resource.RLIM_INFINITY or soft >= wanted:
        return
    allowed = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
    resource.setrlimit(resource.RLIMIT_NOFILE, (allowed, hard))
    if allowed < wanted:
        _log.warning("only %d files may be open, which is too few for %d connections (ulimit -n)", allowed, connections)


def run(settings: Settings, listening: socket.socket, handler: str = "service.workers.solve") -> None:
    """Serve on a socket until a signal asks for the end.

    Comes back when all is done, but where threads are left that hang: then the process ends here, with code 0.
    """
    allow_files(settings.max_connections)
    server = Server(create_app(settings, handler), settings)
    host, port = listening.getsockname()[:2]
    _log.info("serving on http://%s:%d", f"[{host}]" if ":" in host else host, port)
    threading.Thread(target=server.end_in_time, daemon=True).start()
    for sign in (signal.SIGINT, signal.SIGTERM):  # uvicorn's own are not there before it serves, nor while its loop is closed
        signal.signal(sign, server.handle_exit)
    server.run(sockets=[listening])
    _leave_threads()


def _leave_threads() -> None:
    """End the process if there are threads that do not end, which Python would wait for without a limit."""
    end = time.monotonic() + LINGER_SECONDS
    others = [thread for thread in threading.enumerate() if not thread.daemon and thread is not threading.current_thread()]
    for thread in others:
        thread.join(max(0.0, end - time.monotonic()))
    if left := [thread.name for thread in others if thread.is_alive()]:
        _log.warning("ending without waiting for %s", ", ".join(left))
        os._exit(0)
