from __future__ import annotations

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from starlette.datastructures import Headers

from service.errors import RequestError
from service.negotiation import check_content, choose_format

JSON, SVG = "application/json", "image/svg+xml"


@pytest.mark.parametrize(
    ("accept", "chosen"),
    [
        ("*/*", "json"),
        ("", "json"),
        (JSON, "json"),
        (SVG, "svg"),
        ("image/*", "svg"),
        ("application/*", "json"),
        (f"{SVG}, {JSON}", "json"),
        (f"{SVG}, {JSON};q=0.9", "svg"),
        (f"{JSON};q=0.2, {SVG};q=0.3", "svg"),
        (f"text/html, */*;q=0.1, {SVG};q=0.5", "svg"),
        (f"*/*, {JSON};q=0", "svg"),
        ("IMAGE/SVG+XML", "svg"),
        (f"{SVG};q=abc", "svg"),
        (f"{JSON}; charset=utf-8", "json"),
    ],
)
def test_the_format_that_is_liked_best(accept: str, chosen: str) -> None:
    assert choose_format(accept) == chosen


@pytest.mark.parametrize("accept", ["text/html", "text/*, image/png", "*/*;q=0", f"{JSON};q=0, {SVG};q=0.0"])
def test_no_format_is_liked(accept: str) -> None:
    with pytest.raises(RequestError, match="image/svg") as refusal:
        choose_format(accept)
    assert refusal.value.code == "not-acceptable"


@given(st.text(st.characters(codec="latin-1"), max_size=60), st.text(st.characters(codec="latin-1"), max_size=60))
def test_any_header_is_read_or_refused(accept: str, content_type: str) -> None:
    for call in (lambda: choose_format(accept), lambda: check_content(Headers({"content-type": content_type}))):
        with contextlib.suppress(RequestError):
            call()
