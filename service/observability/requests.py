"""What is told of each request: a line of log and its figures, and its ids to all that is logged on the way."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping
from contextvars import Token

from starlette.types import Scope

from service.http.trace_context import TraceContext
from service.observability.logs import IDS
from service.observability.metrics import SUCCESS, Metrics
from service.observability.telemetry import QUIET

_log = logging.getLogger("service.access")

UNMATCHED = "(none)"
"""The route of a request whose address leads nowhere."""

CLIENT_GONE = 499
"""The status of a request whose client went away before there was an answer."""


class Watch:
    """One request, watched from its first byte to its answer's last.

    Parameters
    ----------
    scope : Scope
        The connection's; its ``state`` is read at the end: ``client`` (the name of its key),
        ``code``, ``cache``, ``bytes_in`` and ``timings`` (milliseconds by stage).
    request_id : str
        The id that the client gets.
    trace : TraceContext
        The trace that the request belongs to, and its span.
    """

    def __init__(self, scope: Scope, request_id: str, trace: TraceContext) -> None:
        self._scope = scope
        self._begun = time.monotonic()
        self._metrics: Metrics = scope["app"].state.metrics
        self._metrics.begin()
        ids = {"request_id": request_id, "trace_id": trace.trace_id, "span_id": trace.span_id}
        self._token: Token[Mapping[str, str]] = IDS.set(ids)

    def end(self, status: int | None, bytes_out: int) -> None:
        """Tell of the answer; status None: the client went away before there was one."""
        scope, state = self._scope, self._scope["state"]
        seconds = time.monotonic() - self._begun
        status = status or CLIENT_GONE
        route = route_template(scope)
        code = state.get("code")
        bytes_in = state.get("bytes_in", 0)
        timings: dict[str, float] = state.get("timings", {})
        self._metrics.observe_request(route, scope["method"], status, code or SUCCESS, seconds)
        self._metrics.observe_transfer(bytes_in, bytes_out)
        line = {
            "method": scope["method"],
            "path": scope["path"],
            "route": route,
            "status": status,
            "code": code,
            "client": state.get("client"),
            "cache": state.get("cache"),
            "ms": round(1000 * seconds, 1),
            "bytes_in": bytes_in,
            "bytes_out": bytes_out,
        }
        if timings:
            queue, work = timings["queue"], sum(timings.values()) - timings["queue"]
            solve = timings.get("solve")
            self._metrics.observe_work(queue / 1000, None if solve is None else solve / 1000, bytes_in)
            line |= {"queue_ms": round(queue, 1), "compute_ms": round(work, 1)}
        level = logging.DEBUG if scope["path"] in QUIET else logging.INFO
        _log.log(level, "%s %s %d", scope["method"], scope["path"], status, extra=line)
        IDS.reset(self._token)


def route_template(scope: Scope) -> str:
    """The route as it stands in the router, with its parameters' names; one for all addresses that lead nowhere."""
    route = scope.get("route")
    return getattr(route, "path_format", None) or getattr(route, "path", None) or UNMATCHED
