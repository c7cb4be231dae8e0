"""Where the radius turns and takes values: closed forms, and a dense look at every segment."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mat_core.analysis.bernstein import product, sign_changes, value
from mat_core.analysis.radii import radius_arcs, radius_extremes, radius_intervals, solve_radius
from mat_core.analysis.spans import cut_spans
from tests.curves.shapes import solved

SHAPES = ("ell", "mixed_holes", "ellipse", "dumbbell", "blob_holes", "gear", "spiral", "eccentric_ring", "flat_arcs")
DENSE = np.linspace(0.0, 1.0, 2001)


def test_products_and_sign_changes_of_known_polynomials() -> None:
    roots = np.array([[0.1, 0.5, 0.75], [0.2, 0.2000001, 0.9], [0.3, 0.3, 0.6], [1.5, -0.5, 2.0]])
    c = np.ones((4, 1))
    for column in roots.T:
        c = product(c, np.column_stack((-column, 1.0 - column)))
    s = np.full(4, 0.37)
    assert value(c, s) == pytest.approx(np.prod(s[:, None] - roots, axis=1), abs=1e-15)
    row, found = sign_changes(c)
    for i in range(3):
        wanted = roots[i] if i < 2 else roots[i][2:]  # a double root may be listed, or not
        own = found[row == i]
        # roots 1e-7 apart are known to 1e-16 / 1e-7
        assert all(np.abs(own - root).min() <= 1e-8 for root in wanted)
        assert all(np.abs(roots[i] - place).min() <= 1e-7 for place in own)
    assert not (row == 3).any()
    assert sign_changes(np.zeros((2, 5)))[0].size == 0


@pytest.mark.parametrize("name", SHAPES)
def test_spans_are_the_curves(name: str) -> None:
    axis = solved(name)
    spans = cut_spans(axis)
    s = np.random.default_rng(1).random(len(spans.segment))
    rows = np.stack([value(spans.rows[:, :, k], s) for k in range(4)], axis=1)
    discs = rows[:, :3] / rows[:, 3:] / axis.table.scale + [*axis.table.origin, 0.0]
    t = spans.t[:, 0] + s * (spans.t[:, 1] - spans.t[:, 0])
    assert np.abs(discs - axis.evaluate(spans.segment, t)[:, :3]).max() <= 1e-14 * axis.domain.size


@pytest.mark.parametrize("name", SHAPES)
def test_arcs_are_monotone_and_leave_no_gap(name: str) -> None:
    axis = solved(name)
    arcs = radius_arcs(axis)
    for segment in axis.segments:
        own = arcs.segment == segment.id
        t, direction = arcs.t[own], arcs.direction[own]
        assert (t[0, 0], t[-1, 1]) == (0.0, 1.0)
        assert np.array_equal(t[1:, 0], t[:-1, 1])
        assert np.all(direction[1:] != direction[:-1])
        for (low, high), sign in zip(t, direction, strict=True):
            change = np.diff(segment.evaluate(low + (high - low) * DENSE)[:, 2])
            assert np.all(change * sign >= -1e-14) if sign else np.all(np.abs(change) <= 1e-14)


@pytest.mark.parametrize("name", SHAPES)
def test_values_separate_above_from_below(name: str) -> None:
    axis = solved(name)
    arcs = radius_arcs(axis)
    largest = float(arcs.radius.max())
    for share in (0.21, 0.5, 0.77, 0.93, 0.999):
        wanted = share * largest
        segment, t = solve_radius(axis, wanted, arcs)
        assert np.abs(axis.evaluate(segment, t)[:, 2] - wanted).max(initial=0.0) <= 1e-14
        above = radius_intervals(axis, low=wanted, arcs=arcs)
        below = radius_intervals(axis, high=wanted, arcs=arcs)
        for s in axis.segments:
            radius = s.evaluate(DENSE)[:, 2]
            clear = np.abs(radius - wanted) > 1e-13
            inside = np.zeros(len(DENSE), dtype=bool)
            outside = np.zeros(len(DENSE), dtype=bool)
            for own, found in ((above, inside), (below, outside)):
                for low, high in own.t[own.segment == s.id]:
                    found |= (low <= DENSE) & (high >= DENSE)
            assert np.array_equal(inside[clear], (radius > wanted)[clear])
            assert np.array_equal(outside[clear], (radius < wanted)[clear])
            assert np.count_nonzero(np.diff(radius >= wanted)) <= np.count_nonzero(segment == s.id)


def test_the_radius_of_an_ellipse_turns_at_its_centre() -> None:
    axis = solved("ellipse")
    extremes = radius_extremes(axis)
    assert extremes.kind.tolist() == [1]
    assert extremes.radius == pytest.approx([1.0], abs=1e-6)
    assert np.abs(axis.evaluate(extremes.segment, extremes.t)[0, :2]).max() <= 1e-5
    # the radius at (x, 0) of the ellipse x^2 / a^2 + y^2 / b^2 = 1 is b sqrt(1 - x^2 / (a^2 - b^2))
    segment, t = solve_radius(axis, 0.75)
    places = np.sort(axis.evaluate(segment, t)[:, 0])
    x = math.sqrt(3.0 * (1.0 - 0.75**2))
    assert places == pytest.approx([-x, x], abs=1e-5)


def test_a_neck_is_a_minimum_and_the_seam_of_a_ring_is_looked_over() -> None:
    neck = radius_extremes(solved("dumbbell"))
    assert neck.kind.tolist() == [-1]
    ring = radius_extremes(solved("eccentric_ring"))
    assert sorted(ring.kind.tolist()) == [-1, 1]
    assert np.all((ring.t >= 0.0) & (ring.t < 1.0))


def test_a_constant_radius_is_one_flat_arc_without_extremes() -> None:
    for name in ("stadium", "annulus"):
        axis = solved(name)
        assert radius_arcs(axis).direction.tolist() == [0]
        assert radius_extremes(axis).t.size == 0
        radius = float(radius_arcs(axis).radius[0, 0])
        assert radius_intervals(axis, radius - 1e-9, radius + 1e-9).t.tolist() == [[0.0, 1.0]]
        assert radius_intervals(axis, high=0.5 * radius).t.size == 0


def test_a_disc_has_no_arcs() -> None:
    axis = solved("circle")
    assert radius_arcs(axis).t.shape == (0, 2)
    assert solve_radius(axis, 0.5)[1].size == 0
    assert radius_intervals(axis, 0.1).t.shape == (0, 2)
    assert radius_extremes(axis).t.size == 0
