"""The reducer finds the core of planted failures."""

from __future__ import annotations

import math
from typing import Any

import pytest

from tests.families import CATALOGUE, hole_grid, polygon_random, star_shaped
from tests.hunt.reduce import reduced, simpler, steps, weight

Json = dict[str, Any]


def points(domain: Json) -> list[list[float]]:
    return [p for loop in [domain["outer"], *domain["holes"]] for e in loop for p in e["control_points"]]


def closed(domain: Json) -> bool:
    return all(
        math.dist(a["control_points"][-1], b["control_points"][0]) < 1e-9
        for loop in [domain["outer"], *domain["holes"]]
        for a, b in zip(loop, [*loop[1:], loop[0]], strict=True)
    )


def test_holes_that_do_not_matter_are_dropped() -> None:
    domain = hole_grid(4, 4)
    core = [domain["holes"][i][0]["control_points"][0] for i in (5, 11)]
    small = reduced(domain, lambda d: sum(h[0]["control_points"][0] in core for h in d["holes"]) == 2)
    assert sorted(h[0]["control_points"][0] for h in small["holes"]) == sorted(core)


def test_edges_are_merged_round_the_vertex_that_matters() -> None:
    domain = polygon_random(5, 30)
    core = domain["outer"][17]["control_points"][0]
    small = reduced(domain, lambda d: len(d["outer"]) >= 3 and core in points(d))
    assert len(small["outer"]) == 3
    assert core in points(small)


def test_curves_that_do_not_matter_become_lines() -> None:
    domain = star_shaped(3, 12, "acq", 2)
    small = reduced(domain, lambda d: len(d["outer"]) >= 2 and any("weights" in e for e in d["outer"]))
    assert weight(small) == (0, 2, 5)
    assert sorted(e["degree"] for e in small["outer"]) == [1, 2]


def test_digits_that_do_not_matter_go() -> None:
    small = reduced(polygon_random(2, 8), lambda d: len(d["outer"]) >= 3 and len({tuple(p) for p in points(d)}) >= 3)
    assert all(p == [round(p[0], 2), round(p[1], 2)] for p in points(small))


@pytest.mark.parametrize("name", ["mixed_holes", "blob_holes", "square_one_edge", "gear", "ellipse", "spiral"])
def test_every_candidate_is_closed(name: str) -> None:
    passes = steps(CATALOGUE[name]())
    candidate, tried = next(passes), 0
    while tried < 400:
        assert closed(candidate)
        tried += 1
        try:
            candidate = passes.send(tried % 7 == 0)
        except StopIteration:
            break
    assert tried


def test_nothing_is_lost_when_nothing_smaller_fails() -> None:
    domain = CATALOGUE["mixed_holes"]()
    small = reduced(domain, lambda d: False)
    assert (small["outer"], small["holes"]) == (domain["outer"], domain["holes"])


def test_the_number_of_tries_is_kept() -> None:
    tried: list[Json] = []
    reduced(polygon_random(1, 40), lambda d: bool(tried.append(d)), tries=25)
    assert len(tried) == 25


def test_simpler_edges_keep_their_ends() -> None:
    edge = CATALOGUE["lens_one_edge"]()["outer"][0]
    for other in [*simpler(edge), *simpler(CATALOGUE["spiral"]()["outer"][0])]:
        assert all(math.isfinite(c) for p in other["control_points"] for c in p)
        assert len(other["control_points"]) > other["degree"]
