"""What a client may send and ask for, by the headers of RFC 9110."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Literal

from starlette.datastructures import Headers

from service.errors import RequestError

Format = Literal["json", "geojson", "svg", "dxf", "msgpack"]

FORMATS: dict[Format, str] = {
    "json": "application/json",
    "geojson": "application/geo+json",
    "svg": "image/svg+xml",
    "dxf": "image/vnd.dxf",
    "msgpack": "application/vnd.msgpack",
}
"""The formats in the order of preference where a client has none; a route may offer some of them only."""

WITH_PRECISION: tuple[Format, ...] = ("json", "geojson", "msgpack")
"""The formats whose coordinates can be rounded; the numbers of a drawing are its writer's own."""

PRECISION_RANGE = (3, 15)
"""Significant digits of coordinates: fewer are no shape any more, more are not in every double."""

CODINGS = ("gzip", "x-gzip")
"""The content coding that is read and written, by both of its names (RFC 9110, 8.4.1.3)."""

_JSON = re.compile(r"application/(json|[^/]+\+json)")
_QUALITY = re.compile(r"0(\.\d{0,3})?|1(\.0{0,3})?")
_PARAMETER = re.compile(r';\s*([^\s=;,"]+)\s*=\s*("(?:[^"\\]|\\.)*"|[^;]*)')


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


def check_precision(precision: int | None, form: Format) -> None:
    """Refuse a precision for a format that has none; its range is the route's to check.

    Raises
    ------
    RequestError
        ``invalid-parameter``.
    """
    if precision is not None and form not in WITH_PRECISION:
        detail = f"precision: the format {form} has none; it goes with {', '.join(WITH_PRECISION)}."
        raise RequestError("invalid-parameter", detail)


def accepts_gzip(accept_encoding: str) -> bool:
    """Whether a client takes gzip and does not like the plain answer better."""
    qualities = {name: _number(values.get("q", "1")) for name, values in map(_parameters, accept_encoding.split(","))}
    wanted = max((qualities[name] for name in CODINGS if name in qualities), default=qualities.get("*", 0.0))
    return wanted > 0 and wanted >= qualities.get("identity", 0.0)


def check_content(headers: Headers) -> bool:
    """Refuse a body that is declared as something else than JSON in UTF-8, plain or compressed by gzip.

    Returns
    -------
    bool
        Whether it is compressed.

    Raises
    ------
    RequestError
        ``unsupported-media-type``.
    """
    compressed = check_coding(headers)
    if "content-type" in headers:
        media_type, parameters = _parameters(headers["content-type"])
        if not _JSON.fullmatch(media_type):
            raise RequestError("unsupported-media-type", "Send it with 'Content-Type: application/json'.")
        if parameters.get("charset", "utf-8").lower() not in ("utf-8", "utf8", "us-ascii"):
            raise RequestError("unsupported-media-type", "JSON is UTF-8; send it so, without another charset.")
    return compressed


def check_coding(headers: Headers) -> bool:
    """Whether a body is compressed by gzip. RequestError ``unsupported-media-type`` for any other coding."""
    coding = headers.get("content-encoding", "identity").strip().lower()
    if coding not in ("", "identity", *CODINGS):
        refuse = {"Accept-Encoding": "gzip"}
        detail = f"Content-Encoding {coding[:40]!r}: send it as it is, or by gzip."
        raise RequestError("unsupported-media-type", detail, headers=refuse)
    return coding in CODINGS


def _parameters(value: str) -> tuple[str, dict[str, str]]:
    """``type/subtype; a=b`` taken apart, all but the values in small letters; in time proportional to its length."""
    head, _, _ = value.partition(";")
    found = _PARAMETER.findall(value[len(head) :])
    return head.strip().lower(), {name.lower(): content.strip().strip('"') for name, content in found}


def _quality(media_type: str, ranges: list[tuple[str, dict[str, str]]]) -> float:
    """The quality that the most specific matching range gives to a media type; 0 when none matches."""
    wildcards = (media_type, media_type.split("/")[0] + "/*", "*/*")
    for wanted in wildcards:
        for pattern, parameters in ranges:
            if pattern == wanted:
                return _number(parameters.get("q", "1"))
    return 0.0


def _number(text: str) -> float:
    """A quality value (RFC 9110, 12.4.2); what is none counts as 1."""
    return float(text) if _QUALITY.fullmatch(text) else 1.0
