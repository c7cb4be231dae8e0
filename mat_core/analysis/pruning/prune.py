"""Cutting branches off an axis that say little about the shape, from their tips inwards.

Only what hangs free is ever cut, so that components and cycles stay as they are. Four rules, each on what the one before left:

scale         the scale axis (J. Giesen, B. Miklos, M. Pauly, C. Wormser, "The scale axis transform", 2009): all discs grown by
              the factor s; those that are not maximal in the union go. From a tip inwards a disc goes while another grown disc
              has all of its own: that of its inner neighbours, dr/ds > 1/s, of the node that the segment leads to, or of those
              about that node, up the graph, that reach farthest over the segment: s r_k - |c - c_k| is largest.
              Every disc that goes is inside a grown disc that stays. The union's own new discs, across gaps that growing has
              closed, are not discs of the domain and are not drawn: so topology stays.
angle         from a tip inwards to the first disc whose two footpoints stand at least `angle` apart (the object angle; 180
              degrees less the angle of a corner), small where noise on the boundary makes branches (D. Attali and A. Montanvert,
              1996); or from where the radius falls inwards: a round end is no noise, however narrow the way to it.
radius_ratio  whole branches whose reach beyond their root's disc is small: (length + radius at the tip) / radius at the root,
              which is 1 for a branch that adds nothing and sqrt 2 into a square corner; the least first.
length        whole branches shorter than a length, the shortest first. Equal ones are cut together.

        tip  o-----.-----o root      A branch runs from a tip to the next node where two more segments end; what was a node of
                        / \\          three is passed once one of its segments is gone, so branches grow together.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.analysis.bernstein import product, sign_changes
from mat_core.analysis.inscribed import inscribed_disc
from mat_core.analysis.intervals import Intervals, intersection, joined
from mat_core.analysis.options import real
from mat_core.analysis.pruning.peeling import Peeling
from mat_core.analysis.pruning.pruned import PrunedAxis, view
from mat_core.analysis.slopes import slope_intervals, stretches
from mat_core.analysis.spans import Spans, cut_spans
from mat_core.axis import MedialAxis
from mat_core.errors import UnsupportedOption

Floats = NDArray[np.float64]

INSIDE = 7  # discs of each segment that may be best coverers, besides its ends


def prune(
    axis: MedialAxis,
    *,
    angle: float | None = None,
    length: float | None = None,
    radius_ratio: float | None = None,
    scale: float | None = None,
) -> PrunedAxis:
    """Cut leaf branches by one or more rules; topology never changes.

    Parameters
    ----------
    axis : MedialAxis
    angle : float, optional
        Radians, 0 to pi: cut from the tips to the first disc whose footpoints stand this far apart, also within a segment.
    length : float, optional
        Caller's unit, at least 0: cut whole branches that are shorter.
    radius_ratio : float, optional
        At least 1: cut whole branches with (length + radius at the tip) below this times the radius at the root.
    scale : float, optional
        The scale axis' s, at least 1: cut from the tips while discs grown by s are covered, also within a segment.

    Returns
    -------
    PrunedAxis
        A view of the axis. Where the axis is a tree, its largest disc is never cut: of a tree that is pruned away entirely this
        disc stays, as a node of kind ``point``.

    Raises
    ------
    UnsupportedOption
        An option is out of its range, or none is given.
    """
    angle, length, radius_ratio, scale = _checked(angle, length, radius_ratio, scale)
    peeling = Peeling(axis, inscribed_disc(axis) if axis.runs.cycles == 0 else None)
    if scale is not None:
        peeling.shorten("scale", *_uncovered(axis, peeling, scale))
    if angle is not None:
        steepest = math.cos(0.5 * angle)
        peeling.shorten("angle", slope_intervals(axis, steepest, 1), slope_intervals(axis, steepest, -1))
    if radius_ratio is not None:
        peeling.drop("radius_ratio", radius_ratio)
    if length is not None:
        peeling.drop("length", length)
    return view(axis, peeling)


def _checked(
    angle: float | None, length: float | None, radius_ratio: float | None, scale: float | None
) -> list[float | None]:
    """The options as floats; UnsupportedOption for one out of its range."""
    ranges = (("angle", angle, 0.0, math.pi, "between 0 and pi radians"), ("length", length, 0.0, math.inf, "at least 0"),
              ("radius_ratio", radius_ratio, 1.0, math.inf, "at least 1"), ("scale", scale, 1.0, math.inf, "at least 1"))
    found = [None if value is None else real(name, value) for name, value, *_ in ranges]
    for (name, given, low, high, words), value in zip(ranges, found, strict=True):
        if value is not None and not low <= value <= high:
            raise UnsupportedOption(name, f"{given} is not {words}")
    if all(value is None for value in found):
        raise UnsupportedOption("angle", "nothing to prune by; give at least one of angle, length, radius_ratio, scale")
    return found


def _uncovered(axis: MedialAxis, peeling: Peeling, s: float) -> tuple[Intervals, Intervals]:
    """Where segments are kept at scale s, for tips that come from their start and from their end."""
    discs, rivals = _rivals(axis, s)
    spans = cut_spans(axis)
    kept = []
    for ends, nodes, sign in zip(peeling.roots(), (axis.runs.end_node, axis.runs.start_node), (1, -1), strict=True):
        open_ = intersection(slope_intervals(axis, 1.0 / s, sign), _outside(axis, spans, s, ends))
        # what reaches farthest over the start of the way, the middle of it, or its end
        places = [axis.evaluate(np.arange(len(ends)), np.full(len(ends), t))[:, :3] for t in (0.0, 0.5, 1.0)]
        found = np.tile(ends, (len(places), 1, 1))
        for g, node in enumerate(nodes.tolist()):
            if node < 0:
                continue
            own = discs[rivals[node]]
            for coverer, place in zip(found, places, strict=True):
                gain = own[:, 2] - np.hypot(own[:, 0] - place[g, 0], own[:, 1] - place[g, 1]) / s
                coverer[g] = own[int(np.argmax(gain))]
        for coverer in found:
            open_ = intersection(open_, _outside(axis, spans, s, coverer))
        kept.append(open_)
    return kept[0], kept[1]


def _rivals(axis: MedialAxis, s: float) -> tuple[Floats, list[list[int]]]:
    """(discs (K, 3), which of them may cover, grown, what hangs on each node).

    The node itself, its neighbours up the graph with what reaches farthest over them, and discs inside the segments there.
    """
    count, segments = len(axis.node_discs), len(axis.curves.degree)
    inside = axis.evaluate(np.repeat(np.arange(segments), INSIDE), np.tile(np.linspace(0.0, 1.0, INSIDE + 2)[1:-1], segments))
    discs = np.concatenate((axis.node_discs.reshape(-1, 3), inside[:, :3]))
    higher: list[list[int]] = [[] for _ in range(count)]
    beside: list[list[int]] = [[] for _ in range(count)]
    for g, (a, b) in enumerate(zip(axis.runs.start_node.tolist(), axis.runs.end_node.tolist(), strict=True)):
        if a < 0:
            continue
        own = range(count + g * INSIDE, count + (g + 1) * INSIDE)
        beside[a] += own
        if a != b:
            beside[b] += own
            low, high = (a, b) if discs[a, 2] < discs[b, 2] else (b, a)
            higher[low].append(high)
    best = list(range(count))
    rivals: list[list[int]] = [[] for _ in range(count)]
    for node in np.argsort(-discs[:count, 2], kind="stable").tolist():
        own_rivals = [node, *beside[node], *(k for h in higher[node] for k in (h, best[h], *beside[h]))]
        apart = np.hypot(*(discs[own_rivals, :2] - discs[node, :2]).T)
        best[node] = own_rivals[int(np.argmax(discs[own_rivals, 2] - apart / s))]
        rivals[node] = own_rivals
    return discs, rivals


def _outside(axis: MedialAxis, spans: Spans, s: float, coverer: Floats) -> Intervals:
    """Where the grown discs of a segment are not inside that of its coverer (G, 3), x, y, r in the caller's coordinates.

    Covered means r_k - r >= |c - c_k| / s: F = (R - r_k W)^2 - ((X - c_k W)^2 + (Y - ..)^2) / s^2 >= 0 and R <= r_k W.
    """
    disc = coverer * axis.table.scale
    disc[:, :2] -= axis.table.origin * axis.table.scale
    own = spans.rows[:, :, :3] - disc[spans.segment][:, None] * spans.rows[:, :, 3:]
    x, y, r = (own[:, :, k] for k in range(3))
    margin = product(r, r) - (product(x, x) + product(y, y)) / (s * s)
    segment, t = [spans.segment, spans.segment], [spans.t[:, 0], spans.t[:, 1]]
    for rows in (margin, r):
        row, place = sign_changes(rows)
        segment.append(spans.segment[row])
        t.append(spans.t[row, 0] + place * (spans.t[row, 1] - spans.t[row, 0]))
    owner, stretch = stretches(np.concatenate(segment), np.concatenate(t))
    found = axis.evaluate(owner, stretch.mean(axis=1))[:, :3]
    apart = np.hypot(*(found[:, :2] - coverer[owner, :2]).T)
    free = coverer[owner, 2] - found[:, 2] < apart / s
    return joined(owner[free], stretch[free])
