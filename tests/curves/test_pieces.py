"""Few pieces: polynomials go on where the boundary does, smooth at their knots, and end where it has a joint."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pytest

from mat_core import Domain, MedialAxis, medial_axis
from mat_core.axis import Segment
from mat_core.kernels.layout import EDGE, LOOP, SPAN
from tests.curves.shapes import shape, solved
from tests.curves.test_bound import outlines
from tests.families import smooth
from tests.transforms import in_parts

Json = dict[str, Any]
SHAPES = ("ellipse", "ellipse_4", "kidney", "blob", "blob_holes", "heart", "lens_one_edge", "mixed", "spiral")


def spans(segment: Segment) -> list[tuple[float, float]]:
    """Knot spans that hold a freeform piece."""
    ends = np.unique(segment.knots)
    middles = [0.5 * (t0 + t1) for t0, t1, kind in segment.pieces if kind == "freeform"]
    return [(float(ends[i - 1]), float(ends[i])) for i in np.unique(np.searchsorted(ends, middles))]


def pairs(axis: MedialAxis) -> int:
    """Pairs of sides with a freeform curve between them."""
    return len(np.unique(axis.curves.part_strip[axis.curves.part_i[:, 3] == 4]))


def blobs() -> list[Json]:
    return [smooth(seed + 100, 7 + seed % 9) for seed in range(20)]


@pytest.mark.parametrize(("tolerance", "contents", "most"), [
    (1e-6, outlines, 1.0), (1e-6, blobs, 1.4), (1e-9, outlines, 1.2), (1e-9, blobs, 2.0),
])
def test_pieces_a_pair_on_average(tolerance: float, contents: Callable[[], Iterable[Json]], most: float) -> None:
    domains = [Domain.from_dict({"outer": c["outer"], "holes": c.get("holes", [])}) for c in contents()]
    axes = [medial_axis(d, tolerance=tolerance) for d in domains]
    assert sum(len(spans(s)) for a in axes for s in a.segments) <= most * sum(pairs(a) for a in axes)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-10])
@pytest.mark.parametrize("name", SHAPES)
def test_one_derivative_at_knots_between_fitted_pieces(name: str, tolerance: float) -> None:
    for s in solved(name, tolerance).segments:
        found = spans(s)
        inner = [b for _, b in found if any(a == b for a, _ in found)]
        for knot in inner:
            before, after = s.evaluate([np.nextafter(knot, 0), knot], derivative=True)
            assert np.abs(before - after).max() <= 1e-7 * np.abs(after).max()
            assert np.count_nonzero(s.knots == knot) < s.degree


def passed(axis: MedialAxis) -> int:
    """Discs between two strips that a polynomial passes."""
    c, passed = axis.curves, 0
    for s in axis.segments:
        rows = slice(c.part_start[s.id] + 1, c.part_start[s.id + 1])
        new = np.diff(c.part_strip[rows.start - 1 : rows.stop]) != 0
        passed += int(np.count_nonzero(new & ~np.isin(c.part_f[rows, 0], s.knots)))
    return passed


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
@pytest.mark.parametrize("name", ["kidney", "blob", "blob_holes", "parabola_cap", "mixed"])
def test_edges_given_in_parts_have_as_many_pieces(name: str, tolerance: float) -> None:
    whole = solved(name, tolerance)
    parts = medial_axis(Domain.from_dict(in_parts(shape(name), (0.13, 0.37, 0.5, 0.81))), tolerance=tolerance)
    counts = [sum(len(spans(s)) for s in axis.segments) for axis in (whole, parts)]
    assert len(parts.skeleton.strip_i) > len(whole.skeleton.strip_i)
    assert passed(parts) > passed(whole)
    assert counts[1] <= 1.1 * counts[0] + 1  # they end at other discs, so one more may be due


@pytest.mark.parametrize("off", [1e-12, 1e-9, 1e-7])
def test_what_only_looks_like_one_curve_is_none(off: float) -> None:
    content = in_parts(shape("parabola_cap"), (0.3,))
    before = passed(medial_axis(Domain.from_dict(content), tolerance=1e-2))
    # the joint still is smooth, but the second part of the parabola is another curve by `off`; the line goes on
    content["outer"][1]["control_points"][1][1] += off
    assert 0 < passed(medial_axis(Domain.from_dict(content), tolerance=1e-2)) < before


def test_an_ellipse_is_cut_at_none_of_its_vertices() -> None:
    # one rational quadratic a quarter; the axis from leaf to leaf passes the disc at both ends of the minor axis
    (segment,) = solved("ellipse", 1e-3).segments
    assert len(spans(segment)) <= 2
    assert len(segment.pieces) == 2


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_pieces_are_even_at_smooth_leaves(tolerance: float) -> None:
    leaves = 0
    for seed in range(12):
        axis = medial_axis(Domain.from_dict(smooth(seed + 100, 7 + seed)), tolerance=tolerance)
        si, strips, c = axis.table.si, axis.skeleton.strip_i, axis.curves
        for s in axis.segments:
            for node, part in ((s.start_node, c.part_start[s.id]), (s.end_node, c.part_start[s.id + 1] - 1)):
                right, left = strips[c.part_strip[part], :2]
                # both sides are one curve: the axis is even in the footpoint, and smooth in its square
                one = np.array_equal(si[right][[LOOP, EDGE, SPAN]], si[left][[LOOP, EDGE, SPAN]])
                if node is not None and axis.nodes[node].kind == "curvature_center" and one:
                    leaves += 1
                    assert np.count_nonzero(c.part_strip == c.part_strip[part]) <= 2
    assert leaves > 20


def test_a_segment_tells_what_rounding_leaves_of_its_tolerance() -> None:
    content = smooth(104, 9)
    moved = {"outer": [dict(e, control_points=[[x + 1e6, y - 1e6] for x, y in e["control_points"]]) for e in content["outer"]]}
    axis = medial_axis(Domain.from_dict(moved), tolerance=1e-12)
    worst = max(s.max_error for s in axis.segments)
    unit = float(np.spacing(1e6))
    assert unit <= worst <= 10 * unit
    check = axis.certificate["checks"]["curves_tolerance"]
    assert check["measured"] == pytest.approx(worst / axis.domain.size, rel=1e-6)
    assert check["limit"] > check["measured"] > 1e-12
    assert "rounding" in check["detail"]


@pytest.mark.parametrize("tolerance", [1e-9, 1e-10, 1e-12])
def test_a_stretch_between_contacts_1e_11_apart_is_followed(tolerance: float) -> None:
    """A curve that starts without speed, nearly straight, leaves a vertex: the two normals of its discs are nearly one."""
    a, b, c, d, e = (224.33, 308.73), (226.78, 361.4), (233.28, 367.85), (240.0, 367.85), (240.0, 308.73)
    chains = [(a, (224.33, 308.81), b, b), (b, (226.91466495097913, 367.7644849331218), c), (c, d), (d, e), (e, a)]
    domain = Domain.from_dict({"outer": [{"degree": len(chain) - 1, "control_points": chain} for chain in chains]})
    axis = medial_axis(domain, tolerance=tolerance)
    assert max(len(s.pieces) for s in axis.segments) <= 15
