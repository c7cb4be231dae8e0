"""Every line of standard error is one JSON document, and belongs to the request in whose context it was written."""

from __future__ import annotations

import asyncio
import json
import logging
import re
import subprocess
import sys
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from service.app import create_app
from service.observability.logs import IDS, OUTPUT, JsonLines, forward
from service.settings import Settings
from tests.service.live import ROOT

HANDLER = "tests.service.handlers"
TRACE = "0af7651916cd43dd8448eb211c80319c"


def formatted(record: logging.LogRecord) -> dict[str, object]:
    text = JsonLines().format(record)
    assert "\n" not in text
    document: dict[str, object] = json.loads(text)
    return document


def record(message: str, *arguments: object, **extra: object) -> logging.LogRecord:
    return logging.getLogger("service.test").makeRecord(
        "service.test", logging.WARNING, __file__, 1, message, arguments, None, extra=extra
    )


def test_a_line_has_its_time_its_level_its_logger_and_what_was_said() -> None:
    line = formatted(record("ended %d\nof %s", 3, "five", code="x", sizes=(1, 2)))
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z", line.pop("time"))
    assert line == {
        "level": "warning", "logger": "service.test", "message": "ended 3\nof five", "code": "x", "sizes": [1, 2],
    }  # fmt: skip


def test_what_json_cannot_hold_is_spelled_out() -> None:
    line = formatted(record("odd", thing=object, number=float("nan"), by_number={1: 2}))
    assert (line["thing"], line["number"], line["by_number"]) == (str(object), None, {"1": 2})


def test_an_exception_is_in_its_line() -> None:
    try:
        raise ZeroDivisionError("here")
    except ZeroDivisionError:
        broken = logging.getLogger("t").makeRecord("t", logging.ERROR, __file__, 1, "failed", (), sys.exc_info())
    assert formatted(broken)["exception"].endswith("ZeroDivisionError: here\n")


def test_a_line_written_during_a_request_carries_its_ids() -> None:
    token = IDS.set({"request_id": "r", "trace_id": TRACE})
    try:
        line = formatted(record("on the way"))
    finally:
        IDS.reset(token)
    assert (line["request_id"], line["trace_id"]) == ("r", TRACE)
    assert "request_id" not in formatted(record("afterwards"))


def test_what_workers_print_is_passed_on(caplog: pytest.LogCaptureFixture) -> None:
    """A line of their log as what it says, a crash report or anything else as it is, however long."""
    said = b'{"time":"t","level":"error","logger":"service.x","message":"100 % bad","request_id":"r","name":"n","code":5}'
    lines = [said, b"Fatal Python error: Aborted", b"", b"x" * 3000, b'{"time": 1}', b"[]", b"\xff", b"no end"]

    async def run() -> None:
        stream = asyncio.StreamReader(limit=1500)
        stream.feed_data(b"\n".join(lines))
        stream.feed_eof()
        await forward(stream)

    asyncio.run(run())
    first, *others = caplog.records
    assert (first.name, first.levelname, first.getMessage()) == ("service.x", "ERROR", "100 % bad")
    assert vars(first).items() >= {"request_id": "r", "code": 5, "name_": "n"}.items()
    assert {entry.name for entry in others} == {OUTPUT}
    assert [entry.getMessage() for entry in others] == [line.decode(errors="replace") for line in lines[1:] if line]


def test_a_worker_s_own_lines_are_json_and_carry_the_request_s_id(tmp_path: Path) -> None:
    """A crash report of the interpreter, and the line of a handler that failed where it must not."""
    program = f"""
from starlette.testclient import TestClient
from service.app import create_app
from service.settings import Settings
from tests.service.test_app import wait_until_ready
from pathlib import Path
with TestClient(create_app(Settings(workers=1, data_dir=Path({str(tmp_path)!r})), {HANDLER!r})) as client:
    wait_until_ready(client)
    for do in ("crash", "complain"):
        client.post("/v1/mat", content='{{"do": "%s"}}' % do, headers={{"X-Request-ID": do, "Content-Type": "application/json"}})
"""
    ended = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    lines = [json.loads(line) for line in ended.stderr.splitlines()]
    assert any(line["logger"] == OUTPUT and "Segmentation fault" in line["message"] for line in lines)
    (complaint,) = (line for line in lines if line["logger"] == "tests.handlers")
    assert (complaint["level"], complaint["message"], complaint["request_id"]) == ("warning", "as ordered", "complain")
    assert "in complain\n" in complaint["exception"]


def test_each_answer_is_one_line_with_its_ids_sizes_times_and_code(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    headers = {"X-Request-ID": "logged", "traceparent": f"00-{TRACE}-b7ad6b7169203331-01", "Content-Type": "application/json"}
    app = create_app(Settings(workers=1, data_dir=tmp_path), HANDLER)
    with TestClient(app) as client, caplog.at_level("INFO", "service.access"):
        answered = client.post("/v1/mat", content=b'{"do": "echo"}', headers=headers)
        client.post("/v1/mat", content=b"x" * 10, headers={"Content-Type": "text/plain"})
        client.get("/healthz")
    good, bad = (entry for entry in caplog.records if entry.name == "service.access")
    assert vars(good).items() >= {
        "method": "POST", "path": "/v1/mat", "route": "/v1/mat", "status": 200, "code": None, "bytes_in": 14,
        "bytes_out": len(answered.content),
    }.items()  # fmt: skip
    line = vars(good)
    assert line["ms"] >= line["queue_ms"] >= 0
    assert line["compute_ms"] >= 0
    assert vars(bad).items() >= {"status": 415, "code": "unsupported-media-type"}.items()


def test_the_whole_process_speaks_json(tmp_path: Path) -> None:
    """The server's own lines, a warning of Python's, and one of a library that prints in its own way."""
    program = """
import logging, warnings, uvicorn
from service.observability import logs
config = uvicorn.Config("service.app:create_app", factory=True)   # sets up handlers of its own
logs.install("info")
logging.getLogger("uvicorn.error").info("Started server process [%d]", 1)
logging.getLogger("uvicorn.access").info("never shown")
logging.getLogger("dbos").warning("from the store")
logging.getLogger("service.x").debug("too quiet")
logs.install("debug")
warnings.warn("careful")
"""
    ended = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    lines = [json.loads(line) for line in ended.stderr.splitlines()]
    assert [line["logger"] for line in lines] == ["uvicorn.error", "dbos", "py.warnings"]
    assert lines[0]["message"] == "Started server process [1]"
    assert "careful" in lines[2]["message"]
