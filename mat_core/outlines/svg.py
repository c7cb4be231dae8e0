"""Domains from what an SVG file fills: paths and basic shapes, with their transformations and fill rules.

Coordinates are those of the outermost user space, y down, unless they are flipped. What is only stroked, text, images and masks
bound nothing here and are left out, with a word each.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import NamedTuple
from xml.etree import ElementTree

from mat_core.errors import UnreadableInput
from mat_core.outlines.nesting import Outlines, Rule, nested
from mat_core.outlines.pen import Affine
from mat_core.outlines.svg_path import path_loops

UNDRAWN = frozenset({"defs", "clipPath", "mask", "symbol", "pattern", "marker", "linearGradient", "radialGradient"})
"""Elements whose children are drawn only where something refers to them."""

CONTAINERS = frozenset({"svg", "g", "a", "switch"})
SHAPES = frozenset({"path", "rect", "circle", "ellipse", "polygon", "polyline"})
SILENT = frozenset({"title", "desc", "metadata", "line", "style", "script", "view", "namedview"})
"""Elements that fill nothing, so that nothing is lost with them."""

FLIP = Affine(d=-1.0)
HREF = "{http://www.w3.org/1999/xlink}href"
DEEPEST = 100
"""References into references that are followed; a loop of them would never end."""

MOST_REFERENCES = 100_000
"""References that are followed at all: few lines of references to references can stand for billions of shapes."""

_TRANSFORM = re.compile(r"\s*(matrix|translate|scale|rotate|skewX|skewY)\s*\(([^)]*)\)[\s,]*")
_LENGTH = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(?:px)?\s*")


class _Style(NamedTuple):
    """What an element hands on to its children."""

    fill: str = "black"
    rule: str = "nonzero"
    stroke: str = "none"
    affine: Affine = Affine()


def from_svg(text: str | bytes, *, flip: bool = False) -> Outlines:
    """The domains that an SVG document fills.

    Parameters
    ----------
    text : str or bytes
        The document.
    flip : bool
        Turn the y axis up, as drawings and maps have it.

    Returns
    -------
    Outlines
        Domains named by the ``id`` of their element, or by its kind and number, `name#i` where it has several parts. An element
        is by itself: where two overlap, so do their domains.

    Raises
    ------
    UnreadableInput
        It is not XML, or not SVG; a path, a transformation or a length follows no grammar; or references or groups multiply
        without an end.
    """
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise UnreadableInput(f"not XML that can be read: {error}") from error
    if _tag(root) != "svg":
        raise UnreadableInput(f"the document is <{_tag(root)}>, not <svg>")
    reader = _Reader(root)
    try:
        reader.walk(root, _Style(affine=FLIP if flip else Affine()), 0)
    except RecursionError as error:
        raise UnreadableInput("groups within groups are too deep to be followed") from error
    return reader.found


class _Reader:
    """Walks the elements, and collects domains."""

    def __init__(self, root: ElementTree.Element) -> None:
        self.found = Outlines()
        self._named = {e.get("id"): e for e in root.iter() if e.get("id")}
        self._count = 0
        self._references = 0
        if any(_tag(e) == "style" and (e.text or "").strip() for e in root.iter()):
            self.found.left_out.append("style sheets are not read: fills are those of attributes")

    def walk(self, element: ElementTree.Element, style: _Style, depth: int) -> None:
        """Everything that an element fills."""
        tag = _tag(element)
        if tag in UNDRAWN or tag in SILENT or _property(element, "display") == "none":
            return
        name = element.get("id") or f"{tag} {self._count + 1}"
        try:
            style = _inherited(element, style)
            if tag in SHAPES:
                self._count += 1
                self._shape(tag, element, style, name)
                return
        except UnreadableInput as error:
            raise UnreadableInput(f"{name}: {error}") from error
        if tag in CONTAINERS:
            for child in element:
                self.walk(child, style, depth)
        elif tag == "use":
            self._use(element, style, depth, name)
        elif tag:
            self.found.left_out.append(f"{name}: <{tag}> has no outline")

    def _use(self, element: ElementTree.Element, style: _Style, depth: int, name: str) -> None:
        """What a reference draws."""
        target = self._named.get((element.get("href") or element.get(HREF) or "").removeprefix("#"))
        if target is None or depth >= DEEPEST:
            why = "refers to nothing in this file" if target is None else "refers to itself"
            self.found.left_out.append(f"{name}: <use> {why}")
            return
        self._references += 1
        if self._references > MOST_REFERENCES:
            raise UnreadableInput(f"{name}: more than {MOST_REFERENCES} references are drawn")
        inner = style._replace(affine=style.affine.after(Affine(e=_length(element, "x"), f=_length(element, "y"))))
        for child in target if _tag(target) == "symbol" else [target]:
            self.walk(child, inner, depth + 1)

    def _shape(self, tag: str, element: ElementTree.Element, style: _Style, name: str) -> None:
        """A path or basic shape."""
        if style.fill == "none":
            if style.stroke != "none":
                self.found.left_out.append(f"{name}: stroked, not filled; turn the stroke into a path first")
            return
        rule: Rule = "evenodd" if style.rule == "evenodd" else "nonzero"
        self.found.add(name, nested(path_loops(path_data(tag, element.attrib), style.affine), rule))


def path_data(tag: str, attributes: Mapping[str, str]) -> str:
    """The path data of a path or basic shape, by section 10 of SVG 2; empty where nothing is drawn."""
    if tag == "path":
        return attributes.get("d", "")
    if tag in ("polygon", "polyline"):
        points = attributes.get("points", "")
        return f"M{points}Z" if points.strip() else ""
    if tag == "rect":
        return _rect(attributes)
    rx, ry = (_length(attributes, "r"),) * 2 if tag == "circle" else (_length(attributes, "rx"), _length(attributes, "ry"))
    x, y = _length(attributes, "cx"), _length(attributes, "cy")
    if rx <= 0.0 or ry <= 0.0:
        return ""
    return f"M{x - rx} {y}A{rx} {ry} 0 0 1 {x + rx} {y}A{rx} {ry} 0 0 1 {x - rx} {y}Z"


def _rect(attributes: Mapping[str, str]) -> str:
    """A rectangle, its corners rounded where it says so."""
    x, y, w, h = (_length(attributes, key) for key in ("x", "y", "width", "height"))
    if w <= 0.0 or h <= 0.0:
        return ""
    given = {key for key in ("rx", "ry") if attributes.get(key, "auto").strip() != "auto"}
    rx = min(_length(attributes, "rx" if "rx" in given else "ry"), w / 2)
    ry = min(_length(attributes, "ry" if "ry" in given else "rx"), h / 2)
    if rx <= 0.0 or ry <= 0.0:
        return f"M{x} {y}H{x + w}V{y + h}H{x}Z"
    a = f"A{rx} {ry} 0 0 1"
    return (
        f"M{x + rx} {y}H{x + w - rx}{a} {x + w} {y + ry}V{y + h - ry}{a} {x + w - rx} {y + h}"
        f"H{x + rx}{a} {x} {y + h - ry}V{y + ry}{a} {x + rx} {y}Z"
    )


def transformation(text: str) -> Affine:
    """The map of an attribute ``transform``."""
    found, at = Affine(), 0
    while at < len(text.rstrip()):
        match = _TRANSFORM.match(text, at)
        if not match:
            raise UnreadableInput(f"transform: cannot read {text[at:]!r}")
        try:
            numbers = [float(n) for n in re.split(r"[\s,]+", match[2].strip())]
            found = found.after(_named_map(match[1], *numbers))
        except (ValueError, TypeError) as error:
            raise UnreadableInput(f"transform: cannot read {match[0].strip()!r}") from error
        at = match.end()
    return found


def _named_map(name: str, first: float, *others: float) -> Affine:
    """One map of a list of transformations."""
    if name == "matrix":
        b, c, d, e, f = others
        return Affine(first, b, c, d, e, f)
    if name == "translate":
        return Affine(e=first, f=others[0] if others else 0.0)
    if name == "scale":
        return Affine(a=first, d=others[0] if others else first)
    if name == "skewX":
        return Affine(c=math.tan(math.radians(first)))
    if name == "skewY":
        return Affine(b=math.tan(math.radians(first)))
    x, y = others or (0.0, 0.0)
    c, s = math.cos(math.radians(first)), math.sin(math.radians(first))
    return Affine(c, s, -s, c, x, y).after(Affine(e=-x, f=-y))


def _inherited(element: ElementTree.Element, style: _Style) -> _Style:
    """The style of an element within its parent's."""
    text = _property(element, "transform")
    return _Style(
        _property(element, "fill") or style.fill,
        _property(element, "fill-rule") or style.rule,
        _property(element, "stroke") or style.stroke,
        style.affine.after(transformation(text)) if text else style.affine,
    )


def _property(element: ElementTree.Element, name: str) -> str | None:
    """A property of an element: by its attribute ``style``, else by an attribute of its own."""
    for declaration in element.get("style", "").split(";"):
        key, _, value = declaration.partition(":")
        if key.strip() == name:
            return value.strip()
    return element.get(name)


def _length(attributes: Mapping[str, str] | ElementTree.Element, name: str) -> float:
    """A length in user units; 0 where there is none."""
    text = attributes.get(name)
    if text is None or text.strip() == "auto":
        return 0.0
    match = _LENGTH.fullmatch(text)
    if not match:
        raise UnreadableInput(f"{name}: {text!r} is not a number of user units")
    return float(match[1])


def _tag(element: ElementTree.Element) -> str:
    """The name of an element without its namespace; empty for comments."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""
