"""What the service answers: one entry for each POST below /v1, with its documents and its formats.

The web process reads this table and never the library's own (`mat_core.analysis.operations`, for the workers); tests hold
the two to each other, and routes and OpenAPI document are made from it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel

from service import schemas
from service.analyses import boundaries, branches, measures
from service.http.negotiation import FORMATS, Format

UNDRAWN: tuple[Format, ...] = ("json", "msgpack")
DRAWN: tuple[Format, ...] = ("json", "svg", "dxf", "msgpack")


@dataclass(frozen=True, slots=True)
class Operation:
    """One route.

    Attributes
    ----------
    name : str
        Its address below /v1; the workers know it by the same name.
    summary, description : str
        For people, in the OpenAPI document.
    request, answer : type of pydantic.BaseModel
        The body, and the JSON that answers it.
    formats : tuple of str
        What it can be answered in, best first.
    example : str
        The committed example that is shown with the route; all of them where empty.
    arguments : dict
        Arguments that go with that example.
    """

    name: str
    summary: str
    description: str
    request: type[BaseModel]
    answer: type[BaseModel]
    formats: tuple[Format, ...] = UNDRAWN
    example: str = "plate"
    arguments: dict[str, Any] = field(default_factory=dict)


OPERATIONS = {
    operation.name: operation
    for operation in (
        Operation(
            "mat",
            "Solve a domain",
            "The certified medial axis transform of a planar domain bounded by rational B-splines.",
            schemas.DomainRequest,
            schemas.MatAnswer,
            tuple(FORMATS),
            example="",
        ),
        Operation(
            "offset",
            "Offset a domain",
            "Everything at a distance from the boundary: closed loops, trimmed by the axis; each region is a domain again.",
            boundaries.OffsetRequest,
            boundaries.OffsetAnswer,
            DRAWN,
            arguments={"distance": 0.25},
        ),
        Operation(
            "inscribed-disc",
            "The largest disc",
            "The largest disc inside the domain, and the largest in each of its parts, which are what necks separate.",
            measures.InscribedDiscRequest,
            measures.InscribedDiscAnswer,
        ),
        Operation(
            "width",
            "Wall thickness",
            "How thick the domain is along its axis: the thinnest wall, all necks, and the boundary on walls under a limit.",
            measures.WidthRequest,
            measures.WidthAnswer,
            arguments={"limit": 1.2},
        ),
        Operation(
            "nearest",
            "Nearest places of the axis",
            "For each of many points: the nearest place of the axis, its segment and t, and the maximal disc there.",
            measures.NearestRequest,
            measures.NearestAnswer,
            arguments={"points": [[1.0, 3.5], [4.5, 2.0]]},
        ),
        Operation(
            "centerline",
            "The longest path",
            "The longest path along the axis, its ends prolonged to the boundary if asked; with cycles, the longest of the"
            " shortest paths between nodes.",
            branches.CenterlineRequest,
            branches.CenterlineAnswer,
            DRAWN,
            arguments={"extend": True},
        ),
        Operation(
            "prune",
            "Prune the axis",
            "The axis without the branches that say little about the shape: by angle, length, radius ratio or the scale axis."
            " Components and cycles stay; what was cut is listed.",
            branches.PruneRequest,
            branches.PruneAnswer,
            DRAWN,
            arguments={"angle": 2.0},
        ),
        Operation(
            "reconstruct",
            "Rebuild the boundary",
            "The boundary as the envelope of the maximal discs, and its distance from the one that was given.",
            boundaries.ReconstructRequest,
            boundaries.ReconstructAnswer,
            DRAWN,
        ),
    )
}
