"""Axes for the tests of the measures: families, and outlines people draw; solved once each."""

from __future__ import annotations

import functools
import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core import Domain, MedialAxis, medial_axis
from tests.curves.shapes import solved

Json = dict[str, Any]
Floats = NDArray[np.float64]

CORPUS = Path(__file__).resolve().parents[1] / "corpus"
FAMILIES = ("rectangle", "ell", "circle", "annulus", "eccentric_ring", "dumbbell", "ellipse", "stadium", "blob_holes",
            "hole_grid", "gear", "mixed", "mixed_holes", "comb", "spiral", "keyhole", "half_disc", "plate")
OUTLINES = (0, 7, 21, 35, 49)


@functools.cache
def outlines() -> list[Json]:
    """Glyphs and icons kept in the repository."""
    with gzip.open(CORPUS / "outlines.jsonl.gz", "rt", encoding="utf-8") as lines:
        return [json.loads(line) for line in lines]


@functools.cache
def outline(index: int) -> MedialAxis:
    """The axis of one of them."""
    found = outlines()
    return of(found[index % len(found)])


def of(shaped: Json) -> MedialAxis:
    """The axis of a domain object with annotations."""
    return medial_axis(Domain.from_dict({"outer": shaped["outer"], "holes": shaped.get("holes", [])}))


def all_axes() -> list[MedialAxis]:
    """Families, then outlines."""
    return [solved(name) for name in FAMILIES] + [outline(i) for i in OUTLINES]


def polygon(axis: MedialAxis, chords: int = 400) -> shapely.Polygon:
    """A fine flattening of the domain."""
    rings = []
    for loop in (axis.domain.outer, *axis.domain.holes):
        parts = []
        for edge in loop:
            straight = edge.degree == 1 and len(edge.control_points) == 2
            parts.append(edge.evaluate(np.linspace(*edge.domain, 2 if straight else chords))[:-1])
        rings.append(np.concatenate(parts))
    return shapely.Polygon(rings[0], rings[1:])
