"""Offsets against closed forms, against an erosion by shapely, and against themselves."""

from __future__ import annotations

import functools
import gzip
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from mat_core import Domain, MedialAxis, UnsupportedOption, medial_axis
from mat_core.analysis import Offset, inscribed_disc, offset, offsets
from tests.analysis.erosion import eroded, evaluated, flatten, polygon
from tests.families import CATALOGUE, arc, circle_hole, line, polyline

Json = dict[str, Any]

SHARES = (0.1, 0.3, 0.5, 0.7, 0.9)
FAMILIES = (
    "rectangle", "ell", "star_7", "circle", "ellipse_flat", "stadium", "annulus", "eccentric_ring", "square_round_hole",
    "parabola_cap", "dumbbell", "thorn", "kidney", "mixed", "plate", "pipe_bend",
)  # fmt: skip
CHORDS = 200


def solve(shape: Json, tolerance: float = 1e-9) -> MedialAxis:
    return medial_axis(Domain.from_dict({"outer": shape["outer"], "holes": shape.get("holes", [])}), tolerance=tolerance)


@functools.cache
def family(name: str) -> MedialAxis:
    return solve(CATALOGUE[name]())


@functools.cache
def outlines() -> list[Json]:
    file = Path(__file__).parent.parent / "corpus" / "outlines.jsonl.gz"
    with gzip.open(file, "rt") as lines:
        return [json.loads(row) for row in lines]


def largest(axis: MedialAxis) -> float:
    return float(axis.skeleton.disc[:, 2].max() / axis.table.scale)


def boundary(axis: MedialAxis, chords: int = CHORDS) -> shapely.Polygon:
    return polygon(axis.domain.outer, axis.domain.holes, chords)


def regions(result: Offset, chords: int = 60) -> list[shapely.Polygon]:
    def loop(edges: Any) -> Any:
        return flatten([e.curve for e in edges], chords)

    return [shapely.Polygon(loop(r.outer.edges), [loop(h.edges) for h in r.holes]) for r in result.regions]


def sagitta(shape: shapely.Polygon) -> float:
    """How far a fine polygon may be from its curves: from the turn of neighbouring chords where that is small."""
    worst = 0.0
    for ring in (shape.exterior, *shape.interiors):
        p = np.asarray(ring.coords)
        chord = np.diff(p, axis=0)
        angle = np.arctan2(chord[:, 1], chord[:, 0])
        turn = np.abs(np.remainder(np.diff(angle, append=angle[:1]) + math.pi, 2 * math.pi) - math.pi)
        smooth = turn < 0.1
        worst = max(worst, float((turn * np.hypot(*chord.T) / 8.0)[smooth].max(initial=0.0)))
    return worst


def points(result: Offset, count: int = 9) -> Any:
    u = np.linspace(0.0, 1.0, count)
    return np.concatenate([evaluated(e.curve, u) for loop in result.loops for e in loop.edges])


def assert_sound(axis: MedialAxis, result: Offset, shape: shapely.Polygon) -> None:
    """At the distance, without a crossing, closed, taken as domains again."""
    d, size = abs(result.distance), axis.domain.size
    off = shapely.distance(shape.boundary, shapely.points(points(result))) - d
    assert np.abs(off).max() <= result.max_error + 2.0 * sagitta(shape) + 1e-12 * size
    assert result.max_error <= 2.0 * axis.tolerance * size
    for region, drawn in zip(result.regions, regions(result), strict=True):
        assert drawn.is_valid
        assert region.outer.area > 0.0
        assert all(hole.area < 0.0 for hole in region.holes)
        for loop in (region.outer, *region.holes):
            for a, b in zip(loop.edges, (*loop.edges[1:], loop.edges[0]), strict=True):
                assert np.array_equal(a.curve.control_points[-1], b.curve.control_points[0])
        Domain.from_dict(region.to_dict())


def assert_eroded(axis: MedialAxis, result: Offset, shape: shapely.Polygon) -> None:
    """As many loops and as much area as shapely leaves of a fine polygon."""
    left = eroded(shape, result.distance)
    area = sum(part.area for part in left)
    crumb = 1e-6 * area
    loops = sum(1 + sum(shapely.Polygon(hole).area > crumb for hole in part.interiors) for part in left)
    assert len(result.loops) == loops
    assert len(result.regions) == len(left)
    assert result.area == pytest.approx(area, rel=1e-5, abs=2.0 * sagitta(shape) * result.perimeter + 1e-7 * axis.domain.area)


# Closed forms --------------------------------------------------------------------------------------------------------
def test_a_rectangle_shrinks_to_a_rectangle() -> None:
    axis = solve({"outer": polyline([(0, 0), (3, 0), (3, 1), (0, 1)])})
    result = offset(axis, 0.25)
    assert [e.kind for e in result.loops[0].edges] == ["line"] * 4
    corners = sorted(tuple(np.round(e.curve.control_points[0], 15)) for e in result.loops[0].edges)
    assert corners == [(0.25, 0.25), (0.25, 0.75), (2.75, 0.25), (2.75, 0.75)]
    assert result.area == pytest.approx(2.5 * 0.5, rel=1e-15)
    assert result.perimeter == pytest.approx(6.0, rel=1e-15)
    assert [(e.source.loop, e.source.edge) for e in result.loops[0].edges] in [
        [(0, (i + k) % 4) for i in range(4)] for k in range(4)
    ]
    first = result.loops[0].edges[0]
    assert sorted((first.source.u0, first.source.u1)) == pytest.approx(
        [0.25 / 3, 2.75 / 3] if first.curve.control_points[:, 1].std() == 0 else [0.25, 0.75], rel=1e-14
    )


def test_a_reflex_vertex_gives_an_arc_of_radius_d() -> None:
    axis = solve({"outer": polyline([(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)])})
    result = offset(axis, 0.5)
    arcs = [e for e in result.loops[0].edges if e.kind == "arc"]
    (fan,) = arcs
    p = evaluated(fan.curve, np.linspace(0, 1, 50))
    assert np.hypot(*(p - (2.0, 2.0)).T) == pytest.approx(np.full(50, 0.5), rel=1e-14)
    assert fan.source.u0 == fan.source.u1
    assert fan.source.angles is not None
    assert fan.source.angles[0] - fan.source.angles[1] == pytest.approx(math.pi / 2, rel=1e-14)
    # six sides moved in by 0.5; the round corner takes less than the square one would
    assert result.area == pytest.approx(3 * 1 + 1 * 3 - 1 * 1 + (1.0 - math.pi / 4) * 0.25, rel=1e-14)


def test_an_annulus_keeps_its_centre() -> None:
    result = offset(family("annulus"), 0.1)
    (region,) = result.regions
    assert [len(region.outer.edges), len(region.holes)] == [1, 1]
    radii = [np.hypot(*flatten([e.curve for e in loop.edges], 40).T) for loop in result.loops]
    inner = min(math.hypot(*p) for p in family("annulus").domain.holes[0][0].control_points)
    assert radii[0] == pytest.approx(np.full(len(radii[0]), 0.9), rel=1e-14)
    assert radii[1] == pytest.approx(np.full(len(radii[1]), inner + 0.1), rel=1e-14)


def test_a_disc_shrinks_and_grows() -> None:
    axis = family("circle")
    r = largest(axis)
    for d in (0.3 * r, 0.999 * r, -0.5 * r):
        result = offset(axis, d)
        assert result.area == pytest.approx(math.pi * (r - d) ** 2, rel=1e-12)
        assert result.perimeter == pytest.approx(2 * math.pi * (r - d), rel=1e-12)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_the_largest_disc_inside_a_strip_counts(share: float) -> None:
    """A side of one cubic over a line: the axis runs from vertex to vertex, and no disc of the skeleton is larger than 0."""
    bow = {
        "degree": 3,
        "control_points": [
            [343.2684326171875, 341.09251403808594],
            [375.2425079345703, 412.25621032714844],
            [418.4025115966797, 507.26416015625],
            [474.0, 633.0000152587891],
        ],
    }
    axis = solve({"outer": [bow, line((474.0, 633.0000152587891), (343.2684326171875, 341.09251403808594))]})
    assert not axis.skeleton.disc[:, 2].any()
    result = offset(axis, share * inscribed_disc(axis).radius)
    assert len(result.regions) == 1
    shape = boundary(axis)
    assert_sound(axis, result, shape)
    assert_eroded(axis, result, shape)
    assert offset(axis, 1.01 * inscribed_disc(axis).radius).regions == ()


def test_a_stadium_stays_one() -> None:
    half = [arc((1.0, 0.0), 1.0, -math.pi / 2, 0.0), arc((1.0, 0.0), 1.0, 0.0, math.pi / 2)]
    other = [arc((-1.0, 0.0), 1.0, math.pi / 2, math.pi), arc((-1.0, 0.0), 1.0, math.pi, 1.5 * math.pi)]
    axis = solve({"outer": [line((-1, -1), (1, -1)), *half, line((1, 1), (-1, 1)), *other]})
    for d in (0.25, 0.75, -0.5):
        result = offset(axis, d)
        assert {e.kind for e in result.loops[0].edges} == {"line", "arc"}
        assert result.max_error <= 1e-14
        assert result.area == pytest.approx(math.pi * (1 - d) ** 2 + 4 * (1 - d), rel=1e-13)
    assert offset(axis, 1.0).regions == ()


@pytest.mark.parametrize("share", [0.05, 0.2, 0.6, 0.95])
def test_an_ellipse_has_its_parallel_curve(share: float) -> None:
    """C + d n for the part of the angle that the cut locus leaves: beyond it, near the ends, it is trimmed."""
    axis = solve(CATALOGUE["ellipse"](), 1e-10)
    box = axis.domain.bbox
    a, b = 0.5 * (box[2] - box[0]), 0.5 * (box[3] - box[1])
    d = share * b
    phi = np.linspace(0.0, 2.0 * math.pi, 4001)
    speed = np.hypot(a * np.sin(phi), b * np.cos(phi))
    exact = np.column_stack((a * np.cos(phi) - d * b * np.cos(phi) / speed, b * np.sin(phi) - d * a * np.sin(phi) / speed))
    kept = exact[exact[:, 1] * np.sin(phi) > 0.0]
    result = offset(axis, d, 1e-10)
    ring = regions(result, 400)[0].exterior
    shapely.prepare(ring)
    assert shapely.distance(ring, shapely.points(kept)).max() < 3e-7
    assert all(e.kind == "spline" for e in result.loops[0].edges)
    assert len(result.loops[0].edges) == (1 if d < b * b / a else 2)


def test_parallel_walls_leave_nothing() -> None:
    """A dumbbell of two squares: at half the width of its bar the bar is gone, not a slit."""
    bar = [(0, 0), (2, 0), (2, 0.75), (4, 0.75), (4, 0), (6, 0), (6, 2), (4, 2), (4, 1.25), (2, 1.25), (2, 2), (0, 2)]
    axis = solve({"outer": polyline(bar)})
    for d, count in ((0.25 * (1 - 1e-9), 1), (0.25, 2), (0.25 * (1 + 1e-9), 2)):
        result = offset(axis, d)
        assert len(result.regions) == count
        for region in result.regions:
            Domain.from_dict(region.to_dict())


# Families and outlines -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", sorted(CATALOGUE))
def test_every_family_at_five_distances(name: str) -> None:
    axis = family(name)
    shape = boundary(axis)
    shapely.prepare(shape.boundary)
    for share in SHARES:
        assert_sound(axis, offset(axis, share * largest(axis)), shape)


@pytest.mark.parametrize("name", FAMILIES)
def test_as_much_is_left_as_shapely_leaves(name: str) -> None:
    axis = family(name)
    shape = boundary(axis)
    for share in (0.2, 0.6):
        assert_eroded(axis, offset(axis, share * largest(axis)), shape)


@pytest.mark.parametrize("index", range(0, 60, 5))
def test_outlines(index: int) -> None:
    rows = outlines()
    axis = solve(rows[index * len(rows) // 60])
    shape = boundary(axis, 100)
    shapely.prepare(shape.boundary)
    for share in SHARES:
        result = offset(axis, share * largest(axis))
        assert_sound(axis, result, shape)
        if share == 0.5:
            assert_eroded(axis, result, shape)


@pytest.mark.parametrize("name", ["ell", "star_7", "blob", "stadium", "thorn", "dumbbell"])
def test_twice_is_once(name: str) -> None:
    """offset(offset(d1), d2) = offset(d1 + d2)."""
    axis = family(name)
    first, second = 0.3 * largest(axis), 0.25 * largest(axis)
    once = offset(axis, first + second)
    inner = offset(axis, first, 1e-6)
    parts = [offset(medial_axis(Domain.from_dict(r.to_dict()), 1e-9), second) for r in inner.regions]
    assert sum(p.area for p in parts) == pytest.approx(once.area, rel=1e-5)
    assert sum(len(p.loops) for p in parts) == len(once.loops)
    apart = shapely.hausdorff_distance(
        shapely.union_all([s.boundary for s in regions(once, 200)]),
        shapely.union_all([s.boundary for p in parts for s in regions(p, 200)]),
    )
    assert apart < 1e-4 * axis.domain.size


# Outward -------------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["rectangle", "ell", "comb", "circle", "annulus", "keyhole", "kidney"])
def test_outward(name: str) -> None:
    axis = family(name)
    shape = boundary(axis)
    shapely.prepare(shape.boundary)
    for result in offsets(axis, [-0.02 * axis.domain.size, -0.3 * axis.domain.size]):
        assert_sound(axis, result, shape)
        (region,) = result.regions
        box = shapely.box(*shape.bounds).buffer(-3.0 * result.distance, join_style="mitre")
        free = [p for p in eroded(box.difference(shapely.Polygon(shape.exterior)), -result.distance) if len(p.interiors)]
        (outside,) = free
        assert region.outer.area == pytest.approx(
            max(shapely.Polygon(ring).area for ring in outside.interiors), rel=1e-5, abs=2 * sagitta(shape) * result.perimeter
        )


def test_outward_of_a_rectangle_is_round_at_its_corners() -> None:
    axis = solve({"outer": polyline([(0, 0), (3, 0), (3, 1), (0, 1)]), "holes": [circle_hole((1.5, 0.5), 0.25)]})
    small, large = offsets(axis, [-0.125, -0.5])
    assert sorted(e.kind for e in small.regions[0].outer.edges) == ["arc"] * 4 + ["line"] * 4
    grown = 3 + 8 * 0.125 + math.pi * 0.125**2 - math.pi * 0.125**2
    assert small.area == pytest.approx(grown, rel=1e-13)
    assert {e.source.loop for e in small.regions[0].holes[0].edges} == {1}
    assert {e.source.loop for e in small.regions[0].outer.edges} == {0}
    assert large.regions[0].holes == ()
    assert large.area == pytest.approx(3 + 8 * 0.5 + math.pi * 0.25, rel=1e-13)


def test_there_and_back() -> None:
    """A rectangle grown and shrunk by as much is what it was."""
    axis = solve({"outer": polyline([(0, 0), (3, 0), (3, 1), (0, 1)])})
    grown = medial_axis(Domain.from_dict(offset(axis, -0.4).regions[0].to_dict()))
    assert offset(grown, 0.4 * (1 - 1e-9)).area == pytest.approx(3.0, rel=1e-8)


# Arguments and documents ---------------------------------------------------------------------------------------------
def test_beyond_the_largest_disc_there_is_nothing() -> None:
    for name in ("rectangle", "circle", "blob_holes"):
        axis = family(name)
        for share in (1.0, 1.5, 1e6):
            result = offset(axis, share * largest(axis))
            assert (result.regions, result.area, result.perimeter, result.max_error) == ((), 0, 0, 0.0)


@pytest.mark.parametrize("distance", [0.0, -0.0, math.nan, math.inf, -math.inf])
def test_distances_that_are_none(distance: float) -> None:
    with pytest.raises(UnsupportedOption, match="distance"):
        offset(family("rectangle"), distance)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, 1.0, math.nan, 1e-15])
def test_tolerances_that_are_none(tolerance: float) -> None:
    with pytest.raises(UnsupportedOption, match="tolerance"):
        offset(family("rectangle"), 0.1, tolerance)


def test_the_document_is_json_and_its_regions_are_domains() -> None:
    axis = family("mixed_holes")
    result = offset(axis, 0.4 * largest(axis))
    document = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    assert document["distance"] == result.distance
    assert sum(Domain.from_dict(r).area for r in document["regions"]) == pytest.approx(document["area"], rel=1e-9)
    for region, notes in zip(document["regions"], document["edges"], strict=True):
        assert len(region["outer"]) == len(notes["outer"])
        assert {"kind", "source", "max_error"} == set(notes["outer"][0])


@pytest.mark.parametrize("name", ["blob", "ell", "mixed"])
def test_sources_tell_where_an_edge_comes_from(name: str) -> None:
    """The ends of every edge lie at d from the places its source names, and so does the middle of a line or arc."""
    axis = family(name)
    d = 0.3 * largest(axis)
    for loop in offset(axis, d).loops:
        for e in loop.edges:
            s = e.source
            edge = (axis.domain.outer, *axis.domain.holes)[s.loop][s.edge]
            p = np.vstack((e.curve.control_points[:1], e.curve.control_points[-1:]))
            assert np.hypot(*(p - edge.evaluate([s.u0, s.u1])).T) == pytest.approx([d, d], rel=1e-8)


def test_a_small_tolerance_gives_a_small_error() -> None:
    axis = solve(CATALOGUE["blob"](), 1e-10)
    errors = [offset(axis, 0.4 * largest(axis), t).max_error / axis.domain.size for t in (1e-3, 1e-6, 1e-9, 1e-12)]
    assert all(e <= t for e, t in zip(errors, (1e-3, 1e-6, 1e-9, 1e-12), strict=True))
    assert errors == sorted(errors, reverse=True)
