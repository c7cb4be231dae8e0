"""How answers leave."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from service.responses import PIECE_BYTES, InPieces


@pytest.mark.parametrize("size", [0, 1, PIECE_BYTES, PIECE_BYTES + 1, 5 * PIECE_BYTES - 1])
def test_a_large_answer_leaves_in_pieces_and_arrives_whole(size: int) -> None:
    body = bytes(range(256)) * (size // 256 + 1)
    body = body[:size]
    sent: list[Any] = []

    async def send(message: Any) -> None:
        sent.append(message)

    asyncio.run(InPieces(body, headers={"ETag": "x"}, media_type="application/json")({}, send, send))  # type: ignore[arg-type]
    start, *pieces = sent
    headers = dict(start["headers"])
    assert (start["status"], headers[b"content-length"], headers[b"etag"]) == (200, str(size).encode(), b"x")
    assert b"".join(piece["body"] for piece in pieces) == body
    assert [piece["more_body"] for piece in pieces] == [True] * (len(pieces) - 1) + [False]
    assert len(pieces) == max(1, -(-size // PIECE_BYTES))
