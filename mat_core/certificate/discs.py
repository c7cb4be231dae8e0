"""Discs: those of nodes and joints as they were handed in, and discs inside every strip found anew by a shrinking ball.

A disc tangent to the boundary at p and q that holds no boundary point inside is the maximal disc at p, and the one at
q; there is no other. So a partner is confirmed from one side by growing the disc tangent at p until it touches the
other side of the strip, and asking all of the boundary whether it reaches into it:

    r <- |D|^2 / (2 n.D),   D = q - p,   q = foot of p + r n on the other side   (converges quadratically)

Why a few discs are enough for a strip: cutting a domain along maximal discs leaves sub-domains whose axes have nothing
to do with each other (Choi, Choi, Moon 1997). When the discs at both ends of a strip are empty and touch where they
should, and nothing else lies between their footpoints (coverage), the sub-domain in between has just two sides, and
neither can be its own partner, because its curvature is monotone (Vogt). Discs inside confirm what then cannot be
otherwise, and would show a piece whose curvature is not monotone.

At a smooth joint the tangents of both pieces may differ a little (by less than the smoothing angle). A normal between
both is as good as either, and such a disc may be reached into by r angle^2; both are granted there, and only there.
"""

from __future__ import annotations

import math

from mat_core.certificate.coverage import owned
from mat_core.certificate.report import DISCS_EMPTY, DISCS_TOUCHING, PARTNERS_LEFT, PARTNERS_RIGHT, made, worst
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.judge import CLOSE, depth
from mat_core.kernels.judge_ball import ball
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, FAN, KIND, LEN, NEXT, PREV, SWEEP, TX0, TX1, TY0, TY1

SAMPLES = (0.44, 0.59)  # where in a strip, on its right and on its left side, discs are found anew
SAME_DISC = 1e-9  # a strip between discs nearer than this has no inside to look at
NO_SIDE = 1e-11  # nor is there anything to start from on a side shorter than this, unless both are


@inner
def _missed(si, sf, i, s, dx, dy, tx, ty, r):
    """Distance of a disc's centre from foot + r n, for a foot at s on site i with tangent t; d: the foot from the centre.

    At a smooth joint any normal between those of both pieces will do.
    """
    off = math.sqrt((dx - r * ty) * (dx - r * ty) + (dy + r * tx) * (dy + r * tx))
    at_end = s >= 1.0
    if not at_end and s > 0.0:
        return off
    other = si[i, NEXT] if at_end else si[i, PREV]
    joint = other if at_end else i
    if si[i, KIND] == FAN or si[other, KIND] == FAN or si[joint, CORNER] == CONVEX_VERTEX:
        return off
    ux = sf[other, TX0] if at_end else sf[other, TX1]
    uy = sf[other, TY0] if at_end else sf[other, TY1]
    across = (tx * dx + ty * dy) * (ux * dx + uy * dy) <= 0.0
    if across and tx * ux + ty * uy > 0.0 and tx * dy - ty * dx < 0.0:
        either = abs(math.sqrt(dx * dx + dy * dy) - r)
    else:
        either = math.sqrt((dx - r * uy) * (dx - r * uy) + (dy + r * ux) * (dy + r * ux))
    return either if either < off else off


@inner
def _check_touch(t, disc, d, i, s, turn, angle, figures):
    """One footpoint of disc d; `angle` of the disc grows to what the boundary turns by at the smooth joints of its site."""
    x, y, tx, ty, curvature, speed = evaluate(t.si, t.sf, t.cp, i, s, 0.0, 0.0)
    off = _missed(t.si, t.sf, i, s, x - disc[d, 0], y - disc[d, 1], tx, ty, disc[d, 2])
    worst(figures, DISCS_TOUCHING, off, disc[d, 0], disc[d, 1])
    angle[d] = max(angle[d], turn[i], turn[t.si[i, NEXT]])


@inner
def check_touching(t, k, order, turn, granted, figures):
    """Discs touch at contacts and at both ends of owned intervals; fills what is granted to each one's emptiness."""
    disc = k.disc
    made(figures, DISCS_TOUCHING)
    for d in range(disc.shape[0]):
        granted[d] = 0.0
        for m in range(k.contact_start[d], k.contact_start[d + 1]):
            _check_touch(t, disc, d, k.contact_site[m], k.contact_s[m], turn, granted, figures)
    before = -1
    reached = 0.0
    disc_before = -1
    for place in range(order.shape[0]):
        site, lo, hi, disc_lo, disc_hi = owned(k, order[place])
        # where an interval ends and the next one begins is one footpoint, if all is well
        if lo != reached or site != before or disc_lo != disc_before:
            _check_touch(t, disc, disc_lo, site, lo, turn, granted, figures)
        _check_touch(t, disc, disc_hi, site, hi, turn, granted, figures)
        before = site
        reached = hi
        disc_before = disc_hi
    for d in range(disc.shape[0]):
        granted[d] *= granted[d] * disc[d, 2]


@inner
def check_disc(t, k, d, boxes, granted, figures):
    """A disc handed in is empty."""
    x = k.disc[d, 0]
    y = k.disc[d, 1]
    r = k.disc[d, 2]
    first = min(k.contact_start[d], k.contact_site.shape[0] - 1)
    last = max(k.contact_start[d + 1] - 1, 0)
    inside = depth(t.si, t.sf, t.cp, boxes.order, boxes.box, boxes.stack, boxes.work, boxes.binomial, x, y, r,
                   k.contact_site[first], k.contact_s[first], k.contact_site[last], k.contact_s[last])
    worst(figures, DISCS_EMPTY, inside - granted[d] if r >= 0.0 else math.inf, x, y)


@inner
def _width(t, k, strip, side, radius):
    """Length of a strip's side."""
    i = k.strip_i[strip, side]
    whole = abs(t.sf[i, SWEEP]) * radius if t.si[i, KIND] == FAN else t.sf[i, LEN]
    return whole * abs(k.strip_s[strip, 2 * side + 1] - k.strip_s[strip, 2 * side])


@inner
def check_partners(t, k, strip, boxes, slack, figures):
    """A disc found anew from either side of a strip that has an inside, as far as the side has a length, is empty and touches.

    slack: what is granted to emptiness.
    """
    d0 = k.strip_i[strip, 2]
    d1 = k.strip_i[strip, 3]
    apart = 0.0
    for axis in range(3):
        apart = max(apart, abs(k.disc[d1, axis] - k.disc[d0, axis]))
    s = k.strip_s
    if not apart > SAME_DISC and s[strip, 1] - s[strip, 0] <= 0.5 and s[strip, 2] - s[strip, 3] <= 0.5:
        return
    radius = 0.5 * (k.disc[d0, 2] + k.disc[d1, 2])
    right = _width(t, k, strip, 0, radius)
    left = _width(t, k, strip, 1, radius)
    neither = not right > NO_SIDE and not left > NO_SIDE
    if right > NO_SIDE or neither:
        at = s[strip, 0] + SAMPLES[0] * (s[strip, 1] - s[strip, 0])
        guess = s[strip, 2] + SAMPLES[0] * (s[strip, 3] - s[strip, 2])
        _check_partner(t, k.strip_i[strip, 0], at, k.strip_i[strip, 1], s[strip, 3], s[strip, 2], guess, radius, boxes, slack,
                       PARTNERS_RIGHT, figures)
    if left > NO_SIDE or neither:
        at = s[strip, 3] + SAMPLES[1] * (s[strip, 2] - s[strip, 3])
        guess = s[strip, 1] + SAMPLES[1] * (s[strip, 0] - s[strip, 1])
        _check_partner(t, k.strip_i[strip, 1], at, k.strip_i[strip, 0], s[strip, 0], s[strip, 1], guess, radius, boxes, slack,
                       PARTNERS_LEFT, figures)


@inner
def _check_partner(t, i, s, j, lo, hi, guess, radius, boxes, slack, check, figures):
    """The disc tangent at s on site i that touches [lo, hi] of site j, near `guess` maybe."""
    x, y, tx, ty, curvature, speed = evaluate(t.si, t.sf, t.cp, i, s, 0.0, 0.0)
    cx = x
    cy = y
    inside = off = math.inf
    for attempt in range(2):
        # a disc that is not confirmed was too large, maybe: then all of the other side is searched
        r, at, qx, qy, ux, uy = ball(t.si, t.sf, t.cp, i, s, x, y, tx, ty, j, lo, hi, radius, guess, attempt > 0)
        if not r < math.inf:
            continue
        cx = x - r * ty
        cy = y + r * tx
        inside = depth(t.si, t.sf, t.cp, boxes.order, boxes.box, boxes.stack, boxes.work, boxes.binomial, cx, cy, r, i, s, j, at)
        inside -= slack
        off = _missed(t.si, t.sf, j, at, qx - cx, qy - cy, ux, uy, r)
        if inside <= CLOSE and off <= CLOSE:
            break
    worst(figures, check, inside, cx, cy)
    worst(figures, check, off, cx, cy)
