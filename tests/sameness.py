"""Are two answers the same axis, whatever their nodes and segments are called and whichever way round they run?

Where an exact tie is broken by rounding, one node becomes several with segments between them, all nearer to each other than the
accuracy. So the nodes of both answers are gathered into places, what lies within a place is left out, and then there must be
as many segments between two places in the one as in the other, of the same kinds and lengths.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tests.assertions import EXACT, Answer, is_exact
from tests.reference import Floats, Ints

Json = dict[str, Any]
Place = tuple[int, int]
GAUSS = np.polynomial.legendre.leggauss(5)  # on each cell, none of which turns by more than some degrees
EACH = 5  # points of each segment looked for on the other axis


@dataclass
class Sameness:
    """What was measured, in units of the domain's size, and everything that was different.

    Parameters
    ----------
    nodes : float
        Largest distance of a node from the nearest one of the other answer, in x, y and radius.
    curves : float
        Largest distance of a point of one axis from the other.
    lengths : float
        Largest difference of the lengths of two segments that are one.
    differences : list of str
    """

    nodes: float = 0.0
    curves: float = 0.0
    lengths: float = 0.0
    differences: list[str] = field(default_factory=list)

    def limit(self, name: str, value: float, limit: float, where: str = "") -> None:
        """Keep the largest value, and complain where it is over the limit."""
        setattr(self, name, max(getattr(self, name), value))
        if not value <= limit:
            self.differences.append(f"{name}: {value:.2e} > {limit:.1e}{where}")

    def require(self, condition: bool, difference: str) -> None:
        """A yes or no matter."""
        if not condition:
            self.differences.append(difference)


def compare(a: Answer, b: Answer, accuracy: float = EXACT, tolerance: float = 1e-6) -> Sameness:
    """Two answers in one frame; fitted curves may be `tolerance` from the axis each, everything else `accuracy`."""
    same = Sameness()
    for one, other in ((a, b), (b, a)):
        _compare_points(same, one, other, accuracy, tolerance)
    leaves = [sum(d == 1 for d in answer.degree.values()) for answer in (a, b)]
    cycles = [answer.graph["cycles"] for answer in (a, b)]
    same.require(leaves[0] == leaves[1], f"leaves: {leaves[0]} and {leaves[1]}")
    same.require(cycles[0] == cycles[1], f"cycles: {cycles[0]} and {cycles[1]}")
    if not same.differences:
        _compare_segments(same, a, b, accuracy, tolerance)
    return same


def assert_same_axis(a: Answer, b: Answer, accuracy: float = EXACT, tolerance: float = 1e-6) -> None:
    """Fail with everything that `compare` found."""
    same = compare(a, b, accuracy, tolerance)
    assert not same.differences, "\n".join(same.differences)


def _compare_points(same: Sameness, one: Answer, other: Answer, accuracy: float, tolerance: float) -> None:
    """Every node of the one is a node of the other, every point of its segments is on the other's."""
    if len(one.node_disc):
        same.require(len(other.node_disc) > 0, "nodes: none")
        gaps = cKDTree(other.node_disc).query(one.node_disc)[0] if len(other.node_disc) else np.array([np.inf])
        same.limit("nodes", float(gaps.max()), accuracy, f" at {one.node_disc[int(gaps.argmax())]}")
    if one.segments:
        same.require(len(other.segments) > 0, "segments: none")
        owner, discs = one.samples(EACH)
        gaps = other.axis.nearest(discs)[0] if other.segments else np.array([np.inf])
        fitted = not all(is_exact(s) for s in [*one.segments, *other.segments])
        limit = accuracy + (2 * tolerance if fitted else 0.0)
        same.limit("curves", float(gaps.max()), limit, f" at {discs[int(gaps.argmax())]}")


def _compare_segments(same: Sameness, a: Answer, b: Answer, accuracy: float, tolerance: float) -> None:
    """The same segments between the same places, of the same kinds and lengths."""
    places = gathered(np.vstack([a.node_disc, b.node_disc]), accuracy)
    ends = [segments_between(a, places[: len(a.nodes)], accuracy), segments_between(b, places[len(a.nodes) :], accuracy)]
    for place in sorted(ends[0].keys() | ends[1].keys()):
        one, other = (sorted(e.get(place, [])) for e in ends)
        if len(one) != len(other):
            same.differences.append(f"segments: {len(one)} and {len(other)} between two nodes at {_where(a, places, place)}")
            continue
        for (length, kinds), (length_too, kinds_too) in zip(one, other, strict=True):
            limit = 4 * accuracy + (4 * tolerance if "freeform" in kinds else 0.0)
            same.limit("lengths", abs(length - length_too), limit, f" at {_where(a, places, place)}")
            same.require(kinds == kinds_too, f"kinds: {kinds} and {kinds_too} at {_where(a, places, place)}")


def _where(a: Answer, places: Ints, place: Place) -> str:
    """The nodes of a place pair, to be read."""
    return str([np.round(a.node_disc[i], 6).tolist() for i in np.nonzero(np.isin(places[: len(a.nodes)], place))[0][:2]])


def gathered(discs: Floats, accuracy: float) -> Ints:
    """The place of every disc: those nearer to each other than the accuracy, over others in between, are one."""
    if not len(discs):
        return np.empty(0, dtype=np.int64)
    pairs = cKDTree(discs).query_pairs(accuracy, output_type="ndarray")
    near = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(discs), len(discs)))
    return np.asarray(connected_components(near, directed=False)[1], dtype=np.int64)


def segments_between(answer: Answer, places: Ints, accuracy: float) -> dict[Place, list[tuple[float, tuple[str, ...]]]]:
    """(length, kinds) of the segments between two places; those without a node are between -1 and -1.

    Segments within a place are left out, and so are kinds that make up no more of a segment than the accuracy.
    """
    found: dict[Place, list[tuple[float, tuple[str, ...]]]] = defaultdict(list)
    for segment, by_kind in zip(answer.segments, lengths_by_kind(answer), strict=True):
        nodes = segment["start_node"], segment["end_node"]
        start, end = sorted(-1 if n is None else int(places[answer.index[n]]) for n in nodes)
        length = sum(by_kind.values())
        if start != end or length > len(places) * accuracy:
            found[start, end].append((length, tuple(sorted(kind for kind in by_kind if by_kind[kind] > accuracy))))
    return found


def lengths_by_kind(answer: Answer) -> list[dict[str, float]]:
    """How long a segment is, in the plane, on pieces of each kind."""
    found: list[dict[str, float]] = [defaultdict(float) for _ in answer.segments]
    if not answer.segments:
        return found
    axis = answer.axis
    cells, length = np.arange(len(axis.owner)), np.zeros(len(axis.owner))
    for node, weight in zip(*GAUSS, strict=True):
        speed = axis.evaluate(cells, np.full(len(cells), 0.5 + 0.5 * node))[1][:, :2]
        length += 0.5 * weight * np.linalg.norm(speed, axis=1)
    for owner, middle, part in zip(axis.owner, 0.5 * (axis.u0 + axis.u1), length, strict=True):
        segment = answer.segments[owner]
        kind = next((p["kind"] for p in segment.get("pieces", []) if middle <= p["t"][1]), segment["kind"])
        found[owner][kind] += float(part)
    return found
