"""Wall thickness: closed forms, and the slow oracle at many boundary points."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mat_core.analysis import width
from mat_core.errors import UnsupportedOption
from tests.analysis.shapes import all_axes, of, outlines
from tests.curves.shapes import shape, solved
from tests.families import CATALOGUE, rectangle
from tests.reference import Reference
from tests.transforms import divided, restarted, reversed_loops, rotated, scaled

ANGLE = math.radians(150.0)


@pytest.mark.parametrize(("name", "thickness"), [
    ("rectangle", 1.0), ("square", 1.0), ("ell", 1.0), ("circle", 2.0), ("annulus", 0.6), ("eccentric_ring", 0.35),
    ("dumbbell", 0.4), ("stadium", 2.0), ("hole_grid", 0.2), ("pipe_bend", 1.0),
])
def test_closed_forms(name: str, thickness: float) -> None:
    found = width(solved(name)).minimum
    assert found is not None
    assert found.thickness == pytest.approx(thickness, abs=1e-9)
    assert found.kind == "neck"
    left, right = found.disc.footpoints[:2]
    if found.disc.segment is not None:
        assert math.dist(left.point, right.point) == pytest.approx(thickness, abs=1e-6)


def test_the_wall_of_an_ellipse_ends_where_its_sides_open_to_the_angle() -> None:
    # at a (cos u, ..) the normal is (b cos u, a sin u); both footpoints are 2 atan2(a sin u, b cos u) apart
    a, b = 2.0, 1.0
    u = math.atan2(b * math.sin(0.5 * ANGLE), a * math.cos(0.5 * ANGLE))
    x = (a * a - b * b) / a * math.cos(u)
    found = width(solved("ellipse"))
    assert len(found.walls) == 1
    assert found.minimum is not None
    assert found.minimum.kind == "taper"
    assert abs(found.minimum.disc.point[0]) == pytest.approx(x, abs=1e-4)
    assert found.minimum.thickness == pytest.approx(2.0 * b * math.sqrt(1.0 - x * x / (a * a - b * b)), abs=1e-4)
    assert found.walls[0].largest == pytest.approx(2.0, abs=2e-6)


def test_corners_are_no_walls_but_sharp_ones_are_knife_edges() -> None:
    assert width(solved("triangle")).minimum is None
    edge = width(solved("sliver")).minimum
    assert edge is not None
    assert (edge.thickness, edge.kind) == (0.0, "taper")
    everything = width(solved("square"), angle=0.0).minimum
    assert everything is not None
    assert everything.thickness == 0.0


def test_thin_boundary_of_a_rectangle() -> None:
    axis = of(rectangle(2.0, 1.0))
    assert width(axis, 0.99).thin == ()
    thin = width(axis, 1.01).thin
    assert thin is not None
    # along the spine alone: at the ends discs of the corners begin
    assert [(i.loop, i.edge) for i in thin] == [(0, 0), (0, 2)]
    assert [v for i in thin for v in (i.u0, i.u1)] == pytest.approx([0.25, 0.75] * 2, abs=1e-12)
    whole = width(solved("circle"), 2.1).thin
    assert whole is not None
    assert [(i.u0, i.u1) for i in whole] == [(0.0, 1.0)]
    rings = width(solved("annulus"), 0.61).thin
    assert rings is not None
    assert [i.loop for i in rings] == [0, 1]


def test_a_neck_between_two_reflex_vertices_is_two_points() -> None:
    found = width(solved("comb"), angle=math.pi)
    assert found.minimum is not None
    axis = of({"outer": CATALOGUE["dumbbell"]()["outer"]})
    thin = width(axis, 0.5).thin
    assert thin is not None
    # the straight sides of the neck; the reflex vertices at their ends belong to them
    assert [(i.edge, i.u0, i.u1) for i in thin] == [(0, 0.0, 1.0), (4, 0.0, 1.0)]


@pytest.mark.parametrize("content", [shape("blob_holes"), shape("hole_grid"), shape("mixed"), shape("eccentric_ring"),
                                     shape("keyhole"), *outlines()[3:40:12]], ids=lambda d: str(d.get("name")))
def test_thin_boundary_against_the_oracle(content: dict[str, object]) -> None:
    axis = of(content)
    found = width(axis)
    assert found.minimum is not None
    limit = 1.3 * found.minimum.thickness + 0.02 * axis.domain.size
    thin = width(axis, limit).thin
    assert thin is not None
    reference = Reference({"outer": content["outer"], "holes": content.get("holes", [])})
    _, size = reference.frame
    for owner, (loop, edge) in enumerate(reference.names):
        low, high = (axis.domain.outer, *axis.domain.holes)[loop][edge].domain
        u = low + (high - low) * (np.arange(24) + 0.513) / 24
        at = [reference.boundary.locate(owner, v) for v in u.tolist()]
        p, normal, curvature = reference.at(np.array([c for c, _ in at]), np.array([s for _, s in at]))
        discs = reference.maximal_discs(p, normal, curvature)
        a, b = p - discs.center, discs.partner - discs.center
        apart = np.arccos(np.clip((a * b).sum(axis=1) / discs.radius**2, -1.0, 1.0))
        thickness = 2.0 * size * discs.radius
        own = [i for i in thin if (i.loop, i.edge) == (loop, edge)]
        inside = np.array([any(i.u0 <= v <= i.u1 for i in own) for v in u.tolist()])
        clear = (np.abs(thickness - limit) > 1e-3 * size) & (np.abs(apart - ANGLE) > 0.02) & (discs.blur < 1e-6)
        assert np.array_equal(inside[clear], ((thickness < limit) & (apart > ANGLE))[clear]), (loop, edge)


def test_walls_are_where_the_sides_face_each_other() -> None:
    t = np.linspace(0.0, 1.0, 101)
    for axis in all_axes():
        found = width(axis)
        for s in axis.segments:
            own = [w for w in found.walls if w.segment == s.id]
            apart = 2.0 * np.arccos(np.abs(s.dr_ds(t)))
            inside = np.array([any(w.t0 <= v <= w.t1 for w in own) for v in t.tolist()])
            clear = np.abs(apart - ANGLE) > 1e-4
            assert np.array_equal(inside[clear], (apart > ANGLE)[clear])
            for w in own:
                r = 2.0 * s.evaluate(np.linspace(w.t0, w.t1, 50))[:, 2]
                assert w.least - 1e-12 <= r.min()
                assert r.max() <= w.largest + 1e-12
        for neck in found.necks:
            assert found.minimum is not None
            assert found.minimum.thickness <= neck.thickness + 1e-5 * axis.domain.size
        found.to_dict()


@pytest.mark.parametrize("name", ["blob_holes", "mixed", "gear"])
def test_the_description_of_the_domain_decides_nothing(name: str) -> None:
    plain = width(solved(name), 0.3)
    assert plain.minimum is not None
    for change, factor in ((lambda d: rotated(d, 0.7), 1.0), (lambda d: scaled(d, 1e3), 1e3), (reversed_loops, 1.0),
                           (restarted, 1.0), (divided, 1.0)):
        other = width(of(change(CATALOGUE[name]())), 0.3 * factor)
        assert other.minimum is not None
        assert other.minimum.thickness / factor == pytest.approx(plain.minimum.thickness, abs=1e-5)
        assert len(other.necks) == len(plain.necks)


def test_bad_options_are_refused() -> None:
    for options in ({"limit": -1.0}, {"limit": math.nan}, {"angle": 4.0}, {"angle": -0.1}):
        with pytest.raises(UnsupportedOption, match=next(iter(options))):
            width(solved("ell"), **options)


@pytest.mark.parametrize("name", ["rectangle", "dumbbell", "blob_holes", "hole_grid", "annulus", "mixed", "comb"])
def test_thin_walls_are_the_walls_up_to_the_limit(name: str) -> None:
    axis = solved(name)
    everything = width(axis)
    assert everything.thin_walls is None
    assert everything.minimum is not None
    limit = 1.3 * everything.minimum.thickness
    found = width(axis, limit)
    assert found.thin_walls is not None
    slack = 1e-12 * axis.domain.size
    for thin in found.thin_walls:
        assert thin.largest <= limit + slack
        wall = next(w for w in found.walls if w.segment == thin.segment and w.t0 <= thin.t0 and thin.t1 <= w.t1)
        diameters = 2.0 * axis.segments[thin.segment].evaluate(np.linspace(thin.t0, thin.t1, 33))[:, 2]
        assert diameters.min() >= thin.least - slack
        assert diameters.max() <= thin.largest + slack
        for t, end in ((thin.t0, wall.t0), (thin.t1, wall.t1)):
            assert t == end or 2.0 * axis.segments[thin.segment].evaluate(t)[2] == pytest.approx(limit, rel=1e-9)
    # nothing is left out: what of the walls is thinner lies on one of them
    for wall in found.walls:
        t = np.linspace(wall.t0, wall.t1, 33)
        thinner = t[2.0 * axis.segments[wall.segment].evaluate(t)[:, 2] < limit - slack]
        own = [w for w in found.thin_walls if w.segment == wall.segment]
        assert all(any(w.t0 <= v <= w.t1 for w in own) for v in thinner.tolist())
