"""Where the axis is sampled: strips through one of their sides, intervals of them about evenly along their chord.

A strip is walked by a footpoint s on one side, its way. An interval of the axis may pass several strips; its own parameter tau
is the share of the way along its chord (`interval`). A sample is taken at an s and brings its tau; the *plan* of an interval says
where tau runs in each strip, from the discs between strips and one sample half way, so that s can be told for a wanted tau.
"""

from __future__ import annotations

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

MIN_HALF = 0.02  # tau half way in s, from either end; a sample nearer says little about the other half


@inner
def along(ends: Floats, x: float, y: float, r: float) -> float:
    """tau of a disc on the interval."""
    ux = ends[1, I_X] - ends[0, I_X]
    uy = ends[1, I_X + 1] - ends[0, I_X + 1]
    ur = ends[1, I_X + 2] - ends[0, I_X + 2]
    part = (x - ends[0, I_X]) * ux + (y - ends[0, I_X + 1]) * uy + (r - ends[0, I_X + 2]) * ur
    return part / (ux * ux + uy * uy + ur * ur)


@inner
def sample(
    si: Ints, sf: Floats, cp: Floats, way_i: Ints, way_f: Floats, w: int, s: float, ends: Floats,
    samples: Floats, row: int,
) -> None:
    """Row of `samples` for the true axis point with footpoint s in row w of the way."""
    x, y, r, sj, dx, dy, dr = trace(si, sf, cp, way_i[w, WAY_SITE], s, way_i[w, WAY_PARTNER], way_f[w, WAY_LO], way_f[w, WAY_HI])
    samples[row, 0] = along(ends, x, y, r)
    samples[row, 1] = x
    samples[row, 2] = y
    samples[row, 3] = r
    samples[row, 4] = s
    samples[row, 5] = sj


@inner
def plan(
    si: Ints, sf: Floats, cp: Floats, way_i: Ints, way_f: Floats, disc: Floats, strip_i: Ints, ends: Floats,
    samples: Floats, spare: int, steps: Floats,
) -> bool:
    """Fill `steps`, where tau runs in each strip of the interval; False when it does not run evenly enough.

    The last strip's sample half way in s stands in row `spare` in any case.
    """
    first = int(ends[0, I_ROW])
    last = int(ends[1, I_ROW])
    even = True
    before = 0.0
    for w in range(first, last + 1):
        s0 = ends[0, I_S] if w == first else way_f[w, WAY_S0]
        s1 = ends[1, I_S] if w == last else way_f[w, WAY_S1]
        after = 1.0
        if w < last:
            d = strip_i[w, 3]
            after = along(ends, disc[d, 0], disc[d, 1], disc[d, 2])
        sample(si, sf, cp, way_i, way_f, w, 0.5 * (s0 + s1), ends, samples, spare)
        half = (samples[spare, 0] - before) / (after - before)
        if not MIN_HALF < half < 1.0 - MIN_HALF or not after > before:
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
def sample_at(
    si: Ints, sf: Floats, cp: Floats, way_i: Ints, way_f: Floats, f: float, ends: Floats, samples: Floats,
    row: int, steps: Floats,
) -> None:
    """Row of `samples` near tau = f, where the plan puts it."""
    first = int(ends[0, I_ROW])
    strips = int(ends[1, I_ROW]) - first + 1
    k = 0
    while k < strips - 1 and f >= steps[k + 1, PLAN_T]:
        k += 1
    t0 = steps[k, PLAN_T]
    t1 = steps[k + 1, PLAN_T] if k < strips - 1 else 1.0
    s = steps[k, PLAN_S0] + _share((f - t0) / (t1 - t0), steps[k, PLAN_HALF]) * (steps[k, PLAN_S1] - steps[k, PLAN_S0])
    sample(si, sf, cp, way_i, way_f, first + k, s, ends, samples, row)
