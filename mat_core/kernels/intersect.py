"""Where the boundary meets itself: every pair of gentle pieces decided by subdivision, near-linear over a box tree.

    adjacent pieces      see `mat_core.kernels.joints`: whether they share more than their joint becomes some tasks
    two lines            by their nearest points
    other pairs          a task: halve the longer piece, drop what is separated by more than `gap` along x, y, either
                         chord or its normal (control polygons bound the curves); both smaller than gap / 4 and still
                         not separated: they meet

Points of one loop joined by a boundary path of a few gaps are near each other by rights; so are, up to `cusp_path`, the
branches of a cusp (they run against each other, 2 x**1.5 apart at distance x from the tip).

Coordinates, piece tables and gentle pieces as in `mat_core.kernels.outline`. `gap`: what is nearer counts as touching.
Hits, rows of `hits` (n, 5): piece i, its t, piece j, its t, kind. Tasks: columns in `mat_core.kernels.joints`.
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints, restrict
from mat_core.kernels.jit import jit
from mat_core.kernels.joints import (
    AHEAD,
    BEHIND,
    I0,
    NEAR_PATH,
    PIECE_I,
    PIECE_J,
    lines_fold,
    plan,
    plan_joint,
    span_of,
)
from mat_core.kernels.outline import BLOCK, CP0, CUM, DEG, LEN, LOOP, XMIN

# Kinds of hits.
MEET = 0  # within `gap` of each other
OVERLAP = 1  # adjacent pieces, the second running back along the first
UNDECIDED = 2  # still not separated when the budget of subdivisions was spent

APART, FOUND, SPENT = 0, 1, 2  # answers about a pair

LEAF = 0.25  # of gap: extent at which subdivision ends; hulls of two leaves add half a gap at most
STRAIGHT_BACK = 0.1  # sine between chords that run against each other, as the branches of a cusp do


@jit
def separated_along(rows: Floats, a: int, p: int, b: int, q: int, dx: float, dy: float, gap: float) -> bool:
    """Whether blocks `a` (degree p) and `b` (degree q) are over `gap` apart along the unit vector (dx, dy)."""
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
    dx = 1.0
    dy = 0.0
    for k in range(6):
        # x, y, chord of a, its normal, chord of b, its normal
        if k == 2 or k == 4:
            c = a if k == 2 else b
            e = a + p if k == 2 else b + q
            dx = rows[e, 0] - rows[c, 0]
            dy = rows[e, 1] - rows[c, 1]
            length = math.hypot(dx, dy)
            if length > 0.0:
                dx /= length
                dy /= length
        elif k > 0:
            turned = -dy
            dy = dx
            dx = turned
        if separated_along(rows, a, p, b, q, dx, dy, gap):
            return True
    return False


@jit
def joined_by_right(rows: Floats, p: int, q: int, ahead: float, behind: float, gap: float, cusp_path: float) -> bool:
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
    pi: Ints,
    pcp: Floats,
    tasks: Floats,
    task: int,
    gap: float,
    cusp_path: float,
    work: Floats,
    stack: Floats,
    budget: int,
) -> tuple[int, float, float, int]:
    """Do the two pieces of a task come within `gap`? Returns answer, both parameters, budget left."""
    i = int(tasks[task, PIECE_I])
    j = int(tasks[task, PIECE_J])
    ahead = tasks[task, AHEAD]
    behind = tasks[task, BEHIND]
    p = pi[i, DEG]
    q = pi[j, DEG]
    a = pi[i, CP0]
    b = pi[j, CP0]
    top = 0
    for k in range(4):
        stack[0, k] = tasks[task, I0 + k]
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
def paths_between(pi: Ints, pf: Floats, piece_start: Ints, i: int, j: int) -> tuple[float, float]:
    """Boundary paths from the end of piece i ahead to the start of j > i, from the end of j back to the start of i."""
    loop = pi[i, LOOP]
    if loop != pi[j, LOOP]:
        return math.inf, math.inf
    first = piece_start[loop]
    last = piece_start[loop + 1] - 1
    ahead = pf[j, CUM] - pf[i, CUM] - pf[i, LEN]
    behind = pf[last, CUM] + pf[last, LEN] - pf[j, CUM] - pf[j, LEN] + pf[i, CUM] - pf[first, CUM]
    return ahead, behind


@jit
def compare_joints(
    pi: Ints,
    pf: Floats,
    pcp: Floats,
    piece_start: Ints,
    gap: float,
    work: Floats,
    tasks: Floats,
    hits: Floats,
    counts: Ints,
) -> None:
    """All adjacent pairs: what runs back is a hit, what needs a closer look a task; counts as in `compare_pairs`."""
    found = counts[0]
    planned = counts[1]
    for loop in range(piece_start.shape[0] - 1):
        first = piece_start[loop]
        n = piece_start[loop + 1] - first
        # In a loop of two pieces each joint has the halves next to it; the halves not next to it are compared as well.
        cut = 0.5 if n == 2 else 0.0
        for k in range(n if n > 1 else 0):
            i = first + k
            j = first + (k + 1) % n
            if pi[i, DEG] == 1 and pi[j, DEG] == 1:
                folded = lines_fold(pcp, pi[i, CP0], pi[j, CP0], gap)
            else:
                far = math.inf
                if k + 1 < n and n > 2:
                    _, far = paths_between(pi, pf, piece_start, i, j)
                elif n > 2:
                    far, _ = paths_between(pi, pf, piece_start, j, i)
                folded, planned = plan_joint(pi, pcp, i, cut, j, 1.0 - cut, far, gap, work, tasks, planned)
                if n == 2:
                    h = 0.5 * k
                    planned = plan(tasks, planned, first, h, h + 0.5, first + 1, h, h + 0.5, math.inf, math.inf)
            if folded:
                found = note(hits, found, i, 0.5, j, 0.5, OVERLAP)
    counts[0] = found
    counts[1] = planned


@jit
def lines_hit(
    pi: Ints, pf: Floats, pcp: Floats, piece_start: Ints, i: int, j: int, gap: float
) -> tuple[bool, float, float]:
    """Whether the lines i < j, not adjacent, meet where they may not, and their parameters."""
    near, s, t = lines_meet(pcp, pi[i, CP0], pi[j, CP0], gap)
    if near:
        ahead, behind = paths_between(pi, pf, piece_start, i, j)
        onward = ahead + (1.0 - s) * pf[i, LEN] + t * pf[j, LEN]
        backward = behind + s * pf[i, LEN] + (1.0 - t) * pf[j, LEN]
        near = onward > NEAR_PATH * gap and backward > NEAR_PATH * gap
    return near, s, t


@jit
def are_adjacent(pi: Ints, piece_start: Ints, i: int, j: int) -> bool:
    """Whether pieces i < j are neighbours on one loop."""
    loop = pi[i, LOOP]
    if loop != pi[j, LOOP]:
        return False
    return j == i + 1 or (i == piece_start[loop] and j == piece_start[loop + 1] - 1)


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
def note(hits: Floats, found: int, i: int, s: float, j: int, t: float, kind: int) -> int:
    """Write a hit if there is room; returns the number of hits."""
    if found < hits.shape[0]:
        hits[found, 0] = i
        hits[found, 1] = s
        hits[found, 2] = j
        hits[found, 3] = t
        hits[found, 4] = kind
        return found + 1
    return found


@jit
def compare_pairs(
    pi: Ints,
    pf: Floats,
    pcp: Floats,
    piece_start: Ints,
    n: int,
    gap: float,
    tree: Floats,
    pairs: Ints,
    work: Floats,
    tasks: Floats,
    hits: Floats,
    counts: Ints,
) -> None:
    """All pairs not adjacent: hits that show at once, and tasks for the rest; counts[0] hits, counts[1] tasks, added
    to.

    Walks the tree against itself; only pieces whose boxes come within `gap` are looked at. Ends early when `hits` is
    full. counts[1] beyond the rows of `tasks` says that a larger buffer is needed.
    """
    leaves = build_boxes(pf, n, tree)
    found = counts[0]
    planned = counts[1]
    top = 0
    pairs[0, 0] = 1
    pairs[0, 1] = 1
    while top >= 0 and found < hits.shape[0]:
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
            if v != w:
                i = v - leaves
                j = w - leaves
                if are_adjacent(pi, piece_start, i, j):
                    continue
                p = pi[i, DEG]
                q = pi[j, DEG]
                if p == 1 and q == 1:
                    hit, s, t = lines_hit(pi, pf, pcp, piece_start, i, j, gap)
                    if hit:
                        found = note(hits, found, i, s, j, t, MEET)
                    continue
                for k in range(p + 1):
                    for c in range(3):
                        work[k, c] = pcp[pi[i, CP0] + k, c]
                for k in range(q + 1):
                    for c in range(3):
                        work[BLOCK + k, c] = pcp[pi[j, CP0] + k, c]
                if not separated(work, 0, p, BLOCK, q, gap):
                    ahead, behind = paths_between(pi, pf, piece_start, i, j)
                    planned = plan(tasks, planned, i, 0.0, 1.0, j, 0.0, 1.0, ahead, behind)
            continue
        # Both nodes are on one level, v <= w; pushed so that pairs come out in loop order.
        for k in range(3, -1, -1):
            if k != 2 or v != w:
                top += 1
                pairs[top, 0] = 2 * v + (k >> 1)
                pairs[top, 1] = 2 * w + (k & 1)
    counts[0] = found
    counts[1] = planned


@jit
def compare_closely(
    pi: Ints,
    pcp: Floats,
    tasks: Floats,
    n: int,
    gap: float,
    cusp_path: float,
    work: Floats,
    stack: Floats,
    budget: int,
    hits: Floats,
    found: int,
) -> int:
    """Last pass: the first `n` tasks by subdivision, their hits after the `found` already there; returns all hits."""
    for task in range(n):
        answer, s, t, budget = meet(pi, pcp, tasks, task, gap, cusp_path, work, stack, budget)
        if answer != APART:
            kind = MEET if answer == FOUND else UNDECIDED
            found = note(hits, found, int(tasks[task, PIECE_I]), s, int(tasks[task, PIECE_J]), t, kind)
        if answer == SPENT or found >= hits.shape[0]:
            break
    return found
