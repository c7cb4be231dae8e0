"""The certificate's own feet: the point of a site nearest to a disc's centre, by bracketed Newton iterations."""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate, pasted_frame
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import ARC, CP0, DEG, FAN, K0, KIND, LINE, RATIONAL, SWEEP, TX0, TY0, X0, X1, Y0, Y1

NEWTON = 60  # steps of the bracketed Newton iterations; halving alone ends in as many
INSET = 1e-3  # a first guess at an end is taken this share of the interval inside
SETTLED = 1e-8  # a Newton step below this squares to rounding
RETRIES = 6  # first guesses for a local foot,
END_RETRIES = 6  # and more beside each end, each this share of the way of the one before from it:
TOWARDS_END = 0.05
CLOSE = 1e-11  # a foot this near to where a disc should touch is the one that was looked for; well below what a check forgives


@inner
def _from_centre(cp, c0, deg, rational, s, x, y):
    """C - c with both derivatives of C; these are taken about the nearer end, or a tiny piece would lose their digits."""
    ox = 0.0 if s <= 0.5 else cp[c0 + deg, 0]
    oy = 0.0 if s <= 0.5 else cp[c0 + deg, 1]
    dx, dy, x1, y1, x2, y2 = pasted_frame(cp, c0, deg, rational, s, ox, oy)
    return dx + (ox - x), dy + (oy - y), x1, y1, x2, y2


@inner
def bezier_foot(cp, c0, deg, rational, lo, hi, x, y, guess):
    """(distance, s): a local minimum of |C(s) - c| on [lo, hi], by bracketed Newton on g = (C - c).C' from a guess."""
    a = lo
    b = hi
    inset = INSET * (hi - lo)
    s = min(max(guess, lo + inset), hi - inset)
    for _ in range(NEWTON):
        dx, dy, x1, y1, x2, y2 = _from_centre(cp, c0, deg, rational, s, x, y)
        g = dx * x1 + dy * y1
        if g > 0.0:
            b = s
        else:
            a = s
        slope = x1 * x1 + y1 * y1 + dx * x2 + dy * y2
        new = s - g / slope if slope > 0.0 else (lo if g > 0.0 else hi)
        if slope > 0.0 and abs(new - s) <= SETTLED:
            if lo <= new <= hi:
                # so short a step lowers |C - c|^2 by g^2 / slope, to rounding: no need to look there
                return math.sqrt(max(dx * dx + dy * dy - g * g / slope, 0.0)), new
            s = min(max(new, lo), hi)
            break
        if a < new < b:
            s = new
            continue
        end = lo if new <= a else hi
        if end == a or end == b:
            # an end that nothing has excluded yet is tried itself before halving
            dx, dy, x1, y1, x2, y2 = _from_centre(cp, c0, deg, rational, end, x, y)
            g = dx * x1 + dy * y1
            if (g >= 0.0) if end == lo else (g <= 0.0):
                return math.sqrt(dx * dx + dy * dy), end
        new = 0.5 * (a + b)
        if abs(new - s) <= 2e-16:
            break
        s = new
    dx, dy, x1, y1, x2, y2 = _from_centre(cp, c0, deg, rational, s, x, y)
    return math.sqrt(dx * dx + dy * dy), s


@inner
def turn_fraction(px, py, qx, qy, sweep):
    """Where direction q stands on a turn from p by `sweep`, as a fraction; ambiguity is cut opposite its middle."""
    angle = math.atan2(px * qy - py * qx, px * qx + py * qy)
    if angle < 0.5 * sweep - math.pi:
        angle += 2.0 * math.pi
    elif angle > 0.5 * sweep + math.pi:
        angle -= 2.0 * math.pi
    return angle / sweep


@inner
def foot(si, sf, cp, i, lo, hi, x, y, guess):
    """(distance, s): the foot of c on [lo, hi] of site i; on a SPIRAL the local one that `guess` leads to."""
    kind = si[i, KIND]
    if kind == LINE:
        lx = sf[i, X1] - sf[i, X0]
        ly = sf[i, Y1] - sf[i, Y0]
        s = ((x - sf[i, X0]) * lx + (y - sf[i, Y0]) * ly) / (lx * lx + ly * ly)
        s = lo if s < lo else (hi if s > hi else s)
        # from the nearer end, which keeps the digits
        dx = (sf[i, X0] - x) + s * lx if s <= 0.5 else (sf[i, X1] - x) - (1.0 - s) * lx
        dy = (sf[i, Y0] - y) + s * ly if s <= 0.5 else (sf[i, Y1] - y) - (1.0 - s) * ly
        return math.sqrt(dx * dx + dy * dy), s
    if kind == ARC:
        k = sf[i, K0]
        vx = k * (x - sf[i, X0]) + sf[i, TY0]
        vy = k * (y - sf[i, Y0]) - sf[i, TX0]
        s = turn_fraction(sf[i, TY0], -sf[i, TX0], vx, vy, sf[i, SWEEP])
    elif kind == FAN:
        dx = x - sf[i, X0]
        dy = y - sf[i, Y0]
        s = turn_fraction(-sf[i, TY0], sf[i, TX0], dx, dy, sf[i, SWEEP])
        s = lo if s < lo else (hi if s > hi else s)
        return math.sqrt(dx * dx + dy * dy), s
    else:
        return bezier_foot(cp, si[i, CP0], si[i, DEG], si[i, RATIONAL], lo, hi, x - sf[i, X0], y - sf[i, Y0], guess)
    s = lo if s < lo else (hi if s > hi else s)
    dx, dy, tx, ty, curvature, speed = evaluate(si, sf, cp, i, s, x, y)
    return math.sqrt(dx * dx + dy * dy), s


@inner
def distance_from(si, sf, cp, i, lo, hi, guess, x, y, r, granted):
    """(off, s): how far a disc is from touching [lo, hi] of site i, |distance of its centre - r|, and the foot.

    A local foot elsewhere is not believed before others were tried, unless it is as near as is granted; `guess` is the parameter
    to begin at.
    """
    if si[i, KIND] == FAN:  # one point, wherever its foot is said to be
        dx = x - sf[i, X0]
        dy = y - sf[i, Y0]
        return abs(math.sqrt(dx * dx + dy * dy) - r), guess
    best = math.inf
    best_s = guess
    for attempt in range(RETRIES):
        distance, s = foot(si, sf, cp, i, lo, hi, x, y, guess)
        off = abs(distance - r)
        if off < best:
            best = off
            best_s = s
        if best <= max(granted, CLOSE):
            return best, best_s
        guess = lo + (attempt + 0.5) / (RETRIES - 1.0) * (hi - lo)
    return _beside_ends(si, sf, cp, i, lo, hi, x, y, r, best, best_s)


@inner
def _beside_ends(si, sf, cp, i, lo, hi, x, y, r, best, best_s):
    """`distance_from` by guesses nearer and nearer to an end: steps from farther inside may all lead elsewhere."""
    for side in range(2):
        way = hi - lo
        for _ in range(END_RETRIES):
            way *= TOWARDS_END
            distance, s = foot(si, sf, cp, i, lo, hi, x, y, lo + way if side == 0 else hi - way)
            if abs(distance - r) < best:
                best = abs(distance - r)
                best_s = s
    return best, best_s
