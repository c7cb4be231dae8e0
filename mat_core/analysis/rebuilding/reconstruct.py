"""The boundary again, from the medial axis and its radius alone.

1. Each segment gives two curves, the envelope of its discs on the right and on the left (`envelope`).
2. Sides follow each other in the order of the boundary (`walk`).
   One that errors turn back along itself is cut to what runs ahead (`folds`).
3. Where the two do not meet the disc itself lies between them, a contact along an arc: it is put in. The gap is the angle
   between both segments less their sides' own, so that also arcs of more than half a turn are told from none.
4. Where errors have made a loop cross itself, what runs round in between is cut out (`untangling`).
5. Loops are measured against the domain's own edges, both ways.

Nothing is taken from the boundary but for that comparison.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.offsetting.parallel import QUARTER, arc_spline
from mat_core.analysis.outline import edge_dicts, measure
from mat_core.analysis.rebuilding.closing import Part, Vertex, closed, common_point
from mat_core.analysis.rebuilding.distance import farthest, pieces_of
from mat_core.analysis.rebuilding.envelope import Envelope
from mat_core.analysis.rebuilding.folds import follow, forward
from mat_core.analysis.rebuilding.untangling import untangled
from mat_core.analysis.rebuilding.walk import Side, Walk
from mat_core.axis import MedialAxis
from mat_core.errors import NotCertified
from mat_core.model.curve import RationalBSpline

Floats = NDArray[np.float64]

FIT_SHARE = 0.1  # of the axis's tolerance, for the curves of the boundary
SNAP = 1e-9  # normalised: a shorter arc is rounding of e, which moves along the boundary only
NEARLY_POINT = 0.1  # of what the disc turns: a side that stays within so much of its start may be a vertex
POINT = 4.0  # errors of the axis by which discs may miss a vertex


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """A boundary rebuilt from an axis; lengths in the caller's unit.

    Attributes
    ----------
    outer : tuple of RationalBSpline
        Edges head to tail, counter-clockwise.
    holes : tuple of tuple of RationalBSpline
        Likewise, clockwise.
    to_boundary : float
        Largest distance of its points from the domain's own boundary, measured at many.
    from_boundary : float
        Largest distance of the boundary's points from it, likewise.
    area : float
        Enclosed.
    """

    outer: tuple[RationalBSpline, ...]
    holes: tuple[tuple[RationalBSpline, ...], ...]
    to_boundary: float
    from_boundary: float
    area: float

    @property
    def paths(self) -> list[list[RationalBSpline]]:
        """The curves of each loop, the outer one first: what formats draw."""
        return [list(loop) for loop in (self.outer, *self.holes)]

    @property
    def distance(self) -> float:
        """The larger one of both distances."""
        return max(self.to_boundary, self.from_boundary)

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts, lists and numbers; ``outer`` and ``holes`` are those of a JSON domain."""
        return {
            "outer": edge_dicts(self.outer),
            "holes": [edge_dicts(hole) for hole in self.holes],
            "to_boundary": self.to_boundary,
            "from_boundary": self.from_boundary,
            "area": self.area,
        }


class _Gap(NamedTuple):
    """Between two sides: the turn of the disc (anticlockwise), and the disc."""

    turn: float
    disc: Floats


def reconstruct(axis: MedialAxis) -> Reconstruction:
    """The boundary as the envelope of the maximal discs.

    Parameters
    ----------
    axis : MedialAxis
        The rebuilt boundary is as near to the domain's as the axis's curves are to the true ones.

    Returns
    -------
    Reconstruction

    Raises
    ------
    NotCertified
        The sides do not close to one outer loop and holes: a defect of the axis, or one whose errors are as large as a hole.

    Notes
    -----
    Loops do not cross themselves or each other but where two walls are nearer to each other than the errors of the axis: the
    result is as near to the boundary there as everywhere, but is no domain; a finer tolerance gives one.

    H. Blum, "A transformation for extracting new descriptors of shape" (1967): axis and radius determine the shape.
    """
    table = axis.table
    loops = _circle(axis) if not len(axis.segments) else _Rebuilder(axis, _fit_tolerance(axis)).loops()
    curves = [
        [RationalBSpline(c.degree, c.knots, c.control_points / table.scale + table.origin, c.weights) for c in loop]
        for loop in loops
    ]
    curves = untangled(curves, _error(axis))
    areas = [measure(loop)[0] for loop in curves]
    outside = [i for i, a in enumerate(areas) if a > 0.0]
    if len(outside) != 1:
        raise NotCertified(f"reconstruct: {len(outside)} loops run anticlockwise, not 1")
    origin = table.origin
    rebuilt = pieces_of((c for loop in curves for c in loop), origin)
    given = pieces_of((c for loop in (axis.domain.outer, *axis.domain.holes) for c in loop), origin)
    holes = tuple(tuple(loop) for i, loop in enumerate(curves) if i != outside[0])
    return Reconstruction(
        tuple(curves[outside[0]]), holes, farthest(rebuilt, given), farthest(given, rebuilt), math.fsum(areas)
    )


def _error(axis: MedialAxis) -> float:
    """By which the curves of a rebuilt boundary may miss the true ones, in the caller's unit."""
    return (float(axis.curves.max_error.max(initial=0.0)) + _fit_tolerance(axis)) / axis.table.scale


def _fit_tolerance(axis: MedialAxis) -> float:
    """Of the curves of the boundary, normalised."""
    return FIT_SHARE * axis.tolerance * axis.domain.size * axis.table.scale


def _circle(axis: MedialAxis) -> list[list[RationalBSpline]]:
    """The boundary of a disc, whose axis is a point."""
    disc = axis.skeleton.disc[axis.runs.node_disc[0]]
    edge = Part([], _arc_about(disc, disc[:2] + np.array([disc[2], 0.0]), 2.0 * math.pi), None)
    return [closed([edge])]


def _arc_about(disc: Floats, begin: Floats, turn: float) -> RationalBSpline:
    """An arc of a disc from a point of it on, anticlockwise."""
    spans = max(math.ceil(turn / QUARTER), 1)
    x, y = begin - disc[:2]
    angle = math.atan2(y, x) + turn * np.arange(spans + 1) / spans
    ends = disc[:2] + disc[2] * np.column_stack((np.cos(angle), np.sin(angle)))
    knots, control, weights = arc_spline(ends, np.full(spans, turn / spans))
    return RationalBSpline(2, knots, control, weights)


class _Rebuilder:
    """Steps 1 and 3 for one axis, normalised."""

    def __init__(self, axis: MedialAxis, tolerance: float) -> None:
        self.axis = axis
        self.envelope = Envelope(axis, tolerance)

    def loops(self) -> list[list[RationalBSpline]]:
        """All loops of the boundary."""
        return [self._draw(chain) for chain in Walk(self.axis, self.envelope).chains()]

    def _gap(self, a: Side, b: Side) -> _Gap:
        """Step 3: what lies between the end of side a and the start of side b, at one disc."""
        ends = self.envelope.ends
        i, j = (1 if a.sense > 0 else 0), (0 if b.sense > 0 else 1)
        arrive, leave = a.sense * ends.forward[a.item, i], b.sense * ends.forward[b.item, j]
        back = -arrive
        between = math.atan2(back[0] * leave[1] - back[1] * leave[0], back @ leave) % (2.0 * math.pi)
        if a.item == b.item and i == j:
            between = 2.0 * math.pi
        angle_a, angle_b = float(ends.angle[a.item, i]), float(ends.angle[b.item, j])
        # from the direction of travel clockwise to e, on either side
        own_a = math.pi - angle_a if a.sense > 0 else angle_a
        own_b = angle_b if b.sense > 0 else math.pi - angle_b
        return _Gap(between - own_a - own_b, 0.5 * (ends.disc[a.item, i] + ends.disc[b.item, j]))

    def _controls(self, side: Side) -> list[Floats]:
        """Beziers of one side, in the direction of the boundary; none where all of it runs back."""
        fits = self.envelope.right if side.sense > 0 else self.envelope.left
        rows = fits.of(side.item)
        pieces = forward([c.copy() for c in fits.control[rows]], fits.ends[rows],
                         lambda v: self.envelope.headings(side.item, v, float(side.sense)))
        return pieces if side.sense > 0 else [piece[::-1].copy() for piece in reversed(pieces)]

    def _vertex(self, side: Side) -> Vertex | None:
        """The point that all discs of an item pass through on one side, if there is one.

        Errors of e move p across such a point to first order, so it is found from centres and radii: |c - V| = r.
        """
        fits = self.envelope.right if side.sense > 0 else self.envelope.left
        control = fits.control[fits.of(side.item)].reshape(-1, 2)
        ends = self.envelope.ends
        heading = np.arctan2(ends.forward[side.item, :, 1], ends.forward[side.item, :, 0]) - side.sense * ends.angle[side.item]
        turn = abs(math.remainder(float(heading[1] - heading[0]), 2.0 * math.pi))
        if np.abs(control - control[0]).max() > NEARLY_POINT * turn * float(ends.disc[side.item, :, 2].max()):
            return None
        discs = self.envelope.discs(side.item)
        return self._met(control.mean(axis=0), discs)

    def _met(self, start: Floats, discs: Floats) -> Vertex | None:
        """The point near `start` that all of some discs pass through, if there is one but for errors."""
        place = common_point(start, discs)
        misses = np.abs(np.hypot(*(place - discs[:, :2]).T) - discs[:, 2])
        return Vertex(place, discs) if misses.max() <= POINT * float(self.axis.curves.max_error.max()) else None

    def _vertices(self, chain: list[Side], controls: list[list[Floats]], gaps: list[_Gap]) -> list[Vertex | None]:
        """For each side the vertex that it is, if it is one. In a row they are if one point is: tiny sides of a curve are not."""
        found: list[Vertex | None] = []
        row: Vertex | None = None
        for side, control, gap in zip(chain, controls, gaps, strict=True):
            own = self._vertex(side) if control else self._middle(side)
            if own is not None and len(own.discs):
                row = own if row is None else self._met(row.place, np.concatenate((row.discs, own.discs)))
                own = own if row is not None else None
            elif own is None:
                row = None
            found.append(own)
            if gap.turn * gap.disc[2] > SNAP:
                row = None
        return found

    def _heading(self, side: Side) -> Floats:
        """Where the boundary goes at the start of a side."""
        start = np.array([0.0 if side.sense > 0 else 1.0])
        heading: Floats = side.sense * self.envelope.headings(side.item, start, float(side.sense))[0]
        return heading

    def _middle(self, side: Side) -> Vertex:
        """Between the ends of a side that runs back as a whole: its neighbours meet there."""
        fits = self.envelope.right if side.sense > 0 else self.envelope.left
        control = fits.control[fits.of(side.item)]
        return Vertex(0.5 * (control[0, 0] + control[-1, -1]), np.empty((0, 3)))

    def _from_widest_gap(self, chain: list[Side]) -> tuple[list[Side], list[_Gap]]:
        """The chain from behind its widest gap on, where nothing overlaps, with the gap after each side."""
        gaps = [self._gap(side, after) for side, after in zip(chain, chain[1:] + chain[:1], strict=True)]
        first = 1 + max(range(len(chain)), key=lambda i: gaps[i].turn * gaps[i].disc[2])
        return chain[first:] + chain[:first], gaps[first:] + gaps[:first]

    def _draw(self, chain: list[Side]) -> list[RationalBSpline]:
        """One loop of curves, ends joined."""
        chain, gaps = self._from_widest_gap(chain)
        edges: list[Part] = []
        smooth = False
        controls = [self._controls(side) for side in chain]
        vertices = self._vertices(chain, controls, gaps)
        for i, (side, vertex, gap) in enumerate(zip(chain, vertices, gaps, strict=True)):
            if vertex is not None:
                edges.append(Part([], None, vertex))
            elif smooth:
                follow(edges[-1].pieces, controls[i], self._heading(side))
            else:
                edges.append(Part(controls[i], None, None))
            # sides that overlap on their disc do so by errors, along themselves: the second one goes on where it starts
            smooth = vertex is None and gap.turn * gap.disc[2] <= SNAP < gap.disc[2]
            smooth = smooth and vertices[(i + 1) % len(chain)] is None
            if gap.turn * gap.disc[2] > SNAP:
                p = vertex.place if vertex is not None else edges[-1].pieces[-1][-1]
                edges.append(Part([], _arc_about(gap.disc, p, gap.turn), None))
        if all(edge.vertex is not None for edge in edges):
            raise NotCertified("reconstruct: a loop is shorter than the errors of the axis; ask for a finer tolerance")
        return closed(edges)
