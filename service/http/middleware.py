"""What surrounds every request: its id and its trace, in and out; who asks; one line of log.

::

    RequestContext   id, trace, sizes, log line; a defect of anything inside becomes a problem document here
      CrossOrigin    only where MAT_CORS_ORIGINS is set; answers preflights
        Gate         keys, and how many requests of one are under way; only where MAT_API_KEYS is set
          Head       HEAD is GET without the body
            routes
"""

from __future__ import annotations

import logging
import re
import uuid

from fastapi import FastAPI
from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware.cors import CORSMiddleware
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.errors import RequestError
from service.http.keys import Concurrency, identify, is_open
from service.http.responses import problem_response
from service.http.trace_context import TraceContext
from service.http.traffic import Load
from service.observability.requests import Watch
from service.observability.telemetry import current_trace
from service.settings import KIB, Settings

_log = logging.getLogger("service")

_SAFE_ID = re.compile(r"[A-Za-z0-9._:/+=@-]{1,128}")
"""An id from outside goes into headers and logs, so only harmless ones are taken over."""

FIELD_BYTES = 8 * KIB
"""Longest header field that is looked at; the server below takes 64 KiB of them together."""

REQUEST_HEADERS = (
    "Authorization",
    "Content-Encoding",
    "Idempotency-Key",
    "If-Match",
    "If-None-Match",
    "Prefer",
    "Traceparent",
    "Tracestate",
    "X-API-Key",
    "X-Request-ID",
)
"""What pages of other origins may send, besides what they always may."""

RESPONSE_HEADERS = (
    "Allow",
    "Cache-Status",
    "ETag",
    "Link",
    "Location",
    "Preference-Applied",
    "Retry-After",
    "Server-Timing",
    "Traceresponse",
    "WWW-Authenticate",
    "X-Request-ID",
)
"""What they may read of an answer, besides what they always may."""


def install(app: FastAPI, settings: Settings) -> None:
    """Put everything around the routes of `app`, innermost first."""
    app.add_middleware(Head)
    if settings.api_keys:
        app.add_middleware(Gate, settings=settings)
    if settings.cors_origins:
        app.add_middleware(
            CrossOrigin,
            allow_origins=settings.cors_origins,
            allow_methods=("GET", "HEAD", "POST", "DELETE"),
            allow_headers=REQUEST_HEADERS,
            expose_headers=RESPONSE_HEADERS,
        )
    app.add_middleware(RequestContext)


class RequestContext:
    """``request.state.request_id`` and ``.trace``, the headers that tell of them, and what is told of each answer."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one connection event of the server."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        given = headers.get("x-request-id", "")
        request_id = given if _SAFE_ID.fullmatch(given) else uuid.uuid4().hex
        trace = current_trace() or TraceContext.of(headers.get("traceparent", ""))
        state = scope.setdefault("state", {})
        load = Load(scope["app"].state.traffic)
        state.update(request_id=request_id, trace=trace, client=None, load=load)
        watch = Watch(scope, request_id, trace)
        status: int | None = None
        sent = 0

        async def send_with_id(message: Message) -> None:
            nonlocal status, sent
            if message["type"] == "http.response.start":
                status = message["status"]
                answer = MutableHeaders(scope=message)
                answer["X-Request-ID"] = request_id
                answer["Traceresponse"] = trace.header
            sent += len(message.get("body", b""))
            await send(message)

        try:
            if any(len(value) > FIELD_BYTES for _, value in scope["headers"]):
                raise RequestError("header-too-large", f"A field is longer than {FIELD_BYTES} bytes.")
            await self._app(scope, receive, send_with_id)
        except RequestError as error:
            await problem_response(error, Request(scope))(scope, receive, send_with_id)
        except Exception as defect:
            _log.error("request %s failed", request_id, exc_info=defect)
            if status is not None:
                raise  # half an answer is out: only the end of the connection can tell
            failure = RequestError("internal-error", "An unexpected failure, logged.")
            await problem_response(failure, Request(scope))(scope, receive, send_with_id)
        finally:
            load.release()
            watch.end(status, sent)


class CrossOrigin(CORSMiddleware):
    """The web framework's own, with its refusals as problem documents."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one connection event of the server."""
        headers = Headers(scope=scope) if scope["type"] == "http" else Headers()
        if scope.get("method") == "OPTIONS" and {"origin", "access-control-request-method"} <= set(headers):
            response = self.preflight_response(headers)
            if response.status_code >= 400:
                detail = f"{bytes(response.body).decode()}; MAT_CORS_ORIGINS names the origins that are."
                error = RequestError("origin-not-allowed", detail, headers={"Vary": response.headers["vary"]})
                response = problem_response(error, Request(scope))
            else:
                response = Response(status_code=204, headers=_without_body(response))
            await response(scope, receive, send)
            return
        await super().__call__(scope, receive, send)


def _without_body(response: Response) -> dict[str, str]:
    """The headers of a response, but for those of its body."""
    return {name: value for name, value in response.headers.items() if not name.startswith("content-")}


class Gate:
    """Lets in who has a key, and no more of one's requests at a time than the settings allow."""

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self._app = app
        self._settings = settings
        self._concurrency = Concurrency(settings.key_concurrency)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one connection event of the server."""
        if scope["type"] != "http" or is_open(scope["path"], self._settings.metrics_open):
            await self._app(scope, receive, send)
            return
        try:
            client = identify(self._settings.api_keys, Headers(scope=scope))
            scope["state"]["client"] = client
            self._concurrency.enter(client)
        except RequestError as error:
            await problem_response(error, Request(scope))(scope, receive, send)
            return
        try:
            await self._app(scope, receive, send)
        finally:
            self._concurrency.leave(client)


class Head:
    """Answers HEAD as GET is answered, without the body (RFC 9110, 9.3.2)."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one connection event of the server."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self._app(scope, receive, send)
            return

        async def send_head(message: Message) -> None:
            if message["type"] == "http.response.body":
                message = {**message, "body": b""}
            await send(message)

        asked = {**scope, "method": "GET"}
        try:
            await self._app(asked, receive, send_head)
        finally:
            if "route" in asked:  # found inside, told outside
                scope["route"] = asked["route"]
