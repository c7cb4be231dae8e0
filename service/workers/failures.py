"""Why a request was not answered by a worker. The routes turn each into its problem document."""

from __future__ import annotations


class PoolError(Exception):
    """A request was not answered; its class says why."""


class QueueFull(PoolError):
    """As many requests wait in its lane as the settings allow.

    Attributes
    ----------
    begun : bool
        It was worked on, for longer than the lane it came from gives; it is the next lane that is full.
    """

    def __init__(self, begun: bool = False) -> None:
        super().__init__()
        self.begun = begun


class DeadlineExceeded(PoolError):
    """The time for it ran out, waiting included; the worker was killed."""


class WorkerCrashed(PoolError):
    """The worker ended without a whole answer."""
