"""The figures of the service for Prometheus."""

from __future__ import annotations

import asyncio
import contextlib

from fastapi import APIRouter, Request, Response
from prometheus_client.exposition import choose_encoder

from service.jobs.port import StoreUnavailable
from service.observability.metrics import Metrics

COUNT_SECONDS = 1.0
"""How long the job store may take to count: the other figures are most wanted when it is away."""

router = APIRouter(include_in_schema=False)


@router.get("/metrics")
async def metrics(request: Request) -> Response:
    """All of them, in the text format that the scraper prefers."""
    figures: Metrics = request.app.state.metrics
    with contextlib.suppress(StoreUnavailable, TimeoutError):  # /readyz tells of that; the last counts stay
        async with asyncio.timeout(COUNT_SECONDS):
            figures.set_jobs(await request.app.state.jobs.counts())
    encode, media_type = choose_encoder(request.headers.get("accept", ""))
    return Response(encode(figures.registry), headers={"Content-Type": media_type})
