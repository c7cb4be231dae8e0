"""Schemathesis over the routes of jobs: what is sent may be anything, what comes back is as the document says."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.openapi import JOB_CODES

RELAXED = settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
ROUTES = [(path, verb.upper()) for path, verbs in JOB_CODES.items() for verb in verbs]


@schemathesis.serializer("application/x-ndjson")
def lines(_: Any, value: Any) -> bytes:
    """Lines as they are sent; what is no text cannot be sent as such, and goes as no line at all."""
    return value.encode() if isinstance(value, str) else b""


@pytest.fixture(scope="session")
def described(live: httpx2.Client) -> Any:
    """The document as served. Lines may fit their schema (a string) and hold no domain: then 400 is right."""
    configuration = schemathesis.Config.from_dict(
        {"checks": {"positive_data_acceptance": {"expected-statuses": ["2xx", "400", "404", "415"]}}}
    )
    return schemathesis.openapi.from_url(f"{live.base_url}/openapi.json", config=configuration)


@pytest.mark.parametrize(("path", "verb"), ROUTES)
@pytest.mark.parametrize("mode", schemathesis.GenerationMode)
@given(data=st.data())
@RELAXED
def test_the_routes_of_jobs_answer_as_described(
    described: Any, mode: schemathesis.GenerationMode, path: str, verb: str, data: st.DataObject
) -> None:
    data.draw(described[path][verb].as_strategy(generation_mode=mode)).call_and_validate()
