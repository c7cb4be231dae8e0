"""The options of a request: which there are, what they may be."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from mat_core.errors import Problem
from mat_core.model.values import as_number, describe, pointer_to, short


def read_options(value: object, problems: list[Problem]) -> dict[str, Any]:
    """The request's options: those given and sound.

    Parameters
    ----------
    value : object
        Member ``options`` of the document.
    problems : list of Problem
        Grows by one for each fault.

    Returns
    -------
    dict
        tolerance, step, smooth_angle (float), method (str), check_step (int), samples (bool); absent keys stay absent.
    """
    if not isinstance(value, Mapping):
        problems.append(Problem("invalid-request", "/options", f"options must be an object, not {describe(value)}"))
        return {}
    options: dict[str, Any] = {}
    for key, given in value.items():
        rule = OPTION_RULES.get(key) if isinstance(key, str) else None
        if rule is None:
            text = f"unknown option {short(key)}; known are {', '.join(OPTION_RULES)}"
            problems.append(Problem("invalid-request", pointer_to("/options", key), text))
        elif given is None and key in {"step", "check_step"}:
            continue
        elif rule.accepts(given):
            options[key] = float(given) if key in FLOAT_OPTIONS else given
        else:
            text = f"{key} must be {rule.asks}, not {describe(given)}"
            problems.append(Problem("invalid-request", f"/options/{key}", text))
    return options


class OptionRule(NamedTuple):
    """What an option may be: the test and its wording."""

    accepts: Callable[[Any], bool]
    asks: str


def _between(low: float, high: float) -> Callable[[Any], bool]:
    def accepts(value: Any) -> bool:
        number = as_number(value)
        return number is not None and low <= number <= high

    return accepts


SMALLEST_TOLERANCE = 1e-12  # relative: rounding of the arithmetic itself leaves about 1e-14
LARGEST_TOLERANCE = 0.1
SMALLEST_STEP = 1e-6  # relative: a million samples along one side
LARGEST_SMOOTH_ANGLE = 0.1  # radians: a sharper corner is meant
FLOAT_OPTIONS = frozenset({"tolerance", "step", "smooth_angle"})
OPTION_RULES = {
    "tolerance": OptionRule(
        _between(SMALLEST_TOLERANCE, LARGEST_TOLERANCE), f"a number from {SMALLEST_TOLERANCE} to {LARGEST_TOLERANCE}"
    ),
    "step": OptionRule(
        _between(SMALLEST_STEP, 1e300),
        f"a number from {SMALLEST_STEP} (relative to the larger side of the bounding box, like tolerance) or null",
    ),
    "method": OptionRule(lambda value: isinstance(value, str) and value in ("discs", "march"), '"discs" or "march"'),
    "check_step": OptionRule(
        lambda value: isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= 10**6,
        "a positive integer or null",
    ),
    "smooth_angle": OptionRule(_between(0.0, LARGEST_SMOOTH_ANGLE), f"an angle from 0 to {LARGEST_SMOOTH_ANGLE} radians"),
    "samples": OptionRule(lambda value: isinstance(value, bool), "true or false"),
}
