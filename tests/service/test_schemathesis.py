"""Schemathesis against the running service: every operation of the OpenAPI document, with good and bad requests."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.operations import OPERATIONS
from tests.service.domains import ARGUMENTS, valid_domains

RELAXED = settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, *HealthCheck]
)


@pytest.fixture(scope="session")
def described(live: httpx2.Client) -> Any:
    """The document as served. A domain may fit its schema and break a rule of geometry: then 422 is right."""
    configuration = schemathesis.Config.from_dict(
        {"checks": {"positive_data_acceptance": {"expected-statuses": ["2xx", "422"]}}}
    )
    return schemathesis.openapi.from_url(f"{live.base_url}/openapi.json", config=configuration)


ROUTES = [f"/v1/{name}" for name in OPERATIONS]


@pytest.mark.parametrize("path", [*ROUTES, "/healthz", "/readyz", "/version"])
@given(data=st.data())
@RELAXED
def test_requests_that_fit_the_document(described: Any, path: str, data: st.DataObject) -> None:
    operation = described[path]["POST" if path in ROUTES else "GET"]
    data.draw(operation.as_strategy()).call_and_validate()


@pytest.mark.parametrize("path", ROUTES)
@given(data=st.data())
@RELAXED
def test_requests_that_do_not_fit_the_document(described: Any, path: str, data: st.DataObject) -> None:
    strategy = described[path]["POST"].as_strategy(generation_mode=schemathesis.GenerationMode.NEGATIVE)
    data.draw(strategy).call_and_validate()


@pytest.mark.parametrize("name", OPERATIONS)
@given(data=st.data())
@RELAXED
def test_truly_valid_domains_are_answered_as_documented(described: Any, name: str, data: st.DataObject) -> None:
    body = data.draw(valid_domains())
    if name in ARGUMENTS:
        body["arguments"] = data.draw(ARGUMENTS[name])
    query = data.draw(st.sampled_from([{}, *({"f": f} for f in OPERATIONS[name].formats)]))
    case = described[f"/v1/{name}"]["POST"].Case(
        body=body, query=query, headers={"Content-Type": "application/json"}, media_type="application/json"
    )
    assert case.call_and_validate().status_code == 200
