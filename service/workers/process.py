"""What a process of the workers asks of the operating system, about itself or another one."""

from __future__ import annotations

import contextlib
import ctypes
import os
import resource
import signal
import sys
import time

LOW_PRIORITY = 10
"""Beside a process of the usual priority it gets a tenth of a processor that both want."""

_PR_SET_PDEATHSIG = 1

_CLOCK_BITS, _CPUCLOCK_SCHED = 3, 2
"""How Linux numbers the clock of a process's processor time (clock_getcpuclockid)."""


def die_with_parent(parent: int) -> None:
    """Ask the kernel to kill this process when its parent ends (Linux; elsewhere the closed streams do it).

    Parameters
    ----------
    parent : int
        The process that must be the parent: it may have ended before the kernel was asked.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def give_way(process: int, how: str) -> None:
    """Let a process give way to others for the rest of its life: only a privileged one gets back what it gave up.

    Parameters
    ----------
    process : int
        Its id.
    how : str
        idle: it gets what the others leave, and steps aside the moment that one of them wakes up (low, where there is no such
        thing or a sandbox forbids it); low: a tenth of a processor that another one wants, too; normal: it stays what it is.
    """
    if how == "idle" and sys.platform == "linux":
        with contextlib.suppress(PermissionError):
            os.sched_setscheduler(process, os.SCHED_IDLE, os.sched_param(0))
            return
    if how != "normal":
        os.setpriority(os.PRIO_PROCESS, process, LOW_PRIORITY)


def processor_seconds(process: int | None) -> float:
    """Seconds of processor time that a process has used; 0 when it has ended or is only just being born (None).

    Seconds of the wall where the system does not tell.
    """
    if sys.platform != "linux":
        return time.monotonic()
    if process is None:
        return 0.0
    try:
        return time.clock_gettime(~process << _CLOCK_BITS | _CPUCLOCK_SCHED)
    except OSError:
        return 0.0


def resident_bytes() -> int:
    """Resident size of this process in bytes, now (Linux) or at its peak (elsewhere)."""
    try:
        with open("/proc/self/statm", "rb") as statm:
            return int(statm.read().split()[1]) * resource.getpagesize()
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def limit_memory(extra_bytes: int) -> None:
    """Let this process claim `extra_bytes` of address space beyond the present; beyond it Python raises MemoryError."""
    try:
        with open("/proc/self/statm", "rb") as statm:
            present = int(statm.read().split()[0]) * resource.getpagesize()
    except OSError:
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = present + extra_bytes
    resource.setrlimit(resource.RLIMIT_AS, (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard))
