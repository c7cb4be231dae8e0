"""The boundary as the certificate sees it: closed loops, turned once, every bit of them owned by exactly one strip side.

Why this proves the degrees: walking along a loop, one interval ends and the next one begins at the same disc, so every contact of a
disc takes one end and one beginning of an interval. A strip that ends at a disc brings one of each (its right side ends, its left
side begins there), and so does an arc in whole contact. Hence, when nothing is left over,

    contacts of a disc = strips that end there + arcs in whole contact with it,

and no branch can be missing at a disc, nor one be there twice.
"""

from __future__ import annotations

import math

from mat_core.certificate.report import BOUNDARY, COVERAGE, NEIGHBOURS, TURNING, WHOLE_ARCS, count_fault, note
from mat_core.certificate.splines import rational_point
from mat_core.kernels.curve import edge_parameter
from mat_core.kernels.jit import jit
from mat_core.kernels.layout import (
    ARC, CONVEX_VERTEX, CORNER, EDGE, FAN, K0, KIND, LEN, LINE, LOOP, NEXT, PREV, SWEEP, TX0, TX1, TY0, TY1, X0, X1, Y0, Y1,
)

NEARLY_SMOOTH = 0.1  # a joint without vertex turns by less than this
HALF_WAY = 0.47  # where a piece is compared with the input's edge


@jit
def check_boundary(si, sf, loop_start, turn, report):
    """Loops close, and turn once around: by +2 pi the outer one, by -2 pi each hole. Fills `turn`: of smooth joints, by site."""
    for loop in range(loop_start.shape[0] - 1):
        total = 0.0
        first = loop_start[loop]
        last = loop_start[loop + 1]
        for i in range(first, last):
            before = i - 1 if i > first else last - 1
            x = sf[i, X0]
            y = sf[i, Y0]
            if si[before, NEXT] != i or si[i, PREV] != before:
                note(report, BOUNDARY, math.inf, x, y)
            note(report, BOUNDARY, math.hypot(sf[before, X1] - x, sf[before, Y1] - y), x, y)
            at_joint = _turn(sf[before, TX1], sf[before, TY1], sf[i, TX0], sf[i, TY0])
            turn[i] = 0.0
            if si[i, CORNER] == CONVEX_VERTEX:
                if at_joint < -0.5 * math.pi:
                    at_joint += 2.0 * math.pi
            else:
                turn[i] = abs(at_joint)
                if turn[i] > NEARLY_SMOOTH:
                    note(report, TURNING, turn[i], x, y)
            total += at_joint
            kind = si[i, KIND]
            if kind == ARC or kind == FAN:
                total += sf[i, SWEEP]
            elif kind != LINE:
                total += _turn(sf[i, TX0], sf[i, TY0], sf[i, TX1], sf[i, TY1])
        whole = 2.0 * math.pi if loop == 0 else -2.0 * math.pi
        note(report, TURNING, abs(total - whole), sf[first, X0], sf[first, Y0])


@jit
def _turn(ax, ay, bx, by):
    """Angle from direction a to direction b."""
    return math.atan2(ax * by - ay * bx, ax * bx + ay * by)


@jit
def check_edges(si, sf, cp, place_i, place_s, first, frame, degree, cp_start, control, knot_start, knots, edge_start, ox, oy, scale,
                work, report):
    """Every piece lies on the input's edge that it names, at the parameter that it names: places from row `first` on."""
    for n in range(first, first + si.shape[0]):
        i = place_i[n]
        if si[i, KIND] == FAN:
            continue
        edge = edge_start[si[i, LOOP]] + si[i, EDGE]
        x = frame[n, 0]
        y = frame[n, 1]
        u = edge_parameter(si, sf, cp, i, place_s[n])
        rational_point(degree[edge], knots, knot_start[edge], knot_start[edge + 1], control, cp_start[edge], 2, u, work)
        note(report, BOUNDARY, math.hypot((work[0, 0] - ox) * scale - x, (work[0, 1] - oy) * scale - y), x, y)


@jit
def list_places(si, strip_i, strip_s, whole_i, whole_s, contact_start, contact_site, contact_s, owned_i, owned_s, place_i, place_s,
                place_disc):
    """All owned intervals of the boundary, owned_i (site, disc at lo, disc at hi) and owned_s (lo, hi), and places to look at.

    Places: beginnings of the intervals, ends of them, contacts of discs, middles of arcs in whole contact, one on each piece.
    """
    strips = strip_i.shape[0]
    for m in range(strips):
        owned_i[2 * m, 0] = strip_i[m, 0]
        owned_i[2 * m, 1] = strip_i[m, 2]
        owned_i[2 * m, 2] = strip_i[m, 3]
        owned_s[2 * m, 0] = strip_s[m, 0]
        owned_s[2 * m, 1] = strip_s[m, 1]
        owned_i[2 * m + 1, 0] = strip_i[m, 1]
        owned_i[2 * m + 1, 1] = strip_i[m, 3]
        owned_i[2 * m + 1, 2] = strip_i[m, 2]
        owned_s[2 * m + 1, 0] = strip_s[m, 3]
        owned_s[2 * m + 1, 1] = strip_s[m, 2]
    owned = owned_i.shape[0]
    n = 2 * owned + contact_site.shape[0]
    for m in range(whole_i.shape[0]):
        row = 2 * strips + m
        owned_i[row, 0] = whole_i[m, 0]
        owned_i[row, 1] = whole_i[m, 1]
        owned_i[row, 2] = whole_i[m, 1]
        owned_s[row, 0] = whole_s[m, 0]
        owned_s[row, 1] = whole_s[m, 1]
        place_i[n] = whole_i[m, 0]
        place_s[n] = 0.5 * (whole_s[m, 0] + whole_s[m, 1])
        n += 1
    for i in range(si.shape[0]):
        place_i[n + i] = i
        place_s[n + i] = HALF_WAY
    for row in range(owned):
        place_i[row] = owned_i[row, 0]
        place_s[row] = owned_s[row, 0]
        place_disc[row] = owned_i[row, 1]
        place_i[owned + row] = owned_i[row, 0]
        place_s[owned + row] = owned_s[row, 1]
        place_disc[owned + row] = owned_i[row, 2]
    for d in range(contact_start.shape[0] - 1):
        for c in range(contact_start[d], contact_start[d + 1]):
            place_i[2 * owned + c] = contact_site[c]
            place_s[2 * owned + c] = contact_s[c]
            place_disc[2 * owned + c] = d


@jit
def _length(si, sf, disc, i, ds, d):
    """Length of a part ds of site i; on a fan, of the way of the centre of disc d."""
    return abs(ds) * (abs(sf[i, SWEEP]) * disc[d, 2] if si[i, KIND] == FAN else sf[i, LEN])


@jit
def check_coverage(si, sf, disc, owned_i, owned_s, order, first, frame, report):
    """No gap, no overlap, and one disc where two intervals meet; `order` sorts the intervals by site, then along it.

    Fills first (n + 1,): where the intervals of each site begin in `order`. frame: of their beginnings.
    """
    n = si.shape[0]
    count = order.shape[0]
    place = 0
    for i in range(n):
        while place < count and owned_i[order[place], 0] < i:
            place += 1
        first[i] = place
    first[n] = count
    for i in range(n):
        if first[i] == first[i + 1]:
            note(report, COVERAGE, max(sf[i, LEN], abs(sf[i, SWEEP])), sf[i, X0], sf[i, Y0])
            continue
        reached = 0.0
        before = -1
        for m in range(first[i], first[i + 1]):
            row = order[m]
            x = frame[row, 0]
            y = frame[row, 1]
            d = owned_i[row, 1]
            gap = max(abs(owned_s[row, 0] - reached), owned_s[row, 0] - owned_s[row, 1])
            note(report, COVERAGE, _length(si, sf, disc, i, gap, d), x, y)
            if before >= 0 and before != d:
                count_fault(report, NEIGHBOURS, x, y)
            reached = owned_s[row, 1]
            before = owned_i[row, 2]
        note(report, COVERAGE, _length(si, sf, disc, i, 1.0 - reached, before), sf[i, X1], sf[i, Y1])
        after = si[i, NEXT]
        if first[after] < first[after + 1] and owned_i[order[first[after]], 1] != before:
            count_fault(report, NEIGHBOURS, sf[i, X1], sf[i, Y1])


@jit
def check_whole(si, sf, disc, whole_i, whole_s, first, frame, report):
    """An arc in whole contact lies on its disc's circle, unless it is tiny: one centre, one radius. frame: middles, from `first`."""
    for m in range(whole_i.shape[0]):
        i = whole_i[m, 0]
        d = whole_i[m, 1]
        off = short = _length(si, sf, disc, i, whole_s[m, 1] - whole_s[m, 0], d)
        x = frame[first + m, 0]
        y = frame[first + m, 1]
        if si[i, KIND] == ARC:
            k = sf[i, K0]
            off = math.inf
            if k > 0.0:
                away = math.hypot(x - frame[first + m, 3] / k - disc[d, 0], y + frame[first + m, 2] / k - disc[d, 1])
                off = max(away, abs(1.0 / k - disc[d, 2]))
        note(report, WHOLE_ARCS, min(off, short), x, y)
