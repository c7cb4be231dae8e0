"""How answers leave."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from service.http.responses import InPieces


@pytest.mark.parametrize("pieces", [(), (b"abc",), (b"abc", b"d" * 1000, b"e")])
def test_an_answer_leaves_in_the_pieces_that_it_came_in(pieces: tuple[bytes, ...]) -> None:
    sent: list[Any] = []

    async def send(message: Any) -> None:
        sent.append(message)

    asyncio.run(InPieces(pieces, {"ETag": "x"}, "application/json")({}, send, send))  # type: ignore[arg-type]
    start, *messages = sent
    headers = dict(start["headers"])
    size = str(sum(map(len, pieces))).encode()
    assert (start["status"], headers[b"content-length"], headers[b"etag"]) == (200, size, b"x")
    assert [message["body"] for message in messages] == list(pieces or (b"",))
    assert [message["more_body"] for message in messages] == [True] * (len(messages) - 1) + [False]
