"""Discs that connect the loops of a domain where no disc at a joint does."""

from __future__ import annotations

import math

from mat_core.kernels.boxtree import query
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import FAN, KIND, LOOP, PREV, SWEEP, THROUGH, TX0, TX1, TY0, X0
from mat_core.topology.discs import K_LOW, NO_PARTNER, OK
from mat_core.topology.unite import find, unite


@inner
def rightmost(si, sf, cp, first, last):
    """(x, site, s) of the point with the largest x on the sites first .. last-1: its outward normal is (1, 0).

    On a FAN s is where the normal passes (1, 0); on a piece where the tangent is vertical.
    """
    best = -math.inf
    best_site = -1
    best_s = 0.0
    for i in range(first, last):
        if si[i, KIND] == FAN:
            # normals turn clockwise by |SWEEP| from that of the start: is (1, 0) among them?
            turn = math.atan2(sf[i, TX0], -sf[i, TY0])  # from (1, 0) anticlockwise to the first normal
            s = turn / -sf[i, SWEEP]
            if -1e-9 <= s <= 1.0 + 1e-9 and sf[i, X0] > best:
                best = sf[i, X0]
                best_site = i
                best_s = min(max(s, 0.0), 1.0)
            continue
        if sf[i, X0] > best:
            best = sf[i, X0]
            best_site = i
            best_s = 0.0
        if sf[i, TX0] * sf[i, TX1] < 0.0:
            lo = 0.0
            hi = 1.0
            for _ in range(60):
                m = 0.5 * (lo + hi)
                dx, dy, tx, ty, k, speed = evaluate(si, sf, cp, i, m, 0.0, 0.0)
                if tx * sf[i, TX0] > 0.0:
                    lo = m
                else:
                    hi = m
            dx, dy, tx, ty, k, speed = evaluate(si, sf, cp, i, 0.5 * (lo + hi), 0.0, 0.0)
            if dx > best:
                best = dx
                best_site = i
                best_s = 0.5 * (lo + hi)
    return best, best_site, best_s


@inner
def connect_loops(si, sf, cp, tree, stack, loop_start, kind, winner, loop_parent, right, right_site, extra,
                  extra_site):
    """Discs that join loops no joint disc joins; returns (status, how many).

    The disc at the rightmost point of a group of loops lies right of all of them, so it touches another group: after at most one
    disc a hole all loops are connected. Rows of `extra`: x, y, r, s, s_winner; of `extra_site`: site, winner.
    """
    n_loops = loop_start.shape[0] - 1
    for loop in range(n_loops):
        loop_parent[loop] = loop
    for j in range(si.shape[0]):
        if kind[j] == THROUGH:
            unite(loop_parent, si[j, LOOP], si[winner[j], LOOP])
    # the rightmost point of each group stands at its root
    for loop in range(1, n_loops):
        x, site, s = rightmost(si, sf, cp, loop_start[loop], loop_start[loop + 1])
        right[loop, 0] = x
        right[loop, 1] = s
        right_site[loop] = site
    for loop in range(1, n_loops):
        _keep_rightmost(right, right_site, find(loop_parent, loop), loop)
    count = 0
    for group in range(1, n_loops):
        # until it hangs on a smaller one: in the end all hang on loop 0
        while find(loop_parent, group) == group:
            site = right_site[group]
            s = right[group, 1]
            px, py, tx, ty, k, speed = evaluate(si, sf, cp, site, s, 0.0, 0.0)
            skip = si[site, PREV] if s == 0.0 else -1
            phi, w, sw = query(si, sf, cp, tree, stack, site, s, -ty, tx, skip, -1, K_LOW)
            if w < 0 or find(loop_parent, si[w, LOOP]) == group:
                return NO_PARTNER, count
            other = find(loop_parent, si[w, LOOP])
            unite(loop_parent, group, other)
            _keep_rightmost(right, right_site, min(group, other), max(group, other))
            extra[count, 0] = px - ty / phi
            extra[count, 1] = py + tx / phi
            extra[count, 2] = 1.0 / phi
            extra[count, 3] = s
            extra[count, 4] = sw
            extra_site[count, 0] = site
            extra_site[count, 1] = w
            count += 1
    return OK, count


@inner
def _keep_rightmost(right, right_site, root, member):
    """The rightmost point of `member` becomes that of `root` if it lies further right; loop 0 needs none."""
    if root > 0 and right[member, 0] > right[root, 0]:
        right[root, 0] = right[member, 0]
        right[root, 1] = right[member, 1]
        right_site[root] = right_site[member]
