"""A PostgreSQL of the tests' own, on this machine only, where its programs are installed."""

from __future__ import annotations

import contextlib
import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import sqlalchemy as sa

from service.jobs.engine import engine_for
from tests.service.live import free_port
from tests.service.processes import descendants

START_SECONDS = 60


def programs() -> Path | None:
    """The folder of initdb and postgres: on the path, or where Debian puts them."""
    found = [Path(place).resolve().parent for name in ("initdb",) if (place := shutil.which(name))]
    found += sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True)
    return next((folder for folder in found if (folder / "initdb").exists() and (folder / "postgres").exists()), None)


class Postgres:
    """One cluster in a folder that is gone afterwards; it can be stopped and started again, frozen and thawed."""

    def __init__(self, folder: Path) -> None:
        self._programs = folder
        self._port = free_port()
        self._home = Path(tempfile.mkdtemp(prefix="pg-"))
        self._process: subprocess.Popen[bytes] | None = None
        self._as: dict[str, Any] = {}
        if os.geteuid() == 0:  # it refuses to run as root
            user = _somebody()
            shutil.chown(self._home, user.pw_uid, user.pw_gid)
            self._as = {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []}
        self._run("initdb", "-D", str(self._home / "data"), "-U", "mat", "-A", "trust", "-E", "UTF8", "--no-sync")

    @property
    def url(self) -> str:
        """For MAT_DATABASE_URL."""
        return f"postgresql://mat@127.0.0.1:{self._port}/postgres"

    def without_encoding(self) -> str:
        """The address of another database, one that does not know how its text is encoded."""
        engine = engine_for(self.url)
        with engine.connect().execution_options(isolation_level="AUTOCOMMIT") as c:
            c.execute(sa.text("CREATE DATABASE plain ENCODING 'SQL_ASCII' LC_COLLATE 'C' LC_CTYPE 'C' TEMPLATE template0"))
        engine.dispose()
        return sa.make_url(self.url).set(database="plain").render_as_string(hide_password=False)

    def start(self) -> None:
        """Start, and wait until it answers."""
        options = {"listen_addresses": "127.0.0.1", "port": self._port, "unix_socket_directories": "", "fsync": "off"}
        settings = [part for name, value in options.items() for part in ("-c", f"{name}={value}")]
        command = [str(self._programs / "postgres"), "-D", str(self._home / "data"), *settings]
        self._process = subprocess.Popen(command, cwd=self._home, stderr=subprocess.DEVNULL, **self._as)
        end = time.monotonic() + START_SECONDS
        while "ready" not in self._state():
            assert self._process.poll() is None, "PostgreSQL ended while starting"
            assert time.monotonic() < end, "PostgreSQL did not start in time"
            time.sleep(0.05)

    def stop(self) -> None:
        """Stop at once: connections are cut."""
        if self._process is not None:
            self.thaw()
            self._process.send_signal(signal.SIGINT)
            self._process.wait(30)
            self._process = None

    def freeze(self) -> None:
        """Neither answer nor refuse: the kernel takes connections and questions, and nobody looks at them."""
        self._signal(signal.SIGSTOP)

    def thaw(self) -> None:
        """Go on where it was frozen."""
        self._signal(signal.SIGCONT)

    def _signal(self, sign: signal.Signals) -> None:
        assert self._process is not None, "it was started"
        for pid in (self._process.pid, *descendants(self._process.pid)):
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, sign)

    def remove(self) -> None:
        """Stop, and leave nothing."""
        self.stop()
        shutil.rmtree(self._home, ignore_errors=True)

    def _run(self, program: str, *arguments: str) -> None:
        command = [str(self._programs / program), *arguments]
        subprocess.run(command, cwd=self._home, check=True, stdout=subprocess.DEVNULL, **self._as)

    def _state(self) -> str:
        """The last line of its lock file: starting, or ready."""
        try:
            return (self._home / "data" / "postmaster.pid").read_text().splitlines()[-1]
        except (OSError, IndexError):
            return ""


def _somebody() -> pwd.struct_passwd:
    """A user who is not root."""
    for name in ("postgres", "nobody"):
        try:
            return pwd.getpwnam(name)
        except KeyError:
            continue
    raise LookupError("no user to run PostgreSQL as")
