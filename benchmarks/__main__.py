"""Time per stage, by family, size and tolerance: `python -m benchmarks [--repeat N] [--only TEXT]`.

Stages are the functions that the pipeline calls, in its order. Every figure is the median of warm runs in milliseconds of
CPU time; compare the ratios, not the milliseconds: machines differ. `x n` beside a sized family is the growth of time over
growth of size from the row before: 1 is linear, 2 is quadratic. `--only growth` prints the table from 1e3 to 1e5 edges.
"""

from __future__ import annotations

import argparse
import gzip
import json
import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from benchmarks import growth
from benchmarks.shapes import LARGE
from benchmarks.stages import Stages, edges, run, spans, stages_of
from mat_core import MatError
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


def show(label: str, figures: dict[str, float], note: str = "") -> None:
    total = figures["medial_axis"]
    parts = " ".join(f"{k} {v:.2f} ({100 * v / total:.0f}%)" for k, v in stages_of(figures).items())
    ends = " ".join(f"{k} {figures[k]:.2f}" for k in ("from_dict", "to_dict", "to_json"))
    print(f"{label:28s} {total:9.2f} ms {note:7s} {ends} | {parts}")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks")
    parser.add_argument("--repeat", type=int, default=7)
    parser.add_argument("--only", default="")
    chosen = parser.parse_args()
    os.environ["MAT_CORE_THREADS"] = "1"  # stages on one thread, whose times can be added up
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
                figures = run(domain, stages, chosen.repeat)
            except MatError as error:
                print(f"{name} ({spans(domain)}): {error}")
                continue
            count, spent = spans(domain), figures["medial_axis"]
            pace = "" if before is None else f"x{math.log(spent / before[1]) / math.log(count / before[0]):.2f}"
            show(f"{name} ({count})", figures, pace)
            before = count, spent
    print("# tolerances")
    for name in ("ellipse", "blob_holes", "mixed_holes", "spiral"):
        for tolerance in TOLERANCES if chosen.only in name else ():
            show(f"{name} {tolerance:g}", run(CATALOGUE[name](), stages, chosen.repeat, tolerance))
    if chosen.only in "growth":
        print("\n".join(["# growth", *growth.header()]))
        for name in LARGE:
            family = growth.grow(name, stages)
            print("\n".join([*growth.table(family), *filter(None, [family.ended])]), flush=True)
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
