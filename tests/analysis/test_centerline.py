"""The longest path: closed forms, and all pairs of nodes by networkx."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mat_core.analysis import centerline
from mat_core.errors import UnsupportedOption
from tests.analysis.shapes import all_axes, of
from tests.curves.shapes import solved
from tests.families import CATALOGUE, dumbbell, rectangle
from tests.transforms import reversed_loops, rotated

networkx = pytest.importorskip("networkx")


def test_it_is_the_longest_shortest_path_and_its_parts_fit() -> None:
    for axis in all_axes():
        found = centerline(axis)
        graph = networkx.MultiGraph()
        graph.add_nodes_from(range(len(axis.nodes)))
        graph.add_edges_from((a, b, {"length": axis.lengths[g]}) for g, a, b in axis.graph.edges if a is not None)
        for k, (g, forward) in enumerate(found.path):
            if not found.closed:
                ends = (axis.segments[g].start_node, axis.segments[g].end_node)
                assert (found.nodes[k], found.nodes[k + 1]) == (ends if forward else ends[::-1])
        assert found.length == pytest.approx(sum(axis.lengths[g] for g, _ in found.path), rel=1e-12)
        if len(axis.nodes) > 1:
            reached = dict(networkx.all_pairs_dijkstra_path_length(graph, weight="length"))
            longest = max(max(own.values()) for own in reached.values())
            assert found.length == pytest.approx(longest, rel=1e-12)
            assert found.bound == pytest.approx(longest, rel=1e-9)
        found.to_dict()


def test_closed_forms() -> None:
    # a leaf, the spine and a leaf
    assert centerline(of(rectangle(3.0, 1.0))).length == pytest.approx(2.0 + math.sqrt(2.0), abs=1e-13)
    a, b = 2.0, 1.0
    ellipse = centerline(solved("ellipse"))
    assert ellipse.length == pytest.approx(2.0 * (a - b * b / a), abs=1e-5)
    assert (ellipse.before, ellipse.after) == (None, None)
    long = centerline(solved("ellipse"), extend=True)
    assert long.length == pytest.approx(2.0 * a, abs=1e-5)
    assert long.before is not None
    assert long.after is not None
    assert {round(long.before.end[0], 9), round(long.after.end[0], 9)} == {-2.0, 2.0}
    stadium = centerline(solved("stadium"), extend=True)
    assert stadium.length == pytest.approx(4.0, abs=1e-12)
    rect = centerline(of(rectangle()), extend=True)
    assert (rect.before, rect.after) == (None, None)
    ring = centerline(solved("annulus"))
    assert (ring.closed, ring.nodes, ring.path) == (True, (), ((0, True),))
    assert ring.length == pytest.approx(math.tau * 0.7, rel=1e-13)
    disc = centerline(solved("circle"), extend=True)
    assert (disc.path, disc.nodes, disc.length) == ((), (0,), 0.0)
    assert disc.sample().shape == (1, 3)


def test_extensions_end_on_the_boundary_straight_on() -> None:
    for axis in all_axes():
        found = centerline(axis, extend=True)
        for extension in (found.before, found.after):
            if extension is not None:
                leaf = axis.nodes[extension.node]
                assert leaf.kind in ("curvature_center", "arc_center")
                assert math.dist(extension.start, extension.end) == pytest.approx(leaf.radius, rel=1e-9)
                ends = [s for s in axis.segments if extension.node in (s.start_node, s.end_node)]
                t = 0.0 if ends[0].start_node == extension.node else 1.0
                along = ends[0].tangent(t) * (1.0 if t else -1.0)
                assert np.subtract(extension.end, extension.start) == pytest.approx(leaf.radius * along, abs=1e-4 * leaf.radius)


def test_samples_are_even_and_start_and_end_where_the_path_does() -> None:
    for axis in all_axes():
        found = centerline(axis, extend=True)
        if not found.path:
            continue
        spacing = found.length / 37.5
        discs = found.sample(spacing)
        steps = np.hypot(*np.diff(discs[:, :2], axis=0).T)
        assert len(discs) == 39
        assert steps.max() <= spacing * (1.0 + 1e-9)
        assert np.all(np.abs(np.diff(discs[:, 2])) <= steps + 1e-5 * axis.domain.size)
        if found.before is not None:
            assert discs[0].tolist() == pytest.approx([*found.before.end, 0.0], abs=1e-12)
        elif found.nodes:
            first = axis.nodes[found.nodes[0]]
            assert discs[0].tolist() == pytest.approx([*first.point, first.radius], abs=3e-6)
        if found.after is not None:
            assert discs[-1].tolist() == pytest.approx([*found.after.end, 0.0], abs=1e-9)
    for bad in (0.0, -1.0, math.nan):
        with pytest.raises(UnsupportedOption, match="spacing"):
            centerline(solved("ell")).sample(bad)


def test_a_hair_thin_neck_keeps_its_length() -> None:
    narrow = centerline(of(dumbbell(1e-6)))
    assert narrow.length == pytest.approx(4.0, abs=1e-9)
    gaps = np.hypot(*np.diff(narrow.sample()[:, :2], axis=0).T)
    assert gaps == pytest.approx(np.full(100, 0.04), abs=1e-9)


@pytest.mark.parametrize("name", ["mixed", "gear", "hole_grid"])
def test_the_description_of_the_domain_decides_nothing(name: str) -> None:
    plain = centerline(solved(name)).length
    for change in (lambda d: rotated(d, 0.7), reversed_loops):
        assert centerline(of(change(CATALOGUE[name]()))).length == pytest.approx(plain, rel=1e-5)
