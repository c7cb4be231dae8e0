"""Who is alive: the name of this executor, and the leases by which others notice that one has died.

An executor has a name (MAT_EXECUTOR_ID and the number of a slot), and DBOS gives what was running under a name back to the one
who starts under it again. The slot is a locked file, so two processes that share a folder never share a name, and a killed
process's name is free at once. A machine that does not come back is noticed by its lease in the database: every executor
renews its own, and takes over the jobs of one whose lease has run out.

::

    t=0    renew ... renew ... killed          lease runs out        another resumes its jobs
           |---RENEW---|---RENEW---|-------------LEASE-------------|---RENEW---|
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import time
from collections.abc import Callable
from pathlib import Path

from service.jobs.store import Store

LEASE_SECONDS = 15.0
"""How long an executor may be silent. Longer than a database is commonly away; a wrong guess costs only work done twice."""

RENEW_SECONDS = 3.0
"""Pause between renewals."""

SLOTS = 64
"""Executors of one name in one folder."""


class Slot:
    """A name that no other process of this folder has while the file is locked."""

    def __init__(self, folder: Path, name: str) -> None:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        for number in range(SLOTS):
            self.name = name if number == 0 else f"{name}.{number}"
            self._descriptor = os.open(folder / f"{self.name}.lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
            with contextlib.suppress(BlockingIOError):
                fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                return
            os.close(self._descriptor)
        raise OSError(f"{SLOTS} executors named {name} run already")

    def release(self) -> None:
        """Let another process have the name."""
        os.close(self._descriptor)


class Reaper:
    """Renews the lease of one executor, and takes over from those whose lease has run out.

    `resume` is called with the name of a dead executor; it makes what that one had begun available again.
    """

    def __init__(self, store: Store, executor: str, resume: Callable[[str], None]) -> None:
        self._store = store
        self._executor = executor
        self._resume = resume
        self._unbroken_since: float | None = None

    def beat(self) -> None:
        """One renewal, and one look at the others. Errors of the database pass through; call again later.

        After the database was away every lease looks as if it had run out, so nobody is taken for dead before this executor
        has renewed its own for as long as a lease lasts, in which time the living have renewed theirs.
        """
        try:
            self._store.renew(self._executor, LEASE_SECONDS)
        except Exception:
            self._unbroken_since = None
            raise
        if self._unbroken_since is None:
            self._unbroken_since = time.monotonic()
        if time.monotonic() - self._unbroken_since < LEASE_SECONDS:
            return
        while (dead := self._store.take_expired(LEASE_SECONDS)) is not None:
            self._resume(dead)
            self._store.release(dead)
