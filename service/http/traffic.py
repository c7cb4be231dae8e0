"""What bodies and answers take of this process's memory while they are on their way, and its limit.

A body is held from its first byte to its answer's last, an answer until its client has it. Slow clients, at both ends, could
make that any amount: as much as there are connections, times the largest body. So both gates ask first: a piece of a body is
taken in, and an answer handed on, while all other requests hold less than MAT_TRAFFIC_BYTES. One alone may hold more.
"""

from __future__ import annotations

from service.errors import RequestError


class Traffic:
    """All that is held.

    Parameters
    ----------
    limit : int
        Bytes.

    Attributes
    ----------
    held : int
        Bytes.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self.held = 0

    def full(self, mine: int = 0) -> bool:
        """Whether no more is taken of a request that holds so much of it itself."""
        return self.held - mine >= self._limit


class Load:
    """What one request holds of it."""

    def __init__(self, traffic: Traffic) -> None:
        self._traffic = traffic
        self._bytes = 0

    def add(self, size: int) -> None:
        """Hold so many bytes more.

        Raises
        ------
        RequestError
            ``queue-full``.
        """
        if self._traffic.full(self._bytes):
            detail = "Bodies and answers on their way take as much memory as they may."
            raise RequestError("queue-full", detail, headers={"Connection": "close"})
        self._bytes += size
        self._traffic.held += size

    def release(self) -> None:
        """Hold nothing any more."""
        self._traffic.held -= self._bytes
        self._bytes = 0
