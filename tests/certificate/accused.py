"""Correct axes to be damaged, and the tools that damage them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from mat_core import Domain, medial_axis
from mat_core.certificate import certify
from tests import families
from tests.families import arc, bezier, line, shape

Json = dict[str, Any]


class Accused(NamedTuple):
    """All that a certificate is asked about."""

    domain: Domain | None
    table: Any
    skeleton: Any
    graph: Any
    curves: Any
    tolerance: float

    def judge(self) -> Json:
        """Its certificate."""
        return dict(certify(self.table, self.skeleton, self.graph, self.curves, self.tolerance, domain=self.domain))

    def with_discs(self, **arrays: Any) -> Accused:
        """The same with other arrays in the skeleton."""
        return self._replace(skeleton=self.skeleton._replace(**arrays))

    def with_graph(self, **arrays: Any) -> Accused:
        """The same with other arrays in the graph."""
        return self._replace(graph=self.graph._replace(**arrays))

    def with_curves(self, **arrays: Any) -> Accused:
        """The same with other arrays in the curves."""
        return self._replace(curves=self.curves._replace(**arrays))


def letter() -> Json:
    """Like a small a: quadratics and lines, a stem with corners, and a counter."""
    outer = [
        bezier([(0.1, 1.0), (0.1, 0.0), (0.9, 0.0)]),
        bezier([(0.9, 0.0), (1.2, 0.0), (1.35, 0.25)]),
        line((1.35, 0.25), (1.35, 0.05)),
        line((1.35, 0.05), (1.75, 0.05)),
        line((1.75, 0.05), (1.75, 1.4)),
        bezier([(1.75, 1.4), (1.75, 2.2), (0.9, 2.2)]),
        bezier([(0.9, 2.2), (0.5, 2.2), (0.2, 2.0)]),
        line((0.2, 2.0), (0.2, 1.6)),
        bezier([(0.2, 1.6), (0.5, 1.85), (0.85, 1.85)]),
        bezier([(0.85, 1.85), (1.35, 1.85), (1.35, 1.45)]),
        bezier([(1.35, 1.45), (0.1, 1.6), (0.1, 1.0)]),
    ]
    hole = [
        bezier([(0.5, 0.8), (0.5, 1.2), (1.3, 1.15)]),
        bezier([(1.3, 1.15), (1.4, 0.35), (0.9, 0.35)]),
        bezier([(0.9, 0.35), (0.5, 0.35), (0.5, 0.8)]),
    ]
    return shape("letter", outer, [hole], leaves=6)


def plate() -> Json:
    """A quarter of a ring with a rounded end: arcs in whole contact, concentric walls."""
    outer = [
        arc((0.0, 0.0), 2.0, 0.0, np.pi / 2),
        arc((0.0, 1.5), 0.5, np.pi / 2, np.pi),
        arc((0.0, 1.5), 0.5, np.pi, 3 * np.pi / 2),
        arc((0.0, 0.0), 1.0, np.pi / 2, 0.0),
        line((1.0, 0.0), (2.0, 0.0)),
    ]
    return shape("plate", outer)


SHAPES: dict[str, Callable[[], Json]] = {
    "rectangle": families.rectangle,
    "ell": families.ell,
    "ellipse": families.ellipse,
    "circle": families.circle,
    "annulus": families.annulus,
    "eccentric": lambda: families.annulus(offset=0.3),
    "stadium": families.stadium,
    "plate": plate,
    "letter": letter,
    "blob": lambda: families.smooth(3),
    "blob_with_holes": lambda: families.smooth(5, holes=3),
    "square_round_hole": families.square_round_hole,
    "gear": families.gear,
}


@cache
def accused(name: str, tolerance: float = 1e-6) -> Accused:
    """A correct axis; its arrays are not to be written to."""
    shaped = SHAPES[name]()
    domain = Domain.from_dict({"outer": shaped["outer"], "holes": shaped["holes"]})
    axis = medial_axis(domain, tolerance=tolerance)
    return Accused(domain, axis.table, axis.skeleton, axis.runs, axis.curves, tolerance)


def changed(array: Any, index: Any, value: Any) -> Any:
    """A copy with one entry (or row) replaced."""
    copy = array.copy()
    copy[index] = value
    return copy


def moved(array: Any, index: Any, by: float) -> Any:
    """A copy with one entry moved."""
    return changed(array, index, array[index] + by)


def rows_of(starts: Any, g: int) -> range:
    """Rows of group g."""
    return range(int(starts[g]), int(starts[g + 1]))


def with_runs(a: Accused, order: list[int]) -> Accused:
    """Only these segments, in this order (one may be named twice), with their curves; strips are left as they are."""
    k, c = a.graph, a.curves

    def gather(starts: Any, *tables: Any) -> tuple[Any, ...]:
        rows = [r for g in order for r in rows_of(starts, g)]
        offsets = np.concatenate(([0], np.cumsum([len(rows_of(starts, g)) for g in order]))).astype(np.int64)
        return offsets, *(table[rows] for table in tables)

    run_start, run_strip, run_forward = gather(k.run_start, k.run_strip, k.run_forward)
    knot_start, knots = gather(c.knot_start, c.knots)
    cp_start, cp = gather(c.cp_start, c.cp)
    part_start, part_i, part_f = gather(c.part_start, c.part_i, c.part_f)
    part_i = part_i.copy()
    part_i[:, 0] = np.repeat(np.arange(len(order)), np.diff(part_start))
    graph = k._replace(
        run_start=run_start,
        run_strip=run_strip,
        run_forward=run_forward,
        start_node=k.start_node[order],
        end_node=k.end_node[order],
    )
    curves = c._replace(
        degree=c.degree[order],
        kind=c.kind[order],
        max_error=c.max_error[order],
        knot_start=knot_start,
        knots=knots,
        cp_start=cp_start,
        cp=cp,
        part_start=part_start,
        part_i=part_i,
        part_f=part_f,
    )
    return a._replace(graph=graph, curves=curves)


def without_segment(a: Accused, g: int) -> Accused:
    """As if a branch had never been found: its strips, its segment and its curve are gone."""
    gone = a.graph.run_strip[list(rows_of(a.graph.run_start, g))]
    keep = np.setdiff1d(np.arange(len(a.skeleton.strip_i)), gone)
    number = np.full(len(a.skeleton.strip_i), -1)
    number[keep] = np.arange(len(keep))
    rest = with_runs(a, [h for h in range(len(a.graph.start_node)) if h != g])
    part_i = rest.curves.part_i.copy()
    part_i[:, 1] = number[part_i[:, 1]]
    return (
        rest.with_discs(strip_i=a.skeleton.strip_i[keep], strip_s=a.skeleton.strip_s[keep])
        .with_graph(run_strip=number[rest.graph.run_strip])
        .with_curves(part_i=part_i)
    )


def some_node(a: Accused, kind: int) -> int:
    """The first node of a kind."""
    return int(np.flatnonzero(a.graph.node_kind == kind)[0])


def degree_of_nodes(a: Accused) -> Any:
    """Segments that end at each node."""
    ends = np.concatenate((a.graph.start_node, a.graph.end_node))
    return np.bincount(ends[ends >= 0], minlength=len(a.graph.node_disc))
