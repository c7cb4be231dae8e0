"""The documents of the contract as strict models: what the OpenAPI document shows and the tests hold both sides to.

The models describe shapes. The rules of geometry, and the report of *all* faults at once with their places, are
``mat_core.Domain``'s; a body is judged there and only there, in the worker, so that no large body is ever read on the
event loop. Tests hold the two to each other: what a model refuses, the domain refuses.
"""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, JsonValue

Point = Annotated[list[FiniteFloat], Field(min_length=2, max_length=2, description="x, y in the caller's unit")]
Count = Annotated[int, Field(ge=0)]


class Request(BaseModel):
    """Part of a request: no coercion, no unknown members."""

    model_config = ConfigDict(strict=True, extra="forbid")


class Answer(BaseModel):
    """Part of an answer: no coercion; later versions may add members."""

    model_config = ConfigDict(strict=True, extra="allow")


class Edge(Request):
    """A clamped rational B-spline; its knots are non-decreasing and len(knots) = len(control_points) + degree + 1."""

    degree: Annotated[
        int, Field(ge=1, le=25, description="1: straight line; an arc of a circle is a rational quadratic")
    ]
    control_points: Annotated[list[Point], Field(min_length=2)]
    knots: Annotated[list[FiniteFloat] | None, Field(description="may be left out for a Bezier curve")] = None
    weights: Annotated[
        list[Annotated[float, Field(gt=0, allow_inf_nan=False)]] | None,
        Field(description="one for each control point, all positive; may be left out when all are 1"),
    ] = None


Loop = Annotated[
    list[Edge], Field(min_length=1, description="edges head to tail; the last one ends where the first one starts")
]


class Options(Request):
    """How to solve, and what to answer; lengths are fractions of the larger side of the bounding box."""

    tolerance: Annotated[float, Field(ge=1e-12, le=0.1, description="largest error of a fitted curve")] = 1e-6
    step: Annotated[
        float | None, Field(ge=1e-6, le=1e300, description="largest spacing of sample points; the tracing step of march")
    ] = None
    method: Annotated[
        Literal["discs", "march"],
        Field(description="discs: maximal discs first; march: the published procedure, which needs a convex vertex"),
    ] = "discs"
    check_step: Annotated[int, Field(ge=1, le=10**6, description="of march: steps between checks, default 10")] | None = None
    smooth_angle: Annotated[
        float, Field(ge=0, le=0.1, description="radians; a corner turning by less is taken as smooth")
    ] = 1e-6
    samples: Annotated[bool, Field(description="answer sample points with their footpoints, too")] = False


class DomainRequest(Request):
    """A domain in the plane: one outer loop, any number of holes, in either orientation."""

    model_config = ConfigDict(strict=True, extra="forbid", title="Domain")

    outer: Loop
    holes: Annotated[list[Loop] | None, Field(description="disjoint loops inside the outer one")] = None
    options: Options | None = None
    name: Annotated[str | None, Field(description="free text, ignored")] = None
    note: Annotated[JsonValue, Field(description="annotation of any kind, ignored")] = None
    truth: Annotated[JsonValue, Field(description="annotation of any kind, ignored; test benches keep answers here")] = None


class Footpoint(Answer):
    """Where a maximal disc touches the boundary, in the request's own loops, edges and parameters."""

    loop: Annotated[Count, Field(description="0 is the outer loop, i is holes[i - 1]")]
    edge: Count
    u: Annotated[FiniteFloat, Field(description="parameter on the edge's own knots")]
    point: Point | None = None
    angle: Annotated[
        FiniteFloat | None, Field(description="at a reflex vertex: direction from it to the centre, radians")
    ] = None


class AxisCurve(Answer):
    """The x, y of a segment as a rational B-spline in t."""

    degree: Annotated[int, Field(ge=1)]
    knots: list[FiniteFloat]
    control_points: list[Point]
    weights: list[FiniteFloat]


class RadiusFunction(Answer):
    """The radius of a segment as a rational B-spline in the same t."""

    degree: Annotated[int, Field(ge=1)]
    knots: list[FiniteFloat]
    control_values: list[FiniteFloat]
    weights: list[FiniteFloat]


class Samples(Answer):
    """Points along a segment; left and right are as seen in the direction of increasing t."""

    t: list[FiniteFloat]
    points: list[Point]
    radii: list[FiniteFloat]
    left: list[Footpoint]
    right: list[Footpoint]


class Piece(Answer):
    """A stretch of a segment between two boundary pieces."""

    t: Annotated[list[FiniteFloat], Field(min_length=2, max_length=2, description="where it begins and ends")]
    kind: Literal["line", "parabola", "hyperbola", "ellipse", "freeform"]


class Segment(Answer):
    """One curve of the axis between two nodes; a closed one without a node has start_node = end_node = null."""

    id: Count
    start_node: Count | None
    end_node: Count | None
    kind: Literal["line", "parabola", "hyperbola", "ellipse", "freeform"]
    axis: AxisCurve
    radius: RadiusFunction
    pieces: list[Piece]
    samples: Samples | None = None
    max_error: Annotated[FiniteFloat, Field(ge=0, description="bound of the error of centre and radius together, caller's unit")]


class Node(Answer):
    """Where segments end or meet, with its maximal disc."""

    id: Count
    kind: Literal["convex_vertex", "curvature_center", "arc_center", "branch", "point"]
    point: Point
    radius: Annotated[FiniteFloat, Field(ge=0)]
    footpoints: list[Footpoint]


class GraphEdge(Answer):
    """A segment as a directed edge of the graph."""

    segment: Count
    source: Count | None
    target: Count | None


class Graph(Answer):
    """How nodes and segments hang together; cycles = holes."""

    nodes: list[Node]
    edges: list[GraphEdge]
    topological_order: list[Count]
    components: Count
    cycles: Count


class Certificate(Answer):
    """The proof that goes with the answer: each check with its measured figure and its limit."""

    passed: Literal[True]
    smooth_angle: Annotated[
        FiniteFloat, Field(ge=0, description="joints that turn by less, in radians, were smooth; at most the option's value")
    ]


class DomainFigures(Answer):
    """The domain as it was understood."""

    bbox: Annotated[list[FiniteFloat], Field(min_length=4, max_length=4, description="x min, y min, x max, y max")]
    area: FiniteFloat
    loops: Annotated[int, Field(ge=1)]
    edges: Annotated[int, Field(ge=1)]


class Versions(Answer):
    """What produced the answer."""

    service: str
    algorithm: str


class Rounding(Answer):
    """The decimal grid of coordinates and radii, where a precision was asked for."""

    digits: Annotated[int, Field(ge=1, description="of the larger side of the domain")]
    step: Annotated[FiniteFloat, Field(gt=0, description="of the grid, in the caller's unit")]


class MatAnswer(Answer):
    """The medial axis transform of a domain."""

    segments: list[Segment]
    graph: Graph
    certificate: Certificate
    domain: DomainFigures
    version: Versions
    rounding: Rounding | None = None


class Problem(Answer):
    """One fault of a domain."""

    code: Annotated[str, Field(description="stable", examples=["self-intersection"])]
    pointer: Annotated[str, Field(description="JSON pointer into the request", examples=["/holes/0/3"])]
    message: Annotated[str, Field(description="what was found, where, and what to do")]
    loop: Annotated[Count | None, Field(description="0 is the outer loop, i is holes[i - 1]")] = None
    edge: Count | None = None
    u: Annotated[FiniteFloat | None, Field(description="parameter on that edge's own knots")] = None
    x: FiniteFloat | None = None
    y: FiniteFloat | None = None
    other: Annotated[str | None, Field(description="JSON pointer of the other party, where there are two")] = None


class ProblemDocument(Answer):
    """RFC 9457 problem details; every answer from 400 up is one."""

    type: Annotated[str, Field(description="stable URI of the code")]
    title: str
    status: Annotated[int, Field(ge=400, le=599)]
    detail: str
    code: str
    problems: Annotated[list[Problem], Field(description="all faults of the domain at once; empty for other codes")]
    request_id: str | None = None


class Status(Answer):
    """A word on how the service is."""

    status: str


class Link(Answer):
    """Where something is that belongs to a document."""

    href: str
    rel: str
    type: str
    title: str | None = None


class JobStatus(Answer):
    """How a job is, as OGC API - Processes describes it (statusInfo)."""

    jobID: str
    type: Literal["process"]
    processID: Annotated[str, Field(description="the operation")]
    status: Literal["accepted", "running", "successful", "failed", "dismissed"]
    message: str
    progress: Annotated[int, Field(ge=0, le=100)]
    created: datetime
    started: datetime | None = None
    updated: datetime
    finished: datetime | None = None
    links: list[Link]


class JobList(Answer):
    """Some jobs, newest first; a link with rel next where there are more."""

    jobs: list[JobStatus]
    next: Annotated[str | None, Field(description="token of the page that follows; absent on the last")] = None
    links: list[Link]
