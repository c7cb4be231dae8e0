"""The answer document: the contract's names and nothing that JSON cannot hold."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mat_core import Domain, medial_axis
from mat_core.formats import json_document
from tests.curves.shapes import shape, solved

SHAPES = ("rectangle", "ell", "stadium", "annulus", "ellipse", "circle", "mixed", "blob_holes", "gear")


@pytest.mark.parametrize("samples", [False, True])
@pytest.mark.parametrize("name", SHAPES)
def test_json_and_dict_are_one(name: str, samples: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    axis = solved(name)
    content = axis.to_dict(samples=samples)
    assert json.loads(json.dumps(content, allow_nan=False)) == content
    assert json.loads(axis.to_json(samples=samples)) == content
    monkeypatch.setattr(json_document, "HAS_ORJSON", False)
    assert json.loads(axis.to_json(samples=samples)) == content


@pytest.mark.parametrize("name", SHAPES)
def test_the_document_tells_what_the_views_tell(name: str) -> None:
    axis = solved(name)
    content = axis.to_dict()
    assert content["segments"] == [
        {
            "id": s.id,
            "start_node": s.start_node,
            "end_node": s.end_node,
            "kind": s.kind,
            "axis": {
                "degree": s.degree,
                "knots": s.knots.tolist(),
                "control_points": s.control_points.tolist(),
                "weights": s.weights.tolist(),
            },
            "radius": {
                "degree": s.degree,
                "knots": s.knots.tolist(),
                "control_values": s.control_values.tolist(),
                "weights": s.weights.tolist(),
            },
            "pieces": [{"t": [t0, t1], "kind": kind} for t0, t1, kind in s.pieces],
            "max_error": s.max_error,
        }
        for s in axis.segments
    ]
    assert content["graph"] == {
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
        "edges": [{"segment": s, "source": a, "target": b} for s, a, b in axis.graph.edges],
        "topological_order": list(axis.graph.topological_order),
        "components": axis.graph.components,
        "cycles": axis.graph.cycles,
    }


@pytest.mark.parametrize("name", SHAPES)
def test_sampled_points_and_footpoints_are_those_of_the_axis(name: str) -> None:
    axis = solved(name)
    for s, entry in zip(axis.segments, axis.to_dict(samples=True)["segments"], strict=True):
        told = entry["samples"]
        found = s.samples(told["t"])
        assert told["points"] == found.points.tolist()
        assert told["radii"] == found.radii.tolist()
        assert [f["u"] for f in told["left"]] == found.left_u.tolist()
        assert [f["u"] for f in told["right"]] == found.right_u.tolist()
        for t, left, right in zip(told["t"], told["left"], told["right"], strict=True):
            for footpoint, member in zip(s.footpoints(t), (left, right), strict=True):
                shown = footpoint.to_dict()
                del shown["point"]
                assert shown == member


@pytest.mark.parametrize("name", SHAPES)
def test_names_of_the_contract(name: str) -> None:
    content = solved(name).to_dict(samples=True)
    assert set(content) == {"segments", "graph", "certificate", "domain", "version"}
    assert set(content["graph"]) == {"nodes", "edges", "topological_order", "components", "cycles"}
    assert set(content["domain"]) == {"bbox", "area", "loops", "edges"}
    for s in content["segments"]:
        assert {"id", "start_node", "end_node", "kind", "axis", "radius", "samples", "max_error"} <= set(s)
        assert set(s["axis"]) == {"degree", "knots", "control_points", "weights"}
        assert set(s["radius"]) == {"degree", "knots", "control_values", "weights"}
        assert s["axis"]["knots"] == s["radius"]["knots"]
        assert s["axis"]["weights"] == s["radius"]["weights"]
        assert len(s["axis"]["control_points"]) == len(s["radius"]["control_values"])
        counts = {len(s["samples"][key]) for key in ("t", "points", "radii", "left", "right")}
        assert counts == {17}
    for n in content["graph"]["nodes"]:
        assert {"id", "kind", "point", "radius", "footpoints"} == set(n)


@pytest.mark.parametrize("name", ["ell", "mixed", "blob_holes", "annulus", "gear", "ellipse"])
def test_samples_lie_on_the_curve_within_its_error(name: str) -> None:
    axis = solved(name)
    for s, entry in zip(axis.segments, axis.to_dict(samples=True)["segments"], strict=True):
        samples = entry["samples"]
        true = np.column_stack([samples["points"], samples["radii"]])
        off = np.linalg.norm(true - s.evaluate(samples["t"]), axis=1)
        assert off.max() <= s.max_error + 1e-13 * axis.domain.size


@pytest.mark.parametrize("name", ["ell", "blob_holes", "annulus", "mixed"])
def test_step_bounds_the_spacing(name: str) -> None:
    content = shape(name)
    domain = Domain.from_dict({"outer": content["outer"], "holes": content.get("holes", [])})
    axis = medial_axis(domain, step=0.01)
    for s in axis.to_dict(samples=True)["segments"]:
        points = np.array(s["samples"]["points"])
        assert np.hypot(*np.diff(points, axis=0).T).max() <= 0.01 * domain.size


def test_a_fan_footpoint_carries_its_angle() -> None:
    content = solved("ell").to_dict(samples=True)
    fans = [f for s in content["segments"] for side in ("left", "right") for f in s["samples"][side] if "angle" in f]
    assert fans
    assert all(-4 < f["angle"] < 4 for f in fans)
