"""What is measured of all edges at once, and that it proves usual domains valid; `conftest` holds the proofs to the rules."""

from __future__ import annotations

import gzip
import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mat_core.errors import InvalidDomain
from mat_core.model import problems, splines
from mat_core.model.domain import Domain
from mat_core.model.reading import read
from mat_core.model.survey import LARGEST
from tests.hunt.draw import FAMILIES, draw
from tests.model.builders import SQUARE, Json, accept, bezier, circle, codes, domain, mapped, polygon, rectangle, refuse

Rng = np.random.Generator
OUTLINES = Path(__file__).parents[1] / "corpus" / "outlines.jsonl.gz"
TRIES = 40  # of each change
KNOTS = 150  # of each degree


def outlines() -> list[Json]:
    """Glyphs and icons."""
    with gzip.open(OUTLINES, "rt") as lines:
        return [{k: content[k] for k in ("outer", "holes")} for content in map(json.loads, lines)]


def test_usual_domains_are_proved_valid_without_a_look_at_single_edges(monkeypatch: pytest.MonkeyPatch) -> None:
    contents = [*outlines(), *(draw(family, 3) for family in FAMILIES)]

    def looked_at(*_: object) -> None:
        raise AssertionError("edges were looked at one by one")

    monkeypatch.undo()  # what judges every document twice
    for module, name in ((splines, "point_breaches"), (problems, "following_edges"), (problems, "box_of")):
        monkeypatch.setattr(module, name, looked_at)
    for content in contents:
        Domain.from_dict({"outer": content["outer"], "holes": content.get("holes", [])})


def test_what_is_measured() -> None:
    rng = np.random.default_rng(1)
    loops = [[bezier(*rng.normal(size=(int(rng.integers(2, 6)), 2))) for _ in range(n)] for n in (4, 1, 7)]
    found = read(domain(*loops)).seen
    edges = [np.array(edge["control_points"]) for loop in loops for edge in loop]
    assert found.extent.tolist() == [np.abs(p - p[0]).max() for p in edges]
    following = [1, 2, 3, 0, 4, *range(6, 12), 5]
    assert found.gaps.tolist() == [np.abs(edges[e][-1] - edges[f][0]).max() for e, f in enumerate(following)]
    points = np.concatenate(edges)
    assert found.box == (*points.min(axis=0), *points.max(axis=0))
    assert found.largest == np.abs(points).max()
    assert found.size == np.ptp(points, axis=0).max()
    assert (found.least_extent, found.widest_gap) == (found.extent.min(), found.gaps.max())
    assert found.sound


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e151, -1e300])
def test_points_that_cannot_be_used_are_left_out(bad: float) -> None:
    for place in range(3):
        loop = [bezier((0, 0), (3, 1)), bezier((3, 1), (1, 2)), bezier((1, 2), (0, 0))]
        loop[place]["control_points"][0][1] = bad
        found = read(domain(loop)).seen
        assert not found.sound
        assert not found.widest_gap <= LARGEST
        assert (found.largest, found.size) == (3.0, 3.0)


@pytest.mark.parametrize("weight", [0.0, -1.0, math.nan, math.inf, 1e17, 1e-17])
def test_weights_that_break_a_rule_are_seen_wherever_they_are(weight: float) -> None:
    for place in range(9):
        loop = circle(0, 0, 1)
        loop[0]["weights"][place] = weight
        assert not read(domain(loop)).seen.sound
        refuse(loop)


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_knots_are_sound_just_when_no_rule_names_them(degree: int) -> None:
    rng = np.random.default_rng(degree)
    verdicts = set()
    for _ in range(KNOTS):
        count = degree + 1 + int(rng.integers(0, 2 * degree + 3))
        inner = np.sort(rng.choice([0.25, 0.5, 0.75, rng.random()], count - degree - 1))
        knots = np.concatenate((np.zeros(degree + 1), inner, np.ones(degree + 1)))
        if rng.random() < 0.5:
            knots[rng.integers(0, len(knots))] = rng.choice([0.0, 0.5, 1.0, -1.0, math.nan, math.inf, -math.inf, rng.random()])
        if rng.random() < 0.5:
            knots.sort()
        with np.errstate(over="ignore"):
            knots = (knots - rng.choice([0.0, 0.5])) * rng.choice([1.0, 1e-320, 1.5e308, 1.7e308])
        # A convex arc, so that only knots can be wrong.
        x = np.linspace(0, 1, count)
        edge = {"degree": degree, "control_points": np.column_stack((x, x * (x - 1))).tolist(), "knots": knots.tolist()}
        loop = [edge, bezier((1, 0), (0.5, 1)), bezier((0.5, 1), (0, 0))]
        sound = read(domain(loop)).seen.sound
        try:
            named = accept(loop) is None
        except InvalidDomain as error:
            named = any("/knots" in problem.pointer for problem in error.problems)
        full = max(np.count_nonzero(inner == value) for value in (*inner, -1.0)) > degree
        assert sound == (not named) or full, knots  # where the curve stays whole, degree + 1 equal ones are no fault
        verdicts.add(sound)
    assert verdicts == {True, False}


def test_numbers_are_the_same_whichever_way_they_are_read() -> None:
    loop = [*mapped(circle(0, 0, 1), 1e3, 0.1, 0.7), *SQUARE]
    loop[1]["weights"] = [2, 3]
    short = domain(loop, [bezier((0, 1), (2, 3), (4, 5))], circle(1, 2, 3))
    # A tuple among lists is read edge by edge.
    long = domain(loop, [bezier((0, 1), (2, 3), (4, 5))], circle(1, 2, 3))
    long["holes"][0][0]["control_points"] = tuple(long["holes"][0][0]["control_points"])
    first, second = read(short), read(long)
    assert not first.problems
    assert first.edge_of.tolist() == second.edge_of.tolist() == [*range(5), 0, 0]
    assert first.whole.tolist() == second.whole.tolist() == [1, 1, 1]
    for a, b in zip(first.arrays, second.arrays, strict=True):
        assert a.dtype == b.dtype
        assert a.tolist() == b.tolist()


# ---------------------------------------------------------------------------------------------------------- changes

Change = Callable[[list[list[Json]], Rng], None]


def one(loops: list[list[Json]], rng: Rng) -> Json:
    """Any edge."""
    loop = loops[rng.integers(len(loops))]
    return loop[rng.integers(len(loop))]


def point_moved(loops: list[list[Json]], rng: Rng) -> None:
    """By anything between rounding and the size."""
    points = one(loops, rng)["control_points"]
    points[rng.integers(len(points))][rng.integers(2)] += float(rng.normal() * 10.0 ** rng.uniform(-17, 0))


def point_spoiled(loops: list[list[Json]], rng: Rng) -> None:
    """A coordinate that is none."""
    points = one(loops, rng)["control_points"]
    points[rng.integers(len(points))][rng.integers(2)] = float(rng.choice([math.nan, math.inf, 1e151, -1e160]))


def edge_inserted(loops: list[list[Json]], rng: Rng) -> None:
    """A short one."""
    loop = loops[rng.integers(len(loops))]
    x, y = loop[0]["control_points"][0]
    loop.insert(0, bezier((x, y), (x + float(10.0 ** rng.uniform(-18, -8)), y)))


def edge_to_a_point(loops: list[list[Json]], rng: Rng) -> None:
    """All its control points the same."""
    edge = one(loops, rng)
    edge["control_points"] = [list(edge["control_points"][0]) for _ in edge["control_points"]]


def edge_left_out(loops: list[list[Json]], rng: Rng) -> None:
    """Or the only one of its loop."""
    loops[rng.integers(len(loops))].pop(0)


def loop_flattened(loops: list[list[Json]], rng: Rng) -> None:
    """Or all but."""
    scale = float(rng.choice([0.0, 1e-18, 1e-13, 1e-11]))
    for edge in loops[rng.integers(len(loops))]:
        edge["control_points"] = [[x, y * scale] for x, y in edge["control_points"]]


def loop_added(loops: list[list[Json]], rng: Rng) -> None:
    """Anywhere, of any size."""
    x, y, r = rng.uniform(-1.2, 1.2), rng.uniform(-1.2, 1.2), 10.0 ** rng.uniform(-3, 0.3)
    loops.append(circle(x, y, r) if rng.random() < 0.5 else rectangle(x, y, x + r, y + r))


def loop_repeated(loops: list[list[Json]], rng: Rng) -> None:
    """Somewhat smaller, or not."""
    loops.append(mapped(loops[rng.integers(len(loops))], float(rng.choice([1.0, 1.0 - 1e-13, 1.0 - 1e-9, 0.999]))))


def all_far_away(loops: list[list[Json]], rng: Rng) -> None:
    """Where few digits are left."""
    far = float(10.0 ** rng.uniform(2, 13))
    loops[:] = [mapped(loop, 1.0, far, -far) for loop in loops]


CHANGES = (
    point_moved, point_spoiled, edge_inserted, edge_to_a_point, edge_left_out, loop_flattened, loop_added, loop_repeated,
    all_far_away,
)  # fmt: skip


@pytest.mark.parametrize("change", CHANGES)
def test_changed_domains_are_judged_alike_both_ways(change: Change) -> None:
    """By `conftest`; here only that some are refused and the right kinds of shapes are tried."""
    rng = np.random.default_rng(CHANGES.index(change))
    told = set()
    for k in range(TRIES):
        loops = [mapped(circle(0, 0, 1), 1.0, 0, 0, 0.3) if k % 2 else polygon((-1, -1), (1, -1), (0.9, 1), (-1, 0.8))]
        loops += [circle(0.2, 0.1, 0.3), rectangle(-0.6, -0.2, -0.3, 0.2)][: k % 3]
        loops = json.loads(json.dumps(loops))
        change(loops, rng)
        try:
            accept(*loops)
        except InvalidDomain as refused:
            told |= codes(refused.problems)
    assert told
