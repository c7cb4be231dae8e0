"""The documents of what is measured: thickness, the largest discs, nearest places."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import ConfigDict, Field, FiniteFloat

from service.analyses.common import LARGEST, AnalysisAnswer, AnalysisRequest, AxisDisc, Coordinate, Length, Range
from service.schemas import Answer, Count, Point, Request


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
    thin_walls: Annotated[list[Wall] | None, Field(description="walls no thicker than the limit; null without one")]
    angle: FiniteFloat
    limit: FiniteFloat | None


class WidthAnswer(AnalysisAnswer):
    """How thick the domain is along its axis."""

    operation: Literal["width"]
    result: WidthResult


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
