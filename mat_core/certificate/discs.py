"""Discs of nodes and joints as they were handed in: are they empty, and do they touch where they should?

At a smooth joint the tangents of both pieces may differ a little (by less than the smoothing angle). A normal between
both is as good as either, and such a disc may be reached into by r angle^2; both are granted there, and only there.
"""

from __future__ import annotations

import math

from mat_core.certificate.coverage import owned
from mat_core.certificate.report import DISCS_EMPTY, DISCS_TOUCHING, made, worst
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.judge import depth
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, FAN, KIND, NEXT, PREV, TX0, TX1, TY0, TY1


@inner
def missed(si, sf, i, s, dx, dy, tx, ty, r):
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
    off = missed(t.si, t.sf, i, s, x - disc[d, 0], y - disc[d, 1], tx, ty, disc[d, 2])
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
    inside = depth(t.si, t.sf, t.cp, boxes.order, boxes.box, boxes.walk[0], boxes.work, boxes.binomial, x, y, r,
                   k.contact_site[first], k.contact_s[first], k.contact_site[last], k.contact_s[last])
    worst(figures, DISCS_EMPTY, inside - granted[d] if r >= 0.0 else math.inf, x, y)
