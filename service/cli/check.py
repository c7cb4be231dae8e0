"""``mat check``: whether domains are valid, by the only judge of it, `mat_core.Domain`, and whether stored answers are right."""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

import mat_core
from service.cli import files
from service.cli.exits import INVALID_INPUT, NOT_CERTIFIED, OK, tell
from service.cli.report import heading, listed

ANSWER = frozenset(("segments", "graph", "certificate"))
"""Members of an answer of `mat solve`, none of which a domain has."""

AN_ANSWER = "an answer, not a domain; give its domain by --domain to have it certified anew"


class _Unusable(Exception):
    """A file holds nothing that can be looked at; the message says why."""


def check(asked: argparse.Namespace) -> int:
    """Look at every file, whatever is wrong with the ones before it."""
    try:
        domain = None if asked.domain is None else _domain(asked.domain, _document(asked.domain))
    except _Unusable as error:
        tell(str(error))
        return INVALID_INPUT
    found = [_check(name) if domain is None else _certify(name, domain) for name in asked.input]
    return next((code for code in (INVALID_INPUT, NOT_CERTIFIED) if code in found), OK)


def _check(name: str) -> int:
    """Tell of one file with a domain."""
    try:
        document = _document(name)
        if isinstance(document, dict) and document.keys() >= ANSWER:
            raise _Unusable(f"{files.shown(name, 'input')}: {AN_ANSWER}")
        domain = _domain(name, document)
    except _Unusable as error:
        tell(str(error))
        return INVALID_INPUT
    edges, loops = sum(map(len, domain.loops)), len(domain.loops)
    where, plural = files.shown(name, "input"), "loops" if loops > 1 else "loop"
    sys.stdout.write(f"{where}: valid, {edges} edges in {loops} {plural}, area {domain.area:.9g}\n")
    for note in domain.notes:
        sys.stdout.write(f"  {note.pointer}: {note.text}\n")
    return OK


def _certify(name: str, domain: mat_core.Domain) -> int:
    """Tell of one file with an answer."""
    from mat_core.formats.stored_answer import certify_answer

    where = files.shown(name, "input")
    try:
        certificate = certify_answer(_document(name), domain)
    except _Unusable as error:
        tell(str(error))
        return INVALID_INPUT
    except mat_core.NotCertified as error:
        place = f" at ({error.place[0]:.9g}, {error.place[1]:.9g})" if error.place else ""
        tell(f"{where}: not certified{place}: {error.detail} [not-certified]")
        return NOT_CERTIFIED
    except ValueError as error:
        tell(f"{where}: {error} [not-json]")
        return INVALID_INPUT
    checks = certificate["checks"]
    error_told = checks["curves_tolerance"]["measured"] if "curves_tolerance" in checks else 0.0
    sys.stdout.write(f"{where}: certified anew, {len(checks)} checks, curves within {error_told:.3g} of the size\n")
    return OK


def _domain(name: str, document: Any) -> mat_core.Domain:
    """The domain of a document; arguments of an operation may be in it, and are none of a domain's."""
    if isinstance(document, dict):
        document.pop("arguments", None)
    try:
        return mat_core.Domain.from_dict(document)
    except mat_core.InvalidDomain as error:
        problems = [problem.to_dict() for problem in error.problems]
        lines = heading(files.shown(name, "input"), "invalid-domain", problems) + listed(problems)
        raise _Unusable("\n".join(lines)) from error


def _document(name: str) -> Any:
    """What a file says."""
    where = files.shown(name, "input")
    try:
        return json.loads(files.read(name))
    except json.JSONDecodeError as error:
        raise _Unusable(f"{where}: line {error.lineno}, column {error.colno}: {error.msg} [not-json]") from error
    except (ValueError, RecursionError) as error:
        raise _Unusable(f"{where}: not JSON that can be read: {error} [not-json]") from error
