"""Segments as B-splines: clamped, continuous, ending at their nodes; pieces in order."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from mat_core.axis.segment import SEGMENT_KINDS
from tests.curves.shapes import solved

SHAPES = (
    "rectangle", "ell", "stadium", "annulus", "annulus_thin", "eccentric_ring", "ellipse", "blob_holes", "mixed",
    "gear", "keyhole", "pipe_bend", "heart", "mixed_holes", "spiral", "comb",
)  # fmt: skip


@pytest.mark.parametrize("name", SHAPES)
def test_splines_are_clamped_over_the_unit_interval(name: str) -> None:
    for s in solved(name).segments:
        p, knots = s.degree, s.knots
        assert len(knots) == len(s.control_points) + p + 1
        assert np.all(knots[: p + 1] == 0)
        assert np.all(knots[-p - 1 :] == 1)
        assert np.all(np.diff(knots) >= 0)
        inner, count = np.unique(knots[p + 1 : -p - 1], return_counts=True)
        assert np.all((inner > 0) & (inner < 1))
        assert np.all(count <= p)
        assert np.all(s.weights > 0)


@pytest.mark.parametrize("name", SHAPES)
def test_ends_are_the_nodes(name: str) -> None:
    axis = solved(name)
    for s in axis.segments:
        first, last = s.evaluate([0.0, 1.0])
        if s.start_node is None or s.end_node is None:
            assert np.abs(first - last).max() <= 1e-12 * axis.domain.size
            continue
        for disc, node in ((first, s.start_node), (last, s.end_node)):
            assert np.abs(disc - axis.node_discs[node]).max() <= 1e-14 * axis.domain.size


@pytest.mark.parametrize("name", SHAPES)
def test_continuous_with_one_tangent_at_joints(name: str) -> None:
    axis = solved(name)
    for s in axis.segments:
        for t0, _, _ in s.pieces[1:]:
            before, after = s.evaluate([np.nextafter(t0, 0), t0])
            assert np.abs(before - after).max() <= 1e-12 * axis.domain.size
            d0, d1 = s.evaluate([t0 - 1e-9, t0], derivative=True)
            cosine = d0 @ d1 / np.linalg.norm(d0) / np.linalg.norm(d1)
            assert cosine >= 1 - 1e-6


@pytest.mark.parametrize("name", ["blob_holes", "spiral", "ellipse"])
def test_fitted_joints_are_smooth_knots(name: str) -> None:
    axis = solved(name)
    simple = 0
    for s in axis.segments:
        inner, count = np.unique(s.knots[s.degree + 1 : -s.degree - 1], return_counts=True)
        for knot in inner[count < s.degree]:
            before, after = s.evaluate([np.nextafter(knot, 0), knot], derivative=True)
            assert np.abs(before - after).max() <= 1e-6 * np.abs(after).max()
            simple += 1
    assert simple > 0


@pytest.mark.parametrize("name", SHAPES)
def test_pieces_cover_the_segment(name: str) -> None:
    for s in solved(name).segments:
        pieces = s.pieces
        assert pieces[0][0] == 0
        assert pieces[-1][1] == 1
        assert all(a[1] == b[0] and a[0] < a[1] for a, b in itertools.pairwise(pieces))
        kinds = {kind for _, _, kind in pieces}
        assert kinds <= set(SEGMENT_KINDS)
        assert s.kind == (kinds.pop() if len(kinds) == 1 else "freeform")


@pytest.mark.parametrize("name", SHAPES)
def test_parameter_runs_with_length(name: str) -> None:
    for s in solved(name).segments:
        d = s.evaluate(np.linspace(0.01, 0.99, 99), derivative=True)
        speed = np.hypot(d[:, 0], d[:, 1])
        assert speed.min() > 0
        assert s.length == pytest.approx(np.mean(speed), rel=0.25)
