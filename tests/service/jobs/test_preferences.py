from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.http.preferences import Preferences, read_preferences

NOTHING = Preferences()


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([], NOTHING),
        ([""], NOTHING),
        (["respond-async"], Preferences(True)),
        (["Respond-Async"], Preferences(True)),
        (["respond-async, wait=10"], Preferences(True, 10)),
        (["respond-async", "wait=10"], Preferences(True, 10)),
        (["wait=10"], Preferences(False, 10)),
        (['wait="10"'], Preferences(False, 10)),
        (["wait = 10"], Preferences(False, 10)),
        (["respond-async,wait=0"], Preferences(True, 0)),
        (["wait=3, wait=9"], Preferences(False, 3)),
        (['return=minimal; note="a, respond-async", respond-async; x=1'], Preferences(True)),
        (["handling=strict, unknown, respond-async"], Preferences(True)),
    ],
)
def test_what_is_preferred(values: list[str], expected: Preferences) -> None:
    assert read_preferences(values) == expected


@pytest.mark.parametrize(
    "value",
    [
        *("wait", "wait=", "wait=-1", "wait=1.5", "wait=ten", "wait=0", "wait=99999999999999999999", "wait=1 0"),
        *("respond-async=yes", "respond async", "respond-async wait=3", '"respond-async"', ",,;;=", '"', "é=1"),
    ],
)
def test_what_is_not_understood_is_passed_over(value: str) -> None:
    assert read_preferences([value]) == NOTHING


@given(st.text(max_size=200))
def test_no_header_does_harm(value: str) -> None:
    read_preferences([value])


def test_only_what_was_honoured_is_told() -> None:
    assert NOTHING.headers == {}
    assert Preferences(True, 5).headers == {"Preference-Applied": "respond-async, wait=5"}
    assert Preferences(False, 5).headers == {"Preference-Applied": "wait=5"}
