"""Problem documents for every way a request can fail, the web framework's own failures included."""

from __future__ import annotations

import logging
from http import HTTPStatus

import orjson
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from service.errors import ERRORS, MEDIA_TYPE, RequestError
from service.observability.telemetry import note_code

_log = logging.getLogger("service")

_CODES = {400: "invalid-parameter", 404: "not-found", 405: "method-not-allowed", 413: "body-too-large"}


def problem_response(error: RequestError, request: Request) -> Response:
    """The answer to a request that failed."""
    kind = ERRORS[error.code]
    headers = dict(error.headers)
    if kind.retry_after_seconds is not None:
        headers["Retry-After"] = str(kind.retry_after_seconds)
    request.state.code = error.code
    note_code(error.code)
    document = error.document(request.state.request_id)
    return Response(orjson.dumps(document), kind.status, headers, MEDIA_TYPE)


def install(app: FastAPI) -> None:
    """Make every failure of `app` a problem document."""

    @app.exception_handler(RequestError)
    async def on_request_error(request: Request, error: RequestError) -> Response:
        return problem_response(error, request)

    @app.exception_handler(HTTPException)
    async def on_http_exception(request: Request, error: HTTPException) -> Response:
        code = _CODES.get(error.status_code, "internal-error" if error.status_code >= 500 else "invalid-parameter")
        detail = f"{request.method} {request.url.path}: {HTTPStatus(error.status_code).phrase}."
        return problem_response(RequestError(code, detail, headers=dict(error.headers or {})), request)

    @app.exception_handler(RequestValidationError)
    async def on_invalid_parameter(request: Request, error: RequestValidationError) -> Response:
        faults = "; ".join(f"{fault['loc'][-1]}: {fault['msg']}" for fault in error.errors())
        return problem_response(RequestError("invalid-parameter", f"{faults}."), request)

    @app.exception_handler(ClientDisconnect)
    async def on_client_gone(_request: Request, _error: ClientDisconnect) -> Response:
        return Response(status_code=499)  # for the log; nobody is there to read it

    @app.exception_handler(Exception)
    async def on_anything_else(request: Request, error: Exception) -> Response:
        _log.error("request %s failed", request.state.request_id, exc_info=error)
        return problem_response(RequestError("internal-error", "An unexpected failure, logged."), request)
