"""A domain and its medial axis as GeoJSON, for tools that read nothing else.

RFC 7946 in form: one FeatureCollection with the boundary as a Polygon (outer ring counter-clockwise, holes clockwise),
segments as LineStrings and nodes as Points. Not in its coordinates: RFC 7946 means longitude and latitude, here they are
the caller's own in the plane; the member ``coordinate_space`` says so. GeoJSON has no curves, so these are flattened:
chords stray by at most ``flattening_tolerance``, the radii along them included; walls nearer than that may cross.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mat_core.errors import UnsupportedOption
from mat_core.formats.beziers import chains, pieces_of
from mat_core.model.curve import RationalBSpline

if TYPE_CHECKING:
    from mat_core.axis import MedialAxis, Segment

Floats = NDArray[np.float64]
Json = dict[str, Any]

TOLERANCE = 1e-4  # of the size: a circle becomes some 200 chords
TOLERANCE_RANGE = (1e-9, 0.1)  # below it a circle has more than 70,000
RING_ENDS = 4  # positions of the shortest ring that GeoJSON allows, its first one repeated
SPACE = "the plane of the domain, in the caller's unit; not longitude and latitude"


def to_geojson(axis: MedialAxis, tolerance: float = TOLERANCE) -> Json:
    """The boundary, segments and nodes as a FeatureCollection.

    Parameters
    ----------
    axis : MedialAxis
    tolerance : float
        Largest distance between a curve and its chords, relative to the larger side of the bounding box; 1e-9 to 0.1.
        On segments the radii at the vertices, linearly in between, are within it, too.

    Returns
    -------
    dict
        Features ``boundary``, ``segment-0``, ... and ``node-0``, ... with the property ``layer`` telling them apart.
        Segments have kind, start_node, end_node, radii (one for each vertex), length and max_error (of the curve that
        was flattened, from the true axis); nodes have kind and radius.

    Raises
    ------
    UnsupportedOption
        The tolerance is out of its range.
    """
    if not TOLERANCE_RANGE[0] <= tolerance <= TOLERANCE_RANGE[1]:
        raise UnsupportedOption("tolerance", f"{tolerance} is not between {TOLERANCE_RANGE[0]} and {TOLERANCE_RANGE[1]}")
    length = tolerance * axis.domain.size
    return {
        "type": "FeatureCollection",
        "coordinate_space": SPACE,
        "flattening_tolerance": length,
        "bbox": [float(v) for v in axis.domain.bbox],
        "features": [_boundary(axis, length), *_segments(axis, length), *_nodes(axis)],
    }


def _feature(layer: str, number: int | None, geometry: str, coordinates: Any, **properties: Any) -> Json:
    name = layer if number is None else f"{layer}-{number}"
    return {
        "type": "Feature",
        "id": name,
        "geometry": {"type": geometry, "coordinates": coordinates},
        "properties": {"layer": layer, **({} if number is None else {"id": number}), **properties},
    }


def _boundary(axis: MedialAxis, tolerance: float) -> Json:
    """The domain as one polygon."""
    arrays = axis.domain.arrays
    rings = []
    for loop, backwards in enumerate(arrays.reversed.tolist()):
        ring = _ring(arrays.loop(loop), tolerance)
        # the interior lies to the left of every loop of a domain, and so do GeoJSON's rings
        rings.append((ring[::-1] if backwards else ring).tolist())
    return _feature("boundary", None, "Polygon", rings, area=axis.domain.area)


def _ring(edges: tuple[RationalBSpline, ...], tolerance: float) -> Floats:
    """A closed chain (n, 2), first vertex repeated; finer than asked where it would have no inside."""
    while True:
        found = chains([pieces_of(edge) for edge in edges], tolerance)
        # without the ends of the edges, which may miss the next start by a rounding
        ring = np.vstack((*(vertices[:-1] for vertices in found), found[0][:1]))
        distinct: Floats = ring[np.append(True, (np.diff(ring, axis=0) != 0.0).any(axis=1))]
        if len(distinct) >= RING_ENDS:
            return distinct
        tolerance *= 0.5


def _segments(axis: MedialAxis, tolerance: float) -> Iterator[Json]:
    """A feature for each segment; all are flattened together."""
    flattened = chains([disc_pieces(segment) for segment in axis.segments], tolerance)
    for segment, discs in zip(axis.segments, flattened, strict=True):
        yield _feature(
            "segment",
            segment.id,
            "LineString",
            discs[:, :2].tolist(),
            kind=segment.kind,
            start_node=segment.start_node,
            end_node=segment.end_node,
            length=segment.length,
            max_error=segment.max_error,
            radii=discs[:, 2].tolist(),
        )


def disc_pieces(segment: Segment) -> Floats:
    """The Bezier pieces (S, p + 1, 4) of a segment: x, y, r and weight."""
    radii = np.column_stack((segment.control_values, np.zeros(len(segment.weights))))
    centers = pieces_of(RationalBSpline(segment.degree, segment.knots, segment.control_points, segment.weights))
    heights = pieces_of(RationalBSpline(segment.degree, segment.knots, radii, segment.weights))
    return np.concatenate((centers[..., :2], heights[..., :1], centers[..., 2:]), axis=2)


def _nodes(axis: MedialAxis) -> list[Json]:
    return [
        _feature("node", node.id, "Point", list(node.point), kind=node.kind, radius=node.radius) for node in axis.nodes
    ]
