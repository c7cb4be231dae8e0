"""What the workers run in the tests of the pool: every way a request can go, selected by its body."""

from __future__ import annotations

import json
import os
import signal
import time
from typing import Any


def preload(progress: Any) -> dict[str, str]:
    progress("nothing to compile", 1, 1)
    return {"service": "test", "algorithm": "test"}


def handle(header: dict[str, Any], body: bytes, report: Any = None) -> tuple[dict[str, Any], bytes]:
    """Do what the body says: ``{"do": name, ...}``."""
    order = json.loads(body[:1000].rstrip(b" "))
    return {"timings": {"solve": 0.0}, "pid": os.getpid()} | ACTIONS[order["do"]](order, body)[0], body


def echo(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    return ({},)


def spin(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    """Like a compiled loop: busy, and deaf to everything but SIGKILL."""
    signal.pthread_sigmask(signal.SIG_BLOCK, set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP})
    end = time.monotonic() + order["seconds"]
    while time.monotonic() < end:
        pass
    return ({},)


def crash(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    os.kill(os.getpid(), signal.SIGSEGV)
    raise AssertionError


def fail(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    raise RuntimeError("a handler that breaks its promise")


def grow(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    """Claim memory and keep it."""
    try:
        KEPT.append(bytearray(order["bytes"]))
    except MemoryError:
        return ({"refused": True},)
    return ({"refused": False},)


def refuse(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    """Answer with an error of the table."""
    return ({"error": {"code": order["code"], "detail": "as ordered", "extra": order.get("extra", {})}},)


KEPT: list[bytearray] = []
ACTIONS = {"echo": echo, "spin": spin, "crash": crash, "fail": fail, "grow": grow, "refuse": refuse}
