"""Values of a JSON document: what they are, and what to call them and their places."""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Real
from typing import Any

import numpy as np


def loop_name(loop: int) -> str:
    """A loop in words."""
    return "outer loop" if loop == 0 else f"hole {loop - 1}"


def loop_pointer(loop: int) -> str:
    """JSON pointer of a loop: /outer or /holes/i."""
    return "/outer" if loop == 0 else f"/holes/{loop - 1}"


def edge_pointer(loop: int, edge: int) -> str:
    """JSON pointer of an edge."""
    return f"{loop_pointer(loop)}/{edge}"


def as_list(value: object) -> list[Any] | None:
    """Lists, tuples and arrays as a list; None for anything else."""
    if isinstance(value, np.ndarray):
        return list(value) if value.ndim else None
    return list(value) if isinstance(value, list | tuple) else None


def as_number(value: object) -> float | None:
    """A number as float (an integer beyond all floats becomes infinite); None for anything else, booleans too."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf


def describe(value: object) -> str:
    """What a value is, in the words of JSON, short whatever its size."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float | str):
        return short(value)
    if isinstance(value, Mapping):
        return "an object"
    return "a list" if isinstance(value, list | tuple | np.ndarray) else f"a {type(value).__name__}"


def short(value: object) -> str:
    """The value's text, cut to a readable length."""
    if isinstance(value, int) and abs(value) > 10**30:
        return "an integer of more than 30 digits"
    if isinstance(value, str):
        return f'"{value}"' if len(value) <= 40 else f'"{value[:37]}..."'
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def pointer_to(at: str, key: object) -> str:
    """Pointer of a member, its name escaped as RFC 6901 asks and cut short."""
    return f"{at}/{str(key)[:60].replace('~', '~0').replace('/', '~1')}"
