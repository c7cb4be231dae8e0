"""The arguments of an operation as they come in a JSON document: which there are, what they may be.

What can be said of an argument by itself is said here, with all other faults of a document at once and with JSON pointers;
what depends on the axis is left to the functions, which raise `UnsupportedOption` and name the argument.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mat_core.errors import Problem
from mat_core.model.values import as_list, as_number, describe, pointer_to, short

CODE = "invalid-request"  # of `mat_core.model.problems.CODES`
AT = "/arguments"
LARGEST = 1e100  # of lengths and coordinates: their squares are still numbers
MOST_POINTS = 100_000

Refusal = tuple[str, str]
"""A pointer below the argument's own, and what must be there."""


@dataclass(frozen=True, slots=True)
class Argument:
    """One argument of an operation.

    Attributes
    ----------
    check : callable
        Gives the faults of a JSON value; none when it can be used.
    asks : str
        What the value must be, in words.
    required : bool
        Whether it must be given; else null stands for its absence.
    """

    check: Callable[[object], list[Refusal]]
    asks: str
    required: bool = False


def number(
    least: float = -LARGEST, most: float = LARGEST, *, above: float | None = None, other_than: float | None = None,
    required: bool = False, unit: str = "",
) -> Argument:  # fmt: skip
    """A finite number in a range; `above` and `other_than` leave a bound or a value out."""
    words = ["a number"]
    if above is not None:
        words.append(f"above {above:g}")
    elif least > -LARGEST:
        words.append(f"from {least:g}")
    if most < LARGEST:
        words.append(f"to {most:g}")
    if other_than is not None:
        words.append(f"other than {other_than:g}")
    asks = " ".join(words) + (f", {unit}" if unit else "")

    def check(value: object) -> list[Refusal]:
        given = as_number(value)
        sound = given is not None and least <= given <= most and given != other_than and (above is None or given > above)
        return [] if sound else [("", asks)]

    return Argument(check, asks, required)


def truth_value() -> Argument:
    """True or false."""
    return Argument(lambda value: [] if isinstance(value, bool) else [("", "true or false")], "true or false")


def point_list() -> Argument:
    """At least one point, each a pair of finite numbers."""
    asks = f"a list of 1 to {MOST_POINTS} points [x, y]"

    def check(value: object) -> list[Refusal]:
        listed = as_list(value)
        if not listed or len(listed) > MOST_POINTS:
            return [("", asks)]
        return [(f"/{i}", "a point [x, y] of two finite numbers") for i, point in enumerate(listed) if not _is_point(point)]

    return Argument(check, asks, required=True)


def _is_point(value: object) -> bool:
    pair = as_list(value)
    if pair is None or len(pair) != 2:
        return False
    return all((v := as_number(c)) is not None and math.isfinite(v) and abs(v) <= LARGEST for c in pair)


def read_arguments(
    rules: Mapping[str, Argument], value: object, problems: list[Problem], at_least_one: bool = False
) -> dict[str, Any]:
    """The arguments of a document: those given and sound.

    Parameters
    ----------
    rules : mapping
        The operation's arguments by name.
    value : object
        Member ``arguments`` of the document; None where there is none.
    problems : list of Problem
        Grows by one for each fault.
    at_least_one : bool
        Whether none at all is a fault.

    Returns
    -------
    dict
        Numbers as float, points as arrays (n, 2).
    """
    if value is not None and not isinstance(value, Mapping):
        problems.append(Problem(CODE, AT, f"arguments must be an object, not {describe(value)}"))
        return {}
    given = dict(value or {})
    if at_least_one and all(given.get(name) is None for name in rules):
        problems.append(Problem(CODE, AT, f"no argument is given; give at least one of {', '.join(rules)}"))
    for name in given:
        if not isinstance(name, str) or name not in rules:
            known = f"known are {', '.join(rules)}" if rules else "this operation takes none"
            problems.append(Problem(CODE, pointer_to(AT, name), f"unknown argument {short(name)}; {known}"))
    found: dict[str, Any] = {}
    for name, rule in rules.items():
        content = given.get(name)
        if content is None and not rule.required:
            continue
        if name not in given:
            problems.append(Problem(CODE, f"{AT}/{name}", f"{name} is missing: give {rule.asks}"))
            continue
        refusals = rule.check(content)
        for below, asks in refusals:
            text = f"{name} must be {asks}, not {describe(_inside(content, below))}"
            problems.append(Problem(CODE, f"{AT}/{name}{below}", text))
        if not refusals:
            found[name] = _usable(content)
    return found


def _inside(value: Any, below: str) -> object:
    """What stands at a pointer of one step or none."""
    return value[int(below[1:])] if below else value


def _usable(value: object) -> Any:
    """A JSON value in the form that functions take."""
    if isinstance(value, list | tuple):
        return np.array(value, dtype=np.float64)
    return value if isinstance(value, bool) else as_number(value)
