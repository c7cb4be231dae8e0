r"""How far a polynomial is from the parallel curve it was fitted to: a bound by signs of polynomials, nothing sampled.

F(v) is held against C(v) + d n(v) at the same v, C = P / w a Bezier curve with tangent vectors T, N = T turned left. Along T
and N the two differ by

    e_t = (F - C).T / |T|,       e_n = (F - C).N / |T| - d,       |F - C - d n|^2 = e_t^2 + e_n^2.

|T| is a root, its square is not. With the polynomials A = (F w - P).T, B = (F w - P).N and S = w^2 |T|^2

    |e_t| <= a   where   a^2 S - A^2 >= 0,
    |e_n| <= b   where   b (2 d - b) S -+ (B^2 - d^2 S) >= 0,    0 < b < d,    B > 0 at one place:

the lower one of the latter two says |B| >= (d - b) w |T|, so that B keeps its sign, the upper one B^2 <= (d^2 + 2 d b) S. A
polynomial without a negative Bernstein coefficient on an interval is nowhere negative there; halving the interval brings the
coefficients to the values. Guesses for a and b come from values, and are stated only where the signs prove them.

A Bezier that stands still at an end has T = v T~ there: that factor is taken out, directions stay.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.bernstein import binomials, derivative, halve, product, restrict
from mat_core.boundary.sites import SiteTable
from mat_core.kernels.layout import CP0, DEG, RATIONAL, X0, X0_LOW, Y0, Y0_LOW

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

MARGIN = 1.2  # what is to be proved over the largest value seen
PLACES = np.linspace(0.0, 1.0, 41)[1:-1]  # where values are taken
HALVINGS = 12  # of an interval until its signs decide
NOISE = 1e-13  # coefficients below zero by this share of the largest are rounding
STILL = 1e-13  # a tangent at an end this short against the longest is none
ROUNDING = 1e-15  # of points a radius or so away (normalised)


def parallel_bound(table: SiteTable, site: Ints, s: Floats, distance: float, control: Floats) -> Floats:
    """Bounds of the distance between fitted polynomials and the parallel curves of Bezier pieces.

    Parameters
    ----------
    table : SiteTable
    site : (R,) int64
        Of kind SPIRAL.
    s : (R, 2) float64
        Interval on the site, s0 < s1.
    distance : float
        Positive, to the left, normalised.
    control : (R, p + 1, 2) float64
        Bezier control points over that interval, normalised.

    Returns
    -------
    (R,) float64
        Infinite where nothing could be proved.
    """
    out = np.full(len(site), np.inf)
    shape = np.column_stack((table.si[site, DEG], table.si[site, RATIONAL]))
    for degree, rational in np.unique(shape, axis=0).tolist():
        rows = np.flatnonzero((shape == (degree, rational)).all(axis=1))
        whole = table.cp[table.si[site[rows], CP0][:, None] + np.arange(degree + 1)]
        f = table.sf[site[rows]]
        start = np.column_stack((f[:, X0] + f[:, X0_LOW], f[:, Y0] + f[:, Y0_LOW]))
        fitted = control[rows] - start[:, None]
        out[rows] = _bounds(whole, bool(rational), s[rows], distance, fitted)
    return out


def _bounds(whole: Floats, rational: bool, s: Floats, d: float, fitted: Floats) -> Floats:
    """The bounds for Beziers (R, n + 1, 3) of one degree; `fitted` is relative to the same point."""
    weight = whole[:, :, 2] if rational else np.ones((len(whole), 1))
    own = [whole[:, :, k] * whole[:, :, 2] if rational else whole[:, :, k] for k in range(2)]
    tangent = [product(derivative(p), weight) - product(p, derivative(weight)) if rational else derivative(p) for p in own]
    a, b = s[:, 0], s[:, 1]
    tx, ty = _moving([restrict(t, a, b) for t in tangent])
    w = restrict(weight, a, b)
    apart = [_difference(product(fitted[:, :, k], w), restrict(p, a, b)) for k, p in enumerate(own)]
    along = product(apart[0], tx) + product(apart[1], ty)
    across = product(apart[1], tx) - product(apart[0], ty)
    speed_sq = product(product(w, w), product(tx, tx) + product(ty, ty))
    # guesses from values
    size = np.sqrt(_values(speed_sq))
    with np.errstate(divide="ignore", invalid="ignore"):
        most_along = MARGIN * np.abs(_values(along) / size).max(axis=1) + ROUNDING
        most_across = MARGIN * np.abs(_values(across) / size - d).max(axis=1) + ROUNDING
    known = (most_across < d) & np.isfinite(most_along) & (_values(across)[:, len(PLACES) // 2] > 0.0)
    # proofs
    sq = _raised(speed_sq, 2 * (along.shape[1] - 1))
    known &= _nowhere_negative(most_along[:, None] ** 2 * sq - product(along, along), known)
    off = product(across, across) - d * d * sq
    room = (most_across * (2.0 * d - most_across))[:, None] * sq
    for margin in (room - off, room + off):
        known &= _nowhere_negative(margin, known)
    bound: Floats = np.where(known, np.hypot(most_along, most_across), np.inf)
    return bound


def _moving(tangent: list[Floats]) -> list[Floats]:
    """Tangent vectors without the factors v and 1 - v of ends where they vanish."""
    for end in (0, -1):
        length = np.hypot(tangent[0], tangent[1])
        still = length[:, end] <= STILL * length.max(axis=1)
        if tangent[0].shape[1] == 1 or not still.any():
            continue
        n = tangent[0].shape[1] - 1
        factor = n / np.arange(1, n + 1)
        reduced = [t[:, 1:] * factor if end == 0 else t[:, :-1] * factor[::-1] for t in tangent]
        tangent = [np.where(still[:, None], _raised(r, n), t) for r, t in zip(reduced, tangent, strict=True)]
    return tangent


def _difference(a: Floats, b: Floats) -> Floats:
    """a - b of rows of any two degrees."""
    degree = max(a.shape[1], b.shape[1]) - 1
    return _raised(a, degree) - _raised(b, degree)


def _raised(rows: Floats, degree: int) -> Floats:
    """The same polynomials with degree + 1 coefficients."""
    more = degree + 1 - rows.shape[1]
    return product(rows, np.ones((1, more + 1))) if more else rows


def _values(rows: Floats) -> Floats:
    """(R, k) values at all places."""
    n = rows.shape[1] - 1
    powers = np.arange(n + 1)
    basis = binomials(n)[:, None] * PLACES ** powers[:, None] * (1.0 - PLACES) ** (n - powers)[:, None]
    values: Floats = rows @ basis
    return values


def _nowhere_negative(rows: Floats, wanted: Flags) -> Flags:
    """Whether polynomials have no negative value in [0, 1]; only of the wanted ones."""
    proved = wanted.copy()
    row = np.flatnonzero(wanted)
    noise = NOISE * np.abs(rows).max(axis=1)
    c = rows[row]
    for halving in range(HALVINGS + 1):
        floor = -noise[row]
        ends = np.minimum(c[:, 0], c[:, -1])
        proved[row[ends < floor]] = False
        open_ = (c.min(axis=1) < floor) & proved[row]
        if halving == HALVINGS:
            proved[row[open_]] = False
        row, c = np.repeat(row[open_], 2), np.stack(halve(c[open_]), axis=1).reshape(-1, c.shape[1])
        if not len(row):
            break
    return proved
