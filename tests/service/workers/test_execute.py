"""The frame of an execute request."""

from __future__ import annotations

import base64
import contextlib
import json
from typing import Any

import pytest
from hypothesis import given

from service.errors import RequestError
from service.workers.execute import unwrap, wrap
from tests.service.domains import anything

OFFERED = {"application/json": "json", "image/svg+xml": "svg"}


def refused(content: Any) -> dict[str, str]:
    """Pointers and messages of a refusal."""
    with pytest.raises(RequestError) as refusal:
        unwrap(content, OFFERED)
    assert refusal.value.code == "invalid-domain"
    return {problem["pointer"]: problem["message"] for problem in refusal.value.extra["problems"]}


def test_inputs_as_they_are_and_with_their_values() -> None:
    frame = unwrap({"inputs": {"outer": [1], "options": {"value": {"step": 2}}, "arguments": {"limit": 3}}}, OFFERED)
    assert frame.body == {"outer": [1], "options": {"step": 2}, "arguments": {"limit": 3}}
    assert (frame.form, frame.whole) == (None, False)


def test_places_are_those_of_the_request() -> None:
    frame = unwrap({"inputs": {"outer": [], "options": {"value": {}}}}, OFFERED)
    places = {"": "/inputs", "/outer/0": "/inputs/outer/0", "/options/step": "/inputs/options/value/step"}
    assert {pointer: frame.place(pointer) for pointer in places} == places


@pytest.mark.parametrize(
    ("outputs", "form"),
    [
        (None, None),
        ({}, None),
        ({"result": {}}, None),
        ({"result": None}, None),
        ({"result": {"transmissionMode": "value"}}, None),
        ({"result": {"format": {"mediaType": "image/svg+xml"}}}, "svg"),
    ],
)
def test_the_format_of_the_output(outputs: Any, form: str | None) -> None:
    assert unwrap({"inputs": {}, "outputs": outputs, "response": "document"}, OFFERED).form == form


@pytest.mark.parametrize(
    ("content", "pointer"),
    [
        (None, ""),
        ([], ""),
        ({}, ""),
        ({"inputs": 3}, "/inputs"),
        ({"outer": []}, "/inputs"),
        ({"inputs": {}, "subscriber": {}}, "/subscriber"),
        ({"inputs": {}, "a/b~c": 1}, "/a~1b~0c"),
        ({"inputs": {}, "response": "pretty"}, "/response"),
        ({"inputs": {"outer": {"href": "http://example.org"}}}, "/inputs/outer"),
        ({"inputs": {}, "outputs": []}, "/outputs"),
        ({"inputs": {}, "outputs": {"axis": {}}}, "/outputs"),
        ({"inputs": {}, "outputs": {"result": 3}}, "/outputs/result"),
        ({"inputs": {}, "outputs": {"result": {"schema": {}}}}, "/outputs/result"),
        ({"inputs": {}, "outputs": {"result": {"transmissionMode": "reference"}}}, "/outputs/result/transmissionMode"),
        ({"inputs": {}, "outputs": {"result": {"format": {"mediaType": "text/html"}}}}, "/outputs/result/format/mediaType"),
        ({"inputs": {}, "outputs": {"result": {"format": {"mediaType": []}}}}, "/outputs/result/format/mediaType"),
        ({"inputs": {}, "outputs": {"result": {"format": 3}}}, "/outputs/result/format/mediaType"),
    ],
)
def test_what_is_refused_is_named(content: Any, pointer: str) -> None:
    assert pointer in refused(content)


def test_all_problems_of_the_frame_come_together() -> None:
    assert set(refused({"x": 1, "response": 2, "outputs": 3})) == {"/inputs", "/x", "/response", "/outputs"}


@given(anything)
def test_anything_is_read_or_refused(content: Any) -> None:
    with contextlib.suppress(RequestError):
        unwrap(content, OFFERED)


def test_a_document_of_outputs() -> None:
    assert json.loads(wrap(b'{"a": 1}', "application/json")) == {"result": {"mediaType": "application/json", "value": {"a": 1}}}
    assert json.loads(wrap("<é>".encode(), "image/svg+xml")) == {"result": {"mediaType": "image/svg+xml", "value": "<é>"}}
    packed = json.loads(wrap(b"\x81\xff", "application/vnd.msgpack"))["result"]
    assert packed["encoding"] == "base64"
    assert base64.b64decode(packed["value"]) == b"\x81\xff"
