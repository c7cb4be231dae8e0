"""Loops that cross themselves: what errors have made goes, what is the shape's own stays."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mat_core import Domain, InvalidDomain
from mat_core.analysis.outline import edge_dicts, measure
from mat_core.analysis.rebuilding.untangling import untangled
from mat_core.model.curve import RationalBSpline
from mat_core.outlines import circle, polygon

Loop = list[RationalBSpline]


def line(*points: tuple[float, float]) -> RationalBSpline:
    """A polyline as one curve."""
    n = len(points)
    return RationalBSpline(1, np.array([0.0, *range(n), n - 1.0]), np.array(points, dtype=float), np.ones(n))


def bezier(*points: tuple[float, float]) -> RationalBSpline:
    n = len(points) - 1
    knots = np.repeat([0.0, 1.0], n + 1)
    return RationalBSpline(n, knots, np.array(points, dtype=float), np.ones(n + 1))


def square_with(corner: list[RationalBSpline]) -> Loop:
    """The unit square; `corner` leads from (1, 0.5) to (0.5, 1)."""
    return [line((0.5, 1), (0, 1), (0, 0), (1, 0), (1, 0.5)), *corner]


def is_domain(loop: Loop) -> bool:
    Domain.from_dict({"outer": edge_dicts(loop)})
    return True


def closed(loop: Loop) -> bool:
    return all((a.control_points[-1] == b.control_points[0]).all() for a, b in zip(loop, loop[1:] + loop[:1], strict=True))


E = 1e-4
WAYS = {
    # both sides of a corner go on beyond it
    "overshot": [line((1, 0.5), (1, 1 + E)), line((1, 1 + E), (1 + E, 1 + E)), line((1 + E, 1 + E), (1 + E, 1), (0.5, 1))],
    # one curve that turns round for a while
    "loop in a curve": [bezier((1, 0.5), (1, 0.9), (1, 1)), bezier((1, 1), (1 - 3e-3, 1.0 + E), (1 - 1e-3, 1 - E), (0.5, 1))],
    # ends that pass each other in the middle of curves that are bent
    "bent": [bezier((1, 0.5), (1.01, 0.8), (1 - E, 1 + E)), bezier((1 - E, 1 + E), (1.002, 1 - E), (0.99, 1 - E), (0.5, 1))],
}


@pytest.mark.parametrize("name", WAYS)
def test_what_runs_round_at_a_crossing_is_cut_out(name: str) -> None:
    loop = square_with(WAYS[name])
    (found,) = untangled([loop], E)
    assert closed(found)
    assert is_domain(found)
    assert measure(found)[0] == pytest.approx(measure(loop)[0], abs=4e-4)
    assert max(np.abs(edge.control_points).max() for edge in found) <= 1.02


def test_what_does_not_cross_stays_the_same_object() -> None:
    loops = [[RationalBSpline(1, np.array([0.0, 0.0, 1.0, 1.0]), np.array(e["control_points"]), np.ones(2)) for e in ring]
             for ring in (polygon([(0, 0), (4, 0), (4, 4), (0, 4)]), polygon([(1, 1), (1, 2), (2, 2)]))]
    found = untangled(loops, 1e-3)
    assert all(a is b for a, b in zip(found, loops, strict=True))


@pytest.mark.parametrize("error", [1e-9, 1e-6, 1e-3])
def test_a_figure_of_eight_is_not_cut_in_two(error: float) -> None:
    eight = [line((0, 0), (2, 1), (2, 0), (0, 1), (0, 0))]
    assert untangled([eight], error)[0] is eight


def test_a_fold_wider_than_the_errors_stays() -> None:
    loop = square_with(WAYS["overshot"])
    assert untangled([loop], 1e-9)[0] is loop


def test_several_folds_of_one_loop_all_go() -> None:
    n = 12
    corners = [(math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n)) for k in range(n)]
    loop = []
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        # each side begins before its corner and ends behind the next one
        dx, dy = E * (bx - ax), E * (by - ay)
        loop.append(line((ax - dx, ay - dy), (bx + dx, by + dy)))
    joined = [piece for side, after in zip(loop, loop[1:] + loop[:1], strict=True)
              for piece in (side, line(tuple(side.control_points[-1]), tuple(after.control_points[0])))]
    with pytest.raises(InvalidDomain):
        is_domain(joined)
    loop = joined
    (found,) = untangled([loop], E)
    assert closed(found)
    assert is_domain(found)


@pytest.mark.parametrize("turned", [1e-11, 1e-9])
def test_branches_that_rounding_turned_across_each_other_in_a_cusp_part_again(turned: float) -> None:
    """The slit ends at (0.5, 0.5): a line in, and a parabola that leaves against it, first a little on the wrong side."""
    slit = [line((1, 0.5), (0.5, 0.5)), bezier((0.5, 0.5), (0.7, 0.5 - 0.2 * turned), (1, 0.6))]
    loop = [line((1, 0.6), (1, 1), (0, 1), (0, 0), (1, 0), (1, 0.5)), *slit]
    with pytest.raises(InvalidDomain, match="cusp"):
        is_domain(loop)
    (found,) = untangled([loop], 1e-9)
    assert closed(found)
    assert is_domain(found)
    assert abs(found[2].control_points[1, 1] - 0.5) <= 0.2 * turned


def test_holes_are_treated_alone() -> None:
    ring = {"outer": polygon([(0, 0), (1, 0), (1, 1), (0, 1)]), "holes": [circle((0.3, 0.3), 0.1)]}
    hole = list(Domain.from_dict(ring).holes[0])
    loop = square_with(WAYS["overshot"])
    found = untangled([loop, hole], E)
    assert found[1] is hole
    assert is_domain(found[0])
