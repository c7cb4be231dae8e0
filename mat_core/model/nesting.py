"""Which loop lies inside which: judged by shapely on polygons, by the exact curves where the polygons are too coarse.

Loops that do not meet are inside or outside each other as a whole, so one point of each decides: its first control
point, which lies on the curve itself. A tree of these points is asked with all polygons at once, so that a grid of a
thousand holes takes no million comparisons.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from mat_core.errors import Problem
from mat_core.kernels.outline import CP0
from mat_core.model.flattening import flatten
from mat_core.model.loop import Outline
from mat_core.model.meetings import Meeting
from mat_core.model.reading import loop_pointer

ROUNDING = 1e-13  # normalised: of the polygons' corners, with much to spare


def loops_around(outline: Outline, loops: Sequence[int]) -> dict[int, list[int]]:
    """For each of these loops (ascending) the others among them around it; holds for pairs that do not meet."""
    flattening = flatten(outline, loops)
    at = np.asarray(loops)
    tree = shapely.STRtree(shapely.points(outline.cp[outline.pi[outline.piece_start[at], CP0], :2]))
    # Both queries prepare the geometries they are asked with.
    around, inside = tree.query(shapely.polygons(flattening.rings), predicate="contains_properly")
    close = tree.query(flattening.rings, predicate="dwithin", distance=flattening.error + ROUNDING)
    close = close[:, close[0] != close[1]]
    clear = ~np.isin(around * len(at) + inside, close[0] * len(at) + close[1])
    found: dict[int, list[int]] = {loop: [] for loop in loops}
    # The kernel is called for no pairs at all, too: the first close call must not wait for the compiler.
    exact = outline.contains(at[close.T])
    for pairs in (at[np.column_stack((around, inside))[clear]], at[close.T][exact]):
        for outer, inner in pairs.tolist():
            found[inner].append(outer)
    return found


def nesting_problems(outline: Outline, meetings: list[Meeting], flat: set[int]) -> Iterator[Problem]:
    """Holes inside the outer loop, none inside another; silent on loops that meet, are flat, or could not be used."""
    starts = outline.piece_start
    loops = [k for k in range(len(starts) - 1) if starts[k] < starts[k + 1] and k not in flat]
    if not any(loops):
        return
    met = {m.loops for m in meetings}
    around = loops_around(outline, loops)
    for hole in filter(None, loops):
        x, y = outline.frame.to_input(*outline.cp[outline.pi[starts[hole], CP0], :2].tolist())
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
