from __future__ import annotations

import hashlib

import pytest
from starlette.datastructures import Headers

from service.errors import RequestError
from service.http.keys import ApiKeys, Concurrency, identify, is_open, read_keys


def digest(key: str) -> str:
    return hashlib.sha256(key.encode()).hexdigest()


@pytest.fixture
def keys() -> ApiKeys:
    return read_keys(f"cam:{digest('first')}, {digest('second').upper()},")


@pytest.mark.parametrize(
    ("headers", "name"),
    [
        ({"x-api-key": "first"}, "cam"),
        ({"x-api-key": "second"}, digest("second")[:8]),
        ({"authorization": "Bearer first"}, "cam"),
        ({"authorization": "bearer  first "}, "cam"),
        ({"x-api-key": "first", "authorization": "Bearer other"}, "cam"),
        ({"x-api-key": "first", "authorization": "Basic YTpi"}, "cam"),
    ],
)
def test_a_key_is_known_by_either_header(keys: ApiKeys, headers: dict[str, str], name: str) -> None:
    assert identify(keys, Headers(headers)) == name


@pytest.mark.parametrize(
    ("headers", "challenge"),
    [
        ({}, 'Bearer realm="mat"'),
        ({"authorization": "Basic Zmlyc3Q="}, 'Bearer realm="mat"'),
        ({"authorization": "Bearer"}, 'Bearer realm="mat"'),
        ({"x-api-key": ""}, 'Bearer realm="mat"'),
        ({"x-api-key": "third"}, 'Bearer realm="mat", error="invalid_token"'),
        ({"x-api-key": digest("first")}, 'Bearer realm="mat", error="invalid_token"'),
        ({"x-api-key": "fïrst"}, 'Bearer realm="mat", error="invalid_token"'),
        ({"x-api-key": "other", "authorization": "Bearer first"}, 'Bearer realm="mat", error="invalid_token"'),
    ],
)
def test_who_has_none_is_told_how_to_show_one(keys: ApiKeys, headers: dict[str, str], challenge: str) -> None:
    with pytest.raises(RequestError) as refusal:
        identify(keys, Headers(headers))
    assert refusal.value.code == "unauthorized"
    assert refusal.value.headers["WWW-Authenticate"] == challenge


@pytest.mark.parametrize("path", ["/", "/healthz", "/readyz", "/docs", "/static/favicon.png", "/processes", "/processes/mat"])
def test_what_is_open(path: str) -> None:
    assert is_open(path, metrics_open=False)


@pytest.mark.parametrize(
    "path",
    ["/v1/mat", "/metrics", "/v1/jobs", "/nope", "//healthz", "/healthz/", "/static", "/processes/mat/execution", "/docs/x"],
)
def test_all_else_is_not(path: str) -> None:
    assert not is_open(path, metrics_open=False)


def test_metrics_by_choice() -> None:
    assert is_open("/metrics", metrics_open=True)


def test_so_many_at_a_time_and_each_key_by_itself() -> None:
    count = Concurrency(2)
    count.enter("a")
    count.enter("a")
    with pytest.raises(RequestError) as refusal:
        count.enter("a")
    assert refusal.value.code == "too-many-requests"
    count.enter("b")
    count.leave("a")
    count.enter("a")


def test_no_limit() -> None:
    count = Concurrency(0)
    for _ in range(1000):
        count.enter("a")
