"""Many domains at once: JSON lines in, a job whose results are JSON lines."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from service.errors import RequestError
from service.http.bodies import announced_bytes, arriving
from service.http.negotiation import check_coding
from service.http.preferences import Preferences
from service.jobs.batches import HELD_BYTES
from service.jobs.port import BatchRefused
from service.operations import OPERATIONS
from service.orders import Order
from service.routes.jobs import LINES, created, idempotency_key, jobs_of, owner_of, refusals
from service.routes.solve import PrecisionParameter

router = APIRouter(tags=["jobs"])

TYPES = (LINES, "application/jsonl", "application/jsonlines")


@router.post("/v1/batches", operation_id="batch", summary="Many domains in one job", status_code=201)
async def batch(
    request: Request,
    operation: Annotated[str, Query(description="what is done with each domain: a route below /v1")] = "mat",
    precision: PrecisionParameter = None,
) -> Response:
    """A body of JSON lines, each a domain as the operation's own route takes it, `arguments` included.

    The results are JSON lines, too: for each domain in turn its answer, or the problem document of what is wrong with it.
    A body that ends before its end makes no job.
    """
    if operation not in OPERATIONS:
        raise RequestError("invalid-parameter", f"operation: one of {', '.join(OPERATIONS)}.")
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if media_type not in TYPES:
        raise RequestError("unsupported-media-type", f"Send one domain a line, with 'Content-Type: {LINES}'.")
    compressed = check_coding(request.headers)
    key = idempotency_key(request)
    limit = request.app.state.settings.max_batch_bytes
    order = Order(operation, "json", {} if precision is None else {"precision": precision})
    size = announced_bytes(request)
    request.state.load.add(min(size, HELD_BYTES) if size and not compressed else HELD_BYTES)
    lines = arriving(request, limit, compressed)
    with refusals():
        try:
            job = await jobs_of(request).submit_batch(order, lines, key, owner_of(request))
        except BatchRefused as error:
            raise RequestError(error.code, error.detail, {"line": error.line}, {"Connection": "close"}) from None
    return created(request, job, Preferences())
