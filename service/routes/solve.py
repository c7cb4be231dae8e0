"""The routes that solve: POST /v1/mat, and one for each analysis; a domain in, what was found of it out."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Awaitable, Callable
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from starlette.requests import ClientDisconnect

from service.errors import RequestError
from service.negotiation import FORMATS, check_content, choose_format
from service.observability.logs import IDS
from service.observability.telemetry import record_work
from service.operations import OPERATIONS, Operation
from service.preferences import read_preferences
from service.routes import jobs
from service.settings import Settings
from service.workers.pool import DeadlineExceeded, Pool, QueueFull, Reply, WorkerCrashed

router = APIRouter(tags=["medial axis"])


def endpoint(operation: Operation) -> Callable[..., Awaitable[Response]]:
    """The function behind the route of an operation."""

    async def solve(
        request: Request,
        f: Annotated[str | None, Query(description="the format; goes before the Accept header")] = None,
    ) -> Response:
        settings: Settings = request.app.state.settings
        pool: Pool = request.app.state.pool
        form = choose_format(f, request.headers.get("accept", "*/*"), operation.formats)
        check_content(request.headers)
        jobs.idempotency_key(request)  # one that is none is refused of every request, whether it is needed or not
        wishes = read_preferences(request.headers.getlist("prefer"))
        if not wishes.respond_async and pool.refuses(announced_bytes(request)):
            raise queue_full()  # before its body takes memory here
        body = await read_body(request, settings.max_body_bytes)
        if wishes.respond_async:
            return await jobs.submit(request, operation.name, form, body, wishes)
        keep = str(settings.keep_failed_dir) if settings.keep_failed_dir else None
        header = {"operation": operation.name, "format": form, "keep": keep, "ids": dict(IDS.get())}
        reply = await _solve_unless_disconnected(request, pool, header, body, wishes.wait)
        timings = {"queue": 1000 * reply.queue_seconds, **reply.header.get("timings", {})}
        request.state.timings = timings
        record_work(timings, reply.work_seconds)
        if "error" in reply.header:
            raise RequestError(**reply.header["error"])
        timing = ", ".join(f"{name};dur={value:.3f}" for name, value in timings.items())
        headers = {"Server-Timing": timing, "Vary": "Accept", **wishes.headers}
        return Response(reply.body, headers=headers, media_type=FORMATS[form])

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


def queue_full() -> RequestError:
    """The refusal of a request that there is no room for."""
    return RequestError("queue-full", "As many requests wait as may wait; this one was not started.")


def announced_bytes(request: Request) -> int:
    """The size of the body as its header has it; 0 where it says nothing."""
    announced = request.headers.get("content-length", "")
    return int(announced) if announced.isdigit() else 0


async def read_body(request: Request, limit: int) -> bytes:
    """The body, refused as soon as it is known to be too large; its bytes are counted, whatever its header promises."""
    too_large = RequestError("body-too-large", f"The limit is {limit} bytes.", headers={"Connection": "close"})
    if announced_bytes(request) > limit:
        raise too_large
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > limit:
            raise too_large
    request.state.bytes_in = len(body)
    return bytes(body)


async def _solve_unless_disconnected(
    request: Request, pool: Pool, header: dict[str, Any], body: bytes, wait: int | None
) -> Reply:
    """Wait for the answer and for the client's going away, whichever comes first; the latter frees the worker."""
    longest = request.app.state.settings.deadline_seconds
    deadline = longest if wait is None else min(wait, longest)
    solving = asyncio.create_task(pool.solve(header, body, deadline_seconds=deadline))
    leaving = asyncio.create_task(_disconnected(request))
    try:
        await asyncio.wait((solving, leaving), return_when=asyncio.FIRST_COMPLETED)
        if not solving.done():
            raise ClientDisconnect
        return await solving
    except QueueFull:
        raise queue_full() from None
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
