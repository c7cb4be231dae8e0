"""Spans for OpenTelemetry, where a collector is configured by its own variables (OTEL_EXPORTER_OTLP_ENDPOINT and so on).

::

    POST /v1/mat          the web framework's own span, part of the caller's trace
      queue               from arrival until a worker took the request
      work                in the worker
        read, solve, operate, encode

The framework speaks to the API of OpenTelemetry, which does nothing by itself; the SDK and the exporter (extra ``telemetry``) are
imported only when an endpoint is set. The stages are told afterwards, from what the worker measured: no span crosses to it.
"""

from __future__ import annotations

import os
import time
from collections.abc import Mapping

from fastapi.telemetry import TelemetryConfig
from opentelemetry import trace
from starlette.types import Scope

from service.http.trace_context import TraceContext

QUIET = ("/healthz", "/readyz", "/metrics")
"""Asked every few seconds by machines; the answer is no news for people."""

CODE = "mat.code"
"""The attribute of a request's span that holds the code of its problem document."""

_NANOSECONDS = 1_000_000  # of a millisecond

_tracer = trace.get_tracer("service")


def config() -> TelemetryConfig:
    """How the web framework takes part: spans of requests, not of health checks; metrics and logs go their own ways."""
    os.environ.setdefault("OTEL_SERVICE_NAME", "mat")
    return TelemetryConfig(
        auto_configure=True, tracing=True, metrics=False, logs=False, operation_spans=False, exclude=_unwatched
    )


def _unwatched(scope: Scope) -> bool:
    return scope.get("path") in QUIET


def current_trace() -> TraceContext | None:
    """The span that is being recorded, if one is."""
    context = trace.get_current_span().get_span_context()
    if not context.is_valid:
        return None
    ids = trace.format_trace_id(context.trace_id), trace.format_span_id(context.span_id)
    return TraceContext(*ids, flags=int(context.trace_flags))


def note_code(code: str) -> None:
    """Tell the request's span how the request failed."""
    trace.get_current_span().set_attribute(CODE, code)


def record_work(timings: Mapping[str, float], work_seconds: float) -> None:
    """Spans for a request that a worker has just answered.

    Parameters
    ----------
    timings : mapping
        Milliseconds by stage, ``queue`` first, then those of the worker in their order.
    work_seconds : float
        From handing the request to the worker to having its answer.
    """
    if not trace.get_current_span().is_recording():
        return
    end = time.time_ns()
    begin = end - int(1e9 * work_seconds)
    queue = _tracer.start_span("queue", start_time=begin - int(_NANOSECONDS * timings["queue"]))
    queue.end(begin)
    work = _tracer.start_span("work", start_time=begin)
    inside = trace.set_span_in_context(work)
    at = begin
    for name, milliseconds in timings.items():
        if name != "queue":
            stage = _tracer.start_span(name, inside, start_time=at)
            at += int(_NANOSECONDS * milliseconds)
            stage.end(at)
    work.end(end)
