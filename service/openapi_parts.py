"""What the operations of the OpenAPI document have in common: headers, the answers that tell of failures and of jobs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from service.errors import ERRORS, MEDIA_TYPE, RequestError
from service.http.negotiation import Format

Json = dict[str, Any]

SECURITY = {
    "bearer": {"type": "http", "scheme": "bearer", "description": "where the operator has set MAT_API_KEYS"},
    "key": {"type": "apiKey", "in": "header", "name": "X-API-Key", "description": "the same, by another header"},
}

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
    "msgpack": {"type": "string", "format": "binary"},
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

def accepted() -> Json:
    """A job was made."""
    headers = {
        "Location": {"description": "of its status", "schema": {"type": "string"}},
        "Preference-Applied": {"description": "the preferences that were honoured", "schema": {"type": "string"}},
    }
    content = {"application/json": {"schema": reference("JobStatus")}}
    links = {
        name: {"operationId": name, "parameters": {"job_id": "$response.body#/jobID"}} for name in ("job", "results", "dismiss")
    }
    return {"description": "A job: where it is, and how.", "headers": headers, "content": content, "links": links}


def headers() -> Json:
    """What every answer of a worker says about itself."""
    told = {
        "Cache-Status": "whether the answer was kept from an earlier request (RFC 9211)",
        "ETag": "the same for the same request, as long as the versions are",
        "Server-Timing": "milliseconds of each stage",
        "Traceresponse": "the span of this request, as traceparent has it",
        "X-Request-ID": "as sent, or a new one",
    }
    return {name: {"description": text, "schema": {"type": "string"}} for name, text in told.items()}


def problems(codes: Iterable[str]) -> Json:
    """An example of the problem document of each code; responses refer to them by the code."""
    examples = {}
    for code in codes:
        kind = ERRORS[code]
        extra: Json = {"problems": EXAMPLE_PROBLEMS} if code == "invalid-domain" else {}
        examples[code] = {"summary": kind.title, "value": RequestError(code, f"{kind.title}.", extra).document()}
    return examples


def failures(codes: list[str]) -> Json:
    """One response for each status, with an example for each of its codes."""
    responses: Json = {}
    for code in codes:
        kind = ERRORS[code]
        content = {"schema": reference("ProblemDocument"), "examples": {}}
        response = responses.setdefault(str(kind.status), {"description": "", "content": {MEDIA_TYPE: content}})
        response["description"] = "; ".join(filter(None, (response["description"], f"`{code}`: {kind.title}")))
        response["content"][MEDIA_TYPE]["examples"][code] = {"$ref": f"#/components/examples/{code}"}
        if kind.retry_after_seconds is not None:
            description = "seconds to wait before trying again"
            response["headers"] = {"Retry-After": {"description": description, "schema": {"type": "integer"}}}
    return responses


def reference(model: str) -> Json:
    """A schema by its name."""
    return {"$ref": f"#/components/schemas/{model}"}
