"""The header Prefer of RFC 7240, as far as this service knows it: ``respond-async`` and ``wait``.

A preference is a wish: one that is unknown, misspelt or not a list at all is passed over, as the RFC wants it, and the answer
says in Preference-Applied which ones were honoured. Of a preference that is given twice the first counts.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

_TOKEN = r"[!#$%&'*+.^_`|~0-9A-Za-z-]+"
_PREFERENCE = re.compile(rf'\s*({_TOKEN})\s*(?:=\s*({_TOKEN}|"(?:[^"\\]|\\.)*"|)\s*)?(?:;[^,"]*(?:"(?:[^"\\]|\\.)*"[^,"]*)*)?')
_SECONDS = re.compile(r"[0-9]{1,9}")


@dataclass(frozen=True, slots=True)
class Preferences:
    """What a client would like.

    Attributes
    ----------
    respond_async : bool
        A job rather than the answer.
    wait : int or None
        Seconds that it will wait for the answer; a positive number where it stands alone.
    """

    respond_async: bool = False
    wait: int | None = None

    @property
    def headers(self) -> dict[str, str]:
        """The header Preference-Applied, where something was asked for."""
        wait = None if self.wait is None else f"wait={self.wait}"
        applied = ", ".join(filter(None, ("respond-async" if self.respond_async else None, wait)))
        return {"Preference-Applied": applied} if applied else {}


def read_preferences(values: Iterable[str]) -> Preferences:
    """The preferences of a request, from the values of all its Prefer headers."""
    found: dict[str, str] = {}
    for part in _split(",".join(values)):
        match = _PREFERENCE.fullmatch(part)
        if match is not None:
            found.setdefault(match[1].lower(), (match[2] or "").strip('"'))
    respond_async = found.get("respond-async") == ""
    wait = int(found["wait"]) if _SECONDS.fullmatch(found.get("wait", "")) else None
    if wait == 0 and not respond_async:
        wait = None  # no answer takes no time at all
    return Preferences(respond_async, wait)


def _split(text: str) -> list[str]:
    """The parts between commas that are not quoted."""
    return re.findall(r'(?:[^,"]|"(?:[^"\\]|\\.)*"|")+', text)
