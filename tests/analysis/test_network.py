"""The graph for graph programs, and the paper's completeness test."""

from __future__ import annotations

import sys
from dataclasses import replace

import pytest

from mat_core.analysis import completeness, to_networkx
from tests.analysis.shapes import all_axes
from tests.curves.shapes import solved

networkx = pytest.importorskip("networkx")


def test_the_graph_is_what_the_paper_says() -> None:
    for axis in all_axes():
        graph = axis.graph
        out = to_networkx(axis)
        bare = networkx.DiGraph(out)
        bare.remove_edges_from(list(networkx.selfloop_edges(bare)))
        assert networkx.is_directed_acyclic_graph(bare)
        place = {node: i for i, node in enumerate(graph.topological_order)}
        assert sorted(place) == list(range(len(axis.nodes)))
        assert all(a is None or b is None or place[a] < place[b] or a == b for _, a, b in graph.edges)
        # one walk: all nodes but its start are reached from nodes met before
        starts = [n for n in bare if bare.in_degree(n) == 0 and out.nodes[n]["kind"] != "seam"]
        assert starts == list(graph.topological_order[:1])
        kinds = {n.kind for n in axis.nodes}
        wanted = next((k for k in ("convex_vertex", "curvature_center", "arc_center") if k in kinds), None)
        if starts and wanted:
            assert axis.nodes[starts[0]].kind == wanted
        # undirected: as many independent cycles as holes
        components = networkx.number_weakly_connected_components(out)
        assert components == graph.components == 1
        assert out.number_of_edges() - out.number_of_nodes() + components == graph.cycles == len(axis.domain.holes)


def test_depth_first_from_a_convex_corner() -> None:
    """Every node but the first hangs on the deepest node met before that has a segment to it left."""
    for axis in all_axes():
        met: list[int] = []
        left = [(a, b) for _, a, b in axis.graph.edges if a is not None and a != b]
        for node in axis.graph.topological_order:
            if met:
                before = [m for m in met if (m, node) in left or (node, m) in left]
                assert before
                # nodes met later than the one it hangs on have no unmet neighbours
                deepest = met.index(before[-1])
                for later in met[deepest + 1 :]:
                    unmet = {w for e in left if later in e for w in e} - set(met) - {later}
                    assert not unmet
            met.append(node)


def test_attributes() -> None:
    axis = solved("dumbbell")
    out = to_networkx(axis)
    assert out.graph == {"components": 1, "cycles": 0}
    assert out.nodes[0]["kind"] == "arc_center"
    assert out.nodes[0]["r"] == axis.nodes[0].radius
    (a, b, key, data), = out.edges(keys=True, data=True)
    assert (a, b, key) == (0, 1, 0)
    assert data["length"] == pytest.approx(4.0, abs=1e-12)
    assert (data["min_radius"], data["max_radius"]) == pytest.approx((0.2, 1.0), abs=1e-12)


def test_rings_and_discs() -> None:
    ring = to_networkx(solved("annulus"))
    assert list(ring.edges(keys=True)) == [("seam-0", "seam-0", 0)]
    disc = to_networkx(solved("circle"))
    assert [d["kind"] for _, d in disc.nodes(data=True)] == ["point"]
    assert disc.number_of_edges() == 0


def test_without_networkx_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "networkx", None)
    with pytest.raises(ImportError, match=r"mat-core\[graph\]"):
        to_networkx(solved("ell"))


def test_all_axes_are_complete() -> None:
    for axis in all_axes():
        found = completeness(axis)
        assert found.complete
        assert not found.missing
        assert [f.node for f in found.features if f.kind == "convex_vertex"].count(None) == 0
        degree = [0] * len(axis.nodes)
        for _, a, b in axis.graph.edges:
            for node in (a, b):
                if node is not None:
                    degree[node] += 1
        assert list(found.leaves) == [n for n in axis.graph.topological_order if degree[n] == 1]
        assert len(found.to_dict()["features"]) == len(found.features)


@pytest.mark.parametrize(("name", "vertices", "leaves", "shared"), [
    ("rectangle", 4, 0, 0), ("ellipse", 0, 2, 0), ("stadium", 0, 2, 0), ("dumbbell", 0, 2, 0), ("circle", 0, 0, 0),
    ("annulus", 0, 0, 0), ("half_disc", 2, 0, 0), ("parabola_cap", 2, 1, 0), ("lens", 2, 0, 2), ("keyhole", 2, 1, 0),
])
def test_features(name: str, vertices: int, leaves: int, shared: int) -> None:
    found = completeness(solved(name))
    states = [(f.kind, f.state) for f in found.features]
    assert states.count(("convex_vertex", "leaf")) == vertices
    assert states.count(("curvature_maximum", "leaf")) == leaves
    assert states.count(("curvature_maximum", "shared")) == shared
    assert len(states) == vertices + leaves + shared


def test_a_lost_segment_is_noticed() -> None:
    axis = solved("parabola_cap")
    kept = axis.skeleton
    leaf = next(n for n in axis.nodes if n.kind == "curvature_center")
    disc = int(axis.runs.node_disc[leaf.id])
    site = kept.contact_site.copy()
    rows = slice(int(kept.contact_start[disc]), int(kept.contact_start[disc + 1]))
    site[rows] = (site[rows] + 1) % len(axis.table.si)
    damaged = replace(axis, skeleton=kept._replace(contact_site=site))
    found = completeness(damaged)
    assert not found.complete
    assert [f.kind for f in found.missing] == ["curvature_maximum"]
