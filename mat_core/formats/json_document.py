"""The answer document of the contract, and its JSON.

Numbers are the caller's; names are those of the OpenAPI document. Curves carry their knots, control points and weights twice,
once with centres and once with radii, so that each can be read alone.

The text is put together from the flat arrays: all numbers of an array become text in one call, and each segment, node and
footpoint is a template filled with its share. The document is that text, read.
"""

from __future__ import annotations

import importlib.util
import json
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mat_core.axis.segment import SEGMENT_KINDS
from mat_core.kernels.layout import EDGE, FAN, KIND, LOOP
from mat_core.topology.graph import NODE_KINDS

if TYPE_CHECKING:
    from mat_core.axis import MedialAxis

HAS_ORJSON = importlib.util.find_spec("orjson") is not None

SEGMENT = (
    b'{"id":%d,"start_node":%b,"end_node":%b,"kind":"%b",'
    b'"axis":{"degree":%d,"knots":[%b],"control_points":[%b],"weights":[%b]},'
    b'"radius":{"degree":%d,"knots":[%b],"control_values":[%b],"weights":[%b]},'
    b'"pieces":[%b],"max_error":%b%b}'
)
SAMPLES = b',"samples":{"t":[%b],"points":[%b],"radii":[%b],"left":[%b],"right":[%b]}'
NODE = b'{"id":%d,"kind":"%b","point":[%b],"radius":%b,"footpoints":[%b]}'
GRAPH = b'{"nodes":[%b],"edges":[%b],"topological_order":%b,"components":%d,"cycles":%d}'


def document(axis: MedialAxis, samples: bool = False) -> dict[str, Any]:
    """The answer as plain dicts, lists and numbers.

    Parameters
    ----------
    axis : MedialAxis
    samples : bool
        With points, radii and footpoints along every segment.

    Returns
    -------
    dict
    """
    content: dict[str, Any] = _read(encode(axis, samples))
    return content


def about(axis: MedialAxis, **versions: str) -> dict[str, Any]:
    """What goes with everything that is found from an axis: certificate, figures of the domain, all versions."""
    from mat_core import __version__

    return {
        "certificate": dict(axis.certificate),
        "domain": {
            "bbox": [float(v) for v in axis.domain.bbox],
            "area": float(axis.domain.area),
            "loops": len(axis.domain.arrays.loop_start) - 1,
            "edges": len(axis.domain.arrays.degree),
        },
        "version": {"algorithm": __version__, **versions},
    }


def encode(axis: MedialAxis, samples: bool = False, **versions: str) -> bytes:
    """The answer as UTF-8 JSON; never with NaN or Infinity.

    Parameters
    ----------
    axis : MedialAxis
    samples : bool
    **versions : str
        Of what else had a part in the answer, by name, for its member ``version``.

    Returns
    -------
    bytes
    """
    ends = _node_names(axis.runs.start_node), _node_names(axis.runs.end_node)
    segments = _segments(axis, ends, _samples(axis) if samples else [b""] * len(ends[0]))
    return b'{"segments":[%b],"graph":%b,%b' % (b",".join(segments), _graph(axis, ends), _text(about(axis, **versions))[1:])


def _segments(axis: MedialAxis, ends: tuple[list[bytes], list[bytes]], sampled: list[bytes]) -> list[bytes]:
    """Each segment."""
    c = axis.curves
    discs = axis.control_discs
    knots, points, radii, weights = (_rows(a) for a in (c.knots, discs[:, :2], discs[:, 2], c.cp[:, 3]))
    pieces = [
        b'{"t":[%b],"kind":"%b"}' % (t, SEGMENT_KINDS[kind].encode())
        for t, kind in zip(_rows(c.part_f[:, :2]), c.part_i[:, 3].tolist(), strict=True)
    ]
    knot_start, cp_start, part_start = c.knot_start.tolist(), c.cp_start.tolist(), c.part_start.tolist()
    errors, degrees, kinds = _rows(c.max_error / axis.table.scale), c.degree.tolist(), c.kind.tolist()
    listed = []
    for g, (start, end) in enumerate(zip(*ends, strict=True)):
        rows = slice(cp_start[g], cp_start[g + 1])
        own_knots = b",".join(knots[knot_start[g] : knot_start[g + 1]])
        own_weights = b",".join(weights[rows])
        listed.append(
            SEGMENT
            % (
                g, start, end, SEGMENT_KINDS[kinds[g]].encode(),
                degrees[g], own_knots, _pairs(points[rows]), own_weights,
                degrees[g], own_knots, b",".join(radii[rows]), own_weights,
                b",".join(pieces[part_start[g] : part_start[g + 1]]), errors[g], sampled[g],
            )
        )  # fmt: skip
    return listed


def _samples(axis: MedialAxis) -> list[bytes]:
    """The member ``samples`` of each segment: all are sampled in one go."""
    segment, t = axis.sample_parameters()
    count = len(axis.curves.degree)
    if count == 0:
        return []
    found = axis.sample(segment, t)
    bounds = np.searchsorted(segment, np.arange(count + 1)).tolist()
    left = _sides(axis, found.left_site, found.left_u, found.left_angle)
    right = _sides(axis, found.right_site, found.right_u, found.right_angle)
    places, points, radii = _rows(found.t), _rows(found.points), _rows(found.radii)
    listed = []
    for g in range(count):
        own = slice(bounds[g], bounds[g + 1])
        listed.append(
            SAMPLES
            % (
                b",".join(places[own]), _pairs(points[own]), b",".join(radii[own]),
                b",".join(left[own]), b",".join(right[own]),
            )
        )  # fmt: skip
    return listed


def _sides(axis: MedialAxis, site: NDArray[np.int64], u: NDArray[np.float64], angle: NDArray[np.float64],
           points: NDArray[np.float64] | None = None) -> list[bytes]:  # fmt: skip
    """Footpoints, with their points if these are given; those in a normal fan carry the normal's angle."""
    rows = axis.table.si[site]
    at = [b""] * len(rows) if points is None else [b',"point":[%b]' % point for point in _rows(points)]
    turned = [b""] * len(rows)
    fan = np.flatnonzero(rows[:, KIND] == FAN)
    for i, value in zip(fan.tolist(), _rows(angle[fan]), strict=True):
        turned[i] = b',"angle":%b' % value
    parts = zip(rows[:, LOOP].tolist(), rows[:, EDGE].tolist(), _rows(u), at, turned, strict=True)
    return [b'{"loop":%d,"edge":%d,"u":%b%b%b}' % part for part in parts]


def _graph(axis: MedialAxis, ends: tuple[list[bytes], list[bytes]]) -> bytes:
    """Nodes, edges and their order."""
    discs, feet = axis.node_discs, axis.node_feet
    footpoints = _sides(axis, feet.site, feet.u, feet.angle, feet.points)
    start = feet.start.tolist()
    nodes = [
        NODE % (n, NODE_KINDS[kind].encode(), centre, radius, b",".join(footpoints[start[n] : start[n + 1]]))
        for n, (kind, centre, radius) in enumerate(
            zip(axis.runs.node_kind.tolist(), _rows(discs[:, :2]), _rows(discs[:, 2]), strict=True)
        )
    ]
    edges = [b'{"segment":%d,"source":%b,"target":%b}' % (g, a, b) for g, (a, b) in enumerate(zip(*ends, strict=True))]
    order = _text(axis.runs.order.tolist())
    return GRAPH % (b",".join(nodes), b",".join(edges), order, axis.runs.components, axis.runs.cycles)


def _node_names(nodes: NDArray[np.int64]) -> list[bytes]:
    """Ids of nodes; null for those of a closed segment."""
    return [b"%d" % node if node >= 0 else b"null" for node in nodes.tolist()]


def _pairs(rows: list[bytes]) -> bytes:
    """Rows x, y as lists of two."""
    return b"[" + b"],[".join(rows) + b"]" if rows else b""


def _rows(values: NDArray[np.float64]) -> list[bytes]:
    """The numbers of each row, with commas between them; assumes they are finite."""
    if len(values) == 0:
        return []
    text = _text(np.ascontiguousarray(values))
    return text[1:-1].split(b",") if values.ndim == 1 else text[2:-2].split(b"],[")


def _text(value: Any) -> bytes:
    """JSON of a plain object or of an array of numbers."""
    if HAS_ORJSON:
        import orjson

        return orjson.dumps(value, option=orjson.OPT_SERIALIZE_NUMPY)
    plain = value.tolist() if isinstance(value, np.ndarray) else value
    return json.dumps(plain, allow_nan=False, separators=(",", ":")).encode()


def _read(text: bytes) -> Any:
    """What JSON text says that was written here."""
    if HAS_ORJSON:
        import orjson

        try:
            return orjson.loads(text)
        except orjson.JSONDecodeError as error:  # its complaint about a buffer that it could not have
            raise MemoryError from error
    return json.loads(text)
