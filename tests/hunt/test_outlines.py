"""Path data, nesting, SVG and font files are read as they are meant."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from tests.hunt.nesting import domains, polygon
from tests.hunt.outlines import contours, filled_parts, glyphs, icons, lines
from tests.hunt.paths import BadPath, basic_shape, commands, path


def corners(data: str) -> list[list[list[float]]]:
    """The points where the edges of each loop begin."""
    return [[e["control_points"][0] for e in loop] for loop in path(data)]


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


@pytest.mark.parametrize("data", ["0 0L1 1", "M0 0L1", "M0 0X1 1", "M0 0L1 1Z5 5", "M0 0A1 1 0 2 0 1 1"])
def test_bad_data_is_told(data: str) -> None:
    with pytest.raises(BadPath):
        path(data)


def test_smooth_commands_mirror_the_handle() -> None:
    assert path("M0 0C0 1 1 1 1 0S2 -1 2 0Z")[0][1]["control_points"] == [[1, 0], [1, -1], [2, -1], [2, 0]]
    assert path("M0 0c0 1 1 1 1 0s1 -1 1 0z")[0][1]["control_points"] == [[1, 0], [1, -1], [2, -1], [2, 0]]
    assert path("M0 0Q1 2 2 0T4 0T6 0Z")[0][1]["control_points"] == [[2, 0], [3, -2], [4, 0]]
    assert path("M0 0Q1 2 2 0T4 0T6 0Z")[0][2]["control_points"] == [[4, 0], [5, 2], [6, 0]]
    assert path("M0 0L1 0S2 -1 2 3Z")[0][1]["control_points"] == [[1, 0], [1, 0], [2, -1], [2, 3]]


def test_a_subpath_begins_where_the_one_before_began() -> None:
    assert corners("m1 1h2v2zm4 0h1v1z") == [[[1, 1], [3, 1], [3, 3]], [[5, 1], [6, 1], [6, 2]]]


@pytest.mark.parametrize("turn", [0.0, 30.0])
@pytest.mark.parametrize(("large", "sweep"), [(0, 0), (0, 1), (1, 0), (1, 1)])
def test_arcs_lie_on_their_ellipse(large: int, sweep: int, turn: float) -> None:
    loop = path(f"M1 0A3 2 {turn} {large} {sweep} 2.5 1.5Z")[0]
    p = polygon(loop[:-1])
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
    p = polygon(path("M0 0A1 1 0 0 1 4 0Z")[0][:-1])
    assert np.allclose(np.linalg.norm(p - [2, 0], axis=1), 2)


def test_basic_shapes() -> None:
    area = {"circle": math.pi * 4, "ellipse": math.pi * 6, "rect": 12 - (4 - math.pi) * 0.25, "polygon": 0.5}
    given = {
        "circle": {"r": "2"},
        "ellipse": {"rx": "2", "ry": "3", "cx": "1"},
        "rect": {"width": "3", "height": "4", "rx": ".5"},
        "polygon": {"points": "0,0 1,0 1,1"},
    }
    for tag, attributes in given.items():
        p = polygon(path(basic_shape(tag, attributes) or "")[0])
        q = np.roll(p, -1, axis=0)
        assert np.sum(p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]) / 2 == pytest.approx(area[tag], rel=0.02)
    assert basic_shape("line", {}) is None
    assert basic_shape("circle", {"r": "50%"}) is None


RINGS = "M0 0h9v9h-9z M1 1h7v7h-7z M2 2h5v5h-5z"
TURNED = "M0 0h9v9h-9z M1 1v7h7v-7z M2 2h5v5h-5z"


@pytest.mark.parametrize(
    ("data", "rule", "holes"),
    [(RINGS, "evenodd", [1, 0]), (RINGS, "nonzero", [0]), (TURNED, "evenodd", [1, 0]), (TURNED, "nonzero", [1, 0])],
)
def test_nesting(data: str, rule: str, holes: list[int]) -> None:
    assert [len(d["holes"]) for d in domains(path(data), rule)] == holes


def test_loops_that_cross_are_no_domain() -> None:
    assert domains(path("M0 0h2v2h-2z M1 1h2v2h-2z")) == []


def test_svg_files(tmp_path: Path) -> None:
    head = '<svg xmlns="http://www.w3.org/2000/svg"'
    (tmp_path / "a.svg").write_text(f'{head}><defs><path d="M0 0h1v1z"/></defs><g fill="none"><path d="M0 0h1v1z"/></g>'
                                    '<path d="M0 0h4v4h-4z"/><circle r="3" style="fill: none"/></svg>')  # fmt: skip
    (tmp_path / "b.svg").write_text(f'{head} fill="none"><path d="M0 0h1v1z"/></svg>')
    (tmp_path / "c.svg").write_text(f'{head}><g transform="scale(2)"><path d="M0 0h1v1z"/></g></svg>')
    (tmp_path / "d.svg").write_text("no svg")
    assert [len(filled_parts(f)) for f in sorted(tmp_path.iterdir())] == [1, 0, 0, 0]
    assert [name for name, _ in icons(str(tmp_path), 0, 0)] == [f"icons_{tmp_path.name}/a#0"]


def test_contours_without_a_point_on_the_curve() -> None:
    ring = contours([("qCurveTo", ((1, 1), (-1, 1), (-1, -1), (1, -1), None)), ("closePath", ())])
    assert [e["control_points"][0] for e in ring[0]] == [[1, 0], [0, 1], [-1, 0], [0, -1]]


def test_a_font() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    file = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
    found = list(glyphs(file, 5, 1))
    assert found == list(glyphs(file, 5, 1))
    assert all(name.startswith("font_DejaVuSans/") and d["outer"] for name, d in found)


def test_lines_of_domains(tmp_path: Path) -> None:
    file = tmp_path / "some.jsonl"
    file.write_text(json.dumps({"name": "one", "outer": [], "holes": []}) + "\n\n" + json.dumps({"outer": []}) + "\n")
    assert [name for name, _ in lines(file)] == ["lines_some/one", "lines_some/3"]


def test_contours_close_in_spite_of_rounding() -> None:
    end = (2e-5, 0.0)
    curve, side = ("curveTo", ((5.0, 9.0), end, end)), ("lineTo", ((5.0, 0.0),))
    ring = contours([("moveTo", ((0.0, 0.0),)), side, curve, ("closePath", ())])
    assert [e["degree"] for e in ring[0]] == [1, 3]
    assert ring[0][1]["control_points"][2:] == [[0.0, 0.0], [0.0, 0.0]]
