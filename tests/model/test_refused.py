"""Domains that are refused, by family: what is said, where, and which edges are named."""

from __future__ import annotations

import math

import pytest

from tests.model.builders import (
    SQUARE,
    Json,
    accept,
    backwards,
    bezier,
    circle,
    codes,
    mapped,
    polygon,
    problems_of,
    rectangle,
    refuse,
)

NEAR = pytest.approx


def test_bowtie() -> None:
    (problem,) = refuse(polygon((-1, -1), (1, 1), (1, -1), (-1, 1)))
    assert (problem.code, problem.pointer, problem.other) == ("self-intersection", "/outer/0", "/outer/2")
    assert (problem.x, problem.y, problem.u) == (NEAR(0), NEAR(0), NEAR(0.5))
    assert "crosses" in problem.message


def test_curve_crosses_line() -> None:
    outer = [bezier((-1, 0), (1, 0)), bezier((1, 0), (0, -2.5), (-1, 2)), bezier((-1, 2), (-1, 0))]
    (problem,) = refuse(outer)
    assert (problem.code, problem.pointer, problem.other) == ("self-intersection", "/outer/0", "/outer/1")
    assert (problem.x, problem.y) == (NEAR(-3 / 7, abs=1e-9), NEAR(0, abs=1e-9))
    assert problem.u == NEAR(2 / 7, abs=1e-9)


def test_where_a_line_is_crossed_its_weights_tell_the_parameter() -> None:
    lines = polygon((-1, -1), (1, 1), (1, -1), (-1, 1))
    (problem,) = refuse([lines[0] | {"weights": [1e-4, 1e4]}, *lines[1:]])
    assert (problem.x, problem.y) == (NEAR(0), NEAR(0))
    assert problem.u == NEAR(1e-8, rel=1e-7)


def test_loop_touches_itself_at_a_vertex() -> None:
    (problem,) = refuse(polygon((0, 0), (1, 1), (2, 0), (2, 2), (1, 1), (0, 2)))
    assert problem.code == "self-intersection"
    assert (problem.x, problem.y) == (NEAR(1), NEAR(1))
    assert "touches" in problem.message


def test_vertex_touches_an_edge() -> None:
    (problem,) = refuse(polygon((0, 0), (2, 0), (2, 2), (1, 0), (0, 2)))
    assert (problem.code, problem.x, problem.y) == ("self-intersection", NEAR(1), NEAR(0))
    assert "touches" in problem.message


def test_open_loop_names_both_ends() -> None:
    (problem,) = refuse(SQUARE[:3])
    assert (problem.code, problem.pointer, problem.other) == ("open-loop", "/outer/2", "/outer/0")
    assert (problem.x, problem.y, problem.u) == (-1, 1, 1)
    assert "(-1, 1)" in problem.message
    assert "(-1, -1)" in problem.message


def test_edges_out_of_order() -> None:
    found = refuse([SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]])
    assert codes(found) == {"open-loop"}
    assert [p.pointer for p in found] == ["/outer/0", "/outer/1", "/outer/2"]


def test_an_edge_turned_round() -> None:
    assert codes(refuse([SQUARE[0], *backwards([SQUARE[1]]), *SQUARE[2:]])) == {"open-loop"}


def test_hole_outside() -> None:
    (problem,) = refuse(SQUARE, circle(3, 0, 0.3))
    assert (problem.code, problem.pointer) == ("hole-outside", "/holes/0")
    assert "outside" in problem.message


def test_hole_around_the_outer_loop() -> None:
    (problem,) = refuse(SQUARE, circle(0, 0, 3))
    assert (problem.code, problem.pointer) == ("hole-outside", "/holes/0")
    assert "encloses" in problem.message


def test_hole_touches_outer_loop() -> None:
    (problem,) = refuse(SQUARE, circle(0.7, 0, 0.3))
    assert (problem.code, problem.pointer, problem.other) == ("loops-touch", "/holes/0/0", "/outer/1")
    assert (problem.x, problem.y) == (NEAR(1), NEAR(0, abs=1e-6))


def test_holes_touch_each_other() -> None:
    (problem,) = refuse(SQUARE, circle(-0.3, 0, 0.3, clockwise=True), circle(0.3, 0, 0.3, clockwise=True))
    assert (problem.code, problem.pointer, problem.other) == ("loops-touch", "/holes/1/0", "/holes/0/0")
    assert (problem.x, problem.y) == (NEAR(0, abs=1e-6), NEAR(0, abs=1e-6))


def test_hole_vertex_on_outer_vertex() -> None:
    (problem,) = refuse(SQUARE, polygon((-1, -1), (0, -0.5), (-0.5, 0)))
    assert (problem.code, problem.x, problem.y) == ("loops-touch", NEAR(-1), NEAR(-1))


def test_hole_shares_a_wall() -> None:
    assert codes(refuse(SQUARE, rectangle(-0.5, -1, 0.5, 0))) == {"loops-touch"}
    assert codes(refuse(SQUARE, rectangle(-0.5, -1, 1, 0))) == {"loops-touch"}


def test_hole_sticks_out() -> None:
    found = refuse(SQUARE, rectangle(0, 0, 2, 0.5))
    assert codes(found) == {"loops-cross"}
    assert sorted((p.x, p.y) for p in found) == [(NEAR(1), NEAR(0)), (NEAR(1), NEAR(0.5))]


@pytest.mark.parametrize("turned", [False, True])
def test_hole_is_the_outer_loop(turned: bool) -> None:
    (problem,) = refuse(SQUARE, backwards(SQUARE) if turned else SQUARE)
    assert (problem.code, problem.pointer, problem.other) == ("duplicate-loop", "/holes/0", "/outer")


def test_hole_given_twice() -> None:
    first = circle(0, 0, 0.5)
    # The same circle from another start and cut at other places.
    second = [bezier((0.5, 0), (0.5, 0.5), (0, 0.5), weights=[2, 2**0.5, 2])]
    second += [bezier((0, 0.5), (-0.5, 0.5), (-0.5, 0), weights=[1, 0.5**0.5, 1])]
    second += [bezier((-0.5, 0), (-0.5, -0.5), (0, -0.5), weights=[1, 0.5**0.5, 1])]
    second += [bezier((0, -0.5), (0.5, -0.5), (0.5, 0), weights=[1, 0.5**0.5, 1])]
    (problem,) = refuse(SQUARE, first, second)
    assert (problem.code, problem.pointer, problem.other) == ("duplicate-loop", "/holes/1", "/holes/0")


def test_hole_in_hole() -> None:
    (problem,) = refuse(SQUARE, rectangle(-0.5, -0.5, 0.5, 0.5), circle(0, 0, 0.2))
    assert (problem.code, problem.pointer, problem.other) == ("hole-in-hole", "/holes/1", "/holes/0")


@pytest.mark.parametrize("degree", [1, 3, 25])
def test_zero_length_edge(degree: int) -> None:
    (problem,) = refuse([SQUARE[0], bezier(*[(1, -1)] * (degree + 1)), *SQUARE[1:]])
    assert (problem.code, problem.pointer, problem.x, problem.y) == ("zero-length-edge", "/outer/1", 1, -1)


@pytest.mark.parametrize(
    "loop",
    [
        polygon((0, 0), (1, 0), (2, 0)),
        polygon((0, 0), (1, 1)),
        polygon((0, 0), (1, 1e-13)),
        [bezier((0, 0), (0.5, 0.5), (1, 0)), bezier((1, 0), (0.5, 0.5), (0, 0))],
        polygon((0, 0), (1, 0), (1, 1), (1, 0)),
        [bezier((0, 0), (1, 0), (0, 0))],
    ],
)
def test_no_area(loop: list[Json]) -> None:
    assert codes(refuse(loop)) == {"empty-domain"}
    found = refuse(rectangle(-10, -10, 10, 10), loop)
    assert {(p.code, p.pointer) for p in found} == {("empty-domain", "/holes/0")}


def test_no_edges() -> None:
    (problem,) = problems_of({"outer": []})
    assert (problem.code, problem.pointer) == ("empty-domain", "/outer")
    (problem,) = refuse(
        SQUARE,
        [],
    )
    assert (problem.code, problem.pointer) == ("empty-domain", "/holes/0")


@pytest.mark.parametrize("size", [1e-151, 1e-300, 1e-308, 1e-310, 1e-322])
def test_a_size_that_is_hardly_a_float(size: float) -> None:
    assert codes(refuse(rectangle(0, 0, size, size))) <= {"out-of-range", "zero-length-edge"}


def test_too_small_to_compute_with() -> None:
    (problem,) = refuse(rectangle(0, 0, 1e-200, 1e-200))
    assert problem.code == "out-of-range"
    (problem,) = refuse(rectangle(1e15, 1e15, 1e15 + 8, 1e15 + 8))
    assert problem.code == "out-of-range"


def test_an_edge_doubles_back_on_its_neighbour() -> None:
    found = refuse(polygon((0, 0), (2, 0), (1, 0), (1, 1), (0, 1)))
    assert codes(found) == {"self-intersection"}
    assert any({p.pointer, p.other} == {"/outer/0", "/outer/1"} for p in found)
    assert "back" in found[0].message


def test_a_curve_doubles_back_on_its_neighbour() -> None:
    out = bezier((0, 0), (0.5, 0.5), (1, 0))
    # The same parabola from u = 1 back to u = 1/2.
    back = bezier((1, 0), (0.75, 0.25), (0.5, 0.25))
    found = refuse([out, back, bezier((0.5, 0.25), (0.5, -1)), bezier((0.5, -1), (0, 0))])
    assert codes(found) == {"self-intersection"}
    assert {found[0].pointer, found[0].other} == {"/outer/0", "/outer/1"}


def test_a_straight_curve_that_overshoots() -> None:
    loop = [bezier((0, 0), (2, 0), (1, 0)), bezier((1, 0), (1, 1)), bezier((1, 1), (0, 1)), bezier((0, 1), (0, 0))]
    found = refuse(loop)
    assert codes(found) == {"self-intersection"}
    assert {p.pointer for p in found} == {"/outer/0"}


@pytest.mark.parametrize("turn", [0.0, 0.3, 2.7])
@pytest.mark.parametrize("slip", [1e-3, 1e-5, 1e-6, 1e-8, 1e-10])
def test_cusp_branches_that_cross_near_the_tip(slip: float, turn: float) -> None:
    """The handles at the tip stand on the wrong sides: by tangents, beside a straight wall, by curvature."""
    wall = bezier((1, 1), (1, -1))
    lower = bezier((1, 1), (1, 0)), bezier((1, 0), (0, 0))
    loops = [
        [bezier((0, 0), (0.5, -slip), (1, 1)), wall, bezier((1, -1), (0.5, slip), (0, 0))],
        [bezier((0, 0), (0.5, -slip), (1, 1)), *lower],
        [bezier((0, 0), (1 / 3, 0), (2 / 3, -slip), (1, 1)), wall, bezier((1, -1), (2 / 3, slip), (1 / 3, 0), (0, 0))],
    ]
    for loop in loops:
        (problem,) = refuse(mapped(loop, 2.0, turn=turn))
        assert problem.code == "self-intersection"
        assert "crosses" in problem.message
        assert {problem.pointer, problem.other} == {"/outer/0", f"/outer/{len(loop) - 1}"}
        assert math.hypot(problem.x, problem.y) < 10 * math.sqrt(slip)
    # The same handles on the right sides, and on neither.
    for good in (bezier((0, 0), (0.5, slip), (1, 1)), bezier((0, 0), (0.5, 0), (1, 1))):
        accept(mapped([good, *lower], 2.0, turn=turn))


@pytest.mark.parametrize("handle", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_a_cubic_with_a_small_curl(handle: float) -> None:
    curl = bezier((0, 0), (1 + handle, 1), (-handle, 1), (1, 0))
    (problem,) = refuse([curl, bezier((1, 0), (0.5, -1)), bezier((0.5, -1), (0, 0))])
    assert (problem.code, problem.pointer, problem.other) == ("self-intersection", "/outer/0", "/outer/0")
    assert (problem.x, problem.y) == (NEAR(0.5, abs=1e-6), NEAR(0.75, abs=0.02))


def test_a_cubic_with_a_big_loop() -> None:
    (problem,) = refuse([bezier((0, 0), (2, 1), (-1, 1), (1, 0)), bezier((1, 0), (0.5, -1)), bezier((0.5, -1), (0, 0))])
    assert (problem.code, problem.x, problem.y) == ("self-intersection", NEAR(0.5), NEAR(0.3))
    assert problem.u == NEAR(0.1127016653792583, abs=1e-9)


def test_one_closed_edge_shaped_like_an_eight() -> None:
    eight = bezier((0, 0), (3, 3), (3, -3), (-3, 3), (-3, -3), (0, 0))
    found = refuse([eight])
    assert codes(found) == {"self-intersection"}


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-7, 1e-9])
def test_shallow_crossings(depth: float) -> None:
    assert codes(refuse(SQUARE, circle(0.5 + depth, 0, 0.5))) == {"loops-cross"}
    assert codes(refuse(circle(0, 0, 1), circle(0.5 + depth, 0, 0.5))) == {"loops-cross"}
    assert codes(refuse(polygon((0, 0), (2, 0), (2, 2), (1, -depth), (0, 2)))) == {"self-intersection"}
    crossing = polygon((-1, -1), (1, -1), (1, 1), (0.5, -1 - depth), (-1, 1))
    assert "crosses" in refuse(crossing)[0].message


def test_walls_that_coincide_to_rounding() -> None:
    assert codes(refuse(SQUARE, rectangle(-0.5, 0, 0.5, 0.5), rectangle(-0.4, -0.5, 0.4, 1e-14))) == {"loops-touch"}


def test_a_scribble_ends_soon_and_says_that_there_is_more() -> None:
    points = [((7 * i * i + 3 * i) % 101 / 101, (11 * i * i + 5) % 103 / 103) for i in range(60)]
    found = refuse(polygon(*points))
    assert codes(found) == {"self-intersection"}
    assert "more" in found[-1].message


def test_problems_of_several_loops_come_together() -> None:
    found = refuse(
        SQUARE,
        circle(3, 0, 0.2),
        polygon((0, 0), (0.2, 0.2), (0.2, 0), (0, 0.2)),
        polygon((-0.5, -0.5), (-0.4, -0.5), (-0.3, -0.5)),
        SQUARE[:2],
    )
    assert [(p.code, p.pointer) for p in found] == [
        ("hole-outside", "/holes/0"),
        ("self-intersection", "/holes/1/0"),
        ("empty-domain", "/holes/2"),
        ("open-loop", "/holes/3/1"),
    ]


@pytest.mark.parametrize("weight", [1e4, 1e8, 1e12])
def test_crossings_where_a_curve_runs_faster_than_floats_can_follow(weight: float) -> None:
    """The curve leaves its first point and is half way to its apex at u = 1 / weight."""
    outer = [bezier((0, 0), (1, 2), (2, 0), weights=[1, weight, 1]), bezier((2, 0), (0, 0))]
    other = [bezier((0.2, 0.9), (0.6, 0.7), (0.9, 0.9), weights=[1, weight, 1]), bezier((0.9, 0.9), (0.2, 0.9))]
    found = refuse(outer, other)
    assert codes(found) == {"loops-cross"}
    assert all(0 < problem.x < 1 and 0.7 < problem.y <= 1 for problem in found)
    accept(outer, [bezier((0.7, 0.9), (0.8, 0.7), (0.9, 0.9), weights=[1, weight, 1]), bezier((0.9, 0.9), (0.7, 0.9))])
