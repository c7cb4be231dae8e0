"""Which processes there are, read from /proc."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path


def status(pid: int) -> tuple[str, int]:
    """State letter and parent of a process; ("", 0) when there is none."""
    try:
        after_name = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return "", 0
    return after_name[0], int(after_name[1])


def alive(pid: int) -> bool:
    return status(pid)[0] not in ("", "Z")


def descendants(pid: int) -> set[int]:
    """The processes started by this one, and theirs."""
    parents = {int(entry.name): status(int(entry.name))[1] for entry in Path("/proc").iterdir() if entry.name.isdigit()}
    found = {pid}
    while new := {child for child, parent in parents.items() if parent in found} - found:
        found |= new
    return found - {pid}


def eventually(condition: Callable[[], bool], seconds: float = 10.0) -> None:
    """Wait until a condition comes true."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it never came true"
        time.sleep(0.01)
