"""Heads of requests, not waited for beyond their time: uvicorn's h11 protocol with a deadline.

::

    connection made ──┐                                           ┌── the head is whole: the request begins, `bodies` waits on
                      ├── MAT_HEAD_SECONDS for all of a head ──>──┤
    answer sent ──────┘                                           └── time is up: 408 if some of it came, and the connection ends

uvicorn closes a kept connection that is silent for five seconds, and waits without end for a client that sends a byte now and
then, be it a head or what is left of a body that nobody wants any more. Both end here.
"""

from __future__ import annotations

import asyncio
import logging

import h11
import orjson
from uvicorn.protocols.http.h11_impl import STATUS_PHRASES, H11Protocol

from service.errors import ERRORS, MEDIA_TYPE, RequestError

_log = logging.getLogger("service.http")


class HeadsInTime(H11Protocol):
    """One connection. Use as made by `heads_within`."""

    seconds: float
    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """The first head is waited for."""
        super().connection_made(transport)
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Nothing is waited for."""
        self._wait_no_more()
        super().connection_lost(exc)

    def on_response_complete(self) -> None:
        """The next head is waited for; it may be here already."""
        self._wait()
        super().on_response_complete()

    def handle_events(self) -> None:
        """Take what has come; a request that has begun has a deadline of its own."""
        super().handle_events()
        if self.cycle is not None and not self.cycle.response_complete:
            self._wait_no_more()

    def _wait(self) -> None:
        self._wait_no_more()
        self._deadline = self.loop.call_later(self.seconds, self._too_late)

    def _wait_no_more(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _too_late(self) -> None:
        """End the connection; a client that has sent a part of a head is told why."""
        if self.transport.is_closing():
            return
        begun, _ = self.conn.trailing_data
        if begun and self.conn.our_state is h11.IDLE:
            _log.info("the head of a request did not come in %g s", self.seconds)
            self._tell(RequestError("upload-timeout", f"Its head was waited for {self.seconds:g} s."))
        self.transport.close()

    def _tell(self, error: RequestError) -> None:
        """Send a problem document; no request is there that the application could answer."""
        status, document = ERRORS[error.code].status, orjson.dumps(error.document())
        headers = [("Content-Type", MEDIA_TYPE), ("Content-Length", str(len(document)))]
        headers += [("Cache-Control", "no-store"), ("Connection", "close")]
        answer = h11.Response(status_code=status, headers=headers, reason=STATUS_PHRASES[status])
        for event in (answer, h11.Data(data=document), h11.EndOfMessage()):
            self.transport.write(self.conn.send(event))


def heads_within(seconds: float) -> type[HeadsInTime]:
    """The protocol for `uvicorn.Config`, with its deadline.

    Parameters
    ----------
    seconds : float
        How long all of a head may take, from the connection's beginning or from the answer before it.
    """
    return type("HeadsInTime", (HeadsInTime,), {"seconds": seconds})
