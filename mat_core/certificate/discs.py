"""Discs: those of nodes and joints as they were handed in, and discs inside every strip found anew by a shrinking ball.

A disc tangent to the boundary at p and q that holds no boundary point inside is the maximal disc at p, and the one at q; there is
no other. So a partner is confirmed from one side by growing the disc tangent at p until it touches the other side of the strip,
and asking all of the boundary whether it reaches into it:

    r <- |D|^2 / (2 n.D),    D = q - p,   q = foot of p + r n on the other side        (falls to the maximal disc, quadratically)

At a smooth joint the tangents of both pieces may differ a little (by less than the smoothing angle). A normal between both is as
good as either, and such a disc may be reached into by r angle^2; both are granted there, and only there.
"""

from __future__ import annotations

import math

from mat_core.certificate.report import DISCS_EMPTY, DISCS_TOUCHING, PARTNERS_LEFT, PARTNERS_RIGHT, note
from mat_core.kernels.jit import jit
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, FAN, KIND, NEXT, PREV, TX0, TX1, TY0, TY1

RIGHT_SAMPLE, LEFT_SAMPLE = 0.44, 0.59  # where inside a strip discs are found anew


@jit
def _missed(si, sf, i, s, dx, dy, tx, ty, r):
    """Distance of a disc's centre from foot + r n, for a foot at s on site i with tangent t, (dx, dy) away from the centre.

    At a smooth joint any normal between those of both pieces will do.
    """
    off = math.hypot(dx - r * ty, dy + r * tx)
    if 0.0 < s < 1.0 or si[i, KIND] == FAN:
        return off
    at_end = s >= 1.0
    other = si[i, NEXT] if at_end else si[i, PREV]
    joint = other if at_end else i
    if si[other, KIND] == FAN or si[joint, CORNER] == CONVEX_VERTEX:
        return off
    ux = sf[other, TX0] if at_end else sf[other, TX1]
    uy = sf[other, TY0] if at_end else sf[other, TY1]
    between = (tx * dx + ty * dy) * (ux * dx + uy * dy) <= 0.0 and tx * ux + ty * uy > 0.0 and tx * dy - ty * dx < 0.0
    return min(off, abs(math.hypot(dx, dy) - r) if between else math.hypot(dx - r * uy, dy + r * ux))


@jit
def check_touching(si, sf, turn, disc, place_i, place_s, place_disc, frame, count, disc_slack, report):
    """Discs touch at their contacts and at the ends of their strips: the first `count` places.

    Fills disc_slack (D,): what is granted to emptiness because of joints that are not quite smooth.
    """
    for d in range(disc.shape[0]):
        disc_slack[d] = 0.0
    for n in range(count):
        i = place_i[n]
        d = place_disc[n]
        x = disc[d, 0]
        y = disc[d, 1]
        off = _missed(si, sf, i, place_s[n], frame[n, 0] - x, frame[n, 1] - y, frame[n, 2], frame[n, 3], disc[d, 2])
        note(report, DISCS_TOUCHING, off, x, y)
        angle = max(turn[i], turn[si[i, NEXT]])
        disc_slack[d] = max(disc_slack[d], disc[d, 2] * angle * angle)


@jit
def list_balls(disc, strip_i, strip_s, sample, same_disc, place_i, place_s, job_i, job_s, job_strip):
    """Two discs to be found anew in every strip that has an inside; returns how many.

    Footpoints go to the places from row `sample` on; job_i, job_s as `mat_core.kernels.judge.balls` wants them; job_strip: the strip
    and the row of the report.
    """
    jobs = 0
    for m in range(strip_i.shape[0]):
        d0 = strip_i[m, 2]
        d1 = strip_i[m, 3]
        a0 = strip_s[m, 0]
        a1 = strip_s[m, 1]
        b1 = strip_s[m, 2]
        b0 = strip_s[m, 3]
        apart = abs(disc[d1, 0] - disc[d0, 0]) + abs(disc[d1, 1] - disc[d0, 1]) + abs(disc[d1, 2] - disc[d0, 2])
        if apart <= same_disc and a1 - a0 < 0.5 and b1 - b0 < 0.5:
            continue
        for side in range(2):
            place = sample + jobs
            place_i[place] = strip_i[m, side]
            place_s[place] = b0 + LEFT_SAMPLE * (b1 - b0) if side else a0 + RIGHT_SAMPLE * (a1 - a0)
            job_i[jobs, 0] = place
            job_i[jobs, 1] = strip_i[m, 1 - side]
            job_s[jobs, 0] = a0 if side else b0
            job_s[jobs, 1] = a1 if side else b1
            job_s[jobs, 2] = 0.5 * (disc[d0, 2] + disc[d1, 2])
            job_strip[jobs, 0] = m
            job_strip[jobs, 1] = PARTNERS_LEFT if side else PARTNERS_RIGHT
            jobs += 1
    return jobs


@jit
def check_discs(si, sf, disc, strip_i, disc_slack, strip_slack, jobs, job_i, job_strip, partner, probe, depth, report):
    """Depths of discs (first rows of `probe`) and of those found anew (next rows), and whether these touch the other side.

    Fills strip_slack (S,): what is granted inside a strip.
    """
    discs = disc.shape[0]
    for d in range(discs):
        note(report, DISCS_EMPTY, depth[d] - disc_slack[d] if disc[d, 2] >= 0.0 else math.inf, disc[d, 0], disc[d, 1])
    for m in range(strip_i.shape[0]):
        strip_slack[m] = max(disc_slack[strip_i[m, 2]], disc_slack[strip_i[m, 3]])
    for n in range(jobs):
        row = job_strip[n, 1]
        x = probe[discs + n, 0]
        y = probe[discs + n, 1]
        off = _missed(si, sf, job_i[n, 1], partner[n, 0], partner[n, 1] - x, partner[n, 2] - y, partner[n, 3], partner[n, 4],
                      probe[discs + n, 2])
        if off != off or depth[discs + n] == math.inf:
            off = math.inf
            x = partner[n, 1]
            y = partner[n, 2]
        note(report, row, max(off, depth[discs + n] - strip_slack[job_strip[n, 0]]), x, y)
