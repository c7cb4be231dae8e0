"""The boundary as the certificate sees it: closed loops, turned once, every bit owned by exactly one strip side.

Why this proves the degrees: walking along a loop, one interval ends and the next one begins at the same disc, so every
contact of a disc takes one end and one beginning of an interval. A strip that ends at a disc brings one of each (its
right side ends, its left side begins there), and so does an arc in whole contact. Hence, when nothing is left over,

    contacts of a disc = strips that end there + arcs in whole contact with it,

and no branch can be missing at a disc, nor one be there twice.
"""

from __future__ import annotations

import math

from mat_core.certificate.lengths import length_of_part
from mat_core.certificate.report import BOUNDARY, COVERAGE, NEIGHBOURS, TURNING, WHOLE_ARCS, fault, made, worst
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import (
    ARC,
    CONVEX_VERTEX,
    CORNER,
    K0,
    K1,
    KIND,
    LEN,
    LINE,
    LOOP,
    NEXT,
    PREV,
    SPIRAL,
    SWEEP,
    TX0,
    TX1,
    TY0,
    TY1,
    X0,
    X1,
    Y0,
    Y1,
)
from mat_core.kernels.sorting import sort

NEARLY_SMOOTH = 0.1  # a joint without a vertex turns by less than this


@inner
def owned(k, m):
    """(site, lo, hi, disc at lo, disc at hi) of interval m: right sides of strips, then left ones, then whole contacts."""
    strips = k.strip_i.shape[0]
    if m < strips:
        return k.strip_i[m, 0], k.strip_s[m, 0], k.strip_s[m, 1], k.strip_i[m, 2], k.strip_i[m, 3]
    m -= strips
    if m < strips:
        return k.strip_i[m, 1], k.strip_s[m, 3], k.strip_s[m, 2], k.strip_i[m, 3], k.strip_i[m, 2]
    m -= strips
    return k.whole_i[m, 0], k.whole_s[m, 0], k.whole_s[m, 1], k.whole_i[m, 1], k.whole_i[m, 1]


@inner
def list_owned(k, sites, first, order, spare, key):
    """Sort all owned intervals by site and along it: those of site i are order[first[i]:first[i + 1]]; `first` (sites + 1,).

    By the middle, so that ends that differ by rounding do not change the order.
    """
    for i in range(sites + 1):
        first[i] = 0
    for m in range(order.shape[0]):
        site, lo, hi, disc_lo, disc_hi = owned(k, m)
        key[m] = lo + hi
        first[site + 1] += 1
    for i in range(sites):
        first[i + 1] += first[i]
    for m in range(order.shape[0] - 1, -1, -1):
        # from behind: first[i + 1] is where the intervals of site i end, then where they begin
        site, lo, hi, disc_lo, disc_hi = owned(k, m)
        first[site + 1] -= 1
        order[first[site + 1]] = m
    for i in range(sites):
        first[i] = first[i + 1]
    first[sites] = order.shape[0]
    for i in range(sites):
        sort(key, order, spare, first[i], first[i + 1])
        begin = first[i]
        while begin < first[i + 1]:
            end = begin + 1
            while end < first[i + 1] and _same_point(k, order[begin], order[end]):
                end += 1
            if end > begin + 1:
                _chain(k, order, spare, begin, end)
            begin = end


@inner
def _same_point(k, a, b):
    """Whether two intervals are one point of the same site."""
    site_a, lo_a, hi_a, disc_lo, disc_hi = owned(k, a)
    site_b, lo_b, hi_b, disc_lo, disc_hi = owned(k, b)
    return lo_a == hi_a == lo_b == hi_b and site_a == site_b


@inner
def _chain(k, order, spare, begin, end):
    """Intervals of no length at one point have no order of their own: each follows the one that ended at its disc.

    They stay as they were where that leaves some over.
    """
    for place in range(begin, end):
        spare[place] = order[place]
    wanted = -1
    for place in range(begin, end):
        chosen = -1
        for other in range(place, end):
            site, lo, hi, disc_lo, disc_hi = owned(k, order[other])
            follows = disc_lo == wanted
            if place == begin:
                # the first one is that at whose beginning no other ends
                follows = True
                for before in range(begin, end):
                    if owned(k, order[before])[4] == disc_lo:
                        follows = False
            if follows:
                chosen = other
                wanted = disc_hi
                break
        if chosen < 0:
            for back in range(begin, end):
                order[back] = spare[back]
            return
        held = order[place]
        order[place] = order[chosen]
        order[chosen] = held


@inner
def _turn(ax, ay, bx, by):
    """Angle from direction a to direction b."""
    return math.atan2(ax * by - ay * bx, ax * bx + ay * by)


@inner
def check_boundary(t, turn, figures):
    """Loops close and turn once around, by +2 pi or, holes, by -2 pi; fills the turn at each smooth joint."""
    si = t.si
    sf = t.sf
    for loop in range(t.loop_start.shape[0] - 1):
        first = t.loop_start[loop]
        last = t.loop_start[loop + 1] - 1
        total = -2.0 * math.pi if loop == 0 else 2.0 * math.pi
        for i in range(first, last + 1):
            x = sf[i, X0]
            y = sf[i, Y0]
            before = i - 1 if i > first else last
            gap = math.sqrt((sf[before, X1] - x) ** 2 + (sf[before, Y1] - y) ** 2)
            if si[i, PREV] != before or si[before, NEXT] != i or si[i, LOOP] != loop:
                gap = math.inf
            worst(figures, BOUNDARY, gap, x, y)
            at_joint = _turn(sf[before, TX1], sf[before, TY1], sf[i, TX0], sf[i, TY0])
            corner = si[i, CORNER] == CONVEX_VERTEX
            if corner and at_joint < -0.5 * math.pi:
                at_joint += 2.0 * math.pi
            inside = sf[i, SWEEP]
            if si[i, KIND] == LINE:
                inside = 0.0
            elif si[i, KIND] == SPIRAL:
                inside = _turn(sf[i, TX0], sf[i, TY0], sf[i, TX1], sf[i, TY1])
            total += at_joint + inside
            turn[i] = 0.0 if corner else abs(at_joint)
            if turn[i] > NEARLY_SMOOTH:
                worst(figures, TURNING, turn[i], x, y)
        worst(figures, TURNING, abs(total), sf[first, X0], sf[first, Y0])


@inner
def check_coverage(t, k, first, order, figures):
    """No gap, no overlap, and one disc where two intervals meet."""
    si = t.si
    sf = t.sf
    bare = 0
    for i in range(si.shape[0]):
        x = sf[i, X0]
        y = sf[i, Y0]
        if first[i] == first[i + 1]:
            bare += 1
            worst(figures, COVERAGE, max(sf[i, LEN], abs(sf[i, SWEEP])), x, y)
            fault(figures, NEIGHBOURS, 1, x, y)
            continue
        reached = 0.0
        radius = 0.0
        for place in range(first[i], first[i + 1]):
            site, lo, hi, disc_lo, disc_hi = owned(k, order[place])
            radius = k.disc[disc_lo, 2]
            worst(figures, COVERAGE, 0.0 if lo == reached else length_of_part(t, i, reached, lo, radius), x, y)
            worst(figures, COVERAGE, 0.0 if lo <= hi else length_of_part(t, i, hi, lo, radius), x, y)
            reached = hi
        worst(figures, COVERAGE, 0.0 if reached == 1.0 else length_of_part(t, i, reached, 1.0, radius), sf[i, X1], sf[i, Y1])
    fault(figures, NEIGHBOURS, 0, 0.0, 0.0)
    for i in range(si.shape[0] if bare == 0 else 0):
        for place in range(first[i], first[i + 1]):
            following = place + 1 if place + 1 < first[i + 1] else first[si[i, NEXT]]
            disc = owned(k, order[place])[4]
            if disc != owned(k, order[following])[3]:
                fault(figures, NEIGHBOURS, 1, k.disc[disc, 0], k.disc[disc, 1])


@inner
def check_whole(t, k, figures):
    """An arc in whole contact lies on its disc's circle, at both ends, in the middle and in between, unless it is tiny.

    Its distance from that circle is a sine of amplitude `away`, the distance of the centres: between three points in a turn of
    `sweep` it can rise by away (1 - cos(sweep / 4)). The centres themselves may differ more, where the arc is short. A spiral may
    be an arc but for its last digits: its distance bends as its curvature differs from the circle's, which is most at its ends.
    """
    made(figures, WHOLE_ARCS)
    sf = t.sf
    for m in range(k.whole_i.shape[0]):
        i = k.whole_i[m, 0]
        x = k.disc[k.whole_i[m, 1], 0]
        y = k.disc[k.whole_i[m, 1], 1]
        r = k.disc[k.whole_i[m, 1], 2]
        begin = k.whole_s[m, 0]
        share = abs(k.whole_s[m, 1] - begin)
        rise = math.inf  # between the three points
        if t.si[i, KIND] == ARC and sf[i, K0] > 0.0:
            rho = 1.0 / sf[i, K0]
            away = math.sqrt((sf[i, X0] - rho * sf[i, TY0] - x) ** 2 + (sf[i, Y0] + rho * sf[i, TX0] - y) ** 2)
            if away < rho:
                rise = away * (1.0 - math.cos(0.25 * min(share * abs(sf[i, SWEEP]), math.pi)))
        elif t.si[i, KIND] == SPIRAL and min(sf[i, K0], sf[i, K1]) > 0.0 and r > 0.0:
            bend = max(abs(sf[i, K0] - 1.0 / r), abs(sf[i, K1] - 1.0 / r))
            rise = 0.125 * bend * sf[i, LEN] * sf[i, LEN]
        off = math.inf
        if rise < math.inf:
            off = 0.0
            for step in range(3):
                s = begin + 0.5 * step * (k.whole_s[m, 1] - begin)
                dx, dy, tx, ty, curvature, speed = evaluate(t.si, sf, t.cp, i, s, x, y)
                missing = abs(math.sqrt(dx * dx + dy * dy) - r)
                if not missing <= off:
                    off = missing
            off += rise
        length = length_of_part(t, i, begin, k.whole_s[m, 1], r)
        worst(figures, WHOLE_ARCS, length if off > length else off, x, y)
