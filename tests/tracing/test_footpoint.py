"""Appendix A: corresponding footpoints against closed forms, and the squared equation (A4) it is held to."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from mat_core import Domain
from mat_core.boundary.sites import SiteTable, build_sites
from mat_core.kernels.curve import evaluate
from mat_core.tolerances import LADDER
from mat_core.tracing.march.checks import curvature_holds, nearest
from mat_core.tracing.march.footpoint import axis_point, corresponding_footpoint, defect
from mat_core.tracing.march.record import Contact, Record, Strip
from tests.families import CATALOGUE, arc, line, polyline, shape
from tests.paper_shapes import object_2, twice

Json = dict[str, Any]


def table_of(content: Json) -> SiteTable:
    """The sites of a shape."""
    domain = Domain.from_dict({"outer": content["outer"], "holes": content.get("holes", [])})
    return build_sites(domain, 1e-6, LADDER[0])


def vectors(t: SiteTable, site: int, s: float) -> tuple[np.ndarray, np.ndarray]:
    """Point and unit tangent."""
    x, y, tx, ty, _, _ = evaluate(t.si, t.sf, t.cp, site, s, 0.0, 0.0)
    return np.array([x, y]), np.array([tx, ty])


@pytest.mark.parametrize("angle", [1e-3, 0.3, 1.2, math.pi / 2, 2.5, math.pi - 1e-3])
def test_in_a_wedge_both_footpoints_are_equally_far_from_the_corner(angle: float) -> None:
    t = table_of(shape("wedge", polyline([(0, 0), (1, 0), (math.cos(angle), math.sin(angle))])))
    for right in (1e-6, 0.01, 0.5, 0.9):
        left = corresponding_footpoint(t, 0, right, 2, 1.0, 0.0, 0.0)
        assert left == pytest.approx(1.0 - right, abs=1e-12)
        point = axis_point(t, 0, right, 2, 1.0 - right)
        assert point is not None
        assert point.r / t.scale == pytest.approx(right * math.tan(angle / 2), rel=1e-9)


def test_opposite_normals_meet_half_way() -> None:
    t = table_of(shape("strip", polyline([(0, 0), (4, 0), (4, 1), (0, 1)])))
    left = corresponding_footpoint(t, 0, 0.4, 2, 0.99, 0.0, 0.01)
    assert left == pytest.approx(0.6, abs=1e-14)
    point = axis_point(t, 0, 0.4, 2, 0.6)
    assert point is not None
    assert point.r / t.scale == pytest.approx(0.5, abs=1e-15)


def test_overlapping_normals_of_concentric_arcs() -> None:
    """Every normal of one arc is one of the other: half the chord, the parameter of the same angle."""
    outer = [arc((0, 0), 2, 0.1, 1.1), line((2 * math.cos(1.1), 2 * math.sin(1.1)), (math.cos(1.1), math.sin(1.1)))]
    inner = [arc((0, 0), 1, 1.1, 0.1), line((math.cos(0.1), math.sin(0.1)), (2 * math.cos(0.1), 2 * math.sin(0.1)))]
    t = table_of(shape("bend", [*outer, *inner]))
    left = corresponding_footpoint(t, 0, 0.3, 2, 0.99, 0.0, 0.0)
    assert left == pytest.approx(0.7, abs=1e-12)
    point = axis_point(t, 0, 0.3, 2, 0.7)
    assert point is not None
    assert point.r / t.scale == pytest.approx(0.5, rel=1e-12)


def test_there_is_no_footpoint_beyond_the_end_of_an_edge() -> None:
    t = table_of(shape("wedge", polyline([(0, 0), (2, 0), (0.6, 0.8)])))
    assert corresponding_footpoint(t, 0, 0.7, 2, 1.0, 0.0, 0.0) is None
    assert corresponding_footpoint(t, 0, 0.4, 2, 1.0, 0.3, 0.0) is None


def test_the_defect_is_nothing_on_a_circle_and_a_half_turn_on_its_other_side() -> None:
    rng = np.random.default_rng(0)
    for a, b in rng.uniform(0, 2 * math.pi, (200, 2)):
        dx, dy = math.cos(b) - math.cos(a), math.sin(b) - math.sin(a)
        tangents = (-math.sin(a), math.cos(a)), (-math.sin(b), math.cos(b))
        (tx, ty), (ux, uy) = tangents
        assert abs(defect(tx, ty, dx, dy, ux, uy)) < 1e-12
        assert abs(abs(defect(tx, ty, dx, dy, -ux, -uy)) - math.pi) < 1e-12


@pytest.mark.parametrize("build", [object_2, twice, CATALOGUE["mixed"]])
def test_footpoints_solve_the_papers_equations_on_the_right_side(build: Any) -> None:
    """Along the pairs at every convex vertex: (A4) vanishes, alpha = beta > 0 in (A1), and both normals meet there (A2)."""
    t = table_of(build())
    record = Record(t)
    seen = 0
    for a in np.flatnonzero(t.si[:, 11] == 1).tolist():
        b = record.previous_site(a)
        left = 1.0
        for right in np.linspace(0.0, 0.2, 20)[1:].tolist():
            found = corresponding_footpoint(t, a, right, b, left, 0.0, 0.0)
            if found is None:
                break
            left = found
            p, tangent = vectors(t, a, right)
            q, other = vectors(t, b, left)
            d = q - p
            assert abs((d @ other) ** 2 - (d @ tangent) ** 2) < 1e-13
            across = tangent[0] * other[1] - tangent[1] * other[0]
            alpha, beta = d @ other / across, d @ tangent / across
            point = axis_point(t, a, right, b, left)
            assert point is not None
            assert alpha == pytest.approx(point.r, rel=1e-8)
            assert beta == pytest.approx(point.r, rel=1e-8)
            assert np.hypot(*(p + alpha * np.array([-tangent[1], tangent[0]]) - [point.x, point.y])) < 1e-9
            assert curvature_holds(t, a, b, point)
            seen += 1
    assert seen > 20


@pytest.mark.parametrize("name", ["mixed", "blob_holes", "gear", "ell", "spiral"])
def test_the_nearest_point_of_a_site_is_the_nearest(name: str) -> None:
    t = table_of(CATALOGUE[name]())
    rng = np.random.default_rng(1)
    dense = np.linspace(0.0, 1.0, 2001)
    for site in range(len(t.si)):
        points = np.array([vectors(t, site, s)[0] for s in dense])
        for x, y in rng.uniform(-0.5, 0.5, (3, 2)):
            found, s = nearest(t, site, 0.0, 1.0, x, y)
            sampled = np.hypot(points[:, 0] - x, points[:, 1] - y).min()
            assert sampled - 1e-6 <= found <= sampled + 1e-15
            assert math.hypot(*(vectors(t, site, s)[0] - [x, y])) == pytest.approx(found, abs=1e-15)


def test_traced_parts_are_closed_to_later_checks() -> None:
    """Proposition 1, and the error when nothing is left to trace but parts of the boundary are."""
    record = Record(table_of(CATALOGUE["square"]()))
    record.add_strip(Strip(0, 3, 0, 1, 0.0, 0.5, 1.0, 0.5))
    assert record.open[0] == [(0.5, 1.0)]
    assert record.open[3] == [(0.0, 0.5)]
    record.mark(0, 0.7, 0.8)
    assert record.open[0] == [(0.5, 0.7), (0.8, 1.0)]
    record.mark(0, 0.4, 1.0)
    assert record.open[0] == []
    assert record.is_open.tolist() == [False, True, True, True]


def test_contacts_have_one_form() -> None:
    record = Record(table_of(CATALOGUE["square"]()))
    assert record.contact(0, 1.0) == Contact(1, 0.0)
    assert record.contact(0, 1.0 - 1e-13) == Contact(1, 0.0)
    assert record.contact(3, 1.0) == Contact(0, 0.0)
    assert record.contact(2, 1e-13) == Contact(2, 0.0)
    assert record.contact(2, 0.25) == Contact(2, 0.25)
