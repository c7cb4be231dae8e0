"""One edge of a boundary: a clamped rational B-spline in the plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mat_core.kernels.bezier import decompose, derivatives


@dataclass(frozen=True, eq=False)
class RationalBSpline:
    """A clamped rational B-spline curve, as handed in.

    Parameters
    ----------
    degree : int
        1 to 25.
    knots : (n + degree + 1,) float64
        Non-decreasing, first and last repeated degree + 1 times.
    control_points : (n, 2) float64
        In the caller's unit.
    weights : (n,) float64
        Positive.

    Notes
    -----
    Assumes, does not check, that the parts fit together: `Domain.from_dict` is the gate that checks.
    """

    degree: int
    knots: NDArray[np.float64]
    control_points: NDArray[np.float64]
    weights: NDArray[np.float64]

    @property
    def domain(self) -> tuple[float, float]:
        """First and last value of the parameter u."""
        return float(self.knots[0]), float(self.knots[-1])

    @property
    def is_rational(self) -> bool:
        """Whether the weights differ."""
        return bool(np.any(self.weights != self.weights[0]))

    def evaluate(self, u: ArrayLike, derivative: int = 0) -> NDArray[np.float64]:
        """Points of the curve, or its first or second derivative by u.

        Parameters
        ----------
        u : array_like
            Parameters in `domain`; others are moved to the nearer end.
        derivative : {0, 1, 2}
            Which derivative. At an inner knot the piece to the right of it answers.

        Returns
        -------
        ndarray, shape of `u` + (2,)
            Coordinates in the caller's unit (per unit of u, per unit of u squared).

        Raises
        ------
        ValueError
            If `derivative` is not 0, 1 or 2.
        """
        if derivative not in (0, 1, 2):
            raise ValueError(f"derivative must be 0, 1 or 2, not {derivative!r}")
        rows, breaks = self.pieces()
        asked = np.asarray(u, dtype=np.float64)
        values = np.clip(asked, breaks[0], breaks[-1]).ravel()
        spans = np.clip(np.searchsorted(breaks, values, side="right") - 1, 0, len(breaks) - 2)
        out = np.empty((values.size, 2))
        degree = self.degree
        if degree == 1:
            rows, degree = elevated_lines(rows), 2
        for i, (value, k) in enumerate(zip(values.tolist(), spans.tolist(), strict=True)):
            width = float(breaks[k + 1] - breaks[k])
            first = k * (degree + 1)
            t = (value - breaks[k]) / width
            x, y = rows[first if t <= 0.5 else first + degree, :2].tolist()
            found = derivatives(rows, first, degree, t, x, y)
            out[i] = found[2 * derivative : 2 * derivative + 2]
            if derivative == 0:
                out[i] += (x, y)
            else:
                out[i] /= width**derivative
        return out.reshape((*asked.shape, 2))

    def pieces(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The Bezier pieces of the curve.

        Returns
        -------
        rows : (S * (degree + 1), 3) float64
            Control points x, y and weight of the S pieces, one after another.
        breaks : (S + 1,) float64
            Parameters at which the pieces begin and end.
        """
        n = len(self.control_points)
        cp = np.column_stack((self.control_points, self.weights))
        rows = np.empty(((n - self.degree) * (self.degree + 1), 3))
        breaks = np.empty(n - self.degree + 1)
        knots = np.ascontiguousarray(self.knots)  # those of a reversed curve are a view, which would be compiled for anew
        spans = decompose(self.degree, knots, 0, len(knots), cp, 0, n, rows, breaks)
        return rows[: spans * (self.degree + 1)], breaks[: spans + 1]

    def part(self, u0: float, u1: float) -> RationalBSpline:
        """The curve from u0 to u1, in the same parameter.

        Parameters
        ----------
        u0, u1 : float
            u0 < u1; what is outside of `domain` is left off.

        Returns
        -------
        RationalBSpline
            Of the same degree, each inner knot `degree` times.

        Raises
        ------
        ValueError
            If nothing of the curve lies between u0 and u1.
        """
        flat, breaks = self.pieces()
        u0, u1 = max(u0, float(breaks[0])), min(u1, float(breaks[-1]))
        if not u0 < u1:
            raise ValueError(f"nothing of a curve over {self.domain} lies between {u0} and {u1}")
        kept = np.nonzero((breaks[:-1] < u1) & (breaks[1:] > u0))[0]
        rows = flat.reshape(-1, self.degree + 1, 3)[kept]
        rows[..., :2] *= rows[..., 2:]
        begin, end = breaks[kept], breaks[kept + 1]
        rows[-1] = restricted(rows[-1], 0.0, (u1 - begin[-1]) / (end[-1] - begin[-1]))
        last = min(u1, float(end[0]))
        rows[0] = restricted(rows[0], (u0 - begin[0]) / (last - begin[0]), 1.0)
        chain = np.concatenate((rows[:, :-1].reshape(-1, 3), rows[-1:, -1]))
        knots = np.concatenate(([u0] * (self.degree + 1), np.repeat(begin[1:], self.degree), [u1] * (self.degree + 1)))
        return RationalBSpline(self.degree, knots, chain[:, :2] / chain[:, 2:], chain[:, 2].copy())

    def reversed(self) -> RationalBSpline:
        """The curve run through the other way, over the same range of u."""
        first, last = self.domain
        return RationalBSpline(self.degree, (first + last - self.knots)[::-1], self.control_points[::-1], self.weights[::-1])

    def to_dict(self) -> dict[str, object]:
        """The edge in the form `Domain.from_dict` reads; weights are left out when all are 1."""
        edge: dict[str, object] = {
            "degree": self.degree,
            "control_points": self.control_points.tolist(),
            "knots": self.knots.tolist(),
        }
        if np.any(self.weights != 1.0):
            edge["weights"] = self.weights.tolist()
        return edge


def elevated_lines(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bezier pieces of degree 1, rows x, y, w, as pieces of degree 2: the kernel that evaluates begins there."""
    start, end = rows[::2], rows[1::2]
    weight = start[:, 2:] + end[:, 2:]
    middle = start[:, :2] + end[:, 2:] / weight * (end[:, :2] - start[:, :2])
    return np.stack((start, np.column_stack((middle, 0.5 * weight)), end), axis=1).reshape(-1, 3)


def restricted(rows: NDArray[np.float64], s0: float, s1: float) -> NDArray[np.float64]:
    """Bezier rows (p + 1, d), homogeneous, over [s0, s1] in [0, 1], by convex steps."""
    out, p = rows.copy(), len(rows) - 1
    for r in range(1, p + 1):
        for i in range(p, r - 1, -1):
            out[i] = (1.0 - s1) * out[i - 1] + s1 * out[i]
    share = s0 / s1
    for r in range(1, p + 1):
        for i in range(p - r + 1):
            out[i] = (1.0 - share) * out[i] + share * out[i + 1]
    return out
