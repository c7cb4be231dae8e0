"""Whether the boundary that was solved is the caller's: each piece lies on the edge that it names, where it names it."""

from __future__ import annotations

import math

from mat_core.certificate.report import BOUNDARY, worst
from mat_core.kernels.curve import edge_parameter, evaluate
from mat_core.kernels.jit import inner
from mat_core.kernels.judge_spline import spline_value
from mat_core.kernels.layout import EDGE, FAN, KIND, LOOP, UA, UB

ON_PIECE = 0.47  # where a piece is compared with the input's edge
NO_GAP = 1e-12  # between the two; what is more may be the rounding of a parameter
NAMED = 4.5e-16  # of a parameter: two units of its last place


@inner
def _blur(e, edge, u, magnitude, work):
    """How far a point of an edge moves when its parameter does by `NAMED` roundings either way: no double names it better.

    Weights of 1e-6 and 1e6 on one edge drive it through most of its length within 1e-9 of its range.
    """
    step = NAMED * magnitude
    before = max(u - step, e.knots[e.knot_start[edge]])
    after = min(u + step, e.knots[e.knot_start[edge + 1] - 1])
    spline_value(e.degree, e.knot_start, e.knots, e.cp_start, e.cp, 2, edge, before, work)
    x = work[0, 0]
    y = work[0, 1]
    spline_value(e.degree, e.knot_start, e.knots, e.cp_start, e.cp, 2, edge, after, work)
    return math.sqrt((work[0, 0] - x) ** 2 + (work[0, 1] - y) ** 2)


@inner
def check_edges(t, e, ox, oy, scale, work, figures):
    """Every piece lies on the input's edge that it names, at the parameter that it names; work: (d + 1, 3) or more."""
    loops = e.loop_start.shape[0] - 1
    for i in range(t.si.shape[0]):
        if t.si[i, KIND] == FAN:
            continue
        x, y, tx, ty, curvature, speed = evaluate(t.si, t.sf, t.cp, i, ON_PIECE, 0.0, 0.0)
        loop = t.si[i, LOOP]
        edge = t.si[i, EDGE]
        if not (0 <= loop < loops and 0 <= edge < e.loop_start[loop + 1] - e.loop_start[loop]):
            worst(figures, BOUNDARY, math.inf, x, y)
            continue
        u = edge_parameter(t.si, t.sf, t.cp, i, ON_PIECE)
        spline_value(e.degree, e.knot_start, e.knots, e.cp_start, e.cp, 2, e.loop_start[loop] + edge, u, work)
        dx = (work[0, 0] - ox) * scale - x
        dy = (work[0, 1] - oy) * scale - y
        gap = math.sqrt(dx * dx + dy * dy)
        if gap > NO_GAP:
            magnitude = max(abs(t.sf[i, UA]), abs(t.sf[i, UB]))
            gap = max(gap - _blur(e, e.loop_start[loop] + edge, u, magnitude, work) * scale, NO_GAP)
        worst(figures, BOUNDARY, gap, x, y)
