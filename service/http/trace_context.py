"""The trace that a request belongs to (W3C Trace Context).

A valid ``traceparent`` is carried on: the same trace, this request as a new span below the caller's. One that is not valid
is ignored, as the recommendation asks, and a new trace is begun. The recommendation has ``traceparent`` for requests only;
the answer tells its span by ``traceresponse``, the header of the same group's draft for responses, in the same form.
"""

from __future__ import annotations

import re
import secrets
from dataclasses import dataclass

_PARENT = re.compile(r"([0-9a-f]{2})-([0-9a-f]{32})-([0-9a-f]{16})-([0-9a-f]{2})(-.*)?")
_FORBIDDEN_VERSION = "ff"
_KNOWN_VERSION = "00"  # nothing may follow its four fields; a later one may have more, which are not understood
_FLAGS = 0x03  # sampled, random trace id: those of the recommendation; others must not be passed on


@dataclass(frozen=True, slots=True)
class TraceContext:
    """One span: this request.

    Attributes
    ----------
    trace_id, span_id : str
        32 and 16 hexadecimal digits.
    parent_id : str or None
        The caller's span.
    flags : int
        1: the caller records this trace.
    """

    trace_id: str
    span_id: str
    parent_id: str | None = None
    flags: int = 0

    @classmethod
    def of(cls, traceparent: str) -> TraceContext:
        """The span of a request that came with a header, which may be empty or anything else."""
        found = _PARENT.fullmatch(traceparent.strip())
        if found is not None:
            version, trace_id, parent_id, flags, more = found.groups()
            known = version != _FORBIDDEN_VERSION and not (version == _KNOWN_VERSION and more)
            if known and int(trace_id, 16) and int(parent_id, 16):
                return cls(trace_id, _new_id(8), parent_id, int(flags, 16) & _FLAGS)
        return cls(_new_id(16), _new_id(8))

    @property
    def header(self) -> str:
        """The value of ``traceresponse``."""
        return f"{_KNOWN_VERSION}-{self.trace_id}-{self.span_id}-{self.flags:02x}"


def _new_id(count: int) -> str:
    """Random bytes in hexadecimal; not all of them zero."""
    return secrets.token_hex(count - 1) + f"{secrets.randbelow(255) + 1:02x}"
