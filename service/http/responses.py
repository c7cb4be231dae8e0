"""Answers in the shapes that all routes share: problem documents, and documents that clients may keep."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Mapping
from http import HTTPStatus

import orjson
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.routing import iter_route_contexts
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.routing import Match
from starlette.types import Receive, Scope, Send

from service.errors import ERRORS, MEDIA_TYPE, RequestError
from service.http import caching, compression
from service.http.negotiation import accepts_gzip
from service.observability.telemetry import note_code
from service.workers.channel import Pieces

_log = logging.getLogger("service")

_CODES = {400: "invalid-parameter", 404: "not-found", 405: "method-not-allowed", 413: "body-too-large"}

SHOWN = 200
"""Characters of an address or a name that a problem document repeats."""


class InPieces(Response):
    """An answer that goes out in the pieces that it came in, as the client takes it, each forgotten once it is out.

    To copy 45 MB, or to give them back at once, would hold up the event loop, and with it every other request, for some 20 ms.
    """

    def __init__(self, pieces: Pieces, headers: Mapping[str, str], media_type: str) -> None:
        super().__init__(None, 200, {**headers, "Content-Length": str(sum(map(len, pieces)))}, media_type)
        self._pieces = deque(pieces or (b"",))

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the answer."""
        await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
        while self._pieces:
            piece = self._pieces.popleft()
            await send({"type": "http.response.body", "body": piece, "more_body": bool(self._pieces)})


def problem_response(error: RequestError, request: Request) -> Response:
    """The answer to a request that failed; nobody is to keep it."""
    kind = ERRORS[error.code]
    headers = {"Cache-Control": "no-store", **error.headers}
    if kind.retry_after_seconds is not None:
        headers["Retry-After"] = str(kind.retry_after_seconds)
    request.state.code = error.code
    note_code(error.code)
    document = error.document(request.state.request_id)
    return Response(orjson.dumps(document), kind.status, headers, MEDIA_TYPE)


def document_response(request: Request, content: bytes, media_type: str, vary: str = "Accept-Encoding") -> Response:
    """A document that is at hand, to be kept and asked for again with If-None-Match; compressed for who takes that.

    Meant for documents of up to some hundred kilobytes: they are compressed on the event loop.
    """
    tag = caching.content_tag(content)
    headers = {"ETag": tag, "Cache-Control": "no-cache", "Vary": vary}
    if caching.unchanged(request.method, request.headers, tag):
        return Response(status_code=304, headers=headers)
    if len(content) >= compression.LEAST_BYTES and accepts_gzip(request.headers.get("accept-encoding", "")):
        content = compression.compress(content)
        headers["Content-Encoding"] = "gzip"
    return Response(content, headers=headers, media_type=media_type)


async def check_query(request: Request) -> None:
    """Refuse parameters that the route does not know, and those that are given twice: both are likely slips.

    Raises
    ------
    RequestError
        ``invalid-parameter``, with the names that are known.
    """
    known = sorted(parameter.alias for parameter in request.scope["route"].dependant.query_params)
    names = [name for name, _ in request.query_params.multi_items()]
    for name in names:
        if name not in known:
            there_are = f"known here are {', '.join(known)}" if known else "this address takes none"
            raise RequestError("invalid-parameter", f"{name[:SHOWN]}: not a parameter; {there_are}.")
        if names.count(name) > 1:
            raise RequestError("invalid-parameter", f"{name}: given {names.count(name)} times.")


def install(app: FastAPI) -> None:
    """Make every failure of `app` a problem document; what is no failure of a request is the middleware's."""

    @app.exception_handler(RequestError)
    async def on_request_error(request: Request, error: RequestError) -> Response:
        return problem_response(error, request)

    @app.exception_handler(HTTPException)
    async def on_http_exception(request: Request, error: HTTPException) -> Response:
        headers = dict(error.headers or {})
        if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            headers["Allow"] = ", ".join(methods(app, request))
            if request.method == "OPTIONS":
                return Response(status_code=204, headers=headers)
        code = _CODES.get(error.status_code, "internal-error" if error.status_code >= 500 else "invalid-parameter")
        detail = f"{request.method} {request.url.path[:SHOWN]}: {HTTPStatus(error.status_code).phrase}."
        return problem_response(RequestError(code, detail, headers=headers), request)

    @app.exception_handler(RequestValidationError)
    async def on_invalid_parameter(request: Request, error: RequestValidationError) -> Response:
        faults = "; ".join(f"{fault['loc'][-1]}: {fault['msg']}" for fault in error.errors())
        return problem_response(RequestError("invalid-parameter", f"{faults}."), request)

    @app.exception_handler(ClientDisconnect)
    async def on_client_gone(_request: Request, _error: ClientDisconnect) -> Response:
        return Response(status_code=499)  # for the log; nobody is there to read it


def methods(app: FastAPI, request: Request) -> list[str]:
    """The methods of an address, over all routes that are there."""
    found = {"OPTIONS"}
    for route in iter_route_contexts(app.routes):
        if route.matches(request.scope)[0] != Match.NONE:
            found |= set(route.methods or ("GET",))  # what is mounted serves files
    return sorted(found | ({"HEAD"} if "GET" in found else set()))
