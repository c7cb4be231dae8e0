"""Strips: discs found anew from either side are empty and touch, and curves run along the axis within the error they state.

A disc tangent to the boundary at p and q that holds no boundary point inside is the maximal disc at p, and the one at
q; there is no other. So a partner is confirmed from one side by growing the disc tangent at p until it touches the
other side of the strip, and asking all of the boundary whether it reaches into it:

    r <- |D|^2 / (2 n.D),   D = q - p,   q = foot of p + r n on the other side   (converges quadratically)

Why a few discs are enough for a strip: cutting a domain along maximal discs leaves sub-domains whose axes have nothing
to do with each other (Choi, Choi, Moon 1997). When the discs at both ends of a strip are empty and touch where they
should, and nothing else lies between their footpoints (coverage), the sub-domain in between has just two sides, and
neither can be its own partner, because its curvature is monotone (Vogt). Discs inside confirm what then cannot be
otherwise, and would show a piece whose curvature is not monotone.

A curve states a bound e of |c' - c| + |r' - r| between its discs (c', r') and true axis discs (c, r). The distance of c'
from either side then differs from r' by at most e; that much is granted, no more.

A strip between lines, arcs and points has a conic (c', r') = (x, y, r) / w of degree 2, if its curve has that degree. Then

    n.c' - r' of a line,    |c' - p|^2 - (r' + s)^2 of a circle (a point has s = 0),    times w or w^2,

is a polynomial of degree 4 at most, and nothing but 0 if it is 0 at both ends, where the discs are, and at three places between.
So the discs there are those of the axis, with a foot on either side: they confirm the partners, and none is found anew.

All these discs are probes: rows x, y, r, s, off of a table. Those of a strip are near each other, so one walk through the
tree of boxes gathers what any of them may reach into (most strips have one piece of a curve; the pieces of others are
gathered for one by one).
"""

from __future__ import annotations

import math

from mat_core.certificate.discs import missed
from mat_core.certificate.lengths import length_of_part
from mat_core.certificate.report import CURVES_EMPTY, CURVES_ON_AXIS, PARTNERS_LEFT, PARTNERS_RIGHT, worst
from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.judge import depth, depth_near
from mat_core.kernels.judge_ball import ball
from mat_core.kernels.judge_boxes import leaves_near, stretch
from mat_core.kernels.judge_foot import CLOSE, distance_from
from mat_core.kernels.judge_spline import spline_value
from mat_core.kernels.layout import FAN, KIND, SPIRAL

ANEW = (0.44, 0.59)  # where in a strip, on its right and on its left side, discs are found anew
SAMPLES = (0.057, 0.894, 0.281, 0.473, 0.726)  # of a piece; at places of no symmetry, so not at those of a fit
INNER = 2  # from here on they are what a conic is looked at
FROM_MIDDLE = (3, 2, 4, 0, 1)  # the order in which samples are looked at: feet of the first are near the middles of the sides
SAME_DISC = 1e-9  # a strip between discs nearer than this has no inside to look at
NO_SIDE = 1e-11  # nor is there anything to start from on a side shorter than this, unless both are

# rows of the probes: samples of a piece, then the discs found anew; columns: disc, its foot, how far it is from touching there
PROBES = len(SAMPLES) + len(ANEW)
PARTNERS = len(SAMPLES)
X, Y, R, FOOT, OFF = range(5)


@inner
def list_parts(k, c, part_of, run_of):
    """The first part of each strip's curve and its segment; -1 where there is none."""
    for strip in range(k.strip_i.shape[0]):
        part_of[strip] = -1
        run_of[strip] = -1
    for run in range(c.degree.shape[0]):
        for part in range(c.part_start[run + 1] - 1, c.part_start[run] - 1, -1):
            part_of[c.part_i[part, 1]] = part
            run_of[c.part_i[part, 1]] = run


@inner
def check_strip(t, k, c, strip, part, run, boxes, slack, figures):
    """Discs found anew from either side of a strip, and samples of its curve, which begins with `part` of segment `run`.

    part: -1 for no curve. slack: what is granted to emptiness.
    """
    d0 = k.strip_i[strip, 2]
    d1 = k.strip_i[strip, 3]
    end = c.part_start[run + 1] if part >= 0 else -1
    single = part >= 0 and (part + 1 == end or c.part_i[part + 1, 1] != strip)
    conic = single and _is_conic(t, k, c, strip, run)
    if conic and c.max_error[run] <= CLOSE and _confirms(t, k, c, strip, part, run, boxes, slack, figures):
        return
    radius = 0.5 * (k.disc[d0, 2] + k.disc[d1, 2])
    right, left = _sides(t, k, strip, radius)
    for side in range(2):
        if left if side else right:
            _find_anew(t, k, strip, side, radius, False, boxes.probe)
        else:
            _probe(boxes.probe, PARTNERS + side, k.disc[d0, 0], k.disc[d0, 1], 0.0, 0.0, 0.0)
    first = INNER if conic else 0
    if single:
        _sample(c, run, part, first, boxes)
    count = _gather(boxes, k.disc[d0, 0], k.disc[d0, 1], k.disc[d1, 0], k.disc[d1, 1], first if single else PARTNERS, PROBES)
    for side in range(2):
        if left if side else right:
            _judge_partner(t, k, strip, side, radius, count, boxes, slack, figures)
    probe = boxes.probe
    while 0 <= part < end and c.part_i[part, 1] == strip:
        if not single:
            _sample(c, run, part, 0, boxes)
            count = _gather(boxes, probe[0, X], probe[0, Y], probe[1, X], probe[1, Y], 0, PARTNERS)
        _judge_piece(t, k, strip, c.max_error[run], count, PARTNERS - first, boxes, slack, figures)
        part += 1


@inner
def _confirms(t, k, c, strip, part, run, boxes, slack, figures):
    """Whether samples of a strip's conic are empty and touch both sides: then they stand for the discs found anew."""
    d0 = k.strip_i[strip, 2]
    d1 = k.strip_i[strip, 3]
    _sample(c, run, part, INNER, boxes)
    count = _gather(boxes, k.disc[d0, 0], k.disc[d0, 1], k.disc[d1, 0], k.disc[d1, 1], INNER, PARTNERS)
    most = _judge_piece(t, k, strip, c.max_error[run], count, PARTNERS - INNER, boxes, slack, figures)
    if not most <= CLOSE:
        return False
    worst(figures, PARTNERS_RIGHT, most, boxes.probe[INNER, X], boxes.probe[INNER, Y])
    worst(figures, PARTNERS_LEFT, most, boxes.probe[INNER, X], boxes.probe[INNER, Y])
    return True


@inner
def _is_conic(t, k, c, strip, run):
    """Whether a strip is between lines, arcs and points, and its curve of a conic's degree."""
    right = t.si[k.strip_i[strip, 0], KIND]
    left = t.si[k.strip_i[strip, 1], KIND]
    return c.degree[run] <= 2 and right != SPIRAL and left != SPIRAL


@inner
def _probe(probe, row, x, y, r, s, off):
    """Fill one row."""
    probe[row, X] = x
    probe[row, Y] = y
    probe[row, R] = r
    probe[row, FOOT] = s
    probe[row, OFF] = off


@inner
def _gather(boxes, ax, ay, bx, by, first, last):
    """Leaves that any of the probes first .. last - 1 may reach into, near the line from a to b: how many, -1 if too many."""
    reach = 0.0
    for n in range(first, last):
        own = stretch(ax, ay, bx, by, boxes.probe[n, X], boxes.probe[n, Y], boxes.probe[n, R])
        if not own <= reach:
            reach = own
    return leaves_near(boxes.box, boxes.walk[0], boxes.walk[1], ax, ay, bx, by, reach)


@inner
def _depth(t, boxes, count, row, i0, s0, i1, s1):
    """How deep the boundary reaches into a probe; by `count` gathered leaves, or by all of the tree where that is -1."""
    x = boxes.probe[row, X]
    y = boxes.probe[row, Y]
    r = boxes.probe[row, R]
    if count >= 0:
        return depth_near(t.si, t.sf, t.cp, boxes.order, boxes.box, boxes.walk[1], count, boxes.work, boxes.binomial, x, y, r,
                          i0, s0, i1, s1)
    return depth(t.si, t.sf, t.cp, boxes.order, boxes.box, boxes.walk[0], boxes.work, boxes.binomial, x, y, r, i0, s0, i1, s1)


@inner
def _sides(t, k, strip, radius):
    """(right, left): from which sides a disc is found anew; of a strip that has an inside, those that have a length."""
    d0 = k.strip_i[strip, 2]
    d1 = k.strip_i[strip, 3]
    apart = 0.0
    for axis in range(3):
        apart = max(apart, abs(k.disc[d1, axis] - k.disc[d0, axis]))
    s = k.strip_s
    little = not apart > SAME_DISC
    for side in range(2):  # most of a site is looked at even so; of a point there is no more to see
        fan = t.si[k.strip_i[strip, side], KIND] == FAN
        little = little and (fan or abs(s[strip, 2 * side + 1] - s[strip, 2 * side]) <= 0.5)
    if little:
        return False, False
    right = length_of_part(t, k.strip_i[strip, 0], s[strip, 0], s[strip, 1], radius) > NO_SIDE
    left = length_of_part(t, k.strip_i[strip, 1], s[strip, 2], s[strip, 3], radius) > NO_SIDE
    neither = not right and not left
    return right or neither, left or neither


@inner
def _aim(k, strip, side):
    """(i, s, j, lo, hi, guess): a disc at s on site i of one side of a strip touches lo .. hi of site j, near `guess` maybe."""
    s = k.strip_s
    if side == 0:
        at = s[strip, 0] + ANEW[0] * (s[strip, 1] - s[strip, 0])
        guess = s[strip, 2] + ANEW[0] * (s[strip, 3] - s[strip, 2])
        return k.strip_i[strip, 0], at, k.strip_i[strip, 1], s[strip, 3], s[strip, 2], guess
    at = s[strip, 3] + ANEW[1] * (s[strip, 2] - s[strip, 3])
    guess = s[strip, 1] + ANEW[1] * (s[strip, 0] - s[strip, 1])
    return k.strip_i[strip, 1], at, k.strip_i[strip, 0], s[strip, 0], s[strip, 1], guess


@inner
def _find_anew(t, k, strip, side, radius, thorough, probe):
    """The disc tangent to one side of a strip that touches the other, to its row of the probes; r = inf if there is none."""
    i, s, j, lo, hi, guess = _aim(k, strip, side)
    x, y, tx, ty, curvature, speed = evaluate(t.si, t.sf, t.cp, i, s, 0.0, 0.0)
    r, at, qx, qy, ux, uy = ball(t.si, t.sf, t.cp, i, s, x, y, tx, ty, j, lo, hi, radius, guess, thorough)
    if not r < math.inf:
        _probe(probe, PARTNERS + side, x, y, math.inf, guess, math.inf)
        return
    cx = x - r * ty
    cy = y + r * tx
    _probe(probe, PARTNERS + side, cx, cy, r, at, missed(t.si, t.sf, j, at, qx - cx, qy - cy, ux, uy, r))


@inner
def _judge_partner(t, k, strip, side, radius, count, boxes, slack, figures):
    """The disc found anew from one side is empty and touches; `count` leaves were gathered for it."""
    i, s, j, lo, hi, guess = _aim(k, strip, side)
    row = PARTNERS + side
    probe = boxes.probe
    inside = off = x = y = 0.0
    for attempt in range(2):
        if attempt > 0:
            # a disc that is not confirmed was too large, maybe: then all of the other side is searched
            _find_anew(t, k, strip, side, radius, True, probe)
            count = -1
            if not probe[row, R] < math.inf:
                break
        inside = _depth(t, boxes, count, row, i, s, j, probe[row, FOOT]) - slack
        off = probe[row, OFF]
        x = probe[row, X]
        y = probe[row, Y]
        if inside <= CLOSE and off <= CLOSE:
            break
    check = PARTNERS_LEFT if side else PARTNERS_RIGHT
    worst(figures, check, inside, x, y)
    worst(figures, check, off, x, y)


@inner
def _sample(c, run, part, first, boxes):
    """Probes along one piece of a curve, from the `first` of SAMPLES on."""
    for n in range(first, PARTNERS):
        at = c.part_f[part, 0] + SAMPLES[n] * (c.part_f[part, 1] - c.part_f[part, 0])
        spline_value(c.degree, c.knot_start, c.knots, c.cp_start, c.cp, 3, run, at, boxes.points)
        _probe(boxes.probe, n, boxes.points[0, 0], boxes.points[0, 1], boxes.points[0, 2], 0.0, 0.0)


@inner
def _judge_piece(t, k, strip, error, count, samples, boxes, slack, figures):
    """Samples of a piece touch either side of their strip, and the boundary stays out of them; error: what the curve states.

    `count` leaves were gathered for them; the first `samples` from the middle are looked at. Returns the largest figure.
    """
    granted = error + slack
    most = -math.inf
    probe = boxes.probe
    right = k.strip_i[strip, 0]
    left = k.strip_i[strip, 1]
    s = k.strip_s
    last = before = SAMPLES[FROM_MIDDLE[0]]
    s_right = right_before = 0.5 * (s[strip, 0] + s[strip, 1])
    s_left = left_before = 0.5 * (s[strip, 2] + s[strip, 3])
    for m in range(samples):
        n = FROM_MIDDLE[m]
        x = probe[n, X]
        y = probe[n, Y]
        r = probe[n, R]
        # about where the feet of the last two samples point to
        on = (SAMPLES[n] - last) / (last - before) if last != before else 0.0
        guess_right = s_right + on * (s_right - right_before)
        guess_left = s_left + on * (s_left - left_before)
        before = last
        right_before = s_right
        left_before = s_left
        last = SAMPLES[n]
        off_right, s_right = distance_from(t.si, t.sf, t.cp, right, s[strip, 0], s[strip, 1], guess_right, x, y, r, granted)
        off_left, s_left = distance_from(t.si, t.sf, t.cp, left, s[strip, 3], s[strip, 2], guess_left, x, y, r, granted)
        for off in (off_right, off_left):
            worst(figures, CURVES_ON_AXIS, off - granted, x, y)
            most = most if most >= off - granted else off - granted
        inside = _depth(t, boxes, count, n, right, s_right, left, s_left)
        worst(figures, CURVES_EMPTY, inside - granted, x, y)
        most = most if most >= inside - granted else inside - granted
    return most
