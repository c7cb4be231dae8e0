r"""The envelope of the discs along the axis: the boundary, from centres and radii alone.

A disc (c, r)(t) of the family touches its envelope at p = c + r e, where the direction e is known from (p - c)^2 = r^2 and
its derivative, c'.e + r' = 0:

    e = (-r' c' + s sqrt(Q) R) / |c'|^2,    Q = |c'|^2 - r'^2,    R = (c'_y, -c'_x),    s = +1 right, -1 left side

      p right         An error of the axis of size eps moves p by eps along its normal; that of its derivative turns e,
       \  e           which moves p along the boundary only. So p is as far from the boundary as the axis and the radius
        c --> c'      are from theirs, whatever sqrt(Q) does.

So e is c' turned by psi = atan2(sqrt(Q), -r'), to the right or to the left, and its angle changes at the rate

    w = (c' x c'') / |c'|^2 - s psi',   psi' = (sqrt(Q) r'' - r' Q' / (2 sqrt(Q))) / (r'^2 + Q),   p' = c' + r' e + w r J e

with J: turned left by 90 degrees.

At a centre of curvature Q = 0: both sides start in one point and p moves like sqrt(t). There, Q = t Qhat is divided by t
in its Bernstein form, and t = v^2 makes everything smooth again. What errors of the axis leave of Q there is dropped; as Q
then only turns e, p stays on its disc.

The formulas are those of R. T. Farouki and J. K. Johnstone, "The bisector of a point and a plane parametric curve",
CAGD 11 (1994), and H. I. Choi, C. Y. Han, H. P. Moon, K. H. Roh, N.-S. Wee, "Medial axis transform and offset curves by
Minkowski Pythagorean hodograph curves", Computer-Aided Design 31 (1999), section 3.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.fitting import Fits, bernstein, fit
from mat_core.analysis.spans import cut_parts
from mat_core.axis import MedialAxis
from mat_core.topology.graph import CURVATURE_CENTER

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

POINTED = 1e-9  # 1 - r'^2 below this at an end is 0: a centre of curvature; of the slope of Q likewise
NOTHING = 10.0  # errors of its segment: a piece shorter than that has no direction to speak of, and so no sides
WANDER = 1e-7  # normalised: by which errors of r' may move p along the boundary, to and fro
DISCS = 9  # looked at along an item
PLAIN, FROM_START, FROM_END = 0, 1, 2  # how v runs along t


class Items(NamedTuple):
    """Stretches of the axis whose sides are fitted one by one, in order: piece (n,), t0, t1 (n,) on it, mode (n,)."""

    piece: Ints
    t0: Floats
    t1: Floats
    mode: Ints


class Ends(NamedTuple):
    """What both ends of an item tell: disc (n, 2, 3), direction of travel (n, 2, 2), angle of e from it (n, 2) in [0, pi]."""

    disc: Floats
    forward: Floats
    angle: Floats


class Envelope:
    """Both sides of all pieces of an axis, normalised.

    Attributes
    ----------
    items : Items
    ends : Ends
    right, left : Fits
        Sides of each item, both in the direction of t.
    """

    def __init__(self, axis: MedialAxis, tolerance: float) -> None:
        self.axis = axis
        self.degree, rows = cut_parts(axis)
        weight = rows[:, :, 3:]
        self.homogeneous = np.concatenate((rows[:, :, :3] * weight, weight), axis=2)
        self.rows = rows
        self.least = NOTHING * axis.curves.max_error[axis.curves.part_segment]
        self.items = self._cut()
        n = len(self.items.piece)
        both = np.repeat(np.arange(n), 2), np.tile([0.0, 1.0], n)
        x, d, _, root, _, _ = self._frames(*both)
        size = np.hypot(d[:, 0], d[:, 1])
        self.ends = Ends(x.reshape(n, 2, 3), (d[:, :2] / size[:, None]).reshape(n, 2, 2),
                         np.arctan2(root, -d[:, 2]).reshape(n, 2))
        self.right = self._fit(1.0, tolerance)
        self.left = self._fit(-1.0, tolerance)

    def discs(self, item: int) -> Floats:
        """Some discs (n, 3) along an item."""
        v = np.linspace(0.0, 1.0, DISCS)
        return self._frames(np.full(DISCS, item), v)[0]

    def headings(self, item: int, v: Floats, side: float) -> Floats:
        """Where the boundary goes on one side, in the direction of t: unit vectors (n, 2) at v of an item."""
        _, d, _, root, _, _ = self._frames(np.full(len(v), item), v)
        e = _normals(d, root, side)
        return side * np.column_stack((-e[:, 1], e[:, 0]))

    def _fit(self, side: float, tolerance: float) -> Fits:
        return fit(lambda i, v: self._side(i, v, side)[0], lambda i, v: self._side(i, v, side)[1],
                   len(self.items.piece), tolerance, noise=WANDER)

    def _cut(self) -> Items:
        """Pieces as they are, but for those that start or end at a centre of curvature: their halves."""
        q = self._minkowski()
        rows = self.rows
        span = np.hypot(rows[:, -1, 0] - rows[:, 0, 0], rows[:, -1, 1] - rows[:, 0, 1])
        items: list[tuple[int, float, float, int]] = []
        centres = self._centres()
        nested = self._nested(span - np.abs(rows[:, -1, 2] - rows[:, 0, 2]))
        for p, n in enumerate(self.degree.tolist()):
            if nested[p] or (not span[p] > self.least[p] and not self._bulges(p)):
                continue
            leg = (n * (rows[p, 1, :2] - rows[p, 0, :2]), n * (rows[p, n, :2] - rows[p, n - 1, :2]))
            free = bool((rows[p, :, 3] == 1.0).all())
            start, end = (free and (p, k) in centres and _pointed(q[p][::way], float((leg[k] ** 2).sum()))
                          for k, way in ((0, 1), (1, -1)))
            if start and end:
                items += [(p, 0.0, 0.5, FROM_START), (p, 0.5, 1.0, FROM_END)]
            else:
                items.append((p, 0.0, 1.0, FROM_START if start else (FROM_END if end else PLAIN)))
        columns = list(zip(*items, strict=True)) or [(), (), (), ()]
        return Items(np.array(columns[0], dtype=np.int64), np.array(columns[1], dtype=float),
                     np.array(columns[2], dtype=float), np.array(columns[3], dtype=np.int64))

    def _centres(self) -> set[tuple[int, int]]:
        """(piece, 0 at its start or 1 at its end) at centres of curvature: a flat corner, also, has a Q of nearly 0."""
        curves, runs = self.axis.curves, self.axis.runs
        found = set()
        for nodes, pieces, end in ((runs.start_node, curves.part_start[:-1], 0), (runs.end_node, curves.part_start[1:] - 1, 1)):
            ended = nodes >= 0  # a closed segment has no end
            found |= {(int(p), end) for p in pieces[ended][runs.node_kind[nodes[ended]] == CURVATURE_CENTER]}
        return found

    def _nested(self, beyond: Floats) -> Flags:
        """Pieces beside a centre of curvature whose discs lie inside the one that the first of them starts with, but for errors.

        An arc of that disc stands for their sides, whose directions are lost where r' is nearly 1. `beyond`: by how much the disc
        at one end of each piece reaches out of that at the other one.
        """
        curves, runs = self.axis.curves, self.axis.runs
        skipped: Flags = np.zeros(len(beyond), dtype=np.bool_)
        for g, error in enumerate(curves.max_error.tolist()):
            own = list(range(int(curves.part_start[g]), int(curves.part_start[g + 1])))
            for node, inward in ((runs.start_node[g], own), (runs.end_node[g], own[::-1])):
                if node < 0 or runs.node_kind[node] != CURVATURE_CENTER:
                    continue
                reach = np.cumsum(beyond[inward[:-1]])
                skipped[inward[: int(np.searchsorted(reach, error))]] = True
        return skipped

    def _bulges(self, p: int) -> bool:
        """Whether a piece whose ends coincide goes somewhere, nevertheless."""
        return bool(np.abs(self.rows[p, :, :2] - self.rows[p, 0, :2]).max() > self.least[p])

    def _minkowski(self) -> list[Floats]:
        """Bernstein coefficients of Q for every polynomial piece (of the control polygon for rational ones)."""
        out = []
        for p, n in enumerate(self.degree.tolist()):
            d = n * np.diff(self.rows[p, : n + 1, :3], axis=0)
            m = n - 1
            binomial = np.array([math.comb(m, i) for i in range(m + 1)], dtype=float)
            scaled = d * binomial[:, None]
            product = sum(sign * np.convolve(scaled[:, c], scaled[:, c]) for c, sign in ((0, 1.0), (1, 1.0), (2, -1.0)))
            out.append(product / np.array([math.comb(2 * m, i) for i in range(2 * m + 1)]))
        self.q = out
        return out

    def _frames(self, item: Ints, v: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
        """(X, dX, d2X by t; sqrt(Q); sqrt(Q) / (dt/dv); dQ/dt) at v of items; the fifth is finite at a centre of curvature."""
        mode = self.items.mode[item]
        width = (self.items.t1 - self.items.t0)[item]
        # the share of the item that lies behind, from a centre of curvature as a square
        ahead = np.where(mode == FROM_END, 1.0 - v, v)
        square = np.where(mode == PLAIN, v, np.where(mode == FROM_END, 1.0 - ahead**2, ahead**2))
        t = self.items.t0[item] + width * square
        piece = self.items.piece[item]
        x, d, dd = self._evaluate(piece, t)
        root = np.sqrt(np.maximum(d[:, 0] ** 2 + d[:, 1] ** 2 - d[:, 2] ** 2, 0.0))
        rise = 2.0 * (d[:, 0] * dd[:, 0] + d[:, 1] * dd[:, 1] - d[:, 2] * dd[:, 2])
        ratio = root / width
        for n in np.flatnonzero(mode != PLAIN).tolist():
            # sqrt(Q) = sqrt(t) sqrt(Qhat), t = width v^2, dt/dv = 2 v width
            hat, rise[n] = self._divided(int(piece[n]), float(t[n]), bool(mode[n] == FROM_END))
            root[n] = ahead[n] * math.sqrt(width[n] * hat)
            ratio[n] = math.sqrt(hat / width[n]) / 2.0
        return x, d, dd, root, ratio, rise

    def _divided(self, piece: int, t: float, from_end: bool) -> tuple[float, float]:
        """Q over the distance of t from the end where Q is 0, sum over j of B_j(t) m / (j + 1) q_(j+1), m = 2 (n - 1); dQ/dt."""
        q = self.q[piece][::-1] if from_end else self.q[piece]
        m = len(q) - 1
        basis = bernstein(m - 1, np.array([1.0 - t if from_end else t]))[0]
        rise = m * float(basis @ np.diff(np.concatenate(([0.0], q[1:]))))
        return max(float(basis @ (q[1:] * m / np.arange(1, m + 1))), 0.0), -rise if from_end else rise

    def _evaluate(self, piece: Ints, t: Floats) -> tuple[Floats, Floats, Floats]:
        """X = (x, y, r) and two derivatives at t of pieces."""
        x, d, dd = np.empty((len(t), 3)), np.empty((len(t), 3)), np.empty((len(t), 3))
        for n in np.unique(self.degree[piece]).tolist():
            own = np.flatnonzero(self.degree[piece] == n)
            h = self.homogeneous[piece[own], : n + 1]
            a = np.einsum("nk,nkc->nc", bernstein(n, t[own]), h)
            b = n * np.einsum("nk,nkc->nc", bernstein(n - 1, t[own]), np.diff(h, axis=1))
            c = np.zeros_like(a)
            if n > 1:
                c = n * (n - 1) * np.einsum("nk,nkc->nc", bernstein(n - 2, t[own]), np.diff(h, 2, axis=1))
            w, w1, w2 = a[:, 3:], b[:, 3:], c[:, 3:]
            x[own] = a[:, :3] / w
            d[own] = (b[:, :3] - x[own] * w1) / w
            dd[own] = (c[:, :3] - 2.0 * d[own] * w1 - x[own] * w2) / w
        return x, d, dd

    def _side(self, item: Ints, v: Floats, side: float) -> tuple[Floats, Floats]:
        """p and dp/dv on one side."""
        x, d, dd, root, ratio, rise = self._frames(item, v)
        e = _normals(d, root, side)
        mode = self.items.mode[item]
        ahead = np.where(mode == FROM_END, 1.0 - v, v)
        width = (self.items.t1 - self.items.t0)[item]
        rate = np.where(mode == PLAIN, width, 2.0 * ahead * width)
        speed_sq = d[:, 0] ** 2 + d[:, 1] ** 2
        # sides that part like t, not like sqrt(t), do not move with v^2 at first
        opening = np.divide(0.5 * rise, ratio, out=np.zeros_like(rise), where=ratio > 0.0)
        psi = (root * dd[:, 2] * rate - d[:, 2] * opening) / (d[:, 2] ** 2 + root**2)
        turn = (d[:, 0] * dd[:, 1] - d[:, 1] * dd[:, 0]) / speed_sq * rate - side * psi
        along = (d[:, :2] + d[:, 2:] * e) * rate[:, None] + (turn * x[:, 2])[:, None] * np.column_stack((-e[:, 1], e[:, 0]))
        return x[:, :2] + x[:, 2:] * e, along


def _normals(d: Floats, root: Floats, side: float) -> Floats:
    """e on one side."""
    right = np.column_stack((d[:, 1], -d[:, 0]))
    speed = np.hypot(d[:, 0], d[:, 1]) * np.hypot(d[:, 2], root)  # |c'|^2, but for what is dropped of Q
    e: Floats = (-d[:, 2:] * d[:, :2] + (side * root)[:, None] * right) / speed[:, None]
    return e


def _pointed(q: Floats, speed_sq: float) -> bool:
    """Whether Q is 0 at the start of its coefficients; a first slope that is 0 but for rounding is put to 0."""
    if len(q) < 3 or q[0] > POINTED * speed_sq:
        return False
    if q[1] <= POINTED * speed_sq:
        q[1] = 0.0
    return True
