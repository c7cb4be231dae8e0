"""Bodies of requests as they come: counted, expanded, and not waited for beyond their time.

A body that comes at LEAST_RATE is waited for as long as it lasts; a slower one, or one that stops, for MAT_UPLOAD_SECONDS. So a
client that sends a byte now and then is told to go, and a slow line may still send a batch of a gigabyte.
"""

from __future__ import annotations

import asyncio
import io
import time
from collections.abc import AsyncIterator

from fastapi import Request
from starlette.requests import ClientDisconnect

from service.errors import RequestError
from service.http.compression import expanded
from service.http.patience import LEAST_RATE, Patience
from service.settings import Settings

LONGEST_LENGTH = 18
"""Digits of a Content-Length that is believed; any other body is counted as it comes."""

_CLOSE = {"Connection": "close"}
"""What is still to come of the body is not wanted."""


def announced_bytes(request: Request) -> int:
    """The size of the body as its header has it; 0 where it says nothing."""
    announced = request.headers.get("content-length", "")
    return int(announced) if announced.isascii() and announced.isdigit() and len(announced) <= LONGEST_LENGTH else 0


async def read_body(request: Request, limit: int, compressed: bool) -> bytes:
    """All of the body, expanded if need be. RequestError as of `arriving`, and ``queue-full`` where there is no memory for it."""
    body = io.BytesIO()  # which gives away what it gathered without copying it
    async for piece in arriving(request, limit, compressed):
        request.state.load.add(len(piece))
        body.write(piece)
    return body.getvalue()


def arriving(request: Request, limit: int, compressed: bool) -> AsyncIterator[bytes]:
    """The body as it comes, expanded if need be.

    Its bytes are counted, whatever its header promises; those that it expands to are counted, too.

    Raises
    ------
    RequestError
        ``body-too-large`` as soon as that is known, ``upload-timeout``, ``not-gzip``.
    """
    pieces = _arriving(request, limit)
    return expanded(pieces, limit) if compressed else pieces


async def _arriving(request: Request, limit: int) -> AsyncIterator[bytes]:
    """The bytes that are sent."""
    too_large = RequestError("body-too-large", f"The limit is {limit} bytes.", headers=_CLOSE)
    if announced_bytes(request) > limit:
        raise too_large
    settings: Settings = request.app.state.settings
    patience = Patience(settings.upload_seconds)
    request.state.bytes_in = 0
    more = True
    while more:
        asked = time.monotonic()
        try:
            async with asyncio.timeout(patience.left):
                message = await request.receive()
        except TimeoutError:
            detail = f"It came at less than {LEAST_RATE} bytes a second, and was waited for {settings.upload_seconds:g} s."
            raise RequestError("upload-timeout", detail, headers=_CLOSE) from None
        if message["type"] == "http.disconnect":
            raise ClientDisconnect
        piece, more = message.get("body", b""), message.get("more_body", False)
        patience.waited(time.monotonic() - asked, len(piece))
        request.state.bytes_in += len(piece)
        if request.state.bytes_in > limit:
            raise too_large
        yield piece
