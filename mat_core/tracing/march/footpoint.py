"""Appendix A: the footpoint on the other edge that belongs to a footpoint on this one, and the axis point of both.

With D = C2 - C1, N = (-y', x') and T, n the same of unit length, the normals C1 + N1 alpha and C2 + N2 beta meet where

    alpha = D.C2' / (C1' x C2'),     beta = D.C1' / (C1' x C2')                                                       (A1)

(in print the second line before (A1) has a wrong sign: y1 + x1' alpha it must be, as N says; (A1) follows from the right one).
Equal lengths on the same side, |N1| alpha = |N2| beta, are D.(T2 - T1) = 0. The paper squares this,

    0 = |N1|^2 (D.C2')^2 - |N2|^2 (D.C1')^2  =  |C1'|^2 |C2'|^2  [D.(T2 - T1)] [D.(T2 + T1)],                          (A4)

which lets wrong roots in: those of the second factor, where the circle lies inside one edge and outside the other, and, since
the denominator was multiplied away, T1 = T2 and T1 = -T2, normals that never meet. All go when angles are compared instead. A
chord makes the same angle with a circle at both of its ends:

    h = angle(T1, D) - angle(D, T2) = angle(T2, R),     R = 2 (D.T1) D / |D|^2 - T1      (T1 reflected in D)           (A4')

              R                  The circle through p along T1 turns left by angle(T1, D) twice until it passes q, along R. Both
             /   T2              edges touch it when T2 is R. h = pi: the second edge touches it from inside, T2 is -R.
      p --- q -
       \\ D                       On a piece of monotone curvature h rises through 0 once, where the curvature criterion
        T1                       holds, and falls through 0 once at most, where it does not.

The radius is alpha |N1| = |D|^2 / (2 n1.D), half the chord for opposite normals ("the normals overlap"): no case of its own.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from mat_core.boundary.sites import SiteTable
from mat_core.kernels.curve import evaluate
from mat_core.kernels.layout import V0, V1, X0, X1, Y0, Y1

ROOT_STEPS = 80
ROOT_WIDTH = 2e-16  # of the parameter
ANGLE_ROUNDING = 2e-16  # of h itself
FIRST_REACH = 1e-9  # of the parameter: the first place looked at when nothing is known of the foot's pace
W_ROUNDING = 1e-15  # of W, over |D|
NEAR_JOINT = 1e-3  # of the way left to a joint that both edges share: nearer, the pair has reached it
TURNED = 3.0  # radians; h that falls by more between two places may have passed a half turn, not zero


class AxisPoint(NamedTuple):
    """Centre and radius of a disc, with its footpoints s on the right and on the left site."""

    x: float
    y: float
    r: float
    right: float
    left: float


def origin_of(t: SiteTable, i: int, s: float, j: int) -> tuple[float, float]:
    """Where differences are taken from: the vertex that both sites share and that s is near, else the middle of the domain."""
    begins = t.si[i, V0] in (t.si[j, V0], t.si[j, V1])
    ends = t.si[i, V1] in (t.si[j, V0], t.si[j, V1])
    if begins and not (ends and s > 0.5):
        return float(t.sf[i, X0]), float(t.sf[i, Y0])
    if ends:
        return float(t.sf[i, X1]), float(t.sf[i, Y1])
    return 0.0, 0.0


def defect(tx: float, ty: float, dx: float, dy: float, ux: float, uy: float) -> float:
    """h of (A4'), in (-pi, pi], for the chord D and unit tangents t and u at its start and end."""
    along = 2.0 * (dx * tx + dy * ty)
    dd = dx * dx + dy * dy
    # |D|^2 R: no division where both points meet
    rx = along * dx - dd * tx
    ry = along * dy - dd * ty
    return math.atan2(ux * ry - uy * rx, ux * rx + uy * ry)


def corresponding_footpoint(t: SiteTable, i: int, s: float, j: int, start: float, limit: float, pace: float) -> float | None:
    """The first root of (A4') on site j from `start` towards `limit`, for the footpoint s on site i; None if there is none.

    The previous footpoint, `start`, is the initial guess of the paper; `pace` is how far the root is expected from it. The root
    is bracketed by growing steps, then found by a secant method kept in the bracket (Illinois). On the way from `start` |h| falls
    where W = k |D|^2 + 2 N2.D < 0, and W changes its sign once at most on a piece of monotone curvature: behind the place where
    |h| rises again there is nothing to be found.
    """
    ox, oy = origin_of(t, i, s, j)
    px, py, tx, ty, _, _ = evaluate(t.si, t.sf, t.cp, i, s, ox, oy)
    sign = 1.0 if limit < start else -1.0

    def side(at: float) -> tuple[float, float]:
        qx, qy, ux, uy, k, _ = evaluate(t.si, t.sf, t.cp, j, at, ox, oy)
        dx, dy = qx - px, qy - py
        w = k * (dx * dx + dy * dy) + 2.0 * (dy * ux - dx * uy)
        clear = abs(w) > W_ROUNDING * (abs(dx) + abs(dy))
        return sign * defect(tx, ty, dx, dy, ux, uy), w if clear else 0.0

    a, (fa, fell) = start, side(start)  # fell: the last clear W
    reach = FIRST_REACH
    while fa <= 0.0:
        # where h falls the root is here, but for rounding; beside the joint of an LMPC it rises first
        if fell < 0.0 or a == limit:
            return start
        a = max(start - reach, limit) if sign > 0.0 else min(start + reach, limit)
        fa, fell = side(a)
        reach *= 2.0
    # at a shared joint h says nothing: there is no chord, or one along a straight edge
    qx, qy, *_ = evaluate(t.si, t.sf, t.cp, j, limit, ox, oy)
    if qx == 0.0 and qy == 0.0:
        limit += NEAR_JOINT * (a - limit)
    reach = max(pace, FIRST_REACH)
    past = limit
    while True:
        # halves where h was seen to rise again behind b, else ever longer steps
        b = a - sign * reach if past == limit else 0.5 * (a + past)
        b = max(b, limit) if sign > 0.0 else min(b, limit)
        fb, w = side(b)
        if fb <= 0.0:
            return _between(side, a, fa, b, fb)
        if b in (a, limit) or abs(b - a) <= ROOT_WIDTH:
            return None
        if fell < 0.0 < w:
            past = b
        else:
            a, fa, fell = b, fb, w or fell
            reach *= 2.0


def _between(side, a, fa, b, fb) -> float | None:
    """The root of `side` between a, where it is positive, and b, where it is not; None where it jumps there by a full turn."""
    while fa - fb > TURNED:
        # a sharp corner, where D turns about within a short way, or a jump from -pi to pi
        m = 0.5 * (a + b)
        if abs(b - a) <= ROOT_WIDTH or m in (a, b):
            return None
        fm = side(m)[0]
        if fm > 0.0:
            a, fa = m, fm
        else:
            b, fb = m, fm
    last = 0
    for step in range(ROOT_STEPS):
        if fb == 0.0 or abs(b - a) <= ROOT_WIDTH:
            break
        m = (a * fb - b * fa) / (fb - fa) if step % 8 != 7 else 0.5 * (a + b)
        if not min(a, b) < m < max(a, b):
            m = 0.5 * (a + b)
            if m in (a, b):
                break
        fm = side(m)[0]
        if abs(fm) <= ANGLE_ROUNDING:
            return m
        if fm > 0.0:
            a, fa = m, fm
            if last == 1:
                fb *= 0.5
            last = 1
        else:
            b, fb = m, fm
            if last == -1:
                fa *= 0.5
            last = -1
    return b


def axis_point(t: SiteTable, a: int, right: float, b: int, left: float) -> AxisPoint | None:
    """(A2) for a pair of footpoints: C1 + alpha N1; None if it lies on the wrong side (alpha not positive)."""
    ox, oy = origin_of(t, a, right, b)
    px, py, tx, ty, _, _ = evaluate(t.si, t.sf, t.cp, a, right, ox, oy)
    qx, qy, ux, uy, _, _ = evaluate(t.si, t.sf, t.cp, b, left, ox, oy)
    dx = qx - px
    dy = qy - py
    height = dy * tx - dx * ty
    if not height > 0.0:
        return None
    r = 0.5 * (dx * dx + dy * dy) / height
    # the middle of both: C1 + r n1 and C2 + r n2
    x = ox + 0.5 * (px + qx - r * (ty + uy))
    y = oy + 0.5 * (py + qy + r * (tx + ux))
    return AxisPoint(x, y, r, right, left)
