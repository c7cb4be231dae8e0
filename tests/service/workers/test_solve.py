"""What a worker does with its requests, in this process and with the real library."""

from __future__ import annotations

import json
from typing import Any

import pytest

import mat_core
from mat_core.threads import VARIABLE
from service.workers import nursery_link, solve
from tests.service.live import ROOT

PLATE = (ROOT / "openapi" / "examples" / "plate.json").read_bytes().replace(b"\n", b" ")
HEADER = {"operation": "mat", "format": "json", "keep": None}


def lines(*body: bytes, first: int = 0, **header: Any) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    sent: list[bytes] = []
    outcome = solve.handle_lines({**HEADER, "first": first, **header}, b"\n".join(body), sent.append)
    assert not any(b"\n" in line for line in sent)
    return [json.loads(line) for line in sent], outcome


def test_the_rehearsal_is_a_domain_that_is_solved() -> None:
    outcome, _ = solve.handle(HEADER, solve.REHEARSAL)
    assert "error" not in outcome
    solve.rehearse()


def test_each_line_is_answered_as_the_body_of_a_request() -> None:
    found, outcome = lines(PLATE, b"", PLATE, b" ")
    _, answer = solve.handle(HEADER, PLATE)
    assert found == [json.loads(answer)] * 2
    assert outcome == {}


def test_a_worker_uses_one_thread_whatever_a_client_asks_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "8")
    assert nursery_link._environment()[VARIABLE] == "1"
    found, _ = lines(json.dumps(json.loads(PLATE) | {"options": {"threads": 8}}).encode())
    assert [problem["pointer"] for problem in found[0]["problems"]] == ["/options/threads"]


def test_faults_name_the_line_of_the_batch() -> None:
    found, _ = lines(b"{", PLATE, b"", b'{"outer": []}', b"[1, 2", first=500)
    assert [line.get("code") for line in found] == ["not-json", None, "invalid-domain", "not-json"]
    assert [line.get("line") for line in found] == [501, None, 504, 505]
    assert found[0]["status"] == 400
    assert found[3]["column"] == 6
    assert found[2]["problems"][0]["pointer"] == "/outer"


def test_analyses_take_their_arguments_line_by_line() -> None:
    body = json.loads(PLATE)
    given = [json.dumps(body | {"arguments": {"distance": distance}}).encode() for distance in (0.1, 0.2)]
    found, _ = lines(*given, json.dumps(body).encode(), operation="offset")
    assert [line.get("arguments") for line in found[:2]] == [{"distance": 0.1}, {"distance": 0.2}]
    assert found[2]["problems"][0]["pointer"] == "/arguments/distance"


def out_of_memory(*_: Any, **__: Any) -> None:
    raise MemoryError


def test_memory_that_runs_out_is_the_request_s_fault_only_in_an_unused_worker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mat_core, "medial_axis", out_of_memory)
    refused, _ = solve.handle({**HEADER, "unused": True}, PLATE)
    assert refused["error"]["code"] == "too-complex"
    assert solve.handle({**HEADER, "unused": False}, PLATE) == ({"again": True}, b"")
    assert lines(PLATE, PLATE, unused=False) == ([], {"again": True})
    found, outcome = lines(PLATE, PLATE, unused=True)
    assert [line["code"] for line in found] == ["too-complex"]
    assert outcome == {"again": True}


def test_progress_rises_from_reading_to_encoding() -> None:
    told: list[tuple[str, float]] = []
    quiet = solve.handle(HEADER, PLATE)[1]
    answer = solve.handle(HEADER, PLATE, lambda *what: told.append(what))[1]
    assert answer == quiet
    stages = [stage for stage, _ in told]
    assert stages == ["read", "sites", "skeleton", "graph", "curves", "certificate", "encode"]
    fractions = [fraction for _, fraction in told]
    assert fractions == sorted(fractions)
    assert fractions[0] == 0.0
    assert fractions[-1] < 1.0


def test_progress_of_an_analysis_names_it() -> None:
    told: list[str] = []
    solve.handle({**HEADER, "operation": "inscribed-disc"}, PLATE, lambda stage, _: told.append(stage))
    assert told[-1] == "inscribed-disc"


def test_progress_is_no_option_of_a_domain() -> None:
    body = json.dumps(json.loads(PLATE) | {"options": {"progress": True}}).encode()
    assert solve.handle(HEADER, body)[0]["error"]["code"] == "invalid-domain"
