r"""Whether one side of the boundary goes on into the next along the same curve: an edge in parts, a knot that bends nothing.

        A          B          Two Beziers that both run away from V, with control points a_k and b_k, homogeneous about V:
    <-------- V ------>       (w (x - V), w). They are one curve if a change of parameter takes one to the other,

    A(-lambda t) ~ B(t):      a[0, .., 0, -lambda, .. k times ..]  =  mu rho^k b_k     (weights w_k and w_k rho^k draw one curve)

with the blossom a[..] of A, whose values there are A's control points drawn out through V. mu makes the weights at V agree,
lambda and rho the first legs; then all the others must. The longer one is drawn out over the shorter one, so never far.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.jit import inner
from mat_core.kernels.layout import ARC, CP0, DEG, EDGE, K0, KIND, LEN, LINE, LOOP, SPAN, SPIRAL, TX0, TX1, TY0, TY1

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME = 2e-14  # normalised: curves this near are one; rounding of control points, and of drawing out
LONGEST = 4.0  # lambda at most: farther out rounding says nothing


@inner
def goes_on(si: Ints, sf: Floats, cp: Floats, i: int, j: int, work: Floats) -> bool:
    """Whether site j, which begins where site i ends, is the same site or goes on along the same curve.

    work: 2 n + 2 rows of 3 for the highest degree n.
    """
    if i == j:
        return True
    kind = si[i, KIND]
    if kind != si[j, KIND]:
        return False
    if kind == SPIRAL:
        if si[i, LOOP] == si[j, LOOP] and si[i, EDGE] == si[j, EDGE] and si[i, SPAN] == si[j, SPAN]:
            return True
        return _one_bezier(si, sf, cp, i, j, work)
    if kind != LINE and kind != ARC:
        return False
    shorter = min(sf[i, LEN], sf[j, LEN])
    turn = abs(sf[i, TX1] * sf[j, TY0] - sf[i, TY1] * sf[j, TX0])
    bend = abs(sf[i, K0] - sf[j, K0]) if kind == ARC else 0.0
    ahead = sf[i, TX1] * sf[j, TX0] + sf[i, TY1] * sf[j, TY0] > 0.0
    return bool(ahead and (turn + 0.5 * bend * shorter) * shorter <= SAME)


@inner
def _one_bezier(si: Ints, sf: Floats, cp: Floats, i: int, j: int, work: Floats) -> bool:
    """The same for two Beziers."""
    n = si[i, DEG]
    if si[j, DEG] != n:
        return False
    if sf[i, LEN] >= sf[j, LEN]:
        _from_joint(cp, si[i, CP0], n, True, work, 0)
        _from_joint(cp, si[j, CP0], n, False, work, n + 1)
    else:
        _from_joint(cp, si[j, CP0], n, False, work, 0)
        _from_joint(cp, si[i, CP0], n, True, work, n + 1)
    # 1. lambda and rho: the second row of what is drawn out backwards through V is that of the other
    w = work[0, 2]
    mu = w / work[n + 1, 2]
    q = math.hypot(work[1, 0], work[1, 1])
    p = mu * math.hypot(work[n + 2, 0], work[n + 2, 1])
    if not (q > 0.0 and p > 0.0):
        return False
    slope = work[1, 2] - w
    denominator = q / p * mu * work[n + 2, 2] + slope
    if not denominator > 0.0:
        return False
    lam = w / denominator
    rho = lam * q / p
    if not lam <= LONGEST:
        return False
    # 2. control points of A over [0, -lambda] seen from V (blossom), one after the other
    scale = 1.0
    for k in range(n + 1):
        # row 0 now is the blossom with k arguments -lambda and the others 0
        for c in range(3):
            off = work[0, c] - mu * scale * work[n + 1 + k, c]
            if not abs(off) <= SAME * max(w, 1.0):
                return False
        scale *= rho
        for m in range(n - k):
            for c in range(3):
                work[m, c] += lam * (work[m, c] - work[m + 1, c])
    return True


@inner
def _from_joint(cp: Floats, first: int, n: int, ends: bool, work: Floats, to: int) -> None:
    """Homogeneous control points about V in order away from it: V is the last one where the Bezier `ends` there."""
    v = first + n if ends else first
    for k in range(n + 1):
        row = v - k if ends else v + k
        w = cp[row, 2]
        work[to + k, 0] = w * (cp[row, 0] - cp[v, 0])
        work[to + k, 1] = w * (cp[row, 1] - cp[v, 1])
        work[to + k, 2] = w
