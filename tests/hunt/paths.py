"""Loops of edges from the path data of SVG: M L H V C S Q T A Z in both cases, and the basic shapes.

y points down in SVG; it is kept as it is. Arcs become rational quadratics of a quarter turn at most.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from tests.families import bezier, line

Edge = dict[str, Any]
Loop = list[Edge]
Point = tuple[float, float]

COUNTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}  # numbers a command takes
_NUMBER = re.compile(r"[\s,]*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")
_FLAG = re.compile(r"[\s,]*([01])")
_COMMAND = re.compile(r"[\s,]*([MmLlHhVvCcSsQqTtAaZz])")


class BadPath(ValueError):
    """Path data that follows no grammar."""


def commands(data: str) -> Iterator[tuple[str, list[float]]]:
    """(command, its numbers), one for each repetition; a repeated M is an L."""
    at, name = 0, ""
    data = data.strip()
    while at < len(data):
        found = _COMMAND.match(data, at)
        if found:
            name, at = found[1], found.end()
        elif name in ("", "Z", "z"):
            raise BadPath(f"no command at {at}: {data[at : at + 20]!r}")
        numbers = []
        for i in range(COUNTS[name.upper()]):
            match = (_FLAG if name in "Aa" and i in (3, 4) else _NUMBER).match(data, at)
            if not match:
                raise BadPath(f"no number at {at}: {data[at : at + 20]!r}")
            numbers.append(float(match[1]))
            at = match.end()
        yield name, numbers
        name = {"M": "L", "m": "l"}.get(name, name)


class _Pen:
    """Collects edges; a subpath is closed when the next begins, as filling does."""

    def __init__(self) -> None:
        self.loops: list[Loop] = []
        self.loop: Loop = []
        self.start: Point = (0.0, 0.0)
        self.here: Point = (0.0, 0.0)

    def move(self, to: Point) -> None:
        self.close()
        self.start = self.here = to

    def draw(self, points: Sequence[Point], weights: Sequence[float] | None = None) -> None:
        """An edge from here through the other control points; one of no length is left out."""
        if any(p != self.here for p in points):
            self.loop.append(bezier([self.here, *points], weights))
        self.here = points[-1]

    def close(self) -> None:
        if self.here != self.start:
            # an end that misses the start by rounding of relative numbers is the start
            size = max((abs(c) for e in self.loop for p in e["control_points"] for c in p), default=1.0)
            if self.loop and math.dist(self.here, self.start) < 1e-9 * size:
                self.loop[-1]["control_points"][-1] = list(self.start)
            else:
                self.loop.append(line(self.here, self.start))
        if len(self.loop) > 1 or (self.loop and self.loop[0]["degree"] > 2):
            self.loops.append(self.loop)
        self.loop, self.here = [], self.start


def path(data: str) -> list[Loop]:
    """The closed loops of path data."""
    pen = _Pen()
    before, handle = "", (0.0, 0.0)
    for name, given in commands(data):
        upper, (x, y) = name.upper(), pen.here
        dx, dy = (x, y) if name.islower() else (0.0, 0.0)
        numbers = given
        if upper in "MLCSQT":
            numbers = [v + (dx, dy)[i % 2] for i, v in enumerate(given)]
        pairs = list(zip(numbers[::2], numbers[1::2], strict=False))
        mirrored = (2 * x - handle[0], 2 * y - handle[1])
        if upper == "M":
            pen.move(pairs[0])
        elif upper == "Z":
            pen.close()
        elif upper == "H":
            pen.draw([(given[0] + dx, y)])
        elif upper == "V":
            pen.draw([(x, given[0] + dy)])
        elif upper == "A":
            to = (given[5] + dx, given[6] + dy)
            for points, weights in arcs((x, y), given[0], given[1], given[2], bool(given[3]), bool(given[4]), to):
                pen.draw(points, weights)
        else:
            if upper == "S":
                pairs = [mirrored if before in ("C", "S") else (x, y), *pairs]
            elif upper == "T":
                pairs = [mirrored if before in ("Q", "T") else (x, y), *pairs]
            pen.draw(pairs)
            handle = pairs[-2] if len(pairs) > 1 else pairs[-1]
        before = upper
    pen.close()
    return pen.loops


def arcs(
    a: Point, rx: float, ry: float, degrees: float, large: bool, sweep: bool, b: Point
) -> Iterator[tuple[list[Point], list[float] | None]]:
    """The elliptical arc of SVG from a to b as (points after the first, weights), by the rules of its appendix B.2."""
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

    def at(angle: float, stretch: float = 1.0) -> Point:
        x, y = stretch * rx * math.cos(angle), stretch * ry * math.sin(angle)
        return mx + c * x - s * y, my + s * x + c * y

    count = max(1, math.ceil(abs(turn) / (math.pi / 2) - 1e-9))
    half = turn / count / 2
    for i in range(count):
        end = b if i == count - 1 else at(start + (2 * i + 2) * half)
        yield [at(start + (2 * i + 1) * half, 1 / math.cos(half)), end], [1.0, math.cos(half), 1.0]


def basic_shape(tag: str, attributes: Mapping[str, str]) -> str | None:
    """The path data of rect, circle, ellipse and polygon; None for other tags and for percentages and the like."""

    def value(name: str, default: float = 0.0) -> float:
        return float(attributes.get(name, default))

    try:
        if tag == "path":
            return attributes.get("d", "")
        if tag == "polygon":
            return f"M{attributes.get('points', '')}Z"
        if tag in ("circle", "ellipse"):
            rx, ry = (value("r"), value("r")) if tag == "circle" else (value("rx"), value("ry"))
            x, y = value("cx"), value("cy")
            return f"M{x - rx} {y}A{rx} {ry} 0 0 1 {x + rx} {y}A{rx} {ry} 0 0 1 {x - rx} {y}Z"
        if tag == "rect":
            return _rect(value("x"), value("y"), value("width"), value("height"), attributes)
    except ValueError:
        return None
    return None


def _rect(x: float, y: float, w: float, h: float, attributes: Mapping[str, str]) -> str:
    rx = float(attributes.get("rx", attributes.get("ry", 0)))
    ry = float(attributes.get("ry", rx))
    rx, ry = min(rx, w / 2), min(ry, h / 2)
    if not rx or not ry:
        return f"M{x} {y}H{x + w}V{y + h}H{x}Z"
    a = f"A{rx} {ry} 0 0 1"
    return (
        f"M{x + rx} {y}H{x + w - rx}{a} {x + w} {y + ry}V{y + h - ry}{a} {x + w - rx} {y + h}"
        f"H{x + rx}{a} {x} {y + h - ry}V{y + ry}{a} {x + rx} {y}Z"
    )
