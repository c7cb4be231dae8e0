"""How far a peer's axis is from the true one, both ways.

The true axis is ours at 1e-10, whose own distance from closed forms is stated beside it where a shape has one. Stray is the
largest distance of a peer's point from the true axis (false branches, wrong places), missed that of a true point from the
peer's lines (what was left out). Both in units of the domain's size.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from mat_core import MedialAxis
from mat_core.analysis.nearest import nearest

Floats = NDArray[np.float64]

ON_SEGMENT = 33  # true points sampled on each segment
MOST_POINTS = 20_000  # of a peer, spread evenly over what it gives


class Distances(NamedTuple):
    """Largest distances in units of the size; None where there is nothing to measure."""

    stray: float | None
    missed: float | None


def sampled(axis: MedialAxis, count: int = ON_SEGMENT) -> Floats:
    """(n, 2) points of an axis' curves; the node of a disc where there is no curve."""
    segments = len(axis.curves.degree)
    if not segments:
        return axis.node_discs[:, :2]
    return axis.evaluate(np.repeat(np.arange(segments), count), np.tile(np.linspace(0, 1, count), segments))[:, :2]


def distances(truth: MedialAxis, lines: list[Floats]) -> Distances:
    """Of a peer's polylines (n, 2) each, in the caller's coordinates; polylines of one point are points."""
    size = truth.domain.size
    if not lines:
        return Distances(None, None)
    points = np.concatenate(lines)
    points = points[:: max(1, len(points) // MOST_POINTS)]
    stray = float(nearest(truth, points).distance.max())
    drawn = [shapely.LineString(p) if len(p) > 1 else shapely.Point(p[0]) for p in lines]
    _, gaps = shapely.STRtree(drawn).query_nearest(shapely.points(sampled(truth)), all_matches=False, return_distance=True)
    return Distances(stray / size, float(gaps.max()) / size)


def own(truth: MedialAxis, axis: MedialAxis) -> Distances:
    """Of an axis of ours at its tolerance, without chords in between."""
    size = truth.domain.size
    stray = nearest(truth, sampled(axis, ON_SEGMENT - 1)).distance.max()
    missed = nearest(axis, sampled(truth)).distance.max()
    return Distances(float(stray) / size, float(missed) / size)


def from_closed_form(axis: MedialAxis, shaped: dict[str, Any]) -> float | None:
    """Largest distance of exactly known centres from an axis, in units of the size."""
    known = [disc[:2] for chain in shaped.get("truth", {}).get("mat", []) for disc in chain]
    return float(nearest(axis, known).distance.max()) / axis.domain.size if known else None


def read_polylines(path: Path) -> list[Floats]:
    """What the programs of peers write: float64 count, then as many x, y, again and again."""
    flat = np.fromfile(path)
    lines, at = [], 0
    while at < len(flat):
        count = int(flat[at])
        lines.append(flat[at + 1 : at + 1 + 2 * count].reshape(-1, 2))
        at += 1 + 2 * count
    return lines
