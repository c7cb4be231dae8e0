"""Inputs that once went wrong; the line of each in the corpus says what did.

Some have a `truth`: `rungs`, settings of the tolerances tried at most until one passes; `leaves`, of the axis.
"""

from __future__ import annotations

from typing import Any

import pytest

from mat_core import Domain, medial_axis
from mat_core.tolerances import LADDER
from tests.assertions import assert_axis, node_counts
from tests.axis.test_oracle import corpus

REGRESSIONS = corpus("regressions.jsonl.gz")
# what went wrong lies below what the oracle can see: contacts and corners nearer to each other than 1e-8, or flatter than 1e-6,
# coordinates of 1e6, points that lie between two parameters
UNSEEN = {
    "far-ellipse",
    "hairpin-handle",
    "bend-at-an-end",
    "radius-from-a-flat-corner",
    "steep-phi-beside-a-corner",
    "fan-at-a-curve-that-rests",
    "side-without-length",
    "bend-of-tiny-sides",
    "points-that-no-parameter-names",
    "a-strip-of-no-length-along-all-of-a-side",
    "a-slight-bend-of-1e-19-beside-a-reflex-vertex",
    "a-bound-far-below-the-tolerance-refuted",
    "a-slight-leaf-beside-a-joint",
}


@pytest.mark.parametrize("domain", REGRESSIONS, ids=[d["name"] for d in REGRESSIONS])
def test_stays_cured(domain: dict[str, Any]) -> None:
    begun: list[str] = []
    answer = medial_axis(Domain.from_dict(domain), progress=lambda stage, share: begun.append(stage)).to_dict()
    assert answer["certificate"]["passed"] is True
    assert answer["graph"]["cycles"] == len(domain["holes"])
    assert answer["graph"]["components"] == 1
    truth = domain.get("truth", {})
    assert begun.count("sites") <= truth.get("rungs", len(LADDER))
    assert node_counts(answer)[0] == truth.get("leaves", node_counts(answer)[0])
    if domain["name"] not in UNSEEN:
        assert_axis(domain, answer)


@pytest.mark.parametrize("tolerance", [1e-9, 1e-11, 1e-12])
def test_a_foot_beside_an_end_is_found_by_the_certificate(tolerance: float) -> None:
    domain = next(d for d in REGRESSIONS if d["name"] == "foot-beside-the-end")
    axis = medial_axis(Domain.from_dict(domain), tolerance=tolerance)
    assert axis.certificate["checks"]["curves_on_axis"]["measured"] <= 2e-11


@pytest.mark.parametrize("name", ["a-bend-that-is-cut-off-leaves-no-kink", "a-bend-that-is-cut-off-leaves-no-kink-in-a-cubic"])
def test_curves_reach_the_leaf_beside_a_bend_that_is_cut_off(name: str) -> None:
    domain = next(d for d in REGRESSIONS if d["name"] == name)
    assert medial_axis(Domain.from_dict(domain), tolerance=1e-12).certificate["passed"]


def test_a_disc_touches_the_side_of_a_flat_corner_that_it_reaches_first() -> None:
    domain = next(d for d in REGRESSIONS if d["name"] == "straight-into-nearly-concentric")
    begun: list[str] = []
    answer = medial_axis(Domain.from_dict(domain), smooth_angle=0.0, progress=lambda stage, share: begun.append(stage)).to_dict()
    assert answer["certificate"]["passed"] is True
    assert begun.count("sites") == 1
