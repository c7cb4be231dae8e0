"""Domains from a DXF drawing, read by ezdxf (extra ``dxf``).

Lines, arcs, circles, ellipses, polylines with bulges, splines, and blocks of them; curves stay what they are. Entities that
are open are joined head to tail; what is inside is told by the number of loops around, as CAM programs do. The drawing's unit is
kept.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterator
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.errors import UnreadableInput, UnsupportedOption
from mat_core.outlines.chains import Chain, closed_loops, oriented
from mat_core.outlines.nesting import Outlines, nested
from mat_core.outlines.pen import Affine, bezier, quarters

GAP = 1e-6
"""Of the size of the drawing: ends nearer than this are one. Drawings are often written with six or more digits."""

WIDEST_GAP = 0.01
ROUND = ("ARC", "CIRCLE", "ELLIPSE")
COMPOSED = ("INSERT", "LWPOLYLINE", "POLYLINE")
DEEPEST = 32  # blocks in blocks that are followed
MOST_BLOCKS = 100_000  # references to blocks that are followed at all: blocks of blocks can stand for billions of curves
FLAT = 1e-9  # of a curve's size: it is in one plane with the drawing
DEFAULT_LAYER = "0"  # in a block: the layer of the reference to it


def from_dxf(file: str | PathLike[str], *, layers: Collection[str] | None = None, gap: float = GAP) -> Outlines:
    """The domains that the model space of a drawing bounds.

    Parameters
    ----------
    file : path
        A DXF file, in text or binary.
    layers : collection of str, optional
        Layers to read; default: all that are on and not frozen.
    gap : float
        Ends of entities nearer than this, as a fraction of the drawing's size, are joined; the second is moved to the first.

    Returns
    -------
    Outlines
        Domains, by the rule "evenodd". Chains that do not close, ends at which more than two entities meet, texts, dimensions and
        what else bounds nothing are left out.

    Raises
    ------
    UnreadableInput
        It is not a drawing, or its blocks multiply without an end.
    UnsupportedOption
        A layer is not in the drawing, or the gap is not from 0 to 0.01.
    ImportError
        ezdxf is not installed.
    """
    if not 0.0 <= gap <= WIDEST_GAP:
        raise UnsupportedOption("gap", f"{gap} is not a fraction of the drawing's size from 0 to {WIDEST_GAP}")
    drawing = _drawing(file)
    shown = {layer.dxf.name for layer in drawing.layers if not (layer.is_off() or layer.is_frozen())}
    known = {layer.dxf.name for layer in drawing.layers} | {e.dxf.layer for e in drawing.modelspace()}
    if strange := sorted(set(layers or ()) - known):
        raise UnsupportedOption("layers", f"the drawing has no layer {strange[0]!r}; it has {', '.join(sorted(known))}")
    hidden = {layer.dxf.name for layer in drawing.layers} - shown
    read = _Reader(known & set(layers) if layers else known - hidden)
    for entity in drawing.modelspace():
        read.entity(entity, entity.dxf.layer)
    loops, left_out = closed_loops(read.chains, gap)
    outlines = nested(loops, "evenodd")
    others = [f"{count} of type {kind}, {why}" for (kind, why), count in sorted(read.others.items())]
    return Outlines(outlines.domains, left_out + outlines.left_out + others)


def _drawing(file: str | PathLike[str]) -> Any:
    """The document of ezdxf."""
    try:
        from ezdxf.filemanagement import readfile
    except ImportError as error:
        raise ImportError("DXF needs the package ezdxf: pip install 'mat-core[dxf]'") from error
    try:
        return readfile(file)
    except OSError as error:
        if error.errno is not None:  # there is no such file; ezdxf says without a number that it is no drawing
            raise
        raise UnreadableInput(f"{file} is not a DXF drawing") from error
    except Exception:  # ezdxf means errors of its own, but others escape it on files that are cut off or no drawings
        return _recovered(file)


def _recovered(file: str | PathLike[str]) -> Any:
    """The document of a file with faults, as far as ezdxf can mend it."""
    from ezdxf import recover

    try:
        return recover.readfile(Path(file))[0]
    except Exception as error:  # as above
        raise UnreadableInput(f"{file} is not a DXF drawing that can be read: {error!r}") from error


class _Reader:
    """Collects chains of edges, and counts what gives none."""

    def __init__(self, layers: Collection[str]) -> None:
        self.chains: list[Chain] = []
        self.others: Counter[tuple[str, str]] = Counter()
        self._layers = layers
        self._blocks = 0

    def entity(self, entity: Any, layer: str) -> None:
        """An entity of the model space."""
        kind = entity.dxftype()
        if layer not in self._layers and kind != "INSERT":
            self.others[kind, "on layers that are not read"] += 1
        elif kind == "INSERT":
            self._block(entity, layer, 1)
        else:
            self._read(entity)

    def _block(self, insert: Any, layer: str, depth: int) -> None:
        """What a reference to a block draws."""
        if depth > DEEPEST:
            self.others["INSERT", "blocks within themselves"] += 1
            return
        self._blocks += 1
        if self._blocks > MOST_BLOCKS:
            raise UnreadableInput(f"more than {MOST_BLOCKS} references to blocks are drawn")
        for entity in insert.virtual_entities():
            inner = layer if entity.dxf.layer == DEFAULT_LAYER else entity.dxf.layer
            if entity.dxftype() == "INSERT":
                self._block(entity, inner, depth + 1)
            else:
                self.entity(entity, inner)

    def _read(self, entity: Any) -> None:
        """The chain of an entity that is no block."""
        kind = entity.dxftype()
        parts = list(entity.virtual_entities()) if kind in COMPOSED else [entity]
        chains: list[Chain] = []
        for part in parts:
            edges = _edges(part)
            if edges is None:
                self.others[part.dxftype(), "which bounds nothing here"] += 1
            elif not edges:
                self.others[part.dxftype(), "not in the plane of the drawing"] += 1
            else:
                chains.append(edges)
        if chains:
            self.chains.append(oriented(chains))  # arcs of a polyline come counter-clockwise, whichever way it runs


def _edges(entity: Any) -> Chain | None:
    """The edges of a curve; none where it leaves the plane, None where it is no curve."""
    kind = entity.dxftype()
    if kind == "LINE":
        return [bezier([(p.x, p.y) for p in (entity.dxf.start, entity.dxf.end)])]
    if kind in ROUND:
        return list(_arcs(entity))
    return _spline(entity) if kind == "SPLINE" else None


def _arcs(entity: Any) -> Iterator[dict[str, Any]]:
    """The quarters of an arc, circle or ellipse; none where it is turned out of the plane."""
    from ezdxf.entities.ellipse import Ellipse

    tool = (entity if entity.dxftype() == "ELLIPSE" else Ellipse.from_arc(entity)).construction_tool()
    major, minor, center = tool.major_axis, tool.minor_axis, tool.center
    if abs(major.z) + abs(minor.z) > FLAT * major.magnitude:
        return
    ellipse = Affine(major.x, major.y, minor.x, minor.y, center.x, center.y)
    turn = (tool.end_param - tool.start_param) % math.tau or math.tau
    here = ellipse((math.cos(tool.start_param), math.sin(tool.start_param)))
    for points, weights in quarters(ellipse, tool.start_param, turn):
        yield bezier([here, *points], weights)
        here = points[-1]


def _spline(entity: Any) -> Chain:
    """A spline, its ends clamped."""
    if entity.control_point_count() and len(entity.knots):
        points, weights, knots, p = entity.control_points, entity.weights, entity.knots, entity.dxf.degree
    else:  # through points; or with uniform knots, which are not written
        tool = entity.construction_tool()
        points, weights, knots, p = tool.control_points, tool.weights(), tool.knots(), tool.degree
    places = np.array([tuple(point) for point in points], dtype=float)
    if np.ptp(places[:, 2]) > FLAT * np.ptp(places, axis=0).max():
        return []
    w = np.array(weights, dtype=float) if len(weights) else np.ones(len(places))
    h = np.column_stack([places[:, :2] * w[:, None], w])
    knots, h = clamped(int(p), np.array(knots, dtype=float), h)
    edge = {"degree": int(p), "control_points": (h[:, :2] / h[:, 2:]).tolist(), "knots": knots.tolist()}
    return [edge if not len(weights) else {**edge, "weights": h[:, 2].tolist()}]


def clamped(p: int, knots: NDArray[np.float64], h: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The same curve with its first and last knot p + 1 times, as periodic splines do not have them.

    Parameters
    ----------
    p : int
        Degree.
    knots : (n + p + 1,) ndarray
    h : (n, 3) ndarray
        Homogeneous control points.

    Returns
    -------
    (knots, h)
        Fewer or as many of both.
    """
    knots, h = _clamped_start(p, knots, h)
    knots, h = _clamped_start(p, -knots[::-1], h[::-1])
    return -knots[::-1] + 0.0, h[::-1]  # no negative zero


def _clamped_start(p: int, knots: NDArray[np.float64], h: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Insert the first knot of the curve's range until it is there p times (Boehm), and drop what is before it.

    A new control point is h'[i] = (1 - a) h[i - 1] + a h[i] with a = (u - knots[i]) / (knots[i + p] - knots[i]), for
    i in k - p + 1 .. k, where u lies in the span that begins with knot k.
    """
    u = knots[p]
    while np.count_nonzero(knots == u) < p:
        k = int(np.searchsorted(knots, u, side="right")) - 1
        i = np.arange(k - p + 1, k + 1 - np.count_nonzero(knots[: k + 1] == u))
        a = ((u - knots[i]) / (knots[i + p] - knots[i]))[:, None]
        h = np.concatenate([h[: i[0]], (1.0 - a) * h[i - 1] + a * h[i], h[i[-1] :]])
        knots = np.insert(knots, k + 1, u)
    last = int(np.searchsorted(knots, u, side="right")) - 1
    return np.concatenate([[u], knots[last - p + 1 :]]), h[last - p :]


