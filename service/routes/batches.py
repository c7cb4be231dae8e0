"""Many domains at once: JSON lines in, a job whose results are JSON lines."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from service.errors import RequestError
from service.jobs.port import BatchRefused
from service.operations import OPERATIONS
from service.preferences import Preferences
from service.routes.jobs import LINES, created, idempotency_key, jobs_of, owner_of, refusals

router = APIRouter(tags=["jobs"])

TYPES = (LINES, "application/jsonl", "application/jsonlines")


@router.post("/v1/batches", operation_id="batch", summary="Many domains in one job", status_code=201)
async def batch(
    request: Request,
    operation: Annotated[str, Query(description="what is done with each domain: a route below /v1")] = "mat",
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
    if request.headers.get("content-encoding", "identity").strip().lower() not in ("", "identity"):
        refuse = {"Accept-Encoding": "identity"}
        raise RequestError("unsupported-media-type", "Content-Encoding: send the lines as they are.", headers=refuse)
    key = idempotency_key(request)
    announced = request.headers.get("content-length", "")
    limit = request.app.state.settings.max_batch_bytes
    if announced.isdigit() and int(announced) > limit:
        raise RequestError("body-too-large", f"The limit of a batch is {limit} bytes.", headers={"Connection": "close"})
    with refusals():
        try:
            job = await jobs_of(request).submit_batch(operation, _counted(request), key, owner_of(request))
        except BatchRefused as error:
            raise RequestError(error.code, error.detail, {"line": error.line}, {"Connection": "close"}) from None
    return created(request, job, Preferences())


async def _counted(request: Request) -> AsyncIterator[bytes]:
    """The body as it comes, its bytes counted for the log."""
    request.state.bytes_in = 0
    async for piece in request.stream():
        request.state.bytes_in += len(piece)
        yield piece
