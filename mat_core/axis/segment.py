"""One segment of the axis, as people use it: a view of its rows in the flat arrays of a `MedialAxis`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mat_core.axis.lengths import curve_lengths
from mat_core.axis.records import Footpoint, Samples
from mat_core.model.curve import RationalBSpline

if TYPE_CHECKING:
    from mat_core.axis import MedialAxis

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SEGMENT_KINDS = ("line", "parabola", "hyperbola", "ellipse", "freeform")
STALLED = 1e-7  # of a segment's length: a speed below gives no direction, the normals at the footpoints do
LENGTH_STEPS = 60  # of the search for the parameter at a length; Newton's method ends it after a handful


@dataclass(frozen=True, repr=False, eq=False)
class Segment:
    """One curve of the axis between two nodes, with its radius: a rational B-spline in (x, y, r) over t in [0, 1].

    Attributes
    ----------
    axis : MedialAxis
        Where it belongs.
    id : int
        Its index in `MedialAxis.segments`.
    """

    axis: MedialAxis
    id: int

    def _node(self, ends: Ints) -> int | None:
        node = int(ends[self.id])
        return node if node >= 0 else None

    @property
    def start_node(self) -> int | None:
        """Id of the node at t = 0; None for a closed segment without a node."""
        return self._node(self.axis.runs.start_node)

    @property
    def end_node(self) -> int | None:
        """Id of the node at t = 1; None for a closed segment without a node."""
        return self._node(self.axis.runs.end_node)

    @property
    def kind(self) -> str:
        """``line``, ``parabola``, ``hyperbola`` or ``ellipse`` when all of it is exactly that, else ``freeform``."""
        return SEGMENT_KINDS[self.axis.curves.kind[self.id]]

    @property
    def degree(self) -> int:
        """Degree of the spline."""
        return int(self.axis.curves.degree[self.id])

    @property
    def knots(self) -> Floats:
        """Clamped knots from 0 to 1, (n + degree + 1,)."""
        c = self.axis.curves
        return c.knots[c.knot_start[self.id] : c.knot_start[self.id + 1]]

    @property
    def _rows(self) -> slice:
        c = self.axis.curves
        return slice(int(c.cp_start[self.id]), int(c.cp_start[self.id + 1]))

    @property
    def control_points(self) -> Floats:
        """(n, 2) points x, y."""
        return self.axis.control_discs[self._rows, :2]

    @property
    def control_values(self) -> Floats:
        """(n,) radii at the control points."""
        return self.axis.control_discs[self._rows, 2]

    @property
    def weights(self) -> Floats:
        """(n,) weights, all 1 on a polynomial curve."""
        return self.axis.curves.cp[self._rows, 3]

    @property
    def curve(self) -> RationalBSpline:
        """The curve of centres by itself, without the radius."""
        return RationalBSpline(self.degree, self.knots, self.control_points, self.weights)

    @property
    def max_error(self) -> float:
        """Bound of the curve's error, in the caller's unit: of what |(x, y)| and |r| are off the true axis, added.

        Neither the distance of a disc (x, y, r) of the curve from the nearest true one, nor the difference between r and the
        distance of (x, y) to the boundary is larger. Fitted curves: the remainder of the interpolation, from values at
        Chebyshev points and from how fast its corrections fall (`mat_core.curves.interval` derives it and says what is assumed),
        and 1e-13 of the size for the rounding of axis points. Exact ones: what rounding left, measured. Either: two roundings
        of the largest coordinate the caller uses; a tolerance below that is not kept, and the figure here says so.
        """
        return float(self.axis.curves.max_error[self.id] / self.axis.table.scale)

    @property
    def pieces(self) -> tuple[tuple[float, float, str], ...]:
        """(t0, t1, kind) of every piece between the same two sides; one polynomial may go through several (see `knots`)."""
        c = self.axis.curves
        rows = range(int(c.part_start[self.id]), int(c.part_start[self.id + 1]))
        return tuple((float(c.part_f[p, 0]), float(c.part_f[p, 1]), SEGMENT_KINDS[c.part_i[p, 3]]) for p in rows)

    def evaluate(self, t: ArrayLike, derivative: bool = False) -> Floats:
        """Centres and radii of discs.

        Parameters
        ----------
        t : array_like
            Parameters in [0, 1]; those outside are moved to the nearer end.
        derivative : bool
            Give the derivatives by t instead.

        Returns
        -------
        ndarray
            (n, 3) rows x, y, r; (3,) for a single t.
        """
        at = np.asarray(t, dtype=float)
        flat = self.axis.evaluate(np.full(at.size, self.id), at.reshape(-1))
        out = flat[:, 3:] if derivative else flat[:, :3]
        return out.reshape(*at.shape, 3)

    def samples(self, t: ArrayLike) -> Samples:
        """True axis points beside the curve's points at t, with both footpoints.

        Parameters
        ----------
        t : array_like
            (n,) parameters in [0, 1].

        Returns
        -------
        Samples
        """
        at = np.atleast_1d(np.asarray(t, dtype=float))
        return self.axis.sample(np.full(at.size, self.id), at)

    def footpoints(self, t: float) -> tuple[Footpoint, Footpoint]:
        """Left and right footpoint, as seen in the direction of increasing t, of the disc at t in [0, 1]."""
        s = self.samples(t)
        return (
            self.axis.footpoint(int(s.left_site[0]), s.left_u[0], s.left[0], s.left_angle[0]),
            self.axis.footpoint(int(s.right_site[0]), s.right_u[0], s.right[0], s.right_angle[0]),
        )

    @property
    def length(self) -> float:
        """Length of the curve of centres."""
        return float(self.axis.lengths[self.id])

    def tangent(self, t: ArrayLike) -> Floats:
        """Unit tangents of the curve of centres, in the direction of increasing t.

        Parameters
        ----------
        t : array_like
            Parameters in [0, 1]; at an inner knot the piece that begins there answers.

        Returns
        -------
        ndarray
            (n, 2); (2,) for a single t.
        """
        at = np.asarray(t, dtype=float)
        return self._direction(at.reshape(-1))[:, :2].reshape(*at.shape, 2)

    def dr_ds(self, t: ArrayLike) -> Floats:
        """Change of the radius by the length of the curve of centres, in [-1, 1].

        It is the cosine of half the angle under which the centre sees the two footpoints, ahead of it: 0 between parallel
        sides, +-1 at a centre of curvature.

        Parameters
        ----------
        t : array_like
            Parameters in [0, 1].

        Returns
        -------
        ndarray
            (n,); a scalar array for a single t.
        """
        at = np.asarray(t, dtype=float)
        out: Floats = self._direction(at.reshape(-1))[:, 2].reshape(at.shape)
        return out

    def _direction(self, t: Floats) -> Floats:
        """(n, 3) unit tangents and dr/ds.

        With the normals n1, n2 at the right and the left footpoint the axis goes along n1 - n2 turned by -90 degrees, T, and
        dr/ds = T . n1. That needs no speed; where both normals are one, at a centre of curvature, the axis follows it.
        """
        d = self.evaluate(t, derivative=True)
        speed = np.hypot(d[:, 0], d[:, 1])
        still = np.nonzero(speed <= STALLED * self.length)[0]
        speed[still] = 1.0
        out: Floats = d / speed[:, None]
        if len(still):
            s = self.samples(t[still])
            right, left = (np.column_stack((np.cos(a), np.sin(a))) for a in (s.right_angle, s.left_angle))
            across = right - left
            apart = np.hypot(across[:, 0], across[:, 1]) > STALLED
            ahead = np.where(t[still] < 0.5, 1.0, -1.0)[:, None] * right
            along = np.where(apart[:, None], np.column_stack((across[:, 1], -across[:, 0])), ahead)
            along /= np.hypot(along[:, 0], along[:, 1])[:, None]
            out[still, :2] = along
            out[still, 2] = (along * right).sum(axis=1)
        out[:, 2] = np.clip(out[:, 2], -1.0, 1.0)
        return out

    def arc_length(self, t0: float = 0.0, t1: float = 1.0) -> float:
        """Length of the curve of centres from t0 to t1, negative if t1 < t0."""
        low, high = np.clip([min(t0, t1), max(t0, t1)], 0.0, 1.0).tolist()
        ends = np.unique([low, high, *(p[0] for p in self.pieces if low < p[0] < high)])
        total = float(self._lengths(ends[:-1], ends[1:]).sum())
        return total if t0 <= t1 else -total

    def parameter_at(self, length: ArrayLike) -> Floats:
        """The inverse of `arc_length(0, t)`.

        Parameters
        ----------
        length : array_like
            In the caller's unit; below 0 gives 0, above `length` gives 1.

        Returns
        -------
        ndarray
            t in [0, 1], the shape of `length`.
        """
        wanted = np.asarray(length, dtype=float)
        begins = np.array([p[0] for p in self.pieces])
        ends = np.array([p[1] for p in self.pieces])
        reached = np.concatenate(([0.0], np.cumsum(self._lengths(begins, ends))))
        goal = np.clip(wanted.reshape(-1), 0.0, reached[-1])
        piece = np.clip(np.searchsorted(reached, goal, side="right") - 1, 0, len(begins) - 1)
        low, high = begins[piece], ends[piece]
        first = low.copy()
        rest = goal - reached[piece]
        t = low + (high - low) * rest / (reached[piece + 1] - reached[piece])
        for _ in range(LENGTH_STEPS):
            gap = self._lengths(first, t) - rest
            low, high = np.where(gap <= 0.0, t, low), np.where(gap >= 0.0, t, high)
            speed = np.hypot(*self.evaluate(t, derivative=True)[:, :2].T)
            step = t - gap / np.maximum(speed, STALLED * self.length)
            new = np.where((step > low) & (step < high), step, 0.5 * (low + high))
            if np.abs(new - t).max(initial=0.0) <= 1e-15:
                break
            t = new
        out: Floats = t.reshape(wanted.shape)
        return out

    def _lengths(self, t0: Floats, t1: Floats) -> Floats:
        """(n,) lengths from t0 to t1; assumes that each pair lies on one piece."""
        return curve_lengths(self.axis, np.full(len(t0), self.id), t0, t1)

    def __repr__(self) -> str:
        ends = "closed" if self.start_node is None else f"{self.start_node} -> {self.end_node}"
        return f"<Segment {self.id}: {ends}, {self.kind}, degree {self.degree}, {len(self.pieces)} pieces>"
