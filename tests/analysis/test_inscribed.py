"""The largest discs: closed forms, shapely's own, and necks against cycles."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from mat_core import MedialAxis
from mat_core.analysis import inscribed_disc, inscribed_discs
from mat_core.analysis.inscribed import find_tops, terrain
from mat_core.analysis.places import radius_noise
from mat_core.errors import UnsupportedOption
from tests.analysis.shapes import FAMILIES, OUTLINES, all_axes, of, outline, polygon
from tests.curves.shapes import solved
from tests.families import CATALOGUE, rectangle
from tests.transforms import restarted, reversed_loops, rotated, shifted

CLOSED_FORMS = {
    "rectangle": 0.5, "ell": 2.0 - math.sqrt(2.0), "circle": 1.0, "annulus": 0.3, "eccentric_ring": 0.525, "ellipse": 1.0,
    "dumbbell": 1.0, "stadium": 1.0, "half_disc": 0.5,
}


@pytest.mark.parametrize(("name", "radius"), CLOSED_FORMS.items())
def test_closed_forms(name: str, radius: float) -> None:
    disc = inscribed_disc(solved(name))
    assert disc.radius == pytest.approx(radius, abs=1e-12)
    for foot in disc.footpoints:
        assert math.dist(foot.point, disc.point) == pytest.approx(radius, abs=1e-12)
    assert (disc.node is None) == (disc.segment is not None)


@pytest.mark.parametrize("name", FAMILIES)
def test_families_against_shapely(name: str) -> None:
    _against_shapely(solved(name))


@pytest.mark.parametrize("index", OUTLINES)
def test_outlines_against_shapely(index: int) -> None:
    _against_shapely(outline(index))


def _against_shapely(axis: MedialAxis) -> None:
    area = polygon(axis)
    size = axis.domain.size
    disc = inscribed_disc(axis)
    radius = shapely.length(shapely.maximum_inscribed_circle(area, tolerance=1e-5 * size))
    assert radius == pytest.approx(disc.radius, abs=3e-5 * size)
    assert area.exterior.distance(shapely.Point(disc.point)) >= disc.radius - 1e-4 * size


def test_every_part_is_a_local_maximum_and_every_cycle_and_pair_of_parts_has_its_neck() -> None:
    for axis in all_axes():
        found = inscribed_discs(axis)
        radii = [d.radius for d in found.discs]
        assert radii == sorted(radii, reverse=True)
        assert radii[0] == pytest.approx(inscribed_disc(axis).radius, abs=1e-12)
        assert found.parts[0].neck is None
        for part in found.parts[1:]:
            assert part.neck is not None
            assert part.prominence == part.disc.radius - part.neck.radius > 0.0
        necks = find_tops(terrain(axis), radius_noise(axis)).necks
        flat = 1 if len(axis.runs.node_disc) == 0 and len(necks) == 0 else 0  # a ring of one width has no neck
        assert len(necks) + flat == len(found.parts) - 1 + axis.graph.cycles
        assert len(found.to_dict()["parts"]) == len(found.parts)


def test_a_dumbbell_has_two_parts_and_shallow_ones_are_joined_on_request() -> None:
    axis = solved("dumbbell")
    first, second = inscribed_discs(axis).parts
    assert sorted((first.disc.point[0], second.disc.point[0])) == pytest.approx([-2.0, 2.0], abs=1e-12)
    assert second.neck is not None
    assert second.neck.radius == pytest.approx(0.2, abs=1e-12)
    assert second.prominence == pytest.approx(0.8, abs=1e-12)
    assert len(inscribed_discs(axis, prominence=0.79).parts) == 2
    assert len(inscribed_discs(axis, prominence=0.81).parts) == 1
    assert len(inscribed_discs(solved("hole_grid")).parts) == 16


def test_the_description_of_the_domain_decides_nothing() -> None:
    shape = CATALOGUE["blob_holes"]()
    plain = [p.prominence for p in inscribed_discs(of(shape)).parts]
    for change in (lambda d: rotated(d, 0.7), lambda d: shifted(d, 3.0, -2.0), reversed_loops, restarted):
        other = [p.prominence for p in inscribed_discs(of(change(shape))).parts]
        assert other == pytest.approx(plain, abs=2e-6)
    assert len(inscribed_discs(of(shifted(CATALOGUE["gear"](), 1e6, -1e6))).parts) == 12


def test_plateaus_count_once_and_bad_prominence_is_refused() -> None:
    for sides in ((2.0, 1.0), (10.0, 0.1), (1.0, 1.0)):
        assert len(inscribed_discs(of(rectangle(*sides))).parts) == 1
    for bad in (-1.0, math.nan, math.inf):
        with pytest.raises(UnsupportedOption, match="prominence"):
            inscribed_discs(solved("ell"), prominence=bad)
    assert np.isfinite(inscribed_discs(solved("annulus")).parts[0].prominence)
