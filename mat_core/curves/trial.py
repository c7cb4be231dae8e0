"""One piece tried: of how many nodes it is made, and how much longer one could be.

Interpolation of a function that is analytic around an interval errs by powers: with m nodes and both ends, each with its tangent,
by about L rho^-(m + 4) on a length L. So one error tells others,

    E_n / L ~ (E_m / L)^((n + 4) / (m + 4)),      and on another length     E_m ~ L^(m + 4).

The cubic alone (m = 0) is measured before anything is tried (`plan`): the fewest nodes that it lets one expect to do are tried,
and where they do not, their error tells whether more would. Measured on glyphs, icons and blobs: the error expected from the
cubic is within a factor of 10 of the true one in most cases, that from a piece within a factor of 4.
"""

from __future__ import annotations

import math

from mat_core.curves.ends import apart
from mat_core.curves.interval import AXIS_ROUNDING, DOUBTED, attempt, refuted
from mat_core.curves.plan import plan
from mat_core.curves.polynomial import hermite_of
from mat_core.curves.way import I_ROW, MAX_STRIPS, MOST_NODES, Scratch, Track
from mat_core.kernels.jit import inner

READY = 0.5  # of the tolerance: what an expected error must be within, for so many nodes to be tried
HOPELESS = 30.0  # times the tolerance: a piece with such an expected error is shortened untried
PRUDENCE = 0.95  # of the length that an error lets one hope for: it is measured at one place only
MAX_GROWTH = 4.0  # times as long: what an error lets one hope for at most


@inner
def _expected(error: float, length: float, m: int, more: int) -> float:
    """About the error with m + `more` nodes, from that with m: the share of the length falls as powers do (above)."""
    return length * (error / length) ** ((m + more + 4.0) / (m + 4.0))


@inner
def hope(scratch: Scratch, error: float, tolerance: float, m: int) -> float:
    """How many times as long a piece of the highest degree could be; a half where its error says nothing."""
    if not error < math.inf:
        return 0.5
    if error == 0.0:
        return MAX_GROWTH
    error = _expected(error, apart(scratch.ends, 0, scratch.ends, 1), m, MOST_NODES - m)
    return min(PRUDENCE * (tolerance / error) ** (1.0 / (MOST_NODES + 4.0)), MAX_GROWTH)


@inner
def _enough_nodes(error: float, length: float, m: int, tolerance: float) -> int:
    """The least number of nodes, above m, that is expected to do, for an error with m of them; more than there are if none is."""
    for more in range(m + 2, MOST_NODES + 1, 2):
        if _expected(error, length, m, more - m) <= READY * tolerance:
            return more
    return MOST_NODES + 2


@inner
def try_piece(track: Track, scratch: Scratch, tolerance: float) -> tuple[bool, int, float]:
    """(whether the plan runs evenly, nodes, the bound within the tolerance or about the error) of a piece over the interval."""
    if int(scratch.ends[1, I_ROW]) - int(scratch.ends[0, I_ROW]) >= MAX_STRIPS:
        return False, MOST_NODES, math.inf
    fits = hermite_of(scratch.ends, scratch.hermite)
    even, error = plan(track, scratch)
    if not even or not fits:
        return even, MOST_NODES, math.inf
    length = apart(scratch.ends, 0, scratch.ends, 1)
    error = max(error, AXIS_ROUNDING)
    m = _enough_nodes(error, length, 0, tolerance)
    if m > MOST_NODES:
        m = MOST_NODES
        error = _expected(error, length, 0, m)
        if error > HOPELESS * tolerance:
            return True, m, error
    while True:
        error = attempt(track, scratch, m, tolerance)
        if error <= tolerance and refuted(track, scratch, m, error):
            error = DOUBTED * tolerance
        if error <= tolerance or not error < math.inf:
            return True, m, error
        more = _enough_nodes(error, length, m, tolerance)
        if more > MOST_NODES:
            return True, m, error
        m = more
