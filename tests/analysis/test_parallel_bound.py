"""The stated error of an offset's edges is a bound: nothing looked at closely is ever above it, and it is not far above."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mat_core import Domain, MedialAxis, NotCertified, medial_axis
from mat_core.analysis import offset
from mat_core.analysis.offsetting import parallel
from mat_core.analysis.offsetting.parallel import parallel_points
from mat_core.analysis.offsetting.parallel_bound import parallel_bound
from mat_core.boundary.sites import SiteTable
from mat_core.kernels.layout import KIND, SPIRAL
from tests.analysis.test_offset import outlines
from tests.curves.shapes import shape
from tests.families import smooth
from tests.reference import Reference

FAMILIES = ("ellipse", "ellipse_flat", "ellipse_4", "kidney", "blob_holes", "heart", "parabola_cap", "mixed", "thorn", "lens")
SHARES = (0.05, 0.4, 0.8, 0.97)
DENSE = 2000  # places on a fitted polynomial
FLOOR = 1e-14  # rounding of what it is held against


def bernstein(control: np.ndarray, v: np.ndarray) -> np.ndarray:
    rows = np.broadcast_to(control, (len(v), *control.shape))
    while rows.shape[1] > 1:
        rows = (1.0 - v[:, None, None]) * rows[:, :-1] + v[:, None, None] * rows[:, 1:]
    return rows[:, 0]


def through(points: np.ndarray) -> np.ndarray:
    """Control points of the polynomial through points at even parameters."""
    n = len(points) - 1
    v = np.linspace(0.0, 1.0, n + 1)
    basis = np.stack([bernstein(row[:, None], v)[:, 0] for row in np.eye(n + 1)], axis=1)
    control: np.ndarray = np.linalg.solve(basis, points)
    return control


def tables() -> list[tuple[SiteTable, float]]:
    shapes = [*(shape(name) for name in FAMILIES), smooth(104, 9), *outlines()[:20]]
    axes = [medial_axis(Domain.from_dict({"outer": s["outer"], "holes": s.get("holes", [])})) for s in shapes]
    return [(a.table, float(a.skeleton.disc[:, 2].max())) for a in axes]


def test_any_polynomial_beside_a_piece_is_bounded() -> None:
    rng = np.random.default_rng(5)
    v = np.linspace(0.0, 1.0, DENSE)
    ratios = []
    for table, radius in tables():
        for site in np.flatnonzero(table.si[:, KIND] == SPIRAL)[:12].tolist():
            for degree, noise in ((3, 0.0), (5, 0.0), (7, 1e-9), (7, 0.0)):
                a, b = np.sort(rng.random(2)) if degree > 3 else (0.0, 1.0)
                distance = float(rng.choice((0.01, 0.3, 0.9)) * radius)
                s = a + (b - a) * np.linspace(0.0, 1.0, degree + 1)
                points = parallel_points(table, np.full(degree + 1, site), s, distance)
                control = through(points + noise * rng.standard_normal(points.shape))
                (stated,) = parallel_bound(table, np.array([site]), np.array([[a, b]]), distance, control[None])
                exact = parallel_points(table, np.full(DENSE, site), a + (b - a) * v, distance)
                off = float(np.hypot(*(bernstein(control, v) - exact).T).max())
                assert stated >= off - FLOOR
                ratios.append(stated / max(off, FLOOR))
    assert len(ratios) > 300
    assert np.isfinite(ratios).mean() > 0.98  # what cannot be told is said so
    assert np.median(ratios) < 1.5


def assert_bounded(axis: MedialAxis, distance: float, tolerance: float, oracle: Reference) -> int:
    """Dense points of every edge are at the distance to within what it states; how many edges are fitted."""
    result = offset(axis, distance, tolerance)
    origin, size = oracle.frame
    count = 0
    for loop in result.loops:
        for edge in loop.edges:
            u = np.linspace(0.0, 1.0, 400)
            points = np.array([edge.curve.evaluate(t) for t in u.tolist()])
            off = np.abs(oracle.boundary.nearest((points - origin) / size)[0] * size - distance).max()
            assert off <= edge.max_error + (oracle.floor + FLOOR) * size
            count += edge.kind == "spline"
    return count


@pytest.mark.parametrize("tolerance", [1e-2, 1e-5, 1e-8, 1e-11])
def test_edges_of_offsets_are_where_they_say(tolerance: float) -> None:
    fitted = 0
    for n, content in enumerate((*(shape(name) for name in FAMILIES), *outlines()[:10])):
        plain = {"outer": content["outer"], "holes": content.get("holes", [])}
        axis = medial_axis(Domain.from_dict(plain), tolerance=min(tolerance, 1e-6))
        largest = float(axis.skeleton.disc[:, 2].max() / axis.table.scale)
        fitted += assert_bounded(axis, SHARES[n % len(SHARES)] * largest, tolerance, Reference(json.loads(json.dumps(plain))))
    assert fitted > 40


def test_an_edge_without_a_bound_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    axis = medial_axis(Domain.from_dict(shape("ellipse")))
    monkeypatch.setattr(parallel, "parallel_bound", lambda table, site, s, d, control: np.full(len(site), np.inf))
    with pytest.raises(NotCertified, match="could not be bounded") as caught:
        offset(axis, 0.3)
    assert caught.value.place is not None
