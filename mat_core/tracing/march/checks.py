"""The two criteria of section 3 and the check for a branch point of section 5.2.

    distance criterion     no edge is nearer to the centre than the two footpoints
    curvature criterion    r k <= 1 at both footpoints, k the curvature of the boundary (positive where it is convex)

The distance check looks at the parts of the boundary that are not traced yet (Proposition 1), not at the current pair, and not at
all when the pair that left a branch point shares a convex vertex ahead (Proposition 2).

Proposition 2 is false where a hole lies in the pocket of that corner: its proof takes for granted that nothing but the pair's
own edges bounds the region between the branch point and the vertex, which holds in a domain without holes only. And "there can be
only one MAT segment for a pair of boundary segments", which the proof uses, is false for curved edges and around holes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.sites import SiteTable
from mat_core.kernels.curve import evaluate
from mat_core.kernels.layout import ARC, FAN, K0, KIND, LEN, LINE, NEXT, PREV, SWEEP, TX0, TY0, X0, XMAX, XMIN, Y0, YMAX, YMIN
from mat_core.tracing.march.footpoint import AxisPoint
from mat_core.tracing.march.record import Contact, Record

CUT = 1e-15  # a disc is cut by an edge that is nearer to its centre by more than this: rounding of both
CURVED = 1e-9  # relative excess of r k that is rounding
SIDEWAYS = 1e-6  # cosine between a contact's normal and the direction of the centre: larger, and it is no contact
NEAR_SAMPLES = 8  # a spiral is looked at in so many places before the nearest point is closed in on
NEAR_STEPS = 80
NEAR_WIDTH = 2e-16
SLOPE_ROUNDING = 1e-17


def curvature_holds(t: SiteTable, a: int, b: int, p: AxisPoint) -> bool:
    """Section 3, second criterion, at both footpoints."""
    return violating_foot(t, a, b, p) == 0


def _bends_more(t: SiteTable, i: int, s: float, r: float) -> bool:
    """Whether the boundary is more curved than the disc at a footpoint."""
    k = evaluate(t.si, t.sf, t.cp, i, s, 0.0, 0.0)[4]
    return bool(k * r > 1.0 + CURVED)


def violating_foot(t: SiteTable, a: int, b: int, p: AxisPoint) -> int:
    """Where the curvature criterion fails: 1 at the right footpoint, -1 at the left one, 0 at neither.

    At the end of an edge the next one counts as well: with a jump of curvature it may bend more than the disc from there on.
    """
    if _bends_more(t, a, p.right, p.r) or (p.right == 1.0 and _bends_more(t, int(t.si[a, NEXT]), 0.0, p.r)):
        return 1
    if _bends_more(t, b, p.left, p.r) or (p.left == 0.0 and _bends_more(t, int(t.si[b, PREV]), 1.0, p.r)):
        return -1
    return 0


def cut_beside(t: SiteTable, a: int, b: int, cut: list[Contact]) -> int:
    """1 if the edge after the right one is among those that cut, -1 if the edge before the left one is, else 0."""
    sites = {at.site for at in cut}
    if int(t.si[a, NEXT]) in sites:
        return 1
    return -1 if int(t.si[b, PREV]) in sites else 0


def within(record: Record, x: float, y: float, reach: float) -> NDArray[np.int64]:
    """Sites whose boxes are nearer to a point than `reach`: the one look at all edges, vectorised."""
    sf = record.table.sf
    dx = np.maximum(np.maximum(sf[:, XMIN] - x, x - sf[:, XMAX]), 0.0)
    dy = np.maximum(np.maximum(sf[:, YMIN] - y, y - sf[:, YMAX]), 0.0)
    return np.flatnonzero(dx * dx + dy * dy < reach * reach)


def cutting(record: Record, a: int, b: int, x: float, y: float, r: float) -> list[Contact]:
    """Section 5.2: where untraced edges beside the pair (a, b) reach deepest into a disc; one place for each."""
    if not r > CUT:
        return []
    found = []
    for site in within(record, x, y, r - CUT).tolist():
        if site in (a, b) or not record.is_open[site]:
            continue
        distance, s = min(nearest(record.table, site, lo, hi, x, y) for lo, hi in record.open[site])
        if distance < r - CUT:
            found.append(record.contact(site, s))
    return found


def nearest(t: SiteTable, i: int, lo: float, hi: float, x: float, y: float) -> tuple[float, float]:
    """(distance, s) of the point nearest to (x, y) on lo .. hi of a site."""
    kind = t.si[i, KIND]
    row = t.sf[i]
    if kind == FAN:
        s = 0.5 + _turn_from_middle(t, i, x, y) / row[SWEEP]
        return math.hypot(row[X0] - x, row[Y0] - y), float(min(max(s, lo), hi))
    if kind == LINE:
        s = ((x - row[X0]) * row[TX0] + (y - row[Y0]) * row[TY0]) / row[LEN]
        return _distance(t, i, float(min(max(s, lo), hi)), x, y)
    if kind == ARC:
        return min(_distance(t, i, s, x, y) for s in (lo, hi, min(max(_arc_foot(t, i, x, y), lo), hi)))
    return _nearest_on_spiral(t, i, lo, hi, x, y)


def _distance(t: SiteTable, i: int, s: float, x: float, y: float) -> tuple[float, float]:
    dx, dy, *_ = evaluate(t.si, t.sf, t.cp, i, s, x, y)
    return math.hypot(dx, dy), s


def _turn_from_middle(t: SiteTable, i: int, x: float, y: float) -> float:
    """Angle from a fan's middle normal to the direction of (x, y)."""
    vx, vy, tx, ty, _, _ = evaluate(t.si, t.sf, t.cp, i, 0.5, x, y)
    return math.atan2(-ty * -vy - tx * -vx, -ty * -vx + tx * -vy)


def _arc_foot(t: SiteTable, i: int, x: float, y: float) -> float:
    """s of the foot of (x, y) on the circle of an arc, its far side beyond both ends."""
    vx, vy, tx, ty, k, _ = evaluate(t.si, t.sf, t.cp, i, 0.5, x, y)
    # from the middle of the arc: direction of the foot against -n sign(k)
    ux = -vx * k + ty
    uy = -vy * k - tx
    return 0.5 + math.atan2(tx * ux + ty * uy, ty * ux - tx * uy) / float(t.sf[i, SWEEP])


def _nearest_on_spiral(t: SiteTable, i: int, lo: float, hi: float, x: float, y: float) -> tuple[float, float]:
    """The best of both ends and of every place between where f = (C - p).T rises through zero.

    f' = 1 + k (C - p).N by length. Where f has one sign at two places but turns between, its extreme may have the other: so it is
    beside a joint whose edges nearly osculate the disc.
    """

    def slope(s: float) -> float:
        dx, dy, tx, ty, _, _ = evaluate(t.si, t.sf, t.cp, i, s, x, y)
        return float(dx * tx + dy * ty)

    def rate(s: float, sign: float) -> float:
        dx, dy, tx, ty, k, _ = evaluate(t.si, t.sf, t.cp, i, s, x, y)
        return sign * float(1.0 + k * (dy * tx - dx * ty))

    places = [lo + m * (hi - lo) / NEAR_SAMPLES for m in range(NEAR_SAMPLES)] + [hi]
    slopes = [slope(s) for s in places]
    feet = [lo, hi]
    for m in range(NEAR_SAMPLES):
        a, fa, b, fb = places[m], slopes[m], places[m + 1], slopes[m + 1]
        if fa * fb > 0.0:
            sign = math.copysign(1.0, fa)
            falls, rises = rate(a, sign), rate(b, sign)
            if not falls < 0.0 < rises:
                continue
            turn = _rising_zero(partial(rate, sign=sign), a, falls, b, rises)
            if fa > 0.0:
                a, fa = turn, slope(turn)
            else:
                b, fb = turn, slope(turn)
        if fa < 0.0 < fb:
            feet.append(_rising_zero(slope, a, fa, b, fb))
        elif fa == 0.0:
            feet.append(a)
    return min(_distance(t, i, s, x, y) for s in feet)


def _rising_zero(slope: Callable[[float], float], a: float, fa: float, b: float, fb: float) -> float:
    """Where `slope` passes zero between a, where it is negative, and b, where it is positive (Illinois)."""
    last = 0
    for step in range(NEAR_STEPS):
        m = (a * fb - b * fa) / (fb - fa) if step % 8 != 7 else 0.5 * (a + b)
        if not a < m < b:
            m = 0.5 * (a + b)
        if not a < m < b or b - a <= NEAR_WIDTH:
            break
        fm = slope(m)
        if abs(fm) <= SLOPE_ROUNDING:
            return m
        if fm < 0.0:
            a, fa = m, fm
            fb *= 0.5 if last == -1 else 1.0
            last = -1
        else:
            b, fb = m, fm
            fa *= 0.5 if last == 1 else 1.0
            last = 1
    return 0.5 * (a + b)


def touching(record: Record, a: int, b: int, x: float, y: float, r: float) -> tuple[list[Contact], list[int]]:
    """Contacts of a disc beside the pair (a, b), and arcs that it touches along their length."""
    t = record.table
    contacts: list[Contact] = []
    whole: list[int] = []
    for site in within(record, x, y, r + record.tie).tolist():
        if not record.is_open[site]:
            continue
        if t.si[site, KIND] == ARC and _is_whole(t, site, x, y, r, record.tie):
            contacts += [Contact(site, 0.0), Contact(record.next_site(site), 0.0)]
            whole.append(site)
            continue
        if site in (a, b):
            continue
        for lo, hi in record.open[site]:
            distance, s = nearest(t, site, lo, hi, x, y)
            if distance <= r + record.tie and _faces(t, site, s, x, y, r):
                contacts.append(record.contact(site, s))
    return contacts, whole


def _is_whole(t: SiteTable, i: int, x: float, y: float, r: float, tie: float) -> bool:
    """Whether an arc lies on the circle of a disc."""
    k = t.sf[i, K0]
    return bool(k > 0.0 and all(abs(_distance(t, i, s, x, y)[0] - r) <= tie for s in (0.0, 0.5, 1.0)) and k * r > 0.5)


def _faces(t: SiteTable, i: int, s: float, x: float, y: float, r: float) -> bool:
    """Whether the boundary's normal at s points at the centre: the nearest point of a site may be its end, the foot elsewhere."""
    dx, dy, tx, ty, _, _ = evaluate(t.si, t.sf, t.cp, i, s, x, y)
    return abs(dx * tx + dy * ty) <= SIDEWAYS * r and dx * ty - dy * tx > 0.0
