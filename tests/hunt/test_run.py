"""Outcomes are kept, resumed, and told; workers are killed; failures are reduced and written."""

from __future__ import annotations

import io
import json
import os
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from mat_core import Domain
from tests.families import CATALOGUE, hole_grid, polygon_random
from tests.hunt import report
from tests.hunt.__main__ import arguments, chosen, domains, main
from tests.hunt.draw import FAMILIES, draw
from tests.hunt.journal import Journal, read
from tests.hunt.judge import Outcome, pieces
from tests.hunt.run import Hunt, Named, placed
from tests.hunt.team import Solver, Team

Json = dict[str, Any]


def planted(domain: Json) -> tuple[Outcome, Json | None]:
    """Domains with two holes or more fail, those named so take too long, or end their process."""
    if domain.get("note") == "slow":
        time.sleep(60)
    if domain.get("note") == "dies":
        os._exit(3)
    if len(domain["holes"]) > 1:
        return Outcome("failed", "planted", f"{len(domain['holes'])} holes", 1.0, 1.0, pieces(domain)), None
    return Outcome("certified", ms=1.0, mb=1.0, pieces=pieces(domain)), None


def hunted(folder: Path, named: list[Named], resume: bool = False, solver: Solver = planted) -> dict[str, Outcome]:
    journal, team = Journal(folder / "journal.jsonl", resume), Team(2, 2.0, solver)
    try:
        Hunt(team, journal, folder).run(named, report.Progress(out=io.StringIO()))
    finally:
        team.stop()
        journal.close()
    return journal.outcomes


def test_failures_are_reduced_and_written_as_the_corpus_has_them(tmp_path: Path) -> None:
    outcomes = hunted(tmp_path, [("grid/1", hole_grid(3, 3)), ("grid/2", CATALOGUE["ell"]())])
    assert [outcomes[f"grid/{i}"].category for i in (1, 2)] == ["failed", "certified"]
    entry = json.loads((tmp_path / "grid-1.jsonl").read_text())
    assert list(entry) == ["name", "note", "outer", "holes"]
    assert len(entry["holes"]) == 2
    assert entry["note"] == "failed: 2 holes (reduced from grid/1)"
    assert not (tmp_path / "grid-2.jsonl").exists()


def test_workers_are_killed_and_replaced(tmp_path: Path) -> None:
    ell = CATALOGUE["ell"]()
    named = [("a/slow", {**ell, "note": "slow"}), ("a/dies", {**ell, "note": "dies"}), *((f"a/{i}", ell) for i in range(5))]
    outcomes = hunted(tmp_path, named)
    assert outcomes["a/slow"].category == "slow"
    assert re.fullmatch(r"over [\d.]+ s, (0\.\d|nan) s of them at work", outcomes["a/slow"].text)  # it slept
    assert (outcomes["a/dies"].category, outcomes["a/dies"].kind) == ("failed", "worker died")
    assert sum(o.category == "certified" for o in outcomes.values()) == 5


def test_a_journal_is_resumed(tmp_path: Path) -> None:
    ell = CATALOGUE["ell"]()
    hunted(tmp_path, [("a/1", ell), ("a/2", ell)])
    with (tmp_path / "journal.jsonl").open("a") as file:
        file.write('{"name": "a/3", "categ')  # stopped here
    asked: list[str] = []

    def more() -> Iterator[Named]:
        for name in ("a/1", "a/2", "a/3", "a/4"):
            asked.append(name)
            yield name, hole_grid(2, 1)

    outcomes = hunted(tmp_path, list(more()), resume=True)
    assert [outcomes[f"a/{i}"].category for i in (1, 2, 3, 4)] == ["certified", "certified", "failed", "failed"]
    assert read(tmp_path / "journal.jsonl") == outcomes
    assert set(hunted(tmp_path, [("b/1", ell)])) == {"b/1"}  # begun anew


def test_the_table_counts() -> None:
    outcomes = {f"f/{i}": Outcome(c, ms=float(i + 1), pieces=4) for i, c in enumerate(("certified", "invalid", "slow"))}
    rows = [row.split() for row in report.table(outcomes).splitlines()]
    assert rows[1] == ["f", "3", "1", "1", "0", "0", "1", "2.0", "3.0"]
    assert report.failed(outcomes)
    assert not report.failed({"f/0": outcomes["f/0"], "f/1": outcomes["f/1"]})
    assert "f/2" in report.kinds(outcomes)
    assert report.worst({}) == "nothing was solved"


def test_the_worst_is_the_slowest_for_its_size() -> None:
    outcomes = {f"f/{i}": Outcome("certified", ms=2.0 * i, mb=10.0, pieces=i) for i in range(1, 30)}
    outcomes["f/odd"] = Outcome("certified", ms=50.0, mb=500.0, pieces=3)
    told = report.worst(outcomes, 1).splitlines()
    assert told[2].endswith("f/odd")
    assert told[-1].endswith("f/odd")


def test_moved_domains_have_names_of_their_own() -> None:
    (name, domain), *_ = placed([("a/1", polygon_random(1))], 10.0, (5.0, 0.0))
    assert name == "a/1*10@5,0"
    assert domain["outer"][0]["control_points"][0][0] == 10 * polygon_random(1)["outer"][0]["control_points"][0][0] + 5
    assert next(placed([("a/1", domain)], 1.0, (0.0, 0.0))) == ("a/1", domain)


def test_families_are_chosen_by_pattern() -> None:
    assert chosen(arguments([])) == list(FAMILIES)
    assert chosen(arguments(["--only", "tangent_*", "star"])) == ["star", "tangent_lines", "tangent_cubics", "tangent_arcs"]
    assert chosen(arguments(["--lines", "x"])) == []
    with pytest.raises(SystemExit):
        chosen(arguments(["--only", "nothing"]))
    assert arguments(["--shift=-1e6,2"]).shift == (-1e6, 2.0)
    a = arguments(["--only", "star", "--seed", "7", "--count", "2"])
    assert list(domains(a, chosen(a))) == [("star/7", draw("star", 7)), ("star/8", draw("star", 8))]


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--only", "stairs", "--count", "2", "--out", str(tmp_path), "--oracle", "1", "--worst"]) == 0
    told = capsys.readouterr().out
    assert "stairs                                2         2" in told
    assert all(o.oracle for o in read(tmp_path / "journal.jsonl").values())
    assert Domain.from_dict(draw("stairs", 0)).area > 0
