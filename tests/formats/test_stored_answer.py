"""Stored answers, certified anew: right ones pass, and whatever is changed in one is found."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from typing import Any

import pytest

from mat_core import Domain, NotCertified, medial_axis
from mat_core.errors import UnreadableInput
from mat_core.formats.stored_answer import certify_answer
from tests.families import CATALOGUE
from tests.service.live import ROOT

Json = dict[str, Any]
PLATE = json.loads((ROOT / "openapi" / "examples" / "plate.json").read_text())


def domain_of(shape: Json) -> Domain:
    return Domain.from_dict({name: shape[name] for name in ("outer", "holes") if name in shape})


def stored(domain: Domain, samples: bool = False, **options: Any) -> Json:
    """The answer as a file gives it back."""
    document: Json = json.loads(medial_axis(domain, **options).to_json(samples=samples))
    return document


@pytest.fixture(scope="module")
def domain() -> Domain:
    return domain_of(PLATE)


@pytest.fixture(scope="module")
def answer(domain: Domain) -> Json:
    return stored(domain, samples=True)


@pytest.mark.parametrize("name", CATALOGUE)
def test_what_was_certified_is_certified_again_with_the_same_figures(name: str) -> None:
    domain = domain_of(CATALOGUE[name]())
    answer = stored(domain)
    again = certify_answer(answer, domain)
    assert again["passed"]
    assert again["smooth_angle"] == answer["certificate"]["smooth_angle"]
    for check, told in answer["certificate"]["checks"].items():
        assert again["checks"][check]["limit"] == pytest.approx(told["limit"], rel=1e-9)
        assert again["checks"][check]["measured"] == pytest.approx(told["measured"], abs=1e-12)


@pytest.mark.parametrize("options", [{"tolerance": 1e-3}, {"tolerance": 3e-10}, {"smooth_angle": 0.05}])
def test_options_that_the_answer_was_made_with_are_found_in_it(domain: Domain, options: Json) -> None:
    assert certify_answer(stored(domain, samples=True, **options), domain)["checks"]["samples"]["passed"]


def test_an_answer_of_the_march_is_refused_with_a_word_on_its_numbers(domain: Domain) -> None:
    with pytest.raises(NotCertified, match="numbered otherwise"):
        certify_answer(stored(domain, method="march"), domain)


Change = Callable[[Json], object]


def curved(answer: Json) -> Json:
    """The segment with the most control points."""
    return max(answer["segments"], key=lambda segment: len(segment["axis"]["control_points"]))


def branch(answer: Json) -> Json:
    node: Json = next(node for node in answer["graph"]["nodes"] if node["kind"] == "branch")
    return node


def nudge(numbers: list[float], place: int = 0, by: float = 1e-5) -> None:
    numbers[place] += by


def drop(answer: Json) -> None:
    """The last segment, as if there had never been one."""
    answer["segments"].pop()
    answer["graph"]["edges"].pop()


def swap(answer: Json) -> None:
    first, second = answer["segments"][:2]
    first["axis"], second["axis"] = second["axis"], first["axis"]
    first["radius"], second["radius"] = second["radius"], first["radius"]


CHANGES: dict[str, tuple[Change, str]] = {
    "a node is moved": (lambda a: nudge(branch(a)["point"]), "disc"),
    "a node has another radius": (lambda a: branch(a).update(radius=branch(a)["radius"] - 1e-5), "disc"),
    "a footpoint is moved along its edge": (lambda a: nudge(branch(a)["footpoints"][0]["point"]), "footpoints"),
    "a footpoint has another parameter": (lambda a: branch(a)["footpoints"][0].update(u=0.123), "footpoints"),
    "a footpoint is on an edge that is not there": (lambda a: branch(a)["footpoints"][0].update(edge=99), "does not have"),
    "a curve bends": (lambda a: nudge(curved(a)["axis"]["control_points"][1]), "curves_on_axis"),
    "a radius along a curve changes": (lambda a: nudge(curved(a)["radius"]["control_values"], 1), "curves_on_axis"),
    "a curve ends elsewhere": (lambda a: nudge(curved(a)["axis"]["control_points"][-1]), "curves_ends"),
    "a weight changes": (lambda a: nudge(curved(a)["axis"]["weights"]), "differ"),
    "an error is made less": (lambda a: [s.update(max_error=-1.0) for s in a["segments"]], "curves"),
    "an error is too large": (lambda a: curved(a).update(max_error=0.1), "curves_tolerance"),
    "a segment is dropped": (drop, "segments"),
    "a node is dropped": (lambda a: a["graph"]["nodes"].pop(), "nodes"),
    "two segments change places": (swap, ""),
    "a segment joins other nodes": (lambda a: a["segments"][0].update(end_node=0), "join"),
    "a segment and its edge join other nodes": (
        lambda a: (a["segments"][0].update(end_node=0), a["graph"]["edges"][0].update(target=0)), "",
    ),
    "a node is of another kind": (lambda a: branch(a).update(kind="convex_vertex"), "leaves"),
    "a node is of no kind": (lambda a: branch(a).update(kind="knot"), "node_kinds"),
    "a segment is of another kind": (lambda a: a["segments"][0].update(kind="fitted"), "kinds"),
    "a cycle too many is told": (lambda a: a["graph"].update(cycles=7), "cycles"),
    "the order is turned round": (lambda a: a["graph"]["topological_order"].reverse(), "order"),
    "a sample is moved": (lambda a: nudge(a["segments"][0]["samples"]["points"][3]), "samples"),
    "a sample has another radius": (lambda a: nudge(a["segments"][0]["samples"]["radii"], 3), "samples"),
    "the domain has one edge more": (lambda a: a["domain"].update(edges=a["domain"]["edges"] + 1), "another domain"),
}  # fmt: skip


@pytest.mark.parametrize("name", CHANGES)
def test_what_was_changed_is_refused(domain: Domain, answer: Json, name: str) -> None:
    change, told = CHANGES[name]
    changed = copy.deepcopy(answer)
    change(changed)
    assert changed != answer
    with pytest.raises(NotCertified) as refusal:
        certify_answer(changed, domain)
    assert told in refusal.value.detail


def test_the_answer_of_another_domain_is_refused(answer: Json) -> None:
    moved = json.loads(json.dumps(PLATE))
    for loop in (moved["outer"], *moved["holes"]):
        for edge in loop:
            edge["control_points"] = [[x + 1e-3, y] for x, y in edge["control_points"]]
    with pytest.raises(NotCertified, match="another domain"):
        certify_answer(answer, domain_of(moved))


@pytest.mark.parametrize("change", [
    lambda a: a.pop("graph"),
    lambda a: a.update(segments=3),
    lambda a: a["segments"][0].update(max_error="small"),
    lambda a: curved(a)["axis"]["control_points"].append([0.0]),
    lambda a: curved(a)["axis"].update(knots=[None]),
    lambda a: a["graph"].update(topological_order=[0.5]),
    lambda a: a["graph"].update(topological_order=[10**30]),
    lambda a: a["graph"]["nodes"][0].update(point=[float("inf"), 0.0]),
    lambda a: a["certificate"].update(smooth_angle="none"),
])  # fmt: skip
def test_what_is_no_answer_is_told(domain: Domain, answer: Json, change: Change) -> None:
    changed = copy.deepcopy(answer)
    change(changed)
    with pytest.raises((UnreadableInput, NotCertified)) as refusal:
        certify_answer(changed, domain)
    assert isinstance(refusal.value, UnreadableInput) or "differ in degree" in refusal.value.detail


@pytest.mark.parametrize("document", [None, 3, [], {}, "axis", {"domain": None}])
def test_so_is_anything_else(domain: Domain, document: object) -> None:
    with pytest.raises(UnreadableInput, match="not an answer"):
        certify_answer(document, domain)
