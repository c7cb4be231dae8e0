"""The OpenAPI document: the web framework's own, with the bodies that it cannot see.

The routes of `service.operations` take their bodies as bytes (no large body is parsed on the event loop) and answer bytes
that a worker encoded, so their schemas are put in here, together with a problem document for every code of `service.errors`.
``make openapi`` writes the result to openapi/openapi.json.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from service.errors import ERRORS, MEDIA_TYPE, RequestError
from service.negotiation import FORMATS, Format
from service.operations import OPERATIONS, Operation
from service.schemas import ProblemDocument

EXAMPLES = Path(__file__).resolve().parents[1] / "openapi" / "examples"
"""Where a checkout and the image keep the examples; an installed wheel has none, and its document shows none."""

SUMMARY = "The certified medial axis transform of planar domains bounded by rational B-splines."

DESCRIPTION = """\
POST a domain (one outer loop, any number of holes, each loop a chain of rational B-splines) and get its medial axis
transform: segments with their radius functions, the graph, and a certificate that was checked before the answer left.
The same domain with `arguments` goes to the analyses: offsets, widths, inscribed discs and what else there is below /v1.

Every failure is a problem document (RFC 9457) with a stable `code`; an invalid domain is answered with all of its
problems at once, each with its place.
"""

NOT_OF_SOLVING = ("not-found", "method-not-allowed", "not-ready", "result-not-ready", "job-dismissed")
SOLVE_CODES = [code for code in ERRORS if code not in NOT_OF_SOLVING]
READY_CODES = ["queue-full", "not-ready", "store-unavailable"]
JOB_CODES = {
    "/v1/jobs": {"get": ["invalid-parameter", "store-unavailable"]},
    "/v1/jobs/{job_id}": {
        "get": ["invalid-parameter", "not-found", "store-unavailable"],
        "delete": ["invalid-parameter", "not-found", "store-unavailable"],
    },
    "/v1/jobs/{job_id}/results": {"get": [code for code in ERRORS if code not in ("method-not-allowed", "not-ready")]},
    "/v1/batches": {
        "post": [
            *("not-json", "invalid-parameter", "idempotency-key-in-flight", "body-too-large", "unsupported-media-type"),
            *("idempotency-key-reused", "store-unavailable"),
        ]
    },
}
"""What can go wrong with jobs; a failed job's results are its own problem, with its status."""

PREFER = {
    "name": "Prefer",
    "in": "header",
    "required": False,
    "description": "`respond-async`: a job, 201. `respond-async, wait=N`: the answer if it comes within N seconds, else the job."
    " `wait=N`: the answer within N seconds, or 503 deadline-exceeded. Anything else is passed over.",
    "schema": {"type": "string"},
    "example": "wait=10",
}

IDEMPOTENCY_KEY = {
    "name": "Idempotency-Key",
    "in": "header",
    "required": False,
    "description": "of a request for a job: when it is sent again with the same key, the same job is answered",
    "schema": {"type": "string", "minLength": 1, "maxLength": 255, "pattern": r"^[\x21-\x7e]([\x20-\x7e]*[\x21-\x7e])?$"},
}

LINES = "application/x-ndjson"

FORMAT_SCHEMAS: dict[Format, dict[str, str]] = {
    "json": {"type": "object"},
    "geojson": {"type": "object"},
    "svg": {"type": "string"},
    "dxf": {"type": "string"},
}
"""What the formats are as far as a schema can tell; JSON has one of its own for each route."""

EXAMPLE_PROBLEMS = [
    {
        "code": "self-intersection",
        "pointer": "/outer/0",
        "message": "edges 0 and 2 of the outer loop cross",
        "loop": 0,
        "edge": 0,
        "u": 0.5,
        "x": 0.0,
        "y": 0.0,
        "other": "/outer/2",
    }
]

Json = dict[str, Any]


def install(app: FastAPI) -> None:
    """Make `app` serve this document; it is built once, on first use."""

    def document() -> Json:
        if app.openapi_schema is None:
            app.openapi_schema = build(app)
        return app.openapi_schema

    app.openapi = document  # type: ignore[method-assign]  # the framework's documented way


def build(app: FastAPI) -> Json:
    """The document of `app`."""
    document = get_openapi(
        title=app.title, version=app.version, summary=SUMMARY, description=DESCRIPTION, routes=app.routes
    )
    models: list[tuple[type[BaseModel], str]] = [(ProblemDocument, "serialization")]
    for operation in OPERATIONS.values():
        models += [(operation.request, "validation"), (operation.answer, "serialization")]
    _, schemas = models_json_schema(models, ref_template="#/components/schemas/{model}")  # type: ignore[arg-type]
    components = document.setdefault("components", {}).setdefault("schemas", {})
    components.update(schemas["$defs"])
    for unused in ("HTTPValidationError", "ValidationError"):
        components.pop(unused, None)

    for operation in OPERATIONS.values():
        solve = document["paths"][f"/v1/{operation.name}"]["post"]
        solve["requestBody"] = {"required": True, "content": {"application/json": _request_content(operation)}}
        solve["responses"] = {"200": _solved(operation), "201": _accepted(), **_failures(SOLVE_CODES)}
        (parameter,) = solve["parameters"]
        parameter["schema"]["anyOf"][0]["enum"] = list(operation.formats)
        solve["parameters"] += [PREFER, IDEMPOTENCY_KEY]
    _describe_jobs(document["paths"])
    document["paths"]["/readyz"]["get"]["responses"].update(_failures(READY_CODES))
    return document


def _describe_jobs(paths: Json) -> None:
    """Put in what the framework cannot see of the routes of jobs."""
    for path, methods in JOB_CODES.items():
        for method, codes in methods.items():
            route = paths[path][method]
            good = {status: response for status, response in route["responses"].items() if int(status) < 300}
            route["responses"] = {**good, **_failures(codes)}
    batch = paths["/v1/batches"]["post"]
    lines = {"schema": {"type": "string", "description": "one domain a line"}}
    batch["requestBody"] = {"required": True, "content": {LINES: lines}}
    batch["responses"]["201"] = _accepted()
    batch["parameters"][0]["schema"]["enum"] = list(OPERATIONS)
    batch["parameters"].append(IDEMPOTENCY_KEY)
    results = paths["/v1/jobs/{job_id}/results"]["get"]["responses"]["200"]
    results["description"] = "What the request would have been answered; of a batch, JSON lines."
    results["content"] = {FORMATS[form]: {"schema": schema} for form, schema in FORMAT_SCHEMAS.items()}
    results["content"][LINES] = {"schema": {"type": "string"}}


def _accepted() -> Json:
    """A job was made."""
    headers = {
        "Location": {"description": "of its status", "schema": {"type": "string"}},
        "Preference-Applied": {"description": "the preferences that were honoured", "schema": {"type": "string"}},
    }
    content = {"application/json": {"schema": _reference("JobStatus")}}
    links = {
        name: {"operationId": name, "parameters": {"job_id": "$response.body#/jobID"}} for name in ("job", "results", "dismiss")
    }
    return {"description": "A job: where it is, and how.", "headers": headers, "content": content, "links": links}


def _request_content(operation: Operation) -> Json:
    """The schema of a body, and the committed examples; an analysis shows one of them, with arguments."""
    examples = {}
    for path in sorted(EXAMPLES.glob(f"{operation.example or '*'}.json")):
        domain = json.loads(path.read_text())
        value = {**domain, "arguments": operation.arguments} if operation.arguments else domain
        examples[path.stem] = {"summary": domain["name"], "value": value}
    return {"schema": _reference(operation.request.__name__)} | ({"examples": examples} if examples else {})


def _solved(operation: Operation) -> Json:
    """The answer in all of its formats."""
    content: Json = {FORMATS[form]: {"schema": FORMAT_SCHEMAS[form]} for form in operation.formats}
    content[FORMATS["json"]] = {"schema": _reference(operation.answer.__name__)}
    return {
        "description": operation.description,
        "headers": {
            "Server-Timing": {"description": "milliseconds of each stage", "schema": {"type": "string"}},
            "X-Request-ID": {"description": "as sent, or a new one", "schema": {"type": "string"}},
        },
        "content": content,
    }


def _failures(codes: list[str]) -> Json:
    """One response for each status, with an example for each of its codes."""
    responses: Json = {}
    for code in codes:
        kind = ERRORS[code]
        content = {"schema": _reference("ProblemDocument"), "examples": {}}
        response = responses.setdefault(str(kind.status), {"description": "", "content": {MEDIA_TYPE: content}})
        response["description"] = "; ".join(filter(None, (response["description"], f"`{code}`: {kind.title}")))
        extra: Json = {"problems": EXAMPLE_PROBLEMS} if code == "invalid-domain" else {}
        example = RequestError(code, f"{kind.title}.", extra).document()
        response["content"][MEDIA_TYPE]["examples"][code] = {"value": example}
        if kind.retry_after_seconds is not None:
            description = "seconds to wait before trying again"
            response["headers"] = {"Retry-After": {"description": description, "schema": {"type": "integer"}}}
    return responses


def _reference(model: str) -> Json:
    return {"$ref": f"#/components/schemas/{model}"}
