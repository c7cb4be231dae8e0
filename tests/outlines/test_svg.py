"""SVG documents: what is filled becomes domains where it stands; what is not is told."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mat_core.errors import UnreadableInput
from mat_core.model.domain import Domain
from mat_core.outlines import Outlines, from_svg
from mat_core.outlines.svg import path_data, transformation


def read(inner: str, attributes: str = "", **options: bool) -> Outlines:
    return from_svg(f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{inner}</svg>', **options)


def names(found: Outlines) -> list[str]:
    return [d["name"] for d in found.domains]


@pytest.mark.parametrize(
    ("element", "area"),
    [
        ('<circle r="2" cx="7"/>', 4 * math.pi),
        ('<ellipse rx="2" ry="3px" cx="1"/>', 6 * math.pi),
        ('<rect width="3" height="4"/>', 12),
        ('<rect width="3" height="4" rx=".5"/>', 12 - (4 - math.pi) * 0.25),
        ('<rect width="3" height="4" ry="9" rx="auto"/>', math.pi * 1.5 * 2),  # both cut to half of the sides: an ellipse
        ('<polygon points="0,0 1,0 1,1"/>', 0.5),
        ('<polyline points="0,0 1,0 1,1"/>', 0.5),
        ('<path d="M0 0h2v2H0z M.5.5v1h1v-1z"/>', 3),
    ],
)
def test_shapes(element: str, area: float) -> None:
    found = read(element)
    assert found.left_out == []
    assert [Domain.from_dict(d).area for d in found.domains] == pytest.approx([area], rel=1e-12)


NOTHING = ['<rect width="0" height="3"/>', "<circle/>", "<path/>", '<polygon points=" "/>', '<line x2="3"/>']


@pytest.mark.parametrize("element", NOTHING)
def test_what_encloses_nothing_is_no_domain(element: str) -> None:
    assert read(element) == Outlines()


@pytest.mark.parametrize(
    ("text", "point", "image"),
    [
        ("translate(3)", (1, 2), (4, 2)),
        ("translate(3, 4)", (1, 2), (4, 6)),
        ("scale(2)", (1, 2), (2, 4)),
        ("scale(2 3)", (1, 2), (2, 6)),
        ("rotate(90)", (1, 2), (-2, 1)),
        ("rotate(90 1 1)", (1, 2), (0, 1)),
        ("skewX(45)", (1, 2), (3, 2)),
        ("skewY(45)", (1, 2), (1, 3)),
        ("matrix(1 2 3 4 5 6)", (1, 2), (12, 16)),
        (" translate(1,0) , scale(2)\n", (1, 2), (3, 4)),
        ("", (1, 2), (1, 2)),
    ],
)
def test_transformations(text: str, point: tuple[float, float], image: tuple[float, float]) -> None:
    assert transformation(text)(point) == pytest.approx(image, abs=1e-14)


@pytest.mark.parametrize("text", ["turn(3)", "scale(2", "matrix(1 2)", "translate(a)", "scale()", "scale(1 2 3) x"])
def test_transformations_that_cannot_be_read(text: str) -> None:
    with pytest.raises(UnreadableInput, match="q: transform"):
        read(f'<path id="q" transform="{text}" d="M0 0h1v1z"/>')


def test_groups_hand_on_what_they_say() -> None:
    found = read(
        '<g transform="translate(10 0)" fill="none"><g style="fill: red; fill-rule : evenodd">'
        '<path id="a" transform="scale(2)" d="M0 0h3v3h-3z M1 1h1v1h-1z"/></g><path id="b" d="M0 0h1v1z"/></g>'
    )
    assert names(found) == ["a"]
    domain = Domain.from_dict(found.domains[0])
    assert domain.area == pytest.approx(32)
    assert len(found.domains[0]["holes"]) == 1
    assert min(x for e in found.domains[0]["outer"] for x, _ in e["control_points"]) == 10


def test_parts_of_one_element_are_numbered() -> None:
    assert names(read('<path id="i" d="M0 0h1v3h-1z M0 4h1v1h-1z"/><circle r="3"/>')) == ["i#0", "i#1", "circle 2"]


def test_y_can_be_turned_up() -> None:
    shape = '<path d="M0 0h2v1z" transform="translate(0 5)"/>'
    down, up = (np.array([e["control_points"][0] for e in read(shape, flip=f).domains[0]["outer"]]) for f in (False, True))
    assert down.tolist() == [[0, 5], [2, 5], [2, 6]]
    assert (up == down * [1, -1]).all()


def test_references_are_drawn_where_they_say() -> None:
    found = read(
        '<defs><circle id="c" r="1"/><symbol id="s"><rect id="r" width="1" height="2"/></symbol></defs>'
        '<use href="#c" x="5" y="6"/><use href="#no"/>'
        '<use xmlns:xlink="http://www.w3.org/1999/xlink" xlink:href="#s" transform="scale(3)"/>'
    )
    assert names(found) == ["c", "r"]
    assert [Domain.from_dict(d).area for d in found.domains] == pytest.approx([math.pi, 18])
    assert found.left_out == ["use 2: <use> refers to nothing in this file"]


def test_a_reference_to_itself_ends() -> None:
    found = read('<g id="g"><use id="u" href="#g"/></g>')
    assert found.domains == []
    assert found.left_out == ["u: <use> refers to itself"]


def test_references_that_multiply_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten references in each of twenty groups, each to the group before: 1e20 shapes in two hundred lines."""
    monkeypatch.setattr("mat_core.outlines.svg.MOST_REFERENCES", 1000)
    groups = "".join(f'<g id="g{i + 1}">' + f'<use href="#g{i}"/>' * 10 + "</g>" for i in range(20))
    with pytest.raises(UnreadableInput, match="more than 1000 references"):
        read(f'<circle id="g0" r="0"/>{groups}')


def test_groups_too_deep_are_refused() -> None:
    with pytest.raises(UnreadableInput):
        read("<g>" * 50_000 + "</g>" * 50_000)


def test_what_has_no_outline_is_told() -> None:
    found = read(
        '<style>.a{fill:none}</style><text id="t">abc</text><path id="p" fill="none" stroke="red" d="M0 0h9"/>'
        '<path fill="none" d="M0 0h1v1z"/><g display="none"><circle r="1"/></g><!-- no --><image/>'
        '<path id="x" d="M0 0h2v2h-2z M1 1h2v2h-2z"/>'
    )
    assert found.domains == []
    assert [text.split(":")[0] for text in found.left_out] == ["style sheets are not read", "t", "p", "image 3", "x"]


BROKEN = ["", "no", "<html/>", b"\xff\xfe", '<svg><path d="M0 0L1"/></svg>', '<svg><circle r="5%"/></svg>']


@pytest.mark.parametrize("text", BROKEN)
def test_what_is_no_svg_is_told(text: str | bytes) -> None:
    with pytest.raises(UnreadableInput):
        from_svg(text)


def test_path_data_of_a_path_is_its_own() -> None:
    assert path_data("path", {"d": "M1 2"}) == "M1 2"
