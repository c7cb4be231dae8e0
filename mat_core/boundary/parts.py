"""Parts of a Bezier, with all the digits they can have, and points of it seen from the control point that says most about them.

The numerators N = w (P - Q) of a rational Bezier lose where Q is far from the point: the rounding of Q alone would be a speed. So
all is taken relative to the control point that is near it where its weight is far above the others. Beziers with very uneven
weights are cut into parts that have not, before anything else is asked of them.
"""

from __future__ import annotations

import math

from mat_core.kernels.bernstein import restrict_row
from mat_core.kernels.bezier import balance, unevenness
from mat_core.kernels.curve import bezier_frame
from mat_core.kernels.jit import inner

SHORT = 256.0  # roundings: a part shorter than this has no direction of its own
SMALLEST_PART = 2.0**-40
UNEVEN = 64.0  # ratio of weights up to which the numerator of k' has its signs right
MUCH = 4.0  # times the rounding of a control point by itself; a sum that has lost more is not used
_X, _Y, _W, _X1, _Y1, _W1 = range(6)  # rows of the table


@inner
def nearest_row(cp, c0, deg, rational, s):
    """The row of the control point that says most about the point at s: that is near it where its weight is far above the others.

    Relative to it nothing cancels: where the weight changes fast, the rounding of a far reference would be a speed.
    """
    if not rational or s <= 0.0 or s >= 1.0:
        return c0 if s <= 0.5 else c0 + deg
    low = s <= 0.5
    ratio = s / (1.0 - s) if low else (1.0 - s) / s
    best = c0
    most = 0.0
    factor = 1.0
    for step in range(deg + 1):
        i = c0 + (step if low else deg - step)
        if factor * cp[i, 2] > most:
            most = factor * cp[i, 2]
            best = i
        factor *= ratio * (deg - step) / (step + 1.0)
    return best


@inner
def from_nearest(cp, c0, deg, rational, s):
    """`bezier_frame` relative to the `nearest_row`: a rational curve that stands still at an end has no speed left by rounding.

    Such a rest would be taken for a direction, and what it turns by for a bend.
    """
    near = nearest_row(cp, c0, deg, rational, s)
    return bezier_frame(cp, c0, deg, rational, s, cp[near, 0], cp[near, 1])


@inner
def apart(cp, c0, deg, rational, a, b):
    """Distance of the points at two parameters."""
    near = nearest_row(cp, c0, deg, rational, 0.5 * (a + b) if 0.0 < a < 1.0 else a)
    ax, ay, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, a, cp[near, 0], cp[near, 1])
    bx, by, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, b, cp[near, 0], cp[near, 1])
    return math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))


@inner
def extent(cp, c0, deg):
    """Length of the control polygon, each side measured along x and y."""
    length = 0.0
    for i in range(c0, c0 + deg):
        length += abs(cp[i + 1, 0] - cp[i, 0]) + abs(cp[i + 1, 1] - cp[i, 1])
    return length


@inner
def place_part(cp, c0, deg, rational, begin, end, table, target):
    """(x, y): start of the part [begin, end] of a Bezier; its control points relative to that go to rows target.. of `cp`.

    With numerators N = w (P - Q), Q the `nearest_row`, and S = start - Q, the restricted differences of N and w are summed up:
    control points of a short part, start + (sum dN - S sum dw) / w, keep the digits that restricted N and w would lose. Where the
    weights fall by decades it is the sums that lose them, and the restricted N themselves are better.
    """
    near = nearest_row(cp, c0, deg, rational, begin)
    rx = cp[near, 0]
    ry = cp[near, 1]
    sx = cp[c0, 0] - rx
    sy = cp[c0, 1] - ry
    if begin > 0.0:
        sx, sy, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, begin, rx, ry)
    for i in range(deg + 1):
        w = cp[c0 + i, 2]
        table[_X, i] = w * (cp[c0 + i, 0] - rx)
        table[_Y, i] = w * (cp[c0 + i, 1] - ry)
        table[_W, i] = w
    for i in range(deg):
        table[_X1, i] = table[_X, i + 1] - table[_X, i]
        table[_Y1, i] = table[_Y, i + 1] - table[_Y, i]
        table[_W1, i] = table[_W, i + 1] - table[_W, i]
    restrict_row(table, _W, deg, begin, end)
    restrict_row(table, _X1, deg - 1, begin, end)
    restrict_row(table, _Y1, deg - 1, begin, end)
    restrict_row(table, _W1, deg - 1, begin, end)
    if rational:
        restrict_row(table, _X, deg, begin, end)
        restrict_row(table, _Y, deg, begin, end)
    x = y = more = lost = 0.0
    far = abs(sx) + abs(sy)
    for i in range(deg + 1):
        w = table[_W, i]
        if lost > MUCH * (abs(table[_X, i]) + abs(table[_Y, i]) + w * far):
            cp[target + i, 0] = table[_X, i] / w - sx
            cp[target + i, 1] = table[_Y, i] / w - sy
        else:
            cp[target + i, 0] = (x - sx * more) / w
            cp[target + i, 1] = (y - sy * more) / w
        cp[target + i, 2] = w
        if i < deg:
            x += (end - begin) * table[_X1, i]
            y += (end - begin) * table[_Y1, i]
            more += (end - begin) * table[_W1, i]
            if rational:
                lost += (end - begin) * (abs(table[_X1, i]) + abs(table[_Y1, i]) + far * abs(table[_W1, i]))
    # where control points lie on the end, the curve stands still there: those of the part do so, too, and not but for rounding
    i = deg - 1
    while end == 1.0 and i > 0 and cp[c0 + i, 0] == cp[c0 + deg, 0] and cp[c0 + i, 1] == cp[c0 + deg, 1]:
        cp[target + i, 0] = cp[target + deg, 0]
        cp[target + i, 1] = cp[target + deg, 1]
        i -= 1
    return rx + sx, ry + sy


@inner
def about_nearest(cp, cp_low, c0, deg, begin, target):
    """A Bezier relative to the control point that says most about its point at `begin`, in rows target.. of `cp`."""
    near = nearest_row(cp, c0, deg, 1, begin)
    for i in range(deg + 1):
        for axis in range(2):
            cp[target + i, axis] = (cp[c0 + i, axis] - cp[near, axis]) + (cp_low[c0 + i, axis] - cp_low[near, axis])
        cp[target + i, 2] = cp[c0 + i, 2]


@inner
def even_end(cp, c0, deg, begin, end, table, target, rounding):
    """How far a part from `begin` on may go, up to `end`, until its weights are even; rows target.. are scratch.

    No part is within the rounding of coordinates, however uneven: it would have no direction but by rounding.
    """
    while end - begin > SMALLEST_PART:
        place_part(cp, c0, deg, 1, begin, end, table, target)
        balance(cp, target, deg)
        half = begin + 0.5 * (end - begin)
        if not unevenness(cp, target, deg) > UNEVEN or apart(cp, c0, deg, 1, begin, half) <= SHORT * rounding:
            break
        end = half
    return 1.0 if apart(cp, c0, deg, 1, end, 1.0) <= SHORT * rounding else end
