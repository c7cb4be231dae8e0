"""The published procedure: equal to the discs-first method where it succeeds, an honest error where it does not."""

from __future__ import annotations

import gzip
import json
import math
import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from mat_core import Domain, MedialAxis, NotCertified, UnsupportedOption, medial_axis
from mat_core.boundary.sites import build_sites
from mat_core.kernels.curve import evaluate
from mat_core.kernels.layout import KIND, SPIRAL
from mat_core.tolerances import LADDER
from mat_core.tracing.march import default_step
from mat_core.tracing.march.checks import nearest
from tests.families import CATALOGUE, bezier, circle_hole, line, polygon_random, polyline, rectangle, shape, star_shaped
from tests.paper_shapes import PAPER_SHAPES, illustration, pocket, small_hole, twice
from tests.transforms import rotated, scaled, shifted

Json = dict[str, Any]

CORPUS = Path(__file__).parents[1] / "corpus" / "outlines.jsonl.gz"
SMOOTH = {
    "circle", "circle_3", "ellipse", "ellipse_4", "ellipse_flat", "stadium", "rounded_rectangle", "rounded_square", "annulus",
    "annulus_thin", "eccentric_ring", "dumbbell", "heart", "kidney", "blob", "blob_holes",
}  # fmt: skip
RANDOM: dict[str, Callable[[int], Json]] = {
    "polygon": polygon_random,
    "line_arc": lambda seed: star_shaped(seed, 6 + seed % 9, "la", seed % 3),
    "mixed": lambda seed: star_shaped(seed, 5 + seed % 9, "laqc", seed % 4),
}
SAME_NODE = 1e-9  # of the size


def domain_of(content: Json) -> Domain:
    """Without what is known of its axis."""
    return Domain.from_dict({"outer": content["outer"], "holes": content.get("holes", [])})


def assert_same(one: MedialAxis, other: MedialAxis) -> None:
    """Nodes matched one to one, by disc and kind; as many segments between each pair of them; the same cycles."""
    assert one.graph.cycles == other.graph.cycles
    assert len(one.nodes) == len(other.nodes)
    apart = np.abs(one.node_discs[:, None] - other.node_discs[None]).max(axis=2)
    mine, theirs = linear_sum_assignment(apart)
    assert apart[mine, theirs].max(initial=0.0) <= SAME_NODE * one.domain.size
    match = dict(zip(mine.tolist(), theirs.tolist(), strict=True))
    assert all(one.nodes[a].kind == other.nodes[b].kind for a, b in match.items())
    ends = Counter(frozenset((match[s.start_node], match[s.end_node])) for s in one.segments if s.start_node is not None)
    assert ends == Counter(frozenset((s.start_node, s.end_node)) for s in other.segments if s.start_node is not None)
    assert sum(one.lengths) == pytest.approx(sum(other.lengths), rel=1e-5)


def check(content: Json, **options: Any) -> MedialAxis:
    """March, and compare."""
    domain = domain_of(content)
    axis = medial_axis(domain, method="march", **options)
    assert axis.certificate["passed"] is True
    assert_same(axis, medial_axis(domain))
    return axis


# Where it succeeds -----------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", sorted(set(CATALOGUE) - SMOOTH))
def test_march_equals_discs_on_families(name: str) -> None:
    check(CATALOGUE[name]())


@pytest.mark.parametrize("figure", sorted(PAPER_SHAPES))
def test_march_equals_discs_on_shapes_after_the_figures(figure: str) -> None:
    check(PAPER_SHAPES[figure]())


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("family", sorted(RANDOM))
def test_march_equals_discs_on_random_shapes(family: str, seed: int) -> None:
    check(RANDOM[family](seed))


def test_march_equals_discs_on_outlines() -> None:
    """All outlines that have a convex vertex and not so short an edge that the default step is tiny."""
    with gzip.open(CORPUS, "rt", encoding="utf-8") as lines:
        outlines = [json.loads(text) for text in lines]
    refused = 0
    for content in outlines:
        try:
            check(content, step=5e-3)
        except UnsupportedOption:
            refused += 1
    assert refused == 2  # rings and blobs without a convex vertex


@pytest.mark.parametrize(("step", "check_step"), [(1e-3, 1), (1e-3, 100), (1e-2, 10), (1e-1, 1)])
def test_steps_do_not_change_what_they_find(step: float, check_step: int) -> None:
    check(illustration(), step=step, check_step=check_step)


def test_the_example_of_section_5_7() -> None:
    """Leaves A, G, F, D, E; three branch points; N1 and N2, where the fan of B begins and ends, S1 at the smooth corner C."""
    axis = check(illustration())
    leaves = {tuple(round(v, 12) for v in node.point) for node in axis.nodes if node.kind == "convex_vertex"}
    assert leaves == {(0.0, 1.0), (0.0, 2.2), (3.4, 2.2), (1.7, -1.2), (3.4, -1.2)}
    assert Counter(node.kind for node in axis.nodes) == {"convex_vertex": 5, "branch": 3}
    assert len(axis.segments) == 7
    # B2 touches B, FG and EF; at B with a normal of its own
    (at_b,) = [node for node in axis.nodes if any(foot.angle is not None for foot in node.footpoints)]
    assert {foot.edge for foot in at_b.footpoints} == {1, 4, 5}
    # the discs between two pairs of edges: contacts at both ends of the fan, and at C
    assert np.count_nonzero(axis.skeleton.contact_s == 0.0) == 5 + 3
    assert axis.graph.topological_order[0] == 0
    assert axis.nodes[0].point == (0.0, 1.0)


def test_a_motion_moves_the_axis_with_it() -> None:
    content = CATALOGUE["mixed_holes"]()
    for moved in (rotated(content, 0.7), scaled(content, 1e4), shifted(content, 300.0, -200.0)):
        check(moved)


def test_a_tie_of_many_edges_is_one_branch_point() -> None:
    axis = check(CATALOGUE["heptagon"]())
    assert [node.kind for node in axis.nodes].count("branch") == 1


def test_holes_in_a_row() -> None:
    holes = [circle_hole((-0.6, 0.0), 0.2), circle_hole((0.6, 0.1), 0.2), circle_hole((0.0, 0.0), 0.1)]
    assert check(shape("row", rectangle()["outer"], holes)).graph.cycles == 3


def test_a_whole_arc_in_contact_ends_a_segment() -> None:
    assert "arc_center" in {node.kind for node in check(PAPER_SHAPES["19"]()).nodes}


def test_a_curvature_centre_ends_a_segment() -> None:
    assert "curvature_center" in {node.kind for node in check(twice()).nodes}


def test_a_curvature_centre_beside_a_reflex_vertex_ends_a_segment() -> None:
    """The curvature of an edge is largest where a reflex vertex follows it."""
    bump = {"degree": 2, "control_points": [[3, 2], [1.9, 2.2], [1.95, 1.5]]}
    outer = [line((0, 0), (3, 0)), line((3, 0), (3, 2)), bump, line((1.95, 1.5), (0, 1.5)), line((0, 1.5), (0, 0))]
    check(shape("bump", outer))


@pytest.mark.parametrize("step", [None, 1e-2, 1e-3, 3e-4])
def test_two_curvature_centres_that_share_a_branch_point(step: float | None) -> None:
    # round ends of quadratics, where the disc of one maximum of the curvature nearly osculates the boundary beside the other:
    # a "greater than", and the side of a "w" that comes to its corners with such ends
    for text in (
        "170,-41 170,-15 197,-2|1284,512|190,1030|170,1036 170,1065|170,1079 181.5,1092.5|193,1106 211,1106|215,1106 227,1102|"
        "1403,547|1421,538 1421,512|1421,485 1397,475|227,-78|215,-82 211,-82|193,-82 181.5,-68.5|170,-55 170,-41",
        "125,-9 123,0 121,29|117,120|109,284 90,362|83,389 74.5,396.5|66,404 43,404|15,404|15,417|94,430 110,434|"
        "115,435 121.5,437|128,439 132,440|136,441 139,441|147,441 150,436|153,431 158,407|"
        "183,287 190,126|230,137|198,76|149,-18 134,-18|127,-18 125,-9",
    ):
        outer: list[Any] = []
        for part in text.split("|"):
            points = [tuple(float(c) for c in p.split(",")) for p in part.split()]
            outer.append(bezier([outer[-1]["control_points"][-1], *points] if outer else points))
        check({"outer": outer}, step=step)


def test_the_nearest_point_of_a_piece_that_dips_beside_its_end() -> None:
    rng = np.random.default_rng(2)
    s = np.linspace(0.0, 1.0, 4001)
    dips = 0
    for content in [CATALOGUE[name]() for name in ("mixed", "heart", "kidney", "blob_holes", "thorn", "lens")]:
        table = build_sites(domain_of(content), 1e-6, LADDER[0])
        for site in np.flatnonzero(table.si[:, KIND] == SPIRAL).tolist():
            frames = np.array([evaluate(table.si, table.sf, table.cp, site, at, 0.0, 0.0) for at in s])
            for end in (0, -1):
                x, y, tx, ty, k, _ = frames[end]
                if not k > 0.0:
                    continue
                # near the centre of a disc that touches at the end and is a little larger than the boundary bends there
                r = (1.0 + 10.0 ** rng.uniform(-6, -1)) / k
                aside = 10.0 ** rng.uniform(-8, -2) * r * (1 if end == 0 else -1)
                p = (x - r * ty - aside * tx, y + r * tx - aside * ty)
                found, at = nearest(table, site, 0.0, 1.0, *p)
                dense = np.hypot(frames[:, 0] - p[0], frames[:, 1] - p[1])
                assert found <= dense.min() + 1e-15
                dips += 0.0 < at < 0.125 or 0.875 < at < 1.0
    assert dips > 5


def test_a_nearly_smooth_corner_is_a_leaf() -> None:
    check(shape("bent", polyline([(0, 0), (1, -3e-4), (2, 0), (2, 1), (0, 1)])))


# Where it does not -----------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", sorted(SMOOTH))
def test_without_a_convex_vertex_there_is_no_start(name: str) -> None:
    with pytest.raises(UnsupportedOption, match=r"convex vertex.*discs") as refusal:
        medial_axis(domain_of(CATALOGUE[name]()), method="march")
    assert refusal.value.option == "method"


def test_steps_that_pass_over_a_hole_are_an_error_at_the_hole() -> None:
    domain = domain_of(small_hole())
    with pytest.raises(NotCertified, match=r'loop 1 was never met.*method "discs"') as failure:
        medial_axis(domain, method="march", step=0.02)
    assert failure.value.place is not None
    assert math.dist(failure.value.place, (2.3, 0.25)) == pytest.approx(0.04)
    check(small_hole(), step=0.02, check_step=1)


@pytest.mark.parametrize("step", [None, 1e-3, 1e-4])
def test_proposition_2_misses_a_hole_in_a_corner_with_any_step(step: float | None) -> None:
    with pytest.raises(NotCertified, match="loop 1 was never met"):
        medial_axis(domain_of(pocket()), method="march", step=step, check_step=1)


def test_the_place_of_an_error_is_in_the_callers_coordinates() -> None:
    moved = shifted(scaled(pocket(), 1e3), 5e3, -7e3)
    with pytest.raises(NotCertified) as failure:
        medial_axis(domain_of(moved), method="march")
    assert failure.value.place is not None
    assert math.dist(failure.value.place, (5e3 + 3930, -7e3 + 70)) == pytest.approx(40)


@pytest.mark.parametrize("step", [0.02, 0.05, 0.1, 0.2, 0.5, 2.0, 1e300])
@pytest.mark.parametrize("check_step", [1, 3, 10, 10**6])
def test_a_coarse_march_is_right_or_an_error(step: float, check_step: int) -> None:
    for content in (small_hole(), twice(), CATALOGUE["plate"](), CATALOGUE["comb"]()):
        domain = domain_of(content)
        try:
            axis = medial_axis(domain, method="march", step=step, check_step=check_step)
        except NotCertified:
            continue
        assert_same(axis, medial_axis(domain))


@pytest.mark.parametrize("value", [0, -1, 1.5, True, "10", 10**6 + 1, math.nan])
def test_a_check_step_out_of_range(value: Any) -> None:
    with pytest.raises(UnsupportedOption, match="whole number") as refusal:
        medial_axis(domain_of(rectangle()), method="march", check_step=value)
    assert refusal.value.option == "check_step"


@pytest.mark.parametrize("value", [0.0, -1.0, 1e-7, math.inf, math.nan])
def test_a_step_out_of_range(value: float) -> None:
    with pytest.raises(UnsupportedOption) as refusal:
        medial_axis(domain_of(rectangle()), method="march", step=value)
    assert refusal.value.option == "step"


def test_too_many_steps_are_refused_beforehand() -> None:
    with pytest.raises(UnsupportedOption, match="2000000") as refusal:
        medial_axis(domain_of(rectangle()), method="march", step=1e-6)
    assert refusal.value.option == "step"
    named = re.search(r"give (\S+) or more", str(refusal.value))
    assert named is not None
    assert float(named[1]) == pytest.approx(3 / 2e6, rel=0.1)  # its boundary is three times its size


def test_an_edge_that_is_tiny_among_others_does_not_make_the_default_step_as_tiny() -> None:
    nicked = shape("nicked", polyline([(0, 0), (1, 0), (1, 1), (0.5, 1), (0.5 - 1e-6, 1 + 1e-6), (0, 1)]))
    table = build_sites(domain_of(nicked), 1e-6, LADDER[0])
    size = domain_of(nicked).size * table.scale
    assert 4 / 200_000 < default_step(table, size) / table.scale < 5 / 200_000  # four sides, and the normals of a fan
    check(nicked, step=1e-3)
    ordinary = build_sites(domain_of(rectangle()), 1e-6, LADDER[0])
    size = domain_of(rectangle()).size * ordinary.scale
    assert default_step(ordinary, size) == 1e-3 * size


def test_an_unknown_method_names_those_there_are() -> None:
    with pytest.raises(UnsupportedOption, match="discs, march"):
        medial_axis(domain_of(rectangle()), method="voronoi")
