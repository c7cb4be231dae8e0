"""Keys of the service: who asks, and how many requests at a time.

The operator sets digests, never keys, so that neither a process list nor a configuration file gives one away. A key is
random and long, so that one round of SHA-256 is enough: ``openssl rand -hex 32`` makes one, ``printf %s KEY | sha256sum``
its digest.
"""

from __future__ import annotations

import hashlib
import hmac
import re
from dataclasses import dataclass

from starlette.datastructures import Headers

from service.errors import RequestError

OPEN = ("/", "/healthz", "/readyz", "/version", "/docs", "/openapi.json", "/conformance", "/processes")
"""Addresses that need no key: what machines ask to see whether the service is well, and people to learn how to use it."""

OPEN_BELOW = ("/static/",)

_PROCESS = re.compile(r"/processes/[^/]+")
_ENTRY = re.compile(r"(?:([A-Za-z0-9._-]{1,64}):)?([0-9A-Fa-f]{64})")
_UNNAMED = 8  # digits of the digest that stand for the name of a key that has none


@dataclass(frozen=True, slots=True)
class ApiKey:
    """A key by its name, which may be logged, and its digest."""

    name: str
    digest: bytes


ApiKeys = tuple[ApiKey, ...]


def read_keys(text: str) -> ApiKeys:
    """The keys of a setting.

    Parameters
    ----------
    text : str
        ``digest`` or ``name:digest``, separated by commas; a key without a name is called by the first digits of its digest.

    Raises
    ------
    ValueError
        An entry is neither, or two have one name.
    """
    keys = []
    for part in filter(None, (part.strip() for part in text.split(","))):
        entry = _ENTRY.fullmatch(part)
        if entry is None:
            raise ValueError
        keys.append(ApiKey(entry[1] or entry[2][:_UNNAMED].lower(), bytes.fromhex(entry[2])))
    if len({key.name for key in keys}) < len(keys):
        raise ValueError
    return tuple(keys)


def is_open(path: str, metrics_open: bool) -> bool:
    """Whether an address is answered without a key; all that is not known here is not."""
    return path in OPEN or path.startswith(OPEN_BELOW) or bool(_PROCESS.fullmatch(path)) or (metrics_open and path == "/metrics")


def identify(keys: ApiKeys, headers: Headers) -> str:
    """The name of the key that a request carries, as X-API-Key or as a bearer token; the former goes before.

    Every digest is compared, and each in constant time, so that the time tells nothing.

    Raises
    ------
    RequestError
        ``unauthorized``, with the challenge of RFC 6750.
    """
    scheme, _, token = headers.get("authorization", "").partition(" ")
    given = headers.get("x-api-key", token.strip() if scheme.lower() == "bearer" else "")
    if not given:
        detail = "Send a key as 'Authorization: Bearer KEY' or 'X-API-Key: KEY'."
        raise RequestError("unauthorized", detail, headers={"WWW-Authenticate": 'Bearer realm="mat"'})
    digest = hashlib.sha256(given.encode("latin-1")).digest()
    names = [key.name for key in keys if hmac.compare_digest(key.digest, digest)]
    if not names:
        challenge = 'Bearer realm="mat", error="invalid_token"'
        raise RequestError("unauthorized", "This key is not known.", headers={"WWW-Authenticate": challenge})
    return names[0]


class Concurrency:
    """Requests under way by key.

    Parameters
    ----------
    limit : int
        That one key may have at a time; 0: any number.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._under_way: dict[str, int] = {}

    def enter(self, name: str) -> None:
        """Count one more.

        Raises
        ------
        RequestError
            ``too-many-requests``.
        """
        count = self._under_way.get(name, 0)
        if self._limit and count >= self._limit:
            raise RequestError("too-many-requests", f"{count} requests with this key are under way; no more may be.")
        self._under_way[name] = count + 1

    def leave(self, name: str) -> None:
        """Count one less."""
        self._under_way[name] -= 1
        if not self._under_way[name]:
            del self._under_way[name]
