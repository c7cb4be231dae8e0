from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.http.trace_context import TraceContext

TRACE, SPAN = "0af7651916cd43dd8448eb211c80319c", "b7ad6b7169203331"
HEADER = re.compile(r"00-[0-9a-f]{32}-[0-9a-f]{16}-0[0-3]")


@pytest.mark.parametrize(
    ("header", "flags"),
    [
        (f"00-{TRACE}-{SPAN}-01", 1),
        (f"00-{TRACE}-{SPAN}-00", 0),
        (f"00-{TRACE}-{SPAN}-ff", 3),
        (f" 00-{TRACE}-{SPAN}-02 ", 2),
        (f"01-{TRACE}-{SPAN}-01", 1),
        (f"cc-{TRACE}-{SPAN}-01-what-the-future-will-be-like", 1),
    ],
)
def test_a_trace_is_carried_on(header: str, flags: int) -> None:
    context = TraceContext.of(header)
    assert (context.trace_id, context.parent_id, context.flags) == (TRACE, SPAN, flags)
    assert context.span_id != SPAN
    assert HEADER.fullmatch(context.header)
    assert context.header.startswith(f"00-{TRACE}-{context.span_id}-")


@pytest.mark.parametrize(
    "header",
    [
        "",
        "nonsense",
        f"ff-{TRACE}-{SPAN}-01",
        f"00-{TRACE}-{SPAN}-01-more",
        f"00-{TRACE}-{SPAN}-01.",
        f"cc-{TRACE}-{SPAN}-01.more",
        f"00-{TRACE.upper()}-{SPAN}-01",
        f"00-{'0' * 32}-{SPAN}-01",
        f"00-{TRACE}-{'0' * 16}-01",
        f"00-{TRACE}-{SPAN}",
        f"00-{TRACE}-{SPAN}-1",
        f"00-{TRACE[:-1]}g-{SPAN}-01",
        f"0-{TRACE}-{SPAN}-01",
        f"00-{TRACE}-{SPAN}-01, 00-{TRACE}-{SPAN}-01",
    ],
)
def test_an_invalid_one_is_ignored_and_a_new_trace_begun(header: str) -> None:
    context = TraceContext.of(header)
    assert context.trace_id != TRACE
    assert (context.parent_id, context.flags) == (None, 0)
    assert HEADER.fullmatch(context.header)


@given(st.text(st.characters(codec="latin-1"), max_size=80))
def test_any_header(header: str) -> None:
    assert HEADER.fullmatch(TraceContext.of(header).header)
