"""The process that raises workers: it loads and compiles everything once, then forks a ready worker in milliseconds.

Run as ``python -m service.workers.nursery HANDLER CONTROL_FD EVENT_FD MEMORY_BYTES``. A compiled loop ignores every signal but
SIGKILL, so a request is stopped by killing its worker; the next one must therefore cost almost nothing. Forking the
threaded web server would be unsafe, forking this single-threaded process is not, and the loaded pages are shared.

::

    web process --control: (K)ill or (S)pawn, worker id [, socket]--> nursery --fork--> worker
         ^-----------events: JSON lines (progress, ready, gone)--------'                      |
         ^-----------one socket a worker, messages of service.workers.wire-----------------------------'

HANDLER is a module with ``preload(progress) -> dict``, called once here, and ``handle(header, body) -> header, body``,
called in the worker for each request. Nothing outlives the web process: the end of the control stream ends the nursery,
which kills its workers first; and on Linux the kernel kills a worker whose nursery has gone.
"""

from __future__ import annotations

import contextlib
import ctypes
import faulthandler
import gc
import importlib
import json
import os
import resource
import select
import signal
import socket
import struct
import sys
from types import ModuleType
from typing import NoReturn

from service.workers import wire

COMMAND = struct.Struct("!cI")
SPAWN, KILL = b"S", b"K"
_PR_SET_PDEATHSIG = 1


def main() -> None:
    """Load the handler, say so, then serve commands until the control stream ends."""
    handler_name, (control_fd, event_fd, memory_bytes) = sys.argv[1], map(int, sys.argv[2:])
    faulthandler.enable()
    _die_with_parent()
    control = socket.socket(fileno=control_fd)
    events = Events(event_fd)
    handler = importlib.import_module(handler_name)
    about = handler.preload(lambda name, done, total: events.emit("progress", name=name, done=done, total=total))
    # Objects alive now are never collected, so that no collection in a worker touches (and so copies) their pages.
    gc.collect()
    gc.freeze()
    events.emit("ready", about=about)
    Nursery(handler, control, events, memory_bytes).run()


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

    def __init__(self, handler: ModuleType, control: socket.socket, events: Events, memory_bytes: int) -> None:
        self._handler = handler
        self._memory_bytes = memory_bytes
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
        elif worker in self._pids:
            os.kill(self._pids[worker], signal.SIGKILL)
        return True

    def _spawn(self, worker: int, descriptor: int) -> None:
        pid = os.fork()
        if pid == 0:
            self._become_worker(descriptor)
        os.close(descriptor)
        self._pids[worker] = pid

    def _become_worker(self, descriptor: int) -> NoReturn:
        """The child's side of the fork: drop what belongs to the nursery and work until the channel closes."""
        try:
            _die_with_parent()
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            self._control.close()
            self._events.close()
            os.close(self._wake_read)
            os.close(self._wake_write)
            _limit_memory(self._memory_bytes)
            work(self._handler, socket.socket(fileno=descriptor))
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
    while (message := wire.receive(channel)) is not None:
        header, body = message
        answer, content = handler.handle(header, body)
        del message, body
        answer["resident_bytes"] = resident_bytes()
        wire.send(channel, answer, content)


def resident_bytes() -> int:
    """Resident size of this process in bytes, now (Linux) or at its peak (elsewhere)."""
    try:
        with open("/proc/self/statm", "rb") as statm:
            return int(statm.read().split()[1]) * resource.getpagesize()
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _limit_memory(extra_bytes: int) -> None:
    """Let this process claim `extra_bytes` of address space beyond the present; beyond it Python raises MemoryError."""
    try:
        with open("/proc/self/statm", "rb") as statm:
            present = int(statm.read().split()[0]) * resource.getpagesize()
    except OSError:
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = present + extra_bytes
    resource.setrlimit(resource.RLIMIT_AS, (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard))


def _die_with_parent() -> None:
    """Ask the kernel to kill this process when its parent ends (Linux; elsewhere the closed streams do it)."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


if __name__ == "__main__":
    main()
