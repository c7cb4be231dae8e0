"""The web process's end of the socket to a worker, without a worker."""

from __future__ import annotations

import asyncio
import itertools
import socket

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.workers import wire
from service.workers.channel import PIECE_BYTES, Channel, ChannelClosed, Incoming


@given(st.lists(st.binary(max_size=40), max_size=5), st.lists(st.integers(0, 200), max_size=12))
def test_messages_are_whole_wherever_the_stream_is_cut(bodies: list[bytes], cuts: list[int]) -> None:
    stream = b"".join(wire.pack({"number": k}, len(body)) + body for k, body in enumerate(bodies))
    places = sorted({min(cut, len(stream)) for cut in cuts} | {0, len(stream)})
    incoming = Incoming()
    found = [message for a, b in itertools.pairwise(places) for message in incoming.feed(stream[a:b])]
    assert [(header, b"".join(pieces)) for header, pieces in found] == [({"number": k}, body) for k, body in enumerate(bodies)]


def test_half_a_message_is_none() -> None:
    stream = wire.pack({"a": 1}, 10) + bytes(9)
    incoming = Incoming()
    assert not list(incoming.feed(stream))
    assert [header for header, _ in incoming.feed(b"x")] == [{"a": 1}]


async def _connected() -> tuple[Channel, socket.socket]:
    ours, its = socket.socketpair()
    _, channel = await asyncio.get_running_loop().create_connection(Channel, sock=ours)
    return channel, its


def test_a_large_body_is_sent_at_the_pace_of_its_reader() -> None:
    async def scenario() -> None:
        channel, its = await _connected()
        body = bytes(range(256)) * (40 * PIECE_BYTES // 256)
        with its:
            sending = asyncio.create_task(channel.send({"a": 1}, body))
            await asyncio.sleep(0.05)
            assert not sending.done(), "nobody has read it"
            received = await asyncio.to_thread(wire.receive, its)
            await sending
        assert received == ({"a": 1}, body)
        channel.close()

    asyncio.run(scenario())


def test_what_a_new_worker_says_first_is_no_answer() -> None:
    async def scenario() -> None:
        channel, its = await _connected()
        with its:
            wire.send(its, {wire.REHEARSED: 0.25})
            wire.send(its, {"a": 1})
            assert await channel.receive() == ({"a": 1}, ())
        assert channel.rehearsed == 0.25
        channel.close()

    asyncio.run(scenario())


def test_who_sends_to_a_worker_that_ends_does_not_wait_for_ever() -> None:
    async def scenario() -> None:
        channel, its = await _connected()
        sending = asyncio.create_task(channel.send({}, bytes(20 * PIECE_BYTES)))
        await asyncio.sleep(0.05)
        its.close()
        async with asyncio.timeout(10.0):
            await sending
            with pytest.raises(ChannelClosed) as end:
                await channel.receive()
        assert end.value.unread

    asyncio.run(scenario())
