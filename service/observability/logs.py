"""Every line of standard error as one JSON document, whoever wrote it.

::

    {"time": "2026-01-31T12:00:00.123Z", "level": "info", "logger": "service.access", "message": "POST /v1/mat 200",
     "request_id": "...", "trace_id": "...", ...}

Members beyond the first four come from the logging call's ``extra``. The ids are those of the request in whose context the line
was written, so that whatever is logged on the way to an answer is found by the id that the client got. This module imports no
web framework: the workers' nursery uses it, too.
"""

from __future__ import annotations

import asyncio
import logging
import sys
import traceback
from collections.abc import Mapping
from contextvars import ContextVar
from datetime import UTC, datetime
from typing import Any

import orjson

IDS: ContextVar[Mapping[str, str]] = ContextVar("IDS", default={})  # noqa: B039  # never written to
"""request_id, trace_id and span_id of the request that is being handled."""

WITH_HANDLERS_OF_THEIR_OWN = ("uvicorn", "uvicorn.error", "uvicorn.access", "dbos")
"""Loggers whose libraries print in their own way unless told otherwise."""

SILENT = "uvicorn.access"
"""Its line for each request says less than ours."""

NEEDLESS = "ezdxf"
"""Its warnings are of a list of fonts that it cannot keep where nothing may be written; nothing here needs fonts."""

OUTPUT = "service.workers.output"
"""The logger of what the nursery and the workers wrote to standard error without a logger: a crash report, say."""

_STANDARD = frozenset(vars(logging.makeLogRecord({}))) | {"message", "asctime", "taskName", "color_message"}


class JsonLines(logging.Formatter):
    """Makes a log record one line of JSON."""

    def format(self, record: logging.LogRecord) -> str:
        """The line, without its end."""
        line: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            **IDS.get(),
        }
        line.update((name, value) for name, value in vars(record).items() if name not in _STANDARD)
        if record.exc_info and record.exc_info[0] is not None:
            line["exception"] = "".join(traceback.format_exception(*record.exc_info))
        return orjson.dumps(line, default=str, option=orjson.OPT_NON_STR_KEYS | orjson.OPT_SERIALIZE_NUMPY).decode()


def install(level: str) -> None:
    """Write the log of this process as JSON lines, Python's warnings included, unless the host has set up logging itself."""
    root = logging.getLogger()
    if root.handlers:
        return
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonLines())
    root.addHandler(handler)
    root.setLevel(max(logging.INFO, logging.getLevelName(level.upper())))  # what others say while debugging is theirs
    logging.getLogger("service").setLevel(level.upper())
    logging.captureWarnings(True)
    for name in WITH_HANDLERS_OF_THEIR_OWN:
        logger = logging.getLogger(name)
        logger.handlers = [logging.NullHandler()]  # one that is there keeps the library from adding its own
        logger.propagate = name != SILENT
    logging.getLogger(SILENT).disabled = True
    logging.getLogger(NEEDLESS).setLevel(logging.ERROR)


async def forward(stream: asyncio.StreamReader) -> None:
    """Log what the processes below this one print: their lines of JSON as what they say, anything else as it is."""
    while line := await _line(stream):
        text = line.decode(errors="replace").rstrip()
        if not text:
            continue
        try:
            said = orjson.loads(text)
            name, level, message = said.pop("logger"), said.pop("level"), said.pop("message")
            extra = {f"{key}_" if key in _STANDARD else key: value for key, value in said.items() if key != "time"}
            logging.getLogger(name).log(logging.getLevelNamesMapping()[level.upper()], "%s", message, extra=extra)
        except (ValueError, LookupError, TypeError, AttributeError):
            logging.getLogger(OUTPUT).warning("%s", text)


async def _line(stream: asyncio.StreamReader) -> bytes:
    """The next line, or a first part of one that is longer than the stream's buffer."""
    try:
        return await stream.readuntil(b"\n")
    except asyncio.IncompleteReadError as ended:
        return ended.partial
    except asyncio.LimitOverrunError as overrun:
        return await stream.read(overrun.consumed)
