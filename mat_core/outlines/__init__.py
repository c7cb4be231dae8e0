"""Domains from what people have: corners and circles, SVG, DXF, GeoJSON, fonts.

    {"outer": polygon([(0, 0), (6, 0), (6, 4), (0, 4)], rounding=1), "holes": [circle((3, 2), 0.5)]}
    from_svg(text).domains, from_dxf("plate.dxf").domains, from_geojson(text).domains, from_font("a.ttf", "Q").domains

Nothing is flattened: lines stay lines, arcs become rational quadratics of a quarter turn at most, splines stay what they are.
What comes out are JSON domains for `mat_core.Domain.from_dict` or for the body of a request; whether they are valid is for
`Domain` to say. Nothing here knows what becomes of them.
"""

from mat_core.outlines.dxf import from_dxf
from mat_core.outlines.font import from_font
from mat_core.outlines.geojson import from_geojson
from mat_core.outlines.nesting import Outlines, nested
from mat_core.outlines.shapes import circle, polygon
from mat_core.outlines.svg import from_svg
from mat_core.outlines.svg_path import path_loops

__all__ = ["Outlines", "circle", "from_dxf", "from_font", "from_geojson", "from_svg", "nested", "path_loops", "polygon"]
