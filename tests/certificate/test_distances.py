"""Distances of the judge's kernels against dense sampling of the boundary pieces."""

from __future__ import annotations

import numpy as np
import pytest

from mat_core.certificate.certify import depth_finder
from mat_core.kernels.curve import evaluate
from mat_core.kernels.judge import balls, distances, foot
from mat_core.kernels.layout import FAN, KIND
from mat_core.kernels.rows import frames_at
from tests.certificate.accused import accused

DENSE = 2000


def dense_points(table: object) -> np.ndarray:
    """(n, 3) points of the boundary, and their sites."""
    si, sf, cp = table.si, table.sf, table.cp  # type: ignore[attr-defined]
    sites = np.flatnonzero(si[:, KIND] != FAN)
    site = np.repeat(sites, DENSE)
    frame = np.empty((len(site), 4))
    frames_at(si, sf, cp, site, np.tile(np.linspace(0.0, 1.0, DENSE), len(sites)), frame)
    return np.column_stack((frame[:, :2], site))


@pytest.mark.parametrize("name", ["rectangle", "letter", "blob_with_holes", "plate", "ellipse", "gear"])
def test_depths_and_feet_agree_with_dense_sampling(name: str) -> None:
    table = accused(name).table
    si, sf, cp = table.si, table.sf, table.cp
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
            depth = float(depth_finder(table)(np.array([[x, y, r]]))[0])
            assert depth >= max(0.0, r - nearest) - 1e-15
            assert depth <= max(0.0, r - nearest + 0.5 * spacing * spacing / max(nearest, spacing) + 1e-7)
        for site in np.unique(points[:, 2]).astype(int)[:6]:
            own = points[:, 2] == site
            guess = np.linspace(0.0, 1.0, DENSE)[d[own].argmin()]
            distance, s = foot(si, sf, cp, site, 0.0, 1.0, x, y, guess)
            assert distance <= d[own].min() + 1e-15
            dx, dy, tx, ty, _, _ = evaluate(si, sf, cp, site, s, x, y)
            assert distance == pytest.approx(np.hypot(dx, dy), abs=1e-15)
            if 0.0 < s < 1.0:
                assert abs(dx * tx + dy * ty) <= 1e-9


def test_disc_of_no_size_and_of_no_end() -> None:
    table = accused("letter").table
    probe = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, np.inf], [0.0, 0.0, np.nan]])
    assert depth_finder(table)(probe).tolist() == [0.0, 0.0, np.inf, 0.0]


def test_ball_between_two_lines() -> None:
    """In a 2 x 1 rectangle the ball on the bottom side that touches the top one has half the height."""
    table = accused("rectangle").table
    frame = np.empty((1, 4))
    frames_at(table.si, table.sf, table.cp, np.array([0]), np.array([0.5]), frame)
    disc = np.empty((1, 3))
    s = np.empty(1)
    partner = np.empty((1, 4))
    for start in (0.0, 1e-9, 0.1, 100.0):
        interval = np.array([[0.0, 1.0, start]])
        balls(table.si, table.sf, table.cp, np.array([0]), np.array([0.5]), frame, np.array([2]), interval, disc, s, partner)
        assert disc[0, 2] == pytest.approx(0.5 * table.scale, abs=1e-15)
        assert s[0] == pytest.approx(0.5, abs=1e-15)


def test_distance_looks_beyond_the_first_local_foot() -> None:
    table = accused("blob").table
    k = accused("blob").skeleton
    inner = np.flatnonzero(k.disc[:, 2] > 0.0)[:5]
    for d in inner:
        c = k.contact_start[d]
        site = np.array([k.contact_site[c]])
        for guess in (0.01, 0.5, 0.99):
            off = np.empty(1)
            distances(table.si, table.sf, table.cp, site, np.array([[0.0, 1.0, guess]]), k.disc[d : d + 1], off)
            assert off[0] <= 1e-12
