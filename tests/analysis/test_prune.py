"""Pruning: what stays is one piece with all cycles, what goes is listed, and each rule keeps its word."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from mat_core import MedialAxis
from mat_core.analysis import PrunedAxis, inscribed_disc, nearest, prune
from mat_core.errors import UnsupportedOption
from tests.analysis.shapes import all_axes, of
from tests.assertions import Answer
from tests.curves.shapes import solved
from tests.families import CATALOGUE, arc, line, polyline, rectangle
from tests.transforms import restarted, reversed_loops, rotated

RULES: list[dict[str, float]] = [
    {"angle": math.radians(100.0)}, {"angle": math.pi}, {"radius_ratio": 1.3}, {"scale": 1.2}, {"scale": 2.0},
    {"length": math.inf},
    {"scale": 1.1, "angle": 1.0, "radius_ratio": 1.1, "length": 0.1},
]


class Unit:
    """The frame that changes nothing."""

    frame = (np.zeros(2), 1.0)


def kept_places(pruned: PrunedAxis) -> list[tuple[int, float, float]]:
    return [(s.segment, s.t0, s.t1) for s in pruned.segments]


def check(axis: MedialAxis, pruned: PrunedAxis) -> None:
    """Topology stays, and kept and cut places make up the axis without a gap or an overlap."""
    everything = kept_places(pruned) + [p for c in pruned.cuts for p in c.places]
    for segment in axis.segments:
        own = sorted((t0, t1) for g, t0, t1 in everything if g == segment.id)
        assert own[0][0] == 0.0
        assert own[-1][1] == 1.0
        assert all(a[1] == b[0] for a, b in pairwise(own))
    parent = list(range(len(pruned.nodes)))

    def root(v: int) -> int:
        while parent[v] != v:
            v = parent[v]
        return v

    closed = 0
    for s in pruned.segments:
        if s.start_node is None or s.end_node is None:
            closed += 1
            continue
        parent[root(s.start_node)] = root(s.end_node)
        for node, t in ((s.start_node, s.t0), (s.end_node, s.t1)):
            there = axis.segments[s.segment].evaluate(t)
            found = pruned.nodes[node]
            assert [*found.point, found.radius] == pytest.approx(there.tolist(), abs=3e-6 * axis.domain.size)
    components = len({root(v) for v in range(len(parent))}) + closed
    assert components == pruned.components == axis.graph.components
    open_segments = len(pruned.segments) - closed
    assert open_segments - len(pruned.nodes) + components == pruned.cycles == axis.graph.cycles
    degree = [0] * len(pruned.nodes)
    for s in pruned.segments:
        for v in (s.start_node, s.end_node):
            if v is not None:
                degree[v] += 1
    for node in pruned.nodes:
        assert (node.kind == "point") == (degree[node.id] == 0)
        assert (node.kind == "through") == (degree[node.id] == 2)
        assert (node.kind == "branch") == (degree[node.id] > 2)
        assert node.footpoints
    assert sorted(i for chain in pruned.chains for i, _ in chain) == list(range(len(pruned.segments)))


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_topology_never_changes(rule: dict[str, float]) -> None:
    for axis in all_axes():
        pruned = prune(axis, **rule)
        check(axis, pruned)
        if axis.graph.cycles == 0:
            largest = inscribed_disc(axis)
            assert max(n.radius for n in pruned.nodes) <= largest.radius + 1e-12
            where = [(s.segment, s.t0, s.t1) for s in pruned.segments]
            inside = any(g == largest.segment and t0 <= (largest.t or 0.0) <= t1 for g, t0, t1 in where)
            assert inside or any(n.radius == pytest.approx(largest.radius, abs=3e-6) for n in pruned.nodes)


def test_everything_of_a_tree_but_its_largest_disc_can_go() -> None:
    for name in ("rectangle", "ellipse", "comb", "dumbbell"):
        axis = solved(name)
        pruned = prune(axis, length=math.inf)
        largest = inscribed_disc(axis)
        (node,) = pruned.nodes
        assert pruned.segments == ()
        assert (node.kind, node.id, node.node) == ("point", 0, largest.node)
        assert (node.point, node.radius) == (largest.point, largest.radius)
        assert sum(c.length for c in pruned.cuts) == pytest.approx(axis.lengths.sum(), rel=1e-12)
        document = pruned.to_dict()
        assert document["segments"] == []
        assert len(document["graph"]["nodes"]) == 1
    ring = prune(solved("annulus"), length=math.inf)
    assert (len(ring.segments), ring.cuts) == (1, ())
    assert prune(solved("circle"), scale=5.0).nodes[0].kind == "point"


@pytest.mark.parametrize(("rule", "less", "more"), [
    ("angle", math.radians(89.9), math.radians(90.1)), ("radius_ratio", 1.41421, 1.41422), ("scale", 1.41421, 1.41422),
    ("length", 0.70710, 0.70711),
])
def test_corners_of_a_rectangle_go_at_the_values_of_a_right_angle(rule: str, less: float, more: float) -> None:
    axis = of(rectangle(3.0, 1.0))
    options: dict[str, Any] = {rule: less}
    assert prune(axis, **options).cuts == ()
    options = {rule: more}
    pruned = prune(axis, **options)
    assert len(pruned.segments) == 1
    assert [n.kind for n in pruned.nodes] == ["cut", "cut"]
    for cut in pruned.cuts:
        assert (cut.reason, cut.length, cut.radius_ratio) == (rule, pytest.approx(math.sqrt(0.5)), pytest.approx(math.sqrt(2.0)))


def test_a_dent_of_noise_goes_and_the_corners_stay() -> None:
    axis = of({"outer": polyline([(0, 0), (3, 0), (3, 1), (1.51, 1), (1.5, 1.004), (1.49, 1), (0, 1)])})
    for rule in ({"scale": 1.1}, {"angle": math.radians(60.0)}, {"radius_ratio": 1.05}):
        pruned = prune(axis, **rule)
        check(axis, pruned)
        tips = sorted(n.kind for n in pruned.nodes if n.kind not in ("branch", "through"))
        assert tips == ["convex_vertex"] * 4
        assert pruned.cuts


def test_the_angle_is_kept_at_the_cut() -> None:
    angle = math.radians(100.0)
    for axis in all_axes():
        for cut in prune(axis, angle=angle).cuts:
            for g, t0, t1 in cut.places:
                slope = np.abs(axis.segments[g].dr_ds(np.linspace(t0, t1, 25)[1:-1]))
                assert np.all(2.0 * np.arccos(slope) <= angle + 1e-6)


@pytest.mark.parametrize("scale", [1.15, 1.5, 3.0])
def test_every_disc_the_scale_axis_cuts_is_covered(scale: float) -> None:
    t = np.linspace(0.0, 1.0, 161)
    for axis in all_axes():
        if not axis.segments:
            continue
        pruned = prune(axis, scale=scale)
        kept = [axis.segments[g].evaluate(t0 + (t1 - t0) * t) for g, t0, t1 in kept_places(pruned)]
        left = np.concatenate([*kept, [[*n.point, n.radius] for n in pruned.nodes] or np.empty((0, 3))])
        for cut in pruned.cuts:
            for g, t0, t1 in cut.places:
                gone = axis.segments[g].evaluate(np.linspace(t0, t1, 9))
                apart = np.hypot(*(gone[:, None, :2] - left[None, :, :2]).transpose(2, 0, 1))
                over = scale * (left[None, :, 2] - gone[:, None, 2]) - apart
                # the coverer may lie between two samples
                assert np.all(over.max(axis=1) >= -0.02 * axis.domain.size), (axis, g, over.max(axis=1).min())


def test_more_scale_cuts_more() -> None:
    for axis in all_axes()[::2]:
        total = [sum(c.length for c in prune(axis, scale=s).cuts) for s in (1.0, 1.1, 1.3, 1.8, 3.0)]
        assert total[0] == 0.0
        assert all(a <= b + 1e-9 for a, b in pairwise(total))


@pytest.mark.parametrize("rule", RULES, ids=str)
@pytest.mark.parametrize("name", ["comb", "mixed", "gear"])
def test_the_description_of_the_domain_decides_nothing(name: str, rule: dict[str, float]) -> None:
    plain = sorted(c.length for c in prune(solved(name), **rule).cuts)
    for change in (lambda d: rotated(d, 0.7), reversed_loops, restarted):
        other = sorted(c.length for c in prune(of(change(CATALOGUE[name]())), **rule).cuts)
        assert sum(other) == pytest.approx(sum(plain), abs=2e-3)
        if rule.get("length") != math.inf:
            assert len(other) == len(plain)


def test_the_document_has_the_curves_of_what_is_kept() -> None:
    s = np.linspace(0.0, 1.0, 33)
    for name in ("mixed", "spiral", "ellipse", "gear", "blob_holes"):
        axis = solved(name)
        document = prune(axis, angle=math.radians(120.0)).to_dict()
        answer = Answer(document, Unit())  # type: ignore[arg-type]
        for i, entry in enumerate(document["segments"]):
            t0, t1 = entry["t"]
            wanted = axis.segments[entry["segment"]].evaluate(t0 + (t1 - t0) * s)
            found = answer.axis.points(np.full(len(s), i), s)
            assert np.abs(found - wanted).max() <= 1e-12
            assert entry["pieces"][0]["t"][0] == 0.0
            assert entry["pieces"][-1]["t"][1] == pytest.approx(1.0, abs=1e-15)


def test_bad_options_are_refused() -> None:
    axis = solved("ell")
    for options in ({"angle": 4.0}, {"length": -1.0}, {"radius_ratio": 0.9}, {"scale": 0.5}, {"scale": math.nan}):
        with pytest.raises(UnsupportedOption, match=next(iter(options))):
            prune(axis, **options)
    with pytest.raises(UnsupportedOption, match="nothing to prune by"):
        prune(axis)


@pytest.mark.parametrize("name", ["rectangle", "annulus", "blob_holes", "mixed", "comb"])
def test_samples_walk_along_the_chains(name: str) -> None:
    axis = solved(name)
    pruned = prune(axis, angle=1.8)
    spacing = 0.01 * axis.domain.size
    lines = pruned.sample(spacing)
    assert len(lines) == len(pruned.chains)
    for chain, discs in zip(pruned.chains, lines, strict=True):
        steps = np.hypot(*np.diff(discs[:, :2], axis=0).T)
        assert steps.max() <= spacing * (1.0 + 1e-9)
        kept = [pruned.segments[i] for i, _ in chain]
        length = sum(axis.segments[s.segment].arc_length(s.t0, s.t1) for s in kept)
        assert steps.sum() == pytest.approx(length, rel=1e-3)
        found = nearest(axis, discs[:, :2])
        assert found.distance.max() <= 1e-12 * axis.domain.size
        assert np.abs(found.radii - discs[:, 2]).max() <= 1e-7 * axis.domain.size


def test_samples_of_a_point_are_its_disc() -> None:
    axis = solved("circle")
    (line,) = prune(axis, length=1.0).sample(0.1)
    assert line.tolist() == axis.node_discs.tolist()


@pytest.mark.parametrize("spacing", [0.0, -1.0, math.inf, math.nan])
def test_spacings_that_are_none(spacing: float) -> None:
    with pytest.raises(UnsupportedOption):
        prune(solved("rectangle"), angle=1.0).sample(spacing)


def finger() -> MedialAxis:
    """A room, a corridor and a finger off it: the end of the finger is inside the grown disc of the room, not of the corridor."""
    x, y, r = 1.5, 0.9, 0.065
    points = [(x - r, y), (x - r, 0.45), (1.0, 0.45), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, -0.45),
              (2.0, -0.45), (2.0, 0.45), (x + r, 0.45), (x + r, y)]
    lines = [line(a, b) for a, b in pairwise(points)]
    return of({"outer": [*lines, arc((x, y), r, 0.0, 0.5 * math.pi), arc((x, y), r, 0.5 * math.pi, math.pi)]})


def test_a_finger_goes_that_two_discs_cover_only_together() -> None:
    assert not any(n.kind == "arc_center" for n in prune(finger(), scale=2.0).nodes)


@pytest.mark.parametrize("scale", [1.2, 1.5, 2.0])
def test_no_disc_at_a_tip_is_inside_any_other_grown_one(scale: float) -> None:
    for axis in [*all_axes(), finger()]:
        if not axis.segments:
            continue
        pruned = prune(axis, scale=scale)
        each = np.linspace(0.0, 1.0, 25)
        every = axis.evaluate(np.repeat(np.arange(len(axis.segments)), 25), np.tile(each, len(axis.segments)))[:, :3]
        degree = np.bincount([v for s in pruned.segments for v in (s.start_node, s.end_node) if v is not None], minlength=1)
        for s in pruned.segments:
            for node, t0, t1 in ((s.start_node, s.t0, s.t1), (s.end_node, s.t1, s.t0)):
                if node is None or degree[node] != 1:
                    continue
                x, y, r = axis.segments[s.segment].evaluate(t0 + 1e-3 * (t1 - t0))
                larger = every[every[:, 2] > pruned.nodes[node].radius + 1e-9]
                over = scale * (larger[:, 2] - r) - np.hypot(larger[:, 0] - x, larger[:, 1] - y)
                assert over.max(initial=-1.0) <= 2e-3 * axis.domain.size, (axis, s, over.max())
