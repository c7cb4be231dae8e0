"""The answer document of the contract, and its JSON.

Numbers are the caller's; names are those of the OpenAPI document. Curves carry their knots, control points and
weights twice, once with centres and once with radii, so that each can be read alone.
"""

from __future__ import annotations

import importlib.util
import json
from typing import TYPE_CHECKING, Any

import numpy as np

from mat_core.kernels.layout import EDGE, FAN, KIND, LOOP

if TYPE_CHECKING:
    from mat_core.axis import MedialAxis, Samples

HAS_ORJSON = importlib.util.find_spec("orjson") is not None


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
    return {"segments": _segments(axis, samples), "graph": _graph(axis), **about(axis)}


def about(axis: MedialAxis) -> dict[str, Any]:
    """What goes with everything that is found from an axis: certificate, figures of the domain, version."""
    from mat_core import __version__

    return {
        "certificate": dict(axis.certificate),
        "domain": {
            "bbox": [float(v) for v in axis.domain.bbox],
            "area": float(axis.domain.area),
            "loops": len(axis.domain.arrays.loop_start) - 1,
            "edges": len(axis.domain.arrays.degree),
        },
        "version": {"algorithm": __version__},
    }


def encode(axis: MedialAxis, samples: bool = False) -> bytes:
    """The answer as UTF-8 JSON; never with NaN or Infinity.

    Parameters
    ----------
    axis : MedialAxis
    samples : bool

    Returns
    -------
    bytes
    """
    content = document(axis, samples)
    if HAS_ORJSON:
        import orjson

        return orjson.dumps(content)
    return json.dumps(content, allow_nan=False, separators=(",", ":")).encode()


def _segments(axis: MedialAxis, samples: bool) -> list[dict[str, Any]]:
    """The list of segments; array slices become lists once for all of them."""
    c = axis.curves
    kinds = [s.kind for s in axis.segments]
    knots, discs, weights = c.knots.tolist(), axis.control_discs, c.cp[:, 3].tolist()
    points, radii = discs[:, :2].tolist(), discs[:, 2].tolist()
    knot_start, cp_start = c.knot_start.tolist(), c.cp_start.tolist()
    errors = (c.max_error / axis.table.scale).tolist()
    listed: list[dict[str, Any]] = []
    for g, (degree, start, end) in enumerate(
        zip(c.degree.tolist(), axis.runs.start_node.tolist(), axis.runs.end_node.tolist(), strict=True)
    ):
        own_knots = knots[knot_start[g] : knot_start[g + 1]]
        rows = slice(cp_start[g], cp_start[g + 1])
        listed.append(
            {
                "id": g,
                "start_node": start if start >= 0 else None,
                "end_node": end if end >= 0 else None,
                "kind": kinds[g],
                "axis": {
                    "degree": degree,
                    "knots": own_knots,
                    "control_points": points[rows],
                    "weights": weights[rows],
                },
                "radius": {
                    "degree": degree,
                    "knots": list(own_knots),
                    "control_values": radii[rows],
                    "weights": weights[rows],
                },
                "pieces": [{"t": [t0, t1], "kind": kind} for t0, t1, kind in axis.segments[g].pieces],
                "max_error": errors[g],
            }
        )
    if samples and listed:
        _add_samples(axis, listed)
    return listed


def _add_samples(axis: MedialAxis, listed: list[dict[str, Any]]) -> None:
    """Sample all segments in one go and hand out the parts."""
    segment, t = axis.sample_parameters()
    found = axis.sample(segment, t)
    left = _side(axis, found.left_site, found.left_u, found.left_angle)
    right = _side(axis, found.right_site, found.right_u, found.right_angle)
    bounds = np.searchsorted(segment, np.arange(len(listed) + 1)).tolist()
    columns = _columns(found)
    for g, entry in enumerate(listed):
        rows = slice(bounds[g], bounds[g + 1])
        entry["samples"] = {name: values[rows] for name, values in columns.items()}
        entry["samples"]["left"] = left[rows]
        entry["samples"]["right"] = right[rows]


def _columns(found: Samples) -> dict[str, list[Any]]:
    return {"t": found.t.tolist(), "points": found.points.tolist(), "radii": found.radii.tolist()}


def _side(axis: MedialAxis, site: Any, u: Any, angle: Any) -> list[dict[str, Any]]:
    """Footpoints of one side; those in a normal fan carry the normal's angle."""
    rows = axis.table.si[site]
    listed: list[dict[str, Any]] = []
    for loop, edge, kind, value, turned in zip(
        rows[:, LOOP].tolist(), rows[:, EDGE].tolist(), rows[:, KIND].tolist(), u.tolist(), angle.tolist(), strict=True
    ):
        entry = {"loop": loop, "edge": edge, "u": value}
        if kind == FAN:
            entry["angle"] = turned
        listed.append(entry)
    return listed


def _graph(axis: MedialAxis) -> dict[str, Any]:
    graph = axis.graph
    return {
        "nodes": [
            {
                "id": n.id,
                "kind": n.kind,
                "point": list(n.point),
                "radius": n.radius,
                "footpoints": [f.to_dict() for f in n.footpoints],
            }
            for n in axis.nodes
        ],
        "edges": [{"segment": s, "source": a, "target": b} for s, a, b in graph.edges],
        "topological_order": list(graph.topological_order),
        "components": graph.components,
        "cycles": graph.cycles,
    }
