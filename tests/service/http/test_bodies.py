"""How bodies are received: what is waited for, and for how long."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest
from starlette.requests import Request

from service.errors import RequestError
from service.http.bodies import LEAST_RATE, read_body
from service.http.traffic import Load, Traffic
from service.settings import Settings

LIMIT = 10 * LEAST_RATE


def received(pieces: list[bytes], pause: float, upload_seconds: float, limit: int = LIMIT) -> bytes:
    """The body of a request whose pieces come after a pause each."""
    left = list(pieces)

    async def receive() -> dict[str, Any]:
        await asyncio.sleep(pause)
        piece = left.pop(0)
        return {"type": "http.request", "body": piece, "more_body": bool(left)}

    app = SimpleNamespace(state=SimpleNamespace(settings=Settings(upload_seconds=upload_seconds)))
    state = {"load": Load(Traffic(limit))}
    request = Request({"type": "http", "headers": [], "method": "POST", "app": app, "state": state}, receive)
    return asyncio.run(read_body(request, limit, compressed=False))


def test_a_body_comes_whole() -> None:
    assert received([b"ab", b"", b"c"], 0.0, 5.0) == b"abc"


def test_one_that_trickles_is_given_up() -> None:
    with pytest.raises(RequestError) as refusal:
        received([b"x"] * 1000, 0.02, 0.2)
    assert refusal.value.code == "upload-timeout"
    assert refusal.value.headers == {"Connection": "close"}


def test_what_comes_buys_time() -> None:
    body = [bytes(LEAST_RATE)] * 5  # five seconds more
    assert received(body, 0.1, 0.3) == bytes(5 * LEAST_RATE)


def test_more_than_the_limit_is_refused_whatever_was_promised() -> None:
    with pytest.raises(RequestError) as refusal:
        received([bytes(LIMIT), b"x"], 0.0, 5.0)
    assert refusal.value.code == "body-too-large"
