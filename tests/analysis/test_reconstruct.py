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
from mat_core.analysis.rebuilding.reconstruct import Reconstruction
from tests.families import CATALOGUE

Json = dict[str, Any]

FARTHEST = 8.0  # errors of an axis by which a boundary rebuilt from it may miss: corners are put between two sides that miss each
TARGET = 1e-9  # of the size, for axes within 1e-10


def solve(shape: Json, tolerance: float = 1e-10) -> MedialAxis:
    return medial_axis(Domain.from_dict({"outer": shape["outer"], "holes": shape.get("holes", [])}), tolerance=tolerance)


def assert_domain_again(rebuilt: Reconstruction) -> None:
    document = json.loads(json.dumps(rebuilt.to_dict(), allow_nan=False))
    again = Domain.from_dict({"outer": document["outer"], "holes": document["holes"]})
    assert again.area == pytest.approx(document["area"], rel=1e-9)


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


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize(
    "points",
    [
        # beside the leaf the boundary's point moves so slowly that errors of the axis turn it round
        [[0.0066, 0.5214], [0.0028, 0.2242], [0.1302, 0.0], [0.21, 0.0], [1.0, 0.0], [0.02, 1.58]],
        [[-0.0195, 0.6513], [-0.0084, 0.2801], [0.1104, 0.0], [0.23, 0.0], [1.0, 0.0], [-0.05, 1.67]],
        [[-0.042, 0.57], [-0.029, 0.3933], [0.168, 0.0], [0.42, 0.0], [1.0, 0.0], [-0.14, 1.9]],
        # a convex corner of 1e-5, where the radius grows nearly as fast as at a centre of curvature
        [[0.2592, 0.2844], [0.07, 0.0768], [0.114, 0.0], [0.3, 0.0], [1.0, 0.0], [1.44, 1.58]],
        [[0.175, 0.2905], [0.042, 0.0697], [0.1972, 0.0], [0.58, 0.0], [1.0, 0.0], [0.5, 0.83]],
    ],
)
def test_a_rounded_corner_does_not_run_back_along_itself(points: list[list[float]], tolerance: float) -> None:
    chains = points[:4], points[3:5], points[4:], [points[-1], points[0]]
    edges = [{"degree": len(c) - 1, "control_points": c, "knots": [0.0] * len(c) + [1.0] * len(c)} for c in chains]
    assert_domain_again(reconstruct(solve({"outer": edges}, tolerance)))


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10])
def test_an_icon_does_not_run_back_along_itself(tolerance: float) -> None:
    shape = next(row for row in outlines("regressions") if row["name"] == "envelope-that-folds")
    assert_domain_again(reconstruct(solve(shape, tolerance)))


RIGHT = 0.7071067811865476
ROUND_TIPS: dict[str, list[tuple[float, ...]]] = {
    "drop": [
        (160.0, 496.0, 150.42035580240113, 495.9882663961573, 0.8579739451045231),
        (145.90682104930218, 487.5385489652241, 141.3932862962032, 479.0888315342909, 0.8579739451045231),
        (146.71, 471.12), (210.71, 375.12, 219.59, 361.81, RIGHT), (232.9, 370.69, 246.21, 379.57, RIGHT), (237.33, 392.88),
        (173.33, 488.88, 168.57234925808052, 496.01092213626595, 0.8814586964763292),
    ],
    "arrow": [
        (5.854, 5.146, 5.5, 4.792, RIGHT), (5.146, 5.146, 4.792, 5.5, RIGHT), (5.146, 5.854), (9.243, 9.95),
        (6.475, 9.95, 5.975, 9.95, RIGHT), (5.975, 10.45, 5.975, 10.95, RIGHT), (6.475, 10.95),
        (10.45, 10.95, 10.95, 10.95, RIGHT), (10.95, 10.45), (10.95, 6.475, 10.95, 5.975, RIGHT),
        (10.45, 5.975, 9.95, 5.975, RIGHT), (9.95, 6.475), (9.95, 9.243),
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(ROUND_TIPS))
def test_sides_that_overlap_on_a_disc_are_cut(name: str) -> None:
    """Beside a wall of one circle the axis ends 1e-9 from its centre, where errors turn directions by a tenth of a radian."""
    corners = ROUND_TIPS[name]
    edges = [
        {"degree": len(c) // 2, "control_points": [c[:2], *([c[2:4]] if len(c) > 2 else []), after[:2]],
         "weights": [1.0, *c[4:], 1.0]}
        for c, after in zip(corners, corners[1:] + corners[:1], strict=True)
    ]  # fmt: skip
    rebuilt = reconstruct(axis := solve({"outer": edges}))
    assert rebuilt.distance <= TARGET * axis.domain.size
    assert_domain_again(rebuilt)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-9])
@pytest.mark.parametrize(
    "name",
    [
        "foot-beside-the-end",
        "tip-of-a-rebuilt-cusp",
        "flat-corner-rebuilt",
        "vertices-that-drift",
        "segment-shorter-than-its-error",
    ],
)
def test_a_domain_comes_back_at_any_tolerance(name: str, tolerance: float) -> None:
    axis = solve(next(row for row in outlines("regressions") if row["name"] == name), tolerance)
    rebuilt = reconstruct(axis)
    assert_domain_again(rebuilt)
    assert rebuilt.distance <= FARTHEST * tolerance * axis.domain.size


@pytest.mark.parametrize("tolerance", [1e-8, 1e-9, 1e-10])
def test_a_corner_is_placed_by_the_discs_of_all_sides_that_meet_in_it(tolerance: float) -> None:
    """Three sides in a row are the corner at (8.76, 39.2); the discs of the last one turn about it by next to nothing."""
    chains: list[list[tuple[float, float]]] = [
        [(-5, 15.2), (0.92, 15.2), (6.04, 18.4), (8.76, 23.2)], [(8.76, 23.2), (43, 23.2)], [(43, 23.2), (43, -47.2)],
        [(43, -47.2), (59, -63.2)], [(59, -63.2), (59, 23.2)], [(59, 23.2), (59, 32.08), (51.88, 39.2), (43, 39.2)],
        [(43, 39.2), (8.76, 39.2)], [(8.76, 39.2), (6.04, 43.92), (0.92, 47.2), (-5, 47.2)],
        [(-5, 47.2), (-5, 56), (-12.2, 63.2), (-21, 63.2)], [(-21, 63.2), (-45, 63.2)],
        [(-45, 63.2), (-51.08, 63.2), (-56.28, 59.76), (-59, 54.8)], [(-59, 54.8), (-9, 4.8)],
        [(-9, 4.8), (-6.52, 7.6), (-5, 11.2), (-5, 15.2)],
    ]  # fmt: skip
    axis = solve({"outer": [{"degree": len(c) - 1, "control_points": c} for c in chains]}, tolerance)
    assert reconstruct(axis).distance <= FARTHEST * tolerance * axis.domain.size


@pytest.mark.parametrize(
    "name",
    [
        "overlap-beside-a-faint-corner",  # directions at a disc that hardly moves: a side began 0.02 rad behind its corner
        "leaf-at-a-jump-of-curvature",  # what errors leave of Q at a leaf was dropped, which moved points off their discs
        "leaf-at-a-smooth-joint",  # likewise
        "tiny-sides-of-a-smooth-edge",  # nine in a row were each near to a point of its own, and were made one
        "wander-along-a-side",  # an error along a side that halving did not lessen hid one across it
        "overlap-longer-than-a-bezier",  # a side began behind its corner by more than its first Bezier
        "overshoot-before-an-arc",  # what a side's errors put beyond its own end was kept, and an arc began there
    ],
)
def test_shapes_of_icons_and_glyphs_come_back(name: str) -> None:
    axis = solve(next(row for row in outlines("rebuilt") if row["name"] == name))
    rebuilt = reconstruct(axis)
    assert rebuilt.distance <= TARGET * axis.domain.size
    assert_domain_again(rebuilt)


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
    axis = solve(CATALOGUE[name]())
    rebuilt = reconstruct(axis)
    assert_domain_again(rebuilt)
    assert rebuilt.distance <= TARGET * axis.domain.size
