"""The certificate's own way to a maximal disc: a ball tangent at a footpoint shrinks until it touches another site.

r <- |D|^2 / (2 n.D),   D = q - p,   q = foot of p + r n on the other site   (converges quadratically)
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.judge_foot import foot
from mat_core.kernels.layout import KIND, SPIRAL, V0, V1, X0, X1, Y0, Y1

BESIDE = 1e-15  # a foot this near to the footpoint is the same point
POINTS = 8  # of the other side through which a first ball is laid,
ROUNDS = 4  # times, each among the neighbours of the best one so far
BALL_STEPS = 40  # of the shrinking ball; five are usual
BALL_SETTLED = 1e-14  # relative change of the radius that ends the iteration
GROWTHS = 12  # doublings of the first radius until the ball meets the other side
FIRST_RADIUS = 1e-3  # where none is known
LARGEST = 1.0  # no disc in a domain of size at most 1 has a radius over 1/2


@inner
def _common_vertex(si, sf, i, s, j, x, y):
    """The point that distances between (i, s) and site j are best taken from: a vertex of both, else (x, y)."""
    start = si[j, V0] == si[i, V0] or si[j, V1] == si[i, V0]
    end = si[j, V0] == si[i, V1] or si[j, V1] == si[i, V1]
    if end and (s > 0.5 or not start):
        return sf[i, X1], sf[i, Y1]
    if start:
        return sf[i, X0], sf[i, Y0]
    return x, y


@inner
def _through_points(si, sf, cp, ax, ay, tx, ty, ox, oy, j, lo, hi, r, s):
    """(r, s): the ball tangent at a through the best of some points of site j, and of more about that one; as given without any.

    It is not too small. Its foot is so near to s that steps of Newton lead there: from farther off they may pass over the place
    where the distance is largest, and end at another foot, behind the tangent.
    """
    best = 0.0
    begin = lo
    end = hi
    for _ in range(ROUNDS):
        pace = (end - begin) / POINTS
        for point in range(POINTS):
            at = begin + (point + 0.5) * pace
            bx, by, vx, vy, k, speed = evaluate(si, sf, cp, j, at, ox, oy)
            dx = bx - ax
            dy = by - ay
            ahead = 2.0 * (tx * dy - ty * dx)
            if ahead > best * (dx * dx + dy * dy):
                best = ahead / (dx * dx + dy * dy)
                s = at
        if best == 0.0:
            return r, s
        begin = max(lo, s - pace)
        end = min(hi, s + pace)
    return 1.0 / best, s


@inner
def ball(si, sf, cp, i, s_i, px, py, tx, ty, j, lo, hi, first, guess, thorough):
    """(r, s, x, y, tx, ty): the disc tangent at s_i on site i, with frame p, t, that touches [lo, hi] of site j.

    `first`, `guess`: a radius and a foot to begin with. r = inf if there is none; the rest is the foot on j, its place and
    tangent. The foot found may be a local one, the disc then too large, unless the search is `thorough`.
    """
    ox, oy = _common_vertex(si, sf, i, s_i, j, px, py)
    ax, ay, vx, vy, k, speed = evaluate(si, sf, cp, i, s_i, ox, oy)
    r = first if first > 0.0 else FIRST_RADIUS
    s = guess
    growths = 0
    qx = qy = ux = uy = 0.0
    thorough = thorough and si[j, KIND] == SPIRAL
    if thorough:
        r, s = _through_points(si, sf, cp, ax, ay, tx, ty, ox, oy, j, lo, hi, r, s)
    for step in range(BALL_STEPS):
        # of the local feet that the last one, both ends and the middle lead to, the one that allows the smallest ball
        new = math.inf
        last = s
        for attempt in range(4 if thorough and step < 2 else 1):
            guess = last if attempt == 0 else lo + 0.5 * (attempt - 1) * (hi - lo)
            at = foot(si, sf, cp, j, lo, hi, px - r * ty, py + r * tx, guess)[1]
            bx, by, vx, vy, k, speed = evaluate(si, sf, cp, j, at, ox, oy)
            dx = bx - ax
            dy = by - ay
            ahead = 2.0 * (tx * dy - ty * dx)
            # (a foot at the vertex of both sites is none, whatever a handle of a few roundings makes of its direction)
            if ahead * min(new, LARGEST) > dx * dx + dy * dy > BESIDE * BESIDE:
                new = (dx * dx + dy * dy) / ahead
                s = at
                qx = dx
                qy = dy
                ux = vx
                uy = vy
        if new == math.inf:
            # nothing met yet, or only the footpoint itself, where both sites end: begin with a larger ball
            growths += 1
            if growths > GROWTHS:
                r = math.inf
                break
            r *= 2.0
            continue
        settled = abs(new - r) <= BALL_SETTLED * new
        r = new
        if settled:
            break
    return r, s, px + qx, py + qy, ux, uy
