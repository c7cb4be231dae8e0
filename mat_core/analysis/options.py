"""What the functions ask of their arguments alike."""

from __future__ import annotations

from mat_core.errors import UnsupportedOption
from mat_core.model.values import as_number, describe


def real(option: str, value: object) -> float:
    """The value of an option as a float, an integer beyond all floats as infinity.

    Raises
    ------
    UnsupportedOption
        It is no real number; a truth value or a text is none.
    """
    found = as_number(value)
    if found is None:
        raise UnsupportedOption(option, f"{describe(value)} is not a number")
    return found
