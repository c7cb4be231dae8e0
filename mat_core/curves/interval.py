r"""A bound of the distance of a polynomial (`polynomial`) from the axis, over its interval.

        check  node  check  node  check        The nodes make |W|, below, equally large at all checks, which so see
      P-c-+-----o-----+-----o-----+-c-Q        the largest error. Two more checks c stand nearer to P and Q.

The bound. F interpolates X, which at equal tau lies on the true axis, so for each component (Davis, Interpolation and
Approximation, 1963, section 3.6; X smooth)

    F(tau) - X(tau) = -W(tau) h(tau),    W = tau^2 (1 - tau)^2 prod (tau - tau_i),    h = X[0, 0, 1, 1, tau_1 .. tau_m, tau].

W is known, h is slowly varying. Let p_k be the polynomial through the first k values of h at the K = m + 3 checks,
taken from the middle outwards in pairs, and |.| the norm |(x, y)| + |r|; for corrections |x| + |y| + |r|, which is no less.

1. |W p_K|: a polynomial of degree d = 2 m + 6 in any direction, so from its values at N Chebyshev points (Ehlich, Zeller,
   Schwankung von Polynomen zwischen Gitterpunkten, Math. Z. 86, 1964):  max |W p_K| <= max_k |W p_K|(x_k) / cos(pi d / 2 N).
2. |W (h - p_K)|: assumed, as for every function that is analytic around the interval, is that two more terms at a time
   the corrections D_k = max |W (p_k - p_{k-2})|, at the points of 1., fall as fast as the last three did (p_{-1} = 0). With
   q = max(D_K / D_{K-2}, sqrt(D_K / D_{K-4})):    |W (h - p_K)| <= D_K (q + q^2 + ...) = D_K q / (1 - q).
   One ratio alone says little where corrections rise and fall in turn: the last one may be small after a large one by chance.
   q is kept between FAST, what is less may be chance, and SLOW: where corrections are not seen to fall (rounding, a joint
   of the boundary that shows), those to come are taken for nine times the last one in all.
3. The assumption is tested on every piece. At two more true axis points, near either end where W prod (tau - checks) is large,
   F - X is known: there W (h - p_K) may be no more than 2. allows. Discs between the strips of an interval are known exactly,
   and no check stands there, either: F may miss none by more than the bound. A bound that fails a test is not believed, and
   the piece is made shorter.

The norm bounds both the distance in (x, y, r) and | |distance of (x, y) to the boundary| - r |: the boundary's distance
changes by no more than the centre moves. Rounding is added where pieces become segments (`assemble`).
"""

from __future__ import annotations

import math

import numpy as np

from mat_core.curves.plan import sample_at, sample_planned
from mat_core.curves.polynomial import divide, interpolate, miss, weight_of
from mat_core.curves.way import I_ROW, MOST_NODES, PLAN_S0, PLAN_S1, PLAN_T, SPARE, SPARE_MISS, Scratch, Track
from mat_core.kernels.jit import inner

# abscissae of checks (even) and nodes (odd) up to the middle, for 2, 4 and 6 nodes: |W| is equally large at all checks
FRACTIONS = np.array((0.182223, 0.337294, 0.5,
                      0.098311, 0.186439, 0.284563, 0.390292, 0.5,
                      0.061866, 0.118639, 0.183531, 0.255779, 0.333844, 0.415906, 0.5))  # fmt: skip
OUTER = 0.6  # abscissa of the checks beside the ends, relative to the first one's
CHASE = 4  # samples to bring such a check within NEAR_ENOUGH of its abscissa
NEAR_ENOUGH = 0.04
MIN_GAP = 0.02  # least distance of neighbouring abscissae; below, the interpolation would be ill-conditioned
MARGIN = 0.15  # least distance of a check from what stands beside it, relative to the distance of these; nearer, W vanishes

POINTS = 5  # Chebyshev points for each two degrees of W p_K: nowhere more than 1 / cos(pi / POINTS) = 1.24 times as at these
CHEBYSHEV = np.array([[0.5 - 0.5 * math.cos(math.pi * (k + 0.5) / (POINTS * (m + 3))) for k in range(POINTS * (MOST_NODES + 3))]
                      for m in range(MOST_NODES + 1)])  # on [0, 1], the first POINTS (m + 3) of row m
LEAST_SEEN = math.cos(math.pi / POINTS)  # of the largest value of W p_K
TESTED = 1.45  # abscissa of the places where the assumption is tested, relative to the outermost check's
DOUBTED = 2.0  # times the tolerance: the error of a piece whose bound fails a test, as far as it decides where to end it
FAST, SLOW = 0.1, 0.9  # range of the ratio of successive corrections
LEAST_CHECKS = 5  # for 2 nodes: the first of three corrections is the constant itself
AXIS_ROUNDING = 1e-13  # of axis points (normalised); measured: 5e-14, where both sides have nearly one normal


@inner
def _fraction(m: int, k: int) -> float:
    """Abscissa k = 0 .. 2 m of checks (even) and nodes (odd), for m nodes."""
    first = (m // 2) * (m // 2) - 1
    return 1.0 - FRACTIONS[first + 2 * m - k] if k > m else FRACTIONS[first + k]


@inner
def _bound(scratch: Scratch, m: int) -> tuple[float, float]:
    """(bound of the norm of F - X, bound of what 1. leaves of it) from its values `misses` (m + 3, 3) at the checks."""
    samples = scratch.samples
    misses = scratch.misses
    n = m + 3
    for k in range(n):
        share = 1.0 / weight_of(samples, m, samples[m + k, 0])
        for c in range(3):
            misses[k, c] *= share
    divide(samples, misses, m, n)
    largest = 0.0
    last = 0.0
    last_but_one = 0.0
    last_but_two = 0.0
    for point in range(POINTS * n):
        t = CHEBYSHEV[m, point]
        basis = weight_of(samples, m, t)
        x = basis * misses[0, 0]
        y = basis * misses[0, 1]
        r = basis * misses[0, 2]
        if n == LEAST_CHECKS:
            last_but_two = max(last_but_two, abs(x) + abs(y) + abs(r))
        for k in range(1, n, 2):
            basis *= t - samples[m + k - 1, 0]
            more = basis * (t - samples[m + k, 0])
            dx = basis * misses[k, 0] + more * misses[k + 1, 0]
            dy = basis * misses[k, 1] + more * misses[k + 1, 1]
            dr = basis * misses[k, 2] + more * misses[k + 1, 2]
            basis = more
            x += dx
            y += dy
            r += dr
            size = abs(dx) + abs(dy) + abs(dr)
            if k == n - 2:
                last = max(last, size)
            elif k == n - 4:
                last_but_one = max(last_but_one, size)
            elif k == n - 6:
                last_but_two = max(last_but_two, size)
        largest = max(largest, math.sqrt(x * x + y * y) + abs(r))
    last_but_one = max(last_but_one, AXIS_ROUNDING)  # what is less says nothing
    last_but_two = max(last_but_two, AXIS_ROUNDING)
    q = min(max(last / last_but_one, math.sqrt(last / last_but_two), FAST), SLOW)
    last = max(last, FAST * last_but_one)
    rest = last * q / (1.0 - q)
    return largest / LEAST_SEEN + rest, rest


@inner
def _surprising(track: Track, scratch: Scratch, m: int, end: int, rest: float) -> bool:
    """Whether a true axis point near an end is farther from F - W p_K than the rest allows.

    Assumes that `misses` are divided differences (`_bound`); writes to the spare row of samples and of `misses`.
    """
    wanted = TESTED * _fraction(m, 0)
    sample_at(track, scratch, wanted if end == 0 else 1.0 - wanted, SPARE)
    samples = scratch.samples
    misses = scratch.misses
    t = samples[SPARE, 0]
    if not 0.0 < t < 1.0:
        return False
    miss(scratch, SPARE, m, SPARE_MISS)
    basis = weight_of(samples, m, t)
    for k in range(m + 3):
        for c in range(3):
            misses[SPARE_MISS, c] -= basis * misses[k, c]
        basis *= t - samples[m + k, 0]
    x = misses[SPARE_MISS, 0]
    y = misses[SPARE_MISS, 1]
    return math.sqrt(x * x + y * y) + abs(misses[SPARE_MISS, 2]) > rest + AXIS_ROUNDING


@inner
def _chase_end(track: Track, scratch: Scratch, m: int, end: int, row: int) -> None:
    """The check between the outermost one and an end: where the plan puts it, then by regula falsi nearer to its place."""
    samples = scratch.samples
    steps = scratch.steps
    first = int(scratch.ends[0, I_ROW])
    last = int(scratch.ends[1, I_ROW])
    f = OUTER * _fraction(m, 0)
    wanted = f if end == 0 else 1.0 - f
    sample_at(track, scratch, wanted, row)
    w = first if end == 0 else last
    t_out = 0.0 if end == 0 else 1.0
    s_out = steps[w - first, PLAN_S0 if end == 0 else PLAN_S1]
    t_in = 1.0 if end == 0 else steps[w - first, PLAN_T]
    s_in = steps[w - first, PLAN_S1 if end == 0 else PLAN_S0]
    if end == 0 and last > first:
        t_in = steps[1, PLAN_T]
    # only in the outermost strip: another one begins at a disc, where the plan is exact
    if (wanted < t_in) != (end == 0):
        return
    for _ in range(CHASE - 1):
        t = samples[row, 0]
        if abs(t - wanted) < NEAR_ENOUGH:
            return
        if (t < wanted) == (end == 0):
            t_out = t
            s_out = samples[row, 4]
        else:
            t_in = t
            s_in = samples[row, 4]
        s = s_in + (s_out - s_in) * (wanted - t_in) / (t_out - t_in)
        sample_planned(track, scratch, w - first, s, row)


@inner
def _well_inside(t: float, before: float, after: float) -> bool:
    """Whether a check stands clear of its neighbours."""
    return before + MARGIN * (after - before) < t < after - MARGIN * (after - before)


@inner
def attempt(track: Track, scratch: Scratch, m: int, tolerance: float) -> float:
    """Bound of the fit over the interval when it is within the tolerance and passes its tests; else about its error.

    With an infinite tolerance it is the bound of a piece that cannot be shorter, whatever the tests say.

    Assumes that H is there, the plan is made and runs evenly. Infinite when samples stand where they tell nothing.
    """
    samples = scratch.samples
    for i in range(m):
        sample_at(track, scratch, _fraction(m, 2 * i + 1), i)
        if not samples[i, 0] - (samples[i - 1, 0] if i else 0.0) > MIN_GAP:
            return math.inf
    if not 1.0 - samples[m - 1, 0] > MIN_GAP:
        return math.inf
    interpolate(scratch, m)
    worst = 0.0
    for k in range(m + 1):
        # from the middle outwards, but for the second pair, which stands beside the ends
        step = (k + 1) // 2
        row = m + k if k == 0 else m + k + 2
        place = m + 2 * step if k % 2 == 0 else m - 2 * step
        sample_at(track, scratch, _fraction(m, place), row)
        i = place // 2
        before = samples[i - 1, 0] if i > 0 else 0.0
        after = samples[i, 0] if i < m else 1.0
        if not _well_inside(samples[row, 0], before, after):
            return math.inf
        worst = max(worst, miss(scratch, row, m, row - m))
        if not worst <= tolerance:
            return worst
    for end in range(2):
        row = m + 1 + end
        _chase_end(track, scratch, m, end, row)
        if not _well_inside(samples[row, 0], samples[2 * m + 2, 0] if end else 0.0, 1.0 if end else samples[2 * m + 1, 0]):
            return math.inf
        worst = max(worst, miss(scratch, row, m, row - m))
    if not worst <= tolerance:
        return worst
    bound, rest = _bound(scratch, m)
    for end in range(2 if tolerance < math.inf else 0):
        if bound <= tolerance and _surprising(track, scratch, m, end, rest):
            return DOUBTED * tolerance
    return bound


@inner
def refuted(track: Track, scratch: Scratch, m: int, bound: float) -> bool:
    """Whether the fit misses a disc between the interval's strips by more than its bound."""
    samples = scratch.samples
    first = int(scratch.ends[0, I_ROW])
    for w in range(first, int(scratch.ends[1, I_ROW])):
        samples[SPARE, 0] = scratch.steps[w + 1 - first, PLAN_T]
        for c in range(3):
            samples[SPARE, 1 + c] = track.disc[track.strip_i[w, 3], c]
        if miss(scratch, SPARE, m, 0) > bound + AXIS_ROUNDING:
            return True
    return False
