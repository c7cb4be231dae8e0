"""Holds the offsets of one domain against `tests.offsets.buffering`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import shapely

from mat_core import Domain, InvalidDomain, medial_axis
from mat_core.analysis import Offset, inscribed_discs, offsets
from tests.offsets.buffering import Between, Flattened

Json = dict[str, Any]

SHARES = (0.1, 0.3, 0.5, 0.7, 0.9)  # of the largest maximal disc's radius, inward
OUTWARD = (-0.1, -0.5, -0.9)
TOLERANCE = 1e-9  # of the axis and the offsets
ERROR = 1e-7  # of the flattening, relative to the size; made smaller until the reference is as good as DOUBT
FINER = 0.1
LEAST_ERROR = 1e-11
DOUBT = 1e-6  # relative to the domain's area: what the reference may not know of an area
AGREES = 1e-5  # relative to the domain's area: what is promised
ROUNDING = 1e-13  # relative to the size, times a length: of areas of polygons
CRUMB = 1e-9  # of the domain's area: a part of a polygon this small is rounding


@dataclass(frozen=True)
class Checked:
    """One offset against its reference; areas relative to the domain's.

    miss: offset's area less the reference's; doubt: half of what lies between the reference's bounds; beyond: area by which the
    offset leaves those bounds; regions, loops: how many the offset has; known: whether both bounds have equally many;
    problems: what is wrong, empty when nothing is.
    """

    name: str
    share: float
    miss: float
    doubt: float
    beyond: float
    regions: int
    loops: int
    known: bool
    problems: tuple[str, ...]


def check(name: str, shape: Json, shares: Sequence[float] = SHARES) -> Iterator[Checked]:
    """Offsets of a domain at shares of its largest disc's radius; negative ones outward."""
    domain = Domain.from_dict({"outer": shape["outer"], "holes": shape.get("holes", [])})
    axis = medial_axis(domain, tolerance=TOLERANCE)
    largest = max(found.radius for found in inscribed_discs(axis).discs)
    for share, result in zip(shares, offsets(axis, [share * largest for share in shares], TOLERANCE), strict=True):
        yield compared(name, share, domain, result)


def _reference(domain: Domain, distance: float) -> Between:
    """Bounds that are near enough to each other."""
    error = ERROR * domain.size
    while True:
        found = Flattened(domain.outer, domain.holes, error).at(distance)
        if found.doubt <= DOUBT * domain.area or error < LEAST_ERROR * domain.size:
            return found
        error *= FINER


def compared(name: str, share: float, domain: Domain, result: Offset) -> Checked:
    """All that can be told of one offset."""
    between = _reference(domain, result.distance)
    error = ERROR * domain.size
    # on a grid: without one GEOS may take nothing away, or fail, where edges of both are one but for rounding
    grid = ROUNDING * domain.size
    own = shapely.union_all([
        Flattened(tuple(r.outer.curves), tuple(tuple(hole.curves) for hole in r.holes), error).polygon for r in result.regions
    ], grid_size=grid)  # fmt: skip
    slack = (result.max_error + ROUNDING * domain.size) * (result.perimeter + between.most.length)
    miss = result.area - between.area
    beyond = shapely.difference(own, between.most, grid_size=grid).area
    beyond += shapely.difference(between.least, own, grid_size=grid).area
    counts = {_counts(g, CRUMB * domain.area) for g in between}
    problems = list(_crossings(result))
    if between.doubt > DOUBT * domain.area:
        problems.append("the reference is not good enough")
    if abs(miss) > between.doubt + slack:
        problems.append("the area is outside the reference's bounds")
    if beyond > slack + error * (result.perimeter + between.most.length):
        problems.append("the offset is outside the reference's bounds")
    if len(counts) == 1 and counts != {(len(result.regions), len(result.loops))}:
        problems.append(f"{len(result.regions)} regions and {len(result.loops)} loops, not {counts.copy().pop()}")
    area = domain.area
    return Checked(name, share, miss / area, between.doubt / area, beyond / area, len(result.regions), len(result.loops),
                   len(counts) == 1, tuple(problems))


def _crossings(result: Offset) -> Iterator[str]:
    """Regions that are no valid domains: loops that cross or touch themselves or each other."""
    for region in result.regions:
        try:
            region.domain()
        except InvalidDomain as error:
            yield f"a region is no domain: {error}"


def _counts(shape: shapely.Geometry, crumb: float) -> tuple[int, int]:
    """How many parts a polygon has, and how many rings."""
    parts = [part for part in shapely.get_parts(shape) if part.area > crumb]
    return len(parts), sum(1 + sum(shapely.Polygon(ring).area > crumb for ring in part.interiors) for part in parts)
