"""The command ``mat``: solve, check and serve from a terminal, a script or a cluster's scheduler.

Nothing here needs a running service. ``solve`` and ``batch`` do with a domain exactly what a POST would (`service.workers`), so
that their answers are the same bytes; ``check`` asks only `mat_core.Domain`; ``outlines`` reads the files that people have
(`mat_core.outlines`); ``serve`` starts the service. Everything beyond the standard library is imported when a command needs it: a
missing extra is told in a sentence, and help is there at once.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from service.cli.arguments import parse
from service.cli.exits import BROKEN_PIPE, INTERRUPTED, USAGE, Failure, tell

__all__ = ["main"]

EXTRA = frozenset(
    "dbos ezdxf fastapi isal msgpack orjson prometheus_client psycopg pydantic sqlalchemy starlette tqdm uvicorn".split()  # noqa: SIM905
)
"""The modules that come with the extra service."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the program's name; those of this process when left out.

    Returns
    -------
    int
        The exit code, see `service.cli.exits`.
    """
    try:
        return _run(arguments)
    except Failure as failure:
        tell(str(failure))
        return failure.code
    except ModuleNotFoundError as missing:
        if missing.name not in EXTRA:
            raise
        tell(f"this needs {missing.name}, which comes with the extra 'service': pip install 'mat-core[service]'")
        return USAGE
    except KeyboardInterrupt:
        tell("interrupted")
        return INTERRUPTED
    except BrokenPipeError:
        # whoever read has gone; the interpreter must not try to flush what is left
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE


def _run(arguments: Sequence[str] | None) -> int:
    """Parse, then import the module of the command and call it."""
    asked = parse(arguments)
    if asked.command == "solve":
        from service.cli.solve import solve

        return solve(asked)
    if asked.command == "batch":
        from service.cli.batch import batch

        return batch(asked)
    if asked.command == "check":
        from service.cli.check import check

        return check(asked)
    if asked.command == "outlines":
        from service.cli.outlines import outlines

        return outlines(asked)
    from service.cli.serve import serve

    return serve(asked)
