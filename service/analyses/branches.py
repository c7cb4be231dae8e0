"""The documents of what is chosen from an axis: a pruned axis, the longest path."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import ConfigDict, Field, FiniteFloat

from service.analyses.common import LARGEST, AnalysisAnswer, AnalysisRequest, Length, Range
from service.schemas import Answer, Count, Footpoint, GraphEdge, Point, Request, Segment


class PruneArguments(Request):
    """What to cut; at least one rule."""

    model_config = ConfigDict(strict=True, extra="forbid", json_schema_extra={"minProperties": 1})

    angle: Annotated[
        float, Field(ge=0, le=math.pi, description="radians: from the tips to the first disc whose contacts stand this far apart")
    ] | None = None
    length: Annotated[FiniteFloat, Field(ge=0, le=LARGEST, description="whole branches that are shorter")] | None = None
    radius_ratio: Annotated[
        FiniteFloat,
        Field(ge=1, le=LARGEST, description="whole branches whose length and tip are below this times the radius at their root"),
    ] | None = None
    scale: Annotated[
        FiniteFloat, Field(ge=1, le=LARGEST, description="of the scale axis: discs that others cover when all are grown by it")
    ] | None = None


class PruneRequest(AnalysisRequest):
    """A domain whose axis is to be pruned."""

    model_config = ConfigDict(strict=True, extra="forbid", title="PruneRequest")

    arguments: PruneArguments


class PrunedNode(Answer):
    """A node of a pruned axis, and the node of the axis that it was."""

    id: Count
    node: Annotated[Count | None, Field(description="null where a segment was cut inside")]
    kind: Literal["convex_vertex", "curvature_center", "arc_center", "branch", "cut", "through", "point"]
    point: Point
    radius: Length
    footpoints: list[Footpoint]


class PrunedSegment(Segment):
    """What is kept of a segment, as a curve of its own."""

    segment: Annotated[Count, Field(description="the segment of the axis")]
    t: Annotated[Range, Field(description="what is kept of it")]


class PrunedGraph(Answer):
    """How the nodes and segments that are kept hang together; components and cycles are those of the axis."""

    nodes: list[PrunedNode]
    edges: list[GraphEdge]
    components: Count
    cycles: Count


class Place(Answer):
    """A stretch of a segment of the axis."""

    segment: Count
    t: Range


class Cut(Answer):
    """A branch, or the outer part of one, that was cut off."""

    reason: Annotated[Literal["scale", "angle", "radius_ratio", "length"], Field(description="the rule")]
    places: Annotated[list[Place], Field(description="from the tip inwards")]
    length: Length
    radius_ratio: Annotated[FiniteFloat, Field(ge=0, description="length and tip over the radius where it was cut off")]


class PruneResult(Answer):
    """What is kept of the axis, and what was cut off."""

    segments: list[PrunedSegment]
    graph: PrunedGraph
    cuts: list[Cut]


class PruneAnswer(AnalysisAnswer):
    """A pruned axis."""

    operation: Literal["prune"]
    result: PruneResult


class CenterlineArguments(Request):
    """How far the path goes."""

    extend: Annotated[
        bool | None, Field(description="prolong ends at centres of curvature and of arcs straight on to the boundary")
    ] = None


class CenterlineRequest(AnalysisRequest):
    """A domain whose longest path is asked for."""

    model_config = ConfigDict(strict=True, extra="forbid", title="CenterlineRequest")

    arguments: CenterlineArguments | None = None


class Step(Answer):
    """A segment on the way, and whether it is travelled with its t."""

    segment: Count
    forward: bool


class Extension(Answer):
    """A straight prolongation from a leaf to the boundary."""

    node: Count
    start: Point
    end: Point
    length: Length


class CenterlineResult(Answer):
    """The longest path along the axis; with cycles, the longest of the shortest paths between nodes."""

    path: list[Step]
    nodes: list[Count]
    length: Annotated[FiniteFloat, Field(ge=0, description="with the extensions")]
    bound: Annotated[FiniteFloat, Field(ge=0, description="no such path is longer, extensions left aside")]
    closed: bool
    before: Extension | None
    after: Extension | None


class CenterlineAnswer(AnalysisAnswer):
    """The longest path along the axis."""

    operation: Literal["centerline"]
    result: CenterlineResult
