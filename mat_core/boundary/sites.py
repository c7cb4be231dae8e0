"""The flat site table: what a maximal disc may touch, in loop order, interior on the left, in normalised coordinates.

Steps: 1. edges translated to the centre of the bounding box and scaled by a power of two (exact), then to Beziers (knot
insertion), reversed where the loop runs the wrong way; 2. Beziers to pieces of monotone curvature; 3. pieces and normal fans to
sites.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.chain import PF_WIDTH, PI_WIDTH
from mat_core.boundary.curvature import SCRATCH_ROWS, scratch_width
from mat_core.boundary.edges import cut_edges
from mat_core.boundary.filling import fill_sites
from mat_core.kernels.bernstein import MAX_DEPTH
from mat_core.kernels.bezier import CLOSE, count_beziers
from mat_core.kernels.layout import SF_WIDTH, SI_WIDTH, SiteInts
from mat_core.memory import maker
from mat_core.model.domain import Domain
from mat_core.tolerances import Tolerances

KINK = 32.0  # roundings by which a joint may turn, radians, without anything being meant by it
BENT_BACK = 1e-9  # radians by which a reflex joint may turn and be smooth: no branch runs into it, so nothing is gained by more


class SiteTable(NamedTuple):
    """Sites of a domain in normalised coordinates, (input - origin) * scale, so that the larger side is in [0.5, 1].

    si (n, SI_WIDTH) int32 and sf (n, SF_WIDTH) float64: columns in `mat_core.kernels.layout`; cp (m, 3): control points x, y
    (relative to the site's start) and weight; loop_start (L + 1,): sites of each loop; origin (2,); scale: a power of two;
    smooth_angle: joints that turn by no more, radians, were taken as smooth.
    """

    si: SiteInts
    sf: NDArray[np.float64]
    cp: NDArray[np.float64]
    loop_start: NDArray[np.int64]
    origin: NDArray[np.float64]
    scale: float
    smooth_angle: float


def build_sites(domain: Domain, smooth_angle: float, tolerances: Tolerances) -> SiteTable:
    """Cut the boundary of a valid domain into sites.

    Parameters
    ----------
    domain : Domain
        Valid (checked by its constructor).
    smooth_angle : float
        Radians; convex joints that turn by less are smooth, most reflex ones only if they turn by hardly anything.
    tolerances : Tolerances
        Rounding of the normalised coordinates is taken from here and from the size of the input's coordinates.

    Returns
    -------
    SiteTable
    """
    a = domain.arrays
    xmin, ymin, xmax, ymax = domain.bbox
    origin = np.array((0.5 * (xmin + xmax), 0.5 * (ymin + ymax)))
    scale = 2.0 ** -math.frexp(max(xmax - xmin, ymax - ymin))[1]
    magnitude = max(abs(xmin), abs(xmax), abs(ymin), abs(ymax)) * scale
    rounding = tolerances.rounding * max(1.0, magnitude)
    smooth_angle = max(smooth_angle, KINK * rounding)

    loops = len(a.loop_start)
    beziers, points, most_of_edge, longest, highest = count_beziers(a.degree, a.cp_start)
    width = scratch_width(highest)
    make = maker(beziers)
    moved, span_cp, breaks = make((len(a.cp), CLOSE)), np.empty((most_of_edge, CLOSE)), np.empty(longest + 2)
    bez_i, bez_f, bez_loop_start = make((beziers, 6), np.int64), make((beziers, 7)), np.empty(loops, dtype=np.int64)
    table, work = np.empty((SCRATCH_ROWS, width)), np.empty((MAX_DEPTH + 2, width))
    bounds, roots = np.empty((MAX_DEPTH + 2, 2)), np.empty(width)
    piece_loop_start = np.empty(loops, dtype=np.int64)
    cp_low = np.empty((points, 2))
    room, n_pieces = 1, -1
    while n_pieces < 0:
        room *= 4
        cp = make((points * room + 256, 3))
        pieces_i, pieces_f = make((beziers * room + 16, PI_WIDTH), np.int64), make((beziers * room + 16, PF_WIDTH))
        n_pieces, rows = cut_edges(
            a.degree, a.cp_start, a.cp, a.knot_start, a.knots, a.loop_start, a.reversed, origin[0], origin[1], scale, rounding,
            moved, span_cp, breaks, bez_i, bez_f, bez_loop_start, cp, cp_low, pieces_i, pieces_f, piece_loop_start, table, work,
            bounds, roots)
    si, sf = make((2 * n_pieces, SI_WIDTH), np.int32), make((2 * n_pieces, SF_WIDTH))
    turns, loop_start = np.empty(n_pieces), np.empty(loops, dtype=np.int64)
    bent_back = min(smooth_angle, max(BENT_BACK, KINK * rounding))
    n = fill_sites(pieces_i, pieces_f, piece_loop_start, cp, smooth_angle, bent_back, rounding, si, sf, turns,
                    loop_start)
    return SiteTable(si[:n], sf[:n], cp[:rows], loop_start, origin, scale, smooth_angle)
