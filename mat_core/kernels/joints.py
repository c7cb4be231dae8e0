"""Do two adjacent pieces share more than their joint?

    Pieces A and B share V, the end of A and start of B. If the cones of their control points, seen from V, are disjoint
    they share nothing else. If not, cut off the far halves, which are adjacent to nothing (tasks for the general
    comparison), and look again nearer to V, until the cones part or A and B are too thin to tell apart (tip of a cusp).

             A \\      / B       Chords from V to points of A are positive combinations of P_k - V over A's control
                \\    /          points P_k, so disjoint cones hold disjoint curves.
                 \\  /
                  V

Coordinates, piece tables and gentle pieces as in `mat_core.kernels.outline`.
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints, bernstein_sum, derivatives, restrict
from mat_core.kernels.jit import jit
from mat_core.kernels.outline import BLOCK, CP0, DEEPEST, DEG

# Columns of `tasks`: pieces i and j over [I0, I1] and [J0, J1], the boundary path from the end of i ahead to the start
# of j and from the end of j back to the start of i (infinite between loops, zero where they are adjacent).
PIECE_I, I0, I1, J0, J1, PIECE_J, AHEAD, BEHIND = 0, 1, 2, 3, 4, 5, 6, 7

NEAR_PATH = 16.0  # gaps of boundary path within which two points are one corner
THIN = 64.0  # gaps: a thinner tip is accepted; beyond it even branches that part like x**5 are 64 / 2**5 gaps apart
COINCIDENT = 2.0  # gaps: pieces nearer than this from end to end run back along each other
SAME_DIRECTION = 1e-10  # sine below which two cone sides count as one
NO_DIRECTION = 1e-15  # control points this near to V tell no direction: the rounding of normalised coordinates
SAMPLES = 8  # points at which a tip's thickness is measured
BISECTIONS = 45  # of a parameter range, when a footpoint is sought


@jit
def span_of(rows: Floats, c: int, p: int) -> float:
    """Largest distance, by coordinate, of a block's control points from its first one."""
    extent = 0.0
    for i in range(1, p + 1):
        dx = abs(rows[c + i, 0] - rows[c, 0])
        dy = abs(rows[c + i, 1] - rows[c, 1])
        extent = dx if dx > extent else extent
        extent = dy if dy > extent else extent
    return extent


@jit
def cone_seen_from(rows: Floats, v: int, far: int, step: int, p: int) -> tuple[float, float, float, float]:
    """Unit sides lo (right) and hi (left) of the cone of p control points, from row `far` on, seen from row `v`."""
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
    near = min(math.hypot(rows[c, 0] - x, rows[c, 1] - y), math.hypot(rows[c + p, 0] - x, rows[c + p, 1] - y))
    for _ in range(BISECTIONS):
        t = 0.5 * (lo + hi)
        cx, cy, dx, dy, _, _ = derivatives(rows, c, p, t, x, y)
        near = min(near, math.hypot(cx, cy))
        if cx * dx + cy * dy < 0.0:
            lo = t
        else:
            hi = t
    return near


@jit
def thickness(rows: Floats, p: int, q: int, limit: float) -> float:
    """How far the shorter of blocks 0 and BLOCK strays from the other, at SAMPLES points; stops beyond `limit`."""
    la = math.hypot(rows[p, 0] - rows[0, 0], rows[p, 1] - rows[0, 1])
    lb = math.hypot(rows[BLOCK + q, 0] - rows[BLOCK, 0], rows[BLOCK + q, 1] - rows[BLOCK, 1])
    c = 0 if la <= lb else BLOCK
    d = p if la <= lb else q
    other = BLOCK if la <= lb else 0
    degree = q if la <= lb else p
    thick = 0.0
    for k in range(SAMPLES):
        t = k / SAMPLES if la <= lb else 1.0 - k / SAMPLES
        ox = rows[c, 0]
        oy = rows[c, 1]
        sx, sy, sw = bernstein_sum(rows, c, d, t, ox, oy)
        thick = max(thick, distance_to(rows, other, degree, ox + sx / sw, oy + sy / sw))
        if thick > limit:
            break
    return thick


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
def plan(
    tasks: Floats, n: int, i: int, i0: float, i1: float, j: int, j0: float, j1: float, ahead: float, behind: float
) -> int:
    """Append a task; returns the new number of tasks (beyond the buffer they are only counted)."""
    if n < tasks.shape[0]:
        tasks[n, PIECE_I] = i
        tasks[n, I0] = i0
        tasks[n, I1] = i1
        tasks[n, J0] = j0
        tasks[n, J1] = j1
        tasks[n, PIECE_J] = j
        tasks[n, AHEAD] = ahead
        tasks[n, BEHIND] = behind
    return n + 1


@jit
def plan_joint(
    pi: Ints,
    pcp: Floats,
    i: int,
    i0: float,
    j: int,
    j1: float,
    far: float,
    gap: float,
    work: Floats,
    tasks: Floats,
    n: int,
) -> tuple[bool, int]:
    """Adjacent pieces i over [i0, 1] and j over [0, j1] share V, the end of i and start of j. What else may they share?

    Returns whether j runs back along i, and the number of tasks with the parts still to be compared appended. `far`:
    path from the end of j on to the start of i.
    """
    p = pi[i, DEG]
    q = pi[j, DEG]
    for step in range(DEEPEST):
        restrict(pcp, pi[i, CP0], p, i0, 1.0, work, 0)
        restrict(pcp, pi[j, CP0], q, 0.0, j1, work, BLOCK)
        if cones_part(work, p, q):
            return False, n
        sa = span_of(work, 0, p)
        sb = span_of(work, BLOCK, q)
        thick = thickness(work, p, q, THIN * gap)
        if thick <= THIN * gap:
            longer = sa > NEAR_PATH * gap and sb > NEAR_PATH * gap
            return step == 0 and longer and thick <= COINCIDENT * gap, n
        # The far halves are adjacent to nothing any more; a much shorter piece stays whole.
        im = 0.5 * (i0 + 1.0) if sa >= 0.25 * sb else i0
        jm = 0.5 * j1 if sb >= 0.25 * sa else j1
        if im > i0:
            n = plan(tasks, n, i, i0, im, j, 0.0, j1, 0.0, far)
        if jm < j1:
            n = plan(tasks, n, i, im, 1.0, j, jm, j1, 0.0, far)
        i0 = im
        j1 = jm
    return False, n
