"""What is asked of a worker about a body: by a request that waits for it, or by a job that is stored first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from service.http.negotiation import Format
from service.settings import Settings


@dataclass(frozen=True, slots=True)
class Order:
    """One order.

    Attributes
    ----------
    operation : str
        One of `service.operations`.
    form : str
        The format of the answer.
    options : mapping
        What else decides the answer, as JSON has it: ``precision``, ``execute``; see `service.workers.solve.handle`.
    """

    operation: str
    form: Format
    options: Mapping[str, Any] = field(default_factory=dict)

    def header(self, settings: Settings) -> dict[str, Any]:
        """The header of the message to the worker, with the limits of the operator."""
        return {
            "operation": self.operation,
            "format": self.form,
            "most_edges": settings.max_edges,
            "most_control_points": settings.max_control_points,
            "keep": str(settings.keep_failed_dir) if settings.keep_failed_dir else None,
            **self.options,
        }
