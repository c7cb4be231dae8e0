"""Room for large domains: memory that goes back to the operating system as soon as nothing needs it.

The C library's heap keeps what is freed below what is still in use, so the room of a stage, three times what it finds, would
stay in the process beside the next stage's. Hence arrays that are large come from the operating system each by itself, and the
heap, where then nothing lasts, is emptied as parts of a large domain begin to be worked on.
"""

from __future__ import annotations

import ctypes
import math
import mmap
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

MANY = 60_000
"""Rows from which on a table's arrays are worth it: fresh memory is slow at first touch, by a tenth of the time of a solution."""

LARGE = 1 << 20
"""Bytes of an array that is worth a mapping of its own: some 250 pages, of which on average half a one is wasted."""

Maker = Callable[..., NDArray[Any]]
_PRIVATE: dict[str, int] = {"flags": mmap.MAP_PRIVATE} if hasattr(mmap, "MAP_PRIVATE") else {}


def maker(rows: int) -> Maker:
    """What makes arrays (of a shape and a type, yet to be filled) for tables of about so many rows: `numpy.empty` or the like."""
    return np.empty if rows < MANY else _mapped


def joined(arrays: Sequence[NDArray[Any]], axis: int = 0) -> NDArray[Any]:
    """As `numpy.concatenate` of at least one array, of one type."""
    shape = list(arrays[0].shape)
    shape[axis] = sum(array.shape[axis] for array in arrays)
    return np.concatenate(arrays, axis=axis, out=maker(shape[axis])(tuple(shape), arrays[0].dtype))


def joined_one_by_one(columns: list[Sequence[NDArray[Any]]]) -> Iterator[NDArray[Any]]:
    """Each column's arrays as one. A column is let go of when it is copied: at no time is all there twice."""
    while columns:
        yield joined(columns.pop(0))
        give_back()


def _mapped(shape: int | tuple[int, ...], dtype: Any = np.float64) -> NDArray[Any]:
    """A large array in memory of its own; a small one as ever."""
    size = math.prod(shape if isinstance(shape, tuple) else (shape,)) * np.dtype(dtype).itemsize
    if size < LARGE:
        return np.empty(shape, dtype)
    array: NDArray[Any] = np.frombuffer(mmap.mmap(-1, size, **_PRIVATE), dtype).reshape(shape)
    return array


def _trim() -> Callable[[int], int] | None:
    """The C library's way to let go of free pages; only GNU's needs one and has one."""
    return getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None


_TRIM = _trim()


def give_back() -> None:
    """Return the free pages of the heap: about a millisecond for 100 MB."""
    if _TRIM is not None:
        _TRIM(0)
