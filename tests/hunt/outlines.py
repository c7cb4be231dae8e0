"""Real outlines: glyphs of font files, icons of SVG files, lines of domain files.

Each source gives (name, domain). Which glyphs and icons is chosen by a seed; a name says where a domain came from, and
`#n` is its number within the glyph or icon.
"""

from __future__ import annotations

import gzip
import json
import random
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

from mat_core.errors import UnreadableInput
from mat_core.outlines import from_svg, nested
from mat_core.outlines.font import glyph_loops

Json = dict[str, Any]
FONT_FILES = (".ttf", ".otf", ".ttc")


def files(places: list[str], endings: tuple[str, ...]) -> list[Path]:
    """The files among and below some places, by their endings, in order."""
    found: set[Path] = set()
    for place in map(Path, places):
        if not place.exists():
            raise SystemExit(f"there is no {place}")
        found |= {place} if place.is_file() else {p for p in place.rglob("*") if p.suffix.lower() in endings}
    return sorted(found)


# Fonts ---------------------------------------------------------------------------------------------------------------
def glyphs(file: Path, count: int, seed: int) -> Iterator[tuple[str, Json]]:
    """The domains of so many glyphs of a font file, TrueType or CFF; 0: of all."""
    from fontTools.ttLib import TTFont, TTLibError

    try:
        font = TTFont(file, lazy=True, fontNumber=0)
        outlines, names = font.getGlyphSet(), sorted(set((font.getBestCmap() or {}).values()))
    except (TTLibError, OSError):
        return
    random.Random(seed).shuffle(names)
    for name in names[: count or None]:
        try:
            loops = glyph_loops(outlines, name)
        except Exception:  # a broken glyph is the font's fault
            continue
        for number, domain in enumerate(nested(loops, "nonzero").domains):
            yield f"font_{file.stem}/{name}#{number}", domain


# Icons ---------------------------------------------------------------------------------------------------------------
def icons(folder: str, count: int, seed: int) -> Iterator[tuple[str, Json]]:
    """The domains of so many SVG files below a folder; 0: of all."""
    found = files([folder], (".svg",))
    random.Random(seed).shuffle(found)
    usable = ((file, part) for file, part in ((file, _filled(file)) for file in found) if part)
    for file, filled in islice(usable, count or None):
        name = file.relative_to(folder).with_suffix("").as_posix() if Path(folder).is_dir() else file.stem
        for number, domain in enumerate(filled):
            yield f"icons_{Path(folder).name}/{name}#{number}", domain


def _filled(file: Path) -> list[Json]:
    """The domains that an SVG file fills; none where it cannot be read."""
    try:
        return from_svg(file.read_bytes()).domains
    except UnreadableInput:
        return []


# Files of domains ----------------------------------------------------------------------------------------------------
def lines(file: Path) -> Iterator[tuple[str, Json]]:
    """Domains, one a line; also compressed."""
    with gzip.open(file, "rt", encoding="utf-8") if file.suffix == ".gz" else file.open(encoding="utf-8") as text:
        for number, row in enumerate(text, start=1):
            if row.strip():
                domain = json.loads(row)
                yield f"lines_{file.name.split('.')[0]}/{domain.get('name', number)}", domain
