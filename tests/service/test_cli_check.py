"""`mat check --domain`: stored answers certified anew."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from service.cli.__main__ import main
from service.cli.exits import INVALID_INPUT, NOT_CERTIFIED, OK, USAGE
from tests.service.live import ROOT

PLATE = ROOT / "openapi" / "examples" / "plate.json"


@pytest.fixture
def answer(tmp_path: Path) -> Path:
    path = tmp_path / "answer.json"
    assert main(["solve", str(PLATE), "-o", str(path)]) == OK
    return path


def test_a_right_answer_is_certified_anew(answer: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(answer), "--domain", str(PLATE)]) == OK
    assert f"{answer}: certified anew, " in capsys.readouterr().out


def test_a_changed_answer_is_refused_with_check_and_place(answer: Path, capsys: pytest.CaptureFixture[str]) -> None:
    document = json.loads(answer.read_text())
    next(node for node in document["graph"]["nodes"] if node["kind"] == "branch")["point"][0] += 1e-4
    changed = answer.with_name("changed.json")
    changed.write_text(json.dumps(document))
    assert main(["check", str(changed), str(answer), "--domain", str(PLATE)]) == NOT_CERTIFIED
    told = capsys.readouterr()
    assert f"{changed}: not certified at (" in told.err
    assert "[not-certified]" in told.err
    assert f"{answer}: certified anew" in told.out  # whatever is wrong with the ones before it


def test_a_rounded_answer_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rounded = tmp_path / "rounded.json"
    assert main(["solve", str(PLATE), "-o", str(rounded), "--precision", "4"]) == OK
    assert main(["check", str(rounded), "--domain", str(PLATE)]) == NOT_CERTIFIED


def test_what_is_no_answer_or_no_domain_is_told(answer: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = answer.with_name("words.json")
    words.write_text("words")
    assert main(["check", str(words), "--domain", str(PLATE)]) == INVALID_INPUT
    assert main(["check", str(PLATE), "--domain", str(PLATE)]) == INVALID_INPUT
    assert "not an answer" in capsys.readouterr().err
    assert main(["check", str(answer), "--domain", str(words)]) == INVALID_INPUT
    assert main(["check", str(answer), "--domain", str(answer.with_name("nowhere.json"))]) == USAGE
