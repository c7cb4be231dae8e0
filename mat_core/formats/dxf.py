"""A domain, its medial axis and what was found from it as a DXF drawing: lines, circular arcs, circles and rational splines.

Nothing is flattened. What is a line or a circular arc to rounding (`mat_core.formats.primitives`) is written as LINE, ARC or
CIRCLE, everything else as the SPLINE that it is, with its clamped knots and its weights. Layers tell what is what:

    boundary    edges of the domain
    axis        segments, the curves of centres
    nodes       one POINT for each node
    offset      curves that were handed in; the caller may name the layer otherwise

An axis by itself is drawn with all three. Who hands curves in wants those: to cut along an offset or a centerline, nothing else
may be in the way but the boundary, which shows where they lie. `own` says otherwise.

The drawing has no unit: its numbers are the caller's. Written by ezdxf (extra ``dxf``) as DXF R2000, the oldest version
with splines, which every program reads; their degree is 9 at most, and some programs end at 10.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from mat_core.errors import UnsupportedOption
from mat_core.formats.primitives import Arc, Line, Primitive, primitives, rounding
from mat_core.model.curve import RationalBSpline

if TYPE_CHECKING:
    from mat_core.axis import MedialAxis

VERSION = "R2000"
UNITLESS = 0  # of $INSUNITS
COLOURS = {"boundary": 7, "axis": 1, "nodes": 3}  # layers, each with its AutoCAD colour index
RESULT_COLOUR = 5
KNOT_TOLERANCE = 1e-15  # of their range: readers take knots nearer than this as one; ezdxf's default would round them
NO_DATE = 2451544.5  # Julian date of 2000-01-01: one axis, one sequence of bytes
NO_GUID = "{00000000-0000-0000-0000-000000000000}"
DATES = ("$TDCREATE", "$TDUCREATE", "$TDUPDATE", "$TDUUPDATE")
GUIDS = ("$VERSIONGUID", "$FINGERPRINTGUID")


Paths = Iterable[Iterable[RationalBSpline]]


def to_dxf(
    axis: MedialAxis,
    paths: Paths | Mapping[str, Paths] | None = None,
    layer: str = "offset",
    own: Iterable[str] | None = None,
) -> str:
    """A drawing of boundary, axis and nodes, or of what was found from them.

    Parameters
    ----------
    axis : MedialAxis
    paths : iterable of iterables of RationalBSpline, or a mapping of layers to such
        Further curves, such as the loops of an offset; written in the order given.
    layer : str
        Their layer, where `paths` names none.
    own : iterable of str, optional
        Layers of the axis that are drawn, any of ``boundary``, ``axis`` and ``nodes``. All of them if left out; with `paths` the
        boundary.

    Returns
    -------
    str
        An ASCII DXF document. The same axis gives the same text.

    Raises
    ------
    ImportError
        ezdxf is not installed.
    UnsupportedOption
        `own` names another layer.
    """
    drawn = set(COLOURS if paths is None else ("boundary",)) if own is None else set(own)
    unknown = sorted(drawn - COLOURS.keys())
    if unknown:
        raise UnsupportedOption("own", f"{', '.join(unknown)} is no layer of an axis; {', '.join(COLOURS)} are")
    drawing = _new_drawing([name for name in COLOURS if name in drawn])
    space = drawing.modelspace()
    tolerance = rounding(axis.domain)
    if "boundary" in drawn:
        arrays = axis.domain.arrays
        for loop in range(len(arrays.loop_start) - 1):
            _draw(space, primitives(arrays.loop(loop), tolerance), "boundary")
    if "axis" in drawn:
        _draw(space, primitives((s.curve for s in axis.segments), tolerance), "axis")
    if "nodes" in drawn:
        for node in axis.nodes:
            space.add_point(node.point, dxfattribs={"layer": "nodes"})
    for name, found in (paths if isinstance(paths, Mapping) else {layer: paths or ()}).items():
        for curves in found:
            if name not in drawing.layers:
                drawing.layers.add(name, color=RESULT_COLOUR)
            _draw(space, primitives(curves, tolerance), name)
    return _text(drawing)


def _new_drawing(layers: Iterable[str]) -> Any:
    """An empty drawing with layers of an axis."""
    try:
        import ezdxf
    except ImportError as error:
        raise ImportError("DXF needs the package ezdxf: pip install 'mat-core[dxf]'") from error
    drawing = ezdxf.new(VERSION, units=UNITLESS)  # type: ignore[attr-defined]  # not named in its __all__
    for name in layers:
        drawing.layers.add(name, color=COLOURS[name])
    return drawing


def _draw(space: Any, shapes: list[Primitive], layer: str) -> None:
    """Add one entity for each shape."""
    attributes = {"layer": layer}
    for shape in shapes:
        if isinstance(shape, Line):
            space.add_line(shape.start, shape.end, dxfattribs=attributes)
        elif isinstance(shape, Arc):
            _draw_arc(space, shape, attributes)
        else:
            _draw_spline(space, shape, attributes)


def _draw_arc(space: Any, arc: Arc, attributes: dict[str, str]) -> None:
    """ARC runs counter-clockwise from its first angle to its second, in degrees."""
    if arc.closed:
        space.add_circle(arc.center, arc.radius, dxfattribs=attributes)
        return
    first, last = sorted((arc.start, arc.start + arc.sweep))
    space.add_arc(arc.center, arc.radius, math.degrees(first), math.degrees(last), dxfattribs=attributes)


def _draw_spline(space: Any, curve: RationalBSpline, attributes: dict[str, str]) -> None:
    """The curve as it is, in its own knots."""
    first, last = curve.domain
    nearest = KNOT_TOLERANCE * (last - first)
    spline = space.add_spline(degree=curve.degree, dxfattribs={**attributes, "knot_tolerance": nearest})
    spline.control_points = curve.control_points.tolist()
    spline.knots = curve.knots.tolist()
    if curve.is_rational:
        spline.weights = curve.weights.tolist()
        spline.dxf.flags = spline.RATIONAL


def _text(drawing: Any) -> str:
    """The drawing's text, without the date and the random identity that ezdxf would give it."""
    from ezdxf.document import CREATED_BY_EZDXF, WRITTEN_BY_EZDXF
    from ezdxf.lldxf.tagwriter import TagWriter

    drawing.update_all()
    for name in DATES:
        drawing.header[name] = NO_DATE
    for name in GUIDS:
        drawing.header[name] = NO_GUID
    about = drawing.ezdxf_metadata()
    about[CREATED_BY_EZDXF] = about[WRITTEN_BY_EZDXF] = "ezdxf"
    stream = io.StringIO()
    drawing.export_sections(TagWriter(stream, dxfversion=drawing.dxfversion))
    return stream.getvalue()
