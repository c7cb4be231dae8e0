"""Strips that no curve follows: an honest error with its place, after a bounded number of pieces."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable

import numpy as np
import pytest

from mat_core import Domain, NotCertified, medial_axis
from mat_core.axis.records import CurveTable
from mat_core.boundary.sites import SiteTable, build_sites
from mat_core.curves.assemble import build_curves
from mat_core.curves.pieces import MAX_PIECES
from mat_core.kernels.layout import KIND, SPIRAL
from mat_core.tolerances import LADDER
from mat_core.topology.building import build_skeleton
from mat_core.topology.graph import AxisGraph, build_graph
from mat_core.topology.skeleton import Skeleton
from tests.families import CATALOGUE
from tests.hunt.draw import draw

Stages = tuple[SiteTable, Skeleton, AxisGraph]
SHAPES = ("ellipse", "kidney", "blob_holes", "heart", "mixed")
TOLERANCES = (1e-3, 1e-6, 1e-10)


@functools.cache
def stages(name: str) -> Stages:
    domain = Domain.from_dict(CATALOGUE[name]())
    table = build_sites(domain, 1e-6, LADDER[0])
    skeleton, graph = build_graph(table, build_skeleton(table, LADDER[0]), LADDER[0])
    return table, skeleton, graph


def fitted(table: SiteTable, skeleton: Skeleton, graph: AxisGraph) -> list[int]:
    """Strips with a free-form side."""
    free = (table.si[skeleton.strip_i[:, :2], KIND] == SPIRAL).any(axis=1)
    return [int(s) for s in graph.run_strip if free[s]]


def moved_disc(skeleton: Skeleton, strip: int) -> Skeleton:
    disc = skeleton.disc.copy()
    disc[skeleton.strip_i[strip, 3]] += [0.03, -0.02, 0.05]
    return skeleton._replace(disc=disc)


def no_disc(skeleton: Skeleton, strip: int) -> Skeleton:
    disc = skeleton.disc.copy()
    disc[skeleton.strip_i[strip, 3]] = np.nan
    return skeleton._replace(disc=disc)


def sides_without_length(skeleton: Skeleton, strip: int) -> Skeleton:
    strip_s = skeleton.strip_s.copy()
    strip_s[strip, 1] = strip_s[strip, 0]
    strip_s[strip, 3] = strip_s[strip, 2]
    return skeleton._replace(strip_s=strip_s)


def sides_of_one_rounding(skeleton: Skeleton, strip: int) -> Skeleton:
    strip_s = skeleton.strip_s.copy()
    strip_s[strip, 1] = np.nextafter(strip_s[strip, 0], 2.0)
    strip_s[strip, 3] = np.nextafter(strip_s[strip, 2], -1.0)
    return skeleton._replace(strip_s=strip_s)


def clamped_partner(skeleton: Skeleton, strip: int) -> Skeleton:
    strip_s = skeleton.strip_s.copy()
    strip_s[strip, 2] = strip_s[strip, 3]
    return skeleton._replace(strip_s=strip_s)


def wrong_partner(skeleton: Skeleton, strip: int) -> Skeleton:
    strip_i = skeleton.strip_i.copy()
    others = [s for s in strip_i[:, 1] if s not in strip_i[strip, :2]]
    strip_i[strip, 1] = others[0] if others else strip_i[strip, 0]
    return skeleton._replace(strip_i=strip_i)


DAMAGE = (moved_disc, no_disc, sides_without_length, sides_of_one_rounding, clamped_partner, wrong_partner)


def attempt(
    table: SiteTable, skeleton: Skeleton, graph: AxisGraph, tolerance: float
) -> tuple[CurveTable | None, NotCertified | None]:
    try:
        return build_curves(table, skeleton, graph, tolerance), None
    except NotCertified as error:
        return None, error


def pieces_of(curves: CurveTable, strip: int) -> int:
    return int((curves.part_i[:, 1] == strip).sum())


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("damage", DAMAGE, ids=lambda f: f.__name__)
@pytest.mark.parametrize("name", SHAPES)
def test_ends_with_an_error_or_with_few_pieces(
    name: str, damage: Callable[[Skeleton, int], Skeleton], tolerance: float
) -> None:
    table, skeleton, graph = stages(name)
    for strip in fitted(table, skeleton, graph)[:12]:
        damaged = damage(skeleton, strip)
        curves, error = attempt(table, damaged, graph, tolerance)
        ends = damaged.disc[damaged.strip_i[strip, 2:]]
        if error is not None:
            assert "edge" in error.detail
            assert (error.place is not None) == (damage is not no_disc)
        if curves is not None:
            assert pieces_of(curves, strip) <= MAX_PIECES
        if damage is no_disc or (damage is sides_without_length and np.abs(ends[1] - ends[0]).max() > tolerance):
            assert error is not None


def test_the_place_is_the_callers() -> None:
    table, skeleton, graph = stages("kidney")
    strip = fitted(table, skeleton, graph)[0]
    ends = skeleton.disc[skeleton.strip_i[strip, 2:], :2] / table.scale + table.origin
    with pytest.raises(NotCertified) as caught:
        build_curves(table, sides_without_length(skeleton, strip), graph, 1e-6)
    assert caught.value.place == pytest.approx(tuple(ends.mean(axis=0)))


def test_a_footpoint_off_its_disc_on_one_side_is_no_harm() -> None:
    # a contact that was put at the end of its site: its own side would lead past the disc, the other one does not
    table, skeleton, graph = stages("kidney")
    largest = 0.0
    for strip in fitted(table, skeleton, graph):
        for column in (1, 3):
            strip_s = skeleton.strip_s.copy()
            other = strip_s[strip, column - 1]
            strip_s[strip, column] += 1e-6 * (strip_s[strip, column] - other)
            curves = build_curves(table, skeleton._replace(strip_s=strip_s), graph, 1e-10)
            largest = max(largest, float(curves.max_error.max()))
    assert largest <= 1e-9


@pytest.mark.parametrize(("family", "seed"), [("tangent_arcs", 21001), ("noise_hole_grid", 21004), ("noise_quad_circle", 21002)])
def test_a_tolerance_below_what_rounding_allows_says_which_one_can_be_had(family: str, seed: int) -> None:
    shape = draw(family, seed)
    domain = Domain.from_dict({"outer": shape["outer"], "holes": shape["holes"]})
    with pytest.raises(NotCertified, match="ask for no finer tolerance") as given_up:
        medial_axis(domain, tolerance=1e-12)
    told = re.search(r"told to (\S+) of the size", str(given_up.value))
    assert told is not None
    assert 1e-12 < float(told[1]) < 1e-8
    assert medial_axis(domain, tolerance=float(told[1])).certificate["passed"]
