"""Medians of warm runs in CPU time of the process: waiting for a processor that others use is not counted.

Nothing but the standard library: programs of peers import it in environments of their own.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any, NamedTuple

BUDGET = 1.0  # seconds of a measurement, the first run not left out included
MOST_RUNS = 15


class Timed(NamedTuple):
    """Median milliseconds, the number of runs it is the median of, and what the last run gave."""

    ms: float
    runs: int
    result: Any


def timed(function: Callable[[], Any], budget: float = BUDGET, most: int = MOST_RUNS) -> Timed:
    """Run until the budget or `most` is spent; the first run warms, and counts only where it is the only one."""
    spent: list[float] = []
    while len(spent) <= most and sum(spent) < budget:
        begun = time.process_time()
        result = function()
        spent.append(time.process_time() - begun)
    counted = spent[1:] or spent
    return Timed(1e3 * statistics.median(counted), len(counted), result)
