"""Problems, as a person reads them: each on a line, with its place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from service.cli.exits import FAILED, OF_CODE, Failure

MOST = 20
"""Problems that are listed; the rest is counted."""


def refusal(name: str, error: Mapping[str, Any]) -> Failure:
    """The end of a command whose input was refused, or whose answer was withheld.

    Parameters
    ----------
    name : str
        What to call the input.
    error : mapping
        code, detail and extra of a `service.errors.RequestError`.
    """
    code, problems = error["code"], error["extra"].get("problems", [])
    lines = [f"{name}: {error['detail']} [{code}]"] if not problems else heading(name, code, problems)
    return Failure(OF_CODE.get(code, FAILED), "\n".join(lines + listed(problems)))


def heading(name: str, code: str, problems: Sequence[object]) -> list[str]:
    """The line above a list of problems."""
    if code == "not-certified":
        return [f"{name}: the axis failed its certificate and is withheld; please report the input [not-certified]"]
    count = f"{len(problems)} problems" if len(problems) != 1 else "1 problem"
    return [f"{name}: {count} [{code}]"]


def listed(problems: Sequence[Mapping[str, Any]]) -> list[str]:
    """A line for each problem: where in the document, where in the plane, what."""
    lines = []
    for problem in problems[:MOST]:
        place = f" at ({problem['x']:.9g}, {problem['y']:.9g})" if "x" in problem else ""
        pointer = f"{problem['pointer']}{place}: " if problem["pointer"] or place else ""
        lines.append(f"  {pointer}{problem['message']} [{problem['code']}]")
    if len(problems) > MOST:
        lines.append(f"  and {len(problems) - MOST} more")
    return lines
