"""Time per stage: the functions that the pipeline calls, in its order, in CPU milliseconds of warm runs."""

from __future__ import annotations

import inspect
import statistics
import time
from collections.abc import Callable
from itertools import pairwise
from typing import Any

from benchmarks.timing import BUDGET, MOST_RUNS
from mat_core import Domain, medial_axis, pipeline

Json = dict[str, Any]

ENDS = ("from_dict", "medial_axis", "to_dict", "to_json")  # of the whole; everything else is a stage
NO_STAGES = ("mat_core.pipeline", "mat_core.threads")  # modules whose functions arrange the stages
RUNGS = "rungs"  # settings of the tolerances that were tried, not a time


class Stages:
    """Wraps what the pipeline calls and adds up the time spent, calls inside calls counted once."""

    def __init__(self) -> None:
        self.spent: dict[str, float] = {}
        self.calls: dict[str, int] = {}
        self.depth = 0
        for name, value in list(vars(pipeline).items()):
            own = getattr(value, "__module__", "") or ""
            if inspect.isfunction(value) and own.startswith("mat_core.") and own not in NO_STAGES:
                setattr(pipeline, name, self.timed(name, value))

    def timed(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def wrapped(*args: Any, **options: Any) -> Any:
            self.depth += 1
            begun = time.process_time()
            try:
                return function(*args, **options)
            finally:
                self.depth -= 1
                if self.depth == 0:
                    self.calls[name] = self.calls.get(name, 0) + 1
                    self.spent[name] = self.spent.get(name, 0.0) + time.process_time() - begun

        return wrapped


def edges(domain: Json) -> int:
    return sum(len(loop) for loop in [domain["outer"], *domain["holes"]])


def spans(domain: Json) -> int:
    """Knot spans: what the solver cuts, also where they are all one edge."""
    return sum(len(set(e["knots"])) - 1 for loop in [domain["outer"], *domain["holes"]] for e in loop)


def run(domain: Json, stages: Stages, repeat: int = MOST_RUNS, tolerance: float = 1e-6) -> dict[str, float]:
    """Median milliseconds of every stage of one domain, and of the ends of the whole.

    The first run warms; it counts only where it alone takes up the time (twice the BUDGET, for all ends together).
    """
    rows: list[dict[str, float]] = []
    rungs = 0
    sent = {"outer": domain["outer"], "holes": domain["holes"]}
    while len(rows) <= repeat and sum(row[end] for row in rows for end in ENDS) < 2.0 * BUDGET:
        clock = [time.process_time()]
        parsed = Domain.from_dict(sent)
        clock.append(time.process_time())
        stages.spent, stages.calls = {}, {}
        axis = medial_axis(parsed, tolerance=tolerance)
        clock.append(time.process_time())
        inside = stages.spent
        axis.to_dict()
        clock.append(time.process_time())
        axis.to_json()
        clock.append(time.process_time())
        ends = dict(zip(ENDS, (b - a for a, b in pairwise(clock)), strict=True))
        rows.append({**inside, "rest": ends["medial_axis"] - sum(inside.values()), **ends})
        rungs = max(stages.calls.values())
    counted = rows[1:] or rows
    figures = {k: 1e3 * statistics.median(r[k] for r in counted) for k in rows[-1]}
    return {**figures, RUNGS: rungs}


def stages_of(figures: dict[str, float]) -> dict[str, float]:
    """The stages alone, in their order, what is left over last."""
    return {k: v for k, v in figures.items() if k not in ENDS and k != RUNGS}
