"""Real outlines: glyphs of font files, icons of SVG files, lines of domain files.

Each source gives (name, domain). Which glyphs and icons is chosen by a seed; a name says where a domain came from, and
`#n` is its number within the glyph or icon.
"""

from __future__ import annotations

import gzip
import json
import math
import random
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from tests.families import bezier
from tests.hunt.nesting import domains
from tests.hunt.paths import BadPath, basic_shape, path

Json = dict[str, Any]
Loop = list[dict[str, Any]]
FONT_FILES = (".ttf", ".otf", ".ttc")
GAP = 1e-4  # font units: what sums of 16.16 fixed numbers may be off where a contour closes
UNDRAWN = {"defs", "clipPath", "mask", "symbol", "pattern", "marker", "linearGradient", "radialGradient"}


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
    try:
        from fontTools.pens.recordingPen import DecomposingRecordingPen
        from fontTools.ttLib import TTFont, TTLibError
    except ImportError:
        raise SystemExit("--fonts needs fonttools, one of the developers' packages: make dev") from None
    try:
        font = TTFont(file, lazy=True, fontNumber=0)
        outlines, names = font.getGlyphSet(), sorted(set((font.getBestCmap() or {}).values()))
    except (TTLibError, OSError):
        return
    random.Random(seed).shuffle(names)
    for name in names[: count or None]:
        pen = DecomposingRecordingPen(outlines)
        try:
            outlines[name].draw(pen)
        except Exception:  # a broken glyph is the font's fault
            continue
        for number, domain in enumerate(domains(contours(pen.value))):
            yield f"font_{file.stem}/{name}#{number}", domain


def contours(recorded: list[tuple[str, tuple[Any, ...]]]) -> list[Loop]:
    """Loops from what a pen was told."""
    loops: list[Loop] = []
    loop: Loop = []
    here = start = (0.0, 0.0)

    def draw(points: list[Any]) -> None:
        nonlocal here
        points = [(float(x), float(y)) for x, y in points]
        if any(p != here for p in points):
            loop.append(bezier([here, *points]))
        here = points[-1]

    for name, args in recorded:
        if name == "moveTo":
            here = start = (float(args[0][0]), float(args[0][1]))
        elif name in ("lineTo", "curveTo"):
            draw(list(args))
        elif name == "qCurveTo":
            off, end = list(args[:-1]), args[-1]
            if end is None:  # no point of the contour is on the curve
                end = _middle(off[-1], off[0])
                here = start = (float(end[0]), float(end[1]))
            for control, after in zip(off, [*off[1:], None], strict=True):
                draw([control, end if after is None else _middle(control, after)])
            if not off:
                draw([end])
        elif name in ("closePath", "endPath"):
            if loop and 0 < math.dist(here, start) < GAP:
                points = loop[-1]["control_points"]  # a handle of no length stays one
                points[1:] = [list(start) if tuple(p) == here else p for p in points[1:]]
                here = start
            draw([start])
            if loop:
                loops.append(loop)
            loop = []
    return loops


def _middle(a: Any, b: Any) -> tuple[float, float]:
    return (a[0] + b[0]) / 2, (a[1] + b[1]) / 2


# Icons ---------------------------------------------------------------------------------------------------------------
def icons(folder: str, count: int, seed: int) -> Iterator[tuple[str, Json]]:
    """The domains of so many SVG files below a folder; 0: of all. Files with transformations are left out."""
    found = files([folder], (".svg",))
    random.Random(seed).shuffle(found)
    usable = (part for part in ((file, filled_parts(file)) for file in found) if part[1])
    for file, parts in islice(usable, count or None):
        name = file.relative_to(folder).with_suffix("").as_posix() if Path(folder).is_dir() else file.stem
        made = (d for data, rule in parts for d in _domains_of(data, rule))
        for number, domain in enumerate(made):
            yield f"icons_{Path(folder).name}/{name}#{number}", domain


def _domains_of(data: str, rule: str) -> list[Json]:
    try:
        return domains(path(data), rule)
    except BadPath:
        return []


def filled_parts(file: Path) -> list[tuple[str, str]]:
    """(path data, fill rule) of everything in an SVG file that is filled."""
    try:
        root = ElementTree.parse(file).getroot()
    except (ElementTree.ParseError, OSError):
        return []
    parts: list[tuple[str, str]] = []

    def walk(element: ElementTree.Element, fill: str, rule: str) -> bool:
        tag = element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""
        style = dict(p.split(":", 1) for p in element.get("style", "").replace(" ", "").split(";") if ":" in p)
        fill = style.get("fill", element.get("fill", "none" if "fill-none" in element.get("class", "") else fill))
        rule = style.get("fill-rule", element.get("fill-rule", rule))
        if "transform" in element.attrib or "transform" in style or tag == "style":
            return False
        data = basic_shape(tag, element.attrib)
        if data and fill != "none":
            parts.append((data, "evenodd" if rule == "evenodd" else "nonzero"))
        return tag in UNDRAWN or all(walk(child, fill, rule) for child in element)

    return parts if walk(root, "black", "nonzero") else []


# Files of domains ----------------------------------------------------------------------------------------------------
def lines(file: Path) -> Iterator[tuple[str, Json]]:
    """Domains, one a line; also compressed."""
    with gzip.open(file, "rt", encoding="utf-8") if file.suffix == ".gz" else file.open(encoding="utf-8") as text:
        for number, row in enumerate(text, start=1):
            if row.strip():
                domain = json.loads(row)
                yield f"lines_{file.name.split('.')[0]}/{domain.get('name', number)}", domain
