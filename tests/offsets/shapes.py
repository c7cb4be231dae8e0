"""The shapes of the repository that offsets are compared on: families with known axes, glyphs, icons."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

from tests.families import CATALOGUE
from tests.hunt.draw import draw
from tests.offsets.check import Json

OUTLINES = Path(__file__).resolve().parents[1] / "corpus" / "outlines.jsonl.gz"
FAMILIES = (
    "rectangle", "ell", "star_7", "circle", "ellipse_flat", "stadium", "annulus", "eccentric_ring", "square_round_hole",
    "parabola_cap", "dumbbell", "thorn", "kidney", "mixed", "plate", "pipe_bend",
)  # fmt: skip
DRAWN = ("smooth", "smooth_holes", "splines", "rationals_mild", "line_arc", "mixed", "clusters", "stairs")
SEEDS = 8


def shapes() -> list[tuple[str, Json]]:
    """All of them, named."""
    with gzip.open(OUTLINES, "rt", encoding="utf-8") as lines:
        drawn = [json.loads(line) for line in lines]
    return [
        *((name, CATALOGUE[name]()) for name in FAMILIES),
        *((shape["name"], shape) for shape in drawn),
        *((f"{family}/{seed}", draw(family, seed)) for family in DRAWN for seed in range(SEEDS)),
    ]
