"""What an offset is: regions with holes, loops of edges that remember where they come from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from mat_core.analysis.offsetting.parallel import Source
from mat_core.analysis.outline import edge_dicts, measure
from mat_core.model.curve import RationalBSpline
from mat_core.model.domain import Domain


@dataclass(frozen=True, eq=False)
class OffsetEdge:
    """One edge of an offset.

    Attributes
    ----------
    curve : RationalBSpline
        In the caller's coordinates.
    kind : str
        ``line`` and ``arc`` are exact, ``spline`` is fitted.
    source : Source
        What it is parallel to.
    max_error : float
        Bound of the distance from the exact offset, nothing sampled (`mat_core.analysis.offsetting.parallel_bound`).
    """

    curve: RationalBSpline
    kind: str
    source: Source
    max_error: float


@dataclass(frozen=True, eq=False)
class OffsetLoop:
    """A closed loop, edges head to tail: counter-clockwise round a region, clockwise round a hole in it."""

    edges: tuple[OffsetEdge, ...]

    @property
    def curves(self) -> list[RationalBSpline]:
        """The curves of the edges."""
        return [e.curve for e in self.edges]

    @cached_property
    def _measures(self) -> tuple[float, float]:
        return measure(self.curves)

    @property
    def area(self) -> float:
        """Signed: negative for a hole."""
        return self._measures[0]

    @property
    def length(self) -> float:
        """Length of all edges."""
        return self._measures[1]


@dataclass(frozen=True, eq=False)
class OffsetRegion:
    """One connected part of what an offset encloses.

    Attributes
    ----------
    outer : OffsetLoop
    holes : tuple of OffsetLoop
    """

    outer: OffsetLoop
    holes: tuple[OffsetLoop, ...]

    @property
    def area(self) -> float:
        """Of the outer loop less that of the holes."""
        return self.outer.area + sum(hole.area for hole in self.holes)

    def domain(self) -> Domain:
        """The region as a domain, to solve and offset again."""
        return Domain.from_dict(self.to_dict())

    def to_dict(self) -> dict[str, Any]:
        """A JSON domain: what `Domain.from_dict` reads."""
        loops = [edge_dicts(loop.curves) for loop in (self.outer, *self.holes)]
        return {"outer": loops[0], "holes": loops[1:]}


@dataclass(frozen=True, eq=False)
class Offset:
    """The offset of a domain.

    Attributes
    ----------
    distance : float
        Inward where positive, in the caller's unit.
    regions : tuple of OffsetRegion
        Empty where no point of the domain is so far from its boundary.
    """

    distance: float
    regions: tuple[OffsetRegion, ...]

    @property
    def loops(self) -> tuple[OffsetLoop, ...]:
        """All loops, each region's outer one before its holes."""
        return tuple(loop for region in self.regions for loop in (region.outer, *region.holes))

    @property
    def paths(self) -> list[list[RationalBSpline]]:
        """The curves of each loop, head to tail: what formats draw."""
        return [loop.curves for loop in self.loops]

    @property
    def area(self) -> float:
        """Of all regions."""
        return sum(region.area for region in self.regions)

    @property
    def perimeter(self) -> float:
        """Length of all loops."""
        return sum(loop.length for loop in self.loops)

    @property
    def max_error(self) -> float:
        """Largest of the edges' errors; 0 where there is none."""
        return max((e.max_error for loop in self.loops for e in loop.edges), default=0.0)

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers: each of `regions` is a domain again; `edges` tells kind and source likewise."""
        return {
            "distance": self.distance,
            "area": self.area,
            "perimeter": self.perimeter,
            "max_error": self.max_error,
            "regions": [region.to_dict() for region in self.regions],
            "edges": [
                {"outer": _notes(region.outer), "holes": [_notes(hole) for hole in region.holes]} for region in self.regions
            ],
        }

    def __repr__(self) -> str:
        return f"<Offset {self.distance:g}: {len(self.regions)} regions, {len(self.loops)} loops, area {self.area:.6g}>"


def _notes(loop: OffsetLoop) -> list[dict[str, Any]]:
    """Kind, source and error of each edge."""
    out = []
    for e in loop.edges:
        s = e.source
        source: dict[str, Any] = {"loop": s.loop, "edge": s.edge, "u0": s.u0, "u1": s.u1}
        if s.angles is not None:
            source["angles"] = list(s.angles)
        out.append({"kind": e.kind, "source": source, "max_error": e.max_error})
    return out
