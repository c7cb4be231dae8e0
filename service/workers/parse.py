"""JSON as it comes from outside: strict, but with the numbers that are none found and named."""

from __future__ import annotations

import json
from typing import Any

import orjson

from service.errors import RequestError
from service.workers.safe_json import loads


def parse(body: bytes) -> tuple[Any, RequestError | None]:
    """What a body says, and what is wrong with it as JSON.

    NaN and Infinity are not JSON, but the likely slip of a program that wrote the body; so they are read, and reported
    like every other fault of the domain with the place where they stand.
    """
    try:
        return loads(body), None
    except orjson.JSONDecodeError as error:
        strict_error = _not_json(error)
        return _with_non_finite_numbers(body, strict_error), strict_error


def _not_json(error: orjson.JSONDecodeError) -> RequestError:
    place = {"line": error.lineno, "column": error.colno}
    return RequestError("not-json", f"Line {error.lineno}, column {error.colno}: {error.msg}.", place)


def _with_non_finite_numbers(body: bytes, strict_error: RequestError) -> Any:
    """Read a body again with NaN, Infinity and overflow allowed; raise `strict_error` where that is not all."""
    if b"NaN" not in body and b"Infinity" not in body and "infinity" not in strict_error.detail:
        raise strict_error
    try:
        return json.loads(body, parse_int=_integer)
    except (ValueError, RecursionError):
        raise strict_error from None


def _integer(digits: str) -> int | float:
    """An integer as the strict reader takes it: what does not fit 64 bits becomes a float."""
    return int(digits) if len(digits) < 19 else float(digits)
