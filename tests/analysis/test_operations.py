"""The table of operations: what it draws of a result is that result."""

from __future__ import annotations

import json
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from mat_core.analysis.operations import OPERATIONS
from mat_core.model.curve import RationalBSpline
from tests.curves.shapes import solved

SHAPES = ("rectangle", "ell", "annulus", "circle", "stadium", "ellipse", "blob_holes", "gear", "keyhole")


def paths(name: str, shape: str, **arguments: Any) -> tuple[Any, list[list[RationalBSpline]]]:
    operation = OPERATIONS[name]
    result = operation.call(solved(shape), **arguments)
    assert operation.paths is not None
    return result, operation.paths(result)


def length(curve: RationalBSpline) -> float:
    points = curve.evaluate(np.linspace(*curve.domain, 400))
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def head_to_tail(curves: list[RationalBSpline], size: float) -> bool:
    gaps = [np.abs(a.control_points[-1] - b.control_points[0]).max() for a, b in pairwise(curves)]
    return max(gaps, default=0.0) <= 1e-9 * size


@pytest.mark.parametrize("operation", OPERATIONS)
def test_an_operation_has_its_own_name(operation: str) -> None:
    assert OPERATIONS[operation].name == operation


@pytest.mark.parametrize("extend", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_longest_path_runs_from_its_start_to_its_end(shape: str, extend: bool) -> None:
    axis = solved(shape)
    result, (curves,) = paths("centerline", shape, extend=extend)
    assert head_to_tail(curves, axis.domain.size)
    assert sum(map(length, curves)) == pytest.approx(result.length, rel=1e-3)
    if result.nodes and curves:
        first = result.before.end if result.before else axis.nodes[result.nodes[0]].point
        last = result.after.end if result.after else axis.nodes[result.nodes[-1]].point
        np.testing.assert_allclose(curves[0].control_points[0], first, atol=1e-9 * axis.domain.size)
        np.testing.assert_allclose(curves[-1].control_points[-1], last, atol=1e-9 * axis.domain.size)


@pytest.mark.parametrize("distance", [0.1, -0.1, 5.0])
@pytest.mark.parametrize("shape", SHAPES)
def test_loops_of_an_offset_close(shape: str, distance: float) -> None:
    result, loops = paths("offset", shape, distance=distance)
    for curves in loops:
        assert head_to_tail([*curves, curves[0]], solved(shape).domain.size)
    assert sum(length(curve) for curves in loops for curve in curves) == pytest.approx(result.perimeter, rel=1e-3)
    json.dumps(result.to_dict(), allow_nan=False)


@pytest.mark.parametrize("shape", SHAPES)
def test_loops_of_a_rebuilt_boundary_close(shape: str) -> None:
    result, loops = paths("reconstruct", shape)
    assert len(loops) == 1 + len(result.holes) == 1 + len(solved(shape).domain.holes)
    for curves in loops:
        assert head_to_tail([*curves, curves[0]], solved(shape).domain.size)


@pytest.mark.parametrize("shape", SHAPES)
def test_what_is_kept_of_a_pruned_axis_lies_on_the_axis(shape: str) -> None:
    axis = solved(shape)
    result, kept = paths("prune", shape, angle=2.0)
    assert len(kept) == len(result.segments)
    for (curve,), s in zip(kept, result.segments, strict=True):
        own = axis.segments[s.segment].evaluate([s.t0, s.t1])[:, :2]
        np.testing.assert_allclose(curve.control_points[[0, -1]], own, atol=1e-9 * axis.domain.size)
