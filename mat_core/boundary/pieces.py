"""Cut Bezier pieces into arcs of monotone curvature: LINE, ARC or SPIRAL.

The discs-first method needs boundary pieces that no circle touches twice (Vogt's theorem: arcs of monotone curvature), so a
Bezier is cut at every sign change of k' (`boundary.curvature`). Pieces that turn by more than a right angle are halved: their
boxes are small and their tangents bracket.
"""

from __future__ import annotations

import math

from mat_core.boundary.curvature import SHORT, SMALLEST_PART, circle_of, curvature_changes, extent, place_part
from mat_core.boundary.joints import end_frame
from mat_core.kernels.bezier import balance, restrict
from mat_core.kernels.curve import bezier_frame
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import ARC, LINE, SPIRAL

# columns of the tables of pieces
P_KIND, P_DEG, P_CP0, P_RATIONAL, P_EDGE, P_SPAN = range(6)
P_UA, P_UB, P_SKEW, P_X, P_Y, P_CURVATURE, P_CENTRE_X, P_CENTRE_Y, P_FRAME = range(9)
P_X_LOW, P_Y_LOW = 14, 15
# P_SKEW: as `layout.SKEW`; P_X, P_Y: start, P_X_LOW, P_Y_LOW: its further digits; P_FRAME: tx, ty, k at both ends
PI_WIDTH = 6
PF_WIDTH = 16

MAX_TURN = 1.65  # a little over a right angle, so that quarter turns stay whole
ROOT_GAP = 1e-12  # cuts nearer than this to an end or to each other (in the parameter) are one
IDLE = 1e-9  # where a maximum of the curvature is this near to a joint, both are one leaf,
AT_REST = 1e-13  # if the curvatures differ by less than this, relatively
TRIM = 2e-13  # a bend at an end of an edge that is shorter than this is cut off: no disc tells it from the vertex
SHORT_HANDLE = 1e-6  # only a handle shorter than this can make one
HAIRPIN = 0.1  # radians; what turns by less is no such bend
UNEVEN = 64.0  # ratio of weights up to which the numerator of k' has its signs right
TIGHT = 1e4  # curvature of a bend that looks like a corner, and root of its ratio to that of what looks straight beside it
SLIGHT = 0.01  # radians; half a turn smaller than this is not cut off


@inner
def _from_nearer_end(cp, c0, deg, rational, s):
    """`bezier_frame` relative to the nearer end: a rational curve that stands still there has no speed left over by rounding.

    Such a rest would be taken for a direction, and what it turns by for a bend.
    """
    near = c0 if s <= 0.5 else c0 + deg
    return bezier_frame(cp, c0, deg, rational, s, cp[near, 0], cp[near, 1])


@inner
def total_turning(cp, c0, deg, rational, begin, end):
    """Sum of the absolute turns of the tangent between nine parameters (pieces here have at most one inflection)."""
    total = 0.0
    px = py = 0.0
    for step in range(9):
        s = begin + 0.125 * step * (end - begin)
        x, y, x1, y1, x2, y2 = _from_nearer_end(cp, c0, deg, rational, s)
        if x1 == 0.0 and y1 == 0.0:
            continue
        if px != 0.0 or py != 0.0:
            total += abs(math.atan2(px * y1 - py * x1, px * x1 + py * y1))
        px = x1
        py = y1
    return total


@inner
def is_straight(cp, c0, deg, rounding):
    """True if all control points lie on the chord, in order, up to rounding."""
    ex = cp[c0 + deg, 0] - cp[c0, 0]
    ey = cp[c0 + deg, 1] - cp[c0, 1]
    length = math.sqrt(ex * ex + ey * ey)
    if length == 0.0:
        return False
    last = 0.0
    for i in range(1, deg + 1):
        x = cp[c0 + i, 0] - cp[c0, 0]
        y = cp[c0 + i, 1] - cp[c0, 1]
        if abs(ex * y - ey * x) > rounding * length:
            return False
        along = (ex * x + ey * y) / length
        if along < last - rounding:
            return False
        last = along
    return True


@inner
def _part_frames(cp, c0, deg, rational, begin, end, target, noise, pieces_f, row):
    """Unit tangents and curvatures at both ends of a part, from the whole Bezier unless that stands still there."""
    for side in range(2):
        s = begin if side == 0 else end
        if 0.0 < s < 1.0:
            x, y, x1, y1, x2, y2 = _from_nearer_end(cp, c0, deg, rational, s)
            speed = math.sqrt(x1 * x1 + y1 * y1)
            if speed > 1e-9 * math.sqrt(x2 * x2 + y2 * y2):
                tx = x1 / speed
                ty = y1 / speed
                k = (x1 * y2 - y1 * x2) / (speed * speed * speed)
            else:
                tx, ty, k = end_frame(cp, target, deg, side == 1, noise)
        else:
            tx, ty, k = end_frame(cp, c0, deg, side == 1, noise)
        pieces_f[row, P_FRAME + 3 * side] = tx
        pieces_f[row, P_FRAME + 3 * side + 1] = ty
        pieces_f[row, P_FRAME + 3 * side + 2] = k


@inner
def _apart(cp, c0, deg, rational, a, b):
    """Distance of the points at two parameters."""
    near = c0 if a + b <= 1.0 else c0 + deg
    ax, ay, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, a, cp[near, 0], cp[near, 1])
    bx, by, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, b, cp[near, 0], cp[near, 1])
    return math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))


@inner
def _curvature(cp, c0, deg, rational, s):
    """Curvature at s; infinite where the Bezier stands still."""
    x, y, x1, y1, x2, y2 = _from_nearer_end(cp, c0, deg, rational, s)
    speed = math.sqrt(x1 * x1 + y1 * y1)
    return (x1 * y2 - y1 * x2) / (speed * speed * speed) if speed > 0.0 else math.inf


@inner
def _is_idle(cp, c0, deg, rational, a, b, rounding):
    """Whether the part [a, b] is no piece of its own: it has no direction, or is short and its curvature rests."""
    length = _apart(cp, c0, deg, rational, a, b)
    if length < SHORT * rounding:
        return True
    if length > IDLE:
        return False
    k = _curvature(cp, c0, deg, rational, a)
    return abs(_curvature(cp, c0, deg, rational, b) - k) <= AT_REST * abs(k) < math.inf


@inner
def _trimmed(cp, c0, deg, rational, end, roots, n_roots):
    """Where a Bezier begins (end = 0) or ends (end = 1) when a bend there is cut off; `_mended` brings it back to its vertex.

    Font tools leave handles of a few roundings in any direction: the curve sets out along the handle and turns back at once.
    """
    tip = -1
    for step in range(n_roots):
        i = step if end == 0 else n_roots - 1 - step
        if _apart(cp, c0, deg, rational, float(end), roots[i]) >= TRIM:
            break
        tip = i
    p = c0 + deg * end
    q = p + (1 - 2 * end)
    handle = math.sqrt((cp[q, 0] - cp[p, 0]) ** 2 + (cp[q, 1] - cp[p, 1]) ** 2)
    if tip < 0 and (handle == 0.0 or handle > SHORT_HANDLE):
        return float(end)
    near = roots[tip] if tip >= 0 else float(end)
    far = 1.0 - end
    beyond = tip + 1 if end == 0 else (tip if tip >= 0 else n_roots) - 1
    if 0 <= beyond < n_roots:
        far = roots[beyond]
    for _ in range(60):
        m = 0.5 * (near + far)
        if _apart(cp, c0, deg, rational, float(end), m) < 2.0 * TRIM:
            near = m
        else:
            far = m
    turning = total_turning(cp, c0, deg, rational, min(far, float(end)), max(far, float(end)))
    return far if turning > HAIRPIN else float(end)


@inner
def _tight_cut(cp, c0, deg, rational, begin, end):
    """Where half the turn of a part lies behind, if nearly all of it happens in a tight bend at one of its ends; else `end`.

    Cut again and again the parts grow away from the bend as its radius does: the parameter of none has too few digits there.
    """
    x, y, ax, ay, bx, by = _from_nearer_end(cp, c0, deg, rational, begin)
    x, y, dx, dy, ex, ey = _from_nearer_end(cp, c0, deg, rational, end)
    first = ax * ax + ay * ay
    last = dx * dx + dy * dy
    if first == 0.0 or last == 0.0:
        return end
    k0 = abs(ax * by - ay * bx) / (first * math.sqrt(first))
    k1 = abs(dx * ey - dy * ex) / (last * math.sqrt(last))
    half = 0.5 * math.atan2(ax * dy - ay * dx, ax * dx + ay * dy)
    if max(k0, k1) < TIGHT or max(k0, k1) < TIGHT * TIGHT * min(k0, k1) or abs(half) < SLIGHT:
        return end
    lo = begin
    hi = end
    for _ in range(60):
        m = 0.5 * (lo + hi)
        x, y, dx, dy, ex, ey = _from_nearer_end(cp, c0, deg, rational, m)
        if abs(math.atan2(ax * dy - ay * dx, ax * dx + ay * dy)) < abs(half):
            lo = m
        else:
            hi = m
    return lo if begin < lo < end else end


@inner
def _moved(high, low, by):
    """high + low + by as a number in two parts, the first one rounded."""
    rounded = high + by
    rest = rounded - high
    low += (high - (rounded - rest)) + (by - rest)
    return rounded + low, low - ((rounded + low) - rounded)


@inner
def _longest(cp, deg, pieces_i, first, count):
    """The piece of a Bezier with the ends farthest apart: what must give, gives there."""
    longest = first
    most = -1.0
    for p in range(first, count):
        end = pieces_i[p, P_CP0] + deg
        size = abs(cp[end, 0]) + abs(cp[end, 1])
        if size > most:
            most = size
            longest = p
    return longest


@inner
def _mended(cp, c0, deg, rational, begin, end, target):
    """Shear the piece in rows target.. by what is cut off of its Bezier outside [begin, end]: its pieces meet the vertices.

    A piece that ended beside its vertex was in two places, seen from either end.
    """
    ax, ay, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, begin, cp[c0, 0], cp[c0, 1])
    bx, by, x1, y1, x2, y2 = bezier_frame(cp, c0, deg, rational, end, cp[c0 + deg, 0], cp[c0 + deg, 1])
    for i in range(1, deg + 1):
        cp[target + i, 0] += i * (ax - bx) / deg
        cp[target + i, 1] += i * (ay - by) / deg


@inner
def _chain(cp, c0, deg, pieces_i, pieces_f, first, longest, count):
    """Starts of the pieces of one Bezier to more digits, each where the one before ends by its own control points.

    So pieces that are near each other, with tiny ones in between, keep the digits of their differences. What rounding leaves over
    goes to the longest piece; those behind it are placed from the end of the Bezier.
    """
    for axis in range(2):
        pieces_f[first, P_X + axis] = cp[c0, axis]
        for p in range(first + 1, longest + 1):
            pieces_f[p, P_X + axis], pieces_f[p, P_X_LOW + axis] = _moved(
                pieces_f[p - 1, P_X + axis], pieces_f[p - 1, P_X_LOW + axis], cp[pieces_i[p - 1, P_CP0] + deg, axis])
        high = cp[c0 + deg, axis]
        low = 0.0
        for p in range(count - 1, longest, -1):
            high, low = _moved(high, low, -cp[pieces_i[p, P_CP0] + deg, axis])
            pieces_f[p, P_X + axis] = high
            pieces_f[p, P_X_LOW + axis] = low


@inner
def _cut_bezier(cp, c0, deg, rational, edge, span, ua, ub, skew, cp_used, count, pieces_i, pieces_f, rounding, noise, table, work,
                bounds, roots):
    """Cut one Bezier into pieces; returns the new (pieces, rows of cp), pieces = -1 if a buffer is too small."""
    kind = SPIRAL
    k = cx = cy = 0.0
    n_roots = 0
    if is_straight(cp, c0, deg, rounding):
        kind = LINE
    else:
        if rational == 1:
            k, cx, cy = circle_of(cp, c0, deg, 8.0 * rounding, table)
        if k != 0.0:
            kind = ARC
        else:
            n_roots = curvature_changes(cp, c0, deg, rational, cp_used, rounding, table, work, bounds, roots)
            if n_roots < 0:
                return -1, cp_used
    first = count
    gap = max(ROOT_GAP, SHORT * rounding / extent(cp, c0, deg))
    start = _trimmed(cp, c0, deg, rational, 0, roots, n_roots)
    last = _trimmed(cp, c0, deg, rational, 1, roots, n_roots)
    if not start < last:
        start = 0.0
        last = 1.0
    begin = start
    for cut in range(n_roots + 1):
        stop = last
        if cut < n_roots:
            stop = roots[cut]
            if stop - begin < gap or last - stop < gap:
                continue
            if _is_idle(cp, c0, deg, rational, begin, stop, rounding) or _is_idle(cp, c0, deg, rational, stop, last, rounding):
                continue
        while begin < stop:
            end = stop
            while kind != LINE and end - begin > 1e-9 and total_turning(cp, c0, deg, rational, begin, end) > MAX_TURN:
                end = begin + 0.5 * (end - begin)
            while kind == SPIRAL:
                cut_at = _tight_cut(cp, c0, deg, rational, begin, end)
                if not cut_at < end:
                    break
                end = cut_at
            if count >= pieces_i.shape[0] or cp_used + deg + 1 > cp.shape[0]:
                return -1, cp_used
            pieces_f[count, P_X], pieces_f[count, P_Y] = place_part(cp, c0, deg, rational, begin, end, table, cp_used)
            pieces_f[count, P_X_LOW] = pieces_f[count, P_Y_LOW] = 0.0
            if kind == SPIRAL:
                _part_frames(cp, c0, deg, rational, begin, end, cp_used, noise, pieces_f, count)
            pieces_i[count, P_KIND] = kind
            pieces_i[count, P_DEG] = deg
            pieces_i[count, P_CP0] = cp_used
            pieces_i[count, P_RATIONAL] = rational
            pieces_i[count, P_EDGE] = edge
            pieces_i[count, P_SPAN] = span
            before = skew * begin + (1.0 - begin)
            after = skew * end + (1.0 - end)
            pieces_f[count, P_UA] = ua + skew * begin / before * (ub - ua)
            pieces_f[count, P_UB] = ub if end == 1.0 else ua + skew * end / after * (ub - ua)
            pieces_f[count, P_SKEW] = before / after
            pieces_f[count, P_CURVATURE] = k
            pieces_f[count, P_CENTRE_X] = cx
            pieces_f[count, P_CENTRE_Y] = cy
            cp_used += deg + 1
            count += 1
            begin = end
    longest = _longest(cp, deg, pieces_i, first, count)
    if start > 0.0 or last < 1.0:
        _mended(cp, c0, deg, rational, start, last, pieces_i[longest, P_CP0])
    _chain(cp, c0, deg, pieces_i, pieces_f, first, longest, count)
    return count, cp_used


@inner
def _is_uneven(cp, c0, deg):
    """Whether the weights of a Bezier differ so much that the signs of k' drown in rounding."""
    low = high = cp[c0, 2]
    for i in range(1, deg + 1):
        low = min(low, cp[c0 + i, 2])
        high = max(high, cp[c0 + i, 2])
    return high > UNEVEN * low


@inner
def cut_beziers(bez_i, bez_u, bez_loop_start, cp, cp_used, pieces_i, pieces_f, piece_loop_start, rounding, noise, table, work,
                bounds, roots):
    """Cut all Beziers (rows of `bez_i`: degree, cp0, rational, edge, span; `bez_u`: ua, ub, skew) into pieces, in loop order.

    New control points go behind row `cp_used` of `cp`, relative to the start of their piece; a piece ends where the next starts.
    Beziers with very uneven weights are halved first, and balanced, until they are not.
    Returns (pieces, rows of cp); pieces = -1 if a buffer is too small.
    """
    count = 0
    piece_loop_start[0] = 0
    for loop in range(bez_loop_start.shape[0] - 1):
        for b in range(bez_loop_start[loop], bez_loop_start[loop + 1]):
            deg = bez_i[b, 0]
            c0 = bez_i[b, 1]
            ua = bez_u[b, 0]
            ub = bez_u[b, 1]
            skew = bez_u[b, 2]
            begin = 0.0
            u_begin = ua
            step = 1.0
            while begin < 1.0:
                end = min(begin + step, 1.0)
                part = c0
                u_end = ub
                part_skew = skew
                if _is_uneven(cp, c0, deg):
                    if cp_used + deg + 1 > cp.shape[0]:
                        return -1, cp_used
                    restrict(cp, c0, deg, begin, end, cp, cp_used)
                    before = skew * begin + (1.0 - begin)
                    after = skew * end + (1.0 - end)
                    if end < 1.0:
                        u_end = ua + skew * end / after * (ub - ua)
                    part_skew = after / before * balance(cp, cp_used, deg)
                    if step > SMALLEST_PART and _is_uneven(cp, cp_used, deg):
                        step *= 0.5
                        continue
                    part = cp_used
                    cp_used += deg + 1
                count, cp_used = _cut_bezier(cp, part, deg, bez_i[b, 2], bez_i[b, 3], bez_i[b, 4], u_begin, u_end, part_skew,
                                             cp_used, count, pieces_i, pieces_f, rounding, noise, table, work, bounds, roots)
                if count < 0:
                    return -1, cp_used
                begin = end
                u_begin = u_end
                step *= 2.0
        piece_loop_start[loop + 1] = count
    return count, cp_used
