"""Ends of intervals: a disc between strips or a sample inside one, with the direction of the axis there."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.curves.way import (
    END_COLUMNS,
    I_ROW,
    I_S,
    I_SJ,
    I_TX,
    I_X,
    WAY_S0,
    WAY_S1,
    WAY_SITE,
    Scratch,
    Track,
    partner_end,
    sample,
)
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import V0, V1

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PARALLEL = 1e-9  # |n1 - n2| below which two normals at one vertex are one


@inner
def tangent(track: Track, a: int, sa: float, b: int, sb: float, r: float, sign: float) -> tuple[float, float, float]:
    """Direction (x, y, r) of the axis at the disc of radius r with contacts sa on the right and sb on the left site.

    `sign` is 1 where a strip leaves, -1 where it arrives; it matters at a centre of curvature only.
    """
    x, y, ax, ay, k, speed = evaluate(track.si, track.sf, track.cp, a, sa, 0.0, 0.0)
    x, y, bx, by, k, speed = evaluate(track.si, track.sf, track.cp, b, sb, 0.0, 0.0)
    # n1 - n2 = (by - ay, ax - bx), turned by -90 degrees
    tx = ax - bx
    ty = ay - by
    length = math.sqrt(tx * tx + ty * ty)
    vertex_a = track.si[a, V0] if sa <= 0.0 else (track.si[a, V1] if sa >= 1.0 else -1)
    vertex_b = track.si[b, V0] if sb <= 0.0 else (track.si[b, V1] if sb >= 1.0 else -2)
    if vertex_a == vertex_b and (r > 0.0 or length <= PARALLEL) or length == 0.0:
        return -sign * ay, sign * ax, sign
    # n1 + n2 is at right angles to that, and the longer one of the two tells the direction to more digits
    ux = -(ay + by)
    uy = ax + bx
    sum_length = math.sqrt(ux * ux + uy * uy)
    if sum_length > length:
        along = sum_length if ux * tx + uy * ty > 0.0 else -sum_length
        tx = ux / along
        ty = uy / along
    else:
        tx /= length
        ty /= length
    return tx, ty, ty * ax - tx * ay


@inner
def _put_end(
    ends: Floats, row: int, w: int, s: float, sj: float, x: float, y: float, r: float, t: tuple[float, float, float]
) -> None:
    """One end of an interval."""
    ends[row, I_S] = s
    ends[row, I_X] = x
    ends[row, I_X + 1] = y
    ends[row, I_X + 2] = r
    ends[row, I_TX] = t[0]
    ends[row, I_TX + 1] = t[1]
    ends[row, I_TX + 2] = t[2]
    ends[row, I_ROW] = w
    ends[row, I_SJ] = sj


@inner
def put_disc(track: Track, w: int, end: int, ends: Floats, row: int) -> None:
    """End of an interval at the disc where the strip of row w starts (0) or ends (1)."""
    d = track.strip_i[w, 2 + end]
    right, left = track.strip_i[w, 0], track.strip_i[w, 1]
    t = tangent(track, right, track.strip_s[w, end], left, track.strip_s[w, 2 + end], track.disc[d, 2], -1.0 if end else 1.0)
    s = track.way_f[w, WAY_S1 if end else WAY_S0]
    _put_end(ends, row, w, s, partner_end(track, w, end), track.disc[d, 0], track.disc[d, 1], track.disc[d, 2], t)


@inner
def put_sample(track: Track, scratch: Scratch, w: int, row: int, ends: Floats, to: int) -> None:
    """End of an interval at a sample in the strip of row w."""
    samples = scratch.samples
    s = samples[row, 4]
    # sampling ends where the disc is right to rounding; directions tell more of where the partner is
    sample(track, scratch, w, s, samples[row, 5], row)
    sj = samples[row, 5]
    right = track.way_i[w, WAY_SITE] == track.strip_i[w, 0]
    t = tangent(track, track.strip_i[w, 0], s if right else sj, track.strip_i[w, 1], sj if right else s, samples[row, 3], 1.0)
    _put_end(ends, to, w, s, sj, samples[row, 1], samples[row, 2], samples[row, 3], t)


@inner
def apart(a: Floats, i: int, b: Floats, j: int) -> float:
    """Distance of two ends in (x, y, r)."""
    dx = a[i, I_X] - b[j, I_X]
    dy = a[i, I_X + 1] - b[j, I_X + 1]
    dr = a[i, I_X + 2] - b[j, I_X + 2]
    return math.sqrt(dx * dx + dy * dy + dr * dr)


@inner
def copy_end(a: Floats, i: int, b: Floats, j: int) -> None:
    """End i of a to row j of b."""
    for c in range(END_COLUMNS):
        b[j, c] = a[i, c]
