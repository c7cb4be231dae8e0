"""How time grows from 1e3 to 1e5 edges, stage by stage, with an exponent fitted to each.

1 is linear, 2 is quadratic. A family is left off after a size that takes more than LIMIT.
"""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np

from benchmarks.shapes import LARGE
from benchmarks.stages import RUNGS, Stages, edges, run
from mat_core import MatError

SIZES = (1_000, 3_000, 10_000, 30_000, 100_000)
LIMIT = 20.0  # seconds in all for one size of a family
TOLERANCE = {"plate with round holes": 1e-5, "grid of holes": 1e-5, "wave of smooth curves": 1e-5}


class Family(NamedTuple):
    """Numbers of edges, and the figures of `stages.run` at each; what ended it early, or nothing."""

    name: str
    sizes: list[int]
    figures: list[dict[str, float]]
    ended: str

    def exponent(self, stage: str = "medial_axis") -> float:
        """Of the least squares line through (log edges, log time)."""
        spent = [f[stage] for f in self.figures]
        if len(spent) < 2 or min(spent) <= 0.0:
            return float("nan")
        return float(np.polyfit(np.log(self.sizes), np.log(spent), 1)[0])

    def stages(self) -> list[str]:
        """In the order of the pipeline, the ends of the whole last."""
        return [name for name in self.figures[-1] if name not in ("medial_axis", RUNGS)]

    def rungs(self) -> list[float]:
        """Settings of the tolerances that were tried, at each size."""
        return [f[RUNGS] for f in self.figures]


def grow(name: str, stages: Stages) -> Family:
    family = Family(name, [], [], "")
    for size in SIZES:
        domain = LARGE[name](size)
        begun = time.monotonic()
        try:
            figures = run(domain, stages, tolerance=TOLERANCE.get(name, 1e-6))
        except MatError as error:
            return family._replace(ended=f"{edges(domain)} edges: {error}")
        family.sizes.append(edges(domain))
        family.figures.append(figures)
        if time.monotonic() - begun > LIMIT and size != SIZES[-1]:
            return family._replace(ended=f"left off: {family.sizes[-1]} edges took more than {LIMIT:g} s")
    return family


def table(family: Family, least_share: float = 0.03) -> list[str]:
    """Rows of a Markdown table: milliseconds of each stage by size, and its exponent; small stages are left out."""
    last = family.figures[-1]
    rows = []
    for stage in ("medial_axis", *family.stages()):
        if last[stage] < least_share * last["medial_axis"]:
            continue
        cells = [f"{f[stage]:,.0f}" if f[stage] >= 100 else f"{f[stage]:.3g}" for f in family.figures]
        cells += [""] * (len(SIZES) - len(cells))
        bold = "**" if stage == "medial_axis" else ""
        rows.append(f"| {family.name} | {bold}{stage}{bold} | {' | '.join(cells)} | {bold}{family.exponent(stage):.2f}{bold} |")
    return rows


def header() -> list[str]:
    sizes = " | ".join(f"{n:,}" for n in SIZES)
    return [f"| family | stage | {sizes} | exponent |", "|---|---|" + "---:|" * (len(SIZES) + 1)]
