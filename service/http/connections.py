"""Connections, held open for nobody who does not use them: uvicorn's h11 protocol with its limits.

::

    connection made ──┐                                           ┌── the head is whole: the request begins, `bodies` waits on
                      ├── MAT_HEAD_SECONDS for all of a head ──>──┤
    answer sent ──────┘                                           └── time is up: 408 if some of it came, and the connection ends

    the socket is full ──> the client takes 16 KiB a second ──> the answer goes on
                       ──> or less, for MAT_DOWNLOAD_SECONDS ──> the connection ends, and what it had not taken is forgotten

    more than MAT_MAX_CONNECTIONS ──> the one that waited longest for a head ends; or, where none does, the new one, by a 503

By itself uvicorn closes a connection only that is silent for five seconds. It waits without end for a client that sends a byte
now and then, or never reads; takes any number of connections; and tells of what is no HTTP in plain text.
"""

from __future__ import annotations

import asyncio
import logging
import sys
import uuid
from typing import Literal

import h11
import orjson
from uvicorn.protocols.http.h11_impl import STATUS_PHRASES, H11Protocol

from service.errors import ERRORS, MEDIA_TYPE, RequestError
from service.http.farewell import take_leave
from service.http.patience import LEAST_RATE, Patience
from service.http.turns import Turns
from service.settings import KIB, Settings

Reason = Literal["silent", "head", "answer", "crowd", "not-http"]
"""Why a connection was ended: nothing came, or not all of a head; an answer was not taken; too many were open; it was no HTTP."""

SLICE_BYTES = 4 * KIB
"""Of what has come on a connection that is looked at at a time; 6 ms if it is chunks of one byte."""

READ_BYTES, BODY_BYTES = 16 * KIB, 128 * KIB
"""Most that is read of a connection at a time: while a head is waited for, and of a body. A client that sends many requests
behind each other should not make this process hold much of them; a batch of 74 MB takes 0.2 s in pieces of 128 KiB, 0.4 s in
pieces of 16 KiB. Into one room for all connections: asyncio's own, 256 KiB, is new memory each time, and the kernel takes longer
to find its pages than a small request takes."""

URGENT = (b"GET /healthz ", b"GET /readyz ")
"""How requests begin that tell whether the service is well."""

_log = logging.getLogger("service.http")


class Connections:
    """Those of one server.

    Attributes
    ----------
    open : int
        How many there are.
    ended : dict of str to int
        How many were ended from this side, by `Reason`.
    """

    def __init__(self, settings: Settings) -> None:
        self.head_seconds = settings.head_seconds
        self.download_seconds = settings.download_seconds
        self._most = settings.max_connections
        self._waiting: dict[Connection, None] = {}  # for a head; who has waited longest is the first
        self.turns = Turns()
        self.came = memoryview(bytearray(BODY_BYTES))  # on any connection; it is emptied at once
        self.open = 0
        self.ended: dict[Reason, int] = {"silent": 0, "head": 0, "answer": 0, "crowd": 0, "not-http": 0}

    def enter(self) -> bool:
        """Count one more. Where that is one too many, another one ends for it; False if there is none to end."""
        self.open += 1
        if self.open <= self._most:
            return True
        oldest = next(iter(self._waiting), None)
        if oldest is None:
            return False
        oldest.drop("crowd")
        return True

    def leave(self) -> None:
        """Count one less."""
        self.open -= 1

    def waits(self, connection: Connection) -> None:
        """Note that a connection waits for a head."""
        self._waiting[connection] = None

    def waits_no_more(self, connection: Connection) -> None:
        """Note that it does not."""
        self._waiting.pop(connection, None)


class Connection(H11Protocol, asyncio.BufferedProtocol):
    """One of them. Use as made by `protocol`."""

    family: Connections
    _head_deadline: asyncio.TimerHandle | None = None
    _taking_deadline: asyncio.TimerHandle | None = None
    _full_since = 0.0  # by the loop's clock; while there is a deadline for taking
    _untaken = 0  # bytes, then
    _refused = _dropped = _has_turn = False
    _unread = b""

    # what comes

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """The first head is waited for, if there is room for one more connection."""
        super().connection_made(transport)
        transport.set_write_buffer_limits(high=0)  # `pause_writing` tells of every answer that the socket does not take at once
        self._patience = Patience(self.family.download_seconds)
        if self.family.enter():
            self._wait_for_head()
        else:
            self._refuse(RequestError("queue-full", "As many connections are open as may be."), "crowd")

    def connection_lost(self, exc: Exception | None) -> None:
        """Nothing is waited for."""
        self.family.turns.leave(self)
        self._wait_for_no_head()
        self._cancel_taking()
        if exc is None and not self._dropped and (self._refused or self.conn.their_state is h11.SEND_BODY):
            take_leave(self.loop, self.transport.get_extra_info("socket"), self.family.leave)
        else:
            self.family.leave()
        super().connection_lost(exc)

    def get_buffer(self, sizehint: int) -> memoryview:
        """Where the next bytes go."""
        return self.family.came if self.conn.their_state is h11.SEND_BODY else self.family.came[:READ_BYTES]

    def buffer_updated(self, nbytes: int) -> None:
        """Something has come; it is looked at when it is this connection's turn, and no more is read until all of it is."""
        self._unset_keepalive_if_required()
        self._unread += self.family.came[:nbytes]
        urgent = self.conn.their_state is h11.IDLE and self._unread.startswith(URGENT)
        self.family.turns.wait(self, self.loop, urgent=urgent)
        if len(self._unread) > SLICE_BYTES:
            self.transport.pause_reading()

    def take_slice(self) -> tuple[bool, bool]:
        """Look at some of what has come: whether there is more, and whether a request has begun."""
        before = self.cycle
        plain = self.conn.their_state is h11.SEND_BODY and not any(name == b"transfer-encoding" for name, _ in self.headers)
        size = len(self._unread) if plain else SLICE_BYTES  # of a body that is not in chunks, all at once takes no longer
        part, self._unread = self._unread[:size], self._unread[size:]
        self._take(part)
        if not self._unread and not self.flow.read_paused:
            self.transport.resume_reading()
        return bool(self._unread), self.cycle is not before

    def _take(self, part: bytes) -> None:
        """Look at bytes, and at what of those before them could not be looked at yet."""
        if self.transport.is_closing():
            return
        self._has_turn = True
        try:
            if part:
                super().data_received(part)
            else:
                self.handle_events()
        except Exception:  # of this connection, and of no other
            _log.exception("a connection failed where it must not")
            self.transport.abort()
        finally:
            self._has_turn = False

    def eof_received(self) -> None:
        """The client sends no more; one whose request is not whole is told so, if it still listens."""
        rest, self._unread = self._unread, b""
        self._take(rest)
        begun, _ = self.conn.trailing_data
        if self.conn.their_state is h11.SEND_BODY or (begun and self.conn.their_state is h11.IDLE):
            self._refuse(RequestError("not-http", "The connection ended before the request did."), "not-http")

    def handle_events(self) -> None:
        """Take what has come, in turn if it had to wait for an answer. A request that begins has a deadline of its own."""
        if not self._has_turn and self.conn.trailing_data[0]:
            self._unset_keepalive_if_required()
            self.family.turns.wait(self, self.loop)
            return
        super().handle_events()
        if self.cycle is not None and not self.cycle.response_complete:
            self._wait_for_no_head()

    def on_response_complete(self) -> None:
        """The next head is waited for; it may be here already."""
        if self._taking_deadline is None:
            self._patience = Patience(self.family.download_seconds)
        self._wait_for_head()
        super().on_response_complete()

    def send_400_response(self, msg: str) -> None:
        """Called in place of a request by what is no HTTP, while the fault is being handled."""
        fault = sys.exception()
        if isinstance(fault, h11.RemoteProtocolError) and fault.error_status_hint == ERRORS["header-too-large"].status:
            self._refuse(RequestError("header-too-large", "The head of the request is longer than 64 KiB."), "not-http")
        else:
            self._refuse(RequestError("not-http", f"{fault or msg}."), "not-http")

    def drop(self, reason: Reason) -> None:
        """End the connection without a word."""
        self.family.ended[reason] += 1
        self._dropped = True
        self._wait_for_no_head()
        self.transport.abort()

    def _wait_for_head(self) -> None:
        self._wait_for_no_head()
        if not self.transport.is_closing():
            self.family.waits(self)
            self._head_deadline = self.loop.call_later(self.family.head_seconds, self._head_too_late)

    def _wait_for_no_head(self) -> None:
        self.family.waits_no_more(self)
        if self._head_deadline is not None:
            self._head_deadline.cancel()
            self._head_deadline = None

    def _head_too_late(self) -> None:
        """End the connection; a client that has sent a part of a head is told why."""
        begun, _ = self.conn.trailing_data
        if self._unread or self.family.turns.waits(self):
            self._wait_for_head()  # it may be here: it is not the client that is late
        elif begun and self.conn.our_state is h11.IDLE:
            self._refuse(RequestError("upload-timeout", f"Its head was waited for {self.family.head_seconds:g} s."), "head")
        else:
            self.family.ended["silent"] += 1
            self._wait_for_no_head()
            self.transport.close()

    def _refuse(self, error: RequestError, reason: Reason) -> None:
        """Send a problem document, where no request is there that the application could answer, and end the connection."""
        self.family.ended[reason] += 1
        self._refused = True
        self._wait_for_no_head()
        if self.cycle is not None and not self.cycle.response_complete:  # its body turns out to be none
            self.cycle.disconnected = True
            self.cycle.message_event.set()
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE):
            request_id = uuid.uuid4().hex
            _log.info("a connection was ended: %s %s", error.code, error.detail, extra={"request_id": request_id})
            self._send(error, request_id)
        self.transport.close()

    def _send(self, error: RequestError, request_id: str) -> None:
        status, document = ERRORS[error.code].status, orjson.dumps(error.document(request_id))
        headers = [("Content-Type", MEDIA_TYPE), ("Content-Length", str(len(document)))]
        headers += [("Cache-Control", "no-store"), ("Connection", "close"), ("X-Request-ID", request_id)]
        if (pause := ERRORS[error.code].retry_after_seconds) is not None:
            headers.append(("Retry-After", str(pause)))
        head = h11.Response(status_code=status, headers=headers, reason=STATUS_PHRASES[status])
        for event in (head, h11.Data(data=document), h11.EndOfMessage()):
            self.transport.write(self.conn.send(event))

    # what goes

    def pause_writing(self) -> None:
        """The socket is full; the client is waited for."""
        super().pause_writing()
        self._wait_for_taking()

    def resume_writing(self) -> None:
        """The socket has taken everything."""
        super().resume_writing()
        self._note_taken()
        if self.cycle is None or self.cycle.response_complete:
            self._patience = Patience(self.family.download_seconds)

    def _wait_for_taking(self) -> None:
        self._full_since, self._untaken = self.loop.time(), self.transport.get_write_buffer_size()
        self._taking_deadline = self.loop.call_later(self._patience.left, self._taken_too_slowly)

    def _note_taken(self) -> None:
        """What the time cost since the socket was full, and what the client took in it."""
        taken = max(0, self._untaken - self.transport.get_write_buffer_size())
        self._patience.waited(self.loop.time() - self._full_since, taken)
        self._cancel_taking()

    def _cancel_taking(self) -> None:
        if self._taking_deadline is not None:
            self._taking_deadline.cancel()
            self._taking_deadline = None

    def _taken_too_slowly(self) -> None:
        """End the connection, unless enough was taken meanwhile."""
        self._note_taken()
        if self._patience.left > 0.0:
            self._wait_for_taking()
            return
        seconds = self.family.download_seconds
        _log.info("an answer was taken at less than %d bytes a second for %g s; its connection was ended", LEAST_RATE, seconds)
        self.drop("answer")


def protocol(connections: Connections) -> type[Connection]:
    """The protocol for `uvicorn.Config`."""
    return type("Connection", (Connection,), {"family": connections})
