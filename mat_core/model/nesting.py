"""Which loop lies inside which: judged by shapely on polygons, by the exact curves where the polygons are too coarse.

Loops that do not meet are inside or outside each other as a whole, so one point of each decides: its first control
point, which lies on the curve itself. A tree of these points is asked with all polygons at once, so that a grid of a
thousand holes takes no million comparisons.
"""

from __future__ import annotations

from collections.abc import Iterator, Set

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core.errors import Problem
from mat_core.kernels import outline as columns
from mat_core.kernels.bezier import point, restrict
from mat_core.model.flattening import flatten
from mat_core.model.loop import Outline
from mat_core.model.meetings import Meeting
from mat_core.model.values import loop_pointer

ROUNDING = 1e-13  # normalised: of the polygons' corners, with much to spare


def loops_around(outline: Outline, loops: NDArray[np.int64], met: Set[tuple[int, int]]) -> NDArray[np.int64]:
    """Rows (a, b), for these loops (ascending): loop a lies around loop b. Means nothing for pairs that met (smaller first)."""
    flattening = flatten(outline, loops)
    tree = shapely.STRtree(shapely.points(outline.first_points(loops)))
    # Both queries prepare the geometries they are asked with.
    inside = tree.query(shapely.polygons(flattening.rings), predicate="contains_properly").T
    close = tree.query(flattening.rings, predicate="dwithin", distance=flattening.error + ROUNDING).T
    undecided = close[close[:, 0] != close[:, 1]]
    if len(undecided):
        apart = ~np.isin(inside @ (len(loops), 1), undecided @ (len(loops), 1))
        exact = [
            (min(a, b), max(a, b)) not in met and is_inside(outline, a, *outline.first_points(b).tolist())
            for a, b in loops[undecided].tolist()
        ]
        inside = np.concatenate((inside[apart], undecided[np.array(exact)]))
    return np.asarray(loops[inside], dtype=np.int64)


def is_inside(outline: Outline, loop: int, qx: float, qy: float) -> bool:
    """Whether (qx, qy) lies inside the exact curve of a loop; assumes it does not lie on it.

    Crossings of the ray from q towards +x are counted modulo two. What lies wholly to the right of q crosses an odd
    number of times just when its ends differ in "above q"; each end is judged once, for both pieces that share it.
    """
    pieces = range(*outline.piece_start[loop : loop + 2].tolist())
    x1, y0, y1 = outline.pf[pieces.start : pieces.stop, [columns.XMAX, columns.YMIN, columns.YMAX]].T
    odd = False
    for k in np.flatnonzero((y0 <= qy) & (y1 >= qy) & (x1 >= qx)).tolist():
        degree, row = outline.pi[pieces[k], :2].tolist()
        above = [bool(outline.cp[end, 1] > qy) for end in (row, row + degree)]
        ranges = [(0.0, above[0], 1.0, above[1])]
        while ranges:
            t0, above0, t1, above1 = ranges.pop()
            restrict(outline.cp, row, degree, t0, t1, outline.work, 0)
            block = outline.work[: degree + 1, :2]
            (left, low), (right, high) = block.min(axis=0).tolist(), block.max(axis=0).tolist()
            if right < qx or (above0 == above1 and (low > qy or high < qy)):
                continue
            small = max(right - left, high - low) <= columns.NOTHING or t1 - t0 <= columns.NARROWEST
            if left > qx or small:
                odd ^= above0 != above1
                continue
            middle = 0.5 * (t0 + t1)
            split = point(outline.cp, row, degree, middle)[1] > qy
            ranges += [(middle, split, t1, above1), (t0, above0, middle, split)]
    return odd


def nesting_problems(outline: Outline, meetings: list[Meeting], flat: set[int]) -> Iterator[Problem]:
    """Holes inside the outer loop, none inside another; silent on loops that meet, are flat, or could not be used."""
    loops = np.flatnonzero(outline.piece_start[:-1] < outline.piece_start[1:])
    if flat:
        loops = np.setdiff1d(loops, list(flat))
    if not loops.any():
        return
    met = {m.loops for m in meetings}
    pairs = loops_around(outline, loops, met)
    if loops[0] == 0 and len(pairs) == len(loops) - 1 and not pairs[:, 0].any():
        return  # The outer loop lies around each hole, and nothing else around any.
    around: dict[int, list[int]] = {loop: [] for loop in loops.tolist()}
    for outside, loop in pairs.tolist():
        around[loop].append(outside)
    for hole in filter(None, around):
        x, y = outline.frame.to_input(*outline.first_points(hole).tolist())
        at = loop_pointer(hole)
        if 0 in around and (0, hole) not in met and 0 not in around[hole]:
            how = "encloses the outer loop" if hole in around[0] else "lies outside the outer loop"
            text = (
                f"hole {hole - 1} {how}, at ({x:.9g}, {y:.9g}); it must lie inside. Move it, or make it the outer loop"
            )
            yield Problem("hole-outside", at, text, hole, None, None, x, y, "/outer")
        others = [k for k in around[hole] if k > 0 and (min(hole, k), max(hole, k)) not in met]
        if others:
            text = (
                f"hole {hole - 1} lies inside hole {min(others) - 1}, at ({x:.9g}, {y:.9g}), where there is no "
                "material; leave it out, or give the island as a domain of its own"
            )
            yield Problem("hole-in-hole", at, text, hole, None, None, x, y, loop_pointer(min(others)))
