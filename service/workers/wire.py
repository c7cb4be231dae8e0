"""How the web process and a worker talk: messages over a Unix stream socket.

::

    | header bytes, u32 | body bytes, u64 | header (JSON) | body (as it came or as it leaves) |

A new worker begins with ``{"rehearsed_seconds": ...}``: the processor time that it took to get ready. A request is one message.
Its answer may be several: any number of reports (``{"stage", "fraction"}``) or, while it works on a chunk of a batch, of signs of
life (an empty header), then a last message, whose header has ``resident_bytes`` and ``served`` and says how the request went.

The body is never copied into the header, so a worker's encoded answer goes out to the client byte for byte. No pickle:
a message can carry nothing that runs.
"""

from __future__ import annotations

import socket
import struct
from typing import Any

import orjson

FRAME = struct.Struct("!IQ")

Header = dict[str, Any]

REHEARSED = "rehearsed_seconds"
"""The one member of a new worker's first header."""

JOINED_BYTES = 64 * 1024
"""Longest body that goes out with its head in one call, so that the other side wakes up once."""


def pack(header: Header, body_bytes: int) -> bytes:
    """What goes before a body of so many bytes: prefix and header."""
    text = orjson.dumps(header, option=orjson.OPT_SERIALIZE_NUMPY)
    return FRAME.pack(len(text), body_bytes) + text


def send(channel: socket.socket, header: Header, body: bytes = b"") -> None:
    """Write one message to a blocking socket."""
    head = pack(header, len(body))
    if len(body) <= JOINED_BYTES:
        channel.sendall(head + body)
    else:
        channel.sendall(head)
        channel.sendall(body)


def receive(channel: socket.socket) -> tuple[Header, bytes] | None:
    """Read one message from a blocking socket; None when the other side has closed it."""
    prefix = _exactly(channel, FRAME.size)
    if prefix is None:
        return None
    header_size, body_size = FRAME.unpack(prefix)
    header = _exactly(channel, header_size)
    body = _exactly(channel, body_size)
    if header is None or body is None:
        return None
    return orjson.loads(header), bytes(body)


def _exactly(channel: socket.socket, size: int) -> bytearray | None:
    """`size` bytes, or None if the stream ends before them."""
    buffer = bytearray(size)
    view = memoryview(buffer)
    filled = 0
    while filled < size:
        count = channel.recv_into(view[filled:])
        if count == 0:
            return None
        filled += count
    return buffer
