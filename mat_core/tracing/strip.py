"""The footpoint pair and the axis point of a strip, for a given footpoint on one side.

The paper (sections 5.1 and Appendix A) fixes a footpoint on one edge and solves the squared equation (A4) for the other one. Here
the other footpoint is where phi, the curvature of the circle tangent at the first one, is largest: the distance criterion (both
normals meet at equal length) and the curvature criterion (no smaller circle of curvature) hold by construction, and normals may
be parallel or antiparallel.

    c = C + r n,      c' = a t + r' n,      a = |C'| (1 - k r)        (fan: a = r |angle'|)
    c'.n2 = r'        because c stays at distance r from the other side, hence     r' = a (t.n2) / (1 - n.n2)
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.disc import touch_from
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import FAN, KIND, V0, V1


@inner
def trace(si, sf, cp, i, s, j, lo, hi):
    """(x, y, r, s_j, dx, dy, dr): the axis point with footpoint s on site i and its partner in [lo, hi] of site j.

    Derivatives are by s; all zero at the centre of curvature of a leaf, where both sides meet (there they are 0/0).
    """
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, i, s, 0.0, 0.0)
    phi, sj = touch_from(si, sf, cp, i, s, j, lo, hi)
    vertex = si[i, V0] if s < 0.5 else si[i, V1]
    if (s <= 0.0 or s >= 1.0) and (si[j, V0] == vertex or si[j, V1] == vertex) and not phi < math.inf or not phi > 0.0:
        # the shared convex vertex itself: r = 0, the limits of both normals remain
        sj = 1.0 if si[j, V1] == vertex else 0.0
        qx, qy, ux, uy, kq, speed_q = evaluate(si, sf, cp, j, sj, px, py)
        gap = 0.5 * ((tx - ux) * (tx - ux) + (ty - uy) * (ty - uy))
        if gap == 0.0:
            return px, py, 0.0, sj, 0.0, 0.0, 0.0
        dr = speed * (ty * ux - tx * uy) / gap
        return px, py, 0.0, sj, speed * tx - dr * ty, speed * ty + dr * tx, dr
    r = 1.0 / phi
    nx = -ty
    ny = tx
    x = px + r * nx
    y = py + r * ny
    qx, qy, ux, uy, kq, speed_q = evaluate(si, sf, cp, j, sj, x, y)
    if si[j, KIND] == FAN:
        mx = -qx / r
        my = -qy / r
    else:
        mx = -uy
        my = ux
    gap = 0.5 * ((nx - mx) * (nx - mx) + (ny - my) * (ny - my))
    a = r * speed if si[i, KIND] == FAN else speed * (1.0 - k * r)
    if gap == 0.0:
        return x, y, r, sj, 0.0, 0.0, 0.0
    dr = a * (tx * mx + ty * my) / gap
    return x, y, r, sj, a * tx + dr * nx, a * ty + dr * ny, dr
