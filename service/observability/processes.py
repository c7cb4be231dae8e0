"""The processes of the service and their memory, read from /proc; nothing where there is none."""

from __future__ import annotations

import contextlib
import os
import resource
from collections.abc import Iterator
from pathlib import Path

ROLES = ("web", "nursery", "worker")
"""Who is started by whom: the web process starts the nursery, the nursery starts the workers."""


def resident_bytes() -> dict[str, list[int]]:
    """Resident bytes of each process by its role; pages that a worker shares with the nursery count for both."""
    found: dict[str, list[int]] = {role: [] for role in ROLES}
    generation = [os.getpid()]
    for role in ROLES:
        for pid in generation:
            if (size := _resident(pid)) is not None:
                found[role].append(size)
        generation = [child for pid in generation for child in _children(pid)]
    return found


def _resident(pid: int) -> int | None:
    try:
        return int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1]) * resource.getpagesize()
    except (OSError, IndexError):
        return None


def _children(pid: int) -> Iterator[int]:
    """The children of all threads of a process; a thread or a process that ends meanwhile has none."""
    with contextlib.suppress(OSError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            with contextlib.suppress(OSError):
                yield from map(int, (task / "children").read_text(encoding="ascii").split())
