"""How a command can end, for scripts that look at ``$?``, and what it says on standard error."""

from __future__ import annotations

import sys

OK = 0
SOME_FAILED = 1
USAGE = 2
INVALID_INPUT = 3
NOT_CERTIFIED = 4
FAILED = 5
INTERRUPTED = 130
BROKEN_PIPE = 141
TERMINATED = 143

EXITS = {
    OK: "everything was done",
    SOME_FAILED: "batch: some domains were not solved; their lines in the output say why",
    USAGE: "the command line cannot be carried out: an option, a file that is not there, an extra that is not installed",
    INVALID_INPUT: "the input is not JSON or not a valid domain",
    NOT_CERTIFIED: "an axis was found but failed its certificate, and is withheld; check: a stored answer failed it",
    FAILED: "something else failed: a disk that is full, the workers, a defect",
    INTERRUPTED: "interrupted (Ctrl-C)",
    BROKEN_PIPE: "whoever read the output went away",
    TERMINATED: "batch: told to end (SIGTERM)",
}
"""The codes and what they say; the last three are those of a shell for SIGINT, SIGPIPE and SIGTERM."""

OF_CODE = {
    "not-json": INVALID_INPUT,
    "invalid-domain": INVALID_INPUT,
    "too-complex": INVALID_INPUT,
    "not-certified": NOT_CERTIFIED,
}
"""Codes of `service.errors` that have an exit code of their own; every other is FAILED."""


class Failure(Exception):
    """A command ends here; the message is for the person who gave it.

    Attributes
    ----------
    code : int
        The exit code.
    """

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        self.code = code


def tell(message: str) -> None:
    """A message to standard error."""
    sys.stderr.write(f"mat: {message}\n")
