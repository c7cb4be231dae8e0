"""Hypothesis strategies of domains that are valid by construction, as JSON objects of the contract.

Numbers are drawn from grids of a thousandth, so that examples shrink to something one can read and no wall is closer
than the construction says. Whatever is drawn here must be solved and certified: there is no filter and no `assume`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from hypothesis import strategies as st

from tests.families import (
    annulus,
    closed_spline,
    conic_loop,
    gear,
    polar,
    polygon_hole,
    polyline,
    rectangle,
    rounded_rectangle,
    safe_holes,
    stadium,
    wedge_edges,
)
from tests.families import bezier as bezier_edge
from tests.transforms import SAME_PLACE, rotated, scaled, shifted

Json = dict[str, Any]


def fractions(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers on a grid of a thousandth of the range, both ends included."""
    return st.integers(0, 1000).map(lambda i: low + (high - low) * i / 1000)


def plain(shaped: Json) -> Json:
    """The domain alone, as a client sends it."""
    return {"outer": shaped["outer"], "holes": shaped["holes"]}


@st.composite
def star_shaped(draw: st.DrawFn, kinds: str = "laqc", most_holes: int = 3) -> Json:
    """Lines, arcs, quadratics and cubics round the origin, with round and square holes in the middle."""
    n = draw(st.integers(4, 12))
    at = draw(st.lists(fractions(0.35, 0.65), min_size=n, max_size=n))
    radii = draw(st.lists(fractions(0.7, 1.3), min_size=n, max_size=n))
    corners = [polar(r, 2 * math.pi * (i + f) / n) for i, (r, f) in enumerate(zip(radii, at, strict=True))]
    chosen = draw(st.lists(st.sampled_from(kinds), min_size=n, max_size=n))
    bends = draw(st.lists(st.tuples(fractions(-1, 1), fractions(-1, 1)), min_size=n, max_size=n))
    outer = wedge_edges(corners, chosen, bends)
    holes = safe_holes(
        np.random.default_rng(draw(st.integers(0, 999))), outer, draw(st.integers(0, most_holes)) if n > 4 else 0
    )
    return {"outer": outer, "holes": holes}


@st.composite
def blobs(draw: st.DrawFn) -> Json:
    """One closed cubic spline, maybe with one smooth hole: no vertex at all."""
    n = draw(st.integers(6, 14))
    radii = draw(st.lists(fractions(0.8, 1.4), min_size=n, max_size=n))
    outer = closed_spline(np.array([polar(r, 2 * math.pi * i / n) for i, r in enumerate(radii)]))
    holes = []
    if draw(st.booleans()):
        inner = draw(st.lists(fractions(0.2, 0.4), min_size=7, max_size=7))
        holes.append([closed_spline(np.array([polar(r, -2 * math.pi * i / 7) for i, r in enumerate(inner)]))])
    return {"outer": [outer], "holes": holes}


@st.composite
def lenses(draw: st.DrawFn) -> Json:
    """Two curved edges and two corners, one above and one below the chord."""
    height = st.tuples(fractions(0.1, 1.2), fractions(0.1, 1.2))
    (a, b), (c, d) = draw(height), draw(height)
    low = bezier_edge([(-1.0, 0.0), (-0.4, -a), (0.4, -b), (1.0, 0.0)])
    high = bezier_edge([(1.0, 0.0), (0.4, c), (-0.4, d), (-1.0, 0.0)])
    return {"outer": [low, high], "holes": []}


@st.composite
def polygons(draw: st.DrawFn) -> Json:
    """Star-shaped polygons, maybe with a square hole round the origin."""
    n = draw(st.integers(3, 16))
    radii = draw(st.lists(fractions(0.6, 1.5), min_size=n, max_size=n))
    outer = polyline([polar(r, 2 * math.pi * i / n) for i, r in enumerate(radii)])
    holes = []
    if n > 5 and draw(st.booleans()):
        turn = draw(fractions(0, 1))
        holes.append(polygon_hole([polar(0.3, turn + math.pi * i / 2) for i in range(4)]))
    return {"outer": outer, "holes": holes}


@st.composite
def staircases(draw: st.DrawFn) -> Json:
    """Right angles on an integer grid: parallel walls, ties and equal distances all over."""
    heights = draw(st.lists(st.integers(1, 4), min_size=2, max_size=6))
    points = [(0.0, 0.0), (float(len(heights)), 0.0)]
    for i in range(len(heights) - 1, -1, -1):
        if points[-1] != (i + 1.0, float(heights[i])):
            points.append((i + 1.0, float(heights[i])))
        if i == 0 or heights[i - 1] != heights[i]:
            points.append((float(i), float(heights[i])))
    return {"outer": polyline(points), "holes": []}


@st.composite
def known_shapes(draw: st.DrawFn) -> Json:
    """Rings, ellipses, stadiums and other shapes with symmetry, in any proportion."""
    f = draw(fractions(0.05, 0.95))
    return plain(
        draw(
            st.sampled_from(
                [
                    rectangle(1.0, f),
                    stadium(2 * f, 0.5),
                    rounded_rectangle(3.0, 2.0, f),
                    annulus(f),
                    annulus(0.5 * f, 0.4),
                    gear(5 + int(10 * f), 0.2 + 0.4 * f),
                    {"outer": [conic_loop(1.0, 0.99 * f, turn=f)], "holes": []},
                ]
            )
        )
    )


@st.composite
def moved(draw: st.DrawFn, domains: st.SearchStrategy[Json]) -> Json:
    """The same, turned, in another unit, and described in another way."""
    domain = rotated(draw(domains), draw(fractions(0, 6)))
    domain = scaled(domain, 10.0 ** draw(st.integers(-6, 6)))
    if draw(st.booleans()):
        far = 10 * abs(domain["outer"][0]["control_points"][0][0])
        domain = shifted(domain, far, -2 * far)
    for name in draw(st.lists(st.sampled_from(sorted(SAME_PLACE)), max_size=2, unique=True)):
        domain = SAME_PLACE[name](domain)
    return plain(domain)


def valid_domains() -> st.SearchStrategy[Json]:
    """Any of the families, sometimes moved."""
    still = st.one_of(star_shaped(), blobs(), lenses(), polygons(), staircases(), known_shapes())
    return st.one_of(still, moved(still))
