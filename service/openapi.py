"""The OpenAPI document: the web framework's own, with the bodies that it cannot see.

The routes of `service.operations` take their bodies as bytes (no large body is parsed on the event loop) and answer bytes
that a worker encoded, so their schemas are put in here, together with a problem document for every code of `service.errors`.
``make openapi`` writes the result to openapi/openapi.json.
"""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from service.errors import ERRORS
from service.http.keys import is_open
from service.http.negotiation import FORMATS
from service.openapi_parts import (
    FORMAT_SCHEMAS,
    IDEMPOTENCY_KEY,
    LINES,
    PREFER,
    SECURITY,
    Json,
    accepted,
    failures,
    headers,
    problems,
    reference,
)
from service.operations import OPERATIONS, Operation
from service.processes import ExecuteRequest
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

ELSEWHERE = (
    *("not-http", "not-found", "method-not-allowed", "not-ready"),
    *("origin-not-allowed", "result-not-ready", "job-dismissed"),
)

SOLVING = [code for code in ERRORS if code not in ELSEWHERE]
"""Codes of what solves; no-such-process is among them where the process is a part of the address."""

OWN_CODES = {
    "/readyz": ["queue-full", "not-ready", "store-unavailable"],
    "/": ["not-acceptable", "precondition-failed"],
    "/conformance": ["not-acceptable", "precondition-failed"],
    "/processes": ["not-acceptable", "precondition-failed"],
    "/processes/{process_id}": ["no-such-process", "not-acceptable", "precondition-failed"],
    "/processes/{process_id}/execution": SOLVING,
    "/v1/jobs": ["store-unavailable"],
    "/v1/jobs/{job_id}": ["not-found", "store-unavailable"],
    "/v1/jobs/{job_id}/results": [code for code in ERRORS if code not in ("not-http", "method-not-allowed", "not-ready")],
    "/v1/batches": [
        *("not-json", "not-gzip", "upload-timeout", "idempotency-key-in-flight", "body-too-large", "unsupported-media-type"),
        *("idempotency-key-reused", "store-unavailable"),
    ],
    **{f"/v1/{name}": [code for code in SOLVING if code != "no-such-process"] for name in OPERATIONS},
}
"""What can go wrong at an address, besides what can everywhere; a failed job's results are its own problem."""

EVERYWHERE = ["invalid-parameter", "header-too-large"]
GUARDED = ["unauthorized", "too-many-requests"]


def codes_of(path: str) -> list[str]:
    """All codes of an address, in the order of the table."""
    possible = {*EVERYWHERE, *OWN_CODES.get(path, ()), *(() if is_open(path, metrics_open=False) else GUARDED)}
    return [code for code in ERRORS if code in possible]


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
    models: list[tuple[type[BaseModel], str]] = [(ProblemDocument, "serialization"), (ExecuteRequest, "validation")]
    for operation in OPERATIONS.values():
        models += [(operation.request, "validation"), (operation.answer, "serialization")]
    _, schemas = models_json_schema(models, ref_template="#/components/schemas/{model}")  # type: ignore[arg-type]
    components = document.setdefault("components", {}).setdefault("schemas", {})
    components.update(schemas["$defs"])
    for unused in ("HTTPValidationError", "ValidationError"):
        components.pop(unused, None)

    _forget_nulls(document["paths"])
    for operation in OPERATIONS.values():
        solve = document["paths"][f"/v1/{operation.name}"]["post"]
        solve["requestBody"] = {"required": True, "content": {"application/json": _request_content(operation)}}
        solve["responses"] = {"200": _solved(operation), "201": accepted()}
        solve["parameters"] += [PREFER, IDEMPOTENCY_KEY]
        _parameter(solve, "f")["schema"]["enum"] = list(operation.formats)
    execute = document["paths"]["/processes/{process_id}/execution"]["post"]
    execute["requestBody"] = {"required": True, "content": {"application/json": _execute_content()}}
    execute["responses"] = {"200": _executed(), "201": accepted()}
    execute["parameters"] += [PREFER, IDEMPOTENCY_KEY]
    _describe_jobs(document["paths"])
    told = {code for path in document["paths"] for code in codes_of(path)}
    document["components"] |= {"securitySchemes": SECURITY, "examples": problems(code for code in ERRORS if code in told)}
    for path, methods in document["paths"].items():
        for description in methods.values():
            good = {status: response for status, response in description["responses"].items() if int(status) < 400}
            description["responses"] = {**good, **failures(codes_of(path))}
            if not is_open(path, metrics_open=False):
                description["security"] = [{}, *({name: []} for name in SECURITY)]
    return document


def _forget_nulls(paths: Json) -> None:
    """A parameter that may be left out is not one that may be null, which no query can say."""
    for methods in paths.values():
        for description in methods.values():
            for parameter in description.get("parameters", ()):
                for alternative in parameter["schema"].pop("anyOf", ()):
                    if alternative != {"type": "null"}:
                        parameter["schema"] |= alternative


def _parameter(operation: Json, name: str) -> Json:
    """A parameter of an operation."""
    found: Json = next(parameter for parameter in operation["parameters"] if parameter["name"] == name)
    return found


def _describe_jobs(paths: Json) -> None:
    """Put in what the framework cannot see of the routes of jobs."""
    batch = paths["/v1/batches"]["post"]
    lines = {"type": "string", "pattern": r"[^ \t\n\r\f\v]", "description": "one domain a line; blank ones are passed over"}
    batch["requestBody"] = {"required": True, "content": {LINES: {"schema": lines}}}
    batch["responses"]["201"] = accepted()
    batch["parameters"][0]["schema"]["enum"] = list(OPERATIONS)
    batch["parameters"].append(IDEMPOTENCY_KEY)
    results = paths["/v1/jobs/{job_id}/results"]["get"]["responses"]["200"]
    results["description"] = "What the request would have been answered; of a batch, JSON lines."
    results["content"] = {FORMATS[form]: {"schema": schema} for form, schema in FORMAT_SCHEMAS.items()}
    results["content"][LINES] = {"schema": {"type": "string"}}


def _request_content(operation: Operation) -> Json:
    """The schema of a body, and the committed examples; an analysis shows one of them, with arguments."""
    examples = {}
    for path in sorted(EXAMPLES.glob(f"{operation.example or '*'}.json")):
        domain = json.loads(path.read_text())
        value = {**domain, "arguments": operation.arguments} if operation.arguments else domain
        examples[path.stem] = {"summary": domain["name"], "value": value}
    return {"schema": reference(operation.request.__name__)} | ({"examples": examples} if examples else {})


def _solved(operation: Operation) -> Json:
    """The answer in all of its formats."""
    content: Json = {FORMATS[form]: {"schema": FORMAT_SCHEMAS[form]} for form in operation.formats}
    content[FORMATS["json"]] = {"schema": reference(operation.answer.__name__)}
    return {"description": operation.description, "headers": headers(), "content": content}


def _execute_content() -> Json:
    """The schema of an execute request, with a rectangle as its example."""
    inputs = {"outer": [{"degree": 1, "control_points": [a, b]} for a, b in pairwise(_RECTANGLE)]}
    example = {"inputs": inputs, "outputs": {"result": {"format": {"mediaType": FORMATS["svg"]}}}}
    return {"schema": reference("ExecuteRequest"), "examples": {"a picture": {"value": example}}}


def _executed() -> Json:
    """The output of any process, in any format."""
    content: Json = {media_type: {"schema": FORMAT_SCHEMAS[form]} for form, media_type in FORMATS.items()}
    return {"description": "the output as below /v1, or a document that holds it", "headers": headers(), "content": content}


_RECTANGLE = [[0, 0], [4, 0], [4, 2], [0, 2], [0, 0]]
