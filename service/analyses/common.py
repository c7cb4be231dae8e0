"""What the documents of all analyses share."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, FiniteFloat

from service.schemas import (
    Answer,
    Certificate,
    Count,
    DomainFigures,
    DomainRequest,
    Footpoint,
    Point,
    Request,
    Rounding,
    Versions,
)

LARGEST = 1e100
"""Of lengths and coordinates, as in `mat_core.analysis.arguments`."""

Length = Annotated[FiniteFloat, Field(ge=0, description="in the caller's unit")]
Range = Annotated[list[FiniteFloat], Field(min_length=2, max_length=2, description="first and last value")]
Coordinate = Annotated[FiniteFloat, Field(ge=-LARGEST, le=LARGEST)]


class AnalysisRequest(DomainRequest):
    """A domain and the arguments of an operation on its axis; `options` are those of the axis, `samples` has no effect."""


class AnalysisAnswer(Answer):
    """What every analysis answers around its result: what was asked, and the axis it was found from.

    Ids of segments and nodes are those of /v1/mat for the same domain and options.
    """

    operation: str
    arguments: Annotated[dict[str, Any], Field(description="those that were given, as they were understood")]
    certificate: Certificate
    domain: DomainFigures
    version: Versions
    rounding: Rounding | None = None


class NoArguments(Request):
    """There are none."""


class AxisDisc(Answer):
    """A maximal disc and where on the axis it sits: at a node, or at t of a segment."""

    point: Point
    radius: Length
    node: Count | None
    segment: Count | None
    t: FiniteFloat | None
    footpoints: list[Footpoint]
