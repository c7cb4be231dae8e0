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
from mat_core.kernels.curve import edge_parameter, evaluate
from mat_core.kernels.jit import jit
from mat_core.kernels.layout import (
    ARC, CONVEX_VERTEX, CORNER, EDGE, FAN, K0, KIND, LEN, LINE, NEXT, PREV, SWEEP, TX0, TX1, TY0, TY1, X0, X1, Y0, Y1,
)

NEARLY_SMOOTH = 0.1  # a joint without vertex turns by less than this
HALF_WAY = 0.47  # where a piece is compared with the input's edge


@jit
def check_boundary(si, sf, cp, loop_start, turn, report):
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
            dx, dy = evaluate(si, sf, cp, i, 1.0, sf[i, X1], sf[i, Y1])[:2]
            note(report, BOUNDARY, math.hypot(dx, dy), x, y)
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
def check_edges(si, sf, cp, site_loop, degree, cp_start, control, knot_start, knots, edge_start, ox, oy, scale, work, report):
    """Every piece lies on the input's edge that it names, at the parameter that it names."""
    for i in range(si.shape[0]):
        if si[i, KIND] == FAN:
            continue
        edge = edge_start[si[i, site_loop]] + si[i, EDGE]
        x, y = evaluate(si, sf, cp, i, HALF_WAY, 0.0, 0.0)[:2]
        u = edge_parameter(si, sf, cp, i, HALF_WAY)
        rational_point(degree[edge], knots, knot_start[edge], knot_start[edge + 1], control, cp_start[edge], 2, u, work)
        note(report, BOUNDARY, math.hypot((work[0, 0] - ox) * scale - x, (work[0, 1] - oy) * scale - y), x, y)


@jit
def list_intervals(strip_i, strip_s, whole_i, whole_s, owned_i, owned_s):
    """All owned intervals of the boundary: owned_i (site, disc at lo, disc at hi), owned_s (lo, hi)."""
    n = strip_i.shape[0]
    for m in range(n):
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
    for m in range(whole_i.shape[0]):
        owned_i[2 * n + m, 0] = whole_i[m, 0]
        owned_i[2 * n + m, 1] = owned_i[2 * n + m, 2] = whole_i[m, 1]
        owned_s[2 * n + m, 0] = whole_s[m, 0]
        owned_s[2 * n + m, 1] = whole_s[m, 1]


@jit
def _length(si, sf, disc, i, ds, d):
    """Length of a part ds of site i; on a fan, of the way of the centre of disc d."""
    return abs(ds) * (abs(sf[i, SWEEP]) * disc[d, 2] if si[i, KIND] == FAN else sf[i, LEN])


@jit
def check_coverage(si, sf, cp, disc, owned_i, owned_s, order, first, report):
    """No gap, no overlap, and one disc where two intervals meet; `order` sorts the intervals by site, then along it.

    Fills first (n + 1,): where the intervals of each site begin in `order`.
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
        reached = 0.0
        x = sf[i, X0]
        y = sf[i, Y0]
        if first[i] == first[i + 1]:
            note(report, COVERAGE, max(sf[i, LEN], abs(sf[i, SWEEP])), x, y)
            continue
        for m in range(first[i], first[i + 1]):
            row = order[m]
            x, y = evaluate(si, sf, cp, i, owned_s[row, 0], 0.0, 0.0)[:2]
            note(report, COVERAGE, _length(si, sf, disc, i, owned_s[row, 0] - reached, owned_i[row, 1]), x, y)
            if owned_s[row, 1] < owned_s[row, 0]:
                note(report, COVERAGE, _length(si, sf, disc, i, owned_s[row, 1] - owned_s[row, 0], owned_i[row, 1]), x, y)
            if m > first[i] and owned_i[order[m - 1], 2] != owned_i[row, 1]:
                count_fault(report, NEIGHBOURS, x, y)
            reached = owned_s[row, 1]
        last = order[first[i + 1] - 1]
        note(report, COVERAGE, _length(si, sf, disc, i, 1.0 - reached, owned_i[last, 2]), sf[i, X1], sf[i, Y1])
        after = si[i, NEXT]
        if first[after] < first[after + 1] and owned_i[order[first[after]], 1] != owned_i[last, 2]:
            count_fault(report, NEIGHBOURS, sf[i, X1], sf[i, Y1])


@jit
def check_whole(si, sf, cp, disc, whole_i, whole_s, report):
    """An arc in whole contact lies on its disc's circle: both have one centre and one radius, unless the arc is tiny."""
    for m in range(whole_i.shape[0]):
        i = whole_i[m, 0]
        d = whole_i[m, 1]
        lo = whole_s[m, 0]
        hi = whole_s[m, 1]
        short = _length(si, sf, disc, i, hi - lo, d)
        off = short
        x, y, tx, ty = evaluate(si, sf, cp, i, 0.5 * (lo + hi), disc[d, 0], disc[d, 1])[:4]
        if si[i, KIND] == ARC:
            k = sf[i, K0]
            off = max(math.hypot(x - ty / k, y + tx / k), abs(1.0 / k - disc[d, 2])) if k > 0.0 else math.inf
        note(report, WHOLE_ARCS, min(off, short), x + disc[d, 0], y + disc[d, 1])
