"""Shapes whose axis can be written down: leaves, cycles, node kinds and exact discs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import pytest

from tests.assertions import assert_truth, piece_kinds
from tests.families import CATALOGUE, annulus, cross, gear, hole_grid, ngon

Json = dict[str, Any]
Solve = Callable[..., Json]

# what the nodes are, where symmetry leaves no doubt
KINDS: dict[str, dict[str, int]] = {
    "rectangle": {"convex_vertex": 4, "branch": 2},
    "square": {"convex_vertex": 4, "branch": 1},
    "square_one_edge": {"convex_vertex": 4, "branch": 1},
    "triangle": {"convex_vertex": 3, "branch": 1},
    "hexagon": {"convex_vertex": 6, "branch": 1},
    "ngon_32": {"convex_vertex": 32, "branch": 1},
    "cross": {"convex_vertex": 8, "branch": 5},
    "tee": {"convex_vertex": 6, "branch": 4},
    "ell": {"convex_vertex": 5, "branch": 3},
    "ellipse": {"curvature_center": 2},
    "ellipse_4": {"curvature_center": 2},
    "stadium": {"arc_center": 2},
    "rounded_rectangle": {"arc_center": 4, "branch": 2},
    "half_disc": {"convex_vertex": 2},
    "parabola_cap": {"convex_vertex": 2, "curvature_center": 1, "branch": 1},
    "lens": {"convex_vertex": 2},
    "lens_one_edge": {"convex_vertex": 2},
    "arc_lens": {"convex_vertex": 2},
    "dumbbell": {"arc_center": 2},
    "circle": {"point": 1},
    "circle_3": {"point": 1},
    "annulus": {},
    "annulus_thin": {},
    "eccentric_ring": {},
    "square_round_hole": {"convex_vertex": 4, "branch": 4},
}

# what the segments are, where lines, points and arcs make exact conics
SEGMENTS: dict[str, set[str]] = {
    "rectangle": {"line"},
    "hexagon": {"line"},
    "ell": {"line", "parabola"},
    "stadium": {"line"},
    "half_disc": {"parabola"},
    "eccentric_ring": {"ellipse"},
    "square_round_hole": {"line", "parabola"},
    "arc_lens": {"line"},
}


@pytest.mark.parametrize("name", sorted(CATALOGUE))
def test_truth(name: str, solve: Solve) -> None:
    domain = CATALOGUE[name]()
    assert_truth(domain, solve(domain), 1e-6)
    assert_truth(domain, solve(domain, tolerance=5e-10))


@pytest.mark.parametrize("name", sorted(KINDS))
def test_node_kinds(name: str, solve: Solve) -> None:
    nodes = solve(CATALOGUE[name]())["graph"]["nodes"]
    assert Counter(n["kind"] for n in nodes) == KINDS[name]


@pytest.mark.parametrize("name", sorted(SEGMENTS))
def test_exact_pairs_are_conics(name: str, solve: Solve) -> None:
    kinds = {kind for s in solve(CATALOGUE[name]())["segments"] for kind in piece_kinds(s)}
    assert kinds == SEGMENTS[name]


@pytest.mark.parametrize("n", [3, 5, 8, 13, 60])
def test_ngon_has_one_node(n: int, solve: Solve) -> None:
    domain = ngon(n)
    answer = solve(domain)
    assert_truth(domain, answer)
    assert len(answer["segments"]) == n
    assert len(answer["graph"]["nodes"]) == n + 1


@pytest.mark.parametrize("arms", [3, 4, 6])
def test_cross_has_a_node_for_all_arms(arms: int, solve: Solve) -> None:
    domain = cross(arms)
    answer = solve(domain)
    assert_truth(domain, answer)
    ends = Counter(e for s in answer["segments"] for e in (s["start_node"], s["end_node"]))
    assert max(ends.values()) == arms


@pytest.mark.parametrize(("inner", "offset"), [(0.1, 0.0), (0.9, 0.0), (0.999, 0.0), (0.5, 0.1), (0.2, 0.79)])
def test_ring_is_one_closed_segment(inner: float, offset: float, solve: Solve) -> None:
    domain = annulus(inner, offset)
    answer = solve(domain)
    assert_truth(domain, answer)
    assert [(s["start_node"], s["end_node"]) for s in answer["segments"]] == [(None, None)]
    assert answer["graph"]["nodes"] == []


@pytest.mark.parametrize("radius", [0.05, 0.3, 0.49])
def test_grid_of_holes(radius: float, solve: Solve) -> None:
    domain = hole_grid(4, 3, radius)
    answer = solve(domain)
    assert_truth(domain, answer)
    ends = Counter(e for s in answer["segments"] for e in (s["start_node"], s["end_node"]))
    assert sum(d == 4 for d in ends.values()) == 6


@pytest.mark.parametrize("teeth", [3, 24, 60])
def test_gear(teeth: int, solve: Solve) -> None:
    domain = gear(teeth)
    assert_truth(domain, solve(domain))
