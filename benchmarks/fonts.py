"""Whole fonts: every outline of the printable characters of ASCII, in the fonts that come with matplotlib.

Nobody chose these glyphs one by one, so their median says what a glyph costs; that of a font depends on how many edges it is
drawn with.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.timing import timed
from mat_core import Domain, medial_axis
from mat_core.outlines import nested
from mat_core.outlines.font import glyph_loops

Json = dict[str, Any]

FONTS = ("DejaVuSans", "DejaVuSerif", "STIXGeneral", "cmr10")
PRINTABLE = range(33, 127)
RUNS = 7
BUDGET = 0.2  # seconds of one outline


class Font(NamedTuple):
    """Edges, and milliseconds in `medial_axis` at 1e-6, of every outline."""

    name: str
    edges: list[int]
    ms: list[float]


def fonts() -> list[Font]:
    """All of FONTS."""
    return [_measured(name) for name in FONTS]


def median(measured: Sequence[Font]) -> float:
    """Milliseconds, over the outlines of all fonts."""
    return statistics.median(ms for font in measured for ms in font.ms)


def _measured(name: str) -> Font:
    font = Font(name, [], [])
    for outline in outlines(name):
        domain = Domain.from_dict(outline)
        font.edges.append(sum(map(len, [outline["outer"], *outline["holes"]])))
        font.ms.append(timed(lambda domain=domain: medial_axis(domain), BUDGET, RUNS).ms)
    return font


def outlines(name: str) -> Iterator[Json]:
    """The domains of a font's printable characters."""
    import matplotlib
    from fontTools.ttLib import TTFont

    font = TTFont(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / f"{name}.ttf")
    drawn, named = font.getGlyphSet(), font.getBestCmap()
    for character in PRINTABLE:
        if character in named:
            yield from nested(glyph_loops(drawn, named[character]), "nonzero").domains


def table(measured: list[Font]) -> list[str]:
    lines = ["| font | outlines | edges, median | ms, median | ms, largest |", "|---|---:|---:|---:|---:|"]
    for font in measured:
        figures = f"{statistics.median(font.edges):.0f} | {statistics.median(font.ms):.3g} | {max(font.ms):.3g}"
        lines.append(f"| {font.name} | {len(font.ms)} | {figures} |")
    count = sum(len(font.ms) for font in measured)
    return [*lines, "", f"The median of all {count} outlines is {median(measured):.3g} ms."]
