"""Documents as bytes: rounded if asked, as JSON or msgpack, compressed if the client takes that.

Rounding. `precision` is the number of significant digits of the larger side of the domain: coordinates and radii go to one
decimal grid, whose step the answer names. So the same point is the same wherever it stands in the answer, ends that meet
still meet, and a domain far from the origin keeps its shape, which digits of each number by itself would not give. With
positive weights a curve moves by no more than its control points: half a step in x and in y. All else is left as it is:
knots and other parameters, weights, angles, lengths, areas, bounds of errors, and the certificate, which speaks of the
axis before it was rounded.
"""

from __future__ import annotations

import math
from typing import Any

import msgpack
import numpy as np
import orjson
from numpy.typing import NDArray

from service.http.compression import LEAST_BYTES, compress
from service.workers.safe_json import loads

ROUNDED = frozenset(
    ("bbox", "control_points", "control_values", "coordinates", "end", "point", "points", "radii", "radius", "start")
)
"""Members that hold coordinates or radii, as a number or as lists of them, wherever they stand in `PARTS`."""

PARTS = ("segments", "graph", "result", "bbox", "features")
"""Members of an answer that are rounded; not what was asked, nor the certificate and the figures of the domain."""

LEAVES = frozenset(("loop", "edge", "u", "angle"))
"""Members of the footpoints of samples, which are most of a large answer: nothing in them is rounded."""

LARGEST_EXPONENT = 300  # of the grid, so that no product with it overflows


def text(document: Any) -> bytes:
    """The document as JSON."""
    return orjson.dumps(document, option=orjson.OPT_SERIALIZE_NUMPY)


def encode(document: bytes, form: str, digits: int | None, size: float) -> bytes:
    """The document as it leaves.

    Parameters
    ----------
    document : bytes
        As JSON.
    form : str
        msgpack, or one of the kinds of JSON.
    digits : int or None
        Significant digits of coordinates; None: all that there are.
    size : float
        The larger side of the domain, which the digits refer to.
    """
    if digits is None and form != "msgpack":
        return document
    plain = loads(document)
    if digits is not None:
        plain = rounded(plain, digits, size)
    return msgpack.packb(plain) if form == "msgpack" else text(plain)


def rounded(document: dict[str, Any], digits: int, size: float) -> dict[str, Any]:
    """The document with its coordinates and radii on a decimal grid, which it names as ``rounding``."""
    decimals = digits - 1 - (math.floor(math.log10(size)) if size > 0 else 0)
    decimals = max(-LARGEST_EXPONENT, min(decimals, LARGEST_EXPONENT))
    parts = {name: _walk(part, decimals, name in ROUNDED) for name, part in document.items() if name in PARTS}
    return {**document, **parts, "rounding": {"digits": digits, "step": float(f"1e{-decimals}")}}


def _walk(node: Any, decimals: int, inside: bool) -> Any:
    """A part of a document; `inside` a member that holds coordinates, numbers are rounded."""
    if isinstance(node, dict):
        return {name: _walk(value, decimals, name in ROUNDED) for name, value in node.items()}
    if isinstance(node, list):
        if inside and (block := _block(node)) is not None:
            rounded: list[Any] = _round(block, decimals).tolist()
            return rounded
        if node and all(type(value) is dict for value in node) and LEAVES.issuperset(set().union(*node)):
            return node
        return [_walk(value, decimals, inside) for value in node]
    if inside and isinstance(node, float):
        return float(_round(np.float64(node), decimals))
    return node


def _block(node: list[Any]) -> NDArray[np.float64] | None:
    """A list of numbers, or of rows of them, all the way through as an array; None for any other."""
    try:
        block = np.asarray(node, dtype=np.float64)
    except (TypeError, ValueError):
        return None
    return block if np.isfinite(block).all() else None  # null became NaN


def _round(values: Any, decimals: int) -> Any:
    """The nearest numbers of `decimals` decimals; those too large for the grid have no digits behind it anyway."""
    with np.errstate(over="ignore", invalid="ignore"):
        near = np.round(values, decimals) + 0.0  # no negative zero
    return np.where(np.isfinite(near), near, values)


def compressed(content: bytes) -> tuple[bytes, bool]:
    """The content compressed where that pays, and whether it is."""
    if len(content) < LEAST_BYTES:
        return content, False
    return compress(content), True
