"""What was aimed at, and the figure reached in a run: ratios first, then times."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from benchmarks import fonts
from benchmarks.fonts import Font
from benchmarks.growth import Family
from benchmarks.peers.cases import VAST, WIDE
from benchmarks.peers.solve import Row
from benchmarks.resources import FirstUse, Memory

BOOST = "Boost.Polygon"
EXPONENT = 1.1


class Reached(NamedTuple):
    """An aim in words, the figure in words, whether it is met; None where the run has no figure."""

    aim: str
    figure: str
    met: bool | None


def reached(rows: Sequence[Row], families: Sequence[Family]) -> list[Reached]:
    """Of single shapes, and of families as they grow."""

    def of(group: str, tolerance: float | None = None) -> list[Row]:
        return [row for row in rows if row.group == group and tolerance in (None, row.tolerance)]

    def large(*names: str) -> list[Row]:
        return [row for row in rows if row.name in names]

    curves = of("curves", 1e-6)
    blob_like = [row for row in curves if row.name in ("blob_holes", "spiral", "gear")]
    vast = large(f"comb {VAST}", f"coastline {VAST}")
    plates = large(f"plate with round holes {WIDE}", f"grid of holes {WIDE}")
    return [
        faster("curves at 1e-6: at least 50 times faster than Boost.Polygon", curves, 50.0),
        faster("curves at 1e-8: at least 500 times faster than Boost.Polygon", of("curves", 1e-8), 500.0),
        faster("polygons of 1,000 to 6,000 vertices: no slower than Boost.Polygon", of("polygons"), 1.0),
        faster("comb and gear of 10,000 edges: level with Boost.Polygon", large(f"comb {WIDE}", f"gear {WIDE}"), 1.0),
        faster("plates with 10,000 edges of round holes at 1e-5: 10 times faster than Boost.Polygon", plates, 10.0),
        *(growing(family) for family in families),
        quick("median icon: at most 0.6 ms", of("icons"), 0.6, statistics.median),
        quick("small shapes of lines and arcs: under 0.2 ms each", of("lines and arcs"), 0.2, max),
        quick("ellipse: under 0.3 ms", [row for row in curves if row.name == "ellipse"], 0.3, max),
        quick("blob with 5 holes, spiral, gear of 12 teeth: under 2 ms each", blob_like, 2.0, max),
        quick("wave of 10,000 smooth curves: at most 300 ms", large(f"wave {WIDE}"), 300.0, max),
        quick("comb and coastline of 100,000 edges: at most 2,000 ms each", vast, 2000.0, max),
    ]


def reached_by_processes(measured: Sequence[Font], memories: Sequence[Memory], first: FirstUse) -> list[Reached]:
    """Of whole fonts, of memory, and of the first use."""
    glyph = fonts.median(measured)
    return [
        Reached(f"median glyph of {len(measured)} fonts: at most 0.6 ms", f"{number(glyph)} ms", glyph <= 0.6),
        *(small(memory) for memory in memories),
        Reached("all kernels compiled: under 25 s", f"{first.cold:.1f} s", first.cold < 25.0),
        Reached("first use with compiled kernels: under 0.5 s", f"{first.cached:.2f} s", first.cached < 0.5),
    ]


def faster(aim: str, rows: Iterable[Row], least: float) -> Reached:
    """The least ratio of the rows to Boost.Polygon decides."""
    ratios = {row.name: ratio for row in rows if (ratio := row.ratio(BOOST)) is not None}
    if not ratios:
        return Reached(aim, "not measured", None)
    worst = min(ratios, key=lambda name: ratios[name])
    best = max(ratios, key=lambda name: ratios[name])
    figure = f"{number(ratios[worst])} ({worst})"
    return Reached(aim, figure if best == worst else f"{figure} to {number(ratios[best])} ({best})", ratios[worst] >= least)


def quick(aim: str, rows: Iterable[Row], most: float, of_all: Callable[[Iterable[float]], float]) -> Reached:
    times = {row.name: row.ours.ms for row in rows if row.ours.ms is not None}
    if not times:
        return Reached(aim, "not measured", None)
    figure = of_all(times.values())
    which = f"median of {len(times)}" if of_all is statistics.median else max(times, key=lambda name: times[name])
    return Reached(aim, f"{number(figure)} ms ({which})", figure <= most)


def small(memory: Memory) -> Reached:
    figure = f"{memory.whole:.2f} KB, {memory.solving:.2f} KB of it for solving"
    aim = f"memory of {memory.edges:,} edges, {memory.name}: under 2 KB an edge beyond 100 MB"
    return Reached(aim, figure, memory.whole < 2.0)


def growing(family: Family) -> Reached:
    aim = f"growth of time, {family.name}: exponent at most {EXPONENT}"
    exponent = family.exponent()
    if exponent != exponent:
        return Reached(aim, family.ended or "not measured", None)
    sizes = f"{family.sizes[0]:,} to {family.sizes[-1]:,} edges"
    climbed = [f"{n:,} edges take {r:.0f} rungs" for n, r in zip(family.sizes, family.rungs(), strict=True) if r > 1]
    return Reached(aim, "; ".join([f"{exponent:.2f} ({sizes})", *climbed]), round(exponent, 2) <= EXPONENT)


def number(value: float) -> str:
    """Three digits, thousands with a comma."""
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"
