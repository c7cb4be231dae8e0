"""What the answer of an axis is made of: flat arrays of its curves and footpoints, and the pleasant objects made from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Point = tuple[float, float]


class CurveTable(NamedTuple):
    """The curves of all segments as flat arrays; normalised coordinates.

    degree (G,) and kind (G,), an index into `mat_core.axis.segment.SEGMENT_KINDS`. Segment g has the knots
    knots[knot_start[g]:knot_start[g + 1]], from 0 to 1, and the rows cp[cp_start[g]:cp_start[g + 1]]: x, y, r, weight
    (not multiplied by it). max_error (G,): a bound, see `Segment.max_error`. Pieces: part_start (G + 1,); part_i (P, 4):
    segment, strip, side, kind; part_f (P, 4): t0, t1 and the parameters s0, s1 at them on the strip's right site
    (side 0) or left site (side 1). One polynomial may go through several pieces: a knot stands only where it ends.
    """

    degree: Ints
    kind: Ints
    knot_start: Ints
    knots: Floats
    cp_start: Ints
    cp: Floats
    max_error: Floats
    part_start: Ints
    part_i: Ints
    part_f: Floats

    @property
    def part_segment(self) -> Ints:
        """Segment of each piece, (P,)."""
        return self.part_i[:, 0]

    @property
    def part_strip(self) -> Ints:
        """Strip of each piece, (P,)."""
        return self.part_i[:, 1]

    @property
    def part_t(self) -> Floats:
        """(t0, t1) of each piece, (P, 2)."""
        return self.part_f[:, :2]


class NodeFeet(NamedTuple):
    """Footpoints of the nodes' discs as flat arrays; node n has those from start[n] to start[n + 1] - 1.

    start (N + 1,); site (F,); points (F, 2) in the caller's coordinates; u (F,) on the input's edge; angle (F,): direction of the
    normal, told on a normal fan only.
    """

    start: Ints
    site: Ints
    points: Floats
    u: Floats
    angle: Floats


@dataclass(frozen=True, slots=True)
class Footpoint:
    """Where a maximal disc touches the boundary.

    Attributes
    ----------
    loop : int
        0 is the outer loop, i is ``holes[i - 1]`` of the input.
    edge : int
        Edge of that loop, as the input counts them.
    u : float
        Parameter on that edge, in the edge's own knots.
    point : tuple of float
        The place.
    angle : float or None
        At a reflex vertex, where all normals of a range start: direction of this one, in radians.
    """

    loop: int
    edge: int
    u: float
    point: Point
    angle: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """As in the answer document; with the angle on a reflex vertex only."""
        entry: dict[str, Any] = {"loop": self.loop, "edge": self.edge, "u": self.u, "point": list(self.point)}
        if self.angle is not None:
            entry["angle"] = self.angle
        return entry


@dataclass(frozen=True, slots=True)
class Node:
    """A leaf or branch point of the axis, with its maximal disc.

    Attributes
    ----------
    id : int
        Its index in `MedialAxis.nodes`.
    kind : str
        ``convex_vertex``, ``curvature_center``, ``arc_center``, ``branch`` or ``point``.
    point : tuple of float
        Centre of the disc.
    radius : float
        Its radius.
    footpoints : tuple of Footpoint
        Its contacts in cyclic order; where an arc is touched along its length, both ends of the arc.
    """

    id: int
    kind: str
    point: Point
    radius: float
    footpoints: tuple[Footpoint, ...]


class Samples(NamedTuple):
    """True axis points of segments, not points of their fitted curves.

    t (n,); points (n, 2); radii (n,); left and right (n, 2): footpoints; left_site and right_site (n,): rows of the
    site table; left_u, right_u (n,): the input's parameter; left_angle, right_angle (n,): direction of the normal.
    """

    t: Floats
    points: Floats
    radii: Floats
    left: Floats
    right: Floats
    left_site: Ints
    right_site: Ints
    left_u: Floats
    right_u: Floats
    left_angle: Floats
    right_angle: Floats


@dataclass(frozen=True)
class Graph:
    """How nodes and segments hang together: the directed graph of the paper's section 6.

    A depth-first walk lists nodes and segments as it meets them, and directs every segment from the node met first to the one
    met later: so node ids are a topological order, and the directed graph has no cycle. It starts at a convex vertex. Where
    the domain has none it starts at a curvature centre, without one at an arc centre, else (a ring with spokes of reflex
    vertices, say) at any branch point. A segment that returns to the branch point it leaves, round a hole, has one node as
    source and target: it alone has no direction the order could give it. A closed segment without a node is listed last, and is
    no part of the order.

    "Acyclic" is said of the directed graph alone, loops at one node left aside. The undirected one has a cycle for every hole:
    `cycles` is its rank, segments - nodes + components.

    Attributes
    ----------
    edges : tuple of (int, int or None, int or None)
        (segment, source node, target node).
    topological_order : tuple of int
        Nodes, sources before targets, the node where the walk started first.
    components, cycles : int
        Of the undirected graph; closed segments count as one component with one cycle.
    """

    edges: tuple[tuple[int, int | None, int | None], ...]
    topological_order: tuple[int, ...]
    components: int
    cycles: int
