"""The axis belongs to the shape: not to its place, its unit, or the way its boundary is written down."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.assertions import Answer
from tests.changes import CHANGES, moved_back
from tests.families import CATALOGUE
from tests.reference import Reference
from tests.sameness import assert_same_axis, compare

Json = dict[str, Any]
Solve = Callable[..., Json]

SHAPES = [
    "rectangle",
    "square",
    "triangle",
    "heptagon",
    "ell",
    "cross_5",
    "star",
    "polygon",
    "circle_3",
    "ellipse",
    "ellipse_4",
    "stadium",
    "rounded_rectangle",
    "half_disc",
    "annulus",
    "eccentric_ring",
    "square_round_hole",
    "lens",
    "lens_one_edge",
    "parabola_cap",
    "gear",
    "keyhole",
    "dumbbell",
    "pipe_bend",
    "heart",
    "thorn",
    "kidney",
    "blob_holes",
    "mixed",
    "mixed_holes",
    "hole_grid",
    "plate",
]


@pytest.mark.parametrize("change", sorted(CHANGES))
@pytest.mark.parametrize("name", SHAPES)
def test_same_axis(name: str, change: str, solve: Solve) -> None:
    """Every node within 1e-9 of the size, the same segments between them, of the same kinds and lengths."""
    changed = CHANGES[change](CATALOGUE[name]())
    after = moved_back(solve(changed.after), changed)
    *others, last = changed.before
    for before in others:
        frame = Reference(before)
        if not compare(Answer(solve(before), frame), Answer(after, frame)).differences:
            return
    assert_same_axis(Answer(solve(last), Reference(last)), Answer(after, Reference(last)))


@pytest.mark.parametrize("name", ["blob", "blob_holes", "ellipse_4", "square_one_edge"])
def test_knots_are_inserted_beside_the_origin(name: str, solve: Solve) -> None:
    """A spline far away whose coordinates survive the shift keeps all its digits: knots inserted there would be rounded."""
    changed = CHANGES["far"](CATALOGUE[name]())
    before, after = solve(changed.before[0]), moved_back(solve(changed.after), changed)
    same = compare(Answer(before, Reference(changed.before[0])), Answer(after, Reference(changed.before[0])))
    assert same.differences == []
    assert same.nodes < 3e-10  # the last digit of a node a million sizes away
