"""Do two adjacent pieces share more than their joint?

    Pieces A and B share V, the end of A and start of B. If the cones of their control points, seen from V, are disjoint
    they share nothing else. If not, cut off the far halves, which are adjacent to nothing (tasks for the general
    comparison), and look again nearer to V, until the cones part or A and B are too thin to tell apart (tip of a cusp).

             A \\      / B       Chords from V to points of A are positive combinations of P_k - V over A's control
                \\    /          points P_k, so disjoint cones hold disjoint curves.
                 \\  /
                  V

A tip too thin to tell its branches apart is accepted, unless they leave V in the other order than the one they have at
the far end of the tip: then they cross on the way (a handle on the wrong side of its cusp, common in glyphs).

Coordinates, piece tables and gentle pieces as in `mat_core.kernels.outline`.
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints, restrict
from mat_core.kernels.curve import bezier_frame
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.outline import BLOCK, CP0, DEG, span_of

# What adjacent pieces do at their joint.
PART, FOLD, CROSS = 0, 1, 2

# Columns of `tasks`: pieces i and j over [I0, I1] and [J0, J1], the boundary path from the end of i ahead to the start
# of j and from the end of j back to the start of i (infinite between loops, zero where they are adjacent).
PIECE_I, I0, I1, J0, J1, PIECE_J, AHEAD, BEHIND = 0, 1, 2, 3, 4, 5, 6, 7

NEAR_PATH = 16.0  # gaps of boundary path within which two points are one corner
THIN = 64.0  # gaps: a thinner tip is accepted; beyond it even branches that part like x**5 are 64 / 2**5 gaps apart
COINCIDENT = 2.0  # gaps: pieces nearer than this from end to end run back along each other
TIP_NOISE = 8.0  # roundings of the control points that may turn a tangent or bend a curve
SHORT_HANDLE = 1e6  # in gaps: a handle this short bends its curve back within a few gaps of V, where nothing is told apart
SAME_BEND = 1e-9  # relative difference below which two branches of a cusp bend alike
SAME_DIRECTION = 1e-10  # sine below which two cone sides count as one
NO_DIRECTION = 1e-15  # control points this near to V tell no direction: the rounding of normalised coordinates
SAMPLES = 8  # points at which a tip's thickness is measured
BISECTIONS = 45  # of a parameter range, when a footpoint is sought
DEEPEST = 50  # halvings towards V


@inner
def distance(a: Floats, i: int, b: Floats, j: int) -> float:
    """Between the points of row i of `a` and row j of `b`."""
    return math.hypot(a[i, 0] - b[j, 0], a[i, 1] - b[j, 1])


@inner
def cone_seen_from(rows: Floats, v: int, far: int, step: int, p: int) -> tuple[float, float, float, float]:
    """Unit sides lo (right) and hi (left) of the cone of p control points, from row `far` on, seen from row `v`."""
    lx = ly = hx = hy = 0.0
    for n in range(p):
        k = far - n * step
        length = distance(rows, k, rows, v)
        if length <= NO_DIRECTION:
            continue
        x = (rows[k, 0] - rows[v, 0]) / length
        y = (rows[k, 1] - rows[v, 1]) / length
        new = lx == 0.0 and ly == 0.0
        if new or hx * y - hy * x > 0.0:
            hx = x
            hy = y
        if new or lx * y - ly * x < 0.0:
            lx = x
            ly = y
    return lx, ly, hx, hy


@inner
def in_cone(x: float, y: float, lx: float, ly: float, hx: float, hy: float) -> bool:
    """Whether the unit vector (x, y) lies in the cone from lo to hi (under a half turn), widened by SAME_DIRECTION."""
    if x * (lx + hx) + y * (ly + hy) <= 0.0:
        return False
    return lx * y - ly * x >= -SAME_DIRECTION and x * hy - y * hx >= -SAME_DIRECTION


@inner
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
def place_on(rows: Floats, c: int, p: int, t: float, ox: float, oy: float) -> tuple[float, float, float, float]:
    """Point of a block relative to (ox, oy) and its derivative; on a line, which has no weights, along the chord."""
    if p == 1:
        dx = rows[c + 1, 0] - rows[c, 0]
        dy = rows[c + 1, 1] - rows[c, 1]
        return rows[c, 0] - ox + t * dx, rows[c, 1] - oy + t * dy, dx, dy
    x, y, dx, dy, _, _ = bezier_frame(rows, c, p, p, t, ox, oy)
    return x, y, dx, dy


@inner
def distance_to(rows: Floats, c: int, p: int, x: float, y: float) -> float:
    """Distance from (x, y) to the gentle block at row `c`: bisection of (C - q).C' from its two ends."""
    lo = 0.0
    hi = 1.0
    near = math.hypot(rows[c, 0] - x, rows[c, 1] - y)
    t = 1.0
    for _ in range(BISECTIONS):
        cx, cy, dx, dy = place_on(rows, c, p, t, x, y)
        d = math.hypot(cx, cy)
        if d < near:
            near = d
        if cx * dx + cy * dy < 0.0:
            lo = t
        else:
            hi = t
        t = 0.5 * (lo + hi)
    return near


@inner
def thickness(rows: Floats, p: int, q: int, limit: float) -> float:
    """How far the shorter of blocks 0 and BLOCK strays from the other, at SAMPLES points; stops beyond `limit`."""
    first = distance(rows, 0, rows, p) <= distance(rows, BLOCK, rows, BLOCK + q)
    c = 0 if first else BLOCK
    d = p if first else q
    thick = 0.0
    for k in range(SAMPLES):
        t = k / SAMPLES if first else 1.0 - k / SAMPLES
        x, y, _, _ = place_on(rows, c, d, t, 0.0, 0.0)
        off = distance_to(rows, BLOCK - c, p + q - d, x, y)
        if off > thick:
            thick = off
        if thick > limit:
            break
    return thick


@inner
def bend_at(rows: Floats, v: int, step: int, p: int) -> float:
    """Curvature, positive to the left, of a block that leaves row v; its next control points are `step` rows on."""
    if p < 2:
        return 0.0
    ax = rows[v + step, 0] - rows[v, 0]
    ay = rows[v + step, 1] - rows[v, 1]
    bx = rows[v + 2 * step, 0] - rows[v + step, 0]
    by = rows[v + 2 * step, 1] - rows[v + step, 1]
    length = math.hypot(ax, ay)
    share = rows[v, 2] / rows[v + step, 2] * (rows[v + 2 * step, 2] / rows[v + step, 2])
    return (p - 1.0) / p * share * (ax * by - ay * bx) / (length * length * length)


@inner
def side_of(rows: Floats, c: int, p: int, x: float, y: float) -> float:
    """Signed distance of (x, y) to the left of the gentle block at row `c`, at the foot that bisection finds."""
    lo = 0.0
    hi = 1.0
    side = 0.0
    for _ in range(BISECTIONS):
        t = 0.5 * (lo + hi)
        cx, cy, dx, dy = place_on(rows, c, p, t, x, y)
        speed = math.hypot(dx, dy)
        if speed > 0.0:
            side = (cx * dy - cy * dx) / speed
        if cx * dx + cy * dy < 0.0:
            lo = t
        else:
            hi = t
    return side


@inner
def order_at_tip(pcp: Floats, va: int, p: int, vb: int, q: int, gap: float, noise: float) -> float:
    """Positive where the piece that ends in row `va` leaves this V to the left of the one that starts in row `vb`.

    By the tangents, else by the curvatures. Zero where rounding (`noise`, of the control points) could have made the
    difference, or where branches of that curvature are in the other order from `gap` on.
    """
    a = distance(pcp, va, pcp, va - 1)
    b = distance(pcp, vb, pcp, vb + 1)
    if min(a, b) <= max(TIP_NOISE * noise, SHORT_HANDLE * gap):
        return 0.0
    ax = (pcp[va - 1, 0] - pcp[va, 0]) / a
    ay = (pcp[va - 1, 1] - pcp[va, 1]) / a
    bx = (pcp[vb + 1, 0] - pcp[vb, 0]) / b
    by = (pcp[vb + 1, 1] - pcp[vb, 1]) / b
    turn = bx * ay - by * ax
    bend_a = bend_at(pcp, va, -1, p)
    bend_b = bend_at(pcp, vb, 1, q)
    bend = bend_a - bend_b
    if abs(turn) > TIP_NOISE * noise * (1.0 / a + 1.0 / b):
        return 0.0 if turn * bend < 0.0 and 2.0 * abs(turn) <= gap * abs(bend) else turn
    alike = SAME_BEND * (abs(bend_a) + abs(bend_b))
    return bend if abs(bend) > max(alike, TIP_NOISE * noise * (1.0 / (a * a) + 1.0 / (b * b))) else 0.0


@inner
def order_beyond_tip(rows: Floats, p: int, q: int) -> float:
    """The same at the far end of the shorter one of blocks 0 and BLOCK, as a distance."""
    if distance(rows, 0, rows, p) <= distance(rows, BLOCK, rows, BLOCK + q):
        return side_of(rows, BLOCK, q, rows[0, 0], rows[0, 1])
    # Left of A as it runs towards V is right of it seen from V, and B to the right of A is A to the left of B.
    return side_of(rows, 0, p, rows[BLOCK + q, 0], rows[BLOCK + q, 1])


@inner
def lines_fold(pcp: Floats, a: int, b: int, gap: float) -> bool:
    """Does segment b, which starts where segment a ends, run back along a (the shorter within `gap` of the other)?"""
    ux = pcp[a, 0] - pcp[a + 1, 0]
    uy = pcp[a, 1] - pcp[a + 1, 1]
    vx = pcp[b + 1, 0] - pcp[b, 0]
    vy = pcp[b + 1, 1] - pcp[b, 1]
    off = abs(ux * vy - uy * vx)
    along = ux * vx + uy * vy > 0.0
    return along and (off <= gap * math.hypot(ux, uy) or off <= gap * math.hypot(vx, vy))


@inner
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


@inner
def plan_joint(
    pi: Ints,
    pcp: Floats,
    i: int,
    i0: float,
    j: int,
    j1: float,
    far: float,
    gap: float,
    noise: float,
    work: Floats,
    tasks: Floats,
    n: int,
) -> tuple[int, int]:
    """Adjacent pieces i over [i0, 1] and j over [0, j1] share V, the end of i and start of j. What else may they share?

    Returns PART, FOLD (j runs back along i) or CROSS (in the tip at V), and the number of tasks with the parts still to
    be compared appended. `far`: path from the end of j on to the start of i.
    """
    p = pi[i, DEG]
    q = pi[j, DEG]
    for step in range(DEEPEST):
        restrict(pcp, pi[i, CP0], p, i0, 1.0, work, 0)
        restrict(pcp, pi[j, CP0], q, 0.0, j1, work, BLOCK)
        if cones_part(work, p, q):
            break
        sa = span_of(work, 0, p)
        sb = span_of(work, BLOCK, q)
        thick = thickness(work, p, q, THIN * gap)
        if thick <= THIN * gap:
            longer = sa > NEAR_PATH * gap and sb > NEAR_PATH * gap
            if step == 0 and longer and thick <= COINCIDENT * gap:
                return FOLD, n
            near = order_at_tip(pcp, pi[i, CP0] + p, p, pi[j, CP0], q, gap, noise)
            beyond = order_beyond_tip(work, p, q)
            return CROSS if near * beyond < 0.0 and abs(beyond) > TIP_NOISE * noise else PART, n
        # The far halves are adjacent to nothing any more; a much shorter piece stays whole.
        im = 0.5 * (i0 + 1.0) if sa >= 0.25 * sb else i0
        jm = 0.5 * j1 if sb >= 0.25 * sa else j1
        if im > i0:
            n = plan(tasks, n, i, i0, im, j, 0.0, j1, 0.0, far)
        if jm < j1:
            n = plan(tasks, n, i, im, 1.0, j, jm, j1, 0.0, far)
        i0 = im
        j1 = jm
    return PART, n
