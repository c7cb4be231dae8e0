r"""Bounds of how far fitted curves are from the true axis, proved up to rounding.

F = (c, r)(v) is a polynomial of a segment between two sides; g_1 and g_2 are the distances from these, e_i = g_i(c) - r, and
n_i their gradients, the unit normals at the feet. With what `sides` tells of e_i, and

    S = |n_1 - n_2| / 2,  the sine of half the angle between the normals,   t0 = |e_1 - e_2| / (2 S).

C is the cosine of that angle, a = |e_1 + e_2| / 2, and B bounds the second derivatives of g_1 and g_2 together. From c the radius
is changed along n_1 + n_2, at the rate C, and g_1 - g_2 along u = (n_1 - n_2) / |n_1 - n_2|, at the rate 2 S. Go by up to l along
the one, so that r is met or nearer by C l; then along the other to where g_1 = g_2: with

    D = max(t0, l),   k = 0.61 B D / S <= 1/5,   that is within t0 + k D <= 1.2 D,   for   (l^2 + (1.2 D)^2) B / 4 S <= k D.

There a true axis point stands. For every v and any l

    |F - true axis|  <=  hypot(t0 + k D, l) + max(0, a - C l) + 0.61 B D^2        in the norm |(x, y)| + |r|,

which is least about where l = min(a / C, t0 C / S).

All are quotients of polynomials but for what `sides` bounds, and enclosed on cells of [0, 1] by their Bernstein coefficients.
At a centre of curvature, where S ~ v, the powers of v in e ~ v^4, S ~ v, B ~ 1 / v^2 leave bounds of the same form: `sides`
has divided them out, and v^3 is at most one.

B is twice what the second derivatives are at c: that they do not double on this way is the one thing here that is not
enclosed; k says that D is a sixth of S times their radius of curvature at most. Which sides a disc touches is not asked here
but by the certificate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.bernstein import product, restrict
from mat_core.analysis.proving.polynomials import cells, compose, over_power, total, wide
from mat_core.analysis.proving.sides import LEAF, PLAIN, VERTEX, Side, side_of
from mat_core.analysis.spans import cut_parts
from mat_core.axis import MedialAxis
from mat_core.curves.conics import K_FREEFORM
from mat_core.kernels.layout import CURVATURE_LEAF

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CUTS = 4  # cells of each half of a part
HALVINGS = 4  # of a cell that proves less than is stated: enclosures are tighter by a quarter to a half after each
SMALLEST = 1e-13  # normalised: a radius this small is none, a disc this near to another is it
LARGEST_BEND = 0.2  # k above
SECOND = 0.61  # (1 + 1.2^2) / 4 above


@dataclass(frozen=True, eq=False)
class ProvenErrors:
    """What was proved of the fitted parts of an axis; lengths in the caller's unit.

    Attributes
    ----------
    segment : (P,) int64
        Whose parts they are: those between a free curve and another side, in order.
    bound : (P,) float64
        Proved for each; infinite where nothing was.
    stated : (P,) float64
        `max_error` of the segment.
    """

    segment: Ints
    bound: Floats
    stated: Floats

    @property
    def proved(self) -> NDArray[np.bool_]:
        """(P,) whether what is stated is proved."""
        return np.asarray(self.bound <= self.stated)

    def to_dict(self) -> dict[str, Any]:
        """Plain lists and numbers; None where nothing was proved."""
        bounds = [b if np.isfinite(b) else None for b in self.bound.tolist()]
        return {"segment": self.segment.tolist(), "bound": bounds, "stated": self.stated.tolist()}


def prove_errors(axis: MedialAxis) -> ProvenErrors:
    """Bounds of the distance of all fitted curves from the true axis, by enclosures of polynomials.

    It costs hundreds of times what solving does, and is meant for tests and for those who rely on `max_error`. Conics, which
    state what rounding left of them, are not among them.

    Parameters
    ----------
    axis : MedialAxis

    Returns
    -------
    ProvenErrors
    """
    c = axis.curves
    degree, rows = cut_parts(axis)
    part = np.flatnonzero(c.part_i[:, 3] == K_FREEFORM)
    segment = c.part_segment[part]
    stated = c.max_error[segment]
    bound = np.full(len(part), np.inf)
    for n in np.unique(degree[part]).tolist():
        own = np.flatnonzero(degree[part] == n)
        bound[own] = _whole(axis, c.part_i[part[own], 1], rows[part[own], : n + 1, :3], stated[own])
    scale = axis.table.scale
    return ProvenErrors(segment, bound / scale, stated / scale)


def _whole(axis: MedialAxis, strip: Ints, disc: Floats, stated: Floats) -> Floats:
    """(R,) bounds over parts with Bernstein coefficients x, y, r: both halves, each from its outer end inwards."""
    none = np.zeros(len(strip))
    first, second = restrict(disc, none, none + 0.5), restrict(disc, none + 0.5, none + 1.0)[:, ::-1]
    return np.maximum(_half(axis, strip, first, stated), _half(axis, strip, second, stated))


def _half(axis: MedialAxis, strip: Ints, disc: Floats, stated: Floats) -> Floats:
    """(R,) bounds over halves of parts that begin (v = 0) where the part ends."""
    k = axis.skeleton
    kind = np.full(len(strip), PLAIN)
    kind[disc[:, 0, 2] <= SMALLEST] = VERTEX
    for end in (2, 3):
        own = k.strip_i[strip, end]
        there = np.abs(k.disc[own] - disc[:, 0]).max(axis=1) <= SMALLEST
        kind[there & (k.disc_kind[own] == CURVATURE_LEAF)] = LEAF
    bound = np.zeros(len(strip))
    for one in np.unique(kind).tolist():
        rows = np.flatnonzero(kind == one)
        curve = disc[rows]
        if one == LEAF:
            squared = np.tile([0.0, 0.0, 1.0], (len(rows), 1))  # v^2
            curve = np.stack([compose(wide(curve[:, :, i]), squared) for i in range(3)], axis=2)
        bound[rows] = _cut(axis, strip[rows], curve, one, stated[rows])
    return bound


def _cut(axis: MedialAxis, strip: Ints, curve: Floats, kind: int, stated: Floats) -> Floats:
    """(R,) bounds over 0 <= v <= 1 in cells: those that prove less than is stated are halved."""
    bound = np.zeros(len(strip))
    row = np.repeat(np.arange(len(strip)), CUTS)
    low = np.tile(np.arange(CUTS) / CUTS, len(strip))
    known = np.full(len(row), np.inf)
    for halving in range(HALVINGS + 1):
        width = 0.5**halving / CUTS
        for first in (False, True):
            own = np.flatnonzero((low == 0.0) == first)
            if len(own):
                at = kind if first else PLAIN
                whole = curve[row[own]] if at == LEAF else curve[row[own]].astype(float)
                found = _bound(axis, strip[row[own]], restrict(whole, low[own], low[own] + width), at)
                known[own] = np.minimum(known[own], found)  # what holds for a cell holds for its halves
        more = (known > stated[row]) & (halving < HALVINGS)
        np.maximum.at(bound, row[~more], known[~more])
        row, known, low = np.tile(row[more], 2), np.tile(known[more], 2), np.concatenate((low[more], low[more] + 0.5 * width))
    return bound


def _bound(axis: MedialAxis, strip: Ints, disc: Floats, kind: int) -> Floats:
    """(R,) bounds over 0 <= v <= 1."""
    k = axis.skeleton
    right, left = (side_of(axis.table, k.strip_i[strip, i], k.strip_s[strip, 2 * i : 2 * i + 2], disc, kind) for i in range(2))
    return np.array([_of_pair(right, left, i, kind) for i in range(len(strip))])


def _of_pair(right: Side, left: Side, row: int, kind: int) -> float:
    """The bound where both sides of one polynomial are known: the largest over cells of [0, 1]."""
    if not np.isfinite(right.miss[row] + left.miss[row]):
        return np.inf
    (ax, ay, am, ao, au), (bx, by, bm, bo, bu) = (
        (s.x[row][None], s.y[row][None], s.m[row][None], s.off[row][None], s.over[row][None]) for s in (right, left)
    )
    apart, together = (
        [total(product(a, bm), product(b, am), sign) for a, b in ((ax, bx), (ay, by))] for sign in (-1.0, 1.0)
    )
    if kind == LEAF:
        both = [over_power(p, 1) for p in apart]
        if not all(bool(fits[0]) for _, fits in both):
            return np.inf
        apart = [p for p, _ in both]
    most = np.abs(cells(product(am, bm))[0]).max(axis=1)
    astray = 0.5 * float(right.astray[row] + left.astray[row])
    sine, cosine = (0.5 * _least_length(p) / most - astray for p in (apart, together))
    over = cells(product(au, bu))[0].min(axis=1)
    if not (sine > 0.0).all() or not (over > 0.0).all():
        return np.inf
    slack = float(right.slack[row] + left.slack[row])
    cross = product(ao, bu), product(bo, au)
    difference, mean = (
        np.abs(cells(total(*cross, sign))[0]).max(axis=1) / over + slack for sign in (-1.0, 1.0)
    )
    bend = 2.0 * float(right.bend[row] + left.bend[row])
    moved, off = difference / (2.0 * sine), 0.5 * mean
    cosine = np.maximum(cosine, 0.0)
    along = np.minimum(np.divide(off, cosine, out=np.zeros_like(off), where=cosine > 0.0), moved * cosine / sine)
    way = np.maximum(moved, along)
    lost = SECOND * bend * way / sine
    if not (lost <= LARGEST_BEND).all():
        return np.inf
    return float((np.hypot(moved + lost * way, along) + np.maximum(off - cosine * along, 0.0) + SECOND * bend * way * way).max())


def _least_length(vector: list[Floats]) -> Floats:
    """(cells,) bounds from below of the length of a vector of two polynomials, one row each."""
    square = product(vector[0], vector[0]) + product(vector[1], vector[1])
    return np.asarray(np.sqrt(np.maximum(cells(square)[0].min(axis=1), 0.0)))
