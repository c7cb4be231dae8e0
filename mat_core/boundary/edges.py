"""From the caller's edges to pieces of monotone curvature: moved to the origin, cut into Beziers, these into pieces."""

from __future__ import annotations

from mat_core.boundary.pieces import cut_beziers
from mat_core.kernels.bezier import add_closely, balance, decompose
from mat_core.kernels.jit import inner, jit


@jit
def cut_edges(
    degree, cp_start, control, knot_start, knots, edge_loop_start, backwards, ox, oy, scale, rounding, moved, span_cp, breaks,
    bez_i, bez_f, bez_loop_start, cp, cp_low, pieces_i, pieces_f, piece_loop_start, table, work, bounds, roots,
):
    """From edges to pieces; returns (pieces, rows of cp), pieces = -1 if a buffer is too small."""
    # before knots are inserted: far from the origin a new point would be rounded as coarsely as those are
    for row in range(control.shape[0]):
        x, x_low = _between(ox, 0.0, control[row, 0], 0.0)
        y, y_low = _between(oy, 0.0, control[row, 1], 0.0)
        moved[row, 0] = x * scale
        moved[row, 1] = y * scale
        moved[row, 2] = control[row, 2]
        moved[row, 3] = x_low * scale
        moved[row, 4] = y_low * scale
    noise = 4.0 * rounding
    used = _collect_beziers(degree, cp_start, moved, knot_start, knots, edge_loop_start, backwards, noise, span_cp, breaks, bez_i,
                            bez_f, cp, cp_low, bez_loop_start)
    return cut_beziers(bez_i, bez_f, bez_loop_start, cp, cp_low, used, pieces_i, pieces_f, piece_loop_start, rounding, noise,
                       table, work, bounds, roots)


@inner
def _between(a, a_low, b, b_low):
    """b - a of numbers in two parts, in two parts, the first one rounded."""
    return add_closely(b, b_low - a_low, -a)


@inner
def _multiplicity(knots, first, last, u):
    """How many of an edge's knots are u."""
    count = 0
    for i in range(first, last):
        if knots[i] == u:
            count += 1
    return count


@inner
def _collect_beziers(
    degree, cp_start, control, knot_start, knots, edge_loop_start, backwards, rounding,
    span_cp, breaks, bez_i, bez_f, cp, cp_low, bez_loop_start,
):
    """Fill the tables of Beziers and cp; returns the rows of cp.

    bez_i: degree, cp0, rational, edge, span, how many derivatives go on where the one before ends; bez_f: ua, ub, skew, start,
    x and y, and their further digits. Control points are relative to the start of their Bezier; what their digits leave: cp_low.
    """
    count = 0
    used = 0
    bez_loop_start[0] = 0
    for loop in range(edge_loop_start.shape[0] - 1):
        first = edge_loop_start[loop]
        last = edge_loop_start[loop + 1]
        flip = backwards[loop]
        loop_first = count
        for step in range(last - first):
            edge = last - 1 - step if flip else first + step
            d = degree[edge]
            n_spans = decompose(d, knots, knot_start[edge], knot_start[edge + 1] - knot_start[edge], control, cp_start[edge],
                                cp_start[edge + 1] - cp_start[edge], span_cp, breaks)
            for position in range(n_spans):
                span = n_spans - 1 - position if flip else position
                row = span * (d + 1)
                rational = 0
                extent = 0.0
                start = row + (d if flip else 0)
                for i in range(d + 1):
                    source = row + (d - i if flip else i)
                    for axis in range(2):
                        cp[used + i, axis], cp_low[used + i, axis] = _between(
                            span_cp[start, axis], span_cp[start, 3 + axis], span_cp[source, axis], span_cp[source, 3 + axis])
                    cp[used + i, 2] = span_cp[source, 2] / span_cp[row, 2]
                    if cp[used + i, 2] != 1.0:
                        rational = 1
                    extent = max(extent, abs(cp[used + i, 0]), abs(cp[used + i, 1]))
                if extent <= rounding:
                    continue
                bez_i[count, 0] = d
                bez_i[count, 1] = used
                bez_i[count, 2] = rational
                bez_i[count, 3] = edge - first
                bez_i[count, 4] = span
                knot = breaks[span + 1] if flip else breaks[span]
                bez_i[count, 5] = max(d - _multiplicity(knots, knot_start[edge], knot_start[edge + 1], knot), 0)
                bez_f[count, 0] = breaks[span + 1] if flip else breaks[span]
                bez_f[count, 1] = breaks[span] if flip else breaks[span + 1]
                bez_f[count, 2] = balance(cp, used, d)
                bez_f[count, 3] = span_cp[start, 0]
                bez_f[count, 4] = span_cp[start, 1]
                bez_f[count, 5] = span_cp[start, 3]
                bez_f[count, 6] = span_cp[start, 4]
                count += 1
                used += d + 1
        # ends that differ by rounding become one point
        for b in range(loop_first, count):
            after = b + 1 if b + 1 < count else loop_first
            end = bez_i[b, 1] + bez_i[b, 0]
            for axis in range(2):
                cp[end, axis], cp_low[end, axis] = _between(
                    bez_f[b, 3 + axis], bez_f[b, 5 + axis], bez_f[after, 3 + axis], bez_f[after, 5 + axis])
        bez_loop_start[loop + 1] = count
    return used
