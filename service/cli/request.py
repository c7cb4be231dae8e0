"""What the command line asks of a domain, put into the document that the workers read."""

from __future__ import annotations

import argparse
import json
from pathlib import PurePath
from typing import Any

from service.cli.arguments import FORMATS
from service.cli.exits import USAGE, Failure
from service.cli.files import PACKED

OPTIONS = ("tolerance", "method", "step", "smooth_angle", "samples")


def header(asked: argparse.Namespace, form: str) -> dict[str, Any]:
    """What the worker is told besides the body."""
    told: dict[str, Any] = {"operation": operation(asked, form), "format": form}
    if asked.precision is not None:
        from service.http.negotiation import WITH_PRECISION

        if form not in WITH_PRECISION:
            raise Failure(USAGE, f"--precision goes with {', '.join(WITH_PRECISION)}, not with {form}")
        told["precision"] = asked.precision
    return told


def operation(asked: argparse.Namespace, form: str) -> str:
    """The operation asked for, if there is one of that name that has answers in this format."""
    from service.operations import OPERATIONS

    name: str = asked.operation
    if name not in OPERATIONS:
        raise Failure(USAGE, f"there is no operation {name!r}; there are {', '.join(OPERATIONS)}")
    if form not in OPERATIONS[name].formats:
        raise Failure(USAGE, f"{name} is answered in {', '.join(OPERATIONS[name].formats)}, not in {form}")
    return name


def form_of(asked: argparse.Namespace) -> str:
    """The format asked for, or the one that the output's name tells."""
    if asked.format is not None:
        return str(asked.format)
    suffix = PurePath(asked.output.removesuffix(PACKED)).suffix.removeprefix(".").lower()
    return suffix if suffix in FORMATS else "json"


def additions(asked: argparse.Namespace) -> dict[str, Any]:
    """The members that go before the document's own: ``options`` and ``arguments``, as far as given."""
    members: dict[str, Any] = {}
    options = {name: value for name in OPTIONS if (value := getattr(asked, name)) is not None}
    if options:
        members["options"] = options
    if asked.arguments is not None:
        try:
            members["arguments"] = json.loads(asked.arguments)
        except ValueError as error:
            raise Failure(USAGE, f"--arguments is not JSON: {error}") from error
        if not isinstance(members["arguments"], dict):
            raise Failure(USAGE, "--arguments must be a JSON object, such as '{\"distance\": 0.2}'")
    return members


def with_additions(body: bytes, members: dict[str, Any]) -> bytes:
    """A document with members added; one that cannot be read stays as it is, for its reader to refuse."""
    if not members:
        return body
    import orjson

    try:
        document = orjson.loads(body)
    except orjson.JSONDecodeError:
        return body
    if not isinstance(document, dict):
        return body
    for name, added in members.items():
        own = document.get(name)
        document[name] = {**own, **added} if isinstance(own, dict) else added
    return orjson.dumps(document)
