"""pyvoronoi on the chords that boost_voronoi.cpp reads: `python -m benchmarks.peers.run_pyvoronoi CHORDS BUDGET RUNS`.

Timed is what a user of the package has to do: add the chords, construct, read edges and cells, keep what is inside and no
spoke. Polylines are not written: the diagram is the one of Boost.Polygon.
"""

from __future__ import annotations

import json
import struct
import sys
from pathlib import Path
from typing import Any

import pyvoronoi

from benchmarks.timing import timed

POINT_AT_START = 1  # source categories of cells
POINT_AT_END = 2


def read(path: Path) -> tuple[list[Any], list[bool], list[bool], list[int]]:
    """Chords, corner and reflex at the start of each, and the chord after each round its loop."""
    data = path.read_bytes()
    (loops,), at = struct.unpack_from("q", data), 8
    chords: list[Any] = []
    corner: list[bool] = []
    reflex: list[bool] = []
    after: list[int] = []
    for _ in range(loops):
        (count,) = struct.unpack_from("q", data, at)
        flat = struct.unpack_from(f"{3 * count}i", data, at + 8)
        at += 8 + 12 * count
        first = len(chords)
        rows = [flat[3 * i : 3 * i + 3] for i in range(count)]
        for i, (x, y, c) in enumerate(rows):
            (ax, ay, _), (bx, by, _) = rows[i - 1], rows[(i + 1) % count]
            chords.append([[x, y], [bx, by]])
            corner.append(bool(c))
            reflex.append((x - ax) * (by - y) - (y - ay) * (bx - x) < 0)
            after.append(first + (i + 1) % count)
    return chords, corner, reflex, after


def solve(chords: list[Any], corner: list[bool], reflex: list[bool], after: list[int]) -> int:
    """The number of edges kept."""
    diagram = pyvoronoi.Pyvoronoi(1)
    for chord in chords:
        diagram.AddSegment(chord)
    diagram.Construct()
    edges, cells, vertices = diagram.GetEdges(), diagram.GetCells(), diagram.GetVertices()
    points = diagram.CountPoints()
    kept = 0
    for number, edge in enumerate(edges):
        if edge.twin < number or not edge.is_primary or edge.start < 0 or edge.end < 0:
            continue
        one, other = cells[edge.cell], cells[edges[edge.twin].cell]
        i, j = one.site - points, other.site - points
        if one.contains_point or other.contains_point:
            at, owner = (i, one) if one.contains_point else (j, other)
            kept += reflex[at if owner.source_category == POINT_AT_START else after[at]]
            continue
        (x0, y0), (x1, y1) = chords[i]
        v, w = vertices[edge.start], vertices[edge.end]
        left = (x1 - x0) * (v.Y + w.Y - 2 * y0) - (y1 - y0) * (v.X + w.X - 2 * x0)
        spoke = (after[i] == j and not corner[j]) or (after[j] == i and not corner[i])
        kept += left > 0 and not spoke
    return kept


def main() -> None:
    path, budget, most = Path(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
    given = read(path)
    measured = timed(lambda: solve(*given), budget, most)
    print(json.dumps({"ms": measured.ms, "runs": measured.runs, "kept": measured.result, "given": len(given[0])}))


if __name__ == "__main__":
    main()
