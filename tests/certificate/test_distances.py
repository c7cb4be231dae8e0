"""Distances of the judge's kernels against dense sampling of the boundary pieces."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mat_core.certificate.certify import Boxes, boxes_for
from mat_core.certificate.inputs import Boundary, boundary_of
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import jit
from mat_core.kernels.judge import depth, depth_near
from mat_core.kernels.judge_ball import ball
from mat_core.kernels.judge_boxes import fill_boxes, leaves_near, stretch
from mat_core.kernels.judge_foot import distance_from, foot
from mat_core.kernels.layout import FAN, KIND
from tests.certificate.accused import Accused, accused

DENSE = 2000


@jit
def depth_in(t, boxes, x, y, r):
    """`depth` in boxes not yet filled."""
    t, boxes = Boundary(*t), Boxes(*boxes)
    fill_boxes(t.si, t.sf, t.cp, boxes.order, boxes.box)
    return depth(t.si, t.sf, t.cp, boxes.order, boxes.box, boxes.walk[0], boxes.work, boxes.binomial, x, y, r, -1, 0.0, -1, 0.0)


@jit
def depth_along(t, boxes, ax, ay, bx, by, x, y, r):
    """(leaves, depth) by the leaves that are near the line from a to b; leaves are -1 where they have no room."""
    t, boxes = Boundary(*t), Boxes(*boxes)
    fill_boxes(t.si, t.sf, t.cp, boxes.order, boxes.box)
    reach = stretch(ax, ay, bx, by, x, y, r)
    count = leaves_near(boxes.box, boxes.walk[0], boxes.walk[1], ax, ay, bx, by, reach)
    inside = depth_near(t.si, t.sf, t.cp, boxes.order, boxes.box, boxes.walk[1], count, boxes.work, boxes.binomial, x, y, r,
                        -1, 0.0, -1, 0.0)
    return count, inside


@jit
def foot_on(si, sf, cp, i, x, y, guess):
    return foot(si, sf, cp, i, 0.0, 1.0, x, y, guess)


@jit
def ball_between(si, sf, cp, i, s, j, first, thorough):
    x, y, tx, ty, curvature, speed = evaluate(si, sf, cp, i, s, 0.0, 0.0)
    return ball(si, sf, cp, i, s, x, y, tx, ty, j, 0.0, 1.0, first, 0.5, thorough)


@jit
def distance_to(si, sf, cp, i, guess, x, y, r):
    return distance_from(si, sf, cp, i, 0.0, 1.0, guess, x, y, r, 0.0)[0]


def tree_of(a: Accused) -> tuple[Any, Any]:
    """The boundary and room for its tree."""
    return boundary_of(a.table), boxes_for(a.table)


def dense_points(table: object) -> np.ndarray:
    """(n, 3) points of the boundary, and their sites."""
    si, sf, cp = table.si, table.sf, table.cp  # type: ignore[attr-defined]
    sites = np.flatnonzero(si[:, KIND] != FAN)
    return np.array([(*evaluate(si, sf, cp, i, s, 0.0, 0.0)[:2], i) for i in sites for s in np.linspace(0.0, 1.0, DENSE)])


@pytest.mark.parametrize("name", ["rectangle", "letter", "blob_with_holes", "plate", "ellipse", "gear"])
def test_depths_and_feet_agree_with_dense_sampling(name: str) -> None:
    table = accused(name).table
    si, sf, cp = table.si, table.sf, table.cp
    tree = tree_of(accused(name))
    points = dense_points(table)
    spacing = np.hypot(*np.diff(points[:, :2], axis=0).T).max() if len(points) < 3 * DENSE else 0.01
    rng = np.random.default_rng(7)
    centres = rng.uniform(-0.5, 0.5, (60, 2))
    for x, y in centres:
        d = np.hypot(points[:, 0] - x, points[:, 1] - y)
        nearest = d.min()
        # the true distance is at most that of the samples, and nearly it
        for factor in (0.9, 1.0, 1.3):
            r = factor * nearest
            reach = depth_in(*tree, x, y, r)
            assert reach >= max(0.0, r - nearest) - 1e-15
            assert reach <= max(0.0, r - nearest + 0.5 * spacing * spacing / max(nearest, spacing) + 1e-7)
        for site in np.unique(points[:, 2]).astype(int)[:6]:
            own = points[:, 2] == site
            guess = np.linspace(0.0, 1.0, DENSE)[d[own].argmin()]
            distance, s = foot_on(si, sf, cp, site, x, y, guess)
            assert distance <= d[own].min() + 1e-15
            dx, dy, tx, ty, _, _ = evaluate(si, sf, cp, site, s, x, y)
            assert distance == pytest.approx(np.hypot(dx, dy), abs=1e-15)
            if 0.0 < s < 1.0:
                assert abs(dx * tx + dy * ty) <= 1e-9


@pytest.mark.parametrize("name", ["rectangle", "letter", "blob_with_holes", "plate", "ellipse", "gear"])
def test_leaves_along_a_line_are_all_that_a_disc_near_it_reaches_into(name: str) -> None:
    tree = tree_of(accused(name))
    rng = np.random.default_rng(11)
    gathered = 0
    for _ in range(1500):
        line, disc = rng.uniform(-0.5, 0.5, 4), (*rng.uniform(-0.5, 0.5, 2), rng.uniform(0.0, 0.4))
        count, inside = depth_along(*tree, *line, *disc)
        if count >= 0:
            gathered += 1
            assert inside == depth_in(*tree, *disc)
    assert gathered > 50


def test_disc_of_no_size_and_of_no_end() -> None:
    tree = tree_of(accused("letter"))
    assert [depth_in(*tree, 0.0, 0.0, r) for r in (0.0, -1.0, np.inf, np.nan)] == [0.0, 0.0, np.inf, 0.0]


def test_ball_between_two_lines() -> None:
    """In a 2 x 1 rectangle the ball on the bottom side that touches the top one has half the height."""
    table = accused("rectangle").table
    for first, thorough in ((0.0, False), (1e-9, True), (0.1, False), (100.0, True)):
        r, s, x, y, tx, ty = ball_between(table.si, table.sf, table.cp, 0, 0.5, 2, first, thorough)
        assert r == pytest.approx(0.5 * table.scale, abs=1e-15)
        assert s == pytest.approx(0.5, abs=1e-15)
        assert (x, y, tx, ty) == pytest.approx((0.0, 0.5 * table.scale, -1.0, 0.0), abs=1e-15)


def test_distance_looks_beyond_the_first_local_foot() -> None:
    table = accused("blob").table
    k = accused("blob").skeleton
    inner = np.flatnonzero(k.disc[:, 2] > 0.0)[:5]
    for d in inner:
        site = k.contact_site[k.contact_start[d]]
        for guess in (0.01, 0.5, 0.99):
            assert distance_to(table.si, table.sf, table.cp, site, guess, *k.disc[d]) <= 1e-12
