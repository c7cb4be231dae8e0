"""The nearest point of the axis for many points at once, for certain and to the last digits.

Steps: 1. the nearest box in a tree of the spans' boxes gives each point an upper bound; 2. all spans whose boxes are nearer than
that are looked at; 3. on each the squared distance

    |X(s) - q|^2 = |g|^2 + S(s) / V(s),   g = X(0) - q,   S = |E|^2 + 2 W g.E,   E = W (X - X(0)),   V = W^2

is a quotient of Bernstein polynomials, no less than |g|^2 + min S_i / V_i: spans that cannot win are dropped, the others halved
a few times; 4. what is left is searched for all places where S' V - S V' changes sign, and its ends. Taken from the span's own
start, S keeps its digits however short the span is and however far the point.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from mat_core.analysis.arguments import LARGEST
from mat_core.analysis.bernstein import derivative, halve, product, sign_changes
from mat_core.analysis.places import AxisDisc, disc_at_node, discs_inside
from mat_core.analysis.spans import Spans, cut_spans
from mat_core.axis import MedialAxis
from mat_core.errors import UnsupportedOption
from mat_core.model.containment import inside_domain

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

BATCH = 2048  # points looked at together
PAIRS = 100_000  # of a point and a span looked at together; bounds the memory where many spans are equally far
HALVINGS = 3  # of spans before their sign changes are isolated: fewer isolate more, more isolate shorter ones
SLACK = 1e-14  # normalised: what rounding may take from a bound


@dataclass(frozen=True, slots=True)
class Nearest:
    """The nearest places of the axis to n points.

    Attributes
    ----------
    axis : MedialAxis
        Which axis.
    points : (n, 2) float64
        As asked.
    segment, t : (n,) int64, (n,) float64
        Where on the axis; the axis of a disc is a node, there segment is -1 and t is 0.
    node : (n,) int64
        Id of the node where the place is one, else -1.
    distance : (n,) float64
        From the point to the place, in the caller's unit.
    centers : (n, 2) float64
        The place, centre of a maximal disc.
    radii : (n,) float64
        Its radius.
    inside : (n,) bool
        Whether the point lies in the domain. Points outside have a nearest place as well; on the boundary either may be said.
    """

    axis: MedialAxis
    points: Floats
    segment: Ints
    t: Floats
    node: Ints
    distance: Floats
    centers: Floats
    radii: Floats
    inside: Flags

    def disc(self, i: int) -> AxisDisc:
        """The true maximal disc at the i-th place, with its footpoints."""
        if self.node[i] >= 0:
            return disc_at_node(self.axis, int(self.node[i]))
        return discs_inside(self.axis, self.segment[i : i + 1], self.t[i : i + 1])[0]

    def to_dict(self) -> dict[str, Any]:
        """Plain lists and numbers, one entry a point; no segment is None."""
        return {
            "segment": [g if g >= 0 else None for g in self.segment.tolist()],
            "t": self.t.tolist(),
            "node": [n if n >= 0 else None for n in self.node.tolist()],
            "distance": self.distance.tolist(),
            "points": self.centers.tolist(),
            "radii": self.radii.tolist(),
            "inside": self.inside.tolist(),
        }


class _Pieces(NamedTuple):
    """Spans or halves of them, each with the query it is a candidate for; normalised.

    query, span (k,); s (k,) and width (k,): where on the span; offset (k, n + 1, 3): Bezier rows of E (x, y) and W;
    gap (k, 2): g, from the query to X(0).
    """

    query: Ints
    span: Ints
    s: Floats
    width: Floats
    offset: Floats
    gap: Floats

    def take(self, rows: NDArray[Any]) -> _Pieces:
        """Some of them."""
        return _Pieces(*(column[rows] for column in self))


def nearest(axis: MedialAxis, points: ArrayLike) -> Nearest:
    """The nearest point of the axis, and the maximal disc there, for each of many points.

    Parameters
    ----------
    axis : MedialAxis
    points : (n, 2) or (2,) array_like
        Anywhere, in the caller's unit; also outside of the domain.

    Returns
    -------
    Nearest
        The global minimum of the distance to the axis' curves; distances to 1e-14 of the domain's size (or of the distance,
        for points far away). The true axis is within `Segment.max_error` of the curves.

    Raises
    ------
    UnsupportedOption
        `points` has another shape, or a coordinate is no number of at most 1e100.
    """
    asked = _points(points)
    n = len(asked)
    segment, t, node = np.full(n, -1), np.zeros(n), np.full(n, -1)
    if not len(axis.curves.degree):
        node[:] = 0
        discs = np.repeat(axis.node_discs[:1], n, axis=0)
    else:
        spans = cut_spans(axis)
        low, high = _boxes(spans)
        tree = shapely.STRtree(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))
        local = (asked - axis.table.origin) * axis.table.scale
        for first in range(0, n, BATCH):
            rows = slice(first, first + BATCH)
            segment[rows], t[rows] = _search(axis, spans, tree, local[rows])
        discs = axis.evaluate(segment, t)[:, :3]
        node = np.where(t == 0.0, axis.runs.start_node[segment], np.where(t == 1.0, axis.runs.end_node[segment], -1))
    apart = discs[:, :2] - asked
    distance = np.hypot(apart[:, 0], apart[:, 1])
    return Nearest(axis, asked, segment, t, node, distance, discs[:, :2], discs[:, 2], inside_domain(axis.domain, asked))


def _points(points: ArrayLike) -> Floats:
    """(n, 2) points, if they are such."""
    try:
        asked = np.asarray(points, dtype=float)
    except (ValueError, TypeError, OverflowError) as error:
        raise UnsupportedOption("points", f"not numbers, (n, 2) or (2,): {error}") from error
    if asked.ndim == 1:
        asked = asked[None]
    if asked.ndim != 2 or asked.shape[1] != 2 or not (np.abs(asked) <= LARGEST).all():
        raise UnsupportedOption(
            "points", f"an array of shape {asked.shape} is not one of numbers up to {LARGEST:g}, (n, 2) or (2,)"
        )
    return asked


def _boxes(spans: Spans) -> tuple[Floats, Floats]:
    """Lower and upper corners (S, 2) of boxes around the spans' centres: of their Bezier points, as weights are positive."""
    places = spans.rows[:, :, :2] / spans.rows[:, :, 3:]
    return places.min(axis=1), places.max(axis=1)


def _search(axis: MedialAxis, spans: Spans, tree: shapely.STRtree, q: Floats) -> tuple[Ints, Floats]:
    """(segment, t) of the nearest place to each query, normalised (m, 2)."""
    dots = shapely.points(q)
    # 1. and 2.
    close = spans.rows[tree.nearest(dots)]
    ends = close[:, [0, -1], :2] / close[:, [0, -1], 3:] - q[:, None]
    bound = np.hypot(ends[..., 0], ends[..., 1]).min(axis=1)
    query, span = tree.query(dots, predicate="dwithin", distance=bound * (1.0 + SLACK) + SLACK)
    if len(query) > PAIRS and len(q) > 1:
        half = len(q) // 2
        parts = [_search(axis, spans, tree, q[:half]), _search(axis, spans, tree, q[half:])]
        return np.concatenate([g for g, _ in parts]), np.concatenate([t for _, t in parts])
    rows = spans.rows[span]
    start = rows[:, :1, :2] / rows[:, :1, 3:]
    offset = np.concatenate((rows[:, :, :2] - start * rows[:, :, 3:], rows[:, :, 3:]), axis=2)
    pieces = _Pieces(query, span, np.zeros(len(span)), np.ones(len(span)), offset, start[:, 0] - q[query])
    # 3.
    square = np.square(bound)
    for step in range(HALVINGS + 1):
        pieces, square = _drop(pieces, square)
        if step < HALVINGS:
            pieces = _halved(pieces)
    # 4.
    row, s = _stationary(pieces)
    everything = np.arange(len(pieces.query))
    row = np.concatenate((everything, everything, row))
    s = np.concatenate((np.zeros(len(everything)), np.ones(len(everything)), s))
    place = pieces.s[row] + s * pieces.width[row]
    span = pieces.span[row]
    t0, t1 = spans.t[span, 0], spans.t[span, 1]
    t = np.where(place >= 1.0, t1, t0 + place * (t1 - t0))
    segment = spans.segment[span]
    found = (axis.evaluate(segment, t)[:, :2] - axis.table.origin) * axis.table.scale - q[pieces.query[row]]
    order = np.lexsort((t, segment, np.hypot(found[:, 0], found[:, 1]), pieces.query[row]))
    best = order[np.searchsorted(pieces.query[row][order], np.arange(len(q)))]
    return segment[best], t[best]


def _distance_rows(p: _Pieces) -> tuple[Floats, Floats]:
    """Bernstein rows of S and V."""
    x, y, w = p.offset[..., 0], p.offset[..., 1], p.offset[..., 2]
    along = p.gap[:, :1] * x + p.gap[:, 1:] * y
    return product(x, x) + product(y, y) + 2.0 * product(along, w), product(w, w)


def _drop(p: _Pieces, square: Floats) -> tuple[_Pieces, Floats]:
    """Lower the squared bounds (m,) of the queries to what the pieces' ends reach; drop pieces that stay above them."""
    above, weight = _distance_rows(p)
    base = np.square(p.gap).sum(axis=1)
    end = p.gap + p.offset[:, -1, :2] / p.offset[:, -1, 2:]  # not from S, which is less exact near a query
    square = square.copy()
    np.minimum.at(square, p.query, base)
    np.minimum.at(square, p.query, np.square(end).sum(axis=1))
    limit = square[p.query]
    change = above / weight
    rounding = SLACK * (base + np.abs(change).max(axis=1, initial=0.0) + limit)
    return p.take(base + change.min(axis=1, initial=np.inf) <= limit + rounding), square


def _halved(p: _Pieces) -> _Pieces:
    """Both halves of every piece; the right one is taken from its own start."""
    left, right = halve(p.offset)
    start = right[:, :1, :2] / right[:, :1, 2:]
    moved = np.concatenate((right[..., :2] - start * right[..., 2:], right[..., 2:]), axis=2)
    half = 0.5 * p.width
    return _Pieces(
        np.tile(p.query, 2), np.tile(p.span, 2), np.concatenate((p.s, p.s + half)), np.tile(half, 2),
        np.concatenate((left, moved)), np.concatenate((p.gap, p.gap + start[:, 0])))


def _stationary(p: _Pieces) -> tuple[Ints, Floats]:
    """(row, s) where the distance turns: sign changes of S' V - S V', on polynomial spans of S'."""
    found = []
    even = (p.offset[..., 2] == p.offset[:, :1, 2]).all(axis=1)
    for rows in (np.nonzero(even)[0], np.nonzero(~even)[0]):
        above, weight = _distance_rows(p.take(rows))
        slope = derivative(above)
        if len(rows) and not even[rows[0]]:
            slope = product(slope, weight) - product(above, derivative(weight))
        row, s = sign_changes(slope)
        found.append((rows[row], s))
    return np.concatenate([r for r, _ in found]), np.concatenate([s for _, s in found])
