"""The documents of the analyses: a domain with arguments in, a result with what it was found from out.

As in `service.schemas` the models describe shapes; faults are found and told by the library, in the worker.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, FiniteFloat

from service.schemas import (
    Answer,
    Certificate,
    Count,
    DomainFigures,
    DomainRequest,
    Footpoint,
    GraphEdge,
    Loop,
    Point,
    Request,
    Segment,
    Versions,
)

LARGEST = 1e100
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


# offset --------------------------------------------------------------------------------------------------------------


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


# inscribed-disc ------------------------------------------------------------------------------------------------------


class InscribedDiscArguments(Request):
    """Which parts count."""

    prominence: Annotated[
        FiniteFloat, Field(ge=0, le=LARGEST, description="by how much a part's disc must be wider than its neck, in radius")
    ] | None = None


class InscribedDiscRequest(AnalysisRequest):
    """A domain whose largest discs are asked for."""

    model_config = ConfigDict(strict=True, extra="forbid", title="InscribedDiscRequest")

    arguments: InscribedDiscArguments | None = None


class Part(Answer):
    """A part of the domain by its largest disc, and the neck that leads to a larger one."""

    disc: AxisDisc
    neck: AxisDisc | None
    prominence: Length


class InscribedDiscResult(Answer):
    """The parts of the domain; the first one has the largest disc of all."""

    parts: Annotated[list[Part], Field(min_length=1)]


class InscribedDiscAnswer(AnalysisAnswer):
    """The largest disc, and the largest of each part."""

    operation: Literal["inscribed-disc"]
    result: InscribedDiscResult


# width ---------------------------------------------------------------------------------------------------------------


class WidthArguments(Request):
    """What counts as a wall, and which walls are thin."""

    limit: Annotated[
        FiniteFloat, Field(ge=0, le=LARGEST, description="thickness; boundary on thinner walls is listed in thin")
    ] | None = None
    angle: Annotated[
        float, Field(ge=0, le=math.pi, description="radians; a disc is wall where two contacts stand as far apart")
    ] | None = None


class WidthRequest(AnalysisRequest):
    """A domain whose thickness is asked for."""

    model_config = ConfigDict(strict=True, extra="forbid", title="WidthRequest")

    arguments: WidthArguments | None = None


class Thickness(Answer):
    """The thickness at one place."""

    thickness: Length
    kind: Literal["neck", "taper"]
    disc: AxisDisc


class Wall(Answer):
    """A stretch of a segment whose discs are wall."""

    segment: Count
    t: Range
    least: Length
    largest: Length


class BoundaryInterval(Answer):
    """A stretch of an edge of the domain, u in its own knots; a reflex vertex that is touched alone has no length."""

    loop: Count
    edge: Count
    u: Range


class WidthResult(Answer):
    """The thinnest wall (null if there is none), local minima, all walls, and with a limit the boundary on thinner ones."""

    minimum: Thickness | None
    necks: list[Thickness]
    walls: list[Wall]
    thin: Annotated[list[BoundaryInterval] | None, Field(description="null without a limit")]
    angle: FiniteFloat
    limit: FiniteFloat | None


class WidthAnswer(AnalysisAnswer):
    """How thick the domain is along its axis."""

    operation: Literal["width"]
    result: WidthResult


# nearest -------------------------------------------------------------------------------------------------------------


class NearestArguments(Request):
    """Whose nearest places are asked for."""

    points: Annotated[
        list[Annotated[list[Coordinate], Field(min_length=2, max_length=2)]],
        Field(min_length=1, max_length=100_000, description="[x, y] each, anywhere"),
    ]


class NearestRequest(AnalysisRequest):
    """A domain and points in the plane."""

    model_config = ConfigDict(strict=True, extra="forbid", title="NearestRequest")

    arguments: NearestArguments


class NearestResult(Answer):
    """One entry a point: the nearest place of the axis, and its maximal disc."""

    segment: Annotated[list[Count | None], Field(description="null where the axis is a single point")]
    t: list[FiniteFloat]
    node: Annotated[list[Count | None], Field(description="where the place is a node")]
    distance: Annotated[list[Length], Field(description="from the point to the place")]
    points: Annotated[list[Point], Field(description="the places: centres of discs")]
    radii: list[Length]
    inside: Annotated[list[bool], Field(description="whether the point lies in the domain")]


class NearestAnswer(AnalysisAnswer):
    """The nearest places of the axis to points."""

    operation: Literal["nearest"]
    result: NearestResult


# centerline ----------------------------------------------------------------------------------------------------------


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


# prune ---------------------------------------------------------------------------------------------------------------


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


# reconstruct ---------------------------------------------------------------------------------------------------------


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
