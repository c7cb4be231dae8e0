"""Small faults of real files: what is put right and told, what is refused with its place."""

from __future__ import annotations

import math

import pytest

from mat_core.model.domain import Domain
from tests.model.builders import SQUARE, Json, accept, bezier, circle, codes, domain, mapped, polygon, rectangle, refuse

ANGLES = [0.0, 0.7, math.pi / 2, 2.5, math.pi, 4.0]


def notched(dx: float, dy: float) -> list[Json]:
    """The unit square with an edge (dx, dy) at the corner (1, 0)."""
    return polygon((0, 0), (1, 0), (1 + dx, dy), (1, 1), (0, 1))


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("length", [5e-16, 1e-15, 1e-14, 1e-13, 9e-13])
def test_an_edge_of_rounding_is_passed_over_whichever_way_it_points(length: float, angle: float) -> None:
    loop = notched(length * math.cos(angle), length * math.sin(angle))
    found = accept(loop)
    assert found.area == pytest.approx(1, rel=1e-11)
    assert [note.pointer for note in found.notes][:1] == ["/outer/1"]
    assert "passed over" in found.notes[0].text
    # The caller's own numbers, and the numbering, stay.
    assert len(found.outer) == 5
    assert found.outer[1].control_points.tolist() == loop[1]["control_points"]
    assert Domain.from_dict(found.to_dict()).notes == found.notes


def test_curves_of_rounding_and_rows_of_them_are_passed_over() -> None:
    e = 2e-14
    row = [bezier((1, 0), (1 - e, e), (1, 2 * e)), bezier((1, 2 * e), (1 + e, 2 * e), (1 - e, e), (1, 3 * e))]
    loop = [bezier((0, 0), (1, 0)), *row, bezier((1, 3 * e), (1, 1)), bezier((1, 1), (0, 0))]
    assert [note.pointer for note in accept(loop).notes] == ["/outer/1", "/outer/2"]
    # At the seam of the loop.
    assert [note.pointer for note in accept(loop[2:] + loop[:2]).notes] == ["/outer/0", "/outer/4"]


def test_many_small_edges_that_make_a_shape_are_kept() -> None:
    count, radius = 1000, 1e-10
    points = [(radius * math.cos(2 * math.pi * i / count), radius * math.sin(2 * math.pi * i / count)) for i in range(count)]
    found = accept(SQUARE, polygon(*points))
    assert found.notes == ()


def test_an_edge_that_is_one_point_is_refused() -> None:
    assert codes(refuse(notched(0, 0))) == {"zero-length-edge"}
    assert codes(refuse(polygon((0, 0), (1, 0), (1, 1), (0, 1), (0, 0)))) == {"zero-length-edge"}
    # So are all edges of a loop without shape.
    tiny = mapped(SQUARE, 1e-16)
    assert codes(refuse(rectangle(0, 0, 1, 1), tiny)) == {"zero-length-edge"}
    assert codes(refuse(tiny, rectangle(0, 0, 1, 1))) == {"zero-length-edge"}


def test_a_spike_above_rounding_is_refused() -> None:
    assert codes(refuse(notched(-1e-10, 0))) == {"self-intersection"}


@pytest.mark.parametrize("gap", [1e-15, 1e-12, 9e-11])
def test_ends_that_miss_each_other_are_joined_and_told(gap: float) -> None:
    sides = [bezier((0, 0), (1, 0)), bezier((1 + gap, 0), (1, 1)), bezier((1, 1 - gap / 2), (0, 1)), bezier((0, 1), (0, 0))]
    (note,) = accept(sides).notes
    assert note.pointer == "/outer/0"
    assert "2 ends miss the start of the next edge" in note.text


def test_a_wider_gap_is_refused_with_its_size_and_what_to_do() -> None:
    sides = [bezier((0, 0), (1, 0)), bezier((1 + 1e-9, 0), (1, 1)), bezier((1, 1), (0, 1)), bezier((0, 1), (0, 0))]
    (problem,) = refuse(sides)
    assert (problem.code, problem.pointer, problem.x, problem.y) == ("open-loop", "/outer/0", 1, 0)
    assert "1e-09 away" in problem.message
    assert "give both the same point" in problem.message


def test_sound_domains_have_no_notes() -> None:
    assert accept(SQUARE, circle(0, 0, 0.5)).notes == ()


def test_notes_are_not_without_end() -> None:
    holes = [rectangle(i, 0, i + 0.5, 1) for i in range(150)]
    for hole in holes:
        hole[0]["control_points"][1][0] += 1e-12
    notes = accept(rectangle(-1, -1, 151, 2), *holes).notes
    assert len(notes) == 101
    assert "50 more" in notes[-1].text


def spline(degree: int, points: list[tuple[float, float]], inner: list[float]) -> Json:
    knots = [0.0] * (degree + 1) + inner + [1.0] * (degree + 1)
    return {"degree": degree, "control_points": [list(p) for p in points], "knots": knots}


@pytest.mark.parametrize(
    "top",
    [
        spline(3, [(-1, 0), (-0.5, 1), (0, 0.5), (0, 0.5), (0.5, 1), (1, 0)], [1 / 3, 2 / 3]),
        spline(3, [(-1, 0), (-1, 0), (-1, 0), (-0.5, 1), (0.5, 1), (1, 0), (1, 0), (1, 0)], [0.2, 0.4, 0.6, 0.8]),
        spline(2, [(-1, 0), (-0.5, 1), (0, 0.5), (0.5, 1), (1, 0)], [0.5, 0.5]),
        spline(3, [(-1, 0), (-0.5, 1), (0, 0.5), (0.3, 1), (0.5, 1), (1, 0)], [0.5, 0.5 + 1e-12]),
        spline(3, [(-1, 0), (-0.8, 1), (-0.3, 1), (0, 0.5), (0, 0.5), (0.3, 1), (0.5, 1), (1, 0)], [0.5] * 4),
        spline(1, [(-1, 0), (0, 1), (0, 1), (1, 0)], [0.3, 0.6]),
        bezier((-1, 0), (-0.9, 0), (0.2, 0), (1, 0)),
    ],
)
def test_repeated_points_and_knots_and_lines_of_higher_degree_are_as_good_as_any(top: Json) -> None:
    assert accept([top, *polygon((1, 0), (1, -1), (-1, -1), (-1, 0))[:3]]).notes == ()


def test_documents_of_few_digits_are_accepted() -> None:
    loop = mapped(circle(0, 0, 1), 1.0, 0.1, 0.2, 0.3)
    for digits in range(3, 16):
        rounded = [
            edge | {"control_points": [[round(x, digits), round(y, digits)] for x, y in edge["control_points"]]}
            for edge in loop
        ]
        assert Domain.from_dict(domain(rounded)).area == pytest.approx(math.pi, abs=10.0 ** (1 - digits))
