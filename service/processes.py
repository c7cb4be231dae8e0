"""The operations as OGC API - Processes describes them (part 1, core, version 1.0): documents, and nothing of their own.

A process is an entry of `service.operations`; its inputs are the members of that route's body, its one output is its answer.
Schemas refer to the OpenAPI document, where all of them stand. Links are paths, so that they hold behind any proxy.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, JsonValue

from service import __version__
from service.errors import RequestError
from service.http.negotiation import FORMATS
from service.operations import OPERATIONS, Operation
from service.schemas import Answer, Link, Request

SPECIFICATION = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf"
RELATIONS = "http://www.opengis.net/def/rel/ogc/1.0"

CONFORMS_TO = [f"{SPECIFICATION}/{name}" for name in ("core", "ogc-process-description", "json", "dismiss")]
"""The classes that are fulfilled. Not oas30: the OpenAPI document is of version 3.1. Not job-list: jobs
are listed, but not filtered. Not callback: nothing is called."""

CONTROL = ["sync-execute", "async-execute", "dismiss"]
OUTPUT = "result"

JSON = FORMATS["json"]
OPENAPI = "application/vnd.oai.openapi+json;version=3.1"


class LandingPage(Answer):
    """What there is."""

    title: str
    description: str
    links: list[Link]


class Conformance(Answer):
    """The classes of the standard that are fulfilled."""

    conformsTo: list[str]


class ProcessSummary(Answer):
    """One process."""

    id: str
    version: str
    title: str
    description: str
    jobControlOptions: list[Literal["sync-execute", "async-execute", "dismiss"]]
    outputTransmission: list[Literal["value", "reference"]]
    links: list[Link]


class ProcessList(Answer):
    """The processes that there are."""

    processes: list[ProcessSummary]
    links: list[Link]


class Described(Answer):
    """One input or output."""

    title: str
    description: str
    schema_: Annotated[dict[str, JsonValue], Field(alias="schema")]
    minOccurs: int = 1
    maxOccurs: int = 1


class Process(ProcessSummary):
    """One process with its inputs and its output."""

    inputs: dict[str, Described]
    outputs: dict[str, Described]


class OutputFormat(Request):
    """The format of an output."""

    mediaType: Literal[tuple(FORMATS.values())] | None = None  # type: ignore[valid-type]  # as the table has it


class Output(Request):
    """How an output is wanted."""

    format: OutputFormat | None = None
    transmissionMode: Literal["value"] = "value"


class Outputs(Request):
    """Which outputs are wanted."""

    result: Output | None = None


class ExecuteRequest(Request):
    """The inputs of a process, each as it is or as ``{"value": ...}``, and how the output is wanted."""

    model_config = ConfigDict(strict=True, extra="forbid", title="ExecuteRequest")

    inputs: Annotated[
        dict[str, JsonValue], Field(description="the members of the body below /v1: outer, holes, options, arguments")
    ]
    outputs: Outputs | None = None
    response: Annotated[
        Literal["raw", "document"], Field(description="the output as it is, or a document that holds it")
    ] = "raw"


def operation(name: str) -> Operation:
    """The operation of a process.

    Raises
    ------
    RequestError
        ``no-such-process``.
    """
    if name not in OPERATIONS:
        raise RequestError("no-such-process", f"There is none of this name; there are {', '.join(OPERATIONS)}.")
    return OPERATIONS[name]


def landing_page(root: str, title: str, description: str) -> LandingPage:
    """The page at the bare address.

    Parameters
    ----------
    root : str
        The path that the service is mounted at, empty as a rule.
    """
    links = [
        Link(href=f"{root}/", rel="self", type=JSON, title="this document"),
        Link(href=f"{root}/openapi.json", rel="service-desc", type=OPENAPI, title="the OpenAPI document"),
        Link(href=f"{root}/docs", rel="service-doc", type="text/html", title="the same as a page"),
        Link(href=f"{root}/conformance", rel=f"{RELATIONS}/conformance", type=JSON, title="conformance classes"),
        Link(href=f"{root}/processes", rel=f"{RELATIONS}/processes", type=JSON, title="processes"),
        Link(href=f"{root}/jobs", rel=f"{RELATIONS}/job-list", type=JSON, title="jobs"),
    ]
    return LandingPage(title=title, description=description, links=links)


def process_list(root: str, limit: int, offset: int) -> ProcessList:
    """A page of the list of processes."""
    operations = list(OPERATIONS.values())[offset : offset + limit]
    links = [Link(href=f"{root}/processes?limit={limit}&offset={offset}", rel="self", type=JSON)]
    if offset + limit < len(OPERATIONS):
        links.append(Link(href=f"{root}/processes?limit={limit}&offset={offset + limit}", rel="next", type=JSON))
    return ProcessList(processes=[ProcessSummary(**_summary(root, each)) for each in operations], links=links)


def process(root: str, operation: Operation) -> Process:
    """The description of one process."""
    template = f"{root}/openapi.json#/components/schemas/{{model}}"
    fields = operation.request.model_json_schema(ref_template=template)
    inputs = {
        name: Described.model_validate(
            {
                "title": name,
                "description": schema.get("description", _INPUTS.get(name, name)),
                "schema": schema,
                "minOccurs": int(name in fields.get("required", [])),
            }
        )
        for name, schema in fields["properties"].items()
    }
    answer = {"$ref": template.format(model=operation.answer.__name__), "contentMediaType": JSON}
    drawn = [{"type": "string", "contentMediaType": FORMATS[form]} for form in operation.formats if form != "json"]
    schema = {"oneOf": [answer, *drawn]}
    output = {"title": operation.summary, "description": operation.description, "schema": schema}
    return Process(**_summary(root, operation), inputs=inputs, outputs={OUTPUT: Described.model_validate(output)})


_INPUTS = {
    "outer": "the outer loop",
    "holes": "the loops of the holes",
    "options": "how to solve",
    "arguments": "the arguments of the operation",
}


def _summary(root: str, operation: Operation) -> dict[str, Any]:
    here = f"{root}/processes/{operation.name}"
    return {
        "id": operation.name,
        "version": __version__,
        "title": operation.summary,
        "description": operation.description,
        "jobControlOptions": CONTROL,
        "outputTransmission": ["value"],
        "links": [
            Link(href=here, rel="self", type=JSON, title="the description of this process"),
            Link(href=f"{here}/execution", rel=f"{RELATIONS}/execute", type=JSON, title="POST an execute request here"),
        ],
    }


def text(document: BaseModel) -> bytes:
    """A document as JSON."""
    return document.model_dump_json(by_alias=True, exclude_none=True).encode()
