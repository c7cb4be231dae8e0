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
from typing import NamedTuple

import numpy as np

from mat_core.boundary.sites import SiteTable
from mat_core.certificate.coverage import Owned
from mat_core.certificate.inputs import Discs, Floats, Ints
from mat_core.certificate.report import Report
from mat_core.kernels.jit import jit
from mat_core.kernels.judge import balls
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, FAN, KIND, LEN, NEXT, PREV, SWEEP, TX0, TX1, TY0, TY1
from mat_core.kernels.rows import frames_at

SAMPLES = (0.44, 0.59)  # where in a strip, on its right and on its left side, discs are found anew
SAME_DISC = 1e-9  # a strip between discs nearer than this has no inside to look at
NO_SIDE = 1e-11  # nor is there anything to start from on a side shorter than this, unless both are


class Found(NamedTuple):
    """Discs found anew, first `right` from right sides, then those from left sides.

    strip; disc (n, 3); on the other side the site, s, and the foot's frame x, y, tx, ty.
    """

    right: int
    strip: Ints
    disc: Floats
    other: Ints
    s: Floats
    partner: Floats


@jit
def missed(si, sf, site, s, frame, which, disc, off):
    """Distance of the centre of disc which[n] from foot + r n, for a foot at s on a site with its frame, to off[n].

    At a smooth joint any normal between those of both pieces will do.
    """
    for n in range(site.shape[0]):
        i = site[n]
        r = disc[which[n], 2]
        dx = frame[n, 0] - disc[which[n], 0]
        dy = frame[n, 1] - disc[which[n], 1]
        tx = frame[n, 2]
        ty = frame[n, 3]
        off[n] = math.sqrt((dx - r * ty) * (dx - r * ty) + (dy + r * tx) * (dy + r * tx))
        at_end = s[n] >= 1.0
        if not at_end and s[n] > 0.0:
            continue
        other = si[i, NEXT] if at_end else si[i, PREV]
        joint = other if at_end else i
        if si[i, KIND] == FAN or si[other, KIND] == FAN or si[joint, CORNER] == CONVEX_VERTEX:
            continue
        ux = sf[other, TX0] if at_end else sf[other, TX1]
        uy = sf[other, TY0] if at_end else sf[other, TY1]
        across = (tx * dx + ty * dy) * (ux * dx + uy * dy) <= 0.0
        if across and tx * ux + ty * uy > 0.0 and tx * dy - ty * dx < 0.0:
            either = abs(math.sqrt(dx * dx + dy * dy) - r)
        else:
            either = math.sqrt((dx - r * uy) * (dx - r * uy) + (dy + r * ux) * (dy + r * ux))
        if either < off[n]:
            off[n] = either


def check_touching(t: SiteTable, skeleton: Discs, owned: Owned, turn: Floats, report: Report) -> Floats:
    """Discs touch at contacts and at both ends of owned intervals; returns what is granted to each one's emptiness."""
    disc = skeleton.disc
    owner = np.repeat(np.arange(len(disc)), np.diff(skeleton.contact_start))
    angle = np.zeros(len(disc))
    for site, s, which in (
        (skeleton.contact_site, skeleton.contact_s, owner),
        (owned.site, owned.lo, owned.disc_lo),
        (owned.site, owned.hi, owned.disc_hi),
    ):
        frame = np.empty((len(site), 4))
        frames_at(t.si, t.sf, t.cp, site, s, frame)
        off = np.empty(len(site))
        missed(t.si, t.sf, site, s, frame, which, disc, off)
        report.worst("discs_touching", off, disc[which])
        np.maximum.at(angle, which, np.maximum(turn[site], turn[t.si[site, NEXT]]))
    return disc[:, 2] * angle * angle


def find_anew(t: SiteTable, skeleton: Discs, strips: slice) -> Found:
    """One disc from either side of every strip, among some, that has an inside, as far as the side has a length."""
    disc, strip_i, strip_s = skeleton.disc, skeleton.strip_i[strips], skeleton.strip_s[strips]
    d0 = disc[strip_i[:, 2]]
    d1 = disc[strip_i[:, 3]]
    far = np.abs(d1 - d0).max(axis=1) > SAME_DISC
    long = (strip_s[:, 1] - strip_s[:, 0] > 0.5) | (strip_s[:, 2] - strip_s[:, 3] > 0.5)
    radius = 0.5 * (d0[:, 2] + d1[:, 2])
    side = np.empty((len(strip_i), 2))
    for m in range(2):
        i = strip_i[:, m]
        width = np.where(t.si[i, KIND] == FAN, np.abs(t.sf[i, SWEEP]) * radius, t.sf[i, LEN])
        side[:, m] = width * np.abs(strip_s[:, 2 * m + 1] - strip_s[:, 2 * m])
    has_side = (side > NO_SIDE) | (side.max(axis=1) <= NO_SIDE)[:, None]
    from_right = np.flatnonzero((far | long) & has_side[:, 0])
    from_left = np.flatnonzero((far | long) & has_side[:, 1])
    right = len(from_right)
    rows = np.concatenate((from_right, from_left))
    a0, a1, b1, b0 = strip_s[rows].T
    on_right = np.arange(len(rows)) < right
    site = np.where(on_right, strip_i[rows, 0], strip_i[rows, 1])
    other = np.where(on_right, strip_i[rows, 1], strip_i[rows, 0])
    s = np.where(on_right, a0 + SAMPLES[0] * (a1 - a0), b0 + SAMPLES[1] * (b1 - b0))
    interval = np.where(on_right, (b0, b1, radius[rows]), (a0, a1, radius[rows])).T.copy()
    frame = np.empty((len(rows), 4))
    frames_at(t.si, t.sf, t.cp, site, s, frame)
    found = np.empty((len(rows), 3))
    partner = np.empty((len(rows), 4))
    other_s = np.empty(len(rows))
    balls(t.si, t.sf, t.cp, site, s, frame, other, interval, found, other_s, partner)
    lost = ~(found[:, 2] < np.inf)
    found[lost, :2] = frame[lost, :2]
    return Found(right, strips.start + rows, found, other, other_s, partner)


def check_discs(disc: Floats, depth: Floats, slack: Floats, report: Report) -> None:
    """The discs handed in are empty."""
    report.worst("discs_empty", np.where(disc[:, 2] >= 0.0, depth - slack, np.inf), disc)


def check_partners(t: SiteTable, found: Found, depth: Floats, strip_slack: Floats, report: Report) -> None:
    """The discs found anew are empty and touch the other side of their strip."""
    figure = depth - strip_slack[found.strip]
    off = np.empty(len(figure))
    missed(t.si, t.sf, found.other, found.s, found.partner, np.arange(len(figure)), found.disc, off)
    figure = np.maximum(figure, np.where(np.isfinite(off), off, np.inf))
    report.worst("partners_right", figure[: found.right], found.disc[: found.right])
    report.worst("partners_left", figure[found.right :], found.disc[found.right :])
