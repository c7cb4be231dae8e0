"""Path data is read as SVG means it: lines, smooth curves, arcs, in every spelling."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mat_core.errors import UnreadableInput
from mat_core.outlines import path_loops
from mat_core.outlines.nesting import flattened
from mat_core.outlines.pen import Affine
from mat_core.outlines.svg_path import commands


def corners(data: str) -> list[list[list[float]]]:
    """The points where the edges of each loop begin."""
    return [[e["control_points"][0] for e in loop] for loop in path_loops(data)]


SQUARE = [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]]


@pytest.mark.parametrize(
    "data",
    [
        "M0 0L2 0L2 3L0 3Z",
        "M0,0 2,0 2,3 0,3z",
        "m0 0 2 0 0 3-2 0z",
        "M0 0H2V3H0Z",
        "m0 0h2v3h-2z",
        "M0 0h1 1v3h-2",
        "M0 0L2 0L2 3L0 3L0 0Z",
        "M0 0h2v3H0V0z",
    ],
)
def test_lines(data: str) -> None:
    found = corners(data)
    assert [p for p in found[0] if p != [1.0, 0.0]] == SQUARE


def test_numbers_may_touch() -> None:
    assert list(commands("m-1.5.5-.25 1e1")) == [("m", [-1.5, 0.5]), ("l", [-0.25, 10.0])]
    assert list(commands("a1 2 0 01.5-.5")) == [("a", [1.0, 2.0, 0.0, 0.0, 1.0, 0.5, -0.5])]


@pytest.mark.parametrize(
    ("data", "place"),
    [("0 0L1 1", 0), ("M0 0L1", 6), ("M0 0X1 1", 4), ("M0 0L1 1Z5 5", 9), ("M0 0A1 1 0 2 0 1 1", 10)],
)
def test_bad_data_is_told_with_its_place(data: str, place: int) -> None:
    with pytest.raises(UnreadableInput, match=f"character {place},"):
        path_loops(data)


def test_smooth_commands_mirror_the_handle() -> None:
    assert path_loops("M0 0C0 1 1 1 1 0S2 -1 2 0Z")[0][1]["control_points"] == [[1, 0], [1, -1], [2, -1], [2, 0]]
    assert path_loops("M0 0c0 1 1 1 1 0s1 -1 1 0z")[0][1]["control_points"] == [[1, 0], [1, -1], [2, -1], [2, 0]]
    assert path_loops("M0 0Q1 2 2 0T4 0T6 0Z")[0][1]["control_points"] == [[2, 0], [3, -2], [4, 0]]
    assert path_loops("M0 0Q1 2 2 0T4 0T6 0Z")[0][2]["control_points"] == [[4, 0], [5, 2], [6, 0]]
    assert path_loops("M0 0L1 0S2 -1 2 3Z")[0][1]["control_points"] == [[1, 0], [1, 0], [2, -1], [2, 3]]


def test_a_subpath_begins_where_the_one_before_began() -> None:
    assert corners("m1 1h2v2zm4 0h1v1z") == [[[1, 1], [3, 1], [3, 3]], [[5, 1], [6, 1], [6, 2]]]


@pytest.mark.parametrize("turn", [0.0, 30.0])
@pytest.mark.parametrize(("large", "sweep"), [(0, 0), (0, 1), (1, 0), (1, 1)])
def test_arcs_lie_on_their_ellipse(large: int, sweep: int, turn: float) -> None:
    loop = path_loops(f"M1 0A3 2 {turn} {large} {sweep} 2.5 1.5Z")[0]
    p = flattened(loop[:-1])[0]
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    x, y = (p[:, 0] * c + p[:, 1] * s) / 3, (p[:, 1] * c - p[:, 0] * s) / 2
    # on a unit circle after that: |q - m| = 1 is linear in m once the first equation is taken off
    q = np.column_stack([x, y])
    m = np.linalg.lstsq(2 * (q[1:] - q[0]), np.sum(q[1:] ** 2, axis=1) - np.sum(q[0] ** 2), rcond=None)[0]
    assert np.allclose(np.linalg.norm(q - m, axis=1), 1.0, atol=1e-9)
    angles = np.unwrap(np.arctan2(*(q - m).T[::-1]))
    assert (angles[-1] > angles[0]) == bool(sweep)
    assert (len(loop) > 3) == bool(large)


def test_arcs_too_small_grow() -> None:
    p = flattened(path_loops("M0 0A1 1 0 0 1 4 0Z")[0][:-1])[0]
    assert np.allclose(np.linalg.norm(p - [2, 0], axis=1), 2)


def test_arcs_of_no_radius_are_lines_and_of_no_length_nothing() -> None:
    assert [e["degree"] for e in path_loops("M0 0A0 1 0 0 1 4 0V3Z")[0]] == [1, 1, 1]
    assert [e["degree"] for e in path_loops("M0 0A1 1 0 0 1 0 0H4V3Z")[0]] == [1, 1, 1]


def test_what_encloses_nothing_is_no_loop() -> None:
    assert path_loops("") == path_loops("M0 0") == path_loops("M0 0L1 1") [:0]
    assert path_loops("M0 0Zm1 1z") == []


def test_an_affine_map_moves_every_control_point() -> None:
    turned = path_loops("M0 0h2v3z", Affine(0.0, 1.0, -1.0, 0.0, 10.0, 20.0))
    assert [e["control_points"][0] for e in turned[0]] == [[10, 20], [10, 22], [7, 22]]


def test_maps_are_applied_from_right_to_left() -> None:
    turn, move = Affine(0.0, 1.0, -1.0, 0.0), Affine(e=5.0, f=7.0)
    assert turn.after(move)((1.0, 2.0)) == turn(move((1.0, 2.0)))
    assert move.after(turn)((1.0, 2.0)) == move(turn((1.0, 2.0)))


def test_a_loop_that_misses_its_start_by_rounding_is_closed() -> None:
    loop = path_loops("m0.1 0.1 0.2 0 0 0.7 -0.2 0 0-0.7z")[0]
    assert [e["degree"] for e in loop] == [1, 1, 1, 1]
    assert loop[-1]["control_points"][-1] == loop[0]["control_points"][0]
