"""Families, seeded random shapes and a few real outlines against the slow oracle, both ways round."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mat_core import Domain, medial_axis
from tests.assertions import assert_axis, node_counts
from tests.families import CATALOGUE, polygon_random, smooth, star_shaped
from tests.leaves import count_leaves
from tests.reference import Reference
from tests.transforms import rotated, scaled, shifted

Json = dict[str, Any]
Solve = Callable[..., Json]

CORPUS = Path(__file__).parents[1] / "corpus"
RANDOM: dict[str, Callable[[int], Json]] = {
    "smooth": smooth,
    "smooth_holes": lambda seed: smooth(seed, 11, 1 + seed % 4),
    "polygon": polygon_random,
    "line_arc": lambda seed: star_shaped(seed, 6 + seed % 9, "la", seed % 3),
    "mixed": lambda seed: star_shaped(seed, 5 + seed % 9, "laqc", seed % 4),
}


def corpus(name: str) -> list[Json]:
    """Domains kept in the repository, one a line."""
    with gzip.open(CORPUS / name, "rt", encoding="utf-8") as lines:
        return [json.loads(line) for line in lines]


def judge(domain: Json, answer: Json, tolerance: float = 1e-6) -> None:
    """Everything the oracle can say: discs, coverage, nodes, graph, and the number of leaves."""
    assert_axis(domain, answer, tolerance)
    assert answer["certificate"]["passed"] is True
    leaves = count_leaves(Reference(domain, answer["certificate"]["smooth_angle"]))
    found = node_counts(answer)[0]
    assert leaves.certain <= found <= leaves.certain + leaves.doubtful


@pytest.mark.parametrize("name", sorted(CATALOGUE))
def test_catalogue(name: str, solve: Solve) -> None:
    domain = CATALOGUE[name]()
    judge(domain, solve(domain))


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("family", sorted(RANDOM))
def test_random(family: str, seed: int, solve: Solve) -> None:
    domain = RANDOM[family](seed)
    judge(domain, solve(domain))


@pytest.mark.parametrize("name", ["ellipse", "blob_holes", "mixed", "thorn", "spiral", "kidney"])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-8])
def test_tolerance_is_kept(name: str, tolerance: float, solve: Solve) -> None:
    domain = CATALOGUE[name]()
    judge(domain, solve(domain, tolerance=tolerance), tolerance)


@pytest.mark.parametrize("name", sorted(CATALOGUE))
def test_samples_touch(name: str) -> None:
    """Points and footpoints along every segment, where they are asked for."""
    domain = CATALOGUE[name]()
    answer = medial_axis(Domain.from_dict({"outer": domain["outer"], "holes": domain["holes"]})).to_dict(samples=True)
    assert all(s["samples"]["points"] for s in answer["segments"])
    assert_axis(domain, answer, per_segment=2, per_edge=1)


@pytest.mark.parametrize("name", ["ell", "ellipse", "mixed_holes", "blob", "gear", "keyhole"])
def test_far_and_small(name: str, solve: Solve) -> None:
    for domain in (
        shifted(CATALOGUE[name](), 1e6, 1e6),
        scaled(rotated(CATALOGUE[name](), 1.0), 1e-9),
        scaled(CATALOGUE[name](), 1e9),
    ):
        judge(domain, solve(domain))


@pytest.mark.parametrize("domain", corpus("outlines.jsonl.gz"), ids=lambda d: d["name"])
def test_outlines(domain: Json, solve: Solve) -> None:
    """Glyphs and icons: the outlines people send."""
    judge(domain, solve(domain))
