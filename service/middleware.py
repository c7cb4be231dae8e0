"""What surrounds every request: its id, in and out, and one line of log."""

from __future__ import annotations

import json
import logging
import re
import time
import uuid

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_log = logging.getLogger("service.access")

_SAFE_ID = re.compile(r"[A-Za-z0-9._:/+=@-]{1,128}")
"""An id from outside goes into headers and logs, so only harmless ones are taken over."""

HEALTH = ("/healthz", "/readyz")
"""Asked every few seconds by machines; the answer is no news for people."""


class RequestContext:
    """ASGI middleware: ``request.state.request_id``, the header X-Request-ID, and a JSON line for each answer."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one connection event of the server."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        given = Headers(scope=scope).get("x-request-id", "")
        request_id = given if _SAFE_ID.fullmatch(given) else uuid.uuid4().hex
        state = scope.setdefault("state", {})
        state["request_id"] = request_id
        begun = time.monotonic()
        status = 499  # the client went away before there was an answer
        sent = 0

        async def send_with_id(message: Message) -> None:
            nonlocal status, sent
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)["X-Request-ID"] = request_id
            sent += len(message.get("body", b""))
            await send(message)

        try:
            await self._app(scope, receive, send_with_id)
        finally:
            line = {
                "request_id": request_id,
                "method": scope["method"],
                "path": scope["path"],
                "status": status,
                "code": state.get("code"),
                "ms": round(1000 * (time.monotonic() - begun), 1),
                "bytes_in": state.get("bytes_in", 0),
                "bytes_out": sent,
            }
            _log.log(logging.DEBUG if scope["path"] in HEALTH else logging.INFO, json.dumps(line))
