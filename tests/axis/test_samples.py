"""Samples with a step: true axis points, no two neighbours farther apart than the step."""

from __future__ import annotations

import numpy as np
import pytest

from mat_core import Domain, medial_axis
from tests.families import CATALOGUE

UNEVEN = ["dumbbell", "comb", "mixed_holes", "arc_lens", "keyhole", "cross_5", "annulus", "parabola_cap", "sliver", "lens"]


CASES = [(name, step, "discs") for name in UNEVEN for step in (1e-1, 1e-2, 1e-3)] + [("comb", 1e-2, "march")]


@pytest.mark.parametrize(("name", "step", "method"), CASES)
def test_neighbours_are_no_farther_apart_than_the_step(name: str, step: float, method: str) -> None:
    content = CATALOGUE[name]()
    domain = Domain.from_dict({"outer": content["outer"], "holes": content.get("holes", [])})
    axis = medial_axis(domain, method=method, step=step)
    segment, t = axis.sample_parameters()
    points = axis.sample(segment, t).points
    gaps = np.hypot(*np.diff(points, axis=0).T)[segment[1:] == segment[:-1]]
    assert gaps.max() <= step * domain.size
    assert (np.diff(segment) >= 0).all()
    for g in range(len(axis.segments)):
        own = t[segment == g]
        assert own[0] == 0.0
        assert own[-1] == 1.0
        assert (np.diff(own) > 0.0).all()


def test_a_step_is_kept_where_curves_are_coarse() -> None:
    content = CATALOGUE["lens"]()
    axis = medial_axis(Domain.from_dict({"outer": content["outer"], "holes": []}), tolerance=0.1, step=1e-3)
    segment, t = axis.sample_parameters()
    points = axis.sample(segment, t).points
    assert np.hypot(*np.diff(points, axis=0).T)[segment[1:] == segment[:-1]].max() <= 1e-3 * axis.domain.size


def test_a_point_has_no_samples() -> None:
    content = CATALOGUE["circle"]()
    axis = medial_axis(Domain.from_dict({"outer": content["outer"], "holes": []}), step=1e-3)
    assert len(axis.sample_parameters()[1]) == 0
