"""Open CASCADE's BRepMAT2d: `python -m benchmarks.peers.run_open_cascade CURVES BUDGET RUNS [POLYLINES]`.

Timed is exploring a ready face and computing its bisecting locus. It may crash: the caller sees the signal.
"""

from __future__ import annotations

import json
import struct
import sys
from pathlib import Path
from typing import Any

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepMAT2d import BRepMAT2d_BisectingLocus, BRepMAT2d_Explorer
from OCP.collections import Array1_double, Array1_gp_Pnt, Array1_int
from OCP.Geom import Geom_BSplineCurve, Geom_Circle
from OCP.gp import gp_Ax2, gp_Dir, gp_Pln, gp_Pnt, gp_Pnt2d, gp_Vec2d
from OCP.MAT import MAT_Side

from benchmarks.timing import timed

SAMPLES = 513  # points on a bisector
LIMIT = 1e4  # parameters of a bisector beyond it are no place on it
MEET = 1e-7  # of the size: ends nearer than this are one point
SMOOTH = 1e-6  # radians


def edge(entry: dict[str, Any]) -> Any:
    """A topological edge from a line, an arc or a B-spline."""
    if entry["kind"] == "spline":
        return BRepBuilderAPI_MakeEdge(spline(entry)).Edge()
    a, b = (gp_Pnt(x, y, 0.0) for x, y in entry["ends"])
    if entry["kind"] == "line":
        return BRepBuilderAPI_MakeEdge(a, b).Edge()
    up = 1.0 if entry["sweep"] > 0.0 else -1.0
    axes = gp_Ax2(gp_Pnt(*entry["center"], 0.0), gp_Dir(0.0, 0.0, up))
    circle = Geom_Circle(axes, entry["radius"])
    if entry["ends"][0] == entry["ends"][1]:
        return BRepBuilderAPI_MakeEdge(circle).Edge()
    return BRepBuilderAPI_MakeEdge(circle, a, b).Edge()


def spline(entry: dict[str, Any]) -> Any:
    points, weights, degree = entry["control_points"], entry.get("weights"), entry["degree"]
    distinct = sorted(set(entry["knots"]))
    poles, knots, counts = Array1_gp_Pnt(1, len(points)), Array1_double(1, len(distinct)), Array1_int(1, len(distinct))
    for i, (x, y) in enumerate(points):
        poles.SetValue(i + 1, gp_Pnt(x, y, 0.0))
    for i, knot in enumerate(distinct):
        knots.SetValue(i + 1, knot)
        counts.SetValue(i + 1, entry["knots"].count(knot))
    if weights is None:
        return Geom_BSplineCurve(poles, knots, counts, degree)
    shares = Array1_double(1, len(points))
    for i, weight in enumerate(weights):
        shares.SetValue(i + 1, weight)
    return Geom_BSplineCurve(poles, shares, knots, counts, degree)


def face(loops: list[list[dict[str, Any]]]) -> Any:
    """A planar face, the outer loop first."""
    wires = []
    for loop in loops:
        wire = BRepBuilderAPI_MakeWire()
        for entry in loop:
            wire.Add(edge(entry))
        wires.append(wire.Wire())
    made = BRepBuilderAPI_MakeFace(gp_Pln(), wires[0])
    for wire in wires[1:]:
        made.Add(wire)
    return made.Face()


def compute(plane: Any) -> Any:
    locus = BRepMAT2d_BisectingLocus()
    locus.Compute(BRepMAT2d_Explorer(plane), 1, MAT_Side.MAT_Left)
    if not locus.IsDone():
        raise RuntimeError("not done")
    return locus


def ends(geometry: Any) -> list[tuple[Any, Any]]:
    """(point, direction) of a curve's ends; a point has no direction."""
    if hasattr(geometry, "Pnt2d"):
        return [(geometry.Pnt2d(), None)]
    found = []
    for u in (geometry.FirstParameter(), geometry.LastParameter()):
        point, direction = gp_Pnt2d(), gp_Vec2d()
        geometry.D1(u, point, direction)
        found.append((point, direction))
    return found


def is_spoke(one: Any, other: Any, size: float) -> bool:
    """Whether two neighbours meet smoothly, or one is the end of the other: their bisector is no part of the axis."""
    for p, along in ends(one):
        for q, across in ends(other):
            if p.Distance(q) > MEET * size:
                continue
            if along is None or across is None or abs(along.Normalized().Crossed(across.Normalized())) < SMOOTH:
                return True
    return False


def kept(locus: Any, size: float) -> list[list[tuple[float, float]]]:
    """Points along every bisector that is no spoke."""
    graph = locus.Graph()
    lines = []
    for i in range(1, graph.NumberOfArcs() + 1):
        arc = graph.Arc(i)
        if is_spoke(*(locus.GeomElt(e) for e in (arc.FirstElement(), arc.SecondElement())), size):
            continue
        curve = locus.GeomBis(arc, False).Value()
        a, b = (max(-LIMIT, min(LIMIT, u)) for u in (curve.FirstParameter(), curve.LastParameter()))
        points = [curve.Value(a + (b - a) * k / (SAMPLES - 1)) for k in range(SAMPLES)]
        lines.append([(p.X(), p.Y()) for p in points])
    return lines


def main() -> None:
    path, budget, most = Path(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
    given = json.loads(path.read_text(encoding="utf-8"))
    plane = face(given["loops"])
    measured = timed(lambda: compute(plane), budget, most)
    lines = kept(measured.result, given["size"])
    if len(sys.argv) > 4:
        flat = b"".join(struct.pack(f"{1 + 2 * len(p)}d", len(p), *(v for xy in p for v in xy)) for p in lines)
        Path(sys.argv[4]).write_bytes(flat)
    edges = sum(map(len, given["loops"]))
    print(json.dumps({"ms": measured.ms, "runs": measured.runs, "kept": len(lines), "given": edges}))


if __name__ == "__main__":
    main()
