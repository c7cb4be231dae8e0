"""What loops of curves enclose: area and length by quadrature, and the JSON of a domain."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.fitting import bernstein
from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]

NODES = 16  # Gauss points a Bezier piece: exact areas up to degree 16, quarter circles to rounding


@cache
def _gauss(degree: int) -> tuple[Floats, Floats, Floats]:
    """(basis, its derivative, weights) on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(NODES)
    v = 0.5 * (x + 1.0)
    lower = bernstein(degree - 1, v)
    slope = np.zeros((NODES, degree + 1))
    slope[:, 1:] += degree * lower
    slope[:, :-1] -= degree * lower
    return bernstein(degree, v), slope, 0.5 * w


def measure(edges: Sequence[RationalBSpline]) -> tuple[float, float]:
    """(signed area, length) of a closed loop of edges; the area is positive when it runs counter-clockwise."""
    # about one of its points, so that no digits go to where the loop lies
    centre = edges[0].control_points[0]
    area = length = 0.0
    for edge in edges:
        n = edge.degree
        basis, slope, w = _gauss(n)
        rows = edge.pieces()[0].reshape(-1, n + 1, 3)
        weight = rows[:, :, 2:]
        homogeneous = np.concatenate(((rows[:, :, :2] - centre) * weight, weight), axis=2)
        value, rate = basis @ homogeneous, slope @ homogeneous
        p = value[..., :2] / value[..., 2:]
        d = (rate[..., :2] - p * rate[..., 2:]) / value[..., 2:]
        area += float(0.5 * ((p[..., 0] * d[..., 1] - p[..., 1] * d[..., 0]) @ w).sum())
        length += float((np.hypot(d[..., 0], d[..., 1]) @ w).sum())
    return area, length


def edge_dicts(edges: Sequence[RationalBSpline]) -> list[dict[str, object]]:
    """Edges in the form that `Domain.from_dict` reads."""
    return [edge.to_dict() for edge in edges]
