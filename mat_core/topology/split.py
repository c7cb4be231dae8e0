"""Split a face of many arcs by one maximal disc, so that walking along its arcs need not look at all of it every time.

A face's axis is a tree. The disc at a point of an arc touches one more arc of the face and cuts the tree there; of a few such
discs the one that leaves the parts most alike is taken. Halved again and again, a face of k arcs costs k log k.
"""

from __future__ import annotations

from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.query import query
from mat_core.topology.discs import K_LOW

MANY = 64  # faces of up to so many arcs are not split
TRIES = 12
LEAST_SHARE = 8  # a part smaller than 1/8 of the face is not worth a disc
INSIDE = 0.434  # where on its arc a disc is tried: not the middle, where symmetric shapes have their branch points


@inner
def _partner(stack_i, stack_f, begin, k, site, s):
    """The arc of the face that holds s of a site, strictly inside; -1 if there is none."""
    for arc in range(k):
        row = begin + arc
        if stack_i[row, 0] == site and stack_f[row, 0] < s < stack_f[row, 1]:
            return arc
    return -1


@inner
def find_split(si, sf, cp, tree, stack, stack_i, stack_f, begin, k):
    """(arc, s, arc, s, x, y, r) of a disc that cuts a face well, the lower arc first; arc -1 if none was found."""
    best = k // LEAST_SHARE
    low = high = -1
    low_s = high_s = x = y = r = 0.0
    for attempt in range(TRIES):
        arc = (2 * attempt + 1) * k // (2 * TRIES)
        site = stack_i[begin + arc, 0]
        lo = stack_f[begin + arc, 0]
        s = lo + INSIDE * (stack_f[begin + arc, 1] - lo)
        if not lo < s < stack_f[begin + arc, 1]:
            continue
        px, py, tx, ty, curvature, speed = evaluate(si, sf, cp, site, s, 0.0, 0.0)
        phi, winner, sw = query(si, sf, cp, tree, stack, site, s, -ty, tx, -1, -1, K_LOW)
        other = _partner(stack_i, stack_f, begin, k, winner, sw) if winner >= 0 else -1
        if other < 0 or other == arc:
            continue
        between = abs(arc - other)
        share = min(between, k - between)
        if share <= best:
            continue
        best = share
        low = min(arc, other)
        high = max(arc, other)
        low_s = s if arc < other else sw
        high_s = sw if arc < other else s
        x = px - ty / phi
        y = py + tx / phi
        r = 1.0 / phi
        if 3 * share > k:
            break
    return low, low_s, high, high_s, x, y, r


@inner
def split_face(stack_i, stack_f, w_i, w_f, begin, k, low, low_s, high, high_s, disc):
    """Put two faces where one stood: arcs low .. high and arcs high .. low, closed by `disc`. Returns where the second begins."""
    for arc in range(k):
        w_i[arc, 0] = stack_i[begin + arc, 0]
        w_i[arc, 1] = stack_i[begin + arc, 1]
        w_f[arc, 0] = stack_f[begin + arc, 0]
        w_f[arc, 1] = stack_f[begin + arc, 1]
    end = begin
    middle = begin
    for part in range(2):
        first = low if part == 0 else high
        last = high if part == 0 else low + k
        for place in range(first, last + 1):
            arc = place % k
            stack_i[end, 0] = w_i[arc, 0]
            stack_i[end, 1] = w_i[arc, 1] if place < last else disc
            stack_f[end, 0] = w_f[arc, 0]
            stack_f[end, 1] = w_f[arc, 1]
            if place == first:
                stack_f[end, 0] = low_s if part == 0 else high_s
            if place == last:
                stack_f[end, 1] = high_s if part == 0 else low_s
            end += 1
        if part == 0:
            middle = end
    return middle
