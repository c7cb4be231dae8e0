"""``mat solve``: one domain, in this process."""

from __future__ import annotations

import argparse
import contextlib
import signal
from collections.abc import Iterator

from service.cli import files
from service.cli.arguments import LINE_FORMATS
from service.cli.exits import OK
from service.cli.progress import waiting
from service.cli.report import refusal
from service.cli.request import additions, form_of, header, with_additions


def solve(asked: argparse.Namespace) -> int:
    """Read, solve, write."""
    form = form_of(asked)
    told, members = header(asked, form), additions(asked)
    body = with_additions(files.read(asked.input), members)
    with _interruptible(), waiting("loading, which takes a minute the first time:") as stage:
        from service.workers.solve import handle

        meta, content = handle(told, body, lambda name, fraction: stage(f"{name}, {fraction:.0%}:"))
    if "error" in meta:
        raise refusal(files.shown(asked.input, "input"), meta["error"])
    for_eyes = asked.output == files.STANDARD and form in LINE_FORMATS
    files.write(asked.output, content + b"\n" if for_eyes else content)
    return OK


@contextlib.contextmanager
def _interruptible() -> Iterator[None]:
    """Let Ctrl-C end the process at once: a compiled loop would not look at Python's own handler before it ends."""
    before = signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
