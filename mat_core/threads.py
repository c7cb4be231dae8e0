"""Work on several processors, with answers that do not depend on how many there are.

A stage cuts its work into parts whose bounds depend on the domain alone. Each part is one call of a compiled kernel, which lets
other threads run meanwhile, with room of its own; what the parts give is put together in their order. A single part is worked on
where it is asked for, so a small domain pays for no thread. Threads end with the stage that began them: a process may fork
between two solutions, and nothing is left running after an error.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from mat_core.errors import UnsupportedOption
from mat_core.memory import MANY, give_back

VARIABLE = "MAT_CORE_THREADS"
"""The environment variable that bounds the threads where no argument does."""

PART = 4096
"""Sites, strips or the like in one part: some milliseconds of work, where a thread begins and ends in a tenth of one."""

Bounds = tuple[int, int]
R = TypeVar("R")


def threads_allowed(asked: int | None) -> int:
    """How many threads a solution may use.

    Parameters
    ----------
    asked : int or None
        At least 1; None leaves it to `VARIABLE`, and without that to the processors that this process may run on.

    Raises
    ------
    UnsupportedOption
        It is no whole number of at least 1.
    """
    if asked is None:
        text = os.environ.get(VARIABLE, "").strip()
        if not text:
            return _processors()
        if not text.isdecimal() or int(text) < 1:
            raise UnsupportedOption("threads", f"{VARIABLE}={text!r} is not a whole number of at least 1")
        return int(text)
    if not isinstance(asked, int) or isinstance(asked, bool) or asked < 1:
        raise UnsupportedOption("threads", f"{asked!r} is not a whole number of at least 1")
    return asked


def _processors() -> int:
    """Those that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def cut(n: int) -> list[Bounds]:
    """Bounds of parts of 0 .. n - 1: all of PART but the last one, which has what is left; one empty part of nothing."""
    return [(begin, min(begin + PART, n)) for begin in range(0, max(n, 1), PART)]


def cut_between(begins: NDArray[np.int64], n: int) -> list[Bounds]:
    """Bounds of parts of 0 .. n - 1, of about PART, that begin only at some of the rising places `begins`; the first one is 0."""
    if n <= PART:
        return [(0, n)]
    wanted = np.array([begin for begin, _ in cut(n)])
    places = begins[np.minimum(np.searchsorted(begins, wanted), len(begins) - 1)]
    return list(pairwise([*np.unique(places).tolist(), n]))


def each(work: Callable[[Bounds], R], parts: Sequence[Bounds], threads: int) -> list[R]:
    """What `work` gives for each part, in their order; the first error of a part is raised when no part is worked on any more.

    What is freed before and meanwhile is given back to the operating system where the work is large, and so is its room.
    """
    workers = min(threads, len(parts))
    large = len(parts) * PART > MANY
    if large:
        give_back()
    if workers <= 1:
        made = [work(part) for part in parts]
    else:
        with ThreadPoolExecutor(workers, thread_name_prefix="mat_core") as pool:
            made = list(pool.map(work, parts))
    if large:
        give_back()
    return made
