"""The documents of what gives boundaries: offsets, and the boundary rebuilt."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, FiniteFloat

from service.analyses.common import LARGEST, AnalysisAnswer, AnalysisRequest, Length, NoArguments
from service.schemas import Answer, Count, Loop, Request


class OffsetArguments(Request):
    """How far."""

    distance: Annotated[
        FiniteFloat,
        Field(ge=-LARGEST, le=LARGEST, json_schema_extra={"not": {"const": 0}},
              description="in the caller's unit, positive inward, negative outward, not 0"),
    ]  # fmt: skip
    tolerance: Annotated[
        float, Field(ge=1e-13, le=0.1, description="of fitted edges, relative; that of the axis if left out")
    ] | None = None


class OffsetRequest(AnalysisRequest):
    """A domain to be offset."""

    model_config = ConfigDict(strict=True, extra="forbid", title="OffsetRequest")

    arguments: OffsetArguments


class Source(Answer):
    """What an edge of an offset is parallel to: a stretch of an edge of the domain, or a vertex with a range of normals."""

    loop: Count
    edge: Count
    u0: FiniteFloat
    u1: FiniteFloat
    angles: list[FiniteFloat] | None = None


class OffsetEdge(Answer):
    """What is known of an edge of a region."""

    kind: Literal["line", "arc", "spline"]
    source: Source
    max_error: Length


class OffsetEdges(Answer):
    """The edges of a region, in the order of its loops."""

    outer: list[OffsetEdge]
    holes: list[list[OffsetEdge]]


class Region(Answer):
    """A domain: one outer loop, counter-clockwise, and its holes, clockwise."""

    outer: Loop
    holes: list[Loop]


class OffsetResult(Answer):
    """Regions at a distance from the boundary; none where no point is so far from it."""

    distance: FiniteFloat
    area: Length
    perimeter: Length
    max_error: Length
    regions: list[Region]
    edges: list[OffsetEdges]


class OffsetAnswer(AnalysisAnswer):
    """The offset of a domain."""

    operation: Literal["offset"]
    result: OffsetResult


class ReconstructRequest(AnalysisRequest):
    """A domain whose boundary is to be rebuilt from its axis."""

    model_config = ConfigDict(strict=True, extra="forbid", title="ReconstructRequest")

    arguments: NoArguments | None = None


class ReconstructResult(Region):
    """The boundary as the envelope of the maximal discs, and how far it is from the one that was given."""

    to_boundary: Annotated[FiniteFloat, Field(ge=0, description="largest distance of its points from the boundary given")]
    from_boundary: Annotated[FiniteFloat, Field(ge=0, description="largest distance of the boundary's points from it")]
    area: Length


class ReconstructAnswer(AnalysisAnswer):
    """The boundary, rebuilt from axis and radius alone."""

    operation: Literal["reconstruct"]
    result: ReconstructResult
