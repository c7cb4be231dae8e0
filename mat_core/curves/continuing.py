r"""Whether one side of the boundary goes on into the next along the same curve: an edge in parts, a knot that bends nothing.

        A          B          Two Beziers that both run away from V, with control points a_k and b_k about V. They are one curve
    <-------- V ------>       if a change of parameter takes one to the other,

    A(-lambda t) = B(t):      a[0, .., 0, -lambda, .. k times ..]  =  b_k

with the blossom a[..] of A, whose values there are A's control points drawn out through V. The first legs tell lambda; then all
the others must agree. The longer one is drawn out over the shorter one, so never far. Rational Beziers are told apart: of one
conic in parts the joints mostly are its vertices, where the exact disc serves best as the end of a piece.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.jit import inner
from mat_core.kernels.layout import (
    ARC,
    CP0,
    DEG,
    EDGE,
    K0,
    KIND,
    LEN,
    LINE,
    LOOP,
    RATIONAL,
    SPAN,
    SPIRAL,
    TX0,
    TX1,
    TY0,
    TY1,
    SiteInts,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME = 2e-14  # normalised: curves this near are one; rounding of control points, and of drawing out
LONGEST = 4.0  # lambda at most: farther out rounding says nothing


@inner
def goes_on(si: SiteInts, sf: Floats, cp: Floats, i: int, j: int, work: Floats) -> bool:
    """Whether site j, which begins where site i ends, is the same site or goes on along the same curve.

    work: 2 n + 2 rows of 2 for the highest degree n.
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
def _one_bezier(si: SiteInts, sf: Floats, cp: Floats, i: int, j: int, work: Floats) -> bool:
    """The same for two Beziers."""
    n = si[i, DEG]
    if si[j, DEG] != n or si[i, RATIONAL] or si[j, RATIONAL]:
        return False
    if sf[i, LEN] >= sf[j, LEN]:
        _from_joint(cp, si[i, CP0], n, True, work, 0)
        _from_joint(cp, si[j, CP0], n, False, work, n + 1)
    else:
        _from_joint(cp, si[j, CP0], n, False, work, 0)
        _from_joint(cp, si[i, CP0], n, True, work, n + 1)
    q = math.hypot(work[1, 0], work[1, 1])
    if not q > 0.0:
        return False
    lam = math.hypot(work[n + 2, 0], work[n + 2, 1]) / q
    if not lam <= LONGEST:
        return False
    for k in range(n + 1):
        # row 0 now is the blossom with k arguments -lambda and the others 0
        for c in range(2):
            if not abs(work[0, c] - work[n + 1 + k, c]) <= SAME:
                return False
        for m in range(n - k):
            for c in range(2):
                work[m, c] += lam * (work[m, c] - work[m + 1, c])
    return True


@inner
def _from_joint(cp: Floats, first: int, n: int, ends: bool, work: Floats, to: int) -> None:
    """Control points about V in order away from it: V is the last one where the Bezier `ends` there."""
    v = first + n if ends else first
    for k in range(n + 1):
        row = v - k if ends else v + k
        for c in range(2):
            work[to + k, c] = cp[row, c] - cp[v, c]
