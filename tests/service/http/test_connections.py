"""Connections held open for no use: heads that do not come, answers that are not taken, more than there may be; and no HTTP."""

from __future__ import annotations

import contextlib
import json
import select
import socket
import threading
import time
from collections.abc import Iterator

import httpx2
import pytest

from service.errors import ERRORS
from service.settings import KIB, MIB
from tests.service.live import PATIENCE, trickled
from tests.service.processes import eventually
from tests.service.test_server import serving

SECONDS = 0.5
HEAD = b"GET /healthz HTTP/1.1\r\nHost: x\r\n"
POST = b"POST /v1/mat HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n"
CHUNKED = POST.replace(b"Content-Length: %d", b"Transfer-Encoding: chunked")
LARGE = b'{"do": "echo"}'.ljust(12 * MIB)  # more than the kernel keeps of an answer by itself
CONNECTIONS = 4


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx2.URL]:
    with serving(tmp_path_factory.mktemp("heads"), MAT_HEAD_SECONDS=str(SECONDS)) as (_, address):
        yield httpx2.URL(address)


@pytest.fixture(scope="module")
def crowded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx2.URL]:
    settings = {"MAT_MAX_CONNECTIONS": str(CONNECTIONS), "MAT_DOWNLOAD_SECONDS": str(SECONDS), "MAT_WORKERS": "4"}
    with serving(tmp_path_factory.mktemp("crowded"), **settings) as (_, address):
        yield httpx2.URL(address)


@contextlib.contextmanager
def connected(address: httpx2.URL) -> Iterator[socket.socket]:
    with socket.create_connection((address.host, address.port), timeout=60) as client:
        yield client


@contextlib.contextmanager
def asked(address: httpx2.URL, body: bytes) -> Iterator[socket.socket]:
    """A connection on which the worker of the tests was asked to do something; its small buffer takes little by itself."""
    with socket.socket() as client:
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 256 * KIB)
        client.settimeout(60)
        client.connect((address.host, address.port))
        client.sendall(POST % len(body) + body)
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
        client.sendall(POST % len(body))
        time.sleep(2 * SECONDS)
        client.sendall(body + HEAD + b"\r\n")  # and the next request with it
        answers = received(client)
    assert answers.count(b"HTTP/1.1 200 ") == 2


def ended(address: httpx2.URL, reason: str) -> int:
    """How many connections the service says to have ended for a reason."""
    figures = httpx2.get(address.copy_with(path="/metrics"), headers={"Connection": "close"}).text
    return int(float(next(line for line in figures.splitlines() if f'_ended_total{{reason="{reason}"}}' in line).split()[1]))


def test_an_answer_that_is_not_taken_is_forgotten(crowded: httpx2.URL) -> None:
    before = ended(crowded, "answer")
    with asked(crowded, LARGE) as client:
        eventually(lambda: ended(crowded, "answer") == before + 1)
        taken = b""
        with contextlib.suppress(ConnectionResetError):
            taken = received(client)
    assert len(taken) < len(LARGE)


def test_one_that_is_taken_slowly_but_steadily_is_sent_whole(crowded: httpx2.URL) -> None:
    with asked(crowded, LARGE) as client:
        begun = time.monotonic()
        taken = 0
        while taken < len(LARGE):
            time.sleep(SECONDS / 10)
            piece = client.recv(512 * KIB, socket.MSG_WAITALL)
            assert piece
            taken += len(piece)
    assert time.monotonic() - begun > 2 * SECONDS


def problem_of(answer: bytes) -> str:
    """The code of the problem document that is all of an answer."""
    head, _, body = answer.partition(b"\r\n\r\n")
    document = json.loads(body)
    assert head.startswith(b"HTTP/1.1 %d " % ERRORS[document["code"]].status)
    assert b"content-type: application/problem+json" in head.lower()
    assert b"x-request-id: " + document["request_id"].encode() in head.lower()
    return str(document["code"])


def test_a_new_connection_ends_the_one_that_waits_longest(crowded: httpx2.URL) -> None:
    with contextlib.ExitStack() as stack:
        clients = [stack.enter_context(connected(crowded)) for _ in range(CONNECTIONS + 2)]
        for client in clients[:2]:
            with contextlib.suppress(ConnectionResetError):
                assert received(client) == b""
        for client in clients[2:]:
            client.sendall(HEAD + b"Connection: close\r\n\r\n")
            assert received(client).endswith(b'{"status":"ok"}')


def test_where_all_have_work_the_new_one_is_refused(crowded: httpx2.URL) -> None:
    with contextlib.ExitStack() as stack:
        spin = b'{"do": "sleep", "seconds": 30}'
        busy = [stack.enter_context(asked(crowded, spin)) for _ in range(CONNECTIONS)]
        time.sleep(SECONDS)
        with connected(crowded) as client:
            assert problem_of(received(client)) == "queue-full"
        busy.pop().close()
        eventually(lambda: b'"ok"' in one_answer(crowded, HEAD + b"Connection: close\r\n\r\n"))


def one_answer(address: httpx2.URL, request: bytes) -> bytes:
    """All that is answered to bytes, until the connection is closed."""
    with connected(address) as client, contextlib.suppress(ConnectionResetError, BrokenPipeError):
        client.sendall(request)
        return received(client)
    return b""


def test_a_refusal_reaches_a_client_that_sends_all_of_its_body_first(address: httpx2.URL) -> None:
    size = 20 * MIB  # more than the kernel keeps
    assert problem_of(one_answer(address, POST % size + bytes(size))) == "body-too-large"


NO_HTTP = {
    "a greeting of TLS": (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n", "not-http"),
    "words": (b"good morning\r\n\r\n", "not-http"),
    "no host": (b"GET / HTTP/1.1\r\n\r\n", "not-http"),
    "two lengths": (POST[:-4] % 3 + b"\r\nContent-Length: 4\r\n\r\nabc", "not-http"),
    "a length of no digits": (HEAD + b"Content-Length: -1\r\n\r\n", "not-http"),
    "another coding": (HEAD + b"Transfer-Encoding: gzip\r\n\r\n", "not-http"),
    "a chunk without a length": (CHUNKED + b"xyz\r\n", "not-http"),
    "a head without an end": (HEAD + b"X: " + bytes(range(97, 123)) * 20_000, "header-too-large"),
}


@pytest.mark.parametrize(("content", "code"), NO_HTTP.values(), ids=NO_HTTP)
def test_what_is_no_http_is_told_so(address: httpx2.URL, content: bytes, code: str) -> None:
    before = ended(address, "not-http")
    assert problem_of(one_answer(address, content)) == code
    assert ended(address, "not-http") == before + 1


CUT_OFF = {
    "a head": HEAD,
    "a body": POST % 100 + b"{}",
    "a body in chunks": CHUNKED + b"2\r\n{",
    "a batch": POST.replace(b"mat", b"batches").replace(b"/json", b"/x-ndjson") % 100 + b"{}\n",
}


@pytest.mark.parametrize("content", CUT_OFF.values(), ids=CUT_OFF)
def test_what_is_cut_off_is_told_so(address: httpx2.URL, content: bytes) -> None:
    with connected(address) as client:
        client.sendall(content)
        time.sleep(SECONDS / 5)
        client.shutdown(socket.SHUT_WR)
        assert problem_of(received(client)) == "not-http"


def test_much_in_little_pieces_holds_up_nobody(address: httpx2.URL) -> None:
    """A connection that sends chunks of one byte is looked at for a while only, and then the others are."""
    chunks = CHUNKED + b'e\r\n{"do": "echo"}\r\n' + b"1\r\n \r\n" * 200_000 + b"0\r\n\r\n"
    slowest = 0.0
    with connected(address) as client, httpx2.Client(base_url=address) as other:
        threading.Thread(target=client.sendall, args=(chunks,)).start()
        begun = time.monotonic()
        while not select.select([client], [], [], 0.0)[0]:
            asked = time.monotonic()
            assert other.get("/healthz").status_code == 200
            slowest = max(slowest, time.monotonic() - asked)
        whole = time.monotonic() - begun
        assert client.recv(65536).startswith(b"HTTP/1.1 200 ")
    assert slowest < whole / 4


def test_requests_that_come_together_are_answered_in_order(address: httpx2.URL) -> None:
    """However their bytes are cut, and whatever else comes."""
    bodies = [b'{"do": "echo"}'.ljust(20 + 700 * k) for k in range(12)]
    content = b"".join(HEAD + b"\r\n" + POST % len(body) + body for body in bodies)
    content += HEAD + b"Connection: close\r\n\r\n"
    for step in (1000, 7919, len(content)):
        with connected(address) as client:
            for place in range(0, len(content), step):
                client.sendall(content[place : place + step])
            answers = received(client)
        assert answers.count(b"HTTP/1.1 ") == answers.count(b"HTTP/1.1 200 OK\r\n") == 2 * len(bodies) + 1
        found = [answers.index(b"\r\n\r\n" + body) for body in bodies]
        assert found == sorted(found)


def test_many_that_send_without_end_hold_up_nobody(address: httpx2.URL) -> None:
    """Requests that come together take turns with those of other connections."""
    count, clients = 150, 8
    content = (HEAD + b"\r\n") * count
    slowest = 0.0
    with contextlib.ExitStack() as stack:
        flood = [stack.enter_context(connected(address)) for _ in range(clients)]
        other = stack.enter_context(httpx2.Client(base_url=address))
        for client in flood:
            client.sendall(content)
        begun = time.monotonic()
        left = dict.fromkeys(flood, count)
        while any(left.values()):
            asked = time.monotonic()
            assert other.get("/healthz").status_code == 200
            slowest = max(slowest, time.monotonic() - asked)
            for client in select.select(flood, [], [], 0.0)[0]:
                left[client] -= client.recv(1 << 20).count(b"HTTP/1.1 200 OK")
    assert slowest < (time.monotonic() - begun) / 4
