r"""Where the radius passes a level: the part of the axis whose discs are larger.

Along a piece of the axis, r - level has the sign of its numerator over Bernstein polynomials,

    q(t) = sum B_i(t) w_i (r_i - level),    w_i > 0,

so coefficients of one sign mean no root, one change of sign exactly one, and more are halved (Descartes' rule). Signs
at discs are taken from the discs, the same for all strips that meet there, and at joints of pieces from one of them: so
every strip enters and leaves as often as its two ends say.

A root is brought from the piece's curve to the true axis, where both sides' points at the level meet:

    C1(u) + level n1(u) = C2(v) + level n2(v)        (Newton's method in u, v)
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.spans import cut_parts
from mat_core.axis import MedialAxis
from mat_core.boundary.sites import SiteTable
from mat_core.kernels.curve import evaluate
from mat_core.kernels.layout import FAN, KIND, SWEEP
from mat_core.tracing.locate import locate

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

HALVINGS = 40  # of a piece until one change of sign is left; two roots nearer than that are none
BISECTIONS = 30  # of an interval with one root, before Newton's method
NEWTON_STEPS = 12
BESIDE = 1e-5  # of a site's parameter, from an end whose limits are wanted


class Strips(NamedTuple):
    """The strips in order of travel (R of them), and their pieces; normalised.

    disc (R, 2): at start and end. right, left (R,): sites; right_s, left_s (R, 2): footpoints at start and end, where the
    right one runs up its site and the left one down. part (R + 1,): pieces of strip n are part[n] .. part[n + 1].
    degree (P,), radius (P, 8), weight (P, 8): Bernstein coefficients of each piece, the last one repeated.
    """

    disc: Ints
    right: Ints
    left: Ints
    right_s: Floats
    left_s: Floats
    part: Ints
    degree: Ints
    radius: Floats
    weight: Floats


class Corners(NamedTuple):
    """Where r passes the level (K of them), sorted along the strips.

    strip (K,): row of `Strips`; right_s, left_s (K,): footpoints on that strip's sites.
    """

    strip: Ints
    right_s: Floats
    left_s: Floats


def list_strips(axis: MedialAxis) -> Strips:
    """The strips of an axis as its segments travel them."""
    k, runs, c = axis.skeleton, axis.runs, axis.curves
    i, s = k.strip_i[runs.run_strip], k.strip_s[runs.run_strip]
    back = ~runs.run_forward
    disc = np.where(back[:, None], i[:, [3, 2]], i[:, [2, 3]])
    right = np.where(back, i[:, 1], i[:, 0])
    left = np.where(back, i[:, 0], i[:, 1])
    right_s = np.where(back[:, None], s[:, [3, 2]], s[:, [0, 1]])
    left_s = np.where(back[:, None], s[:, [1, 0]], s[:, [2, 3]])
    begins = np.flatnonzero(np.diff(c.part_strip, prepend=-1) != 0)
    part = np.append(begins, len(c.part_strip))
    degree, rows = cut_parts(axis)
    return Strips(disc, right, left, right_s, left_s, part, degree, rows[:, :, 2], rows[:, :, 3])


def find_corners(axis: MedialAxis, strips: Strips, distance: float, level: float, above: Flags) -> Corners:
    """Where r passes the level.

    Parameters
    ----------
    axis : MedialAxis
    strips : Strips
    distance, level : float
        Normalised. Whether r passes is decided at the level, a little above the distance; the place is that of r = distance.
    above : (D,) bool
        Whether each disc of the skeleton is larger than the level.

    Returns
    -------
    Corners
    """
    if not len(strips.disc):
        none = np.empty(0)
        return Corners(np.empty(0, dtype=np.int64), none, none)
    q, start, end = _numerators(strips, level, above)
    rows = np.flatnonzero((q.min(axis=1) <= 0.0) & (q.max(axis=1) > 0.0) | (start != end))
    part, lo, hi, rising = _isolate(q, strips.degree, rows, start, end)
    tau = _bisect(q, strips.degree, part, lo, hi, rising)
    order = np.lexsort((tau, part))
    part, tau = part[order], tau[order]
    strip = np.searchsorted(strips.part, part, side="right") - 1
    right_s, left_s = _start_footpoints(axis, strips, strip, part, tau)
    _meet(axis.table, strips, strip, distance, right_s, left_s)
    return Corners(strip, right_s, left_s)


def _numerators(strips: Strips, level: float, above: Flags) -> tuple[Floats, Flags, Flags]:
    """(q, whether each piece starts above the level, whether it ends above)."""
    q = strips.weight * (strips.radius - level)
    start = q[:, 0] > 0.0
    start[strips.part[:-1]] = above[strips.disc[:, 0]]
    end = np.append(start[1:], False)
    end[strips.part[1:] - 1] = above[strips.disc[:, 1]]
    return q, start, end


def _isolate(q: Floats, degree: Ints, rows: Ints, start: Flags, end: Flags) -> tuple[Ints, Floats, Floats, Flags]:
    """(piece, lo, hi, whether q rises) of intervals with one root each."""
    found: list[tuple[int, float, float, bool]] = []
    for row in rows.tolist():
        n = int(degree[row])
        waiting = [(q[row, : n + 1], bool(start[row]), bool(end[row]), 0.0, 1.0, HALVINGS)]
        while waiting:
            c, first, last, lo, hi, left = waiting.pop()
            signs = c[1:-1] > 0.0
            changes = np.count_nonzero(np.diff(np.concatenate(([first], signs, [last]))))
            if changes == 1 or (changes and first != last and not left):
                found.append((row, lo, hi, last))
            elif changes and left:
                a, b = _halves(c)
                middle, at = 0.5 * (lo + hi), bool(b[0] > 0.0)
                waiting += [(a, first, at, lo, middle, left - 1), (b, at, last, middle, hi, left - 1)]
    columns = list(zip(*found, strict=True)) or [(), (), (), ()]
    return (np.array(columns[0], dtype=np.int64), np.array(columns[1], dtype=float), np.array(columns[2], dtype=float),
            np.array(columns[3], dtype=bool))


def _halves(c: Floats) -> tuple[Floats, Floats]:
    """Bernstein coefficients of both halves (de Casteljau)."""
    a, b = c.copy(), c.copy()
    row = c
    for i in range(1, len(c)):
        row = 0.5 * (row[:-1] + row[1:])
        a[i], b[-1 - i] = row[0], row[-1]
    return a, b


def _bisect(q: Floats, degree: Ints, part: Ints, lo: Floats, hi: Floats, rising: Flags) -> Floats:
    """The root in each interval, nearly."""
    for _ in range(BISECTIONS):
        middle = 0.5 * (lo + hi)
        high = (_values(q[part], degree[part], middle) > 0.0) == rising
        lo, hi = np.where(high, lo, middle), np.where(high, middle, hi)
    return 0.5 * (lo + hi)


def _values(c: Floats, degree: Ints, t: Floats) -> Floats:
    """Polynomials with Bernstein coefficients c (n, width), the first degree + 1 of them, at t (n,)."""
    row = c
    s = 1.0 - t
    out = c[:, 0].copy()
    for step in range(1, int(degree.max(initial=0)) + 1):
        row = s[:, None] * row[:, :-1] + t[:, None] * row[:, 1:]
        out = np.where(degree == step, row[:, 0], out)
    return out


def _start_footpoints(axis: MedialAxis, strips: Strips, strip: Ints, part: Ints, tau: Floats) -> tuple[Floats, Floats]:
    """Both footpoints at tau of each piece, from the curve."""
    t, c, k = axis.table, axis.curves, axis.skeleton
    ends = c.part_f[part, :2]
    at = ends[:, 0] + tau * (ends[:, 1] - ends[:, 0])
    located = np.empty((5, len(at)))
    sites = np.empty((2, len(at)), dtype=np.int64)
    locate(t.si, t.sf, t.cp, k.strip_i, k.strip_s, c.degree, c.knot_start, c.knots, c.cp_start, c.cp, c.max_error,
           c.part_start, c.part_i, c.part_f, c.part_segment[part], at, np.empty((int(c.degree.max()) + 1, 4)), np.empty(6),
           np.empty(6), np.empty(5), located, sites)
    right, left = strips.right_s[strip], strips.left_s[strip]
    right_s = np.clip(located[3], right[:, 0], right[:, 1])
    left_s = np.clip(located[4], left[:, 1], left[:, 0])
    # a piece too short for t is found beside its own strip
    astray = (sites[0] != strips.right[strip]) | (sites[1] != strips.left[strip])
    right_s[astray], left_s[astray] = right[astray].mean(axis=1), left[astray].mean(axis=1)
    return right_s, left_s


def frame(table: SiteTable, site: int, s: float) -> tuple[float, float, float, float, float, float]:
    """(x, y, tx, ty, k, speed) at s of a site: point, tangent, curvature, |dC/ds|."""
    found: tuple[float, float, float, float, float, float] = evaluate(  # type: ignore[no-untyped-call]
        table.si, table.sf, table.cp, site, s, 0.0, 0.0)
    return found


def parallel(table: SiteTable, site: int, s: float, distance: float) -> tuple[float, float, float, float]:
    """(x, y, dx, dy): the point at a distance from s of a site along its normal, and its derivative by s."""
    x, y, tx, ty, k, speed = frame(table, site, s)
    along = speed - distance * _turning(table, site, s, k, speed)
    return x - distance * ty, y + distance * tx, along * tx, along * ty


def _turning(table: SiteTable, site: int, s: float, k: float, speed: float) -> float:
    """How fast the normal turns with s, left positive."""
    if table.si[site, KIND] == FAN:
        return float(table.sf[site, SWEEP])
    if np.isfinite(k):
        return k * speed
    # an end without speed, where k has no bound but their product has a limit
    inward = BESIDE if s < 0.5 else -BESIDE
    near, far = (frame(table, site, s + i * inward)[4:] for i in (1, 2))
    return 2.0 * near[0] * near[1] - far[0] * far[1]


def _meet(table: SiteTable, strips: Strips, strip: Ints, distance: float, right_s: Floats, left_s: Floats) -> None:
    """Move both footpoints of each corner to where the points at a distance meet; in place.

    A step that does not bring them nearer is the last: where r has an extreme near the level they need not meet at all.
    """
    for n, row in enumerate(strip.tolist()):
        a, b = int(strips.right[row]), int(strips.left[row])
        (u_lo, u_hi), (v_hi, v_lo) = strips.right_s[row], strips.left_s[row]
        u, v = float(right_s[n]), float(left_s[n])
        best = math.inf
        for _ in range(NEWTON_STEPS):
            px, py, ax, ay = parallel(table, a, u, distance)
            qx, qy, bx, by = parallel(table, b, v, distance)
            gx, gy = qx - px, qy - py
            miss = math.hypot(gx, gy)
            if not miss < best:
                break
            best, right_s[n], left_s[n] = miss, u, v
            cross = ax * by - ay * bx
            if cross == 0.0:
                break
            u = min(max(u + (gx * by - gy * bx) / cross, u_lo), u_hi)
            v = min(max(v + (gx * ay - gy * ax) / cross, v_lo), v_hi)
