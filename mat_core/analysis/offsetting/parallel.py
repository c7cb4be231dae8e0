"""The edges of an offset: parallel curves of stretches of the boundary, exact where they can be.

A stretch is an interval of one site. What follows on the same edge of the input in the same way (the same line, the same
circle, a smooth curve) becomes one edge of the result:

    LINE      a line
    ARC, FAN  a circular arc, of radius |1/k - d| or d: rational quadratics of at most a quarter turn
    SPIRAL    C(s) + d n(s), fitted

Where two edges meet both end in the same point, the middle of their two; how far they had to move is part of their error. So
are the bound of a fit (`parallel_bound`), and the rounding of coordinates in the caller's own place.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.fitting import Fits, fit, join
from mat_core.analysis.offsetting.level import parallel
from mat_core.analysis.offsetting.parallel_bound import parallel_bound
from mat_core.boundary.sites import SiteTable
from mat_core.errors import NotCertified
from mat_core.kernels.layout import ARC, EDGE, FAN, K0, KIND, LINE, LOOP, NEXT, SPIRAL, SWEEP
from mat_core.model.curve import RationalBSpline
from mat_core.tracing.locate import feet

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_LINE = 1e-13  # radians by which two lines or smooth curves in one may turn
SAME_CIRCLE = 1e-12  # relative difference of two curvatures on one circle
QUARTER = 0.5 * math.pi * (1.0 + 1e-9)  # radians that one rational quadratic turns by at most
NOTHING = 1e-12  # normalised: an edge this short is none; nearer points are one to `Domain`, too
ARC_MOVED = 1.0 + math.tan(0.125 * math.pi)  # times as far as an end at most moves a point of an arc of a quarter turn
ROUNDING = 4.5e-16  # of coordinates, the caller's: two roundings of the largest one
KINDS = {LINE: "line", ARC: "arc", FAN: "arc", SPIRAL: "spline"}


@dataclass(frozen=True, slots=True)
class Source:
    """Where an edge of an offset comes from.

    Attributes
    ----------
    loop, edge : int
        Loop (0 outer, i is ``holes[i - 1]``) and edge of the input.
    u0, u1 : float
        Its parameters at the start and end of the offset's edge; u0 = u1 at a reflex vertex.
    angles : tuple of float or None
        At a reflex vertex: directions of its normals at start and end, in radians; the second is the smaller one.
    """

    loop: int
    edge: int
    u0: float
    u1: float
    angles: tuple[float, float] | None = None


class Stretch(NamedTuple):
    """The part s0 to s1 of a site; `corner` when it ends where r passes d."""

    site: int
    s0: float
    s1: float
    corner: bool


class Drawn(NamedTuple):
    """One edge of the result in normalised coordinates: its control points still to be mapped."""

    kind: str
    degree: int
    knots: Floats
    control: Floats
    weights: Floats
    source: Source
    error: float


def draw_loops(table: SiteTable, loops: Sequence[Sequence[Stretch]], distance: float, tolerance: float) -> list[list[Drawn]]:
    """The edges of each loop of stretches; a loop of no length has none.

    Parameters
    ----------
    table : SiteTable
    loops : sequence of sequence of Stretch
        Each in cyclic order.
    distance, tolerance : float
        Normalised.
    """
    groups = [_group(table, loop) for loop in loops]
    fits, first = _fit_all(table, [g for loop in groups for g in loop], distance, tolerance)
    out = []
    done = 0
    for loop in groups:
        out.append(_draw_loop(table, loop, distance, fits, first[done : done + len(loop)]))
        done += len(loop)
    return out


def _group(table: SiteTable, loop: Sequence[Stretch]) -> list[list[Stretch]]:
    """Stretches that make one edge of the result, in cyclic order."""
    n = len(loop)
    joined = [_continues(table, loop[i - 1], loop[i]) for i in range(n)]
    begin = next((i for i in range(n) if not joined[i]), 0)
    groups: list[list[Stretch]] = []
    for step in range(n):
        i = (begin + step) % n
        if step and joined[i]:
            groups[-1].append(loop[i])
        else:
            groups.append([loop[i]])
    return groups


def _continues(table: SiteTable, a: Stretch, b: Stretch) -> bool:
    """Whether stretch b goes on as a does, on the same edge of the input."""
    si, sf = table.si, table.sf
    if a.corner or a.s1 != 1.0 or b.s0 != 0.0 or si[a.site, NEXT] != b.site or a.site == b.site:
        return False
    kind = si[a.site, KIND]
    if kind != si[b.site, KIND] or kind == FAN or si[a.site, LOOP] != si[b.site, LOOP] or si[a.site, EDGE] != si[b.site, EDGE]:
        return False
    ends = _feet(table, [a.site, b.site], [1.0, 0.0])
    if ends[0, 2] != ends[1, 2] or abs(math.remainder(ends[0, 3] - ends[1, 3], 2.0 * math.pi)) > SAME_LINE:
        return False
    return bool(kind != ARC or abs(sf[a.site, K0] - sf[b.site, K0]) <= SAME_CIRCLE * abs(sf[a.site, K0]))


def _feet(table: SiteTable, site: Sequence[int] | Ints, s: Sequence[float] | Floats) -> Floats:
    """(n, 4) rows x, y, u, direction of the normal."""
    out = np.empty((len(s), 4))
    feet(table.si, table.sf, table.cp, np.asarray(site, dtype=np.int64), np.asarray(s, dtype=float), out)
    return out


def parallel_points(table: SiteTable, site: Ints, s: Floats, distance: float) -> Floats:
    """Points (n, 2) at a distance along the normals at s of sites."""
    found = _feet(table, site, s)
    normal = np.column_stack((np.cos(found[:, 3]), np.sin(found[:, 3])))
    return np.asarray(found[:, :2] + distance * normal, dtype=np.float64)


def _fit_all(
    table: SiteTable, groups: Sequence[Sequence[Stretch]], distance: float, tolerance: float
) -> tuple[Fits, list[int]]:
    """Fits of all free-form stretches, and the number of the first one of each group."""
    free: list[Stretch] = []
    first = []
    for group in groups:
        first.append(len(free))
        if table.si[group[0].site, KIND] == SPIRAL:
            free += group
    site = np.array([f.site for f in free], dtype=np.int64)
    s0, s1 = np.array([f.s0 for f in free]), np.array([f.s1 for f in free])

    def at(curve: Ints, v: Floats) -> Floats:
        return np.where(v == 1.0, s1[curve], s0[curve] + v * (s1 - s0)[curve])

    def points(curve: Ints, v: Floats) -> Floats:
        return parallel_points(table, site[curve], at(curve, v), distance)

    def derivatives(curve: Ints, v: Floats) -> Floats:
        rows = [parallel(table, i, s, distance)[2:] for i, s in zip(site[curve].tolist(), at(curve, v).tolist(), strict=True)]
        return np.asarray(np.array(rows).reshape(-1, 2) * (s1 - s0)[curve, None], dtype=np.float64)

    def bound(curve: Ints, v: Floats, control: Floats) -> Floats:
        return parallel_bound(table, site[curve], np.column_stack((at(curve, v[:, 0]), at(curve, v[:, 1]))), distance, control)

    fits = fit(points, derivatives, len(free), tolerance, regular=True, bound=bound)
    lost = np.flatnonzero(~np.isfinite(fits.error))
    if len(lost):
        x, y = (fits.control[lost[0], 0] / table.scale + table.origin).tolist()
        raise NotCertified("offset: the error of a fitted edge could not be bounded", (x, y))
    return fits, first


def _draw_loop(
    table: SiteTable, groups: list[list[Stretch]], distance: float, fits: Fits, first: list[int]
) -> list[Drawn]:
    """One loop: its edges, ends joined."""
    starts = parallel_points(table, *_columns([(g[0].site, g[0].s0) for g in groups]), distance)
    ends = parallel_points(table, *_columns([(g[-1].site, g[-1].s1) for g in groups]), distance)
    middles = parallel_points(table, *_columns([_middle(g) for g in groups]), distance)
    reach = np.maximum(np.hypot(*(ends - starts).T), np.hypot(*(middles - starts).T))
    kept = np.flatnonzero(reach > NOTHING).tolist()
    if not kept:
        return []
    # what is left out belongs to the joint: it is bridged like any other rounding
    following = kept[1:] + kept[:1]
    joints = np.array([0.5 * (ends[a] + starts[b]) for a, b in zip(kept, following, strict=True)])
    drawn = []
    for n, i in enumerate(kept):
        p, q = joints[n - 1], joints[n]
        moved = max(math.dist(p, starts[i]), math.dist(q, ends[i]))
        drawn.append(_draw(table, groups[i], distance, fits, first[i], p, q, moved))
    return drawn


def _columns(rows: list[tuple[int, float]]) -> tuple[Ints, Floats]:
    return np.array([site for site, _ in rows], dtype=np.int64), np.array([s for _, s in rows])


def _middle(group: Sequence[Stretch]) -> tuple[int, float]:
    """A place inside a group, away from both ends."""
    g = group[len(group) // 2]
    return (g.site, g.s0) if len(group) > 1 else (g.site, 0.5 * (g.s0 + g.s1))


def _draw(
    table: SiteTable, group: list[Stretch], distance: float, fits: Fits, first: int, p: Floats, q: Floats, moved: float
) -> Drawn:
    """One edge from p to q, which are `moved` from the exact ends."""
    kind = int(table.si[group[0].site, KIND])
    source = _source(table, group)
    rounding = ROUNDING * (1.0 + float(np.abs(table.origin).max()) * table.scale)
    error = moved + rounding
    if kind == LINE:
        return Drawn("line", 1, np.array([0.0, 0.0, 1.0, 1.0]), np.array([p, q]), np.ones(2), source, error)
    if kind != SPIRAL:
        return Drawn("arc", 2, *_arc(table, group, distance, p, q), source, ARC_MOVED * moved + rounding)
    rows = slice(fits.of(first).start, fits.of(first + len(group) - 1).stop)
    control = fits.control[rows].copy()
    shift_p, shift_q = p - control[0, 0], q - control[-1, -1]
    control[0, :2] += shift_p
    control[-1, -2:] += shift_q
    knots, points, smoothed = join(list(control))
    points[0], points[-1] = p, q
    return Drawn("spline", control.shape[1] - 1, knots, points, np.ones(len(points)), source,
                 float(fits.error[rows].max()) + smoothed + error)


def _source(table: SiteTable, group: Sequence[Stretch]) -> Source:
    """Where a group comes from."""
    a, b = group[0], group[-1]
    ends = _feet(table, [a.site, b.site], [a.s0, b.s1])
    row = table.si[a.site]
    angles = None
    if row[KIND] == FAN:
        turn = float(table.sf[a.site, SWEEP]) * (a.s1 - a.s0)
        angles = (float(ends[0, 3]), float(ends[0, 3]) + turn)
    return Source(int(row[LOOP]), int(row[EDGE]), float(ends[0, 2]), float(ends[1, 2]), angles)


def _arc(
    table: SiteTable, group: Sequence[Stretch], distance: float, p: Floats, q: Floats
) -> tuple[Floats, Floats, Floats]:
    """(knots, control points, weights) of a circular arc as rational quadratics.

    Over a chord of length c and half the turn h the middle point stands c/2 tan h to the side; its weight is cos h.
    """
    places: list[tuple[int, float]] = []
    turns: list[float] = []
    for g in group:
        turn = float(table.sf[g.site, SWEEP]) * (g.s1 - g.s0)
        spans = max(math.ceil(abs(turn) / QUARTER), 1)
        places += [(g.site, g.s0 + (g.s1 - g.s0) * i / spans) for i in range(spans)]
        turns += [turn / spans] * spans
    ends = parallel_points(table, *_columns(places), distance)
    ends = np.vstack((p, ends[1:], q))
    return arc_spline(ends, np.array(turns))


def arc_spline(ends: Floats, turns: Floats) -> tuple[Floats, Floats, Floats]:
    """(knots, control points, weights) of circular arcs in a row, through ends (n + 1, 2), turning by turns (n,)."""
    half = 0.5 * turns
    chord = np.diff(ends, axis=0)
    middle = 0.5 * (ends[:-1] + ends[1:]) + 0.5 * np.tan(half)[:, None] * np.column_stack((chord[:, 1], -chord[:, 0]))
    control = np.empty((2 * len(half) + 1, 2))
    control[0::2], control[1::2] = ends, middle
    weights = np.ones(len(control))
    weights[1::2] = np.cos(half)
    u = np.concatenate(([0.0], np.cumsum(np.abs(half))))
    u /= u[-1]
    knots = np.concatenate(([0.0], np.repeat(u, 2), [1.0]))
    return knots, control, weights


def to_curve(drawn: Drawn, table: SiteTable) -> RationalBSpline:
    """The edge in the caller's coordinates."""
    return RationalBSpline(drawn.degree, drawn.knots, drawn.control / table.scale + table.origin, drawn.weights)
