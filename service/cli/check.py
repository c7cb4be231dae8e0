"""``mat check``: whether domains are valid, by the only judge of it, `mat_core.Domain`."""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

import mat_core
from service.cli import files
from service.cli.exits import INVALID_INPUT, OK, tell
from service.cli.report import heading, listed

ANSWER = frozenset(("segments", "graph", "certificate"))
"""Members of an answer of `mat solve`, none of which a domain has."""

AN_ANSWER = (
    "an answer, not a domain. Answers are checked before they are written, their certificate tells how; to have one checked"
    " again, solve its domain again"
)


def check(asked: argparse.Namespace) -> int:
    """Look at every file, whatever is wrong with the ones before it."""
    good = [_check(name) for name in asked.input]
    return OK if all(good) else INVALID_INPUT


def _check(name: str) -> bool:
    """Tell of one file; False when it holds no valid domain."""
    where = files.shown(name, "input")
    try:
        document = _read(files.read(name))
        if isinstance(document, dict) and document.keys() >= ANSWER:
            tell(f"{where}: {AN_ANSWER}")
            return False
        domain = mat_core.Domain.from_dict(document)
    except json.JSONDecodeError as error:
        tell(f"{where}: line {error.lineno}, column {error.colno}: {error.msg} [not-json]")
        return False
    except (ValueError, RecursionError) as error:
        if not isinstance(error, mat_core.InvalidDomain):
            tell(f"{where}: not JSON that can be read: {error} [not-json]")
            return False
        problems = [problem.to_dict() for problem in error.problems]
        tell("\n".join(heading(where, "invalid-domain", problems) + listed(problems)))
        return False
    edges, loops = sum(map(len, domain.loops)), len(domain.loops)
    sys.stdout.write(f"{where}: valid, {edges} edges in {loops} {'loops' if loops > 1 else 'loop'}, area {domain.area:.9g}\n")
    for note in domain.notes:
        sys.stdout.write(f"  {note.pointer}: {note.text}\n")
    return True


def _read(body: bytes) -> Any:
    """The document of a body; arguments of an operation may be in it, and are none of a domain's."""
    document = json.loads(body)
    if isinstance(document, dict):
        document.pop("arguments", None)
    return document
