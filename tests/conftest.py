"""Shared by all tests: hypothesis repeats the same examples everywhere, and every shape is solved once."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

Json = dict[str, Any]

# A shell starts a command in the background with Ctrl-C ignored; what the tests start would ignore it, too.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

_slow = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much]
settings.register_profile(
    "steady", derandomize=True, deadline=None, database=None, print_blob=True, suppress_health_check=_slow
)
settings.register_profile("search", max_examples=2000, deadline=None, print_blob=True, suppress_health_check=_slow)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "steady"))


@pytest.fixture(scope="session")
def solve() -> Callable[..., Json]:
    """The answer document of a JSON domain; the same question is asked once in a session."""
    from mat_core import Domain, medial_axis

    answers: dict[str, Json] = {}

    def answer(domain: Json, **options: Any) -> Json:
        sent = {"outer": domain["outer"], "holes": domain.get("holes", [])}
        key = json.dumps([sent, options], sort_keys=True)
        if key not in answers:
            answers[key] = medial_axis(Domain.from_dict(sent), **options).to_dict()
        return answers[key]

    return answer
