"""The one table of everything that can go wrong over HTTP, and the document that tells of it (RFC 9457).

::

    code                    status  who can mend it
    not-http                400     the client: what it sends is no request
    not-json                400     the client: the body
    not-gzip                400     the client: the body
    invalid-parameter       400     the client: the query
    origin-not-allowed      400     the client: the page it runs on, or the operator's setting
    unauthorized            401     the client: its key
    not-found               404     the client: the address
    result-not-ready        404     nobody: the job is not over
    no-such-process         404     the client: the address
    method-not-allowed      405     the client: the verb
    not-acceptable          406     the client: the Accept header
    upload-timeout          408     the client: a faster line, or the operator's limit
    idempotency-key-in-flight  409  nobody: the same request is being received
    job-dismissed           410     the client: it dismissed the job
    precondition-failed     412     nobody: the client has this answer already, or wanted another version
    body-too-large          413     the client, or the operator's limit
    unsupported-media-type  415     the client: the Content-Type or Content-Encoding header
    invalid-domain          422     the client: see problems[]
    too-complex             422     the client, or the operator's limit
    idempotency-key-reused  422     the client: another key for another request
    too-many-requests       429     the client: fewer requests at a time with one key
    header-too-large        431     the client: the header fields
    not-certified           500     us: the answer failed its own proof and was withheld
    internal-error          500     us
    queue-full              503     nobody: try again after Retry-After
    deadline-exceeded       503     the client (a smaller domain), or the operator's limit
    worker-crashed          503     us; trying again is harmless
    not-ready               503     nobody: still starting
    store-unavailable       503     the operator: the database of jobs or its folder

This module imports no web framework: workers use it, too.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

MEDIA_TYPE = "application/problem+json"

TYPE = "urn:mat:problem:"
"""How the type of a problem begins; its code follows."""

PROBLEM_LINE = f'{{"type":"{TYPE}'.encode()
"""How a result line of a batch begins that is a problem document."""

OGC = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0"
"""Where OGC API - Processes has the types of problems that it knows."""


@dataclass(frozen=True, slots=True)
class ErrorKind:
    """One row of the table: what never changes for a code, the pause before trying again, the type that a standard gives."""

    status: int
    title: str
    retry_after_seconds: int | None = None
    uri: str | None = None


ERRORS: dict[str, ErrorKind] = {
    "not-http": ErrorKind(400, "This is no whole request of HTTP/1.1"),
    "not-json": ErrorKind(400, "The body is not JSON"),
    "not-gzip": ErrorKind(400, "The body is not the gzip stream it is said to be"),
    "invalid-parameter": ErrorKind(400, "The query has a parameter that is not known, or a value that is not allowed"),
    "origin-not-allowed": ErrorKind(400, "Pages of this origin may not use this service"),
    "unauthorized": ErrorKind(401, "A key of this service is needed"),
    "not-found": ErrorKind(404, "Nothing is at this address"),
    "result-not-ready": ErrorKind(404, "The job is not over yet", uri=f"{OGC}/result-not-ready"),
    "no-such-process": ErrorKind(404, "There is no process of this name", uri=f"{OGC}/no-such-process"),
    "method-not-allowed": ErrorKind(405, "This address does not answer this method"),
    "not-acceptable": ErrorKind(406, "None of the formats asked for is available"),
    "upload-timeout": ErrorKind(408, "The request did not come in time"),
    "idempotency-key-in-flight": ErrorKind(409, "A request with this Idempotency-Key is being received"),
    "job-dismissed": ErrorKind(410, "The job was dismissed"),
    "precondition-failed": ErrorKind(412, "The condition of the request does not hold"),
    "body-too-large": ErrorKind(413, "The body is larger than this service takes"),
    "unsupported-media-type": ErrorKind(415, "The body is not of a type this service reads"),
    "invalid-domain": ErrorKind(422, "The domain, or what is asked of it, is not valid"),
    "too-complex": ErrorKind(422, "The domain is beyond a limit of this service"),
    "idempotency-key-reused": ErrorKind(422, "This Idempotency-Key belongs to another request"),
    "too-many-requests": ErrorKind(429, "Too many requests with this key at a time", retry_after_seconds=1),
    "header-too-large": ErrorKind(431, "The header fields are larger than this service takes"),
    "not-certified": ErrorKind(500, "The answer failed its certificate and is withheld"),
    "internal-error": ErrorKind(500, "The service failed"),
    "queue-full": ErrorKind(503, "Too many requests are waiting", retry_after_seconds=2),
    "deadline-exceeded": ErrorKind(503, "The time for this request ran out", retry_after_seconds=30),
    "worker-crashed": ErrorKind(503, "The process that solved this request ended", retry_after_seconds=5),
    "not-ready": ErrorKind(503, "The service is still starting", retry_after_seconds=2),
    "store-unavailable": ErrorKind(503, "Jobs cannot be stored or looked up now", retry_after_seconds=5),
}


@dataclass(eq=False)
class RequestError(Exception):
    """A request that ends in a problem document.

    Attributes
    ----------
    code : str
        A key of `ERRORS`.
    detail : str
        What is wrong with this very request, and what to do.
    extra : dict
        Further members of the document, such as ``problems`` or ``line`` and ``column``.
    headers : dict
        Headers that belong to the answer, such as Allow.
    """

    code: str
    detail: str
    extra: dict[str, Any] = field(default_factory=dict)
    headers: dict[str, str] = field(default_factory=dict)

    def document(self, request_id: str | None = None) -> dict[str, Any]:
        """The problem document; ``problems`` is always there, empty where it does not apply."""
        kind = ERRORS[self.code]
        document = {
            "type": kind.uri or f"{TYPE}{self.code}",
            "title": kind.title,
            "status": kind.status,
            "detail": self.detail,
            "code": self.code,
            "problems": [],
            **self.extra,
        }
        if request_id is not None:
            document["request_id"] = request_id
        return document
