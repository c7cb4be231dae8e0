"""Discs that connect the loops of a domain where no disc at a joint does."""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import FAN, KIND, LOOP, PREV, SWEEP, THROUGH, TX0, TX1, TY0, X0
from mat_core.kernels.query import query
from mat_core.topology.discs import K_LOW, NO_PARTNER, OK
from mat_core.topology.unite import find, unite

# rows of the numbers of loops: integers, floats; EXTRA ones, of the discs found here, are fewer
LOOP_PARENT, RIGHT_SITE, EXTRA_SITE, EXTRA_PARTNER = range(4)
RIGHT_X, RIGHT_S, EXTRA_X, EXTRA_Y, EXTRA_R, EXTRA_S, EXTRA_PARTNER_S = range(7)


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
def connect_loops(si, sf, cp, tree, stack, loop_start, kind, winner, loops_i, loops_f):
    """Discs that join loops no joint disc joins; returns (status, how many).

    The disc at the rightmost point of a group of loops lies right of all of them, so it touches another group: after at most one
    disc a hole all loops are connected. Their numbers stand in columns of `loops_i`, `loops_f`, in the rows named EXTRA.
    """
    n_loops = loop_start.shape[0] - 1
    loop_parent = loops_i[LOOP_PARENT]
    for loop in range(n_loops):
        loop_parent[loop] = loop
    for j in range(si.shape[0]):
        if kind[j] == THROUGH:
            unite(loop_parent, si[j, LOOP], si[winner[j], LOOP])
    # the rightmost point of each group stands at its root
    for loop in range(1, n_loops):
        loops_f[RIGHT_X, loop], loops_i[RIGHT_SITE, loop], loops_f[RIGHT_S, loop] = rightmost(si, sf, cp, loop_start[loop],
                                                                                             loop_start[loop + 1])
    for loop in range(1, n_loops):
        _keep_rightmost(loops_i, loops_f, find(loop_parent, loop), loop)
    count = 0
    for group in range(1, n_loops):
        # until it hangs on a smaller one: in the end all hang on loop 0
        while find(loop_parent, group) == group:
            site = loops_i[RIGHT_SITE, group]
            s = loops_f[RIGHT_S, group]
            px, py, tx, ty, k, speed = evaluate(si, sf, cp, site, s, 0.0, 0.0)
            skip = si[site, PREV] if s == 0.0 else -1
            phi, w, sw = query(si, sf, cp, tree, stack, site, s, -ty, tx, skip, -1, K_LOW)
            if w < 0 or find(loop_parent, si[w, LOOP]) == group:
                return NO_PARTNER, count
            other = find(loop_parent, si[w, LOOP])
            unite(loop_parent, group, other)
            _keep_rightmost(loops_i, loops_f, min(group, other), max(group, other))
            loops_f[EXTRA_X, count] = px - ty / phi
            loops_f[EXTRA_Y, count] = py + tx / phi
            loops_f[EXTRA_R, count] = 1.0 / phi
            loops_f[EXTRA_S, count] = s
            loops_f[EXTRA_PARTNER_S, count] = sw
            loops_i[EXTRA_SITE, count] = site
            loops_i[EXTRA_PARTNER, count] = w
            count += 1
    return OK, count


@inner
def _keep_rightmost(loops_i, loops_f, root, member):
    """The rightmost point of `member` becomes that of `root` if it lies further right; loop 0 needs none."""
    if root > 0 and loops_f[RIGHT_X, member] > loops_f[RIGHT_X, root]:
        loops_f[RIGHT_X, root] = loops_f[RIGHT_X, member]
        loops_f[RIGHT_S, root] = loops_f[RIGHT_S, member]
        loops_i[RIGHT_SITE, root] = loops_i[RIGHT_SITE, member]
