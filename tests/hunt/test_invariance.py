"""The command for invariance finds planted differences, and none in a few shapes."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mat_core import Domain, medial_axis
from tests.assertions import Answer
from tests.changes import CHANGES, moved_back
from tests.families import CATALOGUE
from tests.hunt import invariance
from tests.hunt.judge import solved
from tests.reference import Reference
from tests.sameness import compare

Json = dict[str, Any]


def answer_of(domain: Json) -> Json:
    return medial_axis(Domain.from_dict({"outer": domain["outer"], "holes": domain["holes"]})).to_dict()


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = ["--count", "4", "--seed", "3", "--out", str(tmp_path), "--changes", "far", "r*"]
    assert invariance.main(given) == 0
    rows = [row.split() for row in capsys.readouterr().out.splitlines()]
    told = {row[0]: row[1:3] for row in rows if row and row[0] in CHANGES}
    assert told == {name: ["4", "0"] for name in CHANGES if name == "far" or name.startswith("r")}
    lines = [json.loads(line) for line in (tmp_path / "journal.jsonl").read_text().splitlines()]
    assert all(set(line["figures"]) == set(told) and not line["faults"] for line in lines)


def test_what_differs_is_found_reduced_and_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def narrowed(domain: Json) -> Any:
        return CHANGES["inches"](domain)._replace(back=lambda p: p * 25.4 * np.array([1.0, 1.0 + 1e-8]))

    monkeypatch.setitem(CHANGES, "narrowed", narrowed)
    monkeypatch.setattr(invariance, "own_shapes", lambda count, seed: [("analytic/cross", CATALOGUE["cross"]())])
    assert invariance.main(["--out", str(tmp_path), "--changes", "narrowed", "shifted", "--reduce-seconds", "5"]) == 1
    entry = json.loads((tmp_path / "analytic-cross.jsonl").read_text())
    assert "narrowed: nodes: " in entry["note"]
    assert "shifted" not in entry["note"]
    assert len(entry["outer"]) < len(CATALOGUE["cross"]()["outer"])


def test_own_shapes_are_the_same_for_a_seed() -> None:
    shapes = invariance.own_shapes(30, 5)
    assert shapes == invariance.own_shapes(30, 5)
    assert len({name for name, _ in shapes}) == 30


def test_a_refusal_must_be_the_same() -> None:
    bow_tie = {"outer": CATALOGUE["square"]()["outer"], "holes": [CATALOGUE["square"]()["outer"]]}
    told, _ = invariance.judged(bow_tie, ("rotated", "far"))
    assert told.category == "invalid"
    changed = CHANGES["rotated"](CATALOGUE["square"]())._replace(after=bow_tie)
    base = solved(CATALOGUE["square"]())
    assert invariance.same_after(CATALOGUE["square"](), base, changed).differences


@pytest.mark.parametrize("planted", ["node", "length", "kind", "segment"])
def test_each_difference_counts(planted: str) -> None:
    """A node that is elsewhere, a way there and back, another kind, a segment that ends elsewhere."""
    domain = CATALOGUE["cross"]()
    answer = answer_of(domain)
    other = copy.deepcopy(answer)
    segment = other["segments"][0]
    if planted == "node":
        other["graph"]["nodes"][0]["point"][0] += 1e-7
    elif planted == "length":
        for spline, values in ((segment["axis"], "control_points"), (segment["radius"], "control_values")):
            first, *_, last = np.array(spline[values])
            there_and_back = [(first + f * (last - first)).tolist() for f in (0, 0.6, 0.4, 1)]
            spline.update({"degree": 1, "knots": [0, 0, 0.3, 0.6, 1, 1], "weights": [1.0] * 4, values: there_and_back})
    elif planted == "kind":
        segment["kind"] = "hyperbola"
        for piece in segment["pieces"]:
            piece["kind"] = "hyperbola"
    else:
        ends = segment["start_node"], segment["end_node"]
        segment["end_node"] = next(n["id"] for n in other["graph"]["nodes"] if n["id"] not in ends)
    frame = Reference(domain)
    assert compare(Answer(answer, frame), Answer(copy.deepcopy(answer), frame)).differences == []
    assert compare(Answer(answer, frame), Answer(other, frame)).differences


def test_a_node_may_become_several_that_are_one() -> None:
    """Ties that rounding breaks: the middle of a square has four branches or two nodes with three, 1e-12 apart."""
    domain = CATALOGUE["square"]()
    changed = CHANGES["inches"](domain)
    answer = answer_of(domain)
    split = copy.deepcopy(answer)
    middle = next(n for n in split["graph"]["nodes"] if n["kind"] == "branch")
    twin = {**copy.deepcopy(middle), "id": 1 + max(n["id"] for n in split["graph"]["nodes"])}
    twin["point"][0] += 1e-12
    split["graph"]["nodes"].append(twin)
    moved = [s for s in split["segments"] if middle["id"] in (s["start_node"], s["end_node"])][:2]
    for segment in moved:
        for end in ("start_node", "end_node"):
            segment[end] = twin["id"] if segment[end] == middle["id"] else segment[end]
    a, b = middle["point"], twin["point"]
    frame = Reference(domain)
    joint = {
        **copy.deepcopy(moved[0]),
        "id": 99,
        "start_node": middle["id"],
        "end_node": twin["id"],
        "axis": {"degree": 1, "knots": [0, 0, 1, 1], "control_points": [a, b]},
        "radius": {"degree": 1, "knots": [0, 0, 1, 1], "control_values": [middle["radius"], twin["radius"]]},
    }
    split["segments"].append(joint)
    assert compare(Answer(answer, frame), Answer(split, frame)).differences == []
    back = moved_back(answer_of(changed.after), changed)
    assert compare(Answer(back, frame), Answer(split, frame)).differences == []
