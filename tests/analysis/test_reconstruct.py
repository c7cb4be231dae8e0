"""The boundary from axis and radius: against the domain it was made from."""

from __future__ import annotations

import functools
import gzip
import json
import math
from pathlib import Path
from typing import Any

import pytest

from mat_core import Domain, MedialAxis, medial_axis
from mat_core.analysis import reconstruct
from tests.families import CATALOGUE

Json = dict[str, Any]

TARGET = 1e-9  # of the size, for axes within 1e-10


def solve(shape: Json, tolerance: float = 1e-10) -> MedialAxis:
    return medial_axis(Domain.from_dict({"outer": shape["outer"], "holes": shape.get("holes", [])}), tolerance=tolerance)


@functools.cache
def outlines(name: str = "outlines") -> list[Json]:
    file = Path(__file__).parent.parent / "corpus" / f"{name}.jsonl.gz"
    with gzip.open(file, "rt") as lines:
        return [json.loads(row) for row in lines]


@pytest.mark.parametrize("name", sorted(CATALOGUE))
def test_families(name: str) -> None:
    axis = solve(CATALOGUE[name]())
    rebuilt = reconstruct(axis)
    assert rebuilt.distance <= TARGET * axis.domain.size
    assert rebuilt.area == pytest.approx(axis.domain.area, rel=1e-10)
    assert len(rebuilt.holes) == len(axis.domain.holes)


def test_a_leaf_on_a_knot() -> None:
    """There the axis is graded into pieces of 1e-9, whose directions are errors: arcs of nested discs stand for their sides."""
    axis = solve(next(row for row in outlines("regressions") if row["name"] == "leaf-on-a-knot"))
    assert reconstruct(axis).distance <= TARGET * axis.domain.size


@pytest.mark.parametrize("index", range(0, 40, 2))
def test_outlines(index: int) -> None:
    rows = outlines()
    axis = solve(rows[index * len(rows) // 40])
    rebuilt = reconstruct(axis)
    assert rebuilt.distance <= TARGET * axis.domain.size
    assert rebuilt.area == pytest.approx(axis.domain.area, rel=1e-9)


@pytest.mark.parametrize("name", ["rectangle", "star", "stadium", "keyhole", "dumbbell", "circle", "plate", "sliver"])
def test_what_is_exact_comes_back_to_rounding(name: str) -> None:
    axis = solve(CATALOGUE[name](), 1e-6)
    rebuilt = reconstruct(axis)
    assert rebuilt.distance <= 5e-14 * axis.domain.size
    assert rebuilt.area == pytest.approx(axis.domain.area, rel=1e-13)


def test_a_circle_comes_back_as_one_arc() -> None:
    axis = solve(CATALOGUE["circle"]())
    rebuilt = reconstruct(axis)
    r = math.sqrt(axis.domain.area / math.pi)
    assert len(rebuilt.outer) == 1
    assert rebuilt.area == pytest.approx(math.pi * r * r, rel=1e-14)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7, 1e-9])
def test_it_is_as_near_as_the_axis(tolerance: float) -> None:
    axis = solve(CATALOGUE["kidney"](), tolerance)
    assert reconstruct(axis).distance <= 4.0 * tolerance * axis.domain.size


@pytest.mark.parametrize("name", ["ell", "ellipse", "blob_holes", "mixed", "annulus"])
def test_what_comes_back_is_a_domain(name: str) -> None:
    rebuilt = json.loads(json.dumps(reconstruct(solve(CATALOGUE[name]())).to_dict(), allow_nan=False))
    again = Domain.from_dict({"outer": rebuilt["outer"], "holes": rebuilt["holes"]})
    assert again.area == pytest.approx(rebuilt["area"], rel=1e-9)
    assert max(rebuilt["to_boundary"], rebuilt["from_boundary"]) <= TARGET * again.size
