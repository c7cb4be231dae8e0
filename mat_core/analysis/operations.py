"""The table of operations on an axis: by name, with the rules of their arguments; what the service routes are made from.

An entry is all that a new operation needs here. Arguments go to the function by their own names.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from mat_core.analysis.arguments import Argument, number, point_list, truth_value
from mat_core.analysis.centerline import centerline
from mat_core.analysis.inscribed import inscribed_discs
from mat_core.analysis.nearest import nearest
from mat_core.analysis.offsetting.offset import TOLERANCE_RANGE, offset
from mat_core.analysis.pruning.prune import prune
from mat_core.analysis.rebuilding.reconstruct import reconstruct
from mat_core.analysis.width import width
from mat_core.model.curve import RationalBSpline


class Result(Protocol):
    """What an operation gives."""

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        ...


class Drawn(Protocol):
    """A result with curves."""

    @property
    def paths(self) -> list[list[RationalBSpline]]:
        """Head to tail along each path."""
        ...


@dataclass(frozen=True, slots=True)
class Operation:
    """An operation on an axis.

    Attributes
    ----------
    name : str
        Its address in the service, below /v1.
    call : callable
        The function: an axis and keyword arguments in, a `Result` out.
    arguments : mapping
        The rules of its arguments by name.
    paths : callable or None
        The curves in a result, head to tail along each path, where it can be drawn.
    encloses : bool
        Whether these paths bound regions.
    at_least_one : bool
        Whether some argument must be given, whichever.
    """

    name: str
    call: Callable[..., Result]
    arguments: Mapping[str, Argument] = field(default_factory=dict)
    paths: Callable[[Any], list[list[RationalBSpline]]] | None = None
    encloses: bool = False
    at_least_one: bool = False


def _paths(result: Drawn) -> list[list[RationalBSpline]]:
    return result.paths


OPERATIONS = {
    operation.name: operation
    for operation in (
        Operation(
            "offset",
            offset,
            {
                "distance": number(other_than=0.0, required=True, unit="a length in the caller's unit, inward if positive"),
                "tolerance": number(*TOLERANCE_RANGE),
            },
            _paths,
            encloses=True,
        ),
        Operation("inscribed-disc", inscribed_discs, {"prominence": number(0.0)}),
        Operation("width", width, {"limit": number(0.0), "angle": number(0.0, math.pi, unit="radians")}),
        Operation(
            "prune",
            prune,
            {
                "angle": number(0.0, math.pi, unit="radians"),
                "length": number(0.0),
                "radius_ratio": number(1.0),
                "scale": number(1.0),
            },
            _paths,
            at_least_one=True,
        ),
        Operation("reconstruct", reconstruct, paths=_paths, encloses=True),
        Operation("centerline", centerline, {"extend": truth_value()}, _paths),
        Operation("nearest", nearest, {"points": point_list()}),
    )
}
