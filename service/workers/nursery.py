"""The process that raises workers: it loads and compiles everything once, then forks a ready worker in milliseconds.

Run as ``python -m service.workers.nursery HANDLER CONTROL_FD EVENT_FD MEMORY_BYTES PARENT PRIORITY``. A compiled loop ignores
every signal but SIGKILL, so a request is stopped by killing its worker; the next one must therefore cost almost nothing. Forking
the threaded web server would be unsafe, forking this single-threaded process is not, and the loaded pages are shared.

::

    web process --control: (S)pawn, (K)ill or (L)ower, worker id [, socket]--> nursery --fork--> worker
         ^-----------events: JSON lines (progress, ready, gone)-------------'                      |
         ^-----------one socket a worker, messages of service.workers.wire----------------------------------'

HANDLER is a module with ``preload(progress) -> dict``, called once here; ``rehearse()``, called once in each worker, before it
has anything to do; ``handle(header, body, report) -> header, body``, called for each request; and ``handle_lines(header, body,
send) -> header``, called for each chunk of a batch (by `service.workers.result_lines`).
Nothing outlives the web process: the end of the control stream ends the nursery, which kills its workers first; and on Linux
the kernel kills a worker whose nursery has gone.
"""

from __future__ import annotations

import contextlib
import faulthandler
import gc
import importlib
import json
import logging
import os
import select
import signal
import socket
import struct
import sys
import time
from types import ModuleType
from typing import NoReturn

from service.observability import logs
from service.workers import wire
from service.workers.process import die_with_parent, give_way, limit_memory, resident_bytes
from service.workers.result_lines import answer_lines

COMMAND = struct.Struct("!cI")
SPAWN, KILL, LOWER = b"S", b"K", b"L"

_log = logging.getLogger("service.workers.nursery")


def main() -> None:
    """Load the handler, say so, then serve commands until the control stream ends."""
    handler_name, *numbers, long_priority = sys.argv[1:]
    control_fd, event_fd, memory_bytes, parent = map(int, numbers)
    # Ctrl-C on a terminal is for the web process to handle. A session of its own would do that for this one, too, but Linux may
    # divide processors by sessions first (autogroups): then priorities of workers would not count against the web process.
    os.setpgid(0, 0)
    faulthandler.enable()
    logs.install((os.environ.get("MAT_LOG_LEVEL") or "info").strip())
    die_with_parent(parent)
    control = socket.socket(fileno=control_fd)
    events = Events(event_fd)
    handler = importlib.import_module(handler_name)
    about = handler.preload(lambda name, done, total: events.emit("progress", name=name, done=done, total=total))
    # Objects alive now are never collected, so that no collection in a worker touches (and so copies) their pages.
    gc.collect()
    gc.freeze()
    events.emit("ready", about=about)
    Nursery(handler, control, events, memory_bytes, long_priority).run()


class Events:
    """The stream of JSON lines to the web process."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def emit(self, kind: str, **content: object) -> None:
        """Write one event; a web process that has gone is noticed on the control stream, not here."""
        with contextlib.suppress(BrokenPipeError):
            os.write(self._descriptor, json.dumps({"event": kind, **content}).encode() + b"\n")

    def close(self) -> None:
        """Close this process's end."""
        os.close(self._descriptor)


class Nursery:
    """The worker processes of one pool, by the id that the web process gave them."""

    def __init__(
        self, handler: ModuleType, control: socket.socket, events: Events, memory_bytes: int, long_priority: str
    ) -> None:
        self._handler = handler
        self._memory_bytes = memory_bytes
        self._long_priority = long_priority
        self._control = control
        self._events = events
        self._pids: dict[int, int] = {}
        self._wake_read, self._wake_write = os.pipe()
        os.set_blocking(self._wake_write, False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(self._wake_write, warn_on_full_buffer=False)

    def run(self) -> None:
        """Serve until the web process goes away, then leave nothing behind."""
        try:
            while True:
                control = self._control.fileno()
                readable, _, _ = select.select([control, self._wake_read], [], [])
                if self._wake_read in readable:
                    os.read(self._wake_read, 4096)
                    self._reap()
                if control in readable and not self._obey():
                    return
        finally:
            for pid in self._pids.values():
                os.kill(pid, signal.SIGKILL)

    def _obey(self) -> bool:
        """Carry out one command; False at the end of the stream."""
        message, descriptors, _, _ = socket.recv_fds(self._control, COMMAND.size, 1)
        if len(message) < COMMAND.size:
            return False
        command, worker = COMMAND.unpack(message)
        if command == SPAWN:
            self._spawn(worker, descriptors[0])
        elif worker in self._pids and command == KILL:
            os.kill(self._pids[worker], signal.SIGKILL)
        elif worker in self._pids and command == LOWER:
            with contextlib.suppress(ProcessLookupError):  # it has just ended
                give_way(self._pids[worker], self._long_priority)
        return True

    def _spawn(self, worker: int, descriptor: int) -> None:
        nursery = os.getpid()
        try:
            pid = os.fork()
        except OSError as error:
            _log.error("no worker could be forked: %s", error)
            os.close(descriptor)
            self._events.emit("gone", worker=worker, exit_code=error.errno)
            return
        if pid == 0:
            self._become_worker(descriptor, nursery)
        os.close(descriptor)
        self._pids[worker] = pid
        self._events.emit("born", worker=worker, pid=pid)

    def _become_worker(self, descriptor: int, nursery: int) -> NoReturn:
        """The child's side of the fork: drop what belongs to the nursery and work until the channel closes."""
        try:
            die_with_parent(nursery)
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            self._control.close()
            self._events.close()
            os.close(self._wake_read)
            os.close(self._wake_write)
            limit_memory(self._memory_bytes)
            self._handler.rehearse()
            channel = socket.socket(fileno=descriptor)
            wire.send(channel, {wire.REHEARSED: time.process_time()})
            work(self._handler, channel)
        except (BrokenPipeError, ConnectionResetError):
            os._exit(0)
        except BaseException:  # the parent must never run on in a forked child, whatever happened
            sys.excepthook(*sys.exc_info())
            os._exit(1)
        os._exit(0)

    def _reap(self) -> None:
        """Collect every child that has ended and report it."""
        for worker, pid in list(self._pids.items()):
            done, status = os.waitpid(pid, os.WNOHANG)
            if done:
                del self._pids[worker]
                self._events.emit("gone", worker=worker, exit_code=os.waitstatus_to_exitcode(status))


def work(handler: ModuleType, channel: socket.socket) -> None:
    """Answer one request after the other until the channel closes."""
    served = 0

    def report(stage: str, fraction: float) -> None:
        wire.send(channel, {"stage": stage, "fraction": fraction})

    while (message := wire.receive(channel)) is not None:
        header, body = message
        header["unused"] = served == 0
        logs.IDS.set(header.get("ids", {}))  # what is logged on the way is found by them
        if "results" in header:
            answer, content = answer_lines(handler, channel, header, body), b""
            served += answer["written"]["lines"] - header["kept"]["lines"]
        else:
            answer, content = handler.handle(header, body, report if header.get("progress") else None)
            served += 1
        del message, body
        answer |= {"resident_bytes": resident_bytes(), "served": served}
        wire.send(channel, answer, content)


if __name__ == "__main__":
    main()
