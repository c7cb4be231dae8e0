"""The certificate can fail: correct axes, damaged in every way it claims to detect, are caught by the named check."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from mat_core.certificate.inputs import BRANCH, CURVATURE, VERTEX
from mat_core.certificate.report import CHECKS
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, KIND, SPIRAL, TX0, TY0, UA, X1
from tests.certificate.accused import (
    SHAPES,
    Accused,
    accused,
    changed,
    degree_of_nodes,
    moved,
    rows_of,
    some_node,
    with_runs,
    without_segment,
)

Damage = Callable[[Accused], Accused]
DAMAGES: list[tuple[str, str, Damage]] = []


def caught_by(check: str, *shapes: str) -> Callable[[Damage], Damage]:
    """Register a damage: the named check must fail on each of the shapes."""

    def register(damage: Damage) -> Damage:
        DAMAGES.extend((shape, check, damage) for shape in shapes)
        return damage

    return register


# Branches, segments, nodes -------------------------------------------------------------------------------------------
def a_leaf_segment(a: Accused) -> int:
    """A segment that ends at a leaf."""
    leaf = degree_of_nodes(a) == 1
    return int(np.flatnonzero((leaf[a.graph.start_node] | leaf[a.graph.end_node]) & (a.graph.start_node >= 0))[0])


def a_ring_segment(a: Accused) -> int:
    """A segment on a cycle of square_round_hole: between two branch points."""
    branch = a.graph.node_kind == BRANCH
    return int(np.flatnonzero(branch[a.graph.start_node] & branch[a.graph.end_node])[0])


@caught_by("coverage", "rectangle", "ell", "ellipse", "letter", "blob", "blob_with_holes", "square_round_hole", "gear")
@caught_by("faces", "rectangle", "letter", "gear")
@caught_by("degrees", "rectangle", "letter", "gear")
@caught_by("connected", "rectangle", "letter")
def branch_dropped(a: Accused) -> Accused:
    return without_segment(a, a_leaf_segment(a))


@caught_by("cycles", "square_round_hole")
@caught_by("coverage", "square_round_hole")
def cycle_broken(a: Accused) -> Accused:
    return without_segment(a, a_ring_segment(a))


@caught_by("connected", "blob_with_holes", "square_round_hole", "letter")
def connection_of_a_loop_removed(a: Accused) -> Accused:
    """All segments at one branch node go, so what hangs on it falls off."""
    node = some_node(a, BRANCH)
    while (gone := np.flatnonzero((a.graph.start_node == node) | (a.graph.end_node == node))).size:
        a = without_segment(a, int(gone[-1]))
    return a


@caught_by("connected", "letter")
def components_misstated(a: Accused) -> Accused:
    return a.with_graph(components=2)


@caught_by("cycles", "letter", "circle", "annulus", "eccentric")
def cycles_misstated(a: Accused) -> Accused:
    return a.with_graph(cycles=a.graph.cycles + 1)


@caught_by("segments", "rectangle", "letter", "blob", "annulus")
def segment_doubled(a: Accused) -> Accused:
    runs = list(range(len(a.graph.start_node)))
    return with_runs(a, [*runs, runs[-1]])


@caught_by("coverage", "rectangle", "letter", "blob")
@caught_by("degrees", "rectangle", "letter")
@caught_by("faces", "rectangle", "letter")
def segment_doubled_with_its_strips(a: Accused) -> Accused:
    strips = a.graph.run_strip[list(rows_of(a.graph.run_start, 0))]
    n = len(a.skeleton.strip_i)
    runs = list(range(len(a.graph.start_node)))
    b = with_runs(a, [*runs, 0]).with_discs(
        strip_i=np.concatenate((a.skeleton.strip_i, a.skeleton.strip_i[strips])),
        strip_s=np.concatenate((a.skeleton.strip_s, a.skeleton.strip_s[strips])),
    )
    part_i = b.curves.part_i.copy()
    fresh = rows_of(b.curves.part_start, len(runs))
    for row in fresh:
        part_i[row, 1] = n + int(np.flatnonzero(strips == part_i[row, 1])[0])
    first = b.graph.run_start[-2]
    run_strip = b.graph.run_strip.copy()
    run_strip[first:] = n + np.arange(len(strips))
    return b.with_graph(run_strip=run_strip).with_curves(part_i=part_i)


@caught_by("segments", "ell", "letter", "blob_with_holes")
def segment_dropped_from_the_graph_alone(a: Accused) -> Accused:
    return with_runs(a, list(range(len(a.graph.start_node) - 1)))


@caught_by("segments", "ell", "letter")
def segment_ends_at_another_node(a: Accused) -> Accused:
    other = (a.graph.end_node[0] + 1) % len(a.graph.node_disc)
    return a.with_graph(end_node=changed(a.graph.end_node, 0, other))


@caught_by("segments", "letter", "blob")
def strip_travelled_backwards(a: Accused) -> Accused:
    return a.with_graph(run_forward=changed(a.graph.run_forward, 0, not a.graph.run_forward[0]))


@caught_by("discs_touching", "ell", "letter", "blob_with_holes")
@caught_by("degrees", "ell", "letter", "blob_with_holes")
def nodes_merged(a: Accused) -> Accused:
    """Two branch points become one, with all their contacts and strips."""
    k = a.skeleton
    first, second = a.graph.node_disc[np.flatnonzero(a.graph.node_kind == BRANCH)[:2]]
    strip_i = k.strip_i.copy()
    strip_i[:, 2:][strip_i[:, 2:] == second] = first
    owner = np.repeat(np.arange(len(k.disc)), np.diff(k.contact_start))
    owner[owner == second] = first
    order = np.argsort(owner, kind="stable")
    starts = np.searchsorted(owner[order], np.arange(len(k.disc) + 1))
    return a.with_discs(
        strip_i=strip_i, contact_start=starts, contact_site=k.contact_site[order], contact_s=k.contact_s[order]
    )


@caught_by("neighbours", "ell", "letter", "blob_with_holes")
def one_strip_ends_at_another_node(a: Accused) -> Accused:
    first, second = a.graph.node_disc[np.flatnonzero(a.graph.node_kind == BRANCH)[:2]]
    row, end = np.argwhere(a.skeleton.strip_i[:, 2:] == second)[0]
    return a.with_discs(strip_i=changed(a.skeleton.strip_i, (row, 2 + end), first))


@caught_by("node_kinds", "rectangle", "letter")
@caught_by("leaves", "rectangle", "letter")
def leaf_relabelled(a: Accused) -> Accused:
    return a.with_graph(node_kind=changed(a.graph.node_kind, some_node(a, VERTEX), CURVATURE))


@caught_by("node_kinds", "ellipse", "blob", "stadium", "circle", "letter", "gear")
def any_node_relabelled(a: Accused) -> Accused:
    return a.with_graph(node_kind=changed(a.graph.node_kind, -1, (a.graph.node_kind[-1] + 2) % 5))


@caught_by("node_kinds", "ellipse", "blob")
def curvature_leaf_of_another_radius(a: Accused) -> Accused:
    d = a.graph.node_disc[some_node(a, CURVATURE)]
    return a.with_discs(disc=changed(a.skeleton.disc, (d, 2), a.skeleton.disc[d, 2] * (1.0 - 1e-5)))


@caught_by("order", "rectangle", "letter", "blob")
def order_reversed(a: Accused) -> Accused:
    return a.with_graph(order=a.graph.order[::-1].copy())


@caught_by("order", "letter")
def order_with_a_node_twice(a: Accused) -> Accused:
    return a.with_graph(order=changed(a.graph.order, 0, a.graph.order[-1]))


@caught_by("faces", "ell", "letter")
@caught_by("degrees", "ell", "letter")
def contact_listed_twice(a: Accused) -> Accused:
    k = a.skeleton
    starts = k.contact_start.copy()
    starts[-1] += 1
    return a.with_discs(
        contact_start=starts,
        contact_site=np.append(k.contact_site, k.contact_site[-1]),
        contact_s=np.append(k.contact_s, k.contact_s[-1]),
    )


# Boundary ------------------------------------------------------------------------------------------------------------
@caught_by("boundary", "rectangle", "blob", "letter", "annulus")
def axis_of_another_domain(a: Accused) -> Accused:
    return a._replace(table=a.table._replace(origin=a.table.origin + 1e-6))


@caught_by("boundary", "rectangle", "blob")
def boundary_with_a_gap(a: Accused) -> Accused:
    return a._replace(table=a.table._replace(sf=moved(a.table.sf, (0, X1), 1e-6)))


@caught_by("boundary", "blob", "letter")
def piece_named_at_another_parameter(a: Accused) -> Accused:
    i = int(np.flatnonzero(a.table.si[:, KIND] == SPIRAL)[0])
    return a._replace(table=a.table._replace(sf=moved(a.table.sf, (i, UA), 1e-7)))


@caught_by("turning", "rectangle", "blob", "letter")
def boundary_with_a_wrong_tangent(a: Accused) -> Accused:
    sf = a.table.sf.copy()
    i = int(np.flatnonzero(a.table.si[:, KIND] == SPIRAL)[0]) if (a.table.si[:, KIND] == SPIRAL).any() else 0
    sf[i, TX0], sf[i, TY0] = -sf[i, TX0], -sf[i, TY0]
    return a._replace(table=a.table._replace(sf=sf))


@caught_by("leaves", "rectangle", "letter")
def corner_without_a_leaf(a: Accused) -> Accused:
    si = a.table.si.copy()
    si[int(np.flatnonzero(si[:, CORNER] == CONVEX_VERTEX)[0]), CORNER] = 0
    return a._replace(table=a.table._replace(si=si))


@caught_by("whole_arcs", "stadium", "plate", "circle")
def whole_contact_with_another_circle(a: Accused) -> Accused:
    d = a.skeleton.whole_i[0, 1]
    return a.with_discs(disc=moved(a.skeleton.disc, (d, 2), 1e-6))


@caught_by("whole_arcs", "ell", "letter")
def strip_taken_for_a_whole_contact(a: Accused) -> Accused:
    k = a.skeleton
    return a.with_discs(whole_i=np.array([[k.strip_i[0, 0], k.strip_i[0, 2]]]), whole_s=k.strip_s[:1, :2].copy())


# Discs ---------------------------------------------------------------------------------------------------------------
@caught_by("discs_touching", "rectangle", "ell", "ellipse", "circle", "stadium", "letter", "blob", "gear")
@caught_by("discs_empty", "rectangle", "ell", "circle", "letter", "blob", "gear")
def radius_larger(a: Accused) -> Accused:
    d = int(a.skeleton.disc[:, 2].argmax())
    return a.with_discs(disc=moved(a.skeleton.disc, (d, 2), 1e-6))


@caught_by("discs_touching", "rectangle", "letter")
@caught_by("discs_empty", "rectangle", "letter")
def radius_not_a_number(a: Accused) -> Accused:
    return a.with_discs(disc=changed(a.skeleton.disc, (0, 2), np.nan))


@caught_by("discs_touching", "ell", "letter", "blob", "eccentric")
def footpoint_moved(a: Accused) -> Accused:
    """Everywhere it is named, by a millionth of its piece."""
    k = a.skeleton
    owner = np.repeat(np.arange(len(k.disc)), np.diff(k.contact_start))
    through = (k.contact_s > 0.0) & (k.contact_s < 1.0) & (k.disc[owner, 2] > 0.0)
    c = int(np.flatnonzero(through)[0])
    site, s = k.contact_site[c], k.contact_s[c]
    strip_s = k.strip_s.copy()
    for side in range(2):
        rows = k.strip_i[:, side] == site
        part = strip_s[:, 2 * side : 2 * side + 2]
        part[rows[:, None] & (np.abs(part - s) < 1e-12)] += 1e-6
    return a.with_discs(strip_s=strip_s, contact_s=moved(k.contact_s, c, 1e-6))


@caught_by("coverage", "ell", "letter", "blob", "eccentric")
def footpoint_moved_on_one_strip(a: Accused) -> Accused:
    inner = (a.skeleton.strip_s > 0.0) & (a.skeleton.strip_s < 1.0)
    row, column = np.argwhere(inner)[0]
    return a.with_discs(strip_s=moved(a.skeleton.strip_s, (row, column), 1e-6))


def _partners_exchanged(a: Accused) -> Accused:
    """Two strips keep their right sides and exchange their left ones: the boundary is still covered once."""
    k = a.skeleton
    long = np.argsort(-np.abs(k.strip_s[:, 1] - k.strip_s[:, 0]) * a.table.sf[k.strip_i[:, 0], 10])[:2]
    strip_i = k.strip_i.copy()
    strip_s = k.strip_s.copy()
    strip_i[long, 1] = k.strip_i[long[::-1], 1]
    strip_s[np.ix_(long, (2, 3))] = k.strip_s[np.ix_(long[::-1], (2, 3))]
    return a.with_discs(strip_i=strip_i, strip_s=strip_s)


caught_by("partners_right", "rectangle", "ell", "letter", "blob", "gear")(_partners_exchanged)
caught_by("partners_left", "rectangle", "ell", "letter", "blob", "gear")(_partners_exchanged)


# Curves --------------------------------------------------------------------------------------------------------------
def _moved_control_point(a: Accused, row: int, by: float, sideways: bool) -> Accused:
    """A control point moved across its curve, or in radius."""
    cp = a.curves.cp.copy()
    if sideways:
        along = cp[row + 1, :2] - cp[row - 1, :2]
        along /= np.hypot(*along)
        cp[row, 0] -= by * along[1]
        cp[row, 1] += by * along[0]
    else:
        cp[row, 2] += by
    return a.with_curves(cp=cp)


@caught_by("curves_on_axis", *sorted(SHAPES.keys() - {"circle", "stadium"}))
def control_point_moved(a: Accused) -> Accused:
    """Ten tolerances sideways, on the segment with most control points."""
    g = int(np.diff(a.curves.cp_start).argmax())
    first, last = a.curves.cp_start[g : g + 2]
    return _moved_control_point(a, (first + last) // 2, 10.0 * a.tolerance, sideways=True)


@caught_by("curves_on_axis", "rectangle", "ell", "ellipse", "letter", "blob")
@caught_by("curves_empty", "rectangle", "ell", "ellipse", "letter", "blob")
def control_radius_moved(a: Accused) -> Accused:
    g = int(np.diff(a.curves.cp_start).argmax())
    first, last = a.curves.cp_start[g : g + 2]
    return _moved_control_point(a, (first + last) // 2, 10.0 * a.tolerance, sideways=False)


@caught_by("curves_ends", "rectangle", "ellipse", "letter", "blob")
def end_of_a_curve_moved(a: Accused) -> Accused:
    return a.with_curves(cp=moved(a.curves.cp, (0, 0), 1e-5))


@caught_by("curves_ends", "letter", "blob_with_holes")
def curves_of_two_segments_exchanged(a: Accused) -> Accused:
    b = with_runs(a, [1, 0, *range(2, len(a.graph.start_node))])
    return a._replace(curves=b.curves)


@caught_by("curves_continuous", "annulus", "eccentric")
def closed_curve_opened(a: Accused) -> Accused:
    return a.with_curves(cp=moved(a.curves.cp, (0, 0), 1e-6))


@caught_by("curves_continuous", "letter", "ell")
def curve_torn(a: Accused) -> Accused:
    """An inner knot becomes as multiple as the end knots, and what follows it is moved."""
    c = a.curves
    for g in range(len(c.degree)):
        p = int(c.degree[g])
        knots = c.knots[c.knot_start[g] : c.knot_start[g + 1]]
        inner = [k for k in range(p + 1, len(knots) - 2 * p) if knots[k] == knots[k + p - 1]]
        if inner:
            break
    else:
        pytest.skip("no full inner knot")
    at = int(c.knot_start[g]) + inner[0]
    row = int(c.cp_start[g]) + inner[0] - 1
    cp = np.insert(c.cp, row, c.cp[row], axis=0)
    cp[row, 1] += 1e-6
    after = np.arange(len(c.degree) + 1) > g
    return a.with_curves(
        knots=np.insert(c.knots, at, c.knots[at]), cp=cp, knot_start=c.knot_start + after, cp_start=c.cp_start + after
    )


@caught_by("curves_continuous", "letter", "blob")
def weight_negative(a: Accused) -> Accused:
    return a.with_curves(cp=changed(a.curves.cp, (1, 3), -1.0))


@caught_by("curves_tolerance", "letter", "blob")
def tolerance_not_kept(a: Accused) -> Accused:
    return a._replace(tolerance=1e-12)


@caught_by("curves_on_axis", "blob", "letter")
def error_understated(a: Accused) -> Accused:
    return a.with_curves(max_error=np.zeros_like(a.curves.max_error))


# References ----------------------------------------------------------------------------------------------------------
@caught_by("references", "letter")
def strip_that_is_not_there(a: Accused) -> Accused:
    return a.with_graph(run_strip=changed(a.graph.run_strip, 0, len(a.skeleton.strip_i)))


@caught_by("references", "letter", "circle")
def parameter_not_a_number(a: Accused) -> Accused:
    return a.with_discs(contact_s=changed(a.skeleton.contact_s, 0, np.nan))


@caught_by("references", "letter")
def table_cut_short(a: Accused) -> Accused:
    return a.with_curves(max_error=a.curves.max_error[:-1])


@pytest.mark.parametrize(("name", "check", "damage"), DAMAGES, ids=[f"{d.__name__}-{c}-{n}" for n, c, d in DAMAGES])
def test_is_caught(name: str, check: str, damage: Damage) -> None:
    certificate = damage(accused(name)).judge()
    assert not certificate["passed"]
    assert check in certificate["checks"]
    found = certificate["checks"][check]
    assert not found["passed"], {n: c["measured"] for n, c in certificate["checks"].items() if not c["passed"]}
    assert found["measured"] > found["limit"]


def test_every_check_can_fail() -> None:
    assert {check for _, check, _ in DAMAGES} == set(CHECKS)


@pytest.mark.parametrize("name", ["ell", "letter", "blob_with_holes", "plate"])
def test_any_disc_moved_is_caught(name: str) -> None:
    a = accused(name)
    for d in range(len(a.skeleton.disc)):
        for axis in range(3):
            by = 1e-6 if axis < 2 or a.skeleton.disc[d, 2] == 0.0 else -1e-6
            assert not a.with_discs(disc=moved(a.skeleton.disc, (d, axis), by)).judge()["passed"], (d, axis)


@pytest.mark.parametrize("name", ["ell", "letter", "blob_with_holes", "plate"])
def test_any_strip_end_changed_is_caught(name: str) -> None:
    a = accused(name)
    k = a.skeleton
    for m in range(len(k.strip_i)):
        for column in range(4):
            by = 1e-5 if k.strip_s[m, column] < 0.5 else -1e-5
            assert not a.with_discs(strip_s=moved(k.strip_s, (m, column), by)).judge()["passed"], (m, column)
            limit = len(a.table.si) if column < 2 else len(k.disc)
            other = (k.strip_i[m, column] + 1) % limit
            assert not a.with_discs(strip_i=changed(k.strip_i, (m, column), other)).judge()["passed"], (m, column)


def test_place_is_where_the_damage_is() -> None:
    a = accused("letter")
    d = a.graph.node_disc[some_node(a, BRANCH)]
    damaged: Any = a.with_discs(disc=moved(a.skeleton.disc, (d, 2), 1e-6)).judge()["checks"]["discs_touching"]
    expected = a.skeleton.disc[d, :2] / a.table.scale + a.table.origin
    assert np.allclose(damaged["place"], expected, atol=1e-9)
    assert damaged["measured"] == pytest.approx(1e-6 / (a.domain.size * a.table.scale), rel=1e-6) if a.domain else False
