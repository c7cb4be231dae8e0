"""Rises of the curvature so slight that no disc tells them from none.

      .--.                  .--.      A disc that touches on both sides of a rise bridges it. Where the rise turns by the angle a,
     '    `-._          _.-'    `     a disc of radius r reaches over the boundary there by r a^2 / 8 at most, and if its contacts
              `--.__.--'              are no farther apart than d by no more than d a / 4, the height of a triangle with base d
      bend       rise       bend      and the angles a / 2 at it.

A contact lies where the bend beside the rise has not yet turned back by a. Where either height is less than the rounding of a
coordinate, the leaf of the rise and the branch from it to the disc that is as large as the bends let it be are nothing that
coordinates tell. Rational Beziers whose weights differ by many decades are full of them: branches from radii of 1e-10 across the
domain, between contacts 1e-13 apart.
"""

from __future__ import annotations

import math

from mat_core.boundary.bends import STRAIGHTNESS, TURN, curvature_at, passing, turn_between
from mat_core.boundary.parts import SHORT, apart, from_nearest
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import CP0, DEG, K0, K1, KIND, RATIONAL, SPIRAL, TX0, TX1, TY0, TY1

FAINT_TURN = 5e-8  # radians: r a^2 / 8 <= 1.6e-16 for r <= 1/2, and no disc in a domain of size 1 at most is larger
FAINT_DEPTH = 1.1e-16  # the rounding of a normalised coordinate
LEAST = 1.8  # curvature, of discs larger than that
NEAR = 2.0**-10  # parameter: a rise that reaches so far is judged by this part of it first


@inner
def _turn(ax, ay, bx, by):
    """Angle from direction a to direction b, positive to the left."""
    return math.atan2(ax * by - ay * bx, ax * bx + ay * by)


@inner
def _is_faint(turn, width):
    """Whether no disc sees a rise with this turn that is bridged over this width."""
    return turn <= FAINT_TURN or turn * width <= 4.0 * FAINT_DEPTH


@inner
def before_rise(cp, c0, deg, begin, end, rounding):
    """`end` of a part of a rational Bezier from `begin` on, or where the faint rise begins that it lies in.

    Such a rise has a joint at its peak already: cut anywhere else, too, it would be two, whose pieces tell nothing of each other.
    A part that begins with the rise goes on to its end all the same.
    """
    beyond = min(end + (end - begin), 1.0)
    beside = max(curvature_at(cp, c0, deg, 1, begin), curvature_at(cp, c0, deg, 1, beyond))
    if beside > LEAST or not curvature_at(cp, c0, deg, 1, end) > LEAST:
        return end
    first = passing(STRAIGHTNESS, -LEAST, cp, c0, deg, 1, end, end, begin)[1]
    if apart(cp, c0, deg, 1, begin, first) <= SHORT * rounding:
        return end
    last = passing(STRAIGHTNESS, -LEAST, cp, c0, deg, 1, end, end, beyond)[1]
    turn = turn_between(cp, c0, deg, 1, first, last)
    back = passing(TURN, turn, cp, c0, deg, 1, first, first, begin)[1]
    on = passing(TURN, turn, cp, c0, deg, 1, last, last, beyond)[1]
    return first if _is_faint(turn, apart(cp, c0, deg, 1, back, on)) else end


@inner
def _rise(si, sf, cp, i, side):
    """(turn, parameter): by how much piece i turns up to its end `side`, where it is curved by more than `LEAST`; from where on.

    The turn is infinite where the rise is plain, or all of the piece belongs to it.
    """
    at = float(side)
    if not sf[i, K0 + side] > LEAST or si[i, KIND] != SPIRAL:
        return 0.0, at
    if not sf[i, K1 - side] <= LEAST:
        return math.inf, at
    c0 = si[i, CP0]
    deg = si[i, DEG]
    rational = si[i, RATIONAL]
    near = 1.0 - NEAR if side == 1 else NEAR
    k = curvature_at(cp, c0, deg, rational, near)
    width = apart(cp, c0, deg, rational, at, near)
    if k > LEAST and not _is_faint(k * width, width):
        return math.inf, at
    begin = passing(STRAIGHTNESS, -LEAST, cp, c0, deg, rational, at, at, 1.0 - at)[1]
    x, y, x1, y1, x2, y2 = from_nearest(cp, c0, deg, rational, begin)
    return abs(_turn(x1, y1, sf[i, TX0 + 2 * side], sf[i, TY0 + 2 * side])), begin


@inner
def _width(si, cp, i, side, begin, turn):
    """How far from its end `side` piece i has turned by this much beyond the parameter `begin`; inf if it does not."""
    if si[i, KIND] != SPIRAL:
        return math.inf
    c0 = si[i, CP0]
    deg = si[i, DEG]
    rational = si[i, RATIONAL]
    at = float(side)
    back = passing(TURN, turn, cp, c0, deg, rational, begin, begin, 1.0 - at)[1]
    return apart(cp, c0, deg, rational, at, back) if back != 1.0 - at else math.inf


@inner
def _rises_faintly(si, sf, cp, a, b, side):
    """Whether the curvature is above `LEAST` at one side of the joint of pieces a and b (side 1: of a, 0: of b), but faintly.

    Where the joint is a reflex vertex and turns by more than that, the discs touch the vertex itself on the other side.
    """
    i = a if side == 1 else b
    j = b if side == 1 else a
    own, own_from = _rise(si, sf, cp, i, side)
    if own == 0.0 or own == math.inf:
        return False
    turn = _turn(sf[a, TX1], sf[a, TY1], sf[b, TX0], sf[b, TY0])
    if -turn > own:
        return _is_faint(own, _width(si, cp, i, side, own_from, own))
    other, other_from = _rise(si, sf, cp, j, 1 - side)
    rise = own + other + max(turn, 0.0)
    if rise <= FAINT_TURN or rise == math.inf:
        return rise <= FAINT_TURN
    return _is_faint(rise, _width(si, cp, i, side, own_from, rise) + _width(si, cp, j, 1 - side, other_from, rise))


@inner
def flatten_rises(si, sf, cp, base, n):
    """Take what is above `LEAST` from the curvatures that rise faintly, at the joints of a loop's n pieces, in rows `base` on."""
    for p in range(n):
        a = base + (p if p > 0 else n) - 1
        b = base + p
        left = sf[a, K1] > LEAST and _rises_faintly(si, sf, cp, a, b, 1)
        right = sf[b, K0] > LEAST and _rises_faintly(si, sf, cp, a, b, 0)
        if left:
            sf[a, K1] = LEAST
        if right:
            sf[b, K0] = LEAST
