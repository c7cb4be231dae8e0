"""The axis point for a footpoint on one side, when about where its partner is on the other one is known.

`trace` finds the partner from nothing. Along a strip it moves smoothly, so a guess from its neighbours is near it, and Newton's
method on psi, the angle of the inverted tangent (`kernels.disc`), goes from there.

Where it ends is known to be right: phi has one interior maximum on a piece of monotone curvature at most, so a zero of psi at
which phi has a maximum is *the* maximum, wherever the guess was. What is left is that an end of the piece may lie deeper in the
disc. Any doubt is left to `trace`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.curve import evaluate, site_frame
from mat_core.kernels.disc import origin_end, touch_circular, touch_fan
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import FAN, KIND, SPIRAL, X0, X1, Y0, Y1, SiteInts
from mat_core.kernels.spiral import FLAT, summit
from mat_core.tracing.strip import trace

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEAR = 3e-6  # a step this short, in s, is the last one: what the next would change is its square, and phi by the square of that


@inner
def disc_beside(
    si: SiteInts, sf: Floats, cp: Floats, i: int, s: float, j: int, lo: float, hi: float, guess: float, ends: Floats, row: int
) -> tuple[float, float, float, float]:
    """(x, y, r, s_j): the axis point with footpoint s on site i and its partner, near `guess`, in [lo, hi] of site j.

    Row `row` of `ends`: x, y of site j at lo, x, y at hi; it and the guess are of no account but for a SPIRAL.
    """
    at_start = origin_end(si, i, j, s <= 0.5) == 0
    ox = sf[i, X0] if at_start else sf[i, X1]
    oy = sf[i, Y0] if at_start else sf[i, Y1]
    if si[i, KIND] == SPIRAL and 0.0 < s < 1.0:
        dpx, dpy, tx, ty, x2, y2 = site_frame(si, sf, cp, i, s, ox, oy)
        speed = math.sqrt(tx * tx + ty * ty)
        tx /= speed
        ty /= speed
    else:
        dpx, dpy, tx, ty, k, speed = evaluate(si, sf, cp, i, s, ox, oy)
    kind = si[j, KIND]
    if kind == SPIRAL:
        phi, sj = summit(si, sf, cp, j, lo, hi, guess, ox, oy, dpx, dpy, -ty, tx, NEAR)
    elif kind == FAN:
        phi, sj = touch_fan(sf, j, lo, hi, ox, oy, dpx, dpy, -ty, tx)
    else:
        phi, sj = touch_circular(si, sf, cp, j, lo, hi, ox, oy, dpx, dpy, -ty, tx)
    if 0.0 < phi < math.inf:
        r = 1.0 / phi
        x = ox + dpx - r * ty
        y = oy + dpy + r * tx
        if kind != SPIRAL:
            return x, y, r, sj
        ax = ends[row, 0] - x
        ay = ends[row, 1] - y
        bx = ends[row, 2] - x
        by = ends[row, 3] - y
        least = r * r * (1.0 - FLAT)
        if ax * ax + ay * ay >= least and bx * bx + by * by >= least:
            return x, y, r, sj
    x, y, r, sj, dx, dy, dr = trace(si, sf, cp, i, s, j, lo, hi)
    return x, y, r, sj
