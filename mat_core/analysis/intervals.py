"""Sets of intervals of segments: segment (n,) and t (n, 2), in order, none meeting the next on its segment."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Intervals(NamedTuple):
    """Stretches of segments, in order of segment and t: segment (n,) and t (n, 2), begin and end."""

    segment: Ints
    t: Floats


def joined(segment: Ints, t: Floats) -> Intervals:
    """Intervals in order, (n, 2), with those that share an end made one."""
    meets = np.zeros(len(t), dtype=bool)
    meets[1:] = (segment[1:] == segment[:-1]) & (t[1:, 0] == t[:-1, 1])
    first = np.nonzero(~meets)[0]
    last = np.append(first[1:], len(t)) - 1 if len(t) else first
    return Intervals(segment[first], np.column_stack((t[first, 0], t[last, 1])))


def intersection(a: Intervals, b: Intervals) -> Intervals:
    """What both sets cover."""
    segment = np.concatenate((a.segment, a.segment, b.segment, b.segment))
    t = np.concatenate((a.t[:, 0], a.t[:, 1], b.t[:, 0], b.t[:, 1]))
    m, n = len(a.segment), len(b.segment)
    step = np.concatenate((np.ones(m), -np.ones(m), np.ones(n), -np.ones(n)))
    order = np.lexsort((t, segment))
    depth = np.cumsum(step[order])
    segment, t = segment[order], t[order]
    # between two events both cover where two are open; events of one place have no room between them
    inside = np.nonzero((depth[:-1] == 2.0) & (t[1:] > t[:-1]))[0]
    return joined(segment[inside], np.column_stack((t[inside], t[inside + 1])))


def containing(a: Intervals, segment: Ints, t: Floats) -> Ints:
    """Index (k,) of the interval each place lies in, ends included; -1 for none."""
    n = len(a.segment)
    owner = np.concatenate((a.segment, segment))
    order = np.lexsort((np.concatenate((np.zeros(n), np.ones(len(t)))), np.concatenate((a.t[:, 0], t)), owner))
    before = np.empty(n + len(t), dtype=np.int64)
    before[order] = np.cumsum(order < n) - 1
    index = before[n:]
    if not n:
        return np.full(len(t), -1)
    inside = (index >= 0) & (a.segment[index] == segment) & (t <= a.t[index, 1])
    return np.where(inside, index, -1)
