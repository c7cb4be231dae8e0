"""How thick a domain is along its axis, where it is thinnest, and which boundary lies on walls thinner than a limit.

The thickness at a boundary point is the diameter of the maximal disc that touches there. Taken alone that goes to zero into
every convex corner, where nobody would speak of a wall. So a disc counts as *wall* where two of its contacts face each other:
seen from its centre they stand at least `angle` apart,

        ______x______                          x        x  contacts        theta  the angle between them
             /|\\                              /
            ( o )   theta = 180 degrees      ( o ) theta = 180 degrees - alpha in a corner of alpha,
             \\|/    between parallel sides    \\      whatever the radius
        ______x______                          x

and |dr/ds| = cos(theta / 2) along a segment, so that theta >= angle is an inequality between polynomials on each span. A taper
narrower than 180 degrees - angle is a wall down to its tip, which is a knife edge of no thickness. Every neck (see
`mat_core.analysis.inscribed`) is wall for any angle: there dr/ds = 0.

After the sphere thickness of mould and casting design (M. Inui, N. Umezu, K. Wakasaki, S. Sato, "Thickness and clearance
visualization based on distance field of 3D objects", 2015), which leaves corners to the user's eye.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.inscribed import discs_of, find_tops, terrain
from mat_core.analysis.intervals import Intervals, containing, intersection
from mat_core.analysis.options import real
from mat_core.analysis.places import AxisDisc, disc_at_node, discs_inside, radius_noise
from mat_core.analysis.radii import RadiusArcs, radius_arcs, radius_intervals
from mat_core.analysis.slopes import slope_intervals
from mat_core.analysis.touching import BoundaryInterval, facing_discs, touched
from mat_core.axis import MedialAxis
from mat_core.errors import UnsupportedOption

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WALL_ANGLE = math.radians(150.0)  # sides that open by less than 30 degrees are a wall


@dataclass(frozen=True, slots=True)
class Thickness:
    """How thick the domain is at one place.

    Attributes
    ----------
    thickness : float
        Diameter of the disc.
    disc : AxisDisc
        The maximal disc: segment, t, centre, both footpoints. At a node where no segment is wall, all of its footpoints.
    kind : str
        ``neck`` where it grows to both sides, or stays; ``taper`` where the wall ends: its sides open to the angle, or meet.
    """

    thickness: float
    disc: AxisDisc
    kind: str

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        return {"thickness": self.thickness, "kind": self.kind, "disc": self.disc.to_dict()}


@dataclass(frozen=True, slots=True)
class Wall:
    """A stretch of a segment whose discs are wall: from t0 to t1, its least and its largest thickness."""

    segment: int
    t0: float
    t1: float
    least: float
    largest: float

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers."""
        return {"segment": self.segment, "t": [self.t0, self.t1], "least": self.least, "largest": self.largest}


@dataclass(frozen=True, slots=True)
class Width:
    """Thickness of a domain.

    Attributes
    ----------
    minimum : Thickness or None
        The thinnest wall; None if no disc is wall (a triangle without a sharp corner, say).
    necks : tuple of Thickness
        Local minima of the thickness over the whole axis, the thinnest first.
    walls : tuple of Wall
        In order of segment and t.
    thin : tuple of BoundaryInterval or None
        With a limit: the boundary on walls no thicker than it, in order of loop, edge and u; None without.
    thin_walls : tuple of Wall or None
        With a limit: what of `walls` is no thicker than it, cut where it grows thicker; None without.
    angle : float
        Radians; what counts as wall.
    limit : float or None
        As asked.
    """

    minimum: Thickness | None
    necks: tuple[Thickness, ...]
    walls: tuple[Wall, ...]
    thin: tuple[BoundaryInterval, ...] | None
    thin_walls: tuple[Wall, ...] | None
    angle: float
    limit: float | None

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers."""
        return {
            "minimum": None if self.minimum is None else self.minimum.to_dict(),
            "necks": [n.to_dict() for n in self.necks],
            "walls": [w.to_dict() for w in self.walls],
            "thin": None if self.thin is None else [i.to_dict() for i in self.thin],
            "thin_walls": None if self.thin_walls is None else [w.to_dict() for w in self.thin_walls],
            "angle": self.angle,
            "limit": self.limit,
        }


def width(axis: MedialAxis, limit: float | None = None, *, angle: float = WALL_ANGLE) -> Width:
    """Wall thickness along the axis: the least and where, the necks, and what boundary is on thinner walls than a limit.

    Parameters
    ----------
    axis : MedialAxis
    limit : float, optional
        Thickness in the caller's unit. Where it is given, `Width.thin` lists the boundary that walls touch
        whose discs have this diameter or less, `Width.thin_walls` these walls themselves.
    angle : float
        Radians, 0 to pi. A disc is wall where two of its contacts are at least this far apart as seen from its centre; 0 makes
        a wall of everything, corners too. The default lets sides open by 30 degrees.

    Returns
    -------
    Width
        Thickness to within twice the stated error of the curves.

    Raises
    ------
    UnsupportedOption
        `limit` is negative or not finite, or `angle` is not between 0 and pi.
    """
    limit = None if limit is None else real("limit", limit)
    angle = real("angle", angle)
    if limit is not None and not (limit >= 0.0 and math.isfinite(limit)):
        raise UnsupportedOption("limit", f"{limit} is not a thickness of at least 0")
    if not 0.0 <= angle <= math.pi:
        raise UnsupportedOption("angle", f"{angle} is not between 0 and pi radians")
    arcs = radius_arcs(axis)
    stretches = slope_intervals(axis, math.cos(0.5 * angle))
    walls, places = _walls(axis, stretches, arcs)
    facing = facing_discs(axis, angle)
    thin = thin_walls = None
    if limit is not None:
        below = intersection(stretches, radius_intervals(axis, high=0.5 * limit, arcs=arcs))
        thin = touched(axis, below, facing[axis.skeleton.disc[facing, 2] / axis.table.scale <= 0.5 * limit])
        thin_walls, _ = _walls(axis, below, arcs)
    return Width(_minimum(axis, walls, places, facing), _necks(axis, arcs), walls, thin, thin_walls, float(angle), limit)


def _walls(axis: MedialAxis, stretches: Intervals, arcs: RadiusArcs) -> tuple[tuple[Wall, ...], Floats]:
    """Walls, and (n,) the t of the least thickness of each: at an end, or where the radius turns."""
    n = len(stretches.segment)
    segment = np.concatenate((stretches.segment, stretches.segment, arcs.segment))
    t = np.concatenate((stretches.t[:, 0], stretches.t[:, 1], arcs.t[:, 0]))
    owner = np.concatenate((np.arange(n), np.arange(n), containing(stretches, arcs.segment, arcs.t[:, 0])))
    segment, t, owner = segment[owner >= 0], t[owner >= 0], owner[owner >= 0]
    radius = axis.evaluate(segment, t)[:, 2]
    order = np.lexsort((radius, owner))
    first = np.searchsorted(owner[order], np.arange(n))
    last = np.searchsorted(owner[order], np.arange(n), side="right") - 1
    least, largest = 2.0 * radius[order[first]], 2.0 * radius[order[last]]
    rows = zip(stretches.segment.tolist(), stretches.t.tolist(), least.tolist(), largest.tolist(), strict=True)
    return tuple(Wall(g, t0, t1, low, high) for g, (t0, t1), low, high in rows), t[order[first]]


def _minimum(axis: MedialAxis, walls: tuple[Wall, ...], places: Floats, facing: Ints) -> Thickness | None:
    """The thinnest place of the walls; of the discs at nodes that face themselves, one that is thinner still."""
    best: Thickness | None = None
    if walls:
        i = min(range(len(walls)), key=lambda k: walls[k].least)
        g, t = walls[i].segment, float(places[i])
        disc = discs_inside(axis, np.array([g]), np.array([t]))[0]
        ends = t in (walls[i].t0, walls[i].t1)
        steep = abs(float(axis.segments[g].dr_ds(t))) > 1e-6
        best = Thickness(2.0 * disc.radius, disc, "taper" if ends and steep else "neck")
    nodes = np.nonzero(np.isin(axis.runs.node_disc, facing))[0]
    if len(nodes):
        node = int(nodes[np.argmin(axis.node_discs[nodes, 2])])
        disc = disc_at_node(axis, node)
        if best is None or 2.0 * disc.radius < best.thickness - radius_noise(axis):
            best = Thickness(2.0 * disc.radius, disc, "neck")
    return best


def _necks(axis: MedialAxis, arcs: RadiusArcs) -> tuple[Thickness, ...]:
    """All necks, the thinnest first."""
    ground = terrain(axis, arcs)
    discs = discs_of(axis, ground, np.unique(find_tops(ground, radius_noise(axis)).necks[:, 0]))
    return tuple(Thickness(2.0 * d.radius, d, "neck") for d in sorted(discs, key=lambda d: d.radius))
