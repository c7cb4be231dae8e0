"""How a Bezier bends: by how much it turns, where it stands still, and bends at its ends that no disc tells from the vertex."""

from __future__ import annotations

import math

from mat_core.boundary.joints import end_frame
from mat_core.boundary.parts import SHORT, apart, from_nearest
from mat_core.kernels.jit import inner

IDLE = 1e-6  # where a maximum of the curvature is this near to a joint, both are one leaf,
AT_REST = 1e-12  # radians; if what the curvatures differ by bends it by less than this on the way: tangents are known no better
TRIM = 2e-13  # a bend at an end of an edge that is shorter than this, and tighter, is cut off: no disc tells it from the vertex
UNSEEN = 5e-4  # radians; a triangle with the base 2 TRIM and half of this at both ends is less than 1e-16 high
SHORT_HANDLE = 1e-6  # only a handle shorter than this can make one where the curvature
GENTLE = 1e8  # is less than this at the end
LASTING = 2.0  # times the curvature beyond it: what is curved by no more at an end goes on, and is no bend there
CALM = 0.1  # radians; if it turns by less
HAIRPIN = 1e-3  # radians; what turns by less is no such bend
TIGHT = 1e4  # curvature of a bend that looks like a corner, and root of its ratio to that of what looks straight beside it
SLIGHT = 0.01  # radians; half a turn smaller than this is not cut off
BARELY = 1e-5  # radians; a disc of radius 1/2 reaches over a bend that turns by less by less than 2.5e-11
DISTANCE, TURN, STRAIGHTNESS = range(3)  # what is asked of a point: how far it and its tangent are from another, less curvature
HALVINGS = 60


@inner
def total_turning(cp, c0, deg, rational, begin, end):
    """Sum of the absolute turns of the tangent between nine parameters (pieces here have at most one inflection)."""
    total = 0.0
    px = py = 0.0
    for step in range(9):
        s = begin + 0.125 * step * (end - begin)
        x, y, x1, y1, x2, y2 = from_nearest(cp, c0, deg, rational, s)
        if x1 == 0.0 and y1 == 0.0:
            continue
        if px != 0.0 or py != 0.0:
            total += abs(math.atan2(px * y1 - py * x1, px * x1 + py * y1))
        px = x1
        py = y1
    return total


@inner
def curvature_at(cp, c0, deg, rational, s):
    """Curvature at s; infinite where the Bezier stands still."""
    x, y, x1, y1, x2, y2 = from_nearest(cp, c0, deg, rational, s)
    speed = math.sqrt(x1 * x1 + y1 * y1)
    return (x1 * y2 - y1 * x2) / (speed * speed * speed) if speed > 0.0 else math.inf


@inner
def is_idle(cp, c0, deg, rational, a, b, rounding):
    """Whether the part [a, b] is no piece of its own: it has no direction, or is short and its curvature rests."""
    length = apart(cp, c0, deg, rational, a, b)
    if length < SHORT * rounding:
        return True
    if length > IDLE:
        return False
    return abs(curvature_at(cp, c0, deg, rational, b) - curvature_at(cp, c0, deg, rational, a)) * length <= AT_REST


@inner
def turn_between(cp, c0, deg, rational, a, b):
    """The angle between the tangents at two parameters."""
    x, y, x1, y1, x2, y2 = from_nearest(cp, c0, deg, rational, a)
    u, v, u1, v1, u2, v2 = from_nearest(cp, c0, deg, rational, b)
    return abs(math.atan2(x1 * v1 - y1 * u1, x1 * u1 + y1 * v1))


@inner
def _asked(what, cp, c0, deg, rational, at, s):
    """The distance of the point at s from that at `at`, the turn between them, or how little the Bezier is curved at s."""
    if what == DISTANCE:
        return apart(cp, c0, deg, rational, at, s)
    if what == STRAIGHTNESS:
        return -curvature_at(cp, c0, deg, rational, s)
    return turn_between(cp, c0, deg, rational, at, s)


@inner
def passing(what, limit, cp, c0, deg, rational, at, near, far):
    """Two parameters between which what is `_asked` passes a limit: the last below it, from `near` on, and the first beyond."""
    for _ in range(HALVINGS):
        m = 0.5 * (near + far)
        if _asked(what, cp, c0, deg, rational, at, m) < limit:
            near = m
        else:
            far = m
    return near, far


@inner
def _turn_at_rest(cp, c0, deg, rational, end, s, noise):
    """By how much a Bezier that stands still at an end turns from there to the parameter s."""
    tx, ty, k = end_frame(cp, c0, deg, end == 1, noise)
    x, y, x1, y1, x2, y2 = from_nearest(cp, c0, deg, rational, s)
    return abs(math.atan2(tx * y1 - ty * x1, tx * x1 + ty * y1))


@inner
def _tip(cp, c0, deg, rational, end, roots, n_roots):
    """The last extreme of the curvature, from an end on, that is within `TRIM` of it; -1 if none is."""
    tip = -1
    for step in range(n_roots):
        i = step if end == 0 else n_roots - 1 - step
        if apart(cp, c0, deg, rational, float(end), roots[i]) >= TRIM:
            break
        tip = i
    return tip


@inner
def trimmed(cp, c0, deg, rational, end, roots, n_roots, noise):
    """Where a Bezier begins (end = 0) or ends (end = 1) when a bend there is cut off (`chain.stretch` brings it back).

    Font tools leave handles of a few roundings in any direction: the curve sets out along the handle and turns back at once. So
    does one that stands still there, or hardly moves, where the weights of the next control points differ by decades.
    """
    tip = _tip(cp, c0, deg, rational, end, roots, n_roots)
    p = c0 + deg * end
    q = p + (1 - 2 * end)
    handle = math.sqrt((cp[q, 0] - cp[p, 0]) ** 2 + (cp[q, 1] - cp[p, 1]) ** 2)
    if tip < 0 and handle > SHORT_HANDLE and abs(end_frame(cp, c0, deg, end == 1, noise)[2]) < GENTLE:
        return float(end)
    near = roots[tip] if tip >= 0 else float(end)
    far = 1.0 - end
    beyond = tip + 1 if end == 0 else (tip if tip >= 0 else n_roots) - 1
    if 0 <= beyond < n_roots:
        far = roots[beyond]
    far = passing(DISTANCE, 2.0 * TRIM, cp, c0, deg, rational, float(end), near, far)[1]
    peak = curvature_at(cp, c0, deg, rational, near)
    far_k = curvature_at(cp, c0, deg, rational, far)
    turn = total_turning(cp, c0, deg, rational, min(far, float(end)), max(far, float(end)))
    if handle == 0.0:
        turn = max(turn, _turn_at_rest(cp, c0, deg, rational, end, far, noise))
    lasts = tip < 0 and abs(peak) < LASTING * abs(far_k)
    if turn <= (CALM if lasts else HAIRPIN):
        return float(end)
    # beside a reflex vertex the rest of a convex bend has a leaf of its own: it must be no farther from the vertex, either, but
    # if it turns by so little that no disc, with contacts this near to each other, tells it from none
    if peak > 0.0 and 0.0 < far_k * TRIM < 1.0:
        rest = passing(STRAIGHTNESS, -1.0 / TRIM, cp, c0, deg, rational, float(end), near, far)[1]
        if peak * TRIM < 1.0 or turn_between(cp, c0, deg, rational, rest, far) > UNSEEN:
            far = rest
    return far


@inner
def is_cut_with_peak(cp, c0, deg, rational, end, at, roots, n_roots):
    """Whether what `trimmed` cut off, up to the parameter `at`, is a peak tighter than `TRIM`, and what is left is not."""
    tip = _tip(cp, c0, deg, rational, end, roots, n_roots)
    near = roots[tip] if tip >= 0 else float(end)
    return 0.0 < curvature_at(cp, c0, deg, rational, at) * TRIM < 1.0 <= curvature_at(cp, c0, deg, rational, near) * TRIM


@inner
def _bends_left(cp, c0, deg, rational, end, peak):
    """Whether a Bezier turns to the left by so much, about a peak of its curvature near its end, that discs tell it."""
    far = passing(DISTANCE, 2.0 * TRIM, cp, c0, deg, rational, float(end), float(end), 1.0 - end)[1]
    first = passing(STRAIGHTNESS, 0.0, cp, c0, deg, rational, peak, peak, far)[0]
    last = passing(STRAIGHTNESS, 0.0, cp, c0, deg, rational, peak, peak, float(end))[0]
    return total_turning(cp, c0, deg, rational, min(first, last), max(first, last)) > BARELY


@inner
def extreme_at_end(cp, c0, deg, rational, end, roots, n_roots, k, rounding):
    """What a piece takes for the curvature k at an end of its Bezier, where one more extreme has no room for a piece beside it.

    The highest one is a leaf, at the joint, if enough bends there. Else the lowest one: a piece that falls to it and turns back
    within rounding would be taken for one that rises.
    """
    most = least = k
    peak = float(end)
    for i in range(n_roots):
        if apart(cp, c0, deg, rational, float(end), roots[i]) < SHORT * rounding:
            bend = curvature_at(cp, c0, deg, rational, roots[i])
            least = min(least, bend)
            if bend > most:
                most = bend
                peak = roots[i]
    if max(k, 0.0) < most < math.inf and _bends_left(cp, c0, deg, rational, end, peak):
        return most
    return least if least < 0.0 else k


@inner
def tight_cut(cp, c0, deg, rational, begin, end, rounding):
    """Where half the turn of a part lies behind, if nearly all of it happens in a tight bend at one of its ends; else `end`.

    Cut again and again the parts grow away from the bend as its radius does: the parameter of none has too few digits there.
    A bend within the rounding of coordinates stays in one part with what is beside it: a part of 1e-18 is no side of a disc.
    """
    x, y, ax, ay, bx, by = from_nearest(cp, c0, deg, rational, begin)
    x, y, dx, dy, ex, ey = from_nearest(cp, c0, deg, rational, end)
    first = ax * ax + ay * ay
    last = dx * dx + dy * dy
    if first == 0.0 or last == 0.0:
        return end
    k0 = (ax * by - ay * bx) / (first * math.sqrt(first))
    k1 = (dx * ey - dy * ex) / (last * math.sqrt(last))
    tight = max(abs(k0), abs(k1))
    half = 0.5 * math.atan2(ax * dy - ay * dx, ax * dx + ay * dy)
    if tight < TIGHT or abs(half) < SLIGHT:
        return end
    # where it bends both ways it is straight in between, and the bend is tight if it is for the part's extent
    straight = k0 * k1 <= 0.0 and tight * apart(cp, c0, deg, rational, begin, end) > TIGHT
    if not straight and tight < TIGHT * TIGHT * min(abs(k0), abs(k1)):
        return end
    lo = passing(TURN, abs(half), cp, c0, deg, rational, begin, begin, end)[0]
    if min(apart(cp, c0, deg, rational, begin, lo), apart(cp, c0, deg, rational, lo, end)) < SHORT * rounding:
        return end
    return lo if begin < lo < end else end
