"""Cut Bezier pieces into arcs of monotone curvature: LINE, ARC or SPIRAL.

The discs-first method needs boundary pieces that no circle touches twice (Vogt's theorem: arcs of monotone curvature), so a
Bezier is cut at every sign change of k' (`boundary.curvature`). Pieces that turn by more than a right angle are halved: their
boxes are small and their tangents bracket.
"""

from __future__ import annotations

import math

from mat_core.boundary.bends import extreme_at_end, is_cut_with_peak, is_idle, tight_cut, total_turning, trimmed
from mat_core.boundary.chain import (
    CUT_OFF,
    CUT_WITH_PEAK,
    EXTREME,
    P_CENTRE_X,
    P_CENTRE_Y,
    P_CP0,
    P_CURVATURE,
    P_DEG,
    P_EDGE,
    P_FRAME,
    P_GOES_ON,
    P_KIND,
    P_RATIONAL,
    P_SKEW,
    P_SPAN,
    P_UA,
    P_UB,
    PLAIN,
    chain,
    cut_off,
    go_on,
    handle,
    longest_of,
    stretch,
)
from mat_core.boundary.curvature import circle_of, curvature_changes
from mat_core.boundary.faint import before_rise
from mat_core.boundary.joints import end_frame
from mat_core.boundary.parts import SHORT, UNEVEN, about_nearest, even_end, extent, from_nearest, place_part
from mat_core.kernels.bezier import balance, unevenness
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import ARC, LINE, SPIRAL

MAX_TURN = 1.65  # a little over a right angle, so that quarter turns stay whole
SHORTEST = 1e-9  # of the parameter; what is shorter is not halved, however much it turns
LEAN = 1e-3  # radians; a piece that would lean by more is too short to make up for what was cut off
ROOT_GAP = 1e-12  # cuts nearer than this to an end or to each other (in the parameter) are one


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
            x, y, x1, y1, x2, y2 = from_nearest(cp, c0, deg, rational, s)
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
def _cut_kind(cp, c0, deg, rational, end, at, roots, n_roots):
    """CUT_OFF or CUT_WITH_PEAK where a Bezier begins or ends at the parameter `at`, PLAIN where that is its own end."""
    if at == float(end):
        return PLAIN
    return CUT_WITH_PEAK if is_cut_with_peak(cp, c0, deg, rational, end, at, roots, n_roots) else CUT_OFF


@inner
def _take_extreme(cp, c0, deg, rational, end, roots, n_roots, pieces_f, row, rounding):
    """Let a piece at an end of its Bezier have the curvature of `extreme_at_end` there: EXTREME if it is another, else PLAIN."""
    column = P_FRAME + 3 * end + 2
    k = pieces_f[row, column]
    pieces_f[row, column] = extreme_at_end(cp, c0, deg, rational, end, roots, n_roots, k, rounding)
    return PLAIN if pieces_f[row, column] == k else EXTREME


@inner
def _gentle_end(cp, c0, deg, rational, begin, end, kind, rounding):
    """How far a piece from `begin` on may go: it turns by little more than a right angle, and by no tight bend at an end."""
    while end - begin > SHORTEST and total_turning(cp, c0, deg, rational, begin, end) > MAX_TURN:
        end = begin + 0.5 * (end - begin)
    while kind == SPIRAL:
        cut_at = tight_cut(cp, c0, deg, rational, begin, end, rounding)
        if not cut_at < end:
            break
        end = cut_at
    return end


@inner
def _pace(pieces_f, p, begin, end, ua, ub, skew):
    """The edge's parameter along the part [begin, end] of a Bezier, see `layout.SKEW`."""
    before = skew * begin + (1.0 - begin)
    after = skew * end + (1.0 - end)
    pieces_f[p, P_UA] = ua + skew * begin / before * (ub - ua)
    pieces_f[p, P_UB] = ub if end == 1.0 else ua + skew * end / after * (ub - ua)
    pieces_f[p, P_SKEW] = before / after


@inner
def _simple_kind(cp, c0, deg, rational, rounding, table):
    """(LINE, ARC or else SPIRAL, curvature and centre of an ARC) of a Bezier."""
    if is_straight(cp, c0, deg, rounding):
        return LINE, 0.0, 0.0, 0.0
    k = cx = cy = 0.0
    if rational == 1:
        k, cx, cy = circle_of(cp, c0, deg, 8.0 * rounding, table)
    return ARC if k != 0.0 else SPIRAL, k, cx, cy


@inner
def _cut_bezier(cp, c0, deg, rational, bent, edge, span, ua, ub, skew, cp_used, count, pieces_i, pieces_f, rounding, noise, table,
                work, bounds, roots):
    """Cut one Bezier into pieces; returns (pieces, rows of cp, what is at its start and end, way in x, y).

    The way is that along what was cut off, where no piece is long enough to make up for it.

    pieces = -1 if a buffer is too small. A part of one that is known to be bent is neither straight nor an arc, however short.
    """
    n_roots = 0
    kind, k, cx, cy = (SPIRAL, 0.0, 0.0, 0.0) if bent else _simple_kind(cp, c0, deg, rational, rounding, table)
    if kind == SPIRAL:
        n_roots = curvature_changes(cp, c0, deg, rational, cp_used, rounding, table, work, bounds, roots)
        if n_roots < 0:
            return -1, cp_used, PLAIN, PLAIN, 0.0, 0.0
    first = count
    gap = max(ROOT_GAP, SHORT * rounding / extent(cp, c0, deg))
    start = trimmed(cp, c0, deg, rational, 0, roots, n_roots, noise)
    last = trimmed(cp, c0, deg, rational, 1, roots, n_roots, noise)
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
            if is_idle(cp, c0, deg, rational, begin, stop, rounding) or is_idle(cp, c0, deg, rational, stop, last, rounding):
                continue
        while begin < stop:
            end = stop if kind == LINE else _gentle_end(cp, c0, deg, rational, begin, stop, kind, rounding)
            if count >= pieces_i.shape[0] or cp_used + deg + 1 > cp.shape[0]:
                return -1, cp_used, PLAIN, PLAIN, 0.0, 0.0
            x, y = place_part(cp, c0, deg, rational, begin, end, table, cp_used)
            if kind == SPIRAL:
                _part_frames(cp, c0, deg, rational, begin, end, cp_used, noise, pieces_f, count)
            pieces_i[count, P_KIND] = kind
            pieces_i[count, P_DEG] = deg
            pieces_i[count, P_CP0] = cp_used
            pieces_i[count, P_RATIONAL] = rational
            pieces_i[count, P_EDGE] = edge
            pieces_i[count, P_SPAN] = span
            pieces_i[count, P_GOES_ON] = 0
            _pace(pieces_f, count, begin, end, ua, ub, skew)
            pieces_f[count, P_CURVATURE] = k
            pieces_f[count, P_CENTRE_X] = cx - x
            pieces_f[count, P_CENTRE_Y] = cy - y
            cp_used += deg + 1
            count += 1
            begin = end
    begins = _cut_kind(cp, c0, deg, rational, 0, start, roots, n_roots)
    ends = _cut_kind(cp, c0, deg, rational, 1, last, roots, n_roots)
    if begins == PLAIN and n_roots > 0:
        begins = _take_extreme(cp, c0, deg, rational, 0, roots, n_roots, pieces_f, first, rounding)
    if ends == PLAIN and n_roots > 0:
        ends = _take_extreme(cp, c0, deg, rational, 1, roots, n_roots, pieces_f, count - 1, rounding)
    off_x = off_y = 0.0
    if begins < EXTREME or ends < EXTREME:
        off_x, off_y = cut_off(cp, c0, deg, rational, start, last)
        if stretch(cp, pieces_i[longest_of(cp, deg, pieces_i, first, count), P_CP0], deg, off_x, off_y, LEAN):
            off_x = off_y = 0.0
    return count, cp_used, begins, ends, off_x, off_y


@inner
def cut_beziers(bez_i, bez_f, bez_loop_start, cp, cp_low, cp_used, pieces_i, pieces_f, piece_loop_start, rounding, noise, table,
                work, bounds, roots):
    """Cut all Beziers (rows of `bez_i`, `bez_f`, see `boundary.edges`) into pieces, in loop order.

    New control points go behind row `cp_used` of `cp`, relative to the start of their piece; a piece ends where the next starts.
    Beziers with very uneven weights are halved first, and balanced, until they are not.
    Returns (pieces, rows of cp); pieces = -1 if a buffer is too small.
    """
    count = 0
    ended = PLAIN
    left = 0.0
    piece_loop_start[0] = 0
    for loop in range(bez_loop_start.shape[0] - 1):
        for b in range(bez_loop_start[loop], bez_loop_start[loop + 1]):
            deg = bez_i[b, 0]
            c0 = bez_i[b, 1]
            ua = bez_f[b, 0]
            ub = bez_f[b, 1]
            skew = bez_f[b, 2]
            first = count
            uneven = deg > 1 and unevenness(cp, c0, deg) > UNEVEN
            bent = uneven and _simple_kind(cp, c0, deg, 1, rounding, table)[0] == SPIRAL
            off_x = off_y = 0.0
            begin = 0.0
            u_begin = ua
            step = 1.0
            while begin < 1.0:
                end = min(begin + step, 1.0)
                part = c0
                u_end = ub
                part_skew = skew
                if uneven:
                    part = cp_used
                    about = cp_used + deg + 1
                    if about + deg + 1 > cp.shape[0]:
                        return -1, cp_used
                    about_nearest(cp, cp_low, c0, deg, begin, about)
                    end = even_end(cp, about, deg, begin, end, table, part, rounding)
                    end = before_rise(cp, about, deg, begin, end, rounding)
                    place_part(cp, about, deg, 1, begin, end, table, part)
                    before = skew * begin + (1.0 - begin)
                    after = skew * end + (1.0 - end)
                    if end < 1.0:
                        u_end = ua + skew * end / after * (ub - ua)
                    part_skew = after / before * balance(cp, part, deg)
                    cp_used = about
                part_first = count
                count, cp_used, begins, ends, part_x, part_y = _cut_bezier(
                    cp, part, deg, bez_i[b, 2], bent, bez_i[b, 3], bez_i[b, 4], u_begin, u_end, part_skew, cp_used, count,
                    pieces_i, pieces_f, rounding, noise, table, work, bounds, roots)
                if count < 0:
                    return -1, cp_used
                off_x += part_x
                off_y += part_y
                # as many derivatives as go on from the part or the Bezier before
                smooth = deg if begin > 0.0 else bez_i[b, 5]
                if smooth > 0 and part_first > piece_loop_start[loop]:
                    right = handle(cp, part, part + 1)
                    go_on(pieces_i, pieces_f, part_first - 1, part_first, left, right, min(ended, begins), smooth > 1)
                ended = ends
                left = handle(cp, part + deg - 1, part + deg)
                step = 2.0 * (end - begin)
                begin = end
                u_begin = u_end
            longest = longest_of(cp, deg, pieces_i, first, count)
            if off_x != 0.0 or off_y != 0.0:
                stretch(cp, pieces_i[longest, P_CP0], deg, off_x, off_y, math.inf)
            chain(cp, cp_low, bez_f, b, c0 + deg, pieces_i, pieces_f, first, longest, count)
        piece_loop_start[loop + 1] = count
    return count, cp_used
