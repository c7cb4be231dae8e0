"""The oracle is right on axes written down by hand, and complains about every way of damaging them."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.assertions import assert_axis, assert_truth, measure
from tests.families import CATALOGUE, ellipse, rectangle
from tests.leaves import count_leaves
from tests.reference import Reference
from tests.transforms import SAME_PLACE

Json = dict[str, Any]


def conic(controls: list[tuple[float, float, float]], weight: float | None) -> Json:
    """A segment's axis and radius from control points (x, y, r): a line, or a rational quadratic."""
    degree = len(controls) - 1
    knots = [0.0] * (degree + 1) + [1.0] * (degree + 1)
    basis = {"degree": degree, "knots": knots, "weights": [1.0] * 2 if weight is None else [1.0, weight, 1.0]}
    points, values = [[x, y] for x, y, _ in controls], [r for _, _, r in controls]
    return {"axis": {**basis, "control_points": points}, "radius": {**basis, "control_values": values}}


def document(
    nodes: list[tuple[str, tuple[float, float, float]]], segments: list[tuple[int, int, str, Json]], holes: int = 0
) -> Json:
    """An answer from (kind, disc) and (start, end, kind, curves); the order of the nodes is topological."""
    return {
        "segments": [
            {"id": i, "start_node": a, "end_node": b, "kind": kind, "max_error": 0.0, **curves}
            for i, (a, b, kind, curves) in enumerate(segments)
        ],
        "graph": {
            "nodes": [
                {"id": i, "kind": kind, "point": [x, y], "radius": r, "footpoints": []}
                for i, (kind, (x, y, r)) in enumerate(nodes)
            ],
            "edges": [{"segment": i, "source": a, "target": b} for i, (a, b, _, _) in enumerate(segments)],
            "topological_order": list(range(len(nodes))),
            "components": 1,
            "cycles": holes,
        },
    }


def rectangle_axis() -> Json:
    """Of the rectangle 2 x 1."""
    discs = [(-1.0, -0.5, 0.0), (-1.0, 0.5, 0.0), (-0.5, 0.0, 0.5), (0.5, 0.0, 0.5), (1.0, -0.5, 0.0), (1.0, 0.5, 0.0)]
    kinds = ["convex_vertex", "convex_vertex", "branch", "branch", "convex_vertex", "convex_vertex"]
    pairs = [(0, 2), (1, 2), (2, 3), (3, 4), (3, 5)]
    return document(
        list(zip(kinds, discs, strict=True)), [(a, b, "line", conic([discs[a], discs[b]], None)) for a, b in pairs]
    )


def ellipse_axis() -> Json:
    """Of the ellipse 2, 1: in the plane of x and r it is part of an ellipse, x = sqrt(3) cos t, r = sin t."""
    reach, c = 1.5, math.sqrt(3)
    first = math.acos(reach / c)
    half = math.pi / 2 - first
    discs = [(reach, 0.0, 0.5), (-reach, 0.0, 0.5)]
    curves = conic([discs[0], (0.0, 0.0, 1 / math.cos(half)), discs[1]], math.cos(half))
    return document([("curvature_center", d) for d in discs], [(0, 1, "ellipse", curves)])


def shift_radius(answer: Json) -> None:
    answer["segments"][2]["radius"]["control_values"] = [0.5 + 1e-6, 0.5 + 1e-6]


def bend_axis(answer: Json) -> None:
    answer["segments"][2] |= conic([(-0.5, 0.0, 0.5), (0.0, 1e-6, 0.5), (0.5, 0.0, 0.5)], 1.0)


def drop_branch(answer: Json) -> None:
    answer["segments"].pop(0)
    answer["graph"]["edges"].pop(0)
    answer["graph"]["nodes"].pop(0)
    answer["graph"]["topological_order"].remove(0)


def double_segment(answer: Json) -> None:
    answer["segments"].append({**answer["segments"][2], "id": 5})
    answer["graph"]["edges"].append({"segment": 5, "source": 2, "target": 3})


def move_node(answer: Json) -> None:
    answer["graph"]["nodes"][2]["point"][0] += 1e-7


def rename_node(answer: Json) -> None:
    answer["graph"]["nodes"][0]["kind"] = "curvature_center"


def turn_order(answer: Json) -> None:
    answer["graph"]["topological_order"].reverse()


def shorten(answer: Json) -> None:
    answer["segments"][0] |= conic([(-0.9, -0.4, 0.1), (-0.5, 0.0, 0.5)], None)
    answer["graph"]["nodes"][0] |= {"kind": "curvature_center", "point": [-0.9, -0.4], "radius": 0.1}


DAMAGES = [shift_radius, bend_axis, drop_branch, double_segment, move_node, rename_node, turn_order, shorten]


def test_accepts_what_is_right() -> None:
    for domain, answer in ((rectangle(), rectangle_axis()), (ellipse(), ellipse_axis())):
        report = assert_axis(domain, answer)
        assert report.worst["distance - radius"] < 1e-14
        assert_truth(domain, answer)


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda d: d.__name__)
def test_notices_damage(damage: Callable[[Json], None]) -> None:
    answer = copy.deepcopy(rectangle_axis())
    damage(answer)
    assert measure(rectangle(), answer).problems


def test_notices_an_axis_that_is_too_long() -> None:
    answer = ellipse_axis()
    c, reach = math.sqrt(3), 1.6
    half = math.pi / 2 - math.acos(reach / c)
    discs = [(reach, 0.0, math.cos(half)), (-reach, 0.0, math.cos(half))]
    answer["segments"][0] |= conic([discs[0], (0.0, 0.0, 1 / math.cos(half)), discs[1]], math.cos(half))
    for node, (x, y, r) in zip(answer["graph"]["nodes"], discs, strict=True):
        node |= {"point": [x, y], "radius": r}
    assert measure(ellipse(), answer).problems


@pytest.mark.parametrize("name", sorted(CATALOGUE))
def test_known_discs_are_maximal(name: str) -> None:
    """The families' own truth, held to the oracle: discs, and the number of leaves."""
    domain = CATALOGUE[name]()
    reference = Reference(domain)
    origin, size = reference.frame
    known = np.array([d for chain in domain["truth"].get("mat", []) for d in chain], dtype=float).reshape(-1, 3)
    if len(known):
        center = (known[:, :2] - origin) / size
        assert np.abs(reference.boundary.contacts(center)[0] - known[:, 2] / size).max() < 1e-14
    leaves = count_leaves(reference)
    assert leaves.doubtful == 0
    assert leaves.certain == domain["truth"].get("leaves", leaves.certain)


@pytest.mark.parametrize("name", sorted(SAME_PLACE))
def test_transformations_keep_the_curves(name: str) -> None:
    for built in CATALOGUE.values():
        domain = built()
        before, after = Reference(domain), Reference(SAME_PLACE[name](domain))
        after.__dict__["frame"] = before.frame
        points = before.boundary.grid[::5].reshape(-1, 2)
        assert after.boundary.contacts(points)[0].max() < 1e-14
