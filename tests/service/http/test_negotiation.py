from __future__ import annotations

import contextlib
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from starlette.datastructures import Headers

from service.errors import RequestError
from service.http.negotiation import FORMATS, check_content, choose_format

JSON, GEOJSON, SVG, DXF = "application/json", "application/geo+json", "image/svg+xml", "image/vnd.dxf"


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
        (f"*/*, {JSON};q=0", "geojson"),
        ("IMAGE/SVG+XML", "svg"),
        (f"{SVG};q=abc", "svg"),
        (f"{JSON}; charset=utf-8", "json"),
        (GEOJSON, "geojson"),
        (f"application/*;q=0.5, {GEOJSON}", "geojson"),
        (DXF, "dxf"),
        (f"image/*, {SVG};q=0.1", "dxf"),
    ],
)
def test_the_format_that_is_liked_best(accept: str, chosen: str) -> None:
    assert choose_format(None, accept) == chosen


@pytest.mark.parametrize("name", FORMATS)
def test_the_parameter_goes_before_the_header(name: str) -> None:
    assert choose_format(name, "text/html") == name


def test_a_route_offers_what_it_offers() -> None:
    assert choose_format(None, f"{GEOJSON}, {SVG};q=0.5", ("json", "svg")) == "svg"
    assert choose_format(None, "image/*", ("json", "dxf")) == "dxf"
    with pytest.raises(RequestError, match=re.escape("application/json; or choose by ?f=json")) as refusal:
        choose_format(None, GEOJSON, ("json",))
    assert refusal.value.code == "not-acceptable"


@pytest.mark.parametrize("asked", ["", "xml", "JSON", "geojson"])
def test_a_format_that_is_not_offered(asked: str) -> None:
    with pytest.raises(RequestError, match="json, svg") as refusal:
        choose_format(asked, "*/*", ("json", "svg"))
    assert refusal.value.code == "invalid-parameter"


@pytest.mark.parametrize("accept", ["text/html", "text/*, image/png", "*/*;q=0", "application/*;q=0, image/*;q=0.0"])
def test_no_format_is_liked(accept: str) -> None:
    with pytest.raises(RequestError, match="image/svg") as refusal:
        choose_format(None, accept)
    assert refusal.value.code == "not-acceptable"


@given(st.text(st.characters(codec="latin-1"), max_size=60), st.text(st.characters(codec="latin-1"), max_size=60))
def test_any_header_is_read_or_refused(accept: str, content_type: str) -> None:
    for call in (lambda: choose_format(None, accept), lambda: check_content(Headers({"content-type": content_type}))):
        with contextlib.suppress(RequestError):
            call()
