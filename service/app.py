"""Assembles the application: ``uvicorn --factory service.app:create_app``."""

from __future__ import annotations

import gc
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import Depends, FastAPI

from service import __version__, openapi
from service.http import middleware, responses
from service.http.caching import ResultCache
from service.http.connections import Connections
from service.http.traffic import Traffic
from service.jobs.dbos_jobs import DbosJobs
from service.observability import logs, telemetry
from service.observability.metrics import Metrics
from service.routes import batches, docs, health, jobs, metrics, processes, solve
from service.settings import Settings
from service.workers.pool import Pool


def create_app(settings: Settings | None = None, handler: str = "service.workers.solve") -> FastAPI:
    """The service as an ASGI application.

    Parameters
    ----------
    settings : Settings, optional
        Read from the environment when left out.
    handler : str
        The module that the workers run; tests put others in its place.

    Raises
    ------
    service.settings.InvalidSetting
        When a ``MAT_*`` variable cannot be used.
    """
    settings = settings or Settings.from_environment()
    pool = Pool(settings, handler)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        gc.freeze()  # no collection goes through what is loaded by now; `service.jobs.keeper` does the same for the rest
        async with pool.running(), app.state.jobs.running():
            yield

    app = FastAPI(
        title="Medial axis transform",
        version=__version__,
        lifespan=lifespan,
        dependencies=[Depends(responses.check_query)],
        openapi_url=None,  # served by service.routes.docs, with a tag
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        telemetry=telemetry.config(),
        generate_unique_id_function=lambda route: route.name,
    )
    app.state.settings = settings
    app.state.pool = pool
    app.state.jobs = DbosJobs(settings, pool)
    app.state.leaving = False  # becomes true when the process has been asked to end
    app.state.connections = Connections(settings)
    app.state.traffic = Traffic(settings.traffic_bytes)
    app.state.metrics = Metrics(pool, app.state.connections, app.state.traffic)
    app.state.results = ResultCache(settings.result_cache_bytes)
    middleware.install(app, settings)
    responses.install(app)
    app.include_router(solve.router)
    app.include_router(jobs.router)
    app.include_router(batches.router)
    app.include_router(processes.router)
    app.include_router(health.router)
    app.include_router(metrics.router)
    app.include_router(docs.router)
    app.mount("/static", docs.files, name="static")
    openapi.install(app)
    logs.install(settings.log_level)
    return app
