"""Where the axis is sampled: strips through one of their sides, intervals of them about evenly along their chord.

A strip is walked by a footpoint s on one side, its way. An interval of the axis may pass several strips; its own parameter tau
is the share of the way along its chord (`interval`). A sample is taken at an s and brings its tau; the *plan* of an interval says
where tau runs in each strip, from the discs between strips and one sample half way, so that s can be told for a wanted tau.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import SiteInts
from mat_core.memory import maker
from mat_core.tracing.partner import disc_beside

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# an end of an interval: s, x, y, r, tangent, row of the way, partner's s. Rows of `ends`: start and end of the interval, the end
# of a piece that will do; of `waiting`: ends that were too far
I_S, I_X, I_TX, I_ROW, I_SJ = 0, 1, 4, 7, 8
END_ROWS, END_COLUMNS, WAITING = 3, 9, 128

# the way: where a strip is sampled. way_i: site of s, site of its partner; way_f: s at both ends, the partner's range
WAY_SITE, WAY_PARTNER = range(2)
WAY_S0, WAY_S1, WAY_LO, WAY_HI = range(4)

# samples: tau, x, y, r, s, partner's s
SAMPLE_COLUMNS = 6

# the plan of an interval, a row for each strip it passes: tau and s at its start, tau half way in s, s at its end; the partner's
# s at its start and end, and the share of its way half way in s
PLAN_T, PLAN_HALF, PLAN_S0, PLAN_S1, PLAN_SJ0, PLAN_SJ1, PLAN_SJ_HALF = range(7)
PLAN_COLUMNS = 7
MAX_STRIPS = 12  # strips that one interval may pass

MAX_DEGREE = 9  # of a polynomial: some readers of DXF take splines of degree 10 at most
ROWS = MAX_DEGREE + 1  # control points kept for a piece

# rows of samples: 0 .. m - 1 nodes, from m on m + 1 checks, two more near the ends; one spare
MOST_NODES = MAX_DEGREE - 3
SAMPLE_ROWS = 2 * MOST_NODES + 4
SPARE = SAMPLE_ROWS - 1
SPARE_MISS = MAX_DEGREE  # row of misses that is no check's


class Track(NamedTuple):
    """What curves are led along: sites, and strips in order and direction of travel with the way through each."""

    si: SiteInts
    sf: Floats
    cp: Floats
    disc: Floats  # (D, 3) x, y, r
    strip_i: Ints  # (W, 4) right site, left site, disc at the start, at the end
    strip_s: Floats  # (W, 4) s on the right site at both ends, on the left site at both ends
    joined: NDArray[np.bool_]  # (W,) the strip goes on where the one before ends, along one analytic curve on either side
    way_i: Ints  # (W, 2) WAY_SITE, WAY_PARTNER
    way_f: Floats  # (W, 4) WAY_S0 .. WAY_HI
    partner_ends: Floats  # (W, 4) x, y of the partner where its range begins and ends; of ways through strips that are fitted


class Scratch(NamedTuple):
    """Room for one interval: made once, written over and over."""

    ends: Floats  # (END_ROWS, END_COLUMNS)
    waiting: Floats  # (WAITING, END_COLUMNS)
    chord: Floats  # (3,) from the interval's start to its end, divided by its squared length: tau is a product with it
    steps: Floats  # (MAX_STRIPS, PLAN_COLUMNS) the plan
    samples: Floats  # (SAMPLE_ROWS, SAMPLE_COLUMNS)
    hermite: Floats  # (4, 3) Bernstein coefficients of the cubic H
    newton: Floats  # (MAX_DEGREE, 3) Newton coefficients of g
    misses: Floats  # (MAX_DEGREE + 1, 3) F - X at the checks, then divided differences of h; a spare row
    bernstein: Floats  # (ROWS,) of one component of g
    corners: Floats  # (2, 3) both ends of a conic


def new_track(si: SiteInts, sf: Floats, cp: Floats, disc: Floats, strips: int) -> Track:
    """A track for so many strips, yet to be laid (`fit.travel`)."""
    make = maker(strips)
    return Track(
        si,
        sf,
        cp,
        disc,
        make((strips, 4), np.int64),
        make((strips, 4)),
        make(strips, np.bool_),
        make((strips, 2), np.int64),
        make((strips, 4)),
        make((strips, 4)),
    )


def new_scratch() -> Scratch:
    """Room for a call of a kernel."""
    return Scratch(
        np.empty((END_ROWS, END_COLUMNS)),
        np.empty((WAITING, END_COLUMNS)),
        np.empty(3),
        np.empty((MAX_STRIPS, PLAN_COLUMNS)),
        np.empty((SAMPLE_ROWS, SAMPLE_COLUMNS)),
        np.empty((4, 3)),
        np.empty((MAX_DEGREE, 3)),
        np.empty((MAX_DEGREE + 1, 3)),
        np.empty(ROWS),
        np.empty((2, 3)),
    )


@inner
def draw_chord(scratch: Scratch) -> None:
    """Fill `chord` for the interval between both ends."""
    ends = scratch.ends
    chord = scratch.chord
    dd = 0.0
    for c in range(3):
        chord[c] = ends[1, I_X + c] - ends[0, I_X + c]
        dd += chord[c] * chord[c]
    for c in range(3):
        chord[c] /= dd


@inner
def along(ends: Floats, chord: Floats, x: float, y: float, r: float) -> float:
    """tau of a disc on the interval."""
    return (x - ends[0, I_X]) * chord[0] + (y - ends[0, I_X + 1]) * chord[1] + (r - ends[0, I_X + 2]) * chord[2]


@inner
def partner_end(track: Track, w: int, end: int) -> float:
    """The partner's s where the way starts (0) or ends (1) in row w: a right side is passed upwards, a left one downwards."""
    upwards = track.way_i[w, WAY_PARTNER] == track.strip_i[w, 0]
    return track.way_f[w, WAY_HI if upwards == (end == 1) else WAY_LO]


@inner
def place_partner(track: Track, w: int) -> None:
    """Note where the partner's range begins and ends in row w of the way."""
    for end in range(2):
        s = track.way_f[w, WAY_HI if end else WAY_LO]
        x, y, tx, ty, k, speed = evaluate(track.si, track.sf, track.cp, track.way_i[w, WAY_PARTNER], s, 0.0, 0.0)
        track.partner_ends[w, 2 * end] = x
        track.partner_ends[w, 2 * end + 1] = y


@inner
def sample(track: Track, scratch: Scratch, w: int, s: float, guess: float, row: int) -> None:
    """Row of `samples` for the true axis point with footpoint s in row w of the way; the partner's s is near a guess."""
    samples = scratch.samples
    site = track.way_i[w, WAY_SITE]
    partner = track.way_i[w, WAY_PARTNER]
    lo = track.way_f[w, WAY_LO]
    hi = track.way_f[w, WAY_HI]
    x, y, r, sj = disc_beside(track.si, track.sf, track.cp, site, s, partner, lo, hi, guess, track.partner_ends, w)
    samples[row, 0] = along(scratch.ends, scratch.chord, x, y, r)
    samples[row, 1] = x
    samples[row, 2] = y
    samples[row, 3] = r
    samples[row, 4] = s
    samples[row, 5] = sj
