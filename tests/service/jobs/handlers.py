"""What the workers run in the tests of jobs: a body says what becomes of it, and each piece of work leaves a line in a file."""

from __future__ import annotations

import json
import os
import signal
import time
from collections.abc import Callable
from typing import Any

from service.errors import RequestError

DONE = "TEST_DONE"
"""The environment variable that names the file with a line for each body that was worked on to its end."""


def preload(progress: Callable[[str, int, int], None]) -> dict[str, str]:
    progress("nothing to compile", 1, 1)
    return {"service": "test", "algorithm": "test"}


def rehearse() -> None:
    """Nothing here is written to by every request."""


def handle(header: dict[str, Any], body: bytes, report: Any = None) -> tuple[dict[str, Any], bytes]:
    """Do what the body says: ``{"name": ..., "seconds": ..., "error": ..., "crash": ...}``, all of it optional."""
    try:
        order = json.loads(body)
    except ValueError:
        return {"error": {"code": "not-json", "detail": "as it came", "extra": {}}}, b""
    if header.get("look"):
        time.sleep(order.get("look_seconds", 0.0))
        return {"timings": {}, "format": header["format"], "whole": False}, b""
    if report is not None:
        report("solve", 0.5)
    if order.get("crash"):
        os.kill(os.getpid(), signal.SIGSEGV)
    end = time.monotonic() + order.get("seconds", 0.0)
    while time.monotonic() < end:
        pass
    if "error" in order:
        return {"error": {"code": order["error"], "detail": "as ordered", "extra": {"problems": order.get("problems", [])}}}, b""
    if DONE in os.environ:
        with open(os.environ[DONE], "a") as done:
            done.write(f"{order.get('name')}\n")
    return {"timings": {"solve": 0.0}}, json.dumps({"did": order}).encode()


def handle_lines(header: dict[str, Any], body: bytes, send: Callable[[bytes], None]) -> dict[str, Any]:
    for number, line in enumerate(body.split(b"\n"), header["first"] + 1):
        if line.strip():
            outcome, content = handle(header, line)
            if "error" in outcome:
                error = RequestError(**outcome["error"])
                error.extra["line"] = number
                content = json.dumps(error.document(), separators=(",", ":")).encode()
            send(content)
    return {}
