"""Where the boundary meets itself: every pair of gentle pieces decided by subdivision, near-linear over a box tree.

    pair not adjacent    halve the longer piece, drop what is separated by more than `gap` along x, y or either chord
                         and its normal (control polygons bound the curves); both smaller than gap / 4 and still not
                         separated: they meet.
    pair adjacent        pieces A -> V -> B share the end V. If the cones of their control points seen from V are disjoint
                         they share nothing else. Else cut off the far halves (not adjacent: as above) and look again
                         nearer to V, until the cones part or A and B together are thinner than THIN gaps (tip of a cusp).

                A \\      / B           cone of A seen from V: the chords from V to points of A are positive
                   \\    /              combinations of P_k - V, so disjoint cones hold disjoint curves
                    \\  /
                     V

Points of one loop joined by a boundary path of a few gaps are near each other by rights; so are, up to `cusp_path`, the
branches of a cusp (they run against each other, 2 x**1.5 apart at distance x from the tip).

Coordinates, piece tables and gentle pieces as in `mat_core.kernels.outline`. `gap`: what is nearer counts as touching.
Hits, rows of `hits` (n, 5): piece i, its t, piece j, its t, kind.
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints, bernstein_sum, derivatives, restrict
from mat_core.kernels.jit import jit
from mat_core.kernels.outline import BLOCK, CP0, CUM, DEEPEST, DEG, LEN, LOOP, XMIN

# Kinds of hits.
MEET = 0  # within `gap` of each other
OVERLAP = 1  # adjacent pieces, the second running back along the first
UNDECIDED = 2  # still not separated when the budget of subdivisions was spent

APART, FOUND, SPENT = 0, 1, 2  # answers about a pair

LEAF = 0.25  # of gap: extent at which subdivision ends; hulls of two leaves add half a gap at most
NEAR_PATH = 16.0  # gaps of boundary path within which two points are one corner
THIN = 16.0  # gaps: a tip thinner than this is accepted; halving once more at least halves the gap cubed, so >= 2 gaps remain
SAME_DIRECTION = 1e-10  # sine below which two cone sides count as one
STRAIGHT_BACK = 0.1  # sine between chords that run against each other, as the branches of a cusp do
NO_DIRECTION = 1e-15  # control points this near to V tell no direction: the rounding of normalised coordinates
SAMPLES = 8  # points at which a tip's thickness is measured
BISECTIONS = 45  # of a parameter range, when a footpoint is sought


@jit
def separated_along(
    rows: Floats, a: int, p: int, b: int, q: int, dx: float, dy: float, gap: float
) -> bool:
    """Whether the projections on the unit vector (dx, dy) of blocks `a` (degree p) and `b` (degree q) are over `gap` apart."""
    ox = rows[a, 0]
    oy = rows[a, 1]
    a0 = 0.0
    a1 = 0.0
    for i in range(1, p + 1):
        v = (rows[a + i, 0] - ox) * dx + (rows[a + i, 1] - oy) * dy
        if v < a0:
            a0 = v
        elif v > a1:
            a1 = v
    below = True
    above = True
    for i in range(q + 1):
        v = (rows[b + i, 0] - ox) * dx + (rows[b + i, 1] - oy) * dy
        if v >= a0 - gap:
            below = False
        if v <= a1 + gap:
            above = False
    return below or above


@jit
def separated(rows: Floats, a: int, p: int, b: int, q: int, gap: float) -> bool:
    """Whether two control polygons are proved more than `gap` apart along x, y, either chord or its normal."""
    if separated_along(rows, a, p, b, q, 1.0, 0.0, gap) or separated_along(rows, a, p, b, q, 0.0, 1.0, gap):
        return True
    for side in range(2):
        c = a if side == 0 else b
        e = a + p if side == 0 else b + q
        dx = rows[e, 0] - rows[c, 0]
        dy = rows[e, 1] - rows[c, 1]
        length = math.hypot(dx, dy)
        if length > 0.0:
            dx /= length
            dy /= length
            if separated_along(rows, a, p, b, q, -dy, dx, gap) or separated_along(rows, a, p, b, q, dx, dy, gap):
                return True
    return False


@jit
def span_of(rows: Floats, c: int, p: int) -> float:
    """Largest distance, by coordinate, of a block's control points from its first one."""
    extent = 0.0
    for i in range(1, p + 1):
        extent = max(extent, abs(rows[c + i, 0] - rows[c, 0]), abs(rows[c + i, 1] - rows[c, 1]))
    return extent


@jit
def joined_by_right(
    rows: Floats, p: int, q: int, ahead: float, behind: float, gap: float, cusp_path: float
) -> bool:
    """Whether blocks 0 and BLOCK are near only because a short boundary path joins them.

    `ahead`, `behind`: the longest such path from the first to the second, going on or going back.
    """
    path = min(ahead, behind)
    if path <= NEAR_PATH * gap:
        return True
    if path > cusp_path:
        return False
    ax = rows[p, 0] - rows[0, 0]
    ay = rows[p, 1] - rows[0, 1]
    bx = rows[BLOCK + q, 0] - rows[BLOCK, 0]
    by = rows[BLOCK + q, 1] - rows[BLOCK, 1]
    dot = ax * bx + ay * by
    return dot < 0.0 and abs(ax * by - ay * bx) <= STRAIGHT_BACK * abs(dot)


@jit
def meet(
    pi: Ints, pcp: Floats, i: int, i0: float, i1: float, j: int, j0: float, j1: float,
    ahead: float, behind: float, gap: float, cusp_path: float, work: Floats, stack: Floats, budget: int,
) -> tuple[int, float, float, int]:
    """Do piece i over [i0, i1] and piece j over [j0, j1] come within `gap`? Returns answer, both parameters, budget left.

    `ahead` is the boundary path from the end of i to the start of j, `behind` from the end of j to the start of i
    (infinite between loops).
    """  # fmt: skip
    p = pi[i, DEG]
    q = pi[j, DEG]
    a = pi[i, CP0]
    b = pi[j, CP0]
    top = 0
    stack[0, 0] = i0
    stack[0, 1] = i1
    stack[0, 2] = j0
    stack[0, 3] = j1
    while top >= 0:
        s0 = stack[top, 0]
        s1 = stack[top, 1]
        t0 = stack[top, 2]
        t1 = stack[top, 3]
        top -= 1
        restrict(pcp, a, p, s0, s1, work, 0)
        restrict(pcp, b, q, t0, t1, work, BLOCK)
        if separated(work, 0, p, BLOCK, q, gap):
            continue
        if ahead < cusp_path or behind < cusp_path:
            on = ahead + math.hypot(pcp[a + p, 0] - work[0, 0], pcp[a + p, 1] - work[0, 1])
            on += math.hypot(work[BLOCK + q, 0] - pcp[b, 0], work[BLOCK + q, 1] - pcp[b, 1])
            back = behind + math.hypot(pcp[b + q, 0] - work[BLOCK, 0], pcp[b + q, 1] - work[BLOCK, 1])
            back += math.hypot(work[p, 0] - pcp[a, 0], work[p, 1] - pcp[a, 1])
            if joined_by_right(work, p, q, on, back, gap, cusp_path):
                continue
        sa = span_of(work, 0, p)
        sb = span_of(work, BLOCK, q)
        if max(sa, sb) <= LEAF * gap:
            return FOUND, 0.5 * (s0 + s1), 0.5 * (t0 + t1), budget
        budget -= 1
        if budget <= 0:
            return SPENT, 0.5 * (s0 + s1), 0.5 * (t0 + t1), 0
        # Halve the longer; the half whose end is nearer to the other's middle goes on top of the stack.
        if sa >= sb:
            mx = 0.5 * (work[BLOCK, 0] + work[BLOCK + q, 0])
            my = 0.5 * (work[BLOCK, 1] + work[BLOCK + q, 1])
            first = math.hypot(work[0, 0] - mx, work[0, 1] - my) < math.hypot(work[p, 0] - mx, work[p, 1] - my)
            m = 0.5 * (s0 + s1)
            stack[top + 1, 0] = m if first else s0
            stack[top + 1, 1] = s1 if first else m
            stack[top + 2, 0] = s0 if first else m
            stack[top + 2, 1] = m if first else s1
            stack[top + 1, 2] = t0
            stack[top + 1, 3] = t1
            stack[top + 2, 2] = t0
            stack[top + 2, 3] = t1
        else:
            mx = 0.5 * (work[0, 0] + work[p, 0])
            my = 0.5 * (work[0, 1] + work[p, 1])
            first = math.hypot(work[BLOCK, 0] - mx, work[BLOCK, 1] - my) < math.hypot(
                work[BLOCK + q, 0] - mx, work[BLOCK + q, 1] - my
            )
            m = 0.5 * (t0 + t1)
            stack[top + 1, 2] = m if first else t0
            stack[top + 1, 3] = t1 if first else m
            stack[top + 2, 2] = t0 if first else m
            stack[top + 2, 3] = m if first else t1
            stack[top + 1, 0] = s0
            stack[top + 1, 1] = s1
            stack[top + 2, 0] = s0
            stack[top + 2, 1] = s1
        top += 2
    return APART, 0.0, 0.0, budget


@jit
def cone_seen_from(rows: Floats, v: int, far: int, step: int, p: int) -> tuple[float, float, float, float]:
    """Unit sides lo, hi (right and left) of the cone of the p control points from row `v` to `far`, seen from row `v`."""
    lx = ly = hx = hy = 0.0
    k = far
    for _ in range(p):
        x = rows[k, 0] - rows[v, 0]
        y = rows[k, 1] - rows[v, 1]
        length = math.hypot(x, y)
        k -= step
        if length <= NO_DIRECTION:
            continue
        x /= length
        y /= length
        if lx == 0.0 and ly == 0.0:
            lx = hx = x
            ly = hy = y
        elif hx * y - hy * x > 0.0:
            hx = x
            hy = y
        elif lx * y - ly * x < 0.0:
            lx = x
            ly = y
    return lx, ly, hx, hy


@jit
def in_cone(x: float, y: float, lx: float, ly: float, hx: float, hy: float) -> bool:
    """Whether the unit vector (x, y) lies in the cone from lo to hi (under a half turn), widened by SAME_DIRECTION."""
    if x * (lx + hx) + y * (ly + hy) <= 0.0:
        return False
    return lx * y - ly * x >= -SAME_DIRECTION and x * hy - y * hx >= -SAME_DIRECTION


@jit
def cones_part(rows: Floats, p: int, q: int) -> bool:
    """Whether block 0, ending in V, and block BLOCK, starting in V, lie in disjoint cones from V."""
    alx, aly, ahx, ahy = cone_seen_from(rows, p, 0, -1, p)
    blx, bly, bhx, bhy = cone_seen_from(rows, BLOCK, BLOCK + q, 1, q)
    return not (
        in_cone(alx, aly, blx, bly, bhx, bhy)
        or in_cone(ahx, ahy, blx, bly, bhx, bhy)
        or in_cone(blx, bly, alx, aly, ahx, ahy)
        or in_cone(bhx, bhy, alx, aly, ahx, ahy)
    )


@jit
def distance_to(rows: Floats, c: int, p: int, x: float, y: float) -> float:
    """Distance from (x, y) to the gentle block at row `c`: bisection of (C - q).C' from its two ends."""
    lo = 0.0
    hi = 1.0
    for _ in range(BISECTIONS):
        t = 0.5 * (lo + hi)
        cx, cy, dx, dy, _, _ = derivatives(rows, c, p, t, x, y)
        if cx * dx + cy * dy < 0.0:
            lo = t
        else:
            hi = t
    sx, sy, sw = bernstein_sum(rows, c, p, 0.5 * (lo + hi), x, y)
    near = math.hypot(sx / sw, sy / sw)
    return min(
        near, math.hypot(rows[c, 0] - x, rows[c, 1] - y), math.hypot(rows[c + p, 0] - x, rows[c + p, 1] - y)
    )


@jit
def is_thin(rows: Floats, p: int, q: int, limit: float) -> bool:
    """Whether the shorter of blocks 0 and BLOCK lies within `limit` of the other, at SAMPLES points and its far end."""
    la = math.hypot(rows[p, 0] - rows[0, 0], rows[p, 1] - rows[0, 1])
    lb = math.hypot(rows[BLOCK + q, 0] - rows[BLOCK, 0], rows[BLOCK + q, 1] - rows[BLOCK, 1])
    c = 0 if la <= lb else BLOCK
    d = p if la <= lb else q
    other = BLOCK if la <= lb else 0
    degree = q if la <= lb else p
    for k in range(SAMPLES):
        t = k / SAMPLES if la <= lb else 1.0 - k / SAMPLES
        ox = rows[c, 0]
        oy = rows[c, 1]
        sx, sy, sw = bernstein_sum(rows, c, d, t, ox, oy)
        if distance_to(rows, other, degree, ox + sx / sw, oy + sy / sw) > limit:
            return False
    return True


@jit
def meet_at_joint(
    pi: Ints, pcp: Floats, i: int, i0: float, j: int, j1: float,
    far: float, gap: float, cusp_path: float, work: Floats, stack: Floats, budget: int,
) -> tuple[int, float, float, int, int]:
    """Do adjacent pieces i over [i0, 1] and j over [0, j1] share more than the end V of i, the start of j?

    Returns answer, both parameters, budget left, kind of hit. `far`: path from the end of j on to the start of i.
    """  # fmt: skip
    p = pi[i, DEG]
    q = pi[j, DEG]
    whole = True
    for _ in range(DEEPEST):
        restrict(pcp, pi[i, CP0], p, i0, 1.0, work, 0)
        restrict(pcp, pi[j, CP0], q, 0.0, j1, work, BLOCK)
        if cones_part(work, p, q):
            return APART, 0.0, 0.0, budget, MEET
        sa = span_of(work, 0, p)
        sb = span_of(work, BLOCK, q)
        if is_thin(work, p, q, THIN * gap):
            if whole and min(sa, sb) > NEAR_PATH * gap:
                return FOUND, 0.5 * (i0 + 1.0), 0.5 * j1, budget, OVERLAP
            return APART, 0.0, 0.0, budget, MEET
        whole = False
        # The far halves are adjacent to nothing any more; a much shorter piece stays whole.
        im = 0.5 * (i0 + 1.0) if sa >= 0.25 * sb else i0
        jm = 0.5 * j1 if sb >= 0.25 * sa else j1
        if im > i0:
            answer, s, t, budget = meet(
                pi, pcp, i, i0, im, j, 0.0, j1, 0.0, far, gap, cusp_path, work, stack, budget
            )
            if answer != APART:
                return answer, s, t, budget, MEET
        if jm < j1:
            answer, s, t, budget = meet(
                pi, pcp, i, im, 1.0, j, jm, j1, 0.0, far, gap, cusp_path, work, stack, budget
            )
            if answer != APART:
                return answer, s, t, budget, MEET
        i0 = im
        j1 = jm
    return APART, 0.0, 0.0, budget, MEET


@jit
def lines_meet(pcp: Floats, a: int, b: int, gap: float) -> tuple[bool, float, float]:
    """Do the segments at rows a, a + 1 and b, b + 1 come within `gap`? Also the parameters of their nearest points."""
    ox = pcp[a, 0]
    oy = pcp[a, 1]
    ux = pcp[a + 1, 0] - ox
    uy = pcp[a + 1, 1] - oy
    vx = pcp[b + 1, 0] - pcp[b, 0]
    vy = pcp[b + 1, 1] - pcp[b, 1]
    wx = pcp[b, 0] - ox
    wy = pcp[b, 1] - oy
    cross = ux * vy - uy * vx
    if cross != 0.0:
        s = (wx * vy - wy * vx) / cross
        t = (wx * uy - wy * ux) / cross
        if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
            return True, s, t
    best = math.inf
    best_s = 0.0
    best_t = 0.0
    uu = ux * ux + uy * uy
    vv = vx * vx + vy * vy
    for k in range(4):
        # Ends 0 and 1 of b against a, ends 2 and 3 of a against b.
        if k < 2:
            x = wx + k * vx
            y = wy + k * vy
            t = float(k)
            s = min(1.0, max(0.0, (x * ux + y * uy) / uu))
        else:
            s = float(k - 2)
            t = min(1.0, max(0.0, ((s * ux - wx) * vx + (s * uy - wy) * vy) / vv))
        d = math.hypot(wx + t * vx - s * ux, wy + t * vy - s * uy)
        if d < best:
            best = d
            best_s = s
            best_t = t
    return best <= gap, best_s, best_t


@jit
def lines_fold(pcp: Floats, a: int, b: int, gap: float) -> bool:
    """Does segment b, which starts where segment a ends, run back along a (the shorter within `gap` of the other)?"""
    ux = pcp[a, 0] - pcp[a + 1, 0]
    uy = pcp[a, 1] - pcp[a + 1, 1]
    vx = pcp[b + 1, 0] - pcp[b, 0]
    vy = pcp[b + 1, 1] - pcp[b, 1]
    if ux * vx + uy * vy <= 0.0:
        return False
    return abs(ux * vy - uy * vx) <= gap * max(math.hypot(ux, uy), math.hypot(vx, vy))


@jit
def judge_pair(
    pi: Ints, pf: Floats, pcp: Floats, piece_start: Ints, i: int, j: int,
    gap: float, cusp_path: float, work: Floats, stack: Floats, budget: int,
) -> tuple[int, float, float, int, int]:
    """Do pieces i < j meet where they may not? Returns answer, both parameters, budget left, kind of hit."""  # fmt: skip
    a = pi[i, CP0]
    b = pi[j, CP0]
    straight = pi[i, DEG] == 1 and pi[j, DEG] == 1
    ahead = math.inf
    behind = math.inf
    on = False
    back = False
    if pi[i, LOOP] == pi[j, LOOP]:
        first = piece_start[pi[i, LOOP]]
        last = piece_start[pi[i, LOOP] + 1] - 1
        ahead = pf[j, CUM] - pf[i, CUM] - pf[i, LEN]
        behind = pf[last, CUM] + pf[last, LEN] - pf[j, CUM] - pf[j, LEN] + pf[i, CUM] - pf[first, CUM]
        on = j == i + 1
        back = i == first and j == last
    if not on and not back:
        if straight:
            near, s, t = lines_meet(pcp, a, b, gap)
            if near and min(
                ahead + (1.0 - s) * pf[i, LEN] + t * pf[j, LEN], behind + s * pf[i, LEN] + (1.0 - t) * pf[j, LEN]
            ) > NEAR_PATH * gap:
                return FOUND, s, t, budget, MEET
            return APART, 0.0, 0.0, budget, MEET
        answer, s, t, budget = meet(
            pi, pcp, i, 0.0, 1.0, j, 0.0, 1.0, ahead, behind, gap, cusp_path, work, stack, budget
        )
        return answer, s, t, budget, MEET
    if straight:
        if on and lines_fold(pcp, a, b, gap):
            return FOUND, 0.5, 0.5, budget, OVERLAP
        if back and lines_fold(pcp, b, a, gap):
            return FOUND, 0.5, 0.5, budget, OVERLAP
        return APART, 0.0, 0.0, budget, MEET
    if on and not back:
        return meet_at_joint(pi, pcp, i, 0.0, j, 1.0, behind, gap, cusp_path, work, stack, budget)
    if back and not on:
        answer, t, s, budget, kind = meet_at_joint(
            pi, pcp, j, 0.0, i, 1.0, ahead, gap, cusp_path, work, stack, budget
        )
        return answer, s, t, budget, kind
    # A loop of two pieces: each joint with the halves next to it, then the halves that are not next to each other.
    answer, s, t, budget, kind = meet_at_joint(pi, pcp, i, 0.5, j, 0.5, math.inf, gap, cusp_path, work, stack, budget)
    if answer == APART:
        answer, t, s, budget, kind = meet_at_joint(
            pi, pcp, j, 0.5, i, 0.5, math.inf, gap, cusp_path, work, stack, budget
        )
    for half in range(2):
        if answer == APART:
            h = 0.5 * half
            answer, s, t, budget = meet(
                pi, pcp, i, h, h + 0.5, j, h, h + 0.5, math.inf, math.inf, gap, cusp_path, work, stack, budget
            )
            kind = MEET
    return answer, s, t, budget, kind


@jit
def build_boxes(pf: Floats, n: int, tree: Floats) -> int:
    """Boxes of a complete binary tree over pieces 0 .. n - 1 in loop order; returns its number of leaves.

    Node v has the children 2v and 2v + 1, the root is 1, leaf i is node `leaves + i`; an empty node has xmin = inf.
    """
    leaves = tree.shape[0] // 2
    for i in range(leaves):
        for k in range(4):
            tree[leaves + i, k] = pf[i, XMIN + k] if i < n else (math.inf if k < 2 else -math.inf)
    for v in range(leaves - 1, 0, -1):
        for k in range(2):
            tree[v, k] = min(tree[2 * v, k], tree[2 * v + 1, k])
            tree[v, k + 2] = max(tree[2 * v, k + 2], tree[2 * v + 1, k + 2])
    return leaves


@jit
def find_hits(
    pi: Ints, pf: Floats, pcp: Floats, piece_start: Ints, n: int, gap: float, cusp_path: float,
    tree: Floats, pairs: Ints, work: Floats, stack: Floats, budget: int, hits: Floats,
) -> int:
    """All pairs of pieces that meet where they may not, up to the rows of `hits`; returns their number.

    Walks the tree against itself; only pairs of leaves whose boxes come within `gap` are judged.
    """  # fmt: skip
    leaves = build_boxes(pf, n, tree)
    found = 0
    top = 0
    pairs[0, 0] = 1
    pairs[0, 1] = 1
    while top >= 0:
        v = pairs[top, 0]
        w = pairs[top, 1]
        top -= 1
        if (
            tree[v, 0] > tree[w, 2] + gap
            or tree[w, 0] > tree[v, 2] + gap
            or tree[v, 1] > tree[w, 3] + gap
            or tree[w, 1] > tree[v, 3] + gap
        ):
            continue
        if v >= leaves:
            if v == w:
                continue
            i = v - leaves
            j = w - leaves
            answer, s, t, budget, kind = judge_pair(
                pi, pf, pcp, piece_start, i, j, gap, cusp_path, work, stack, budget
            )
            if answer == APART:
                continue
            if found >= hits.shape[0]:
                return found
            hits[found, 0] = i
            hits[found, 1] = s
            hits[found, 2] = j
            hits[found, 3] = t
            hits[found, 4] = kind if answer == FOUND else UNDECIDED
            found += 1
            if answer == SPENT:
                return found
            continue
        # Both nodes are on one level, v <= w; pushed so that pairs come out in loop order.
        pairs[top + 1, 0] = 2 * v + 1
        pairs[top + 1, 1] = 2 * w + 1
        pairs[top + 2, 0] = 2 * v
        pairs[top + 2, 1] = 2 * w + 1
        top += 2
        if v != w:
            pairs[top + 1, 0] = 2 * v + 1
            pairs[top + 1, 1] = 2 * w
            top += 1
        pairs[top + 1, 0] = 2 * v
        pairs[top + 1, 1] = 2 * w
        top += 1
    return found
