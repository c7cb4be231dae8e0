"""What one does with a MedialAxis in hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mat_core import Domain, medial_axis
from tests.curves.shapes import solved
from tests.families import polyline


def rectangle(x: float = 0.0, y: float = 0.0, unit: float = 1.0) -> Domain:
    points = [(x + unit * a, y + unit * b) for a, b in [(0, 0), (3, 0), (3, 1), (0, 1)]]
    return Domain.from_dict({"outer": polyline(points)})


def test_repr_tells_what_it_is() -> None:
    axis = medial_axis(rectangle())
    assert "6 nodes, 5 segments, 0 cycles" in repr(axis)
    assert repr(axis.segments[0]).startswith("<Segment 0: ")


@pytest.mark.parametrize(("x", "y", "unit"), [(0, 0, 1), (1e6, -1e6, 1), (0, 0, 1e9), (5e-9, 0, 1e-9)])
def test_everything_is_in_the_callers_coordinates(x: float, y: float, unit: float) -> None:
    axis = medial_axis(rectangle(x, y, unit))
    slack = 1e-12 * unit + 4e-16 * max(abs(x), abs(y))
    spine = next(s for s in axis.segments if s.length == pytest.approx(2 * unit))
    disc = spine.evaluate(0.5)
    assert disc.shape == (3,)
    assert np.abs(disc - [x + 1.5 * unit, y + 0.5 * unit, 0.5 * unit]).max() <= slack
    left, right = spine.footpoints(0.25)
    across = np.subtract(left.point, right.point)
    assert np.hypot(*across) == pytest.approx(unit, rel=1e-9)
    branch = sorted(n.point for n in axis.nodes if n.kind == "branch")
    assert np.abs(np.subtract(branch, [(x + u * unit, y + 0.5 * unit) for u in (0.5, 2.5)])).max() <= slack
    assert {n.radius for n in axis.nodes if n.kind == "convex_vertex"} == {0.0}


def test_evaluate_takes_any_shape() -> None:
    s = medial_axis(rectangle()).segments[0]
    t = np.linspace(0, 1, 6).reshape(2, 3)
    assert s.evaluate(t).shape == (2, 3, 3)
    assert np.array_equal(s.evaluate(-1.0), s.evaluate(0.0))
    assert s.evaluate([]).shape == (0, 3)


def test_derivative_is_the_slope() -> None:
    for name in ("mixed", "gear", "blob_holes"):
        for s in solved(name).segments:
            t = np.linspace(0.05, 0.95, 7)
            t = t[np.min(np.abs(t[:, None] - s.knots), axis=1) > 1e-5]
            slope = (s.evaluate(t + 1e-6) - s.evaluate(t - 1e-6)) / 2e-6
            scale = np.abs(slope).max(initial=0) + 1e-300
            assert np.abs(s.evaluate(t, derivative=True) - slope).max(initial=0) <= 1e-3 * scale


def test_nodes_know_their_contacts() -> None:
    axis = solved("ell")
    for node in axis.nodes:
        assert node.footpoints
        for foot in node.footpoints:
            assert math.dist(foot.point, node.point) == pytest.approx(node.radius, abs=1e-12)
            if foot.angle is not None:
                direction = np.subtract(node.point, foot.point) / node.radius
                assert direction @ [math.cos(foot.angle), math.sin(foot.angle)] == pytest.approx(1, abs=1e-12)


def test_normals_in_a_fan_have_an_angle() -> None:
    axis = solved("ell")
    feet = [f for s in axis.segments for t in np.linspace(0.02, 0.98, 25) for f in s.footpoints(t)]
    fans = [f for f in feet if f.angle is not None]
    assert fans
    assert len({f.point for f in fans}) == 1
    assert len({f.angle for f in fans}) > 3


def test_graph_lists_every_segment() -> None:
    axis = solved("blob_holes")
    assert [edge[0] for edge in axis.graph.edges] == list(range(len(axis.segments)))
    assert sorted(axis.graph.topological_order) == list(range(len(axis.nodes)))
    assert axis.graph.components == 1
    assert axis.graph.cycles == len(axis.domain.holes)


def test_a_disc_has_no_segment() -> None:
    axis = solved("circle")
    assert axis.segments == ()
    assert [n.kind for n in axis.nodes] == ["point"]
    assert axis.lengths.shape == (0,)
    assert axis.to_dict(samples=True)["segments"] == []


def test_certificate_is_attached_to_a_copy() -> None:
    axis = solved("ell")
    other = axis.with_certificate({"passed": True, "checks": {}})
    assert other is not axis
    assert other.certificate == {"passed": True, "checks": {}}
    assert other.curves is axis.curves
