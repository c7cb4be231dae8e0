"""Loops from chains of edges that were drawn one by one, in any order and direction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from mat_core.outlines.pen import Edge, Loop

Chain = list[Edge]
"""Edges head to tail, open or closed."""


def closed_loops(chains: Sequence[Chain], gap: float) -> tuple[list[Loop], list[str]]:
    """Join chains at their ends.

    Parameters
    ----------
    chains : sequence of list of dict
    gap : float
        Ends nearer than this, as a fraction of the size of all, are one.

    Returns
    -------
    loops : list of list of dict
        Each closed to the last bit: an end is moved to the one that it meets.
    left_out : list of str
        Ends that meet none or several others, a sentence each.
    """
    points = [p for chain in chains for edge in chain for p in edge["control_points"]]
    reach = gap * float(np.ptp(np.array(points), axis=0).max()) if points else 0.0
    whole = [_joined(chain, reach) for chain in chains]
    loops = [_ring(chain) for chain in whole if chain and _near(chain[-1], chain[0], reach) and not _short(chain, reach)]
    open_ones = [chain for chain in whole if chain and not _near(chain[-1], chain[0], reach)]
    partner, left_out = _partners(open_ones, reach)
    used: set[int] = set()
    for first in range(len(open_ones)):
        if first in used:
            continue
        ring, closes = _walk(first, partner, used)
        if closes:
            loops.append(_ring([edge for i, turned in ring for edge in (_reversed(open_ones[i]) if turned else open_ones[i])]))
    return loops, left_out


def oriented(parts: Sequence[Chain]) -> Chain:
    """The chain of parts that follow each other, but may each have been drawn from its end to its start."""
    chain: Chain = []
    for part in parts:
        if chain:
            here = chain[-1]["control_points"][-1]
            turned = _away(part[-1], -1, here) < _away(part[0], 0, here)
        else:  # the first is to end where the second one is
            ends = [p for after in parts[1:2] for p in (after[0]["control_points"][0], after[-1]["control_points"][-1])]
            turned = any(_away(part[0], 0, p) < min(_away(part[-1], -1, q) for q in ends) for p in ends)
        chain.extend(_reversed(part) if turned else part)
    return chain


def _away(edge: Edge, at: int, point: Any) -> float:
    """Distance of the first (0) or last (-1) control point of an edge from a point."""
    return float(np.hypot(*np.subtract(edge["control_points"][at], point)))


def _walk(first: int, partner: list[int], used: set[int]) -> tuple[list[tuple[int, bool]], bool]:
    """The chains that follow each other from one on, each turned round or not, and whether the last meets the first.

    End 2 i is where chain i begins, 2 i + 1 where it ends; `partner` has for each the end that it meets, or -1.
    """
    ring: list[tuple[int, bool]] = []
    entry = 2 * first
    while entry >= 0 and entry // 2 not in used:
        used.add(entry // 2)
        ring.append((entry // 2, entry % 2 == 1))
        entry = partner[entry ^ 1]
    return ring, entry == 2 * first


def _partners(chains: list[Chain], reach: float) -> tuple[list[int], list[str]]:
    """The end that each end meets, -1 where that is not one other; and sentences on those."""
    ends = [p for chain in chains for p in (chain[0]["control_points"][0], chain[-1]["control_points"][-1])]
    if not ends:
        return [], []
    places = shapely.points(np.array(ends))
    of, other = shapely.STRtree(places).query(places, predicate="dwithin", distance=reach)
    meets: list[list[int]] = [[] for _ in ends]
    for i, j in zip(of.tolist(), other.tolist(), strict=True):
        if i != j:
            meets[i].append(j)
    partner = [found[0] if len(found) == 1 and len(meets[found[0]]) == 1 else -1 for found in meets]
    told: set[int] = set()
    left_out = []
    for i, found in enumerate(meets):
        if partner[i] < 0 and i not in told:
            told.update([i, *found])
            count = f"{len(found) + 1} ends meet" if found else "an end meets no other"
            left_out.append(f"{count} at ({ends[i][0]:.9g}, {ends[i][1]:.9g}): no loop can be told from there")
    return partner, left_out


def _joined(chain: Chain, reach: float) -> Chain:
    """A chain whose edges all begin where the one before ends, those of no length left out."""
    kept: Chain = []
    for edge in chain:
        if _short([edge], reach):
            continue
        kept.append(_moved(edge, kept[-1]["control_points"][-1]) if kept else edge)
    return kept


def _ring(chain: Chain) -> Loop:
    """The chain closed: each edge begins where the one before ends, the first where the last does."""
    starts = [chain[-1], *chain[:-1]]
    return [_moved(edge, before["control_points"][-1]) for edge, before in zip(chain, starts, strict=True)]


def _moved(edge: Edge, start: Any) -> Edge:
    """An edge that begins at a point very near its start; handles of no length stay so."""
    points = edge["control_points"]
    if points[0] == start:
        return edge
    return {**edge, "control_points": [list(start) if p == points[0] else p for p in points]}


def _reversed(chain: Chain) -> Chain:
    """The chain from its end to its start."""
    return [_turned(edge) for edge in reversed(chain)]


def _turned(edge: Edge) -> Edge:
    """An edge the other way round."""
    turned = {**edge, "control_points": edge["control_points"][::-1]}
    if "weights" in edge:
        turned["weights"] = edge["weights"][::-1]
    if "knots" in edge:
        knots = edge["knots"]
        turned["knots"] = [knots[0] + knots[-1] - k for k in reversed(knots)]
    return turned


def _near(last: Edge, first: Edge, reach: float) -> bool:
    """True where one edge ends at the start of another."""
    return _away(last, -1, first["control_points"][0]) <= reach


def _short(chain: Chain, reach: float) -> bool:
    """True where all of a chain lies within the gap."""
    points = np.array([p for edge in chain for p in edge["control_points"]])
    return bool(np.ptp(points, axis=0).max() <= reach)
