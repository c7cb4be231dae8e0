"""The routes that solve: POST /v1/mat, and one for each analysis; a domain in, what was found of it out."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Awaitable, Callable
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from starlette.requests import ClientDisconnect

from service.errors import RequestError
from service.http import caching
from service.http.bodies import announced_bytes, read_body
from service.http.caching import Kept, ResultCache
from service.http.negotiation import (
    FORMATS,
    PRECISION_RANGE,
    Format,
    accepts_gzip,
    check_content,
    check_precision,
    choose_format,
)
from service.http.preferences import Preferences, read_preferences
from service.http.responses import InPieces
from service.observability.logs import IDS
from service.observability.telemetry import record_work
from service.operations import OPERATIONS, Operation
from service.orders import Order
from service.routes import jobs
from service.settings import Settings
from service.workers.lanes import Lane
from service.workers.pool import DeadlineExceeded, Pool, QueueFull, Reply, WorkerCrashed

router = APIRouter(tags=["medial axis"])

FormatParameter = Annotated[str | None, Query(description="the format; goes before the Accept header")]
PrecisionParameter = Annotated[
    int | None,
    Query(
        ge=PRECISION_RANGE[0],
        le=PRECISION_RANGE[1],
        description="significant digits of coordinates and radii, counted from the first one of the domain's larger side; all"
        " of them when left out. Not with drawings. The certificate speaks of the axis before it is rounded",
    ),
]

VARY = "Accept, Accept-Encoding"

LOOK_SECONDS = 1.0
"""How long a look at the body of a job may take, waiting included."""

BUSY = ("queue-full", "deadline-exceeded", "worker-crashed")
"""Codes that say nothing of a body."""

def endpoint(operation: Operation) -> Callable[..., Awaitable[Response]]:
    """The function behind the route of an operation."""

    async def solve(request: Request, f: FormatParameter = None, precision: PrecisionParameter = None) -> Response:
        return await answer(request, make_order(request, operation, f, precision))

    return solve


for _operation in OPERATIONS.values():
    router.add_api_route(
        f"/v1/{_operation.name}",
        endpoint(_operation),
        methods=["POST"],
        operation_id="solve" if _operation.name == "mat" else _operation.name,
        summary=_operation.summary,
        description=_operation.description,
    )


def make_order(request: Request, operation: Operation, f: str | None, precision: int | None, **options: Any) -> Order:
    """What a request asks for, besides what its body does."""
    form = choose_format(f, request.headers.get("accept", "*/*"), operation.formats)
    check_precision(precision, form)
    return Order(operation.name, form, {**({} if precision is None else {"precision": precision}), **options})


async def answer(request: Request, order: Order) -> Response:
    """Read the body and answer it: by a job if that is preferred, else from what is kept, or by a worker."""
    settings: Settings = request.app.state.settings
    pool: Pool = request.app.state.pool
    compressed = check_content(request.headers)
    wishes = read_preferences(request.headers.getlist("prefer"))
    jobs.idempotency_key(request)  # one that is none is refused of every request, whether it is needed or not
    if not wishes.respond_async and pool.refuses(announced_bytes(request)):
        raise queue_full()  # before its body takes memory here
    body = await read_body(request, settings.max_body_bytes, compressed)
    if wishes.respond_async:
        order = await _looked_at(request, order, body)
        return await jobs.submit(request, order, body, wishes)
    return await _answer_now(request, order, body, wishes)


async def _answer_now(request: Request, order: Order, body: bytes, wishes: Preferences) -> Response:
    """The answer itself, and the tag that it is known by."""
    pool: Pool = request.app.state.pool
    cache: ResultCache = request.app.state.results
    header = order.header(request.app.state.settings)
    versions = pool.about
    digest = await caching.digest(body, **header, **versions)
    tag = caching.tag(digest)
    if versions:  # not loaded yet: nobody knows which versions will answer
        caching.unchanged(request.method, request.headers, tag)
    gzip = accepts_gzip(request.headers.get("accept-encoding", ""))
    kept = cache.get(digest, gzip)
    if kept is not None:
        request.state.cache = "hit"
        headers = {**kept.headers, "Server-Timing": "cache;desc=hit", "Cache-Status": "mat; hit", **wishes.headers}
        return InPieces(kept.pieces, headers, kept.media_type)
    reply = await _solve_unless_disconnected(request, {**header, "gzip": gzip}, body, wishes.wait)
    request.state.load.add(sum(map(len, reply.pieces)))
    media_type = FORMATS["json"] if reply.header.get("whole") else FORMATS[reply.header.get("format", order.form)]
    headers = {"Vary": VARY}
    if reply.header.get("gzip"):
        headers["Content-Encoding"] = "gzip"
    if versions and versions == pool.about:
        headers["ETag"] = tag
        cache.put(digest, gzip, Kept(reply.pieces, headers, media_type))
    timing = ", ".join(f"{name};dur={value:.3f}" for name, value in request.state.timings.items())
    told = {"Server-Timing": timing, "Cache-Status": "mat; fwd=miss", **wishes.headers}
    return InPieces(reply.pieces, headers | told, media_type)


async def _looked_at(request: Request, order: Order, body: bytes) -> Order:
    """The order of a job, once a worker has looked at its body: what is wrong with it is told at once, and is no job.

    Large bodies are left to the job, and so are all while the workers have no time: a job is not refused for the load. Only the
    format that an execute request names has to be known before.
    """
    pool: Pool = request.app.state.pool
    small = Lane.of(len(body), job=False) is Lane.SMALL
    execute = "execute" in order.options
    if not execute and not (small and pool.ready):
        return order
    header = {**order.header(request.app.state.settings), "look": "domain" if small else "frame"}
    try:
        reply = await _solve_unless_disconnected(request, header, body, None if execute else LOOK_SECONDS)
    except RequestError as error:
        if execute or error.code not in BUSY:
            raise
        return order
    if not execute:
        return order
    form: Format = "json" if reply.header["whole"] else reply.header["format"]
    return Order(order.operation, form, order.options)


def queue_full(begun: bool = False) -> RequestError:
    """The refusal of a request that there is no room for, not at once or not any more."""
    detail = "this one takes longer than most, and was stopped." if begun else "this one was not started."
    return RequestError("queue-full", f"As many requests wait as may wait; {detail}")


async def _solve_unless_disconnected(request: Request, header: dict[str, Any], body: bytes, wait: float | None) -> Reply:
    """Wait for the answer and for the client's going away, whichever comes first; the latter frees the worker."""
    pool: Pool = request.app.state.pool
    longest = request.app.state.settings.deadline_seconds
    deadline = longest if wait is None else min(wait, longest)
    told = {**header, "ids": dict(IDS.get())}
    solving = asyncio.create_task(pool.solve(told, body, deadline_seconds=deadline))
    leaving = asyncio.create_task(_disconnected(request))
    try:
        await asyncio.wait((solving, leaving), return_when=asyncio.FIRST_COMPLETED)
        if not solving.done():
            raise ClientDisconnect
        reply = await solving
        request.state.timings = {"queue": 1000 * reply.queue_seconds, **reply.header.get("timings", {})}
        record_work(request.state.timings, reply.work_seconds)
        if "error" in reply.header:
            raise RequestError(**reply.header["error"])
        return reply
    except QueueFull as refusal:
        raise queue_full(refusal.begun) from None
    except DeadlineExceeded:
        raise RequestError(
            "deadline-exceeded", "The time from arrival to answer ran out; the work was stopped. Try a smaller domain."
        ) from None
    except WorkerCrashed:
        raise RequestError("worker-crashed", "The work ended without an answer; it may be tried again.") from None
    finally:
        for task in (solving, leaving):
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError, Exception):
                await task


async def _disconnected(request: Request) -> None:
    """Return when the client has gone."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
