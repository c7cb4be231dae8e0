"""Jobs: requests whose answer is fetched later, by the rules of OGC API - Processes and RFC 7240."""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections.abc import Iterator
from typing import Annotated
from urllib.parse import urlencode

import orjson
from fastapi import APIRouter, Path, Query, Request, Response
from fastapi.responses import StreamingResponse
from starlette.requests import ClientDisconnect

from service.errors import OGC, RequestError
from service.http import caching, compression
from service.http.negotiation import FORMATS, accepts_gzip
from service.http.preferences import Preferences
from service.jobs.port import Job, Jobs, KeyInFlight, KeyReused, ResultsGone, StoreUnavailable
from service.orders import Order
from service.schemas import JobList, JobStatus, Link

router = APIRouter(tags=["jobs"])

LINES = "application/x-ndjson"

PAGE, LONGEST_PAGE = 50, 1000
"""Jobs on a page of the list: as a rule, and at most."""

POLL_SECONDS = (0.02, 0.5)
"""First and longest pause between two looks at a job that a request waits for."""

LONGEST_WAIT = 600
"""Seconds that a request waits for a job at most, whatever it prefers; connections do not last for ever."""

_ID = re.compile(r"[0-9a-f]{32}")
_KEY = re.compile(r"[\x21-\x7e]([\x20-\x7e]{0,253}[\x21-\x7e])?")

JobId = Annotated[str, Path(description="as in the status document", max_length=64)]


@router.get("/v1/jobs", operation_id="jobs", summary="List jobs", response_model_exclude_none=True)
async def list_jobs(
    request: Request,
    limit: Annotated[int, Query(ge=1, le=LONGEST_PAGE, description="jobs on a page")] = PAGE,
    next: Annotated[str | None, Query(max_length=200, description="the token that the page before ended with")] = None,  # noqa: A002
) -> JobList:
    """Your jobs, newest first: those made with your key where keys are in force."""
    try:
        with refusals():
            found, token = await jobs_of(request).list(limit, next, owner_of(request))
    except ValueError:
        raise RequestError("invalid-parameter", "next: not a token of this list.") from None
    links = [_link(request, "/v1/jobs", "self")]
    if token is not None:
        links.append(_link(request, "/v1/jobs?" + urlencode({"limit": limit, "next": token}), "next"))
    return JobList(jobs=[status_document(request, job) for job in found], next=token, links=links)


@router.get("/v1/jobs/{job_id}", operation_id="job", summary="How a job is", response_model_exclude_none=True)
async def status(request: Request, job_id: JobId) -> JobStatus:
    """The status document of a job."""
    return status_document(request, await find(request, job_id))


@router.get("/v1/jobs/{job_id}/results", operation_id="results", summary="The results of a job")
async def results(request: Request, job_id: JobId) -> Response:
    """What the request would have been answered; of a batch, one line a domain, in order. A failed job's is its problem."""
    return await answer(request, await find(request, job_id))


@router.delete("/v1/jobs/{job_id}", operation_id="dismiss", summary="Dismiss a job", response_model_exclude_none=True)
async def dismiss(request: Request, job_id: JobId) -> JobStatus:
    """Stop a job that is not over; remove one that is over (dismissed ones, too), with its files."""
    job = await find(request, job_id)
    with refusals():
        return status_document(request, await jobs_of(request).dismiss(job))


async def submit(request: Request, order: Order, body: bytes, wishes: Preferences) -> Response:
    """Make a job of a request: 201 once it is on disk, or its answer if that comes within the time the client waits."""
    with refusals():
        job = await jobs_of(request).submit(order, body, idempotency_key(request), owner_of(request))
    if wishes.wait:
        job = await _wait(request, job, min(wishes.wait, LONGEST_WAIT))
        if job.over:
            response = await answer(request, job)
            response.headers.update(wishes.headers)
            return response
    return created(request, job, wishes)


def created(request: Request, job: Job, wishes: Preferences) -> Response:
    """The answer that tells where a job is."""
    document = status_document(request, job).model_dump(mode="json", exclude_none=True)
    headers = {"Location": _address(request, f"/v1/jobs/{job.id}"), **wishes.headers}
    return Response(orjson.dumps(document), 201, headers, "application/json")


async def answer(request: Request, job: Job) -> Response:
    """The results of a job that is over, its problem if it failed."""
    if job.state == "dismissed":
        raise RequestError("job-dismissed", "The job was dismissed; it has no results.")
    if not job.over:
        detail = f"The job is {job.state}, {job.progress} %. Its status tells when the results are there."
        raise RequestError("result-not-ready", detail)
    with refusals():
        if job.state == "failed":
            raise RequestError(**await jobs_of(request).failure(job))
        found = await jobs_of(request).results(job)
    tag = caching.tag(found.digest)
    headers = {"ETag": tag, "Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
    if request.method == "GET" and caching.unchanged(request.method, request.headers, tag):
        return Response(status_code=304, headers=headers)
    pieces = found.pieces
    if found.size >= compression.LEAST_BYTES and accepts_gzip(request.headers.get("accept-encoding", "")):
        headers["Content-Encoding"] = "gzip"
        pieces = compression.compressed(pieces)
    else:
        headers["Content-Length"] = str(found.size)
    media_type = LINES if job.batch else FORMATS[job.format]  # type: ignore[index]  # one of them when it was stored
    return StreamingResponse(pieces, 200, headers, media_type)


async def find(request: Request, job_id: str) -> Job:
    """The job at an address, if the client may see it."""
    askable = job_id if _ID.fullmatch(job_id) else ""  # a database takes not every text that an address can hold
    with refusals():
        job = await jobs_of(request).get(askable, owner_of(request))
    if job is None:
        detail = f"There is no job {job_id!r}, or it is not yours, or it was removed."
        raise RequestError("not-found", detail, {"type": f"{OGC}/no-such-job"})
    return job


def status_document(request: Request, job: Job) -> JobStatus:
    """A job as OGC API - Processes describes it."""
    here = f"/v1/jobs/{job.id}"
    links = [_link(request, here, "self"), _link(request, "/v1/jobs", "up")]
    if job.state in ("successful", "failed"):
        media_type = LINES if job.batch else FORMATS[job.format]  # type: ignore[index]
        links.append(_link(request, f"{here}/results", "http://www.opengis.net/def/rel/ogc/1.0/results", media_type))
    return JobStatus(
        jobID=job.id,
        type="process",
        processID=job.operation,
        status=job.state,
        message=job.message,
        progress=job.progress,
        created=job.created,
        started=job.started,
        updated=job.updated,
        finished=job.finished,
        links=links,
    )


def idempotency_key(request: Request) -> str | None:
    """The Idempotency-Key of a request."""
    key: str | None = request.headers.get("idempotency-key")
    if key is not None and not _KEY.fullmatch(key):
        raise RequestError("invalid-parameter", "Idempotency-Key: 1 to 255 printable ASCII characters.")
    return key


@contextlib.contextmanager
def refusals() -> Iterator[None]:
    """Turn what the port raises into problem documents."""
    try:
        yield
    except KeyReused:
        detail = "The first request with this key was another one; use a new key for a new request."
        raise RequestError("idempotency-key-reused", detail) from None
    except KeyInFlight:
        detail = "The first request with this key has not been answered yet; try again when it has."
        raise RequestError("idempotency-key-in-flight", detail) from None
    except ResultsGone:
        raise RequestError("not-found", "The results were removed.") from None
    except StoreUnavailable:
        detail = "The job store does not answer. Send the request again later; with an Idempotency-Key no job is made twice."
        raise RequestError("store-unavailable", detail) from None


async def _wait(request: Request, job: Job, seconds: float) -> Job:
    """Look at a job until it is over or the time has passed; a store that goes away meanwhile is no reason to lose the job."""
    pause, longest = POLL_SECONDS
    end = asyncio.get_running_loop().time() + seconds
    while not job.over and (left := end - asyncio.get_running_loop().time()) > 0:
        await asyncio.sleep(min(pause, left))
        if await request.is_disconnected():
            raise ClientDisconnect
        pause = min(1.5 * pause, longest)
        with contextlib.suppress(StoreUnavailable):
            job = await jobs_of(request).get(job.id, owner_of(request)) or job
    return job


def jobs_of(request: Request) -> Jobs:
    """The jobs of the application."""
    jobs: Jobs = request.app.state.jobs
    return jobs


def owner_of(request: Request) -> str | None:
    """The name of the key that a request came with."""
    return getattr(request.state, "client", None)


def _address(request: Request, path: str) -> str:
    """A path of this service as clients reach it."""
    return f"{request.scope.get('root_path', '')}{path}"


def _link(request: Request, path: str, rel: str, media_type: str = "application/json") -> Link:
    return Link(href=_address(request, path), rel=rel, type=media_type)
