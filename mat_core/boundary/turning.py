"""By how much the boundary turns at a joint, and whether that means a vertex."""

from __future__ import annotations

import math

from mat_core.boundary.joints import CUSP_ANGLE, cusp_is_convex
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import ARC, EDGE, GOES_ON, K0, K1, KIND, LEN, SPAN, TX0, TX1, TY0, TY1, UA, UB

SLIGHT_BEND = 0.01  # of a convex joint over the length of a piece beside it: no disc is bent so little by a hundred times
SAME_BEZIER = 0.1  # radians; a Bezier turns by less where it is cut, and a spline at a knot, but at a cusp
UNCERTAIN = 2.0  # roundings over its length by which the tangent of a piece may be wrong


@inner
def _bezier_length(si, sf, base, n, p, step):
    """Length of the Bezier that site base + p is cut from, from one end of the site on, in steps of 1 or -1."""
    length = sf[base + p, LEN]
    for k in range(1, n):
        a = base + (p + (k - 1) * step) % n
        b = base + (p + k * step) % n
        joined = sf[a, UB] == sf[b, UA] if step > 0 else sf[a, UA] == sf[b, UB]
        if si[a, EDGE] != si[b, EDGE] or si[a, SPAN] != si[b, SPAN] or not joined:
            break
        length += sf[b, LEN]
    return length


@inner
def _smooth_limit(si, sf, base, n, before, after, smooth_angle, rounding):
    """The angle up to which the convex joint of two of the n pieces of a loop is smooth.

    Two tiny sides that meet at a convex angle may be how a curve bends: a disc at one joint would touch what lies beyond the
    next one, as if there were no corner between. So the angle has to be small for the length of both, or their rounding. Sides
    are as long as the Beziers that the pieces are cut from: a noisy one may have a piece of 1e-9 at its end.
    """
    if SLIGHT_BEND * min(sf[base + before, LEN], sf[base + after, LEN]) >= smooth_angle:
        return smooth_angle
    length = min(_bezier_length(si, sf, base, n, before, -1), _bezier_length(si, sf, base, n, after, 1))
    return min(smooth_angle, max(SLIGHT_BEND * length, UNCERTAIN * rounding / length))


@inner
def _has_two_leaves(si, sf, a, b, bend):
    """Whether the curvature is positive and highest at the reflex joint of pieces a and b, so that its fan would part one leaf.

    The osculating disc of the side that is curved less meets the other one 2 bend / (difference of curvatures) from the joint:
    along an arc that is longer than that there is one leaf, the arc's.
    """
    if not (min(sf[a, K1], sf[b, K0]) > 0.0 and sf[a, K1] >= sf[a, K0] and sf[b, K0] >= sf[b, K1]):
        return False
    sharper = a if sf[a, K1] > sf[b, K0] else b
    return si[sharper, KIND] != ARC or 2.0 * bend >= abs(sf[a, K1] - sf[b, K0]) * sf[sharper, LEN]


@inner
def joint_turn(si, sf, cp, base, n, p, smooth_angle, bent_back, rounding):
    """By how much the boundary turns where site base + p of a loop of n begins, radians; 0 where that is smooth.

    A convex joint that turns by no more than `_smooth_limit` is smooth, a reflex one by no more than `bent_back`: a fan has all
    of its normals, and the disc of their mean would be off by radius times angle. But for one leaf a fan would make two.
    """
    a = base + (p if p > 0 else n) - 1
    b = base + p
    turn = math.atan2(sf[a, TX1] * sf[b, TY0] - sf[a, TY1] * sf[b, TX0], sf[a, TX1] * sf[b, TX0] + sf[a, TY1] * sf[b, TY0])
    if math.pi - abs(turn) < CUSP_ANGLE:
        # the curves tell the side, the angle keeps its digits: a fan ends at the next piece's own normal
        if cusp_is_convex(si, sf, cp, a, b):
            return turn if turn > 0.0 else turn + 2.0 * math.pi
        return turn if turn < 0.0 else turn - 2.0 * math.pi
    if n > 1 and abs(turn) < SAME_BEZIER and si[a, EDGE] == si[b, EDGE] and sf[a, UB] == sf[b, UA] and (
            si[a, SPAN] == si[b, SPAN] or si[b, GOES_ON] == 1):
        return 0.0
    if turn < 0.0:
        smooth = -turn <= (smooth_angle if _has_two_leaves(si, sf, a, b, -turn) else bent_back)
    else:
        smooth = turn <= _smooth_limit(si, sf, base, n, a - base, p, smooth_angle, rounding)
    return 0.0 if smooth else turn
