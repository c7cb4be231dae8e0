"""What a client may send and ask for, by the headers of RFC 9110."""

from __future__ import annotations

import re
from collections.abc import Sequence
from email.message import Message
from typing import Literal

from starlette.datastructures import Headers

from service.errors import RequestError

Format = Literal["json", "geojson", "svg", "dxf"]

FORMATS: dict[Format, str] = {
    "json": "application/json",
    "geojson": "application/geo+json",
    "svg": "image/svg+xml",
    "dxf": "image/vnd.dxf",
}
"""The formats in the order of preference where a client has none; a route may offer some of them only."""

_JSON = re.compile(r"application/(json|[^/]+\+json)")


def choose_format(asked: str | None, accept: str, offered: Sequence[Format] = tuple(FORMATS)) -> Format:
    """The format of an answer.

    Parameters
    ----------
    asked : str or None
        The parameter f, which goes before the header.
    accept : str
        The Accept header; the format that it likes best is taken, the earlier one where it is indifferent.
    offered : sequence of str
        The formats of the route.

    Raises
    ------
    RequestError
        ``invalid-parameter`` for an f that is not offered, ``not-acceptable`` when the header excludes every format.
    """
    if asked is not None:
        for name in offered:
            if name == asked:
                return name
        raise RequestError("invalid-parameter", f"f: available here are {', '.join(offered)}.")
    ranges = [_parameters(part) for part in accept.split(",") if part.strip()]
    qualities = {name: _quality(FORMATS[name], ranges) for name in offered}
    best = max(qualities, key=lambda name: qualities[name])
    if ranges and qualities[best] <= 0:
        types = ", ".join(FORMATS[name] for name in offered)
        raise RequestError("not-acceptable", f"Available here: {types}; or choose by ?f={'|'.join(offered)}.")
    return best


def check_content(headers: Headers) -> None:
    """Refuse a body that is declared as something else than plain JSON in UTF-8.

    Raises
    ------
    RequestError
        ``unsupported-media-type``.
    """
    coding = headers.get("content-encoding", "identity").strip().lower()
    if coding not in ("", "identity"):
        refuse = {"Accept-Encoding": "identity"}
        raise RequestError("unsupported-media-type", f"Content-Encoding {coding!r}: send it as it is.", headers=refuse)
    if "content-type" not in headers:
        return
    media_type, parameters = _parameters(headers["content-type"])
    if not _JSON.fullmatch(media_type):
        raise RequestError("unsupported-media-type", "Send the domain with 'Content-Type: application/json'.")
    if parameters.get("charset", "utf-8").lower() not in ("utf-8", "utf8", "us-ascii"):
        raise RequestError("unsupported-media-type", "JSON is UTF-8; send it so, without another charset.")


def _parameters(value: str) -> tuple[str, dict[str, str]]:
    """``type/subtype; a=b`` taken apart, the type in small letters."""
    message = Message()
    message["content-type"] = value.replace("\r", " ").replace("\n", " ")
    pairs = message.get_params(failobj=[])
    media_type = pairs[0][0].strip().lower() if pairs else ""
    return media_type, {name.lower(): content for name, content in pairs[1:]}


def _quality(media_type: str, ranges: list[tuple[str, dict[str, str]]]) -> float:
    """The quality that the most specific matching range gives to a media type; 0 when none matches."""
    wildcards = (media_type, media_type.split("/")[0] + "/*", "*/*")
    for wanted in wildcards:
        for pattern, parameters in ranges:
            if pattern == wanted:
                return _number(parameters.get("q", "1"))
    return 0.0


def _number(text: str) -> float:
    """A quality value; one that cannot be read counts as 1."""
    try:
        return min(max(float(text), 0.0), 1.0)
    except ValueError:
        return 1.0
