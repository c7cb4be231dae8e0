"""Glyphs of a font become domains; contours of every kind that fonts have are closed."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import pytest

from mat_core.errors import UnreadableInput, UnsupportedOption
from mat_core.model.domain import Domain
from mat_core.outlines import from_font
from mat_core.outlines.font import drawn_loops

FONT = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"


def test_characters_of_a_font() -> None:
    found = from_font(FONT, "Q i8")
    assert [d["name"] for d in found.domains] == ["Q", "i#0", "i#1", "eight"]
    assert [len(d["holes"]) for d in found.domains] == [1, 0, 0, 2]
    assert found.left_out == []
    assert all(Domain.from_dict(d).area > 0 for d in found.domains)


def test_a_character_that_the_font_lacks() -> None:
    with pytest.raises(UnsupportedOption, match="characters: the font has no '\U0001f9ff'"):
        from_font(FONT, "a\U0001f9ff")


def test_what_is_no_font(tmp_path: Path) -> None:
    (tmp_path / "a.ttf").write_text("no font")
    with pytest.raises(UnreadableInput, match="not a font"):
        from_font(tmp_path / "a.ttf", "a")
    with pytest.raises(FileNotFoundError):
        from_font(tmp_path / "b.ttf", "a")


def test_contours_without_a_point_on_the_curve() -> None:
    ring = drawn_loops([("qCurveTo", ((1, 1), (-1, 1), (-1, -1), (1, -1), None)), ("closePath", ())])
    assert [e["control_points"][0] for e in ring[0]] == [[1, 0], [0, 1], [-1, 0], [0, -1]]


def test_a_quadratic_without_a_control_point_is_a_line() -> None:
    ring = drawn_loops([("moveTo", ((0, 0),)), ("qCurveTo", ((4, 0),)), ("lineTo", ((4, 4),)), ("endPath", ())])
    assert [e["degree"] for e in ring[0]] == [1, 1, 1]


def test_contours_close_in_spite_of_rounding() -> None:
    end = (2e-7, 0.0)
    curve, side = ("curveTo", ((5.0, 9.0), end, end)), ("lineTo", ((5.0, 0.0),))
    ring = drawn_loops([("moveTo", ((0.0, 0.0),)), side, curve, ("closePath", ())])
    assert [e["degree"] for e in ring[0]] == [1, 3]
    assert ring[0][1]["control_points"][2:] == [[0.0, 0.0], [0.0, 0.0]]
