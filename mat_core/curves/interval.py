r"""One polynomial over one interval of the axis, and a bound of its distance from the axis.

An interval runs from disc P to disc Q in the space of (x, y, r). Its parameter is the share of the way along the chord,

    tau(X) = (X - P).(Q - P) / |Q - P|^2,

in which the axis is a regular, smooth curve everywhere: also at a centre of curvature, where both footpoints run into
each other and every boundary parameter u gives tau ~ (u - u*)^2, and where a Bezier's own speed is zero. The true
axis is sampled through a footpoint s on one side; each sample brings its own tau, so no equation tau(s) = const has
to be solved.

    F(tau) = H(tau) + tau^2 (1 - tau)^2 g(tau)         H: cubic with the exact discs and exact tangents at both ends
                                                       g: through samples at m nodes; degree of F: m + 3
    tangent at a disc with normals n1 (right), n2 (left): t = (n1 - n2) turned by -90 degrees, dr = t.n1; at a centre of
    curvature (n, 1): the disc moves straight away from its only contact. Tangents know nothing of curvature, so pieces
    join with one tangent.

        check  node  check  node  check        The nodes make |W|, below, equally large at all checks, which so see
      P-c-+-----o-----+-----o-----+-c-Q        the largest error. Two more checks c stand nearer to P and Q.

The bound. F interpolates X, which at equal tau lies on the true axis, so for each component (Davis, Interpolation and
Approximation, 1963, section 3.6; X smooth)

    F(tau) - X(tau) = -W(tau) h(tau),    W = tau^2 (1 - tau)^2 prod (tau - tau_i),    h = X[0, 0, 1, 1, tau_1 .. tau_m, tau].

W is known, h is slowly varying. Let p_k be the polynomial through the first k values of h at the K = m + 3 checks,
taken from the middle outwards in pairs, and |.| the norm |(x, y)| + |r|.

1. |W p_K|: a polynomial of degree d = 2 m + 6 in any direction, so from its values at N Chebyshev points (Ehlich, Zeller,
   Schwankung von Polynomen zwischen Gitterpunkten, Math. Z. 86, 1964):  max |W p_K| <= max_k |W p_K|(x_k) / cos(pi d / 2 N).
2. |W (h - p_K)|: assumed, as for every function that is analytic around the interval, is that two more terms at a time
   the corrections D_k = max |W (p_k - p_{k-2})| fall at least as fast as the last two measured did. With their ratio
   q = D_K / D_{K-2}:    |W (h - p_K)| <= D_K (q + q^2 + ...) = D_K q / (1 - q).
   q is kept between FAST, what is less may be chance, and SLOW: where corrections are not seen to fall (rounding, a joint
   of the boundary that shows), those to come are taken for nine times the last one in all.
3. Discs between the strips of an interval are known exactly, and no check stands there. A bound that is less than what F misses
   one of them by rests on a wrong assumption; it is not believed (`refuted`).

The norm bounds both the distance in (x, y, r) and | |distance of (x, y) to the boundary| - r |: the boundary's distance
changes by no more than the centre moves. Rounding is added where pieces become segments (`assemble`).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.way import I_ROW, I_TX, I_X, PLAN_S0, PLAN_S1, PLAN_T, Scratch, Track, sample, sample_at
from mat_core.kernels.jit import inner

Floats = NDArray[np.float64]

# abscissae of checks (even) and nodes (odd) up to the middle, for 2, 4 and 6 nodes: |W| is equally large at all checks
FRACTIONS = (0.182223, 0.337294, 0.5,
             0.098311, 0.186439, 0.284563, 0.390292, 0.5,
             0.061866, 0.118639, 0.183531, 0.255779, 0.333844, 0.415906, 0.5)  # fmt: skip
OUTER = 0.6  # abscissa of the checks beside the ends, relative to the first one's
CHASE = 4  # samples to bring such a check within NEAR_ENOUGH of its abscissa
NEAR_ENOUGH = 0.04
MIN_GAP = 0.02  # least distance of neighbouring abscissae; below, the interpolation would be ill-conditioned
MARGIN = 0.15  # least distance of a check from what stands beside it, relative to the distance of these; nearer, W vanishes
MIN_COSINE = 0.4  # of the angle between an end tangent and the chord; a piece that turns more is halved

CHEBYSHEV = 0.5 - 0.5 * np.cos(np.pi * (np.arange(48) + 0.5) / 48.0)  # on [0, 1]
FAST, SLOW = 0.1, 0.9  # range of the ratio of successive corrections
AXIS_ROUNDING = 1e-13  # of axis points (normalised); measured: 5e-14, where both sides have nearly one normal


@inner
def _fraction(m: int, k: int) -> float:
    """Abscissa k = 0 .. 2 m of checks (even) and nodes (odd), for m nodes."""
    first = (m // 2) * (m // 2) - 1
    return 1.0 - FRACTIONS[first + 2 * m - k] if k > m else FRACTIONS[first + k]


@inner
def _hermite(ends: Floats, out: Floats) -> bool:
    """Bernstein coefficients (4, 3) of the cubic H over tau; False when an end tangent leans away from the chord."""
    ux = ends[1, I_X] - ends[0, I_X]
    uy = ends[1, I_X + 1] - ends[0, I_X + 1]
    ur = ends[1, I_X + 2] - ends[0, I_X + 2]
    dd = ux * ux + uy * uy + ur * ur
    d = math.sqrt(dd)
    good = True
    for end in range(2):
        tx = ends[end, I_TX]
        ty = ends[end, I_TX + 1]
        tr = ends[end, I_TX + 2]
        lean = tx * ux + ty * uy + tr * ur
        size = math.sqrt(tx * tx + ty * ty + tr * tr)
        factor = dd / lean / 3.0 if lean > 0.0 else 0.0
        if not lean >= MIN_COSINE * size * d or size == 0.0:
            good = False
        sign = 1.0 if end == 0 else -1.0
        for m in range(3):
            p = ends[end, I_X + m]
            out[3 * end, m] = p
            out[1 + end, m] = p + sign * factor * ends[end, I_TX + m]
    return good


@inner
def _cubic(hermite: Floats, t: float, c: int) -> float:
    """Component c of H at t."""
    s = 1.0 - t
    return s * s * (s * hermite[0, c] + 3.0 * t * hermite[1, c]) + t * t * (3.0 * s * hermite[2, c] + t * hermite[3, c])


@inner
def _interpolate(scratch: Scratch, m: int) -> None:
    """Newton coefficients (m, 3) of g through the nodes."""
    samples = scratch.samples
    newton = scratch.newton
    for i in range(m):
        t = samples[i, 0]
        weight = t * t * (1.0 - t) * (1.0 - t)
        for c in range(3):
            newton[i, c] = (samples[i, 1 + c] - _cubic(scratch.hermite, t, c)) / weight
    _divide(samples, newton, 0, m)


@inner
def _divide(samples: Floats, values: Floats, first: int, n: int) -> None:
    """Divided differences in place: values (n, 3) at the abscissae of the samples from row `first` on."""
    for level in range(1, n):
        for i in range(n - 1, level - 1, -1):
            gap = samples[first + i, 0] - samples[first + i - level, 0]
            for c in range(3):
                values[i, c] = (values[i, c] - values[i - 1, c]) / gap


@inner
def _miss(scratch: Scratch, row: int, m: int, k: int) -> float:
    """Norm of F - X at the sample in one row; the vector goes to row k of `misses`."""
    samples = scratch.samples
    newton = scratch.newton
    out = scratch.misses
    t = samples[row, 0]
    weight = t * t * (1.0 - t) * (1.0 - t)
    for c in range(3):
        g = newton[m - 1, c]
        for i in range(m - 2, -1, -1):
            g = g * (t - samples[i, 0]) + newton[i, c]
        out[k, c] = _cubic(scratch.hermite, t, c) + weight * g - samples[row, 1 + c]
    return math.sqrt(out[k, 0] * out[k, 0] + out[k, 1] * out[k, 1]) + abs(out[k, 2])


@inner
def _weight(samples: Floats, m: int, t: float) -> float:
    """W at t."""
    w = t * t * (1.0 - t) * (1.0 - t)
    for i in range(m):
        w *= t - samples[i, 0]
    return w


@inner
def _bound(scratch: Scratch, m: int) -> float:
    """Bound of the norm of F - X from its values `misses` (m + 3, 3) at the checks, as above."""
    samples = scratch.samples
    misses = scratch.misses
    n = m + 3
    for k in range(n):
        weight = _weight(samples, m, samples[m + k, 0])
        for c in range(3):
            misses[k, c] /= weight
    _divide(samples, misses, m, n)
    largest = 0.0
    last = 0.0
    last_but_one = 0.0
    for point in range(CHEBYSHEV.shape[0]):
        t = CHEBYSHEV[point]
        basis = _weight(samples, m, t)
        x = basis * misses[0, 0]
        y = basis * misses[0, 1]
        r = basis * misses[0, 2]
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
            if k == n - 2:
                last = max(last, math.sqrt(dx * dx + dy * dy) + abs(dr))
            elif k == n - 4:
                last_but_one = max(last_but_one, math.sqrt(dx * dx + dy * dy) + abs(dr))
        largest = max(largest, math.sqrt(x * x + y * y) + abs(r))
    last_but_one = max(last_but_one, AXIS_ROUNDING)  # what is less says nothing
    q = min(max(last / last_but_one, FAST), SLOW)
    last = max(last, FAST * last_but_one)
    return largest / math.cos(math.pi * (m + 3.0) / CHEBYSHEV.shape[0]) + last * q / (1.0 - q)


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
        sample(track, scratch, w, s, row)


@inner
def _well_inside(t: float, before: float, after: float) -> bool:
    """Whether a check stands clear of its neighbours."""
    return before + MARGIN * (after - before) < t < after - MARGIN * (after - before)


@inner
def attempt(track: Track, scratch: Scratch, m: int, tolerance: float) -> float:
    """Bound of the fit over the interval when it is within the tolerance; else about its error.

    Assumes that the plan is made and runs evenly. Infinite when there is no fit, or samples stand where they tell nothing.
    """
    samples = scratch.samples
    if not _hermite(scratch.ends, scratch.hermite):
        return math.inf
    for i in range(m):
        sample_at(track, scratch, _fraction(m, 2 * i + 1), i)
        if not samples[i, 0] - (samples[i - 1, 0] if i else 0.0) > MIN_GAP:
            return math.inf
    if not 1.0 - samples[m - 1, 0] > MIN_GAP:
        return math.inf
    _interpolate(scratch, m)
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
        worst = max(worst, _miss(scratch, row, m, row - m))
        if not worst <= tolerance:
            return worst
    for end in range(2):
        row = m + 1 + end
        _chase_end(track, scratch, m, end, row)
        if not _well_inside(samples[row, 0], samples[2 * m + 2, 0] if end else 0.0, 1.0 if end else samples[2 * m + 1, 0]):
            return math.inf
        worst = max(worst, _miss(scratch, row, m, row - m))
    if not worst <= tolerance:
        return worst
    return _bound(scratch, m)


@inner
def refuted(track: Track, scratch: Scratch, m: int, bound: float, spare: int) -> bool:
    """Whether the fit misses a disc between the interval's strips by more than its bound."""
    samples = scratch.samples
    first = int(scratch.ends[0, I_ROW])
    for w in range(first, int(scratch.ends[1, I_ROW])):
        samples[spare, 0] = scratch.steps[w + 1 - first, PLAN_T]
        for c in range(3):
            samples[spare, 1 + c] = track.disc[track.strip_i[w, 3], c]
        if _miss(scratch, spare, m, 0) > bound + AXIS_ROUNDING:
            return True
    return False
