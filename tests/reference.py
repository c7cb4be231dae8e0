"""The slow, obvious oracle: distances and maximal discs by dense subdivision, sharing nothing with the library.

Every rational B-spline is cut into Bezier spans by blossoming and every span halved until its pieces, the *cells*, are
short and flat. A cell lies within `sag` of its chord (convex hull property), so a cell may be skipped for a query point
when its chord is too far off; in the cells that remain every local minimum of the distance is bracketed on a fixed grid
of nine parameters and refined by a safeguarded Newton iteration.

    chord  o-----------o        distance(p, cell) >= distance(p, chord) - sag
            `--.____.-'  ) sag

The maximal disc tangent at a boundary point is found by the shrinking ball: start too large, move to the disc through
the nearest point, repeat. Everything works in *normalised* coordinates: (input - box centre) / larger side of the box.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.special import comb

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CELL_LENGTH = 1 / 150  # longest cell, in units of the domain's larger side: thousands of cells a shape
CELL_SAG = 0.008  # sag / chord of a cell: about 4 degrees of turning
CELL_COSINE = 0.995  # of the angle between a leg of a cell and its chord, 6 degrees: a bend at an end moves the chord by nothing
CELL_LEGS = 3.0  # longest / shortest leg of a cell's control polygon: short handles hide sharp bends
CELL_WEIGHTS = 16.0  # largest / smallest weight of a cell
EVEN = 4.0  # ratio of the weights at both ends of a cell up to which they are left as they are
UNEVEN_LENGTH = 1e-9  # cells of a length below this may be uneven
BENT_LENGTH = 1e-14  # nor are shorter ones cut because they are bent: what they bend by is a vertex to any disc
DEEPEST = 100  # halvings of a span: below this a cell is at rounding level
GRID = 9  # parameters per cell where the sign of the derivative of the distance is looked at
FLAT = 0.25  # 1 - k r, of a point of the grid: beside it as many more parameters are looked at
TIE = 1e-14  # distances closer than this are taken as equal
OWN_BLUR = 3e-7  # error of a disc that its own curvature bounds: its partner is nearer than (TIE / k'')^(1/4)
SMOOTH_TURN = 1e-12  # turning given to a smooth vertex of infinite curvature
NO_LEG = 1e-18  # the widest floats tell no direction of a leg shorter than this,
AT_REST = 1e-7  # nor is one that is this short for its cell where that goes
BESIDE = 1e-10  # a bend so near to a vertex is beside it
HALVINGS = 100  # of a cell, until the place beside its end is found
TINY = 4e-13  # cells shorter than this are part of one bend with their neighbours
HAIRPIN = 1e-3  # radians; a bend of such cells that turns by less is no vertex
CORNER = 1e-6  # radians of turning that make a vertex, the default of the option smooth_angle


class Contacts(NamedTuple):
    """Local minima of the distance from query points: (c,) arrays, `point` (c, dim)."""

    query: Ints
    cell: Ints
    s: Floats
    point: Floats
    distance: Floats


def elevate(control: Floats, degree: int) -> Floats:
    """Raise the degree of Bezier control points (k + 1, dim) to `degree`, exactly."""
    while len(control) - 1 < degree:
        n = len(control)
        a = (np.arange(n + 1) / n)[:, None]
        padded = np.vstack([control[:1], control, control[-1:]])
        control = a * padded[:-1] + (1 - a) * padded[1:]
    return control


def blossom(control: Floats, knots: Floats, degree: int, span: int, arguments: Floats) -> Floats:
    """The symmetric multi-affine form of the polynomial on knot span `span` at `degree` arguments."""
    d = control[span - degree : span + 1].copy()
    for level, a in enumerate(arguments, start=1):
        for j in range(degree, level - 1, -1):
            i = span - degree + j
            lo, hi = knots[i], knots[i + degree - level + 1]
            w = (a - lo) / (hi - lo)
            d[j] = (1 - w) * d[j - 1] + w * d[j]
    return np.asarray(d[degree])


def bezier_spans(control: Floats, knots: Floats, degree: int) -> list[tuple[float, float, Floats]]:
    """Bezier form of every knot span that is not empty: (u0, u1, homogeneous control points)."""
    spans = []
    for k in range(degree, len(control)):
        u0, u1 = knots[k], knots[k + 1]
        if u1 > u0:
            points = [
                blossom(control, knots, degree, k, np.array([u0] * (degree - j) + [u1] * j)) for j in range(degree + 1)
            ]
            spans.append((float(u0), float(u1), np.array(points)))
    return spans


def homogeneous(points: Floats, weights: Floats) -> Floats:
    """Rows (w x, w y, ..., w)."""
    return np.hstack([points * weights[:, None], weights[:, None]])


def full_knots(edge: dict[str, Any]) -> Floats:
    """The edge's knots; those of a Bezier when left out."""
    degree = int(edge["degree"])
    given = edge.get("knots")
    return np.array([0.0] * (degree + 1) + [1.0] * (degree + 1) if given is None else given, dtype=float)


class Intervals(NamedTuple):
    """Parameters [lo, hi] of cells, seen from a point p: (n,) `row` of both, g = (C - p).C' and its slope at lo and hi."""

    row: Ints
    lo: Floats
    hi: Floats
    g_lo: Floats
    g_hi: Floats
    slope_lo: Floats
    slope_hi: Floats

    def where(self, those: NDArray[np.bool_]) -> Intervals:
        """Some of them."""
        return Intervals(*(column[those] for column in self))


class CurveSet:
    """A set of rational B-splines of any dimension, cut into cells, that answers nearest-point queries.

    Each cell keeps its control points relative to its own start, and its end weights alike (`skew`): a bend of 1e-13 that an
    edge with weights from 1e-6 to 1e6 runs through within 1e-20 of its parameter has cells with tangents and curvatures.
    """

    def __init__(self, curves: list[tuple[int, Floats, Floats]], cell_length: float = CELL_LENGTH) -> None:
        """`curves`: (degree, knots, homogeneous control points) each; coordinates of size about one."""
        self.degree = max(degree for degree, _, _ in curves)
        owner, u0, u1, control = [], [], [], []
        for i, (degree, knots, points) in enumerate(curves):
            for a, b, bezier in bezier_spans(np.asarray(points, dtype=np.longdouble), knots, degree):
                owner.append(i)
                u0.append(a)
                u1.append(b)
                control.append(elevate(bezier, self.degree))
        self.owner: Ints = np.array(owner, dtype=np.int64)
        self.u0: Floats = np.array(u0)
        self.u1: Floats = np.array(u1)
        self.skew: Floats = np.ones(len(owner))
        self._control = np.array(control, dtype=np.longdouble)
        self._start = np.zeros((len(owner), self._control.shape[2] - 1), dtype=np.longdouble)
        self._settle(np.arange(len(owner)))
        for _ in range(DEEPEST):
            if not self._halve(cell_length):
                break
        self.control: Floats = self._control.astype(float)
        self.start: Floats = self._start.astype(float)
        self.end: Floats = (self._start + self._project(self._control[:, -1])).astype(float)
        self.length: Floats = np.sum(np.linalg.norm(np.diff(self._project(self.control), axis=1), axis=2), axis=1)
        self.sag = self._sag().astype(float)
        self.half = 0.5 * np.linalg.norm(self.end - self.start, axis=1) + self.sag
        s = np.repeat(np.linspace(0, 1, GRID)[None], len(self.owner), axis=0)
        cells = np.repeat(np.arange(len(self.owner))[:, None], GRID, axis=1)
        self.grid, self.grid_d, self.grid_dd = (
            v.reshape(len(self.owner), GRID, -1) for v in self.evaluate(cells.ravel(), s.ravel())
        )
        self.tree = cKDTree(0.5 * (self.start + self.end))
        self.start_tree = cKDTree(self.grid.reshape(-1, self.grid.shape[2]))

    @staticmethod
    def _project(h: Any) -> Any:
        return h[..., :-1] / h[..., -1:]

    def _settle(self, cells: Ints) -> None:
        """Control points of these cells relative to the cells' starts; end weights alike where they are not.

        Weights w_i c^i belong to the same curve: u0 + (u1 - u0) s / (s + skew (1 - s)) is the parameter at s.
        """
        d = self._control[cells]
        first = self._project(d[:, 0])
        self._start[cells] += first
        d[:, :, :-1] -= first[:, None] * d[:, :, -1:]
        ratio = d[:, -1, -1] / d[:, 0, -1]
        factor = np.where((ratio < EVEN) & (ratio > 1 / EVEN), 1.0, ratio ** (-1.0 / self.degree))
        d *= (factor[:, None] ** np.arange(self.degree + 1))[:, :, None]
        d /= d[:, :1, -1:]
        self.skew[cells] /= factor.astype(float)
        self._control[cells] = d

    def _sag(self) -> Any:
        """Largest distance of a control point from the chord of its cell, (cells,)."""
        p = self._project(self._control)
        return np.max(np.linalg.norm(p - _closest_on_chords(p, p[:, :1], p[:, -1:]), axis=2), axis=1)

    def _halve(self, cell_length: float) -> bool:
        """Halve the cells that are too long, too bent or too uneven, where they are; False when there were none."""
        p = self._project(self._control)
        weights = self._control[:, :, -1]
        chord = np.linalg.norm(p[:, -1] - p[:, 0], axis=1)
        legs = np.linalg.norm(np.diff(p, axis=1), axis=2)
        length = np.sum(legs, axis=1)
        uneven = (legs.max(axis=1) > CELL_LEGS * legs.min(axis=1)) | (weights.max(axis=1) > CELL_WEIGHTS * weights.min(axis=1))
        bent = self._sag() > CELL_SAG * chord
        along = np.einsum("ijk,ik->ij", np.diff(p, axis=1), p[:, -1] - p[:, 0])
        bent |= ((along < CELL_COSINE * legs * chord[:, None]) & (legs > NO_LEG)).any(axis=1)
        bad = (length > cell_length) | (uneven & (length > UNEVEN_LENGTH)) | (bent & (length > BENT_LENGTH))
        if not bad.any():
            return False
        left, right, d = [self._control[bad][:, 0]], [self._control[bad][:, -1]], self._control[bad]
        while d.shape[1] > 1:
            d = 0.5 * (d[:, :-1] + d[:, 1:])
            left.append(d[:, 0])
            right.append(d[:, -1])
        u0, u1, skew = self.u0[bad], self.u1[bad], self.skew[bad]
        middle = u0 + (u1 - u0) / (1 + skew)
        source = np.repeat(np.arange(len(bad)), 1 + bad)
        for name in ("owner", "u0", "u1", "skew", "_control", "_start"):
            setattr(self, name, getattr(self, name)[source])
        first = (np.cumsum(1 + bad) - 2)[bad]
        self.u1[first], self.u0[first + 1] = middle, middle
        self.skew[first], self.skew[first + 1] = 2 * skew / (1 + skew), 0.5 * (1 + skew)
        self._control[first], self._control[first + 1] = np.stack(left, axis=1), np.stack(right[::-1], axis=1)
        self._settle(np.concatenate([first, first + 1]))
        return True

    def evaluate(self, cell: Ints, s: Floats) -> tuple[Floats, Floats, Floats]:
        """Position and its first two derivatives by the cell's own s in [0, 1]; each (n, dim)."""
        d, n = self.control[cell], self.degree
        bernstein = [
            comb(k, np.arange(k + 1)) * s[:, None] ** np.arange(k + 1) * (1 - s[:, None]) ** np.arange(k, -1, -1)
            for k in (n, n - 1, max(n - 2, 0))
        ]
        first = n * np.diff(d, axis=1)
        h0 = np.einsum("ij,ijk->ik", bernstein[0], d)
        h1 = np.einsum("ij,ijk->ik", bernstein[1], first)
        h2 = np.einsum("ij,ijk->ik", bernstein[2], (n - 1) * np.diff(first, axis=1)) if n > 1 else np.zeros_like(h0)
        w = h0[:, -1:]
        c = h0[:, :-1] / w
        c1 = (h1[:, :-1] - h1[:, -1:] * c) / w
        return self.start[cell] + c, c1, (h2[:, :-1] - 2 * h1[:, -1:] * c1 - h2[:, -1:] * c) / w

    def locate(self, owner: int, u: float) -> tuple[int, float]:
        """The cell of curve `owner` that holds parameter u, and the cell's own parameter."""
        first, last = np.searchsorted(self.owner, [owner, owner + 1])
        i = int(np.clip(np.searchsorted(self.u0[first:last], u, side="right") - 1, 0, last - first - 1)) + int(first)
        if not self.u0[i] < self.u1[i]:
            return i, 0.0
        share = float(np.clip((u - self.u0[i]) / (self.u1[i] - self.u0[i]), 0.0, 1.0))
        return i, share * self.skew[i] / (share * self.skew[i] + 1 - share)

    def points(self, owner: Ints, u: Floats) -> Floats:
        """Positions at curve parameters."""
        where = [self.locate(int(o), float(v)) for o, v in zip(owner, u, strict=True)]
        return self.evaluate(np.array([c for c, _ in where], dtype=np.int64), np.array([s for _, s in where]))[0]

    def contacts(self, queries: Floats, slack: float | Floats = 0.0) -> tuple[Floats, Contacts]:
        """Distances (m,) of the queries (m, dim), and all local minima within `slack` of them.

        A minimum at the end of a cell is reported by that cell only; whether the neighbour goes on decreasing is
        left to the caller. Of exact ties (the centre of a circle) some are reported.
        """
        m = len(queries)
        slack = np.broadcast_to(np.asarray(slack, dtype=float), (m,))
        upper = self.start_tree.query(queries)[0]
        found = self.tree.query_ball_point(queries, upper + slack + self.half.max() * (1 + 1e-12) + 1e-15)
        counts = np.array([len(f) for f in found])
        q = np.repeat(np.arange(m), counts)
        cell = np.concatenate([np.asarray(f, dtype=np.int64) for f in found])
        p = queries[q]
        chord = np.linalg.norm(p - _closest_on_chords(p, self.start[cell], self.end[cell]), axis=1)
        keep = chord - self.sag[cell] <= (upper + slack)[q] + 1e-14
        q, cell, p = q[keep], cell[keep], p[keep]
        # one row per bracket: a sign change - to + of (C - p).C', or a cell end from which the distance grows inward
        g = np.einsum("ijk,ijk->ij", self.grid[cell] - p[:, None], self.grid_d[cell])
        intervals = self._intervals(cell, p, g)
        row, lo, hi = intervals.where((intervals.g_lo < 0) & (intervals.g_hi >= 0))[:3]
        s = self._refine(cell[row], p[row], lo, hi)
        at0, at1 = np.nonzero(g[:, 0] >= 0)[0], np.nonzero(g[:, -1] <= 0)[0]
        dip, dip_s = self._dips(cell, p, at0, at1)
        pair, pair_s = self._pairs(cell, p, intervals)
        rows = np.concatenate([row, at0, at1, dip, pair])
        s = np.concatenate([s, np.zeros(len(at0)), np.ones(len(at1)), dip_s, pair_s])
        q, cell = q[rows], cell[rows]
        point = self.evaluate(cell, s)[0]
        distance = np.linalg.norm(point - queries[q], axis=1)
        best = upper.copy()
        np.minimum.at(best, q, distance)
        near = distance <= best[q] + slack[q] + 1e-13
        return best, Contacts(q[near], cell[near], s[near], point[near], distance[near])

    def _dips(self, cell: Ints, p: Floats, at0: Ints, at1: Ints) -> tuple[Ints, Floats]:
        """Minima between a cell's end and the next grid point, where k r > 1 at the end: rows and parameters.

        Where curvature falls fast from a joint, the second contact of a disc may be much closer to it than the grid.
        """
        rows, ends = np.concatenate([at0, at1]), np.concatenate([np.zeros(len(at0)), np.ones(len(at1))])
        c, c1, c2 = self.evaluate(cell[rows], ends)
        concave = np.sum(c1 * c1, axis=1) + np.sum((c - p[rows]) * c2, axis=1) < 0
        rows, ends = rows[concave], ends[concave]
        away = np.concatenate([[0.0], 2.0 ** np.arange(-30, 1) / (GRID - 1)])
        s = np.abs(ends[:, None] - away)
        flat = np.repeat(cell[rows], len(away)), s.ravel()
        c, c1, _ = (v.reshape(len(rows), len(away), v.shape[1]) for v in self.evaluate(*flat))
        inward = np.where(ends == 0, 1.0, -1.0)
        g = np.sum((c - p[rows][:, None]) * c1, axis=2) * inward[:, None]
        i, j = np.nonzero((g[:, :-1] < 0) & (g[:, 1:] >= 0))
        a, b = s[i, j], s[i, j + 1]
        return rows[i], self._refine(cell[rows[i]], p[rows[i]], np.minimum(a, b), np.maximum(a, b))

    def _intervals(self, cell: Ints, p: Floats, g: Floats) -> Intervals:
        """Those of the grid, whose g is given, of all rows: where it is flat, finer ones.

        There the cell follows a circle about the point, and there may be two minima where g has signs that show one, or none.
        """
        speed = np.sum(self.grid_d[cell] ** 2, axis=2)
        slope = speed + np.einsum("ijk,ijk->ij", self.grid[cell] - p[:, None], self.grid_dd[cell])
        flat = np.abs(slope) < FLAT * speed
        flat = flat[:, :-1] | flat[:, 1:]
        row, j = np.nonzero(~flat)
        step = 1.0 / (GRID - 1)
        coarse = row, j * step, (j + 1) * step, g[row, j], g[row, j + 1], slope[row, j], slope[row, j + 1]
        row, j = np.nonzero(flat)
        s = (j[:, None] + np.linspace(0, 1, GRID)) * step
        rows = np.repeat(row, GRID)
        c, c1, c2 = self.evaluate(cell[rows], s.ravel())
        fine_g = np.sum((c - p[rows]) * c1, axis=1).reshape(s.shape)
        fine_slope = (np.sum(c1 * c1, axis=1) + np.sum((c - p[rows]) * c2, axis=1)).reshape(s.shape)
        columns = (v[:, k : GRID - 1 + k].ravel() for v in (s, fine_g, fine_slope) for k in (0, 1))
        fine = np.repeat(row, GRID - 1), *columns
        return Intervals(*(np.concatenate(both) for both in zip(coarse, fine, strict=True)))

    def _pairs(self, cell: Ints, p: Floats, intervals: Intervals) -> tuple[Ints, Floats]:
        """Minima in intervals that have a maximum, too: rows and parameters.

        There g = (C - p).C' has the same sign at both ends, and its own extremum between them has the other one.
        """
        _, _, _, g_lo, g_hi, slope_lo, slope_hi = intervals
        above = (g_lo > 0) & (g_hi > 0) & (slope_lo < 0) & (slope_hi > 0)
        below = (g_lo < 0) & (g_hi < 0) & (slope_lo > 0) & (slope_hi < 0)
        sign = np.where(above, 1.0, -1.0)[above | below]
        row, a, b = intervals.where(above | below)[:3]
        lo, hi = a.copy(), b.copy()
        for _ in range(50 if len(row) else 0):
            m = 0.5 * (lo + hi)
            c, c1, c2 = self.evaluate(cell[row], m)
            falls = sign * (np.sum(c1 * c1, axis=1) + np.sum((c - p[row]) * c2, axis=1)) < 0
            lo, hi = np.where(falls, m, lo), np.where(falls, hi, m)
        c, c1, _ = self.evaluate(cell[row], lo)
        through = sign * np.sum((c - p[row]) * c1, axis=1) < 0
        row, a, b, lo, up = (v[through] for v in (row, a, b, lo, sign > 0))
        return row, self._refine(cell[row], p[row], np.where(up, lo, a), np.where(up, b, lo))

    def _refine(self, cell: Ints, p: Floats, lo: Floats, hi: Floats) -> Floats:
        """Root of (C(s) - p).C'(s) in [lo, hi] by Newton, bisecting whenever it would leave the bracket."""
        lo, hi = lo.copy(), hi.copy()
        s = 0.5 * (lo + hi)
        for _ in range(60):
            c, c1, c2 = self.evaluate(cell, s)
            g = np.einsum("ij,ij->i", c - p, c1)
            dg = np.einsum("ij,ij->i", c1, c1) + np.einsum("ij,ij->i", c - p, c2)
            lo, hi = np.where(g < 0, s, lo), np.where(g < 0, hi, s)
            with np.errstate(divide="ignore", invalid="ignore"):
                new = s - g / dg
            new = np.where((new >= lo) & (new <= hi), new, 0.5 * (lo + hi))
            moved = np.abs(new - s)
            s = new
            if not np.any(moved > 1e-13):
                break
        return s

    def nearest(self, queries: Floats) -> tuple[Floats, Ints, Floats, Floats]:
        """Distance, and cell, parameter and point of one nearest point for every query."""
        best, contact = self.contacts(queries, 1e-14)
        order = np.lexsort((contact.distance, contact.query))
        first = order[np.unique(contact.query[order], return_index=True)[1]]
        cell = np.zeros(len(queries), dtype=np.int64)
        s = np.zeros(len(queries))
        grid = self.start_tree.query(queries)[1]  # where no minimum is bracketed, the best of the grid
        cell[:], s[:] = grid // GRID, (grid % GRID) / (GRID - 1)
        cell[contact.query[first]], s[contact.query[first]] = contact.cell[first], contact.s[first]
        return best, cell, s, self.evaluate(cell, s)[0]


def _closest_on_chords(p: Floats, a: Floats, b: Floats) -> Floats:
    """Points of the straight segments a..b nearest to p, all (..., dim)."""
    ab = b - a
    length_sq = np.sum(ab * ab, axis=-1, keepdims=True)
    f = np.sum((p - a) * ab, axis=-1, keepdims=True) / np.where(length_sq > 0, length_sq, 1.0)
    return np.asarray(a + np.clip(f, 0.0, 1.0) * ab)


class Discs(NamedTuple):
    """Maximal discs tangent at boundary points; `blur` bounds the rounding error of each."""

    center: Floats
    radius: Floats
    partner: Floats
    blur: Floats


class Corner(NamedTuple):
    """A vertex: cell that ends there, point, turning (positive = convex) and the normals on both sides."""

    cell: int
    point: Floats
    turn: float
    normal_in: Floats
    normal_out: Floats


class Bend(NamedTuple):
    """Cells in a row that are all `TINY` and turn by a `HAIRPIN` or more: a vertex, with the cells before and after it.

    To a disc it turns at once by `turn`, from the one to the other; `left` is what it turns left by on its way.
    """

    cells: Ints
    before: int
    after: int
    turn: float
    left: float


@dataclass(frozen=True)
class Reference:
    """The oracle of one domain, given as the JSON object of the contract; joints that turn by no more are smooth."""

    domain: dict[str, Any]
    smooth_angle: float = CORNER

    @cached_property
    def loops(self) -> list[list[dict[str, Any]]]:
        """Outer loop first, then the holes."""
        return [self.domain["outer"], *self.domain.get("holes", [])]

    @cached_property
    def frame(self) -> tuple[Floats, float]:
        """Centre of the outer loop's bounding box and its larger side (to about 1e-7), the unit of all results."""
        curves = [(int(e["degree"]), full_knots(e), _edge_points(e, np.zeros(2), 1.0)) for e in self.domain["outer"]]
        corners = np.vstack([c[:, :2] / c[:, 2:] for _, _, c in curves])
        middle, rough = 0.5 * (corners.min(0) + corners.max(0)), float(np.ptp(corners, axis=0).max())
        scaled = CurveSet(
            [(d, k, _edge_points(e, middle, rough)) for (d, k, _), e in zip(curves, self.domain["outer"], strict=True)]
        )
        grid = scaled.grid.reshape(-1, 2)
        return middle + rough * 0.5 * (grid.min(0) + grid.max(0)), rough * float(np.ptp(grid, axis=0).max())

    @cached_property
    def floor(self) -> float:
        """What the rounding of the input's own coordinates is worth in normalised length."""
        origin, size = self.frame
        return float(4 * np.finfo(float).eps * (np.abs(origin).max() + size) / size)

    @cached_property
    def names(self) -> list[tuple[int, int]]:
        """(loop, edge) of every curve of the boundary set."""
        return [(i, j) for i, loop in enumerate(self.loops) for j in range(len(loop))]

    @cached_property
    def straight(self) -> NDArray[np.bool_]:
        """(edges,) True for those of degree 1: the rounding of a cell of 1e-10 bends it."""
        return np.array([e["degree"] == 1 for loop in self.loops for e in loop])

    @cached_property
    def boundary(self) -> CurveSet:
        """All edges, normalised."""
        origin, size = self.frame
        return CurveSet(
            [(int(e["degree"]), full_knots(e), _edge_points(e, origin, size)) for loop in self.loops for e in loop]
        )

    @cached_property
    def follow(self) -> Ints:
        """(cells,) the next cell along each cell's own loop, as the loop is given."""
        loop = np.array([self.names[o][0] for o in self.boundary.owner])
        following = np.arange(1, len(loop) + 1)
        for i in range(len(self.loops)):
            own = np.nonzero(loop == i)[0]
            following[own[-1]] = own[0]
        return following

    @cached_property
    def side(self) -> Floats:
        """(cells,) +1 where the interior is on the left of increasing u, -1 where the loop was given the other way."""
        loop = np.array([self.names[o][0] for o in self.boundary.owner])
        a, b = self.boundary.start, self.boundary.end
        twice = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        areas = np.array([twice[loop == i].sum() for i in range(len(self.loops))])
        wanted = np.where(np.arange(len(self.loops)) == 0, 1.0, -1.0)
        return np.asarray(np.asarray(np.sign(areas) * wanted)[loop])

    @cached_property
    def ends(self) -> tuple[Floats, Floats]:
        """Unit tangents at the start and end of every cell, in the direction of u; safe at zero speed."""
        p = self.boundary.control[:, :, :2] / self.boundary.control[:, :, 2:]
        least = np.maximum(AT_REST * self.boundary.length, NO_LEG)[:, None]
        return _first_direction(p, least), -_first_direction(p[:, ::-1], least)

    @cached_property
    def bends(self) -> list[Bend]:
        """Bends that are vertices to any disc: all of the turning happens within some 1e-12 of the point."""
        t0, t1 = self.ends
        within = np.arctan2(t0[:, 0] * t1[:, 1] - t0[:, 1] * t1[:, 0], np.sum(t0 * t1, axis=1)) * self.side
        tiny = self.boundary.length < TINY
        back = np.argsort(self.follow)
        found = []
        for first in np.nonzero(tiny & ~tiny[back])[0]:
            run = [int(first)]
            while tiny[self.follow[run[-1]]]:
                run.append(int(self.follow[run[-1]]))
            before, after = int(back[first]), int(self.follow[run[-1]])
            turns = np.concatenate([within[run], self.turns[[before, *run]]])
            if np.abs(turns).sum() < HAIRPIN:
                continue
            turn = math.atan2(t1[before, 0] * t0[after, 1] - t1[before, 1] * t0[after, 0], float(t1[before] @ t0[after]))
            found.append(Bend(np.array(run), before, after, turn * self.side[first], float(turns[turns > 0].sum())))
        return found

    @cached_property
    def bent(self) -> NDArray[np.bool_]:
        """(cells,) True for those of a bend."""
        result = np.zeros(len(self.follow), dtype=bool)
        for bend in self.bends:
            result[bend.cells] = True
        return result

    @cached_property
    def corners(self) -> list[Corner]:
        """Every vertex of the boundary, with the interior on the left."""
        t0, t1 = self.ends
        before, after, turn = t1.copy(), t0[self.follow], self.turns.copy()
        turn[self.bent | self.bent[self.follow]] = 0.0
        for bend in self.bends:
            turn[bend.before], after[bend.before] = bend.turn, t0[bend.after]
        found = []
        for i in np.nonzero(self.stalls & (np.abs(turn) <= self.smooth_angle))[0]:  # curvature +inf: a vertex of angle pi
            normal = _left(before[i] * self.side[i])
            found.append(Corner(int(i), self.boundary.end[i], SMOOTH_TURN, normal, normal))
        for i in np.nonzero(np.abs(turn) > self.smooth_angle)[0]:
            angle, side = float(turn[i]), self.side[i]
            t_in, t_out = (before[i], after[i]) if side > 0 else (-after[i], -before[i])
            if abs(angle) > np.pi - 1e-3:  # a cusp: the domain decides which way it points
                ahead = self.boundary.end[i] + 1e-4 * (t_in - t_out) / np.linalg.norm(t_in - t_out)
                angle = abs(angle) * (-1.0 if self.inside(ahead[None])[0] else 1.0)
            found.append(Corner(int(i), self.boundary.end[i], angle, _left(t_in), _left(t_out)))
        return found

    @cached_property
    def undone(self) -> set[int]:
        """Cells before a vertex or a bend that turns left, but by no more than the boundary turns back by in as little again.

        Where such a bend ends nobody can say, nor whether it is a convex vertex.
        """
        found = {c.cell for c in self.corners if 0 < c.turn < 1 and self._turn_about(c) <= 0}
        for bend in self.bends:
            k = self.at(np.array([bend.before, bend.after]), np.array([1.0, 0.0]))[2]
            if 0 < bend.turn <= -k.min() * TINY:
                found.add(bend.before)
        return found

    def _turn_about(self, corner: Corner) -> float:
        """What the boundary turns left by from a place just before a vertex to one as far after it."""
        first, last = self.normals_beside(corner)
        return math.atan2(first[0] * last[1] - first[1] * last[0], float(first @ last))

    def normals_beside(self, corner: Corner) -> tuple[Floats, Floats]:
        """The normals just before a vertex and just after it, with the interior on the left."""
        before, after = self._normal_beside(corner.cell, 1.0), self._normal_beside(int(self.follow[corner.cell]), 0.0)
        return (before, after) if self.side[corner.cell] > 0 else (after, before)

    def _normal_beside(self, cell: int, end: float) -> Floats:
        """The normal of a cell at a `TINY` distance from its end (1) or start (0)."""
        vertex = self.at(np.array([cell]), np.array([end]))[0][0]
        near, far = end, 1.0 - end
        for _ in range(HALVINGS):
            s = 0.5 * (near + far)
            point, normal, _ = self.at(np.array([cell]), np.array([s]))
            if np.linalg.norm(point[0] - vertex) < TINY:
                near = s
            else:
                far = s
        return np.asarray(normal[0])

    @cached_property
    def flat_corners(self) -> Floats:
        """(n, 2) places where the boundary turns left by too little for a corner, though by more than rounding."""
        flat: Floats = self.boundary.end[self._is_flat]
        return flat

    @cached_property
    def flat_turns(self) -> Floats:
        """(n,) by how much it turns at each of them."""
        turns: Floats = self.turns[self._is_flat]
        return turns

    @cached_property
    def _is_flat(self) -> NDArray[np.bool_]:
        return (self.turns > 1e-12) & (self.turns < 10 * CORNER)

    @cached_property
    def bends_beside_reflex(self) -> Floats:
        """(n, 2) reflex vertices beside which the boundary bends outward more tightly than a thousandth of the size."""
        follow, before = self.follow.copy(), np.argsort(self.follow)
        for bend in self.bends:
            follow[bend.before], before[bend.after] = bend.after, bend.before
        tight = [c.cell for c in self.corners if c.turn < 0
                 and max(self._bend_within(c.cell, 1.0, before), self._bend_within(int(follow[c.cell]), 0.0, follow)) > 1e3]
        points: Floats = self.boundary.end[np.array(tight, dtype=np.int64)]
        return points

    def _bend_within(self, cell: int, end: float, beyond: Ints) -> float:
        """The largest curvature within `BESIDE` of an end of a cell, 1 or 0, on it and those `beyond` it."""
        vertex = self.at(np.array([cell]), np.array([end]))[0]
        s = np.abs(end - np.concatenate([[0.0], 2.0 ** np.arange(-HALVINGS, 1)]))
        largest = -math.inf
        while True:
            point, _, curvature = self.at(np.full(len(s), cell), s)
            near = np.linalg.norm(point - vertex, axis=1) < BESIDE
            largest = max(largest, float(np.nan_to_num(curvature[near], nan=-math.inf).max(initial=-math.inf)))
            if not near[-1]:
                return largest
            cell = int(beyond[cell])

    @cached_property
    def points_of_bends(self) -> Floats:
        """(n, 2) joints of cells where the boundary bends left so tightly that its disc there is no larger than a `TINY` cell."""
        cells = np.arange(len(self.follow))
        tight = np.fmax(self.at(cells, np.ones(len(cells)))[2], self.at(self.follow, np.zeros(len(cells)))[2]) > 1 / TINY
        points: Floats = self.boundary.end[tight]
        return points

    @cached_property
    def turns(self) -> Floats:
        """(cells,) angle from each cell to its follower, radians, left positive; what rounding makes of tiny cells is none.

        Between knots, and at those of less than full multiplicity, a curve turns at once only where it stands still, right back.
        """
        after, before = self.ends
        after = after[self.follow]
        edges = [e for loop in self.loops for e in loop]
        knots = [full_knots(e) for e in edges]
        owner = self.boundary.owner
        cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        turn: Floats = np.arctan2(cross, np.sum(before * after, axis=1)) * self.side
        where = zip(owner, self.boundary.u1, strict=True)
        between = np.array([np.count_nonzero(knots[o] == u) < edges[o]["degree"] for o, u in where])
        turn[between & (np.abs(turn) < 1.0)] = 0.0
        return turn

    @cached_property
    def stalls(self) -> NDArray[np.bool_]:
        """(cells,) True where a cell or its follower rests at their joint and its curvature grows to +infinity."""
        cells = np.arange(len(self.follow))
        result = np.zeros(len(cells), dtype=bool)
        for cell, end, near, far in ((cells, 1.0, 1 - 1e-4, 1 - 1e-2), (self.follow, 0.0, 1e-4, 1e-2)):
            speed = np.linalg.norm(self.boundary.evaluate(cell, np.full(len(cell), end))[1], axis=1)
            with np.errstate(invalid="ignore"):
                k_near = self.at(cell, np.full(len(cell), near))[2]
                k_far = self.at(cell, np.full(len(cell), far))[2]
                result |= (speed < AT_REST * self.boundary.length[cell]) & (k_near > 10 * k_far) & (k_far > 0)
        return result & ~self.bent & ~self.bent[self.follow]

    def inside(self, points: Floats) -> NDArray[np.bool_]:
        """Crossing number on the chords of the cells: right beyond a sag of the boundary."""
        a = self.boundary.start
        b = a[self.follow]
        result = np.zeros(len(points), dtype=bool)
        for i, (x, y) in enumerate(points):
            up = (a[:, 1] <= y) != (b[:, 1] <= y)
            f = (y - a[up, 1]) / (b[up, 1] - a[up, 1])
            result[i] = np.count_nonzero(a[up, 0] + f * (b[up, 0] - a[up, 0]) > x) % 2 == 1
        return result

    def at(self, cell: Ints, s: Floats) -> tuple[Floats, Floats, Floats]:
        """Point, inward unit normal and curvature (positive = convex seen from inside) at cell parameters."""
        c, c1, c2 = self.boundary.evaluate(cell, s)
        side = self.side[cell]
        speed = np.linalg.norm(c1, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            curvature = side * (c1[:, 0] * c2[:, 1] - c1[:, 1] * c2[:, 0]) / speed**3
            curvature[self.straight[self.boundary.owner[cell]]] = 0.0
            normal = side[:, None] * _left(c1) / speed[:, None]
        return c, normal, curvature

    def maximal_discs(self, p: Floats, normal: Floats, curvature: Floats) -> Discs:
        """Largest discs tangent at the points `p` on the side of `normal`; `curvature` is the larger of both sides."""
        largest = 2.0  # beyond any disc of a domain of size one
        with np.errstate(divide="ignore"):
            r = np.minimum(np.where(curvature > 0, 1 / np.maximum(curvature, 1e-300), largest), largest)
        partner, blur = p.copy(), np.full(len(p), OWN_BLUR)
        active = np.arange(len(p))
        for _ in range(200):
            if not len(active):
                break
            c = p[active] + r[active, None] * normal[active]
            d, cell, _, q = self.boundary.nearest(c)
            # a bend that is a vertex to any disc may be that vertex
            placed = np.where(self.bent[cell], TINY, TIE)
            apart = q - p[active]
            with np.errstate(divide="ignore", invalid="ignore"):
                new = np.sum(apart**2, axis=1) / (2 * np.sum(apart * normal[active], axis=1))
                noise = 2 * placed * (r[active] / np.linalg.norm(apart, axis=1)) ** 2
            shrinks = (d < r[active] - TIE) & (new > 0) & (new < r[active] - 1e-16) & (noise < 1e-3)
            done = active[shrinks]
            stuck = (~shrinks) & (r[active] - d > 1e-12)
            blur[active[stuck]] = 1.0
            r[done], partner[done] = new[shrinks], q[shrinks]
            blur[done] = 1e-14 + noise[shrinks]
            active = done
        return Discs(p + r[:, None] * normal, r, partner, blur)


def _edge_points(edge: dict[str, Any], origin: Floats, size: float) -> Any:
    points = (np.array(edge["control_points"], dtype=np.longdouble) - origin) / size
    given = edge.get("weights")
    return homogeneous(points, np.ones(len(points), np.longdouble) if given is None else np.array(given, dtype=np.longdouble))


def _left(v: Floats) -> Floats:
    return np.stack([-v[..., 1], v[..., 0]], axis=-1)


def _first_direction(p: Any, least: float | Any) -> Floats:
    """Direction from p[:, 0] to the first control point that differs from it by more than `least`."""
    legs = p[:, 1:] - p[:, :1]
    lengths = np.linalg.norm(legs, axis=2)
    first = np.argmax(lengths > least, axis=1)
    rows = np.arange(len(p))
    return np.asarray(legs[rows, first] / np.maximum(lengths[rows, first], 1e-300)[:, None], dtype=float)
