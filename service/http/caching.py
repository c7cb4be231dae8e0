"""What answers may be given again: entity tags, preconditions, and a small store of answers.

Solving is pure: the same body, operation, format, precision and versions give the same answer. So the tag of an answer is a
hash of these, known before anything is solved. It is a weak tag: the answer may come plain or compressed, and machines of
another make may differ in the last digit.

Preconditions follow RFC 9110, 13: an If-None-Match that names the tag gives 304 to GET and HEAD, and 412 to a POST. For a
POST the representation that is meant is the answer to this very request; 412 tells a client that what it has is current,
without solving again. If-Match compares strongly, so that no weak tag ever matches it: only ``*`` does.
"""

from __future__ import annotations

import asyncio
import hashlib
import re
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import orjson
from starlette.datastructures import Headers

from service.errors import RequestError
from service.workers.channel import Pieces

INLINE_BYTES = 256 * 1024
"""Bodies up to this are hashed at once, in a quarter of a millisecond; larger ones in a thread."""

LARGEST_SHARE = 4
"""An answer larger than one part in so many of the store is not kept: it would drive out all others."""

_TAG = re.compile(r'(W/)?("[\x21\x23-\x7e\x80-\xff]*")')


async def digest(body: bytes, **order: Any) -> str:
    """The hash of a body and of everything else that decides its answer."""
    state = hashlib.sha256(orjson.dumps(order, option=orjson.OPT_SORT_KEYS) + b"\n")
    if len(body) > INLINE_BYTES:
        await asyncio.to_thread(state.update, body)
    else:
        state.update(body)
    return state.hexdigest()


def tag(digest: str) -> str:
    """The entity tag of an answer."""
    return f'W/"{digest[:32]}"'


def content_tag(content: bytes) -> str:
    """The entity tag of a document that is at hand."""
    return tag(hashlib.sha256(content).hexdigest())


def unchanged(method: str, headers: Headers, current: str) -> bool:
    """Judge the preconditions of a request.

    Returns
    -------
    bool
        True where a GET or HEAD is to be answered 304.

    Raises
    ------
    RequestError
        ``precondition-failed``.
    """
    wanted = headers.get("if-match")
    if wanted is not None and wanted.strip() != "*":
        strong = [name for weak, name in _TAG.findall(wanted) if not weak]
        if current not in strong:
            raise RequestError("precondition-failed", "If-Match names no strong tag of this answer; it has none.")
    known = headers.get("if-none-match")
    if known is None:
        return False
    if known.strip() != "*" and current.removeprefix("W/") not in [name for _, name in _TAG.findall(known)]:
        return False
    if method in ("GET", "HEAD"):
        return True
    raise RequestError("precondition-failed", "If-None-Match names this very answer.", headers={"ETag": current})


@dataclass(frozen=True, slots=True)
class Kept:
    """An answer as it goes out."""

    pieces: Pieces
    headers: Mapping[str, str]
    media_type: str

    @property
    def size(self) -> int:
        """Bytes of the answer."""
        return sum(map(len, self.pieces))


class ResultCache:
    """The answers that were asked for last, up to a number of bytes.

    Only what is always so is kept: successes. A failure may come of the load, of a limit or of a defect.

    Parameters
    ----------
    limit : int
        Bytes of all answers together; 0: none are kept.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._kept: OrderedDict[tuple[str, bool], Kept] = OrderedDict()
        self._bytes = 0

    def get(self, digest: str, compressed: bool) -> Kept | None:
        """The answer to a request, if it is there, as a client that takes gzip or does not should have it."""
        key = (digest, compressed)
        if key in self._kept:
            self._kept.move_to_end(key)
        return self._kept.get(key)

    def put(self, digest: str, compressed: bool, answer: Kept) -> None:
        """Keep an answer, in the place of those that were not asked for in the longest time."""
        key, size = (digest, compressed), answer.size
        if key in self._kept or LARGEST_SHARE * size > self._limit:
            return
        self._kept[key] = answer
        self._bytes += size
        while self._bytes > self._limit:
            _, dropped = self._kept.popitem(last=False)
            self._bytes -= dropped.size
