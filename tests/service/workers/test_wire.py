from __future__ import annotations

import socket
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.workers import wire


@given(st.dictionaries(st.text(), st.integers(-(2**60), 2**60) | st.text() | st.none()), st.binary(max_size=1000))
def test_what_is_sent_is_received(header: wire.Header, body: bytes) -> None:
    left, right = socket.socketpair()
    with left, right:
        wire.send(left, header, body)
        assert wire.receive(right) == (header, body)


def test_a_body_larger_than_every_buffer_arrives_whole() -> None:
    body = bytes(range(256)) * 40_000
    left, right = socket.socketpair()
    with left, right:
        sender = threading.Thread(target=wire.send, args=(left, {"a": 1}, body))
        sender.start()
        assert wire.receive(right) == ({"a": 1}, body)
        sender.join()


@pytest.mark.parametrize("kept", [0, 1, 11, 12, 13, 20])
def test_a_message_cut_short_is_no_message(kept: int) -> None:
    body = b"0123456789"
    head = wire.pack({"a": "bcd"}, len(body))
    left, right = socket.socketpair()
    with right:
        with left:
            left.sendall((head + body)[:kept])
        assert wire.receive(right) is None
