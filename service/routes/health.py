"""Whether the service lives, whether it can take work, and what it is; all on the event loop, never behind work."""

from __future__ import annotations

from fastapi import APIRouter, Request

from service import __version__
from service.errors import RequestError
from service.schemas import Status, Versions
from service.workers.pool import Pool

router = APIRouter(tags=["operation"])


@router.get("/healthz")
async def healthz() -> Status:
    """The process answers. Depends on nothing else, so a failure is a reason to restart it."""
    return Status(status="ok")


@router.get("/readyz")
async def readyz(request: Request) -> Status:
    """The workers are warm, the queue has room, jobs can be stored. If not, send requests elsewhere for a while."""
    pool: Pool = request.app.state.pool
    if request.app.state.leaving:
        raise RequestError("not-ready", "The service has been asked to end; send requests elsewhere.")
    if not pool.ready:
        raise RequestError("not-ready", _loading(pool), {"failed": pool.load_failed})
    if pool.full or request.app.state.traffic.full():
        raise RequestError("queue-full", "As many requests wait, or take as much memory, as may.")
    if not await request.app.state.jobs.ready():
        raise RequestError("store-unavailable", "The job store does not answer; everything but jobs is served.")
    return Status(status="ready")


def _loading(pool: Pool) -> str:
    """How far the workers have come."""
    name, done, total = pool.progress
    if pool.load_failed:
        return "The workers could not be loaded, the log says why; it is tried again."
    if total == 0:
        return "Loading the library."
    return f"Loading or compiling the kernels, step {done} of {total}: {name}."


@router.get("/version")
async def version(request: Request) -> Versions:
    """The versions of the service and of the algorithm; the latter is unknown until the workers are loaded."""
    pool: Pool = request.app.state.pool
    return Versions(service=__version__, algorithm=pool.about.get("algorithm", "unknown"))
