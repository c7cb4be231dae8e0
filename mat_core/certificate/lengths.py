"""How long a part of a site is, never told too short: the speed of a rational curve may change by decades along it."""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import FAN, KIND, LEN, SPIRAL, SWEEP, X0, X1, Y0, Y1

LONGER = 1.5  # times its chord: no curve is that turns by 1.65 or less, as pieces do (`boundary.pieces`): 1 / cos(0.825) = 1.47


@inner
def length_of_part(t, i, begin, end, radius):
    """No less than the length of a part of site i; on a fan that of the way of the centre of a disc of this radius."""
    if t.si[i, KIND] == FAN:
        return abs(t.sf[i, SWEEP] * (end - begin)) * radius
    if t.si[i, KIND] == SPIRAL:
        return _spiral_length(t, i, begin, end)
    return abs(end - begin) * t.sf[i, LEN]


@inner
def _spiral_length(t, i, begin, end):
    """The same of a spiral, from the chords of its halves.

    Where the directions of a curve lie within an angle a, it is no longer than its chord over cos(a / 2).
    """
    ox = t.sf[i, X0] if begin + end < 1.0 else t.sf[i, X1]
    oy = t.sf[i, Y0] if begin + end < 1.0 else t.sf[i, Y1]
    length = px = py = 0.0
    for step in range(3):
        x, y, tx, ty, curvature, speed = evaluate(t.si, t.sf, t.cp, i, begin + 0.5 * step * (end - begin), ox, oy)
        if step > 0:
            length += math.sqrt((x - px) * (x - px) + (y - py) * (y - py))
        px = x
        py = y
    return LONGER * length
