"""JSON read where memory may be denied.

The reader (orjson 3.13) answers a failed allocation of its own buffer with a complaint about the text, and does not survive one
for an object of the result. So what a text may take is asked for before it is read.
"""

from __future__ import annotations

import mmap
from typing import Any

import orjson

SMALL_BYTES = 64 * 1024
"""Below this a text is read without asking."""

DENIED = "memory"
"""A word of the reader's complaint that says it was not the text."""


def loads(text: bytes) -> Any:
    """What JSON text says.

    Raises
    ------
    orjson.JSONDecodeError
        It is not JSON.
    MemoryError
        There may not be enough to read it.
    """
    if len(text) > SMALL_BYTES:
        _ask_for(most_bytes(text))
    try:
        return orjson.loads(text)
    except orjson.JSONDecodeError as error:
        if DENIED in error.msg:
            raise MemoryError from None
        raise


def most_bytes(text: bytes) -> int:
    """What reading a text may take at most, the reader's own buffers included: bytes by the signs that begin a value."""
    lists, objects, strings = text.count(b"["), text.count(b"{"), text.count(b'"') // 2
    values = lists + objects + strings + text.count(b",") + 1
    return 2 * len(text) + 72 * values + 64 * lists + 240 * objects + 64 * strings


def _ask_for(size: int) -> None:
    """Claim address space and give it back."""
    try:
        mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS).close()
    except OSError:
        raise MemoryError from None
