r"""What shapely's buffer makes of an offset, between two bounds.

Loops are flattened; all of a curve stands within [lo, hi] to the left of its chord (`flatten`). Nearest points of the curve seen
from inside are so much nearer or farther than those of the chord, so what chords sweep at d + hi covers all that is within d
of the curve, and at d + lo nothing else:

    polygon - swept(d + hi)   is part of the offset at d, which is part of   polygon - swept(d + lo).

The offset's area must lie between the two; half their difference is what the reference does not know. Straight edges add
nothing to it, and a chord of n times fewer adds n^2 times as much.

What a chord sweeps is a rectangle, and at joints that turn from the inside a sector; at corners it is shapely's buffer of the
vertex. All are drawn so that they cover the sector, or are covered by it, as the bound asks; shapely unites them and takes
them from the polygon. Its buffer of the whole polygon is no reference for what is asked here: GEOS straightens what it
buffers by up to 1 % of the distance where it is concave towards the side that grows (`BufferInputLineSimplifier`), which
moves the offset of a round wall by thousands of times as much. Where all edges are straight the two are the same.

    inside    .--''--.        turning from the inside: rectangles and the triangles between them, in runs drawn as one polygon
      ^     ./ reflex \.      a corner: a disc, of quad_segs
                              turning to the inside: rectangles, which overlap, in runs drawn as one polygon
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]
Loop = tuple[RationalBSpline, ...]

QUAD_SEGS = 1024  # chords of a quarter of a disc at a corner: 3e-7 of the distance
TURN = 0.02  # radians by which chords of a curve may turn to the inside
REFLEX_TURN = 1e-3  # or from it: sectors are triangles there, which are 1.3e-7 of the distance too small
CORNER = 1.5e-3  # what turns more from the inside is a corner
RUN_CHORDS = 64
RUN_TURN = 0.5  # radians
HALVINGS = 30  # of a Bezier


class Between(NamedTuple):
    """The offset contains `least` and is part of `most`."""

    least: shapely.Geometry
    most: shapely.Geometry

    @property
    def area(self) -> float:
        """In the middle of both."""
        return 0.5 * float(self.least.area + self.most.area)

    @property
    def doubt(self) -> float:
        """By which that may be wrong."""
        return 0.5 * float(self.most.area - self.least.area)


class Chords(NamedTuple):
    """Chords of one loop, head to tail: start (n, 2), and between which heights lo <= 0 <= hi to the left the curve is (n,)."""

    start: Floats
    lo: Floats
    hi: Floats


# Flattening ----------------------------------------------------------------------------------------------------------
def beziers(edge: RationalBSpline) -> Floats:
    """(n, degree + 1, 3) homogeneous control points of the Bezier pieces, by knot insertion (Boehm)."""
    p, knots = edge.degree, np.asarray(edge.knots, dtype=float)
    rows = np.column_stack((edge.control_points * edge.weights[:, None], edge.weights))
    inner = np.unique(knots[(knots > knots[0]) & (knots < knots[-1])])
    for u in inner:
        while np.count_nonzero(knots == u) < p:
            k = int(np.searchsorted(knots, u, side="right")) - 1
            i = np.arange(k - p + 1, k + 1)
            share = ((u - knots[i]) / (knots[i + p] - knots[i]))[:, None]
            rows = np.vstack((rows[: k - p + 1], (1 - share) * rows[i - 1] + share * rows[i], rows[k:]))
            knots = np.insert(knots, k + 1, u)
    first = np.arange(len(inner) + 1) * p
    return rows[first[:, None] + np.arange(p + 1)]


def flatten(edge: RationalBSpline, error: float) -> Chords:
    """Chords of an edge with the curve within `error`.

    A Bezier is a mean of its control points in which the ends, on the chord, have a share of 2^(1 - n) at least where all
    weights are one: so it is as high as 1 - 2^(1 - n) of its control points at most.
    """
    if edge.degree == 1:
        return Chords(edge.control_points[:-1], np.zeros(len(edge.control_points) - 1), np.zeros(len(edge.control_points) - 1))
    share = 1.0 - 2.0 ** (1 - edge.degree) if np.ptp(edge.weights) == 0.0 else 1.0
    rows = beziers(edge)
    order = np.arange(len(rows), dtype=float)
    found = []
    for halving in range(HALVINGS):
        lo, hi, turn = _heights(rows, share)
        flat = (hi - lo <= error) & (turn <= np.where(hi > 0.0, REFLEX_TURN, TURN))
        found.append(np.column_stack((order, rows[:, 0, :2] / rows[:, 0, 2:], lo, hi))[flat])
        rows, order = rows[~flat], order[~flat]
        rows = np.stack(_halves(rows), axis=1).reshape(-1, *rows.shape[1:])
        order = np.stack((order, order + 0.5 ** (halving + 1)), axis=1).reshape(-1)
    if len(rows):
        raise ValueError("an edge is not flat in the end")
    table = np.concatenate(found)
    table = table[np.argsort(table[:, 0])]
    return Chords(table[:, 1:3], table[:, 3], table[:, 4])


def _heights(rows: Floats, share: float) -> tuple[Floats, Floats, Floats]:
    """(lo, hi, turn) of Beziers: between which heights over their chord they are, and about how much they turn."""
    p = rows[:, :, :2] / rows[:, :, 2:]
    way = p[:, -1] - p[:, 0]
    length = np.maximum(np.hypot(way[:, 0], way[:, 1]), np.finfo(float).tiny)
    x, y = np.moveaxis(p - p[:, :1], 2, 0)
    along = (x * way[:, :1] + y * way[:, 1:]) / length[:, None]
    left = share * (way[:, :1] * y - way[:, 1:] * x) / length[:, None]
    # what stands before or behind the chord is that much farther from it
    beside = np.maximum(np.maximum(-along, along - length[:, None]), 0.0).max(axis=1)
    lo, hi = np.minimum(left.min(axis=1), 0.0) - beside, np.maximum(left.max(axis=1), 0.0) + beside
    return lo, hi, 8.0 * (hi - lo) / length


def _halves(rows: Floats) -> tuple[Floats, Floats]:
    """Both halves of Beziers (de Casteljau)."""
    a, b = rows.copy(), rows.copy()
    row = rows
    for i in range(1, rows.shape[1]):
        row = 0.5 * (row[:, :-1] + row[:, 1:])
        a[:, i], b[:, -1 - i] = row[:, 0], row[:, -1]
    return a, b


# Sweeping ------------------------------------------------------------------------------------------------------------
class Flattened:
    """A region between loops of curves as a fine polygon, and what is left of it at a distance.

    `error` is what `flatten` takes, in the unit of the curves.
    """

    def __init__(self, outer: Loop, holes: tuple[Loop, ...], error: float) -> None:
        self.loops = [_chords(loop, error, n == 0) for n, loop in enumerate((outer, *holes))]
        self.polygon = shapely.Polygon(self.loops[0].start, [loop.start for loop in self.loops[1:]])

    def at(self, distance: float) -> Between:
        """What is farther inside than a distance; where that is negative, what is in the region or so near to it."""
        if distance > 0.0:
            return Between(self.polygon.difference(_union(self.loops, distance, True)),
                           self.polygon.difference(_union(self.loops, distance, False)))
        turned = [_turned(loop) for loop in self.loops]
        return Between(self.polygon.union(_union(turned, -distance, False)), self.polygon.union(_union(turned, -distance, True)))


def _union(loops: list[Chords], distance: float, all_: bool) -> shapely.Geometry:
    """What loops sweep on their left."""
    return shapely.union_all([part for loop in loops for part in _swept(loop, distance, all_)])


def _turned(loop: Chords) -> Chords:
    """A loop run the other way."""
    return Chords(np.roll(loop.start[::-1], 1, axis=0), -loop.hi[::-1], -loop.lo[::-1])


def _chords(loop: Loop, error: float, outer: bool) -> Chords:
    """The chords of a loop, the inside of the domain on the left."""
    start, lo, hi = (np.concatenate(column) for column in zip(*(flatten(edge, error) for edge in loop), strict=True))
    keep = np.hypot(*(start - np.roll(start, -1, axis=0)).T) > 0.0
    start, lo, hi = start[keep], lo[keep], hi[keep]
    x, y = (start - start[0]).T
    if (float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) > 0.0) != outer:
        return _turned(Chords(start, lo, hi))
    return Chords(start, lo, hi)


def _swept(loop: Chords, distance: float, all_: bool) -> list[shapely.Geometry]:
    """Polygons that cover all that is within a distance of the curves on their left, or nothing else."""
    p, n = loop.start, len(loop.start)
    q = np.roll(p, -1, axis=0)
    way = q - p
    before = np.roll(way, 1, axis=0)
    turn = np.arctan2(before[:, 0] * way[:, 1] - before[:, 1] * way[:, 0], (before * way).sum(axis=1))
    reach = distance + (loop.hi if all_ else loop.lo)
    reflex = (turn < 0.0) & (turn >= -CORNER)
    rim = distance / math.cos(math.pi / (4.0 * QUAD_SEGS)) if all_ else distance
    out: list[shapely.Geometry] = list(shapely.buffer(shapely.points(p[turn < -CORNER]), rim, quad_segs=QUAD_SEGS))
    for begin, end in _runs(reflex, np.abs(turn)):
        rows = np.arange(begin - 1, end) % n  # the joints of a run, and the chord before the first
        d = float(reach[rows].max() if all_ else reach[rows].min())
        rim = d / math.cos(0.5 * float(-turn[rows[1:]].min())) if all_ else d
        normal = _normals(p[rows], q[rows])
        far = np.stack((p[rows] + rim * normal, q[rows] + rim * normal), axis=1).reshape(-1, 2)
        out.append(shapely.Polygon(np.vstack((p[rows], q[rows[-1:]], far[::-1]))))
    lined = reflex | np.roll(reflex, -1)
    straight = turn >= 0.0
    for begin, end in _runs(straight, turn):
        rows = np.arange(begin - 1, end) % n
        out += _bands(p[rows], q[rows], float(reach[rows].max() if all_ else reach[rows].min()))
    alone = np.flatnonzero(~lined & ~straight & ~np.roll(straight, -1))
    for k in alone.tolist():
        out += _bands(p[k : k + 1], q[k : k + 1], float(reach[k]))
    return out


def _runs(wanted: NDArray[np.bool_], turn: Floats) -> list[tuple[int, int]]:
    """Joints begin .. end in a row that are wanted, round the loop, in runs that turn little and have few chords."""
    n = len(wanted)
    first = int(np.argmin(wanted))
    runs: list[tuple[int, int]] = []
    total = 0.0
    for k in range(first, first + n):
        if not wanted[k % n]:
            continue
        total += float(turn[k % n])
        if runs and runs[-1][1] == k and total <= RUN_TURN and k - runs[-1][0] < RUN_CHORDS:
            runs[-1] = (runs[-1][0], k + 1)
        else:
            runs.append((k, k + 1))
            total = float(turn[k % n])
    return runs


def _bands(p: Floats, q: Floats, d: float) -> list[shapely.Polygon]:
    """The union of the rectangles over chords that turn to the left: one polygon if that is simple, else those of both halves.

    Neighbouring rectangles overlap up to where their far sides cross.
    """
    normal = _normals(p, q)
    unit = np.column_stack((normal[:, 1], -normal[:, 0]))
    inner = normal[:-1] + normal[1:]
    crossing = p[1:] + d * inner * (2.0 / (inner * inner).sum(axis=1))[:, None]
    far = np.vstack((p[:1] + d * normal[:1], crossing, q[-1:] + d * normal[-1:]))
    forward = (np.diff(far, axis=0) * unit).sum(axis=1) > 0.0
    if len(p) == 1 or forward.all():
        return [shapely.Polygon(np.vstack((p, q[-1:], far[::-1])))]
    middle = len(p) // 2
    return _bands(p[:middle], q[:middle], d) + _bands(p[middle:], q[middle:], d)


def _normals(p: Floats, q: Floats) -> Floats:
    """To the left of chords, of length one."""
    way = q - p
    normals: Floats = np.column_stack((-way[:, 1], way[:, 0])) / np.hypot(way[:, 0], way[:, 1])[:, None]
    return normals
