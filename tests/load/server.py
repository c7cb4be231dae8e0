"""The service under load: one more process on a free port of this machine, as its operators start it."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import AsyncIterator
from pathlib import Path

from tests.load.client import connected
from tests.service.live import ROOT, START_SECONDS, free_port
from tests.service.processes import alive, descendants, status

GOODBYE_SECONDS = 30.0


class Server:
    """A running service.

    Parameters
    ----------
    folder : Path
        Its log is here, and its data, unless the settings say where.
    **settings : object
        By their names in `service.settings.Settings`. Nothing is kept to be answered again, unless they say so.

    Attributes
    ----------
    port : int
    process : subprocess.Popen
    seen : set of int
        Every process of its that was ever met.
    """

    def __init__(self, folder: Path, **settings: object) -> None:
        self.port = free_port()
        self.seen: set[int] = set()
        self._log = folder / "service.log"
        usual = {"data_dir": folder / f"data-{self.port}", "log_level": "warning", "result_cache_bytes": 0}
        given = {**usual, **settings}
        self._environment = {f"MAT_{name.upper()}": str(value) for name, value in given.items()}
        self.process = self._start()

    def _start(self) -> subprocess.Popen[bytes]:
        command = (sys.executable, "-m", "service.cli", "serve", "--host", "127.0.0.1", "--port", str(self.port))
        with self._log.open("ab") as log:
            return subprocess.Popen(command, cwd=ROOT, env={**os.environ, **self._environment}, stderr=log)

    def log(self) -> str:
        """What it has said."""
        return self._log.read_text(encoding="utf-8")

    def kill(self) -> None:
        """As the kernel would: nothing is said to anybody."""
        self.workers()
        self.process.kill()
        self.process.wait()

    def start_again(self) -> None:
        """After a kill; with the same data, at the same port."""
        self.process = self._start()

    async def ready(self) -> None:
        """Wait until it takes work."""
        end = time.monotonic() + START_SECONDS
        async with connected(self.port) as connection:
            while time.monotonic() < end:
                assert self.process.poll() is None, f"the service ended while starting, see {self._log}"
                with contextlib.suppress(ConnectionError):
                    if (await connection.request("GET", "/readyz")).status == 200:
                        return
                await asyncio.sleep(0.05)
        raise AssertionError("the service was not ready in time")

    def workers(self) -> list[int]:
        """The processes that solve, as they are now."""
        family = descendants(self.process.pid)
        self.seen |= family
        nurseries = {pid for pid in family if status(pid)[1] == self.process.pid}
        return sorted(pid for pid in family - nurseries if alive(pid))

    def processor_seconds(self) -> tuple[float, float]:
        """Of the web process, and of all those that belong to it, since they began."""
        return used(self.process.pid), sum(used(pid) for pid in descendants(self.process.pid))

    def stop(self) -> None:
        """Ask it to end, and see that it does; it may have ended already."""
        self.workers()
        self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(GOODBYE_SECONDS)
        finally:
            self.process.kill()
            self.process.wait()

    def orphans(self) -> list[int]:
        """Processes of its that are left although it has ended; some time is given to the kernel."""
        end = time.monotonic() + 5.0
        while (left := [pid for pid in self.seen if alive(pid)]) and time.monotonic() < end:
            time.sleep(0.02)
        return left


def used(pid: int) -> float:
    """Seconds of processor time that a process has used, and those of its children that have ended; 0 when it has itself."""
    try:
        after_name = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return sum(map(int, after_name[11:15])) / os.sysconf("SC_CLK_TCK")


def used_by_all() -> float:
    """Seconds of processor time that the whole machine has used."""
    user, nice, system, _, _, irq, softirq, *_ = map(int, Path("/proc/stat").read_text().split("\n")[0].split()[1:])
    return (user + nice + system + irq + softirq) / os.sysconf("SC_CLK_TCK")


@contextlib.asynccontextmanager
async def serving(folder: Path, **settings: object) -> AsyncIterator[Server]:
    """A service that is ready, stopped in the end whatever happens."""
    server = Server(folder, **settings)
    try:
        await server.ready()
        server.workers()
        yield server
    finally:
        await asyncio.to_thread(server.stop)
