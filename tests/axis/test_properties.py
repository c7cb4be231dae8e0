"""Whatever valid domain comes: solved, certified, and right by the oracle."""

from __future__ import annotations

from typing import Any

from hypothesis import given, settings

from mat_core import Domain, medial_axis
from tests.assertions import assert_axis, node_counts
from tests.leaves import count_leaves
from tests.reference import Reference
from tests.strategies import blobs, known_shapes, lenses, moved, polygons, staircases, star_shaped, valid_domains

Json = dict[str, Any]


def judge(domain: Json) -> None:
    answer = medial_axis(Domain.from_dict(domain)).to_dict()
    assert_axis(domain, answer, per_segment=5, per_edge=3)
    leaves = count_leaves(Reference(domain, answer["certificate"]["smooth_angle"]))
    assert leaves.certain <= node_counts(answer)[0] <= leaves.certain + leaves.doubtful


@given(star_shaped())
@settings(max_examples=60)
def test_star_shaped(domain: Json) -> None:
    judge(domain)


@given(blobs())
@settings(max_examples=40)
def test_blobs(domain: Json) -> None:
    judge(domain)


@given(lenses())
@settings(max_examples=40)
def test_lenses(domain: Json) -> None:
    judge(domain)


@given(polygons())
@settings(max_examples=50)
def test_polygons(domain: Json) -> None:
    judge(domain)


@given(staircases())
@settings(max_examples=40)
def test_staircases(domain: Json) -> None:
    judge(domain)


@given(known_shapes())
@settings(max_examples=40)
def test_known_shapes(domain: Json) -> None:
    judge(domain)


@given(moved(star_shaped(most_holes=1)))
@settings(max_examples=40)
def test_moved(domain: Json) -> None:
    judge(domain)


@given(valid_domains())
@settings(max_examples=40)
def test_answers_repeat(domain: Json) -> None:
    """The same question has the same answer, bit by bit."""
    assert medial_axis(Domain.from_dict(domain)).to_dict() == medial_axis(Domain.from_dict(domain)).to_dict()
