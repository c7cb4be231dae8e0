"""Places on an axis with their maximal discs, in the form that results share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.axis import Footpoint, MedialAxis, Point

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDING = 1e-14  # relative to coordinates: radii that were meant to be equal differ by less


@dataclass(frozen=True, slots=True)
class AxisDisc:
    """A maximal disc and where on the axis it sits: at a node, or inside a segment.

    Attributes
    ----------
    point : tuple of float
        Its centre.
    radius : float
        Its radius.
    node : int or None
        Id of the node.
    segment : int or None
        Id of the segment, None at a node.
    t : float or None
        Parameter on the segment.
    footpoints : tuple of Footpoint
        Its contacts: at a node all of them, else the left and the right one.
    """

    point: Point
    radius: float
    node: int | None
    segment: int | None
    t: float | None
    footpoints: tuple[Footpoint, ...]

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        return {
            "point": list(self.point),
            "radius": self.radius,
            "node": self.node,
            "segment": self.segment,
            "t": self.t,
            "footpoints": [f.to_dict() for f in self.footpoints],
        }


def disc_at_node(axis: MedialAxis, node: int) -> AxisDisc:
    """The disc of a node."""
    n = axis.nodes[node]
    return AxisDisc(n.point, n.radius, n.id, None, None, n.footpoints)


def discs_inside(axis: MedialAxis, segment: Ints, t: Floats) -> list[AxisDisc]:
    """The true discs beside the curves' points at (segment, t), each (n,)."""
    s = axis.sample(segment, t)
    points, radii = s.points.tolist(), s.radii.tolist()
    out = []
    for i, (g, at) in enumerate(zip(segment.tolist(), t.tolist(), strict=True)):
        feet = (
            axis.footpoint(int(s.left_site[i]), s.left_u[i], s.left[i], s.left_angle[i]),
            axis.footpoint(int(s.right_site[i]), s.right_u[i], s.right[i], s.right_angle[i]),
        )
        out.append(AxisDisc((points[i][0], points[i][1]), radii[i], None, g, at, feet))
    return out


def radius_noise(axis: MedialAxis) -> float:
    """Difference of two radii up to which the curves cannot tell which is larger, in the caller's unit.

    Twice the largest stated error, and what rounding makes of equal radii, also through the input's own coordinates.
    """
    rounding = ROUNDING * max(axis.domain.size, *(abs(v) for v in axis.domain.bbox))
    return float(2.0 * axis.curves.max_error.max(initial=0.0) / axis.table.scale + rounding)
