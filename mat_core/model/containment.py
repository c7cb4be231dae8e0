"""Which points lie inside a domain: by shapely on polygons of known error, by the exact curves near them."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core.model.domain import Domain
from mat_core.model.flattening import flatten
from mat_core.model.loop import box_of, frame_of, outline_of
from mat_core.model.nesting import ROUNDING, is_inside


def inside_domain(domain: Domain, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether each point lies inside the outer loop and outside all holes.

    Parameters
    ----------
    domain : Domain
    points : (n, 2) float64
        In the caller's unit, finite. A point on the boundary counts as either.

    Returns
    -------
    (n,) bool
    """
    arrays = domain.arrays
    loops = np.arange(len(arrays.loop_start) - 1)
    frame = frame_of(box_of(arrays.cp), float(np.abs(arrays.cp[:, :2]).max()))
    outline = outline_of(arrays, np.ones(len(loops), dtype=np.int64), frame)
    flattening = flatten(outline, loops.tolist())
    local = (points - np.array(frame.origin)) * frame.scale
    dots = shapely.points(local)
    point, loop = shapely.STRtree(shapely.polygons(flattening.rings)).query(dots, predicate="within")
    ring, near = shapely.STRtree(dots).query(flattening.rings, predicate="dwithin", distance=flattening.error + ROUNDING)
    # polygons are right about points farther away than their error, the exact curves about the others
    sure = ~np.isin(point * len(loops) + loop, near * len(loops) + ring)
    exact = np.array([is_inside(outline, k, *local[i].tolist()) for i, k in zip(near.tolist(), ring.tolist(), strict=True)])
    exact = exact.astype(bool)
    point, loop = np.concatenate((point[sure], near[exact])), np.concatenate((loop[sure], ring[exact]))
    within = np.zeros(len(points), dtype=bool)
    within[point[loop == 0]] = True
    within[point[loop > 0]] = False
    return within
