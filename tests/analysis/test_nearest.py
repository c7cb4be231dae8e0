"""Nearest axis points: closed forms, and never farther than any of many axis points."""

from __future__ import annotations

import importlib
import math

import numpy as np
import pytest
import shapely

from mat_core.analysis import nearest
from mat_core.errors import UnsupportedOption
from tests.analysis.shapes import all_axes, polygon
from tests.curves.shapes import solved

DENSE = np.linspace(0.0, 1.0, 801)


def test_it_is_the_global_minimum() -> None:
    rng = np.random.default_rng(5)
    for axis in all_axes():
        size = axis.domain.size
        low, high = np.array(axis.domain.bbox[:2]) - 0.3 * size, np.array(axis.domain.bbox[2:]) + 0.3 * size
        own = axis.node_discs[:20, :2]
        asked = np.concatenate((rng.uniform(low, high, (60, 2)), own, own + 1e-9 * size, [0.5 * (low + high)]))
        found = nearest(axis, asked)
        if not axis.segments:
            assert found.node.tolist() == [0] * len(asked)
            continue
        points = np.concatenate([s.evaluate(DENSE)[:, :2] for s in axis.segments])
        speed = np.concatenate([np.full(len(DENSE), np.hypot(*s.evaluate(DENSE, True)[:, :2].T).max()) for s in axis.segments])
        spacing = speed / (len(DENSE) - 1)
        apart = np.hypot(*(asked[:, None] - points[None]).transpose(2, 0, 1))
        # no axis point is nearer, and one as near lies between two neighbouring samples
        assert np.all(found.distance <= apart.min(axis=1) + 1e-14 * size)
        assert np.all(found.distance >= (apart - spacing).min(axis=1) - 1e-14 * size)
        there = axis.evaluate(found.segment, found.t)
        assert np.array_equal(there[:, :2], found.centers)
        assert np.hypot(*(there[:, :2] - asked).T) == pytest.approx(found.distance, abs=1e-15 * size)
        assert found.distance[60 : 60 + len(own)] == pytest.approx(np.zeros(len(own)), abs=2e-6 * size)
        # inside a piece the way to the axis is square to it
        inner = (found.t > 1e-6) & (found.t < 1.0 - 1e-6) & (found.distance > 1e-3 * size)
        speed = np.hypot(there[:, 3], there[:, 4])
        along = ((asked - found.centers) * there[:, 3:5]).sum(axis=1)[inner] / (speed * found.distance)[inner]
        assert np.abs(along).max(initial=0.0) <= 1e-5


def test_inside_is_what_shapely_says_away_from_the_boundary_and_exact_near_it() -> None:
    rng = np.random.default_rng(6)
    for axis in all_axes():
        area = polygon(axis)
        low, high = axis.domain.bbox[:2], axis.domain.bbox[2:]
        asked = rng.uniform(low, high, (200, 2))
        clear = shapely.distance(area.boundary, shapely.points(asked)) > 1e-4 * axis.domain.size
        wanted = shapely.contains_xy(area, asked)
        assert np.array_equal(nearest(axis, asked).inside[clear], wanted[clear])
    # a hair on either side of a circle
    turns = np.linspace(0.0, math.tau, 50)
    ring = np.column_stack((np.cos(turns), np.sin(turns)))
    axis = solved("annulus")
    for radius, wanted in ((1.0 - 1e-9, True), (1.0 + 1e-9, False), (0.4 + 1e-9, True), (0.4 - 1e-9, False)):
        assert nearest(axis, radius * ring).inside.tolist() == [wanted] * len(ring)


def test_closed_forms() -> None:
    axis = solved("rectangle")
    found = nearest(axis, [(0.1, 0.3), (0.9, 0.45), (5.0, 0.0)])
    assert found.distance == pytest.approx([0.3, 0.05 / math.sqrt(2.0), math.sqrt(16.25)], abs=1e-14)
    assert found.centers[0] == pytest.approx((0.1, 0.0), abs=1e-14)
    assert found.radii[0] == pytest.approx(0.5, abs=1e-14)
    assert found.inside.tolist() == [True, True, False]
    disc = found.disc(0)
    assert sorted(f.point[1] for f in disc.footpoints) == pytest.approx([-0.5, 0.5], abs=1e-14)
    # all of the axis of a ring is as far from its centre
    ring = nearest(solved("annulus"), (0.0, 0.0))
    assert ring.distance == pytest.approx([0.7], abs=1e-14)
    disc_axis = nearest(solved("circle"), [(3.0, 4.0)])
    assert disc_axis.distance == pytest.approx([5.0], abs=1e-14)
    assert disc_axis.disc(0).radius == pytest.approx(1.0, abs=1e-14)
    assert disc_axis.to_dict()["segment"] == [None]


def test_batches_and_splits_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    axis = solved("gear")
    asked = np.random.default_rng(7).normal(size=(90, 2))
    whole = nearest(axis, asked)
    module = importlib.import_module(nearest.__module__)
    monkeypatch.setattr(module, "BATCH", 17)
    monkeypatch.setattr(module, "PAIRS", 8)
    parts = nearest(axis, asked)
    assert np.array_equal(parts.distance, whole.distance)
    assert nearest(axis, np.empty((0, 2))).distance.shape == (0,)


def test_far_away_points_keep_their_digits() -> None:
    axis = solved("ell")
    far = nearest(axis, [(1e6, 1e6), (-1e6, -1e6)])
    corner = min(axis.nodes, key=lambda n: math.dist(n.point, (-1e6, -1e6)))
    assert far.distance[1] == math.dist(corner.point, (-1e6, -1e6))
    assert far.node[1] == corner.id


def test_bad_points_are_refused() -> None:
    for bad in ([[1.0, 2.0, 3.0]], [[math.nan, 0.0]], 3.0, [[[1.0, 2.0]]]):
        with pytest.raises(UnsupportedOption, match="points"):
            nearest(solved("ell"), bad)
