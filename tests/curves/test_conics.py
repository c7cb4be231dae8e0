"""Lines, arcs and points give exact conics: judged by their discs' distances to both sides, computed here anew."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from typing import Any

import numpy as np
import pytest

from mat_core import Domain, MedialAxis, medial_axis
from mat_core.kernels.layout import ARC, FAN, K0, KIND, LINE, TX0, TY0, X0, Y0
from tests.curves.shapes import solved
from tests.families import dumbbell

EXACT = 1e-12  # of the larger side
SHAPES = (
    "rectangle", "ell", "cross", "comb", "star", "half_disc", "stadium", "annulus", "eccentric_ring",
    "square_round_hole", "arc_lens", "gear", "keyhole", "dumbbell", "pipe_bend", "line_arc", "hole_grid", "plate",
    "mixed_holes", "equal_holes", "flat_arcs", "lens_equal_arcs", "lens_unlike_arcs",
)  # fmt: skip


def side_name(axis: MedialAxis, site: int) -> str:
    kind = axis.table.si[site, KIND]
    if kind == ARC:
        return "convex arc" if axis.table.sf[site, K0] > 0 else "reflex arc"
    return {LINE: "line", FAN: "point"}.get(int(kind), "free-form")


def gap(axis: MedialAxis, site: int, disc: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Distance from the centres of normalised discs to the carrier of a site, less their radii."""
    row = axis.table.sf[site]
    away = disc[:, :2] - row[[X0, Y0]]
    normal = np.array([-row[TY0], row[TX0]])
    kind = axis.table.si[site, KIND]
    if kind == LINE:
        return away @ normal - disc[:, 2]
    if kind == FAN:
        return np.hypot(*away.T) - disc[:, 2]
    k = row[K0]
    # |c - o| against rho, in the form that keeps its digits for flat arcs
    s = 2.0 * (away @ normal) - k * np.sum(away**2, axis=1)
    return s / (1.0 + np.sqrt(np.maximum(1.0 - k * s, 0.0))) - disc[:, 2]


def exact_pieces(axis: MedialAxis) -> list[tuple[tuple[str, str], str, float]]:
    """(pair of sides, kind, worst error relative to the size) of every exact piece of an axis."""
    c, strips = axis.curves, axis.skeleton.strip_i
    found = []
    for p in range(len(c.part_i)):
        segment, strip = int(c.part_i[p, 0]), int(c.part_i[p, 1])
        sides = [int(s) for s in strips[strip, :2]]
        names = sorted(side_name(axis, s) for s in sides)
        if "free-form" in names:
            continue
        t = c.part_f[p, 0] + np.linspace(0, 1, 33) * (c.part_f[p, 1] - c.part_f[p, 0])
        disc = axis.evaluate(np.full(len(t), segment), t)[:, :3]
        disc[:, :2] -= axis.table.origin
        disc *= axis.table.scale
        worst = max(float(np.abs(gap(axis, s, disc)).max()) for s in sides)
        kind = next(k for t0, t1, k in axis.segments[segment].pieces if t0 <= t[16] <= t1)
        found.append(((names[0], names[1]), kind, worst / (axis.domain.size * axis.table.scale)))
    return found


@pytest.mark.parametrize("name", SHAPES)
def test_discs_touch_both_sides(name: str) -> None:
    pieces = exact_pieces(solved(name))
    assert pieces
    assert max(worst for _, _, worst in pieces) <= EXACT


@pytest.mark.parametrize("name", SHAPES)
def test_stated_error_is_rounding(name: str) -> None:
    axis = solved(name)
    exact = [s.max_error for s in axis.segments if all(kind != "freeform" for _, _, kind in s.pieces)]
    assert max(exact) <= EXACT * axis.domain.size


def test_all_ten_pairs_occur() -> None:
    sides = ("line", "point", "convex arc", "reflex arc")
    wanted = {tuple(sorted(pair)) for pair in itertools.combinations_with_replacement(sides, 2)}
    found = Counter(pair for name in SHAPES for pair, _, _ in exact_pieces(solved(name)))
    assert wanted == set(found)


def test_kinds_follow_from_the_pairs() -> None:
    allowed = {
        ("line", "line"): {"line"},
        ("line", "point"): {"parabola"},
        ("convex arc", "line"): {"parabola"},
        ("line", "reflex arc"): {"parabola"},
        ("point", "point"): {"line"},
        ("convex arc", "convex arc"): {"line", "hyperbola"},
        ("reflex arc", "reflex arc"): {"line", "hyperbola"},
        ("point", "reflex arc"): {"hyperbola"},
        ("convex arc", "point"): {"ellipse"},
        ("convex arc", "reflex arc"): {"ellipse"},
    }
    for name in SHAPES:
        for pair, kind, _ in exact_pieces(solved(name)):
            assert kind in allowed[pair], (name, pair, kind)


@pytest.mark.parametrize(("name", "kind"), [("lens_equal_arcs", "line"), ("lens_unlike_arcs", "hyperbola")])
def test_equal_radii_give_a_straight_axis(name: str, kind: str) -> None:
    assert {s.kind for s in solved(name).segments} == {kind}


def test_concentric_arcs_give_a_circle() -> None:
    axis = solved("annulus")
    (ring,) = axis.segments
    disc = ring.evaluate(np.linspace(0, 1, 500))
    centre = 0.5 * (disc[:, :2].max(axis=0) + disc[:, :2].min(axis=0))
    away = np.hypot(*(disc[:, :2] - centre).T)
    assert ring.kind == "ellipse"
    assert ring.start_node is ring.end_node is None
    assert np.ptp(disc[:, 2]) <= EXACT * axis.domain.size
    assert np.ptp(away) <= 1e-5 * axis.domain.size  # the centre is estimated from 500 points
    assert ring.length == pytest.approx(2 * math.pi * float(away.mean()), rel=1e-5)
    assert min(ring.weights) >= 0.6


def test_parabola_between_a_corner_and_a_wall() -> None:
    # reflex corner of the L at distance 1 from the walls
    axis = solved("ell")
    assert "parabola" in {kind for s in axis.segments for _, _, kind in s.pieces}


@pytest.mark.parametrize("neck", [1e-3, 1e-6, 1e-8])
def test_discs_that_leave_a_narrow_neck_are_exact(neck: float) -> None:
    # between the two corners of the neck r = sqrt(x^2 + neck^2 / 4): bent as sharply as the neck is narrow
    content = dumbbell(neck)
    axis = medial_axis(Domain.from_dict({"outer": content["outer"], "holes": content.get("holes", [])}))
    # (a direction at the neck that is an ulp off moves it by 1e-14)
    assert max(worst for pair, _, worst in exact_pieces(axis) if pair == ("point", "point")) <= 1e-13
