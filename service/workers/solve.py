"""What a worker does with one request: read the body, build the domain, solve, operate, encode.

The only module of the service that imports mat_core: its public names, the table of operations, and the formats that show
their results. Every failure becomes a code of `service.errors`; nothing is raised to the process around it.
"""

from __future__ import annotations

import hashlib
import importlib
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
from mat_core.analysis.arguments import read_arguments
from mat_core.analysis.operations import OPERATIONS, Operation, Result
from mat_core.formats.dxf import to_dxf
from mat_core.formats.json_document import about
from mat_core.formats.svg import render_result
from service import __version__
from service.errors import RequestError
from service.workers.process import die_with_parent
from service.workers.safe_json import loads

MAX_PROBLEMS = 1000
"""Problems listed in one answer; a body of garbage would otherwise be answered by a larger one."""

SOLVER_OPTIONS = frozenset(inspect.signature(mat_core.medial_axis).parameters) - {"domain", "progress"}
"""What this version of the library takes; the contract knows more."""

SOLVING = (0.1, 0.9)
"""The part of a large request between reading and encoding, as far as its progress is told."""

_log = logging.getLogger("service.workers.solve")

Answer = tuple[dict[str, Any], bytes]
Report = Callable[[str, float], None]


def preload(progress: Callable[[str, int, int], None]) -> dict[str, str]:
    """Load every kernel, and what draws, before the first fork; say which versions these are.

    The compiler leaves hundreds of megabytes behind, which every worker would share. So a process that ends right after it fills
    the cache first, and this one only loads from there (or compiles after all, if that process failed).
    """
    nursery = os.getpid()
    compiler = os.fork()
    if compiler == 0:
        status = 1
        try:
            die_with_parent(nursery)
            mat_core.warm(progress=progress)
            status = 0
        finally:
            os._exit(status)
    os.waitpid(compiler, 0)
    mat_core.warm()
    importlib.import_module("ezdxf")  # 0.4 s that no first drawing of a worker should wait for
    return {"service": __version__, "algorithm": mat_core.__version__}


def handle(header: dict[str, Any], body: bytes, report: Report | None = None) -> Answer:
    """Answer one request.

    Parameters
    ----------
    header : dict
        ``operation``: mat or one of `mat_core.analysis.operations`; ``format``: one that it is answered in; ``keep``: the
        folder for bodies of failed answers, or None; ``unused``: whether this worker has all of its memory left.
    body : bytes
        The request's body as it came.
    report : callable, optional
        Called with the stage that begins and the fraction that is done.

    Returns
    -------
    tuple of (dict, bytes)
        ``{"timings": ...}`` with the encoded answer, or ``{"error": ...}`` with code, detail and extra members, or
        ``{"again": True}``: memory ran out that earlier requests may have kept, another worker should try.
    """
    try:
        return _solve(header["operation"], header["format"], body, report)
    except RequestError as refusal:
        error = refusal
    except MemoryError:
        if not header.get("unused", True):
            return {"again": True}, b""
        error = RequestError("too-complex", "Solving this domain takes more memory than one request may use. Split it.")
    except Exception:
        _log.exception("a request failed where it must not")
        error = RequestError("internal-error", "An unexpected failure; it is in the service's log.")
    if error.code in ("not-certified", "internal-error"):
        _keep(header["keep"], body)
    return {"error": {"code": error.code, "detail": error.detail, "extra": error.extra}}, b""


def handle_lines(header: dict[str, Any], body: bytes, send: Callable[[bytes], None]) -> dict[str, Any]:
    """Answer a chunk of a batch: each line that is not blank is a request of its own, with one result line.

    Parameters
    ----------
    header : dict
        As for `handle`; the format must be one whose answers have no newline. ``first``: how many lines of the batch come before.
    body : bytes
        JSON lines.
    send : callable
        Takes each result line, without its newline, as soon as it is there: an answer document or a problem document.

    Returns
    -------
    dict
        Empty, or ``{"again": True}``: the line after the last result should be tried by another worker, see `handle`.
    """
    unused = header.get("unused", True)
    for number, line in enumerate(body.split(b"\n"), header["first"] + 1):
        if not line.strip():
            continue
        outcome, content = handle({**header, "unused": unused}, line)
        if "again" in outcome:
            return outcome
        if "error" in outcome:
            error = RequestError(**outcome["error"])
            error.extra["line"] = number  # of the batch, where a body of its own would say which of its lines
            content = _json(error.document())
        send(content)
        unused = False
    return {}


def _solve(name: str, form: str, body: bytes, report: Report | None) -> Answer:
    clock = Clock()
    operation = OPERATIONS.get(name)
    if report is not None:
        report("read", 0.0)
    domain, arguments = _read(body, operation)
    clock.lap("read")
    options = dict(domain.options)
    samples = options.pop("samples", False)
    try:
        for option in options.keys() - SOLVER_OPTIONS:
            raise mat_core.UnsupportedOption(option, "it is not available in this version")
        axis = mat_core.medial_axis(domain, **options, progress=_within(report))
    except mat_core.UnsupportedOption as refusal:
        raise _unsupported(refusal, "/options") from refusal
    except mat_core.NotCertified as failure:
        raise _not_certified(failure) from failure
    clock.lap("solve")
    if report is not None:
        report("encode" if operation is None else operation.name, SOLVING[1])
    if operation is None:
        content = _encode_axis(axis, form, samples)
    else:
        result = _operate(operation, axis, arguments)
        clock.lap("operate")
        content = _encode_result(operation, axis, arguments, result, form)
    clock.lap("encode")
    return {"timings": clock.laps}, content


def _within(report: Report | None) -> Report | None:
    """What the library reports of its stages, as a part of the request."""
    if report is None:
        return None
    begin, end = SOLVING
    return lambda stage, fraction: report(stage, begin + (end - begin) * fraction)


def _operate(operation: Operation, axis: mat_core.MedialAxis, arguments: dict[str, Any]) -> Result:
    """The operation on an axis."""
    try:
        return operation.call(axis, **arguments)
    except mat_core.UnsupportedOption as refusal:
        raise _unsupported(refusal, "/arguments") from refusal
    except mat_core.NotCertified as failure:
        raise _not_certified(failure) from failure


def _encode_axis(axis: mat_core.MedialAxis, form: str, samples: bool) -> bytes:
    """The axis in one of the formats of /v1/mat."""
    if form == "svg":
        return axis.to_svg().encode()
    if form == "dxf":
        return axis.to_dxf().encode()
    return _json(axis.to_geojson() if form == "geojson" else _versioned(axis.to_dict(samples=samples)))


def _encode_result(
    operation: Operation, axis: mat_core.MedialAxis, arguments: dict[str, Any], result: Result, form: str
) -> bytes:
    """A result in one of the formats of its route: JSON, or its curves as a picture or a drawing."""
    if form == "json":
        asked = {"operation": operation.name, "arguments": arguments}
        return _json({**asked, "result": result.to_dict(), **_versioned(about(axis))})
    assert operation.paths is not None, "only what has curves is offered as a drawing"
    paths = operation.paths(result)
    if form == "dxf":
        return to_dxf(axis, paths, operation.name).encode()
    return render_result(axis, paths, operation.name, fill=operation.encloses).encode()


def _versioned(document: dict[str, Any]) -> dict[str, Any]:
    """The document with the version of the service in it."""
    return {**document, "version": {**document["version"], "service": __version__}}


def _json(document: dict[str, Any]) -> bytes:
    return orjson.dumps(document, option=orjson.OPT_SERIALIZE_NUMPY)


def _read(body: bytes, operation: Operation | None) -> tuple[mat_core.Domain, dict[str, Any]]:
    """The domain of a body, and the arguments of an operation; the faults of both come together.

    NaN and Infinity are not JSON, but the likely slip of a program that wrote the body; so they are read, and reported
    like every other fault of the domain with the place where they stand.
    """
    try:
        content = loads(body)
        strict_error = None
    except orjson.JSONDecodeError as error:
        strict_error = _not_json(error)
        content = _with_non_finite_numbers(body, strict_error)
    arguments: dict[str, Any] = {}
    problems: list[mat_core.Problem] = []
    if operation is not None and isinstance(content, dict):
        given = content.pop("arguments", None)
        arguments = read_arguments(operation.arguments, given, problems, operation.at_least_one)
    try:
        domain = mat_core.Domain.from_dict(content)
    except mat_core.InvalidDomain as invalid:
        raise _invalid([*problems, *invalid.problems]) from invalid
    if problems:
        raise _invalid(problems)
    if strict_error is not None:
        raise strict_error
    return domain, arguments


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


def _invalid(found: list[mat_core.Problem]) -> RequestError:
    """The answer to an invalid domain: all its problems, as far as a person would read them."""
    count = len(found)
    problems = [problem.to_dict() for problem in found[:MAX_PROBLEMS]]
    too_complex = all(problem["code"] == "too-complex" for problem in problems)
    detail = "1 problem, see problems." if count == 1 else f"{count} problems, see problems."
    if count > MAX_PROBLEMS:
        detail += f" The first {MAX_PROBLEMS} are listed."
    return RequestError("too-complex" if too_complex else "invalid-domain", detail, {"problems": problems})


def _unsupported(refusal: mat_core.UnsupportedOption, member: str) -> RequestError:
    """The answer to options or arguments that are well formed one by one but do not go together, or with this domain."""
    problem = {"code": "unsupported-option", "pointer": f"{member}/{refusal.option}", "message": str(refusal)}
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
