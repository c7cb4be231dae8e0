r"""Curves that are known point by point as B-splines within a tolerance.

A curve P(v) is fitted over an interval by the polynomial that has its ends and derivatives there, and passes through it
at m inner nodes (m = 2: degree 5, m = 4: degree 7); what is not near enough is halved. The error is measured where
nodes let it be largest, in the parameter, |fit(v) - P(v)|, with a margin of `SAFETY` for places between. Who knows P well
enough for a bound hands it in (`parallel_bound`): then it is the bound that is stated, and that must be near enough.

    P, P' --o--x--o--x--o-- P', P        x nodes, o checks

All intervals of all curves are fitted at once, round by round. Neighbouring fits share their tangent: `join` makes one
B-spline of them, with spans chosen so that derivatives agree (C1, knots of multiplicity degree - 1).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Curves = Callable[[Ints, Floats], Floats]  # (curve (n,), v (n,)) -> (n, 2)
Bound = Callable[[Ints, Floats, Floats], Floats]  # (curve (n,), v at both ends (n, 2), control points) -> (n,)

SAFETY = 1.5  # stated error over the largest measured one
FINE = 5e-8  # from here down degree 7 needs fewer pieces than degree 5 (normalised lengths)
ROUNDS = 20  # of halving: intervals of 1e-6 of their curve are not halved any more
WAITING = 64  # intervals waiting for each curve on average at which halving ends: these are not smooth
SLOW = 0.02  # an end with a leg this short, relative to the chord, has no speed; a straight cubic's has 0.33
NOISE = 1e-13  # an error this small is never halved away
CROSS_NOISE = 1e-11  # an error across the curve that may be of rounding
STALLED_ACROSS = 0.5  # what halving leaves of one that is; of a curve that goes like a square root it leaves 0.7
STALLED = 0.25  # of what it was, and more: what halving a piece leaves of an error of rounding
ROUNDING = 4e-16  # no stated error is less
NODES = {2: (0.18225, 0.337294, 0.5), 4: (0.09825, 0.186439, 0.2845, 0.390292, 0.5)}  # checks and nodes in turn, to the middle
END_CHECK = 0.6  # one more check on the way from the outer one to the end
DRIFT = 1e4  # spans may grow or shrink so much against lengths: knots of slower ends would lose their digits
C1_DEFECT = 1e-12  # a joint whose neighbours are off their common line by more than this stays a full knot


class Fits(NamedTuple):
    """Polynomial pieces in order: curve (K,), ends (K, 2) in v, control (K, n + 1, 2) of their Beziers, error (K,)."""

    curve: Ints
    ends: Floats
    control: Floats
    error: Floats

    def of(self, curve: int) -> slice:
        """Rows of one curve."""
        return slice(*np.searchsorted(self.curve, (curve, curve + 1)).tolist())


def bernstein(degree: int, v: Floats) -> Floats:
    """All Bernstein polynomials of a degree at v (n,): (n, degree + 1)."""
    j = np.arange(degree + 1)
    binomials = np.array([float(math.comb(degree, int(k))) for k in j])
    out: Floats = binomials * v[:, None] ** j * (1.0 - v[:, None]) ** (degree - j)
    return out


@cache
def _scheme(m: int) -> tuple[Floats, Floats, Floats, Floats]:
    """(places, matrix from [P0, D0, samples at nodes, D1, P1] to Bernstein coefficients; basis at checks, and slope)."""
    half = NODES[m]
    inner = np.array([*half, *(1.0 - f for f in half[-2::-1])])
    nodes = inner[1::2]
    checks = np.concatenate(([END_CHECK * inner[0]], inner[0::2], [1.0 - END_CHECK * inner[0]]))
    n = m + 3
    rows = np.zeros((n + 1, n + 1))
    rows[0, 0] = rows[-1, -1] = 1.0
    rows[1, :2] = -n, n
    rows[-2, -2:] = -n, n
    rows[2:-2] = bernstein(n, nodes)
    matrix = np.asarray(np.linalg.inv(rows), dtype=np.float64)
    slope = np.diff(np.pad(bernstein(n - 1, checks), ((0, 0), (1, 1))), axis=1) * -n
    return np.concatenate((nodes, checks)), matrix, bernstein(n, checks), slope


def fit(
    points: Curves, derivatives: Curves, curves: int, tolerance: float, regular: bool = False, noise: float = CROSS_NOISE,
    bound: Bound | None = None,
) -> Fits:
    """Fit the curves P_i(v), v in [0, 1], for i in range(curves).

    Parameters
    ----------
    points, derivatives : callable
        P and dP/dv of many (curve, v) at once, each (n, 2).
    curves : int
    tolerance : float
        Largest error; what rounding keeps above it states the larger one.
    regular : bool
        Where a curve begins or ends without speed, the fit does not: its last bit, shorter than the tolerance, is straight.
    noise : float
        Errors up to this are not chased when halving does not make them smaller; those across the curve above CROSS_NOISE only
        when that hardly makes these smaller.
    bound : callable, optional
        Bounds of the errors of fits that are near enough where they were measured; what it gives is stated, and must do.

    Returns
    -------
    Fits
    """
    m = 2 if tolerance >= FINE else 4
    item = np.arange(curves)
    lo, hi = np.zeros(curves), np.ones(curves)
    before = across_before = np.full(curves, np.inf)
    done: list[tuple[Ints, Floats, Floats, Floats]] = []
    for remaining in range(ROUNDS, -1, -1):
        if not len(item):
            break
        control, error, across = _interpolate(points, derivatives, item, lo, hi, m)
        good = error <= tolerance
        if regular:
            _straighten(control, error, good, tolerance)
        # halving helps no more: what is left is the rounding of the points themselves
        stalled = (error <= noise) & (error >= STALLED * before)
        stalled &= (across <= max(tolerance, CROSS_NOISE)) | (across >= STALLED_ACROSS * across_before)
        ended = remaining == 0 or len(item) > WAITING * (curves + 1)
        good |= stalled | ended
        if bound is not None and good.any():
            measured = error.copy()
            error[good] = bound(item[good], np.column_stack((lo, hi))[good], control[good])
            good &= (error <= tolerance) | ended | stalled & (error <= noise)
            error[~good] = measured[~good]
        before, across_before = np.repeat(error[~good], 2), np.repeat(across[~good], 2)
        done.append((item[good], np.column_stack((lo, hi))[good], control[good], np.maximum(error[good], ROUNDING)))
        item, lo, hi = item[~good], lo[~good], hi[~good]
        middle = 0.5 * (lo + hi)
        item, lo, hi = np.repeat(item, 2), np.column_stack((lo, middle)).reshape(-1), np.column_stack((middle, hi)).reshape(-1)
    if not done:
        return Fits(np.empty(0, dtype=np.int64), np.empty((0, 2)), np.empty((0, m + 4, 2)), np.empty(0))
    return _in_order(done)


def _in_order(done: list[tuple[Ints, Floats, Floats, Floats]]) -> Fits:
    """Pieces of all rounds, by curve and along it."""
    all_item, all_ends, all_control, all_error = (np.concatenate(columns) for columns in zip(*done, strict=True))
    order = np.lexsort((all_ends[:, 0], all_item))
    return Fits(all_item[order], all_ends[order], all_control[order], all_error[order])


def _interpolate(
    points: Curves, derivatives: Curves, item: Ints, lo: Floats, hi: Floats, m: int
) -> tuple[Floats, Floats, Floats]:
    """Bezier control points (K, m + 4, 2) of all intervals lo .. hi, their measured errors (K,), and these across the curve."""
    places, matrix, basis, slope = _scheme(m)
    v = lo[:, None] + (hi - lo)[:, None] * np.concatenate(([0.0], places, [1.0]))
    v[:, -1] = hi
    found = points(np.repeat(item, v.shape[1]), v.reshape(-1)).reshape(*v.shape, 2)
    ends = derivatives(np.repeat(item, 2), np.column_stack((lo, hi)).reshape(-1)).reshape(-1, 2, 2)
    legs = ends * ((hi - lo) / (m + 3))[:, None, None]
    first, last = found[:, :1], found[:, -1:]
    known = np.concatenate((first, legs[:, :1] * (m + 3), found[:, 1 : m + 1], legs[:, 1:] * (m + 3), last), axis=1)
    # about the first point, so that rounding is that of the piece and not of its place
    control = np.einsum("ij,kjc->kic", matrix, _about(known, first)) + first
    control[:, :1], control[:, 1:2] = first, first + legs[:, :1]
    control[:, -1:], control[:, -2:-1] = last, last - legs[:, 1:]
    miss = np.einsum("ij,kjc->kic", basis, control) - found[:, m + 1 : -1]
    rate = np.einsum("ij,kjc->kic", slope, control - first)
    speed = np.hypot(rate[..., 0], rate[..., 1])
    aside = np.abs(miss[..., 0] * rate[..., 1] - miss[..., 1] * rate[..., 0]) / np.maximum(speed, np.finfo(float).tiny)
    return control, SAFETY * np.sqrt((miss**2).sum(axis=2).max(axis=1)), SAFETY * aside.max(axis=1)


def _straighten(control: Floats, error: Floats, good: NDArray[np.bool_], tolerance: float) -> None:
    """Pieces with an end without speed are not good, but for those shorter than the tolerance: these become straight."""
    first, last = control[:, :1], control[:, -1:]
    chord = np.hypot(*(last - first)[:, 0].T)
    legs = np.hypot(*np.diff(control, axis=1)[:, [0, -1]].transpose(2, 0, 1))
    slow = legs.min(axis=1) < SLOW * chord
    good &= ~slow
    short = slow & (chord <= max(tolerance, NOISE))
    control[short] = (first + (last - first) * np.linspace(0.0, 1.0, control.shape[1])[:, None])[short]
    error[short] = chord[short]
    good |= short


def _about(known: Floats, first: Floats) -> Floats:
    """Points relative to the first one; derivatives (rows 1 and -2) as they are."""
    out = known - first
    out[:, 1], out[:, -2] = known[:, 1], known[:, -2]
    return out


def join(pieces: Sequence[Floats]) -> tuple[Floats, Floats, float]:
    """One clamped B-spline of Beziers of one degree that follow each other.

    Parameters
    ----------
    pieces : sequence of (n + 1, 2) float64

    Returns
    -------
    knots : (k,) float64
        From 0 to 1; spans go with the lengths of the pieces, chosen so that derivatives agree where tangents do.
    control_points : (k - n - 1, 2) float64
    moved : float
        How far a joint was moved to make it C1, at most; the curve moves by no more.
    """
    n = len(pieces[0]) - 1
    control: list[Floats] = [pieces[0]]
    knots = [0.0] * (n + 1)
    span = max(math.dist(pieces[0][0], pieces[0][-1]), ROUNDING)
    u = span
    moved = 0.0
    for before, after in pairwise(pieces):
        arrive, leave = before[-1] - before[-2], after[1] - after[0]
        a, b = float(np.hypot(*arrive)), float(np.hypot(*leave))
        defect = float(np.hypot(*(arrive * b - leave * a))) / (a + b) if a > 0.0 and b > 0.0 else math.inf
        length = max(math.dist(after[0], after[-1]), ROUNDING)
        smooth = defect <= C1_DEFECT and length < DRIFT * span * b / a and span * b / a < DRIFT * length
        if smooth:
            moved = max(moved, defect)
            span *= b / a
            control[-1] = control[-1][:-1]
        else:
            span = length
        knots += [u] * (n - 1 if smooth else n)
        control.append(after[1:])
        u += span
    knots += [u] * (n + 1)
    return np.array(knots) / u, np.concatenate(control), moved
