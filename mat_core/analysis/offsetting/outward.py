"""Offsets outward: what grows round a domain, read off the axes of what is not in it.

The exterior is a domain, too, once a frame is put round it: far enough away, its own offset meets nothing else's. The
inside of every hole is another one. Each is solved with `medial_axis` and offset inward; the parts that come from the
frame are dropped, the loops turned round. The exterior's unbounded part gives the outer loop of the result; its other
parts (behind mouths that close before they are filled) and those of the holes are holes.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from mat_core.analysis.offsetting.inward import InwardOffsets
from mat_core.analysis.offsetting.parallel import Source
from mat_core.analysis.offsetting.regions import OffsetEdge, OffsetLoop, OffsetRegion
from mat_core.analysis.outline import edge_dicts
from mat_core.axis import MedialAxis
from mat_core.errors import InvalidDomain, NotCertified
from mat_core.model.curve import RationalBSpline
from mat_core.model.domain import Domain
from mat_core.pipeline import medial_axis

CLEARANCE = 2.5  # of the frame, in distances: points within one distance of the domain are nearer to it than to the frame
SMOOTH_ANGLE = 1e-6  # `medial_axis` without an option
MARGIN = 0.25  # more, relative to the size: where the distance is small the frame is not near, either


class OutwardOffsets:
    """Outward offsets of one domain, up to a farthest distance.

    Parameters
    ----------
    axis : MedialAxis
        Its tolerance and smooth_angle are those of the exterior's axes.
    farthest : float
        Largest distance that will be asked for, in the caller's unit.

    Raises
    ------
    NotCertified
        Where the exterior cannot be solved.
    """

    def __init__(self, axis: MedialAxis, farthest: float) -> None:
        domain = axis.domain
        self.exterior = InwardOffsets(_solved(axis, [_frame(domain, farthest)], domain.outer, "the exterior"))
        self.inside = [
            InwardOffsets(_solved(axis, [], hole, f"the inside of hole {i}")) for i, hole in enumerate(domain.holes)
        ]

    def region(self, distance: float, tolerance: float) -> OffsetRegion:
        """What lies within a distance of the domain, the domain included; lengths in the caller's unit."""
        outer: OffsetLoop | None = None
        holes: list[OffsetLoop] = []
        for part in self.exterior.regions(distance, tolerance):
            if part.outer.edges[0].source.loop == 0:
                (outer,) = (_turned(hole, 0) for hole in part.holes)
            else:
                holes.append(_turned(part.outer, 0))
        for i, inside in enumerate(self.inside):
            holes += [_turned(part.outer, i + 1) for part in inside.regions(distance, tolerance)]
        assert outer is not None
        return OffsetRegion(outer, tuple(holes))


def _frame(domain: Domain, farthest: float) -> list[RationalBSpline]:
    """A rectangle round the domain, far enough away."""
    xmin, ymin, xmax, ymax = domain.bbox
    gap = CLEARANCE * farthest + MARGIN * domain.size
    corners = [(xmin - gap, ymin - gap), (xmax + gap, ymin - gap), (xmax + gap, ymax + gap), (xmin - gap, ymax + gap)]
    ends = [np.array([corners[i - 1], corners[i]]) for i in range(4)]
    return [RationalBSpline(1, np.array([0.0, 0.0, 1.0, 1.0]), end, np.ones(2)) for end in ends]


def _solved(
    axis: MedialAxis, frames: Iterable[list[RationalBSpline]], loop: tuple[RationalBSpline, ...], what: str
) -> MedialAxis:
    """The axis between a frame and a loop, or inside the loop where there is no frame."""
    loops = [edge_dicts(edges) for edges in (*frames, loop)]
    angle = float(axis.certificate.get("smooth_angle", axis.domain.options.get("smooth_angle", SMOOTH_ANGLE)))
    try:
        return medial_axis(Domain.from_dict({"outer": loops[0], "holes": loops[1:]}), axis.tolerance, smooth_angle=angle)
    except InvalidDomain as error:
        raise NotCertified(f"offset: {what} is not a valid domain: {error}") from error
    except NotCertified as error:
        raise NotCertified(f"offset: {what} was not solved: {error.detail}", error.place, error.certificate) from error


def _turned(loop: OffsetLoop, index: int) -> OffsetLoop:
    """A loop run the other way, its sources on loop `index` of the input."""
    edges = []
    for e in reversed(loop.edges):
        s, c = e.source, e.curve
        angles = s.angles[::-1] if s.angles is not None else None
        curve = RationalBSpline(c.degree, (1.0 - c.knots)[::-1], c.control_points[::-1], c.weights[::-1])
        edges.append(OffsetEdge(curve, e.kind, Source(index, s.edge, s.u1, s.u0, angles), e.max_error))
    return OffsetLoop(tuple(edges))
