"""What the workers run in the tests of the pool: every way a request can go, selected by its body."""

from __future__ import annotations

import json
import logging
import os
import signal
import stat
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from service.workers import wire


def preload(progress: Any) -> dict[str, str]:
    progress("nothing to compile", 1, 1)
    return {"service": "test", "algorithm": "test"}


def rehearse() -> None:
    REHEARSED.append(os.getpid())


def handle(header: dict[str, Any], body: bytes, report: Any = None) -> tuple[dict[str, Any], bytes]:
    """Do what the body says: ``{"do": name, ...}``."""
    order = json.loads(body[:1000].rstrip(b" "))
    if header.get("look"):
        return {"timings": {}}, b""
    if order["do"] == "again" and not header["unused"]:
        return {"again": True}, b""
    if report is not None:
        report("working", 0.25)
        report("finishing", 0.75)
    (answer,) = ACTIONS[order["do"]](order, body)
    return {"timings": {"solve": 0.0}, "pid": os.getpid(), "scheduling": scheduling(), "rehearsed": REHEARSED, **answer}, body


def handle_lines(header: dict[str, Any], body: bytes, send: Callable[[bytes], None]) -> dict[str, Any]:
    """Do what each line says; its result tells by whom and under which number."""
    for number, line in enumerate(body.split(b"\n"), header["first"] + 1):
        if line.strip():
            answer, _ = handle(header, line)
            if "again" in answer:
                return answer
            header["unused"] = False
            order = json.loads(line)
            result = {"line": number, "pid": os.getpid(), "answers": order, "text": "x" * order.get("size", 0)}
            send(json.dumps(result).encode())
    return {}


def scheduling() -> list[int]:
    """What this process may ask of the processors: its policy and its priority."""
    return [os.sched_getscheduler(0), os.getpriority(os.PRIO_PROCESS, 0)]


def echo(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    return ({},)


def spin(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    """Like a compiled loop: busy, and deaf to everything but SIGKILL."""
    signal.pthread_sigmask(signal.SIG_BLOCK, set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP})
    end = time.monotonic() + order["seconds"]
    while time.monotonic() < end:
        pass
    return ({},)


def work(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    """Busy for so much processor time, however long that takes."""
    end = time.process_time() + order["seconds"]
    while time.process_time() < end:
        pass
    return ({},)


def sleep(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    time.sleep(order["seconds"])
    return ({},)


def crash(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    os.kill(os.getpid(), signal.SIGSEGV)
    raise AssertionError


def fail(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    raise RuntimeError("a handler that breaks its promise")


def half(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    """End in the middle of an answer."""
    channel = next(int(entry.name) for entry in Path("/proc/self/fd").iterdir() if is_socket(entry))
    os.write(channel, wire.pack({"resident_bytes": 0, "served": 1}, 1000) + bytes(500))
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def is_socket(entry: Path) -> bool:
    try:
        return stat.S_ISSOCK(entry.stat().st_mode)
    except OSError:  # the folder itself, while it is listed
        return False


def crash_once(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    """Crash unless somebody did before."""
    try:
        os.close(os.open(order["mark"], os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return ({},)
    return crash(order, body)


def crash_in_line(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    """End in the middle of writing a line, unless somebody did before."""
    if not os.path.exists(order["mark"]):
        with open(order["file"], "ab") as file:
            file.write(b"half a li")
    return crash_once(order, body)


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


def complain(order: dict[str, Any], body: bytes) -> tuple[dict[str, Any]]:
    """Log what went wrong, and answer all the same."""
    try:
        raise ZeroDivisionError
    except ZeroDivisionError:
        logging.getLogger("tests.handlers").warning("as ordered", exc_info=True)
    return ({},)


KEPT: list[bytearray] = []
REHEARSED: list[int] = []
ACTIONS = {
    "again": echo,
    "complain": complain,
    "crash": crash,
    "crash_in_line": crash_in_line,
    "crash_once": crash_once,
    "echo": echo,
    "fail": fail,
    "grow": grow,
    "half": half,
    "refuse": refuse,
    "spin": spin,
    "work": work,
    "sleep": sleep,
}
