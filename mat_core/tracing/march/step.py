"""Section 5.1: the tracing step. The right footpoint rises by one step, the left one falls to where Appendix A puts it.

Here e2 of the paper is the right site `a`, whose parameter always increases, e1 the left site `b`, whose parameter always
decreases. Both are parts of the input's edges: cut where the curvature turns, so that a point of locally maximal curvature (LMPC)
is the end of an edge, as in Fig. 11(b), and with a fan of normals between two edges for each reflex vertex (5.4).

           b  <- left                A pair ends where either footpoint reaches the end of its edge ("the limiting value", 5.7)
      P  .  .  .  P'                 or a footpoint of a disc that is known: there another trace ended or began.
           a  -> right
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from mat_core.kernels.curve import evaluate
from mat_core.kernels.layout import FAN, KIND, LEN, SWEEP
from mat_core.tracing.march.footpoint import AxisPoint, axis_point, corresponding_footpoint
from mat_core.tracing.march.record import SNAP, Record

DUMMY_EDGES = 2.0  # radians between normals of a reflex vertex, in steps: no centre is farther from it than half the size


@dataclass
class Pair:
    """One pair of edges being traced.

    Attributes
    ----------
    disc, half : int
        The disc it starts from, and which of that disc's contacts the right footpoint leaves.
    a, b : int
        Right and left site.
    a0, b0 : float
        Parameters at the start.
    right, left : float
        Parameters of the last axis point that passed the checks.
    from_branch : bool
        The segment that this pair belongs to left a branch point (Proposition 2).
    put_off : int
        How often it was left until other pairs were traced.
    """

    disc: int
    half: int
    a: int
    b: int
    a0: float
    b0: float
    right: float
    left: float
    from_branch: bool
    put_off: int = 0


@dataclass(frozen=True)
class Limits:
    """Where the footpoints of a pair have to stop: parameters, and whether both stop at one joint ahead that they share."""

    right: float
    left: float
    closing: bool


def limits_of(record: Record, pair: Pair) -> Limits:
    """The limiting values, as far as discs are known by now."""
    right = record.limit_up(pair.a, pair.right)
    left = record.limit_down(pair.b, pair.left)
    return Limits(right, left, right == 1.0 and left == 0.0 and record.next_site(pair.a) == pair.b)


def parameter_step(record: Record, site: int, step: float) -> float:
    """du2: the tracing step in the parameter of a site. A fan's dummy edges have normals `DUMMY_EDGES` steps apart (5.4)."""
    t = record.table
    if t.si[site, KIND] == FAN:
        return DUMMY_EDGES * step / abs(float(t.sf[site, SWEEP]))
    return step / float(t.sf[site, LEN])


def tracing_step(
    record: Record, pair: Pair, now: AxisPoint, du: float, pace: float, limits: Limits
) -> tuple[AxisPoint | None, bool]:
    """The next axis point, and whether a limit is reached with it: tasks 2 and 3 of section 5.1.

    `pace` is how far the left footpoint fell in the last step. Where it would pass its limit, it is put there and the right one
    is sought. No point but a limit: both come to
    the joint that they share (5.5); neither: no left footpoint belongs to the next right one, the bisector has ended.
    """
    t = record.table
    right = min(now.right + du, limits.right)
    if 1.0 - right < SNAP and limits.right == 1.0:
        right = 1.0
    if right == 1.0 and limits.closing:
        return None, True
    left = corresponding_footpoint(t, pair.a, right, pair.b, now.left, limits.left, pace)
    ended = right == limits.right
    if left is None:
        if limits.closing:
            return None, True
        ended = True
        left = limits.left
        found = corresponding_footpoint(t, pair.b, left, pair.a, now.right, right, du)
        right = right if found is None else found
        if not _meets(record, pair, right, left):
            return None, False
    elif (left - limits.left) * record.length(pair.b) <= SNAP and not limits.closing:
        left = limits.left
        ended = True
    if (limits.right - right) * record.length(pair.a) <= SNAP and not limits.closing:
        right = limits.right
        ended = True
    point = axis_point(t, pair.a, right, pair.b, left)
    return point, ended and point is not None


def _meets(record: Record, pair: Pair, right: float, left: float) -> bool:
    """Whether two footpoints belong together up to rounding: both edges may end at the same disc."""
    t = record.table
    point = axis_point(t, pair.a, right, pair.b, left)
    if point is None:
        return False
    x, y, tx, ty, _, _ = evaluate(t.si, t.sf, t.cp, pair.a, right, point.x, point.y)
    return math.hypot(x - point.r * ty, y + point.r * tx) <= SNAP


def point_between(record: Record, pair: Pair, good: AxisPoint, right: float, left: float) -> AxisPoint | None:
    """The axis point of a right footpoint after a good one, by Appendix A; for the bisection of section 5.2.

    The left footpoint is not below `left`; None where there is none.
    """
    t = record.table
    at = corresponding_footpoint(t, pair.a, right, pair.b, good.left, left, 0.0)
    if at is None and _meets(record, pair, right, left):
        at = left
    return None if at is None else axis_point(t, pair.a, right, pair.b, at)
