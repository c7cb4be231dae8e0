"""The process that serves: uvicorn, with an end in good order.

::

    SIGTERM ──> /readyz says no ──notice──> no new connections ──drain──> what still runs is killed ──> exit code 0
                requests are taken          requests in flight end       workers go

A load balancer learns from /readyz that it must send requests elsewhere, and needs a moment for it: the notice. Ctrl-C needs
none. A second signal ends the notice, a second Ctrl-C the draining, too.
"""

from __future__ import annotations

import logging
import math
import resource
import signal
import socket
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
        self._app = app
        self._notice_seconds = settings.shutdown_notice_seconds
        self._leave_at: float | None = None

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to serve. To asyncio the backlog says also how many are accepted at once, so the kernel is told its own anew."""
        await super().startup(sockets)
        for listening in sockets or []:
            listening.listen(BACKLOG)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Begin to leave; unlike uvicorn's own, the signal is not raised again at the end."""
        if self._leave_at is None:
            self._app.state.leaving = True
            self._leave_at = time.monotonic() + (0.0 if sig == signal.SIGINT else self._notice_seconds)
            _log.info("leaving, asked to by %s", signal.Signals(sig).name)
        else:
            self.force_exit = self.should_exit and sig == signal.SIGINT
            self.should_exit = True

    async def on_tick(self, counter: int) -> bool:
        """Called ten times a second: whether it is time to go."""
        if self._leave_at is not None and time.monotonic() >= self._leave_at:
            self.should_exit = True
        return await super().on_tick(counter)


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
    """Serve on a socket until a signal asks for the end, and come back when all is done."""
    allow_files(settings.max_connections)
    server = Server(create_app(settings, handler), settings)
    host, port = listening.getsockname()[:2]
    _log.info("serving on http://%s:%d", f"[{host}]" if ":" in host else host, port)
    server.run(sockets=[listening])
