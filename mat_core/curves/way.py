"""Where the axis is sampled: strips through one of their sides, intervals of them about evenly along their chord.

A strip is walked by a footpoint s on one side, its way. An interval of the axis may pass several strips; its own parameter tau
is the share of the way along its chord (`interval`). A sample is taken at an s and brings its tau; the *plan* of an interval says
where tau runs in each strip, from the discs between strips and one sample half way, so that s can be told for a wanted tau.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.jit import inner
from mat_core.tracing.strip import trace

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# an end of an interval: s, x, y, r, tangent, row of the way. Rows of `ends`: start and end of the interval, the end of a piece
# that will do; of `waiting`: ends that were too far
I_S, I_X, I_TX, I_ROW = 0, 1, 4, 7
END_ROWS, END_COLUMNS, WAITING = 3, 8, 128

# the way: where a strip is sampled. way_i: site of s, site of its partner; way_f: s at both ends, the partner's range
WAY_SITE, WAY_PARTNER = range(2)
WAY_S0, WAY_S1, WAY_LO, WAY_HI = range(4)

# samples: tau, x, y, r, s, partner's s
SAMPLE_COLUMNS = 6

# the plan of an interval, a row for each strip it passes: tau and s at its start, tau half way in s, s at its end
PLAN_T, PLAN_HALF, PLAN_S0, PLAN_S1 = range(4)
MAX_STRIPS = 12  # strips that one interval may pass

MAX_DEGREE = 9  # of a polynomial
ROWS = MAX_DEGREE + 1  # control points kept for a piece

# rows of samples: 0 .. m - 1 nodes, from m on m + 1 checks, two more near the ends, one spare
SAMPLE_ROWS = 2 * (MAX_DEGREE - 3) + 4
SPARE_MISS = MAX_DEGREE  # row of misses that is no check's

LEAST_PART = 1e-11  # an interval's part in one of several strips that is shorter has no parameters of its own in a segment
MIN_HALF = 0.02  # tau half way in s, from either end; a sample nearer says little about the other half


class Track(NamedTuple):
    """What curves are led along: sites, and strips in order and direction of travel with the way through each."""

    si: Ints
    sf: Floats
    cp: Floats
    disc: Floats  # (D, 3) x, y, r
    strip_i: Ints  # (W, 4) right site, left site, disc at the start, at the end
    strip_s: Floats  # (W, 4) s on the right site at both ends, on the left site at both ends
    joined: NDArray[np.bool_]  # (W,) the strip goes on where the one before ends, along one analytic curve on either side
    way_i: Ints  # (W, 2) WAY_SITE, WAY_PARTNER
    way_f: Floats  # (W, 4) WAY_S0 .. WAY_HI


class Scratch(NamedTuple):
    """Room for one interval: made once, written over and over."""

    ends: Floats  # (END_ROWS, END_COLUMNS)
    waiting: Floats  # (WAITING, END_COLUMNS)
    steps: Floats  # (MAX_STRIPS, 4) the plan
    samples: Floats  # (SAMPLE_ROWS, SAMPLE_COLUMNS)
    hermite: Floats  # (4, 3) Bernstein coefficients of the cubic H
    newton: Floats  # (MAX_DEGREE, 3) Newton coefficients of g
    misses: Floats  # (MAX_DEGREE + 1, 3) F - X at the checks, then divided differences of h; a spare row
    bernstein: Floats  # (ROWS,) of one component of g
    corners: Floats  # (2, 3) both ends of a conic


def new_track(si: Ints, sf: Floats, cp: Floats, disc: Floats, strips: int) -> Track:
    """A track for so many strips, yet to be laid (`fit.travel`)."""
    return Track(
        si,
        sf,
        cp,
        disc,
        np.empty((strips, 4), dtype=np.int64),
        np.empty((strips, 4)),
        np.empty(strips, dtype=np.bool_),
        np.empty((strips, 2), dtype=np.int64),
        np.empty((strips, 4)),
    )


def new_scratch() -> Scratch:
    """Room for a call of a kernel."""
    return Scratch(
        np.empty((END_ROWS, END_COLUMNS)),
        np.empty((WAITING, END_COLUMNS)),
        np.empty((MAX_STRIPS, 4)),
        np.empty((SAMPLE_ROWS, SAMPLE_COLUMNS)),
        np.empty((4, 3)),
        np.empty((MAX_DEGREE, 3)),
        np.empty((MAX_DEGREE + 1, 3)),
        np.empty(ROWS),
        np.empty((2, 3)),
    )


@inner
def along(ends: Floats, x: float, y: float, r: float) -> float:
    """tau of a disc on the interval."""
    ux = ends[1, I_X] - ends[0, I_X]
    uy = ends[1, I_X + 1] - ends[0, I_X + 1]
    ur = ends[1, I_X + 2] - ends[0, I_X + 2]
    part = (x - ends[0, I_X]) * ux + (y - ends[0, I_X + 1]) * uy + (r - ends[0, I_X + 2]) * ur
    return part / (ux * ux + uy * uy + ur * ur)


@inner
def sample(track: Track, scratch: Scratch, w: int, s: float, row: int) -> None:
    """Row of `samples` for the true axis point with footpoint s in row w of the way."""
    ends = scratch.ends
    samples = scratch.samples
    site = track.way_i[w, WAY_SITE]
    partner = track.way_i[w, WAY_PARTNER]
    lo = track.way_f[w, WAY_LO]
    hi = track.way_f[w, WAY_HI]
    x, y, r, sj, dx, dy, dr = trace(track.si, track.sf, track.cp, site, s, partner, lo, hi)
    samples[row, 0] = along(ends, x, y, r)
    samples[row, 1] = x
    samples[row, 2] = y
    samples[row, 3] = r
    samples[row, 4] = s
    samples[row, 5] = sj


@inner
def plan(track: Track, scratch: Scratch, spare: int) -> bool:
    """Fill `steps`, where tau runs in each strip of the interval; False when it does not run evenly enough.

    The last strip's sample half way in s stands in row `spare` in any case.
    """
    ends = scratch.ends
    samples = scratch.samples
    steps = scratch.steps
    first = int(ends[0, I_ROW])
    last = int(ends[1, I_ROW])
    even = True
    before = 0.0
    length = 0.0
    for c in range(I_X, I_X + 3):
        length = max(length, abs(ends[1, c] - ends[0, c]))
    least = LEAST_PART if last > first else 0.0
    for w in range(first, last + 1):
        s0 = ends[0, I_S] if w == first else track.way_f[w, WAY_S0]
        s1 = ends[1, I_S] if w == last else track.way_f[w, WAY_S1]
        after = 1.0
        if w < last:
            d = track.strip_i[w, 3]
            after = along(ends, track.disc[d, 0], track.disc[d, 1], track.disc[d, 2])
        sample(track, scratch, w, 0.5 * (s0 + s1), spare)
        half = (samples[spare, 0] - before) / (after - before)
        if not MIN_HALF < half < 1.0 - MIN_HALF or not (after - before) * length > least:
            even = False
        steps[w - first, PLAN_T] = before
        steps[w - first, PLAN_HALF] = half
        steps[w - first, PLAN_S0] = s0
        steps[w - first, PLAN_S1] = s1
        before = after
    return even


@inner
def _share(f: float, half: float) -> float:
    """Share of the way in s where tau is about f, when tau is `half` in the middle."""
    return f * (1.0 - half) / (f * (1.0 - 2.0 * half) + half)


@inner
def sample_at(track: Track, scratch: Scratch, f: float, row: int) -> None:
    """Row of `samples` near tau = f, where the plan puts it."""
    ends = scratch.ends
    steps = scratch.steps
    first = int(ends[0, I_ROW])
    strips = int(ends[1, I_ROW]) - first + 1
    k = 0
    while k < strips - 1 and f >= steps[k + 1, PLAN_T]:
        k += 1
    t0 = steps[k, PLAN_T]
    t1 = steps[k + 1, PLAN_T] if k < strips - 1 else 1.0
    s = steps[k, PLAN_S0] + _share((f - t0) / (t1 - t0), steps[k, PLAN_HALF]) * (steps[k, PLAN_S1] - steps[k, PLAN_S0])
    sample(track, scratch, first + k, s, row)
