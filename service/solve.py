"""What a worker does with one request: read the body, build the domain, solve, encode.

The only module of the service that imports mat_core, and only its public names. Every failure becomes a code of
`service.errors`; nothing is raised to the process around it.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import logging
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import orjson

import mat_core
from service import __version__
from service.errors import RequestError

MAX_PROBLEMS = 1000
"""Problems listed in one answer; a body of garbage would otherwise be answered by a larger one."""

SOLVER_OPTIONS = frozenset(inspect.signature(mat_core.medial_axis).parameters) - {"domain"}
"""What this version of the library takes; the contract knows more."""

_log = logging.getLogger("service.solve")

Answer = tuple[dict[str, Any], bytes]


def preload(progress: Callable[[str, int, int], None]) -> dict[str, str]:
    """Load every kernel before the first fork; say which versions these are.

    The compiler leaves hundreds of megabytes behind, which every worker would share. So a process that ends right after it fills
    the cache first, and this one only loads from there (or compiles after all, if that process failed).
    """
    compiler = os.fork()
    if compiler == 0:
        status = 1
        try:
            mat_core.warm(progress=progress)
            status = 0
        finally:
            os._exit(status)
    os.waitpid(compiler, 0)
    mat_core.warm()
    return {"service": __version__, "algorithm": mat_core.__version__}


def handle(header: dict[str, Any], body: bytes) -> Answer:
    """Answer one request.

    Parameters
    ----------
    header : dict
        ``format``: json or svg; ``keep``: the folder for bodies of failed answers, or None.
    body : bytes
        The request's body as it came.

    Returns
    -------
    tuple of (dict, bytes)
        ``{"timings": ...}`` with the encoded answer, or ``{"error": ...}`` with code, detail and extra members.
    """
    try:
        return _solve(header["format"], body)
    except RequestError as refusal:
        error = refusal
    except MemoryError:
        error = RequestError("too-complex", "Solving this domain takes more memory than one request may use. Split it.")
    except Exception:
        _log.exception("a request failed where it must not")
        error = RequestError("internal-error", "An unexpected failure; it is in the service's log.")
    if error.code in ("not-certified", "internal-error"):
        _keep(header["keep"], body)
    return {"error": {"code": error.code, "detail": error.detail, "extra": error.extra}}, b""


def _solve(form: str, body: bytes) -> Answer:
    clock = Clock()
    domain = _domain(body)
    clock.lap("read")
    options = dict(domain.options)
    samples = options.pop("samples", False)
    try:
        for name in options.keys() - SOLVER_OPTIONS:
            raise mat_core.UnsupportedOption(name, "it is not available in this version")
        axis = mat_core.medial_axis(domain, **options)
    except mat_core.UnsupportedOption as refusal:
        raise _unsupported(refusal) from refusal
    except mat_core.NotCertified as failure:
        raise _not_certified(failure) from failure
    clock.lap("solve")
    if form == "svg":
        content = axis.to_svg().encode()
    else:
        document = axis.to_dict(samples=samples)
        document["version"] = {**document.get("version", {}), "service": __version__}
        content = orjson.dumps(document, option=orjson.OPT_SERIALIZE_NUMPY)
    clock.lap("encode")
    return {"timings": clock.laps}, content


def _domain(body: bytes) -> mat_core.Domain:
    """The domain of a body.

    NaN and Infinity are not JSON, but the likely slip of a program that wrote the body; so they are read, and reported
    like every other fault of the domain with the place where they stand.
    """
    try:
        content = orjson.loads(body)
        strict_error = None
    except orjson.JSONDecodeError as error:
        strict_error = _not_json(error)
        content = _with_non_finite_numbers(body, strict_error)
    try:
        domain = mat_core.Domain.from_dict(content)
    except mat_core.InvalidDomain as invalid:
        raise _invalid(invalid) from invalid
    if strict_error is not None:
        raise strict_error
    return domain


def _not_json(error: orjson.JSONDecodeError) -> RequestError:
    place = {"line": error.lineno, "column": error.colno}
    return RequestError("not-json", f"Line {error.lineno}, column {error.colno}: {error.msg}.", place)


def _with_non_finite_numbers(body: bytes, strict_error: RequestError) -> Any:
    """Read a body again with NaN, Infinity and overflow allowed; raise `strict_error` where that is not all."""
    if b"NaN" not in body and b"Infinity" not in body and "infinity" not in strict_error.detail:
        raise strict_error
    try:
        return json.loads(body, parse_int=_integer)
    except (ValueError, RecursionError):
        raise strict_error from None


def _integer(digits: str) -> int | float:
    """An integer as the strict reader takes it: what does not fit 64 bits becomes a float."""
    return int(digits) if len(digits) < 19 else float(digits)


def _invalid(invalid: mat_core.InvalidDomain) -> RequestError:
    """The answer to an invalid domain: all its problems, as far as a person would read them."""
    count = len(invalid.problems)
    problems = [problem.to_dict() for problem in invalid.problems[:MAX_PROBLEMS]]
    too_complex = all(problem["code"] == "too-complex" for problem in problems)
    detail = "1 problem, see problems." if count == 1 else f"{count} problems, see problems."
    if count > MAX_PROBLEMS:
        detail += f" The first {MAX_PROBLEMS} are listed."
    return RequestError("too-complex" if too_complex else "invalid-domain", detail, {"problems": problems})


def _unsupported(refusal: mat_core.UnsupportedOption) -> RequestError:
    """The answer to options that are well formed one by one but do not go together."""
    problem = {"code": "unsupported-option", "pointer": f"/options/{refusal.option}", "message": str(refusal)}
    return RequestError("invalid-domain", "1 problem, see problems.", {"problems": [problem]})


def _not_certified(failure: mat_core.NotCertified) -> RequestError:
    """The answer that withholds a result: which check failed, where, and all figures of the failed certificate."""
    problem: dict[str, Any] = {"code": "not-certified", "pointer": "", "message": failure.detail}
    if failure.place is not None:
        problem["x"], problem["y"] = failure.place
    return RequestError("not-certified", str(failure), {"problems": [problem], "certificate": failure.certificate})


def _keep(folder: str | None, body: bytes) -> None:
    """Keep a body for reproduction, where the operator allows it; a full disk must not turn into another failure."""
    if folder is None:
        return
    name = hashlib.sha256(body).hexdigest()[:32]
    try:
        (Path(folder) / f"{name}.json").write_bytes(body)
    except OSError as error:
        _log.warning("could not keep a failed request: %s", error)


class Clock:
    """Milliseconds of each stage of a request."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, name: str) -> None:
        """Book the time since the last lap under `name`."""
        now = time.perf_counter()
        self.laps[name] = round(1000 * (now - self._last), 3)
        self._last = now
