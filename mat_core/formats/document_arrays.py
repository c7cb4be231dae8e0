"""Arrays from the lists of a document, which may hold anything."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.errors import UnreadableInput

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def numbers(values: object, pointer: str, width: int | None = None) -> Floats:
    """Finite numbers, in rows where a width is given."""
    try:
        found = np.asarray(values)
    except ValueError:  # rows of different lengths
        found = np.asarray(None)
    if found.size == 0:
        return np.empty((0, width) if width else 0)
    if found.dtype.kind not in "iuf" or not np.isfinite(found).all() or (width and found.shape[-1:] != (width,)):
        raise UnreadableInput(f"not an answer: {pointer}: finite numbers{f', {width} each' if width else ''}, are expected")
    return np.ascontiguousarray(found, dtype=float)


def whole(values: object, pointer: str) -> Ints:
    """Whole numbers."""
    found = np.asarray(values)
    if found.size and found.dtype.kind != "i":
        raise UnreadableInput(f"not an answer: {pointer}: whole numbers are expected")
    return np.ascontiguousarray(found, dtype=np.int64)


def joined(lists: Iterable[list[Any]]) -> list[Any]:
    """All lists as one."""
    return [value for values in lists for value in values]


def offsets(counts: list[int]) -> Ints:
    """Where each of so many rows begins, and where the last ends."""
    return np.concatenate((np.zeros(1, dtype=np.int64), np.cumsum(counts, dtype=np.int64)))
