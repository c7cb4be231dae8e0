"""The way round an axis, along one side of each segment after the other: the order of a rebuilt boundary.

Round a node the right side of an arriving segment goes on as the right side of the next one anticlockwise; at a leaf, as the
segment's own other side.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.rebuilding.envelope import Envelope
from mat_core.axis import MedialAxis
from mat_core.errors import NotCertified

Floats = NDArray[np.float64]


class Side(NamedTuple):
    """One side of one item, in the direction of the boundary: +1 the right side along t, -1 the left side against it."""

    item: int
    sense: int


class Walk:
    """The way round the items of an envelope."""

    def __init__(self, axis: MedialAxis, envelope: Envelope) -> None:
        self.axis = axis
        self.envelope = envelope
        owner = axis.curves.part_segment[envelope.items.piece]
        self.first = np.searchsorted(owner, np.arange(len(axis.segments) + 1)).tolist()

    def chains(self) -> Iterator[list[Side]]:
        """Sides in the order of the boundary, one list a loop."""
        following = self._turn_round()
        waiting = dict.fromkeys(following)
        while waiting:
            start = half = next(iter(waiting))
            chain: list[Side] = []
            while True:
                del waiting[half]
                segment, sense = half
                items = range(self.first[segment], self.first[segment + 1])
                chain += [Side(i, sense) for i in (items if sense > 0 else reversed(items))]
                half = following[half]
                if half == start:
                    break
            if not chain:
                raise NotCertified("reconstruct: the axis round a hole is shorter than its errors; ask for a finer tolerance")
            yield chain

    def _turn_round(self) -> dict[tuple[int, int], tuple[int, int]]:
        """For each side (segment, sense) the next one."""
        runs = self.axis.runs
        at_node: dict[int, list[tuple[float, tuple[int, int]]]] = {}
        following: dict[tuple[int, int], tuple[int, int]] = {}
        for g, (a, b) in enumerate(zip(runs.start_node.tolist(), runs.end_node.tolist(), strict=True)):
            if a < 0:
                following[g, 1], following[g, -1] = (g, 1), (g, -1)
                continue
            for node, d, sense in ((a, self._away(g, 0), 1), (b, self._away(g, 1), -1)):
                at_node.setdefault(node, []).append((math.atan2(d[1], d[0]), (g, sense)))
        for leaving in at_node.values():
            leaving.sort()
            for (_, (segment, sense)), (_, after) in zip(leaving, leaving[1:] + leaving[:1], strict=True):
                following[segment, -sense] = after
        return following

    def _away(self, segment: int, end: int) -> Floats:
        """Where a segment goes from its start (0) or its end (1)."""
        items = range(self.first[segment], self.first[segment + 1])
        if items:
            forward = self.envelope.ends.forward[items[-end], end]
        else:
            # one that is shorter than its errors has no sides; it still parts those of the others
            forward = self.axis.evaluate(np.array([segment]), np.array([float(end)]))[0, 3:5]
        away: Floats = -forward if end else forward
        return away
