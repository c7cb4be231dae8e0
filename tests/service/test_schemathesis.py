"""Schemathesis against the running service: every operation of the OpenAPI document, with good and bad requests."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.app import create_app
from service.http.negotiation import WITH_PRECISION
from service.operations import OPERATIONS
from service.settings import Settings
from tests.service.domains import ARGUMENTS, valid_domains

RELAXED = settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, *HealthCheck]
)


CHECKS: dict[str, dict[str, Any]] = {
    # what fits its schema may break a rule of geometry, 422, or name a job that is gone, 404 or 410
    "positive_data_acceptance": {"expected-statuses": ["2xx", "404", "410", "422"]},
    # OGC API - Processes: results that are not there yet are a 404, and a job dismissed as it ran can be looked at
    "ensure_resource_availability": {"enabled": False},
    "use_after_free": {"enabled": False},
}


def served(live: httpx2.Client, checks: dict[str, dict[str, Any]]) -> Any:
    """The document as served."""
    configuration = schemathesis.Config.from_dict({"checks": checks})
    return schemathesis.openapi.from_url(f"{live.base_url}/openapi.json", config=configuration)


@pytest.fixture(scope="session")
def described(live: httpx2.Client) -> Any:
    return served(live, CHECKS)


@schemathesis.serializer("application/x-ndjson")
def lines(_context: Any, value: Any) -> bytes:
    """A body of lines is any text; what is none has no lines."""
    return value.encode(errors="replace") if isinstance(value, str) else b""


DOCUMENT = create_app(Settings()).openapi()
EVERY = [(method.upper(), path) for path, methods in DOCUMENT["paths"].items() for method in methods]


def that_fit(case: Any) -> Any:
    """A request whose parameters go together: no schema says that a drawing has no precision, nor what tokens there are."""
    (case.query or {}).pop("next", None)
    if (case.query or {}).get("f") not in (None, *WITH_PRECISION):
        case.query.pop("precision", None)
    return case


@pytest.mark.parametrize(("method", "path"), EVERY)
@given(data=st.data())
@RELAXED
def test_requests_that_fit_the_document(described: Any, method: str, path: str, data: st.DataObject) -> None:
    that_fit(data.draw(described[path][method].as_strategy())).call_and_validate()


@pytest.mark.parametrize(("method", "path"), [each for each in EVERY if "requestBody" in str(DOCUMENT["paths"][each[1]])])
@given(data=st.data())
@RELAXED
def test_requests_that_do_not_fit_the_document(described: Any, method: str, path: str, data: st.DataObject) -> None:
    strategy = described[path][method].as_strategy(generation_mode=schemathesis.GenerationMode.NEGATIVE)
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


def test_jobs_from_their_creation_to_their_end(live: httpx2.Client) -> None:
    """The links of the document, followed in any order: make a job of anything, look at it, fetch its results, dismiss it."""
    # a job is made of any body, which a worker reads later: what is wrong with it, the results say (400: it is no JSON; the
    # list has jobs of other tests, too)
    fits = {"expected-statuses": [*CHECKS["positive_data_acceptance"]["expected-statuses"], "400"]}
    described = served(live, {**CHECKS, "positive_data_acceptance": fits, "negative_data_rejection": {"enabled": False}})
    seen: set[tuple[str, str, int]] = set()

    class Asynchronous(described.as_state_machine()):  # type: ignore[misc]
        def before_call(self, case: Any) -> None:
            that_fit(case)
            if case.method == "POST":
                case.headers["Prefer"] = "respond-async"

        def after_call(self, response: Any, case: Any) -> None:
            super().after_call(response, case)
            seen.add((case.method, case.operation.path, response.status_code))

    Asynchronous.run(settings=settings(RELAXED, max_examples=30, stateful_step_count=8))
    assert {("GET", "/v1/jobs/{job_id}", 200), ("DELETE", "/v1/jobs/{job_id}", 200)} <= seen
    assert any(method == "POST" and status == 201 for method, _, status in seen)
    assert any(path == "/v1/jobs/{job_id}/results" and status not in (404, 405) for _, path, status in seen)
