"""Loops from the path data of SVG: M L H V C S Q T A Z, absolute and relative (SVG 2, section 9.3).

y points down in SVG; it is kept as it is.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from mat_core.errors import UnreadableInput
from mat_core.outlines.pen import Affine, Loop, Pen, Point, quarters

COUNTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
"""Numbers that each command takes."""

FLAGS = (3, 4)
"""Which numbers of an arc are 0 or 1, and may touch what follows."""

_NUMBER = re.compile(r"[\s,]*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")
_FLAG = re.compile(r"[\s,]*([01])")
_COMMAND = re.compile(r"[\s,]*([MmLlHhVvCcSsQqTtAaZz])")
_SHOWN = 20


def path_loops(data: str, affine: Affine = Affine()) -> list[Loop]:  # noqa: B008 - it is a tuple
    """The loops of path data; each subpath is closed, as filling does.

    Parameters
    ----------
    data : str
        The attribute ``d`` of a path.
    affine : Affine
        Where it goes.

    Returns
    -------
    list of list of dict
        Loops of edges for `nested`.

    Raises
    ------
    UnreadableInput
        The data follows no grammar.
    """
    pen = Pen(affine)
    before, handle = "", (0.0, 0.0)
    for name, given in commands(data):
        upper, (x, y) = name.upper(), pen.here
        origin = pen.here if name.islower() else (0.0, 0.0)
        if upper == "M":
            pen.move(_pairs(given, origin)[0])
        elif upper == "Z":
            pen.close()
        elif upper == "H":
            pen.draw([(given[0] + origin[0], y)])
        elif upper == "V":
            pen.draw([(x, given[0] + origin[1])])
        elif upper == "A":
            (to,) = _pairs(given[5:], origin)
            for points, weights in arcs((x, y), given[0], given[1], given[2], bool(given[3]), bool(given[4]), to):
                pen.draw(points, weights)
        else:
            points = _pairs(given, origin)
            if upper in "ST":  # the first handle mirrors the last one of the command before, if that had one of its kind
                alike = before in ("C", "S") if upper == "S" else before in ("Q", "T")
                points.insert(0, (2 * x - handle[0], 2 * y - handle[1]) if alike else (x, y))
            pen.draw(points)
            handle = points[-2] if len(points) > 1 else points[-1]
        before = upper
    pen.close()
    return pen.loops


def commands(data: str) -> Iterator[tuple[str, list[float]]]:
    """(command, its numbers), one for each repetition; a repeated M is an L."""
    at, name = 0, ""
    data = data.strip()
    while at < len(data):
        found = _COMMAND.match(data, at)
        if found:
            name, at = found[1], found.end()
        elif name in ("", "Z", "z"):
            raise UnreadableInput(f"path data: no command at character {at}, {data[at : at + _SHOWN]!r}")
        numbers = []
        for i in range(COUNTS[name.upper()]):
            match = (_FLAG if name in "Aa" and i in FLAGS else _NUMBER).match(data, at)
            if not match:
                found_there = repr(data[at : at + _SHOWN]) if at < len(data) else "the end"
                raise UnreadableInput(f"path data: {name} wants a number at character {at}, where there is {found_there}")
            numbers.append(float(match[1]))
            at = match.end()
        yield name, numbers
        name = {"M": "L", "m": "l"}.get(name, name)


def _pairs(numbers: list[float], origin: Point) -> list[Point]:
    """Points from their coordinates, relative to an origin."""
    return [(x + origin[0], y + origin[1]) for x, y in zip(numbers[::2], numbers[1::2], strict=True)]


def arcs(
    a: Point, rx: float, ry: float, degrees: float, large: bool, sweep: bool, b: Point
) -> Iterator[tuple[list[Point], list[float] | None]]:
    """The elliptical arc from a to b as (points after the first, weights), by appendix B.2 of SVG 2."""
    rx, ry = abs(rx), abs(ry)
    if a == b:
        return
    if not rx or not ry:
        yield [b], None
        return
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    hx, hy = (a[0] - b[0]) / 2, (a[1] - b[1]) / 2
    px, py = c * hx + s * hy, c * hy - s * hx
    size = (px / rx) ** 2 + (py / ry) ** 2
    if size > 1:
        rx, ry, size = rx * math.sqrt(size), ry * math.sqrt(size), 1.0
    reach = math.sqrt(max(0.0, 1 / size - 1)) * (-1 if large == sweep else 1)
    qx, qy = reach * rx * py / ry, -reach * ry * px / rx
    start = math.atan2((py - qy) / ry, (px - qx) / rx)
    turn = math.atan2((-py - qy) / ry, (-px - qx) / rx) - start
    turn += 2 * math.pi * (sweep and turn < 0) - 2 * math.pi * (not sweep and turn > 0)
    mx, my = (a[0] + b[0]) / 2 + c * qx - s * qy, (a[1] + b[1]) / 2 + s * qx + c * qy
    ellipse = Affine(c * rx, s * rx, -s * ry, c * ry, mx, my)
    pieces = list(quarters(ellipse, start, turn))
    pieces[-1][0][-1] = b
    yield from pieces
