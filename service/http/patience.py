"""How long a client is waited for that gives or takes bytes slowly."""

from __future__ import annotations

from service.settings import KIB

LEAST_RATE = 16 * KIB
"""Bytes a second at which nobody loses patience; some 130 kbit/s."""


class Patience:
    """Seconds that are left of those in the beginning: waiting spends them, bytes buy them back, never more than these.

    So a slow line may send or take a gigabyte, and a client that stops is waited for no longer after much than after little.

    Parameters
    ----------
    seconds : float

    Attributes
    ----------
    left : float
        Not above zero: the client is not waited for any longer.
    """

    def __init__(self, seconds: float) -> None:
        self._seconds = self.left = seconds

    def waited(self, seconds: float, size: int) -> None:
        """Note that so many bytes were waited for so long."""
        self.left = min(self._seconds, self.left + size / LEAST_RATE - seconds)
