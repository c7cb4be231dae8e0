"""The plan of an interval: where tau runs in each strip it passes, so that s can be told for a wanted tau.

It is made from the discs between strips and one sample half way in s in each. That sample also tells how far the axis is from the
cubic through both ends, from which the degree is chosen (`stretch`); and where the partner is half way, from which it is guessed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.polynomial import cubic_miss
from mat_core.curves.way import (
    I_ROW,
    I_S,
    I_SJ,
    I_X,
    PLAN_HALF,
    PLAN_S0,
    PLAN_S1,
    PLAN_SJ0,
    PLAN_SJ1,
    PLAN_SJ_HALF,
    PLAN_T,
    SPARE,
    WAY_S0,
    WAY_S1,
    Scratch,
    Track,
    along,
    draw_chord,
    partner_end,
    sample,
)
from mat_core.kernels.jit import inner

Floats = NDArray[np.float64]

LEAST_PART = 1e-11  # an interval's part in one of several strips that is shorter has no parameters of its own in a segment
MIN_HALF = 0.02  # tau half way in s, from either end; a sample nearer says little about the other half


@inner
def plan(track: Track, scratch: Scratch) -> tuple[bool, float]:
    """Fill `steps`, where tau runs in each strip of the interval: (whether it runs evenly enough, error of the cubic H alone).

    The last strip's sample half way in s stands in the spare row in any case. The error is told from such samples, by the
    largest of their divided differences.
    """
    ends = scratch.ends
    samples = scratch.samples
    steps = scratch.steps
    first = int(ends[0, I_ROW])
    last = int(ends[1, I_ROW])
    draw_chord(scratch)
    even = True
    off = 0.0
    before = 0.0
    length = 0.0
    for c in range(I_X, I_X + 3):
        length = max(length, abs(ends[1, c] - ends[0, c]))
    least = LEAST_PART if last > first else 0.0
    for w in range(first, last + 1):
        s0 = ends[0, I_S] if w == first else track.way_f[w, WAY_S0]
        s1 = ends[1, I_S] if w == last else track.way_f[w, WAY_S1]
        sj0 = ends[0, I_SJ] if w == first else partner_end(track, w, 0)
        sj1 = ends[1, I_SJ] if w == last else partner_end(track, w, 1)
        after = 1.0
        if w < last:
            d = track.strip_i[w, 3]
            after = along(ends, scratch.chord, track.disc[d, 0], track.disc[d, 1], track.disc[d, 2])
        sample(track, scratch, w, 0.5 * (s0 + s1), 0.5 * (sj0 + sj1), SPARE)
        t = samples[SPARE, 0]
        half = (t - before) / (after - before)
        if not MIN_HALF < half < 1.0 - MIN_HALF or not (after - before) * length > least:
            even = False
        else:
            off = max(off, cubic_miss(scratch, SPARE) * (0.25 / (t * (1.0 - t))) ** 2)
        steps[w - first, PLAN_T] = before
        steps[w - first, PLAN_HALF] = half
        steps[w - first, PLAN_S0] = s0
        steps[w - first, PLAN_S1] = s1
        steps[w - first, PLAN_SJ0] = sj0
        steps[w - first, PLAN_SJ1] = sj1
        come = (samples[SPARE, 5] - sj0) / (sj1 - sj0) if sj1 != sj0 else 0.5
        steps[w - first, PLAN_SJ_HALF] = min(max(come, MIN_HALF), 1.0 - MIN_HALF)
        before = after
    return even, off


@inner
def _share(f: float, half: float) -> float:
    """Share of the way in s where tau is about f, when tau is `half` in the middle."""
    return f * (1.0 - half) / (f * (1.0 - 2.0 * half) + half)


@inner
def _partner_near(steps: Floats, k: int, share: float) -> float:
    """About the partner's s at a share of the way in s through strip k of the interval; inverts `_share`."""
    half = steps[k, PLAN_SJ_HALF]
    come = share * half / (share * (2.0 * half - 1.0) + 1.0 - half)
    return steps[k, PLAN_SJ0] + come * (steps[k, PLAN_SJ1] - steps[k, PLAN_SJ0])


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
    share = _share((f - t0) / (t1 - t0), steps[k, PLAN_HALF])
    s = steps[k, PLAN_S0] + share * (steps[k, PLAN_S1] - steps[k, PLAN_S0])
    sample(track, scratch, first + k, s, _partner_near(steps, k, share), row)


@inner
def sample_planned(track: Track, scratch: Scratch, k: int, s: float, row: int) -> None:
    """Row of `samples` at s in strip k of the interval."""
    steps = scratch.steps
    share = (s - steps[k, PLAN_S0]) / (steps[k, PLAN_S1] - steps[k, PLAN_S0])
    sample(track, scratch, int(scratch.ends[0, I_ROW]) + k, s, _partner_near(steps, k, share), row)
