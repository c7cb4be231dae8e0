"""What a worker does with one request: read the body, build the domain, solve, operate, encode.

The only module of the service, with its `refusals`, that imports mat_core: its public names, the table of operations, the
formats that show their results, and outlines to rehearse with. Every failure becomes a code of `service.errors`; nothing is
raised to the process around it.
"""

from __future__ import annotations

import hashlib
import importlib
import inspect
import logging
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mat_core
from mat_core.analysis.arguments import read_arguments
from mat_core.analysis.operations import OPERATIONS, Operation, Result
from mat_core.formats import json_document
from mat_core.formats.dxf import to_dxf
from mat_core.formats.svg import render_result
from mat_core.outlines import circle, polygon
from mat_core.warm import halves
from service import __version__
from service.errors import RequestError
from service.workers import encode, execute
from service.workers.clock import Clock
from service.workers.parse import parse
from service.workers.process import die_with_parent
from service.workers.refusals import check_edges, invalid, refusals

SOLVER_OPTIONS = frozenset(inspect.signature(mat_core.medial_axis).parameters) - {"domain", "progress", "threads"}
"""What this version of the library takes; the contract knows more."""

REHEARSAL = encode.text(
    {"outer": polygon([(0, 0), (6, 0), (6, 4), (4, 5), (0, 4)], rounding=0.5), "holes": [circle((3, 2), 1.0)]}
)
"""What a worker solves before its first request; a second time would change nothing any more."""

SOLVING = (0.1, 0.9)
"""The part of a large request between reading and encoding, as far as its progress is told."""

_log = logging.getLogger("service.workers.solve")

Answer = tuple[dict[str, Any], bytes]
Report = Callable[[str, float], None]


def preload(progress: Callable[[str, int, int], None]) -> dict[str, str]:
    """Load every kernel, and what draws, before the first fork; say which versions these are.

    The compiler leaves hundreds of megabytes behind, which every worker would share. So processes that end right after it fill
    the cache first, each with half of the kernels, and this one only loads from there (or compiles, if one of them failed).
    """
    nursery = os.getpid()
    compilers = [_compiler(part, progress, nursery) for part in halves()]
    for compiler in compilers:
        os.waitpid(compiler, 0)
    mat_core.warm(None if compilers else progress)
    importlib.import_module("ezdxf")  # 0.4 s that no first drawing of a worker should wait for
    return {"service": __version__, "algorithm": mat_core.__version__}


def _compiler(part: str, progress: Callable[[str, int, int], None], nursery: int) -> int:
    """A process that compiles one half of the kernels."""
    compiler = os.fork()
    if compiler == 0:
        status = 1
        try:
            die_with_parent(nursery)
            mat_core.warm(progress, part)
            status = 0
        finally:
            os._exit(status)
    return compiler


def rehearse() -> None:
    """Make what a forked process shares its own where every request writes to it.

    The first request of a worker would take 11 ms instead of 5 otherwise (a glyph), and each new worker would be felt.
    """
    handle({"operation": "mat", "format": "json"}, REHEARSAL)


def handle(header: dict[str, Any], body: bytes, report: Report | None = None) -> Answer:
    """Answer one request.

    Parameters
    ----------
    header : dict
        ``operation``: mat or one of `mat_core.analysis.operations`; ``format``: one that it is answered in. And if wanted:
        ``precision``: significant digits; ``gzip``: whether the client takes that; ``most_edges`` and
        ``most_control_points``: the limits of the operator; ``keep``: the folder for bodies of failed answers;
        ``execute``: for the execute request of a process, the format of each media type it offers; ``look``: only to tell
        which format that asks for (frame), and what is wrong with the domain and all else, too (domain). ``unused``: whether this
        worker has all of its memory left.
    body : bytes
        The request's body, expanded.
    report : callable, optional
        Called with the stage that begins and the fraction that is done.

    Returns
    -------
    tuple of (dict, bytes)
        ``{"timings": ..., "format": ..., "gzip": ..., "whole": ...}`` with the encoded answer, or ``{"error": ...}`` with code,
        detail and extra members, or ``{"again": True}``: memory ran out that earlier requests may have kept, another worker
        should try.
    """
    try:
        return _solve(header, body, report)
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
        _keep(header.get("keep"), body)
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
            content = encode.text(error.document())
        send(content)
        unused = False
    return {}


def _solve(order: dict[str, Any], body: bytes, report: Report | None) -> Answer:
    """Read, solve, operate, encode; what was wrapped is wrapped again."""
    clock = Clock()
    content, strict_error = parse(body)
    frame = None
    if order.get("execute"):
        frame = execute.unwrap(content, order["execute"])
        order = {**order, "format": frame.form or order["format"]}
        content = frame.body
    whole = frame is not None and frame.whole
    form, look = order["format"], order.get("look")
    answer = b""
    try:
        if look == "domain":
            _read(content, OPERATIONS.get(order["operation"]), order, strict_error)
        elif look is None:
            answer = _answer(order, content, strict_error, clock, report)
    except RequestError as refusal:
        if frame is not None:
            frame.relocate(refusal.extra.get("problems", []))
        raise
    if look is not None:
        return {"timings": clock.laps, "format": form, "whole": whole}, b""
    if whole:
        media_type = next(name for name, offered in order["execute"].items() if offered == form)
        answer = execute.wrap(answer, media_type)
    zipped = False
    if order.get("gzip"):
        answer, zipped = encode.compressed(answer)
        clock.lap("compress")
    return {"timings": clock.laps, "format": form, "gzip": zipped, "whole": whole}, answer


def _answer(
    order: dict[str, Any], content: Any, strict_error: RequestError | None, clock: Clock, report: Report | None
) -> bytes:
    """The answer to a domain, with arguments where the operation has some."""
    operation = OPERATIONS.get(order["operation"])
    if report is not None:
        report("read", 0.0)
    domain, arguments = _read(content, operation, order, strict_error)
    clock.lap("read")
    options = dict(domain.options)
    samples = options.pop("samples", False)
    with refusals("/options"):
        for option in options.keys() - SOLVER_OPTIONS:
            raise mat_core.UnsupportedOption(option, "it is not available in this version")
        axis = mat_core.medial_axis(domain, **options, progress=_within(report))
    clock.lap("solve")
    if report is not None:
        report("encode" if operation is None else operation.name, SOLVING[1])
    if operation is None:
        encoded = _encode_axis(axis, order, samples)
    else:
        with refusals("/arguments"):
            result = operation.call(axis, **arguments)
        clock.lap("operate")
        encoded = _encode_result(operation, axis, arguments, result, order)
    clock.lap("encode")
    return encoded


def _within(report: Report | None) -> Report | None:
    """What the library reports of its stages, as a part of the request."""
    if report is None:
        return None
    begin, end = SOLVING
    return lambda stage, fraction: report(stage, begin + (end - begin) * fraction)


def _encode_axis(axis: mat_core.MedialAxis, order: dict[str, Any], samples: bool) -> bytes:
    """The axis in one of the formats of /v1/mat."""
    form = order["format"]
    if form == "svg":
        return axis.to_svg().encode()
    if form == "dxf":
        return axis.to_dxf().encode()
    if form == "geojson":
        text = encode.text(axis.to_geojson())
    else:
        text = json_document.encode(axis, samples, service=__version__)
    return encode.encode(text, form, order.get("precision"), axis.domain.size)


def _encode_result(
    operation: Operation, axis: mat_core.MedialAxis, arguments: dict[str, Any], result: Result, order: dict[str, Any]
) -> bytes:
    """A result in one of the formats of its route: a document, or its curves as a picture or a drawing."""
    form = order["format"]
    if form in ("json", "msgpack"):
        asked = {"operation": operation.name, "arguments": arguments}
        document = {**asked, "result": result.to_dict(), **json_document.about(axis, service=__version__)}
        return encode.encode(encode.text(document), form, order.get("precision"), axis.domain.size)
    assert operation.paths is not None, "only what has curves is offered as a drawing"
    paths = operation.paths(result)
    if form == "dxf":
        return to_dxf(axis, paths, operation.name).encode()
    return render_result(axis, paths, operation.name, fill=operation.encloses).encode()


def _read(
    content: Any, operation: Operation | None, order: dict[str, Any], strict_error: RequestError | None
) -> tuple[mat_core.Domain, dict[str, Any]]:
    """The domain of a body, and the arguments of an operation; the faults of both come together."""
    arguments: dict[str, Any] = {}
    problems: list[mat_core.Problem] = []
    if operation is not None and isinstance(content, dict):
        given = content.pop("arguments", None)
        arguments = read_arguments(operation.arguments, given, problems, operation.at_least_one)
    limits = {}
    if "most_control_points" in order:
        limits["max_control_points"] = order["most_control_points"]
        check_edges(content, order["most_edges"])
    try:
        domain = mat_core.Domain.from_dict(content, **limits)
    except mat_core.InvalidDomain as refusal:
        raise invalid([*problems, *refusal.problems]) from refusal
    if problems:
        raise invalid(problems)
    if strict_error is not None:
        raise strict_error
    return domain, arguments


def _keep(folder: str | None, body: bytes) -> None:
    """Keep a body for reproduction, where the operator allows it; a full disk must not turn into another failure."""
    if folder is None:
        return
    name = hashlib.sha256(body).hexdigest()[:32]
    try:
        (Path(folder) / f"{name}.json").write_bytes(body)
    except OSError as error:
        _log.warning("could not keep a failed request: %s", error)
