"""Heads that do not come: whoever holds a connection open with a byte now and then is told to go."""

from __future__ import annotations

import contextlib
import json
import socket
import time
from collections.abc import Iterator

import httpx2
import pytest

from tests.service.live import PATIENCE, trickled
from tests.service.test_server import serving

SECONDS = 0.5
HEAD = b"GET /healthz HTTP/1.1\r\nHost: x\r\n"


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx2.URL]:
    with serving(tmp_path_factory.mktemp("heads"), MAT_HEAD_SECONDS=str(SECONDS)) as (_, address):
        yield httpx2.URL(address)


@contextlib.contextmanager
def connected(address: httpx2.URL) -> Iterator[socket.socket]:
    with socket.create_connection((address.host, address.port), timeout=60) as client:
        yield client


def received(client: socket.socket) -> bytes:
    """All that comes until the connection is closed."""
    return b"".join(iter(lambda: client.recv(65536), b""))


def told_to_go(answer: bytes) -> bool:
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 408 Request Timeout\r\n")
    assert b"connection: close" in head.lower()
    document = json.loads(body)
    return (document["code"], document["status"], document["problems"]) == ("upload-timeout", 408, [])


def test_a_head_that_trickles_is_told_to_go(address: httpx2.URL) -> None:
    with connected(address) as client:
        answer, seconds = trickled(client, HEAD + b"X-Slow: a")
    assert told_to_go(answer)
    assert SECONDS - 0.1 <= seconds < PATIENCE


def test_so_is_the_second_head_of_a_connection(address: httpx2.URL) -> None:
    with connected(address) as client:
        client.sendall(HEAD + b"\r\n")
        first = b""
        while b'"ok"}' not in first:
            first += client.recv(65536)
        answer, seconds = trickled(client, HEAD + b"X-Slow: a")
    assert told_to_go(answer)
    assert seconds < PATIENCE


def test_a_connection_on_which_nothing_comes_is_closed_without_a_word(address: httpx2.URL) -> None:
    with connected(address) as client:
        begun = time.monotonic()
        assert received(client) == b""
    assert time.monotonic() - begun >= SECONDS - 0.1


def test_the_rest_of_a_body_that_nobody_wants_is_not_waited_for(address: httpx2.URL) -> None:
    with connected(address) as client:
        client.sendall(b"POST /nowhere HTTP/1.1\r\nHost: x\r\nContent-Length: 1000\r\n\r\n")
        answer, seconds = trickled(client, b" ")
    assert answer.startswith(b"HTTP/1.1 404 ")
    assert answer.count(b"HTTP/1.1") == 1
    assert seconds < PATIENCE


def test_work_and_bodies_may_take_longer_than_a_head(address: httpx2.URL) -> None:
    with connected(address) as client:
        body = b'{"do": "spin", "seconds": 1.5}'
        head = b"POST /v1/mat HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n"
        client.sendall(head % len(body))
        time.sleep(2 * SECONDS)
        client.sendall(body + HEAD + b"\r\n")  # and the next request with it
        answers = received(client)
    assert answers.count(b"HTTP/1.1 200 ") == 2
