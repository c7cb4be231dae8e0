"""What bodies and answers may take of memory, however slowly their clients send and take them."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterator

import httpx2
import pytest

from service.errors import RequestError
from service.http.traffic import Load, Traffic
from service.settings import KIB, MIB
from tests.service.http.test_connections import LARGE, POST, asked, connected
from tests.service.processes import eventually
from tests.service.test_server import serving

ECHO = b'{"do": "echo"}'
JSON = {"Content-Type": "application/json"}
LINES = {"Content-Type": "application/x-ndjson"}


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx2.Client]:
    folder = tmp_path_factory.mktemp("traffic")
    with serving(folder, MAT_TRAFFIC_BYTES=str(MIB)) as (_, address), httpx2.Client(base_url=address) as client:
        yield client


def test_what_others_hold_is_asked_before_more_is_taken() -> None:
    traffic = Traffic(100)
    one, other = Load(traffic), Load(traffic)
    one.add(90)
    one.add(90)  # a request alone may hold more
    with pytest.raises(RequestError) as refusal:
        other.add(1)
    assert refusal.value.code == "queue-full"
    one.release()
    one.release()
    assert traffic.held == 0
    other.add(1)
    assert traffic.held == 1


def outcome(service: httpx2.Client) -> int | str:
    """What a request is answered now: its status, or the code of its problem."""
    answer = service.post("/v1/mat", content=ECHO, headers=JSON)
    return 200 if answer.status_code == 200 else str(answer.json()["code"])


def test_bodies_that_are_held_up_are_not_joined_by_others(service: httpx2.Client) -> None:
    address = httpx2.URL(str(service.base_url))
    with connected(address) as client:
        client.sendall(POST % (2 * MIB) + bytes(2 * MIB - KIB))
        eventually(lambda: outcome(service) == "queue-full")
        assert service.post("/v1/batches", content=ECHO, headers=LINES).json()["code"] == "queue-full"
        assert service.get("/readyz").json()["code"] == "queue-full"
        assert service.get("/healthz").status_code == 200
    eventually(lambda: outcome(service) == 200)
    assert "mat_traffic_bytes 0.0\n" in service.get("/metrics").text


def test_nor_are_answers_that_are_not_taken(service: httpx2.Client) -> None:
    with asked(httpx2.URL(str(service.base_url)), LARGE) as client:
        eventually(lambda: outcome(service) == "queue-full")
        with contextlib.suppress(ConnectionResetError):
            client.shutdown(socket.SHUT_RDWR)
    eventually(lambda: outcome(service) == 200)
