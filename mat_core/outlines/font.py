"""Domains from the glyphs of a font file, TrueType or CFF, read by fontTools (extra ``fonts``).

Coordinates are the font's own units, y up. Contours of TrueType are quadratic, those of CFF cubic; both stay so.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise
from os import PathLike
from typing import Any

from mat_core.errors import UnreadableInput, UnsupportedOption
from mat_core.outlines.nesting import Outlines, nested
from mat_core.outlines.pen import Loop, Pen, Point

CLOSED = 1e-7  # of the largest coordinate: what sums of 16.16 fixed numbers may be off where a contour closes
LISTED = 5


def from_font(
    file: str | PathLike[str], characters: str, *, location: Mapping[str, float] | None = None, number: int = 0
) -> Outlines:
    """The domains of some characters.

    Parameters
    ----------
    file : path
        A .ttf, .otf, .ttc or .woff file.
    characters : str
        Each is drawn by itself, at the origin; spaces have no outline.
    location : mapping, optional
        Where on the axes of a variable font, such as ``{"wght": 700}``.
    number : int
        Which font of a collection.

    Returns
    -------
    Outlines
        Domains named by their glyph, `name#i` where it has several parts. Contours that cross, as those of variable fonts may,
        are left out: the font's tools unite them.

    Raises
    ------
    UnreadableInput
        It is not a font.
    UnsupportedOption
        The font does not have one of the characters.
    ImportError
        fontTools is not installed.
    """
    try:
        from fontTools.ttLib import TTFont, TTLibError
    except ImportError as error:
        raise ImportError("fonts need the package fontTools: pip install 'mat-core[fonts]'") from error
    try:
        font = TTFont(file, lazy=True, fontNumber=number)
        glyphs, names = font.getGlyphSet(location=dict(location) if location else None), font.getBestCmap() or {}
    except TTLibError as error:
        raise UnreadableInput(f"{file} is not a font that can be read: {error}") from error
    strange = sorted({c for c in characters if ord(c) not in names})
    if strange:
        raise UnsupportedOption("characters", f"the font has no {', '.join(map(repr, strange[:LISTED]))}")
    found = Outlines()
    for name in (names[ord(c)] for c in characters):
        found.add(name, nested(glyph_loops(glyphs, name), "nonzero"))
    return found


def glyph_loops(glyphs: Any, name: str) -> list[Loop]:
    """The contours of a glyph of a fontTools glyph set, components taken apart."""
    from fontTools.pens.recordingPen import DecomposingRecordingPen

    recorded = DecomposingRecordingPen(glyphs)
    glyphs[name].draw(recorded)
    return drawn_loops(recorded.value)


def drawn_loops(recorded: Iterable[tuple[str, tuple[Any, ...]]]) -> list[Loop]:
    """Loops from what a pen of fontTools was told."""
    pen = Pen()
    for name, given in recorded:
        if name == "moveTo":
            pen.move(_point(given[0]))
        elif name in ("lineTo", "curveTo"):
            pen.draw([_point(p) for p in given])
        elif name == "qCurveTo":
            _quadratics(pen, given)
        else:
            pen.close(CLOSED)
    return pen.loops


def _quadratics(pen: Pen, given: tuple[Any, ...]) -> None:
    """A run of quadratics: between two control points in a row the curve passes the middle of them."""
    off, end = [_point(p) for p in given[:-1]], given[-1]
    if end is None:  # no point of the contour is on the curve
        end = _middle(off[-1], off[0])
        pen.move(end)
    for control, after in pairwise(off):
        pen.draw([control, _middle(control, after)])
    pen.draw([*off[-1:], _point(end)])


def _middle(a: Point, b: Point) -> Point:
    return (a[0] + b[0]) / 2, (a[1] + b[1]) / 2


def _point(given: Any) -> Point:
    return float(given[0]), float(given[1])
