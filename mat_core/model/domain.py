"""The domain: a region bounded by one outer loop and any number of holes, checked once, at this gate."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from mat_core.kernels.measuring import AREA, LEFT, TOP
from mat_core.model.curve import RationalBSpline
from mat_core.model.healing import Note
from mat_core.model.loop import BoundaryArrays, Frame, Outline
from mat_core.model.problems import check
from mat_core.model.reading import CONTROL_POINT_LIMIT


@dataclass(frozen=True, eq=False)
class Domain:
    """A valid domain. Build it with `Domain.from_dict`; the constructor itself checks nothing.

    Parameters
    ----------
    arrays : BoundaryArrays
        The boundary in the input's own coordinates and orientation, healed where it had to be.
    bbox : tuple of float
        Tight bounds (xmin, ymin, xmax, ymax) of the outer loop's curves, in the caller's unit.
    area : float
        Area of the outer loop less that of the holes, in the caller's unit squared, to rounding.
    options : dict
        Options of the request that were given: tolerance, step, method, check_step, smooth_angle, samples.
    name : str, optional
        The document's name for itself.
    given : BoundaryArrays, optional
        The boundary before it was healed; None if it is the same.
    notes : tuple of Note
        What was healed, each with a JSON pointer and a text; empty for most domains.
    """

    arrays: BoundaryArrays
    bbox: tuple[float, float, float, float]
    area: float
    options: dict[str, Any]
    name: str | None = None
    given: BoundaryArrays | None = None
    notes: tuple[Note, ...] = ()

    @classmethod
    def from_dict(cls, obj: object, *, max_control_points: int = CONTROL_POINT_LIMIT) -> Domain:
        """Check a domain object and take it over.

        Parameters
        ----------
        obj : mapping
            ``{"outer": [edge, ...], "holes": [[edge, ...], ...], "options": {...}}``; an edge is ``{"degree": p,
            "control_points": [[x, y], ...], "knots": [...], "weights": [...]}``, a clamped rational B-spline. Knots may
            be left out for a Bezier curve, weights when all are 1. A string ``name`` is kept; ``note`` and ``truth`` are
            annotations, of any kind, and ignored. Lengths in the options are relative to `size`.
        max_control_points : int
            Size above which the domain is refused as too-complex.

        Returns
        -------
        Domain

        Raises
        ------
        InvalidDomain
            When any rule is broken; its `problems` names all of them with code, JSON pointer, parameter and place.

        Examples
        --------
        >>> corners = [[0, 0], [2, 0], [2, 1], [0, 1]]
        >>> sides = [{"degree": 1, "control_points": [corners[i - 1], corners[i]]} for i in range(4)]
        >>> Domain.from_dict({"outer": sides})
        <Domain 1 loop, 4 edges, area 2, bbox (0, 0, 2, 1)>
        """
        found = check(obj, max_control_points)
        arrays, outline = found.arrays, found.outline
        name = obj.get("name") if isinstance(obj, dict) else None
        given = None if found.given.cp is arrays.cp else found.given
        return cls(arrays, _bounds(outline), _area(outline), found.options, name, given, found.notes)

    @property
    def size(self) -> float:
        """The larger side of `bbox`; every relative tolerance refers to it."""
        return max(self.bbox[2] - self.bbox[0], self.bbox[3] - self.bbox[1])

    @cached_property
    def outer(self) -> tuple[RationalBSpline, ...]:
        """The outer loop's edges, as given."""
        return (self.given or self.arrays).loop(0)

    @cached_property
    def holes(self) -> tuple[tuple[RationalBSpline, ...], ...]:
        """The holes' edges, as given."""
        given = self.given or self.arrays
        return tuple(given.loop(i) for i in range(1, len(self.arrays.loop_start) - 1))

    @property
    def loops(self) -> tuple[tuple[RationalBSpline, ...], ...]:
        """The edges of all loops, numbered as footpoints number them: the outer one, then the holes."""
        return (self.outer, *self.holes)

    def to_dict(self) -> dict[str, object]:
        """The domain in the form `from_dict` reads, knots always written out."""
        document: dict[str, object] = {} if self.name is None else {"name": self.name}
        document["outer"] = [edge.to_dict() for edge in self.outer]
        document["holes"] = [[edge.to_dict() for edge in hole] for hole in self.holes]
        if self.options:
            document["options"] = dict(self.options)
        return document

    def __repr__(self) -> str:
        loops, edges = len(self.arrays.loop_start) - 1, len(self.arrays.degree)
        box = ", ".join(f"{v:.6g}" for v in self.bbox)
        counted = f"{loops} loop{'s' * (loops > 1)}, {edges} edge{'s' * (edges > 1)}"
        return f"<Domain {counted}, area {self.area:.6g}, bbox ({box})>"


def _area(outline: Outline) -> float:
    areas = np.abs(outline.measures[:, AREA])
    return float((areas[0] - areas[1:].sum()) / outline.frame.scale / outline.frame.scale)


def _bounds(outline: Outline) -> tuple[float, float, float, float]:
    """Tight bounds of the outer loop. Where an end of an edge is the extreme its own coordinate is taken, unrounded."""
    frame: Frame = outline.frame
    extent = outline.extent(0)
    ends = outline.measures[0, LEFT : TOP + 1].tolist()
    bounds = []
    for k, sign in enumerate((-1.0, -1.0, 1.0, 1.0)):
        axis = k % 2
        reach = sign * extent[k]
        end_reach = sign * (ends[k] - frame.origin[axis]) * frame.scale
        bounds.append(ends[k] if reach <= end_reach else frame.to_input(extent[k], extent[k])[axis])
    return bounds[0], bounds[1], bounds[2], bounds[3]
