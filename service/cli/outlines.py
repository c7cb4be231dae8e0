"""``mat outlines``: domains from a drawing, a picture, a map or a font, one JSON domain a line."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import PurePath

from mat_core.errors import UnreadableInput, UnsupportedOption
from mat_core.outlines import Outlines, from_dxf, from_font, from_geojson, from_svg
from service.cli import files
from service.cli.exits import INVALID_INPUT, OK, USAGE, Failure, tell

FONTS = (".ttf", ".otf", ".ttc", ".woff")
OPTIONS = {"flip": (".svg",), "layer": (".dxf",), "gap": (".dxf",), "characters": FONTS}
"""Endings of the files that an option is for."""

MOST = 20
"""Lines on what was left out; the rest is counted."""


def outlines(asked: argparse.Namespace) -> int:
    """Read a file, write its domains, tell what was left out."""
    ending = PurePath(asked.input.removesuffix(files.PACKED)).suffix.lower()
    if ending not in READERS:
        raise Failure(USAGE, f"{asked.input}: the kind of a file is told by its ending, one of {' '.join(READERS)}")
    for option, endings in OPTIONS.items():
        if getattr(asked, option) is not None and ending not in endings:
            raise Failure(USAGE, f"--{option} is for {' '.join(endings)}, not for {ending}")
    try:
        found = READERS[ending](asked)
    except (UnsupportedOption, ImportError) as error:
        raise Failure(USAGE, f"{asked.input}: {error}") from error
    except UnreadableInput as error:
        raise Failure(INVALID_INPUT, f"{asked.input}: {error}") from error
    except OSError as error:
        raise Failure(USAGE, f"cannot read {asked.input}: {error.strerror}") from error
    for text in found.left_out[:MOST]:
        tell(f"{asked.input}: left out: {text}")
    if len(found.left_out) > MOST:
        tell(f"{asked.input}: left out: and {len(found.left_out) - MOST} more")
    if not found.domains:
        raise Failure(INVALID_INPUT, f"{asked.input}: no outline was found")
    files.write(asked.output, b"".join(json.dumps(domain).encode() + b"\n" for domain in found.domains))
    return OK


def _dxf(asked: argparse.Namespace) -> Outlines:
    given = {} if asked.gap is None else {"gap": asked.gap}
    return from_dxf(asked.input, layers=asked.layer, **given)


def _font(asked: argparse.Namespace) -> Outlines:
    if asked.characters is None:
        raise Failure(USAGE, f"{asked.input}: say which glyphs by --characters, such as --characters 'Qa&'")
    return from_font(asked.input, asked.characters)


READERS: dict[str, Callable[[argparse.Namespace], Outlines]] = {
    ".svg": lambda asked: from_svg(files.read(asked.input), flip=bool(asked.flip)),
    ".dxf": _dxf,
    ".geojson": lambda asked: from_geojson(files.read(asked.input)),
    ".json": lambda asked: from_geojson(files.read(asked.input)),
} | dict.fromkeys(FONTS, _font)
