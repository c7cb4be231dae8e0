"""The execute request of OGC API - Processes around a domain, taken off before solving and put on after.

``{"inputs": {...}, "outputs": {"result": {"format": {"mediaType": ...}}}, "response": "raw" | "document"}``: the inputs are the
members of the body of the route below /v1; one that is an object may, and by the letter of the standard must, be written as
``{"value": {...}}``. Read in the worker, so that no large body is ever parsed on the event loop.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import orjson

from service.errors import RequestError

OUTPUT = "result"
"""The one output of every process."""

MEMBERS = ("inputs", "outputs", "response")

Json = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Execute:
    """What an execute request asks.

    Attributes
    ----------
    body : dict
        The body of the route below /v1.
    form : str or None
        The format of the output, where the request names one.
    whole : bool
        True: all outputs in one JSON document; False: the output as it is.
    qualified : frozenset of str
        Inputs that came as ``{"value": ...}``.
    """

    body: Json
    form: str | None
    whole: bool
    qualified: frozenset[str]

    def relocate(self, problems: list[Json]) -> None:
        """Make the places of problems those of the request that the body came in."""
        for problem in problems:
            for member in ("pointer", "other"):
                if problem.get(member) is not None:
                    problem[member] = self.place(problem[member])

    def place(self, pointer: str) -> str:
        """A JSON pointer into `body` as one into the request."""
        name = pointer.split("/")[1] if pointer else ""
        return f"/inputs/{name}/value{pointer[len(name) + 1 :]}" if name in self.qualified else f"/inputs{pointer}"


def unwrap(content: Any, offered: Mapping[str, str]) -> Execute:
    """Take an execute request apart.

    Parameters
    ----------
    content : object
        What the JSON says.
    offered : mapping
        The format of each media type of the process.

    Raises
    ------
    RequestError
        ``invalid-domain`` with all problems of the frame.
    """
    problems: list[Json] = []

    def fault(pointer: str, message: str) -> None:
        problems.append({"code": "invalid-request", "pointer": pointer, "message": message})

    frame = content if isinstance(content, dict) else {}
    inputs = frame.get("inputs")
    if not isinstance(inputs, dict):
        fault("/inputs" if frame else "", 'give an execute request: an object with the member "inputs", an object')
    for name in frame.keys() - set(MEMBERS):
        fault(f"/{_token(name)}", f"unknown member; known are {', '.join(MEMBERS)}")
    response = frame.get("response", "raw")
    if response not in ("raw", "document"):
        fault("/response", "response must be raw or document")
    form = _form(frame.get("outputs"), offered, fault)
    body, qualified = {}, set()
    for name, value in (inputs if isinstance(inputs, dict) else {}).items():
        if isinstance(value, dict) and "href" in value:
            fault(f"/inputs/{_token(name)}", "this service fetches nothing: give the value itself")
        elif isinstance(value, dict) and "value" in value:
            qualified.add(name)
            body[name] = value["value"]
        else:
            body[name] = value
    if problems:
        raise RequestError("invalid-domain", f"{len(problems)} problems, see problems.", {"problems": problems})
    return Execute(body, form, response == "document", frozenset(qualified))


def _form(outputs: Any, offered: Mapping[str, str], fault: Any) -> str | None:
    """The format that the member ``outputs`` asks for."""
    if outputs is None:
        return None
    if not isinstance(outputs, dict) or outputs.keys() - {OUTPUT}:
        fault("/outputs", f"outputs must be an object; the one output is {OUTPUT}")
        return None
    asked = outputs.get(OUTPUT) or {}
    if not isinstance(asked, dict) or asked.keys() - {"format", "transmissionMode"}:
        fault(f"/outputs/{OUTPUT}", "known are format and transmissionMode")
        return None
    if asked.get("transmissionMode", "value") != "value":
        fault(f"/outputs/{OUTPUT}/transmissionMode", "outputs are sent by value")
    form = asked.get("format") or {}
    media_type = form.get("mediaType") if isinstance(form, dict) else form
    if media_type is None:
        return None
    if not isinstance(media_type, str) or media_type not in offered:
        fault(f"/outputs/{OUTPUT}/format/mediaType", f"available here are {', '.join(offered)}")
        return None
    return offered[media_type]


def wrap(content: bytes, media_type: str) -> bytes:
    """The document of all outputs, which are one: JSON as it is, text as a string, anything else in base64."""
    if media_type.endswith("json"):
        return b'{"%b":{"mediaType":"%b","value":%b}}' % (OUTPUT.encode(), media_type.encode(), content)
    value: Json = {"mediaType": media_type}
    try:
        value["value"] = content.decode("utf-8")
    except UnicodeDecodeError:
        value |= {"encoding": "base64", "value": base64.b64encode(content).decode("ascii")}
    return orjson.dumps({OUTPUT: value})


def _token(name: str) -> str:
    """A member's name in a JSON pointer (RFC 6901)."""
    return name.replace("~", "~0").replace("/", "~1")
