"""Make a failing domain smaller while it goes on failing in the same way.

`steps` is a generator: it yields candidates and is sent True for each that still fails. So whoever drives it decides where
and how a candidate is tried: `reduced` does it with a predicate, `tests.hunt.run` in processes that can be killed. Passes are
repeated until none helps: fewer holes, fewer edges, simpler edges, fewer digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterator
from itertools import pairwise
from typing import Any

from tests.transforms import bezier_pieces, each_edge, each_loop

Json = dict[str, Any]
Edge = dict[str, Any]
Steps = Generator[Json, bool, Json]
DIGITS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 14)  # after the point, in units of the domain's size


def reduced(domain: Json, fails: Callable[[Json], bool], tries: int = 2000) -> Json:
    """The smallest domain found that still fails, after so many tries at most."""
    passes = steps(domain)
    best, candidate = domain, next(passes, None)
    while candidate is not None and tries > 0:
        tries -= 1
        failing = fails(candidate)
        best = candidate if failing else best
        try:
            candidate = passes.send(failing)
        except StopIteration as done:
            return dict(done.value)
    return best


def steps(domain: Json) -> Steps:
    """Yield candidates, take True for those that still fail, return the last of these."""
    best = {"outer": domain["outer"], "holes": list(domain.get("holes", []))}
    best = yield from _first_that_fails(best, iter([each_loop(best, joined)]))
    while True:
        before = best
        best = yield from _fewer_holes(best)
        best = yield from _fewer_edges(best)
        best = yield from _first_that_fails(best, _as_pieces(best))
        best = yield from _simpler_edges(best)
        if best is before:
            break
    best = yield from _first_that_fails(best, (rounded(best, digits) for digits in DIGITS))
    return (yield from _fewer_digits(best))


def weight(domain: Json) -> tuple[int, int, int]:
    """What a reduction lowers: holes, edges, control points."""
    edges = [e for loop in [domain["outer"], *domain["holes"]] for e in loop]
    return len(domain["holes"]), len(edges), sum(len(e["control_points"]) for e in edges)


def _first_that_fails(best: Json, candidates: Iterator[Json]) -> Steps:
    for candidate in candidates:
        if candidate != best and (yield candidate):
            return candidate
    return best


def joined(loop: list[Edge]) -> list[Edge]:
    """Each edge begins where the one before ends, to the last bit, so that later passes can move both alike."""
    ends = [e["control_points"][-1] for e in loop]
    before = [ends[-1], *ends[:-1]]
    return [{**e, "control_points": [list(a), *e["control_points"][1:]]} for e, a in zip(loop, before, strict=True)]


# Holes and edges -----------------------------------------------------------------------------------------------------
def _fewer_holes(best: Json) -> Steps:
    """Runs of holes left out: all, half of them, ..., one."""
    run = len(best["holes"])
    while run:
        at = 0
        while at < len(best["holes"]):
            holes = best["holes"][:at] + best["holes"][at + run :]
            if (yield {**best, "holes": holes}):
                best = {**best, "holes": holes}
            else:
                at += run
        run //= 2
    return best


def _fewer_edges(best: Json) -> Steps:
    """Runs of edges replaced by one straight edge, or left out where they end close to where they begin."""
    for index in range(1 + len(best["holes"])):
        run = len(_loop(best, index)) - 2
        while run > 1:
            at = 0
            while at < len(_loop(best, index)) and len(_loop(best, index)) - run >= 1:
                loop = _loop(best, index)
                turned = loop[at:] + loop[:at]
                chord = line(turned[0]["control_points"][0], turned[run - 1]["control_points"][-1])
                candidate = _with_loop(best, index, [chord, *turned[run:]])
                if chord["control_points"][0] != chord["control_points"][1] and (yield candidate):
                    best = candidate
                at += 1
            run = run // 2 if run > 3 else run - 1
    return best


def _loop(domain: Json, index: int) -> list[Edge]:
    return list(domain["outer"] if index == 0 else domain["holes"][index - 1])


def _with_loop(domain: Json, index: int, loop: list[Edge]) -> Json:
    if index == 0:
        return {**domain, "outer": loop}
    return {**domain, "holes": [*domain["holes"][: index - 1], loop, *domain["holes"][index:]]}


def line(a: list[float], b: list[float]) -> Edge:
    """A straight edge."""
    return {"degree": 1, "control_points": [list(a), list(b)]}


# Edges by themselves -------------------------------------------------------------------------------------------------
def _as_pieces(best: Json) -> Iterator[Json]:
    """Edges with inner knots as Bezier pieces, so that each can be simplified."""

    def cut(edge: Edge) -> list[Edge]:
        cuts = bezier_pieces(edge) if len(edge["control_points"]) > edge["degree"] + 1 else [edge]
        for one, other in pairwise(cuts):
            other["control_points"][0] = list(one["control_points"][-1])
        return cuts

    yield each_edge(best, cut)


def _simpler_edges(best: Json) -> Steps:
    """Edges one by one as a line, without weights, of a lower degree, without the knots that a Bezier does not need."""
    for index in range(1 + len(best["holes"])):
        for at in range(len(_loop(best, index))):
            loop = _loop(best, index)
            for simple in simpler(loop[at]):
                candidate = _with_loop(best, index, [*loop[:at], simple, *loop[at + 1 :]])
                if (yield candidate):
                    best = candidate
                    break
    return best


def simpler(edge: Edge) -> Iterator[Edge]:
    """The same edge made simpler, simplest first."""
    degree, points = edge["degree"], edge["control_points"]
    bezier = len(points) == degree + 1
    if points[0] != points[-1] and (degree > 1 or len(points) > 2):
        yield line(points[0], points[-1])
    if not bezier and points[0] != points[-1]:
        kept = [points[0], *points[1:degree], points[-1]]
        yield {"degree": degree, "control_points": kept}
    weights = edge.get("weights")
    if weights is not None:
        yield {k: v for k, v in edge.items() if k != "weights"}
    if bezier:
        for drop in range(1, degree) if degree > 2 else ():
            lower: Edge = {"degree": degree - 1, "control_points": points[:drop] + points[drop + 1 :]}
            yield lower if weights is None else {**lower, "weights": weights[:drop] + weights[drop + 1 :]}
        if "knots" in edge:
            yield {k: v for k, v in edge.items() if k != "knots"}


# Digits --------------------------------------------------------------------------------------------------------------
def rounded(domain: Json, digits: int, only: tuple[float, float] | None = None) -> Json:
    """Coordinates with so many digits after the point in units of the size (of one point only); weights, too."""
    points = [p for loop in [domain["outer"], *domain["holes"]] for e in loop for p in e["control_points"]]
    size = max(max(c) - min(c) for c in zip(*points, strict=True)) or 1.0
    places = digits - math.floor(math.log10(size))

    def change(edge: Edge) -> list[Edge]:
        new = {
            **edge,
            "control_points": [
                [round(c, places) + 0.0 for c in p] if only is None or tuple(p) == only else p for p in edge["control_points"]
            ],
        }
        if "weights" in edge and only is None:
            new["weights"] = [float(f"{w:.{digits}g}") for w in edge["weights"]]
        return [new]

    return each_edge(domain, change)


def _fewer_digits(best: Json) -> Steps:
    """Points rounded one by one as far as they go."""
    points = [p for loop in [best["outer"], *best["holes"]] for e in loop for p in e["control_points"]]
    for point in dict.fromkeys(tuple(p) for p in points):
        best = yield from _first_that_fails(best, (rounded(best, digits, point) for digits in DIGITS))
    return best
