"""What is solved side by side: shapes in groups, each with the tolerances that it is solved at."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.shapes import LARGE, coastline
from tests.families import CATALOGUE

Json = dict[str, Any]

CORPUS = Path(__file__).parents[2] / "tests" / "corpus" / "outlines.jsonl.gz"
SMALL = ("rectangle", "ell", "circle", "stadium", "rounded_rectangle", "half_disc", "keyhole", "dumbbell", "pipe_bend")
CURVED = ("ellipse", "blob_holes", "spiral", "gear")
AMPERSAND = "a/DejaVuSans/ampersand#0"
COASTS = (1000, 2000, 6000)
WIDE = 10_000  # edges of a large shape
VAST = 100_000

EVERYONE = ("Boost.Polygon", "pyvoronoi", "Open CASCADE", "flo-mat", "scikit-image")
VORONOI = ("Boost.Polygon", "pyvoronoi")
BOOST = ("Boost.Polygon",)


class Case(NamedTuple):
    """A shape at a tolerance (relative to its size), who solves it, whether distances from the true axis are measured."""

    group: str
    name: str
    build: Callable[[], Json]
    tolerance: float
    peers: tuple[str, ...]
    judged: bool = False

    @property
    def label(self) -> str:
        return f"{self.name} {self.tolerance:g}"


def cases() -> Iterator[Case]:
    """All of them, the quick ones first: what the time limit cuts off is the largest."""
    for name in SMALL:
        yield Case("lines and arcs", name, CATALOGUE[name], 1e-6, EVERYONE, True)
    curved = {name: CATALOGUE[name] for name in CURVED} | {"ampersand": lambda: outlines()[AMPERSAND]}
    for name, build in curved.items():
        yield Case("curves", name, build, 1e-6, EVERYONE, True)
        yield Case("curves", name, build, 1e-8, BOOST, True)
    for name, outline in outlines().items():
        if name != AMPERSAND:
            group = "glyphs" if name.startswith("a/") else "icons"
            yield Case(group, name[2:], lambda outline=outline: outline, 1e-6, ("Boost.Polygon", "Open CASCADE", "flo-mat"), True)
    for n in COASTS:
        yield Case("polygons", f"coastline {n}", lambda n=n: coastline(n), 1e-6, VORONOI, n == min(COASTS))
    for name in ("comb", "gear"):
        yield Case("large", f"{name} {WIDE}", lambda name=name: LARGE[name](WIDE), 1e-6, VORONOI)
    yield Case("large", f"wave {WIDE}", lambda: LARGE["wave of smooth curves"](WIDE), 1e-5, VORONOI)
    for name in ("plate with round holes", "grid of holes"):
        yield Case("large", f"{name} {WIDE}", lambda name=name: LARGE[name](WIDE), 1e-5, BOOST)
    for name in ("comb", "coastline"):
        yield Case("large", f"{name} {VAST}", lambda name=name: LARGE[name](VAST), 1e-6, BOOST)


def outlines() -> dict[str, Json]:
    """Glyphs (a/...) and icons (b/...) of the tests' corpus by name."""
    with gzip.open(CORPUS, "rt", encoding="utf-8") as lines:
        return {d["name"]: d for d in map(json.loads, lines)}
