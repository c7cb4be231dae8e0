"""Time per stage, by family, size and tolerance: `python -m benchmarks [--repeat N] [--only TEXT]`.

Stages are the functions that the pipeline calls, in its order. Every figure is the median of warm runs in milliseconds;
compare the ratios, not the milliseconds: machines differ. `x n` beside a sized family is the growth of time over growth
of size from the row before: 1 is linear, 2 is quadratic.
"""

from __future__ import annotations

import argparse
import gzip
import inspect
import json
import math
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mat_core import Domain, MatError, medial_axis, pipeline
from tests.families import CATALOGUE, comb, gear, hole_grid, ngon, polygon_random, smooth, star_shaped

Json = dict[str, Any]
CORPUS = Path(__file__).parents[1] / "tests" / "corpus" / "outlines.jsonl.gz"

SIZED: dict[str, tuple[Callable[[int], Json], tuple[int, ...]]] = {
    "comb": (comb, (4, 16, 64, 256)),
    "gear": (gear, (8, 32, 128, 512)),
    "polygon": (lambda n: polygon_random(1, n), (8, 32, 128, 512)),
    "ngon": (ngon, (8, 32, 128, 512)),
    "smooth": (lambda n: smooth(1, n), (8, 32, 128)),
    "line_arc": (lambda n: star_shaped(1, n, "la"), (8, 32, 128)),
    "hole_grid": (lambda n: hole_grid(n, n), (2, 4, 8, 16)),
}
FIXED = (
    "rectangle",
    "ell",
    "ellipse",
    "stadium",
    "rounded_rectangle",
    "gear",
    "kidney",
    "blob_holes",
    "mixed_holes",
    "spiral",
)
TOLERANCES = (1e-3, 1e-6, 1e-9)


class Stages:
    """Wraps what the pipeline calls and adds up the time spent, calls inside calls counted once."""

    def __init__(self) -> None:
        self.spent: dict[str, float] = {}
        self.depth = 0
        for name, value in vars(pipeline).items():
            own = getattr(value, "__module__", "") or ""
            if inspect.isfunction(value) and own.startswith("mat_core.") and own != pipeline.__name__:
                setattr(pipeline, name, self.timed(name, value))

    def timed(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def wrapped(*args: Any, **options: Any) -> Any:
            self.depth += 1
            begun = time.perf_counter()
            try:
                return function(*args, **options)
            finally:
                self.depth -= 1
                if self.depth == 0:
                    self.spent[name] = self.spent.get(name, 0.0) + time.perf_counter() - begun

        return wrapped


def edges(domain: Json) -> int:
    return sum(len(loop) for loop in [domain["outer"], *domain["holes"]])


def spans(domain: Json) -> int:
    """Knot spans: what the solver cuts, also where they are all one edge."""
    return sum(len(set(e["knots"])) - 1 for loop in [domain["outer"], *domain["holes"]] for e in loop)


def run(domain: Json, stages: Stages, repeat: int, tolerance: float = 1e-6) -> dict[str, float]:
    """Median milliseconds of every stage of one domain, and of the ends of the whole."""
    rows: list[dict[str, float]] = []
    sent = {"outer": domain["outer"], "holes": domain["holes"]}
    for i in range(repeat + 1):
        stages.spent = {}
        clock = [time.perf_counter()]
        parsed = Domain.from_dict(sent)
        clock.append(time.perf_counter())
        axis = medial_axis(parsed, tolerance=tolerance)
        clock.append(time.perf_counter())
        axis.to_dict()
        clock.append(time.perf_counter())
        inside = stages.spent
        row = {
            "from_dict": clock[1] - clock[0],
            **inside,
            "medial_axis": clock[2] - clock[1],
            "to_dict": clock[3] - clock[2],
        }
        row["rest"] = row["medial_axis"] - sum(inside.values())
        if i:  # the first run compiles and warms
            rows.append(row)
    return {k: 1e3 * statistics.median(r.get(k, 0.0) for r in rows) for k in dict.fromkeys(k for r in rows for k in r)}


def show(label: str, figures: dict[str, float], note: str = "") -> None:
    total = figures["medial_axis"]
    parts = " ".join(
        f"{k} {v:.2f} ({100 * v / total:.0f}%)"
        for k, v in figures.items()
        if k not in ("medial_axis", "from_dict", "to_dict")
    )
    print(
        f"{label:28s} {total:9.2f} ms {note:7s} "
        f"from_dict {figures['from_dict']:.2f} to_dict {figures['to_dict']:.2f} | {parts}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks")
    parser.add_argument("--repeat", type=int, default=7)
    parser.add_argument("--only", default="")
    chosen = parser.parse_args()
    stages = Stages()
    print("# families")
    for name in FIXED:
        if chosen.only in name:
            domain = CATALOGUE[name]()
            show(f"{name} ({edges(domain)})", run(domain, stages, chosen.repeat))
    print("# sizes")
    for name, (build, sizes) in SIZED.items():
        before: tuple[int, float] | None = None
        for n in sizes if chosen.only in name else ():
            domain = build(n)
            try:
                figures = run(domain, stages, 3 if n > 100 else chosen.repeat)
            except MatError as error:
                print(f"{name} ({spans(domain)}): {error}")
                continue
            count, spent = spans(domain), figures["medial_axis"]
            growth = "" if before is None else f"x{math.log(spent / before[1]) / math.log(count / before[0]):.2f}"
            show(f"{name} ({count})", figures, growth)
            before = count, spent
    print("# tolerances")
    for name in ("ellipse", "blob_holes", "mixed_holes", "spiral"):
        for tolerance in TOLERANCES if chosen.only in name else ():
            show(f"{name} {tolerance:g}", run(CATALOGUE[name](), stages, chosen.repeat, tolerance))
    if chosen.only in "outlines":
        print("# outlines")
        with gzip.open(CORPUS, "rt", encoding="utf-8") as lines:
            domains = [json.loads(line) for line in lines]
        times = {d["name"]: run(d, stages, chosen.repeat) for d in domains}
        middle = sorted(times.values(), key=lambda f: f["medial_axis"])[len(times) // 2]
        show(f"median of {len(times)}", middle)
        worst = max(times, key=lambda k: times[k]["medial_axis"])
        show(worst, times[worst])


if __name__ == "__main__":
    main()
