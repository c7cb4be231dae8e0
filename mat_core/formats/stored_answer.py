"""A stored answer, certified anew: does what the document holds pass the certificate on the domain it is said to belong to?

An answer does not hold which bits of the boundary each segment belongs to. That is found anew, and is no more than a witness: the
certificate judges discs, graph and curves as the document holds them, by that witness. So what passes is right whoever wrote it,
and what was changed by more than the certificate's limits is refused, and so is what was rounded to fewer digits than these.

1. The witness is the axis of the domain, found with the tolerance and the smooth angle that the answer was made with.
2. Nodes, segments and pieces must be as many as those of the witness, numbered alike and of the same kinds. The domain alone
   decides that, but method "march" numbers otherwise: its answers are refused, with a word on why.
3. The document's discs, graph and curves take the place of the witness's own, and the certificate is made.
4. Footpoints, and samples where there are any, are on the input's edges where they say, and on their discs' circles.

Not looked at: the direction in a normal fan (``angle``), and the certificate and the version that the document holds.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from mat_core.axis import MedialAxis
from mat_core.axis.records import CurveTable
from mat_core.axis.segment import SEGMENT_KINDS
from mat_core.certificate import certify
from mat_core.certificate.report import CHECKS
from mat_core.errors import NotCertified, UnreadableInput
from mat_core.formats.document_arrays import Floats, joined, numbers, offsets, whole
from mat_core.model.domain import Domain
from mat_core.pipeline import TOLERANCE_RANGE, medial_axis
from mat_core.threads import threads_allowed
from mat_core.topology.graph import NODE_KINDS, AxisGraph

Json = Mapping[str, Any]

LIMIT = 1e-9
"""Of footpoints and samples, relative to the larger side of the bounding box: that of the certificate's discs."""

LARGEST_SMOOTH_ANGLE = 0.1

DIGITS = 12
"""Of a tolerance that somebody asks for, at most."""

ROUNDING = 1e-14
"""Granted to figures of the domain, relative to the largest coordinate: they may have been summed up in another order."""


def certify_answer(answer: object, domain: Domain, *, threads: int | None = None) -> dict[str, Any]:
    """Certify a stored answer anew.

    Parameters
    ----------
    answer : object
        The document of `MedialAxis.to_dict` or of the service, as JSON reads it.
    domain : Domain
        What it is said to be the axis of.
    threads : int, optional
        As in `medial_axis`.

    Returns
    -------
    dict
        The new certificate, which has passed; with the checks ``footpoints`` and, where there are any, ``samples``: the largest
        distance of one from the edge that it names, or from its disc's circle.

    Raises
    ------
    UnreadableInput
        The document is no answer.
    NotCertified
        It is an answer, and not that of this domain; or none can be found now to judge it by.
    """
    document: Any = answer
    with _reading():
        _same_domain(document["domain"], domain)
        tolerance = _tolerance(document["certificate"]["checks"])
        smooth_angle = float(np.clip(document["certificate"]["smooth_angle"], 0.0, LARGEST_SMOOTH_ANGLE))
    witness = medial_axis(domain, tolerance, smooth_angle=smooth_angle, threads=threads)
    with _reading():
        axis = _in_place_of(witness, document["graph"], document["segments"])
    made = certify(axis.table, axis.skeleton, axis.runs, axis.curves, tolerance, domain=domain, threads=threads_allowed(threads))
    checks = dict(made["checks"])
    with _reading():
        if made["passed"]:
            checks["footpoints"] = _check("footpoints", list(_foot_faults(domain, document["graph"]["nodes"])), domain)
        if made["passed"] and any("samples" in segment for segment in document["segments"]):  # its curves can be evaluated
            checks["samples"] = _check("samples", list(_sample_faults(domain, axis, document["segments"])), domain)
    certificate = {**made, "checks": checks, "passed": all(check["passed"] for check in checks.values())}
    if not certificate["passed"]:
        name, check = next((name, check) for name, check in checks.items() if not check["passed"])
        figure = f"{check['measured']:.3g}, and {check['limit']:.3g} at most is allowed"
        raise NotCertified(f"{name}: {check['detail']}: {figure}", tuple(check["place"] or ()) or None, certificate)
    return certificate


@contextlib.contextmanager
def _reading() -> Iterator[None]:
    """What cannot be read in a document makes it none."""
    try:
        yield
    except (KeyError, IndexError, TypeError, AttributeError, OverflowError) as error:
        raise UnreadableInput(f"not an answer: {type(error).__name__}: {error}") from error


def _tolerance(checks: Json) -> float:
    """What was asked for: the limit of its check without the rounding that all limits of lengths have."""
    if "curves_tolerance" not in checks:
        return TOLERANCE_RANGE[1]  # there is no curve
    rounding = checks["boundary"]["limit"] - CHECKS["boundary"].limit
    asked = float(f"{checks['curves_tolerance']['limit'] - rounding:.{DIGITS}g}")
    return float(np.clip(asked, *TOLERANCE_RANGE))


def _same_domain(told: Json, domain: Domain) -> None:
    """The figures of the domain in the answer are those of this one."""
    counts = {"loops": len(domain.arrays.loop_start) - 1, "edges": len(domain.arrays.degree)}
    for name, count in counts.items():
        if told[name] != count:
            raise NotCertified(f"it is the answer of another domain: one of {told[name]} {name}, and this has {count}")
    slack = ROUNDING * max(map(abs, domain.bbox))
    box = numbers(told["bbox"], "/domain/bbox", 4)
    if not (np.abs(box - domain.bbox) <= slack).all():
        raise NotCertified(f"it is the answer of another domain: one within {box.tolist()}, and this has {list(domain.bbox)}")
    if not abs(told["area"] - domain.area) <= LIMIT * domain.size**2:
        raise NotCertified(f"it is the answer of another domain: one of area {told['area']}, and this has {domain.area}")


# The arrays ----------------------------------------------------------------------------------------------------------
def _in_place_of(witness: MedialAxis, graph: Json, segments: Sequence[Json]) -> MedialAxis:
    """The axis that the document holds, with what it does not hold from the witness."""
    discs = witness.skeleton.disc.copy()
    discs[witness.runs.node_disc] = _node_discs(witness, graph["nodes"])
    return MedialAxis(
        witness.domain, witness.table, witness.skeleton._replace(disc=discs), _graph(witness, graph, segments),
        _curves(witness, segments), witness.tolerance,
    )  # fmt: skip


def _node_discs(witness: MedialAxis, nodes: Sequence[Json]) -> Floats:
    """(N, 3) normalised discs of the nodes."""
    _as_many("nodes", len(nodes), len(witness.runs.node_disc))
    _numbered("node", nodes)
    told, found = [len(node["footpoints"]) for node in nodes], np.diff(witness.node_feet.start).tolist()
    if told != found and sorted(told) == sorted(found):
        raise NotCertified('its nodes are numbered otherwise than those found now; was it method "march", or another version?')
    for number, counts in enumerate(zip(told, found, strict=True)):
        _as_many(f"footpoints of node {number}", *counts)
    points = numbers([node["point"] for node in nodes], "/graph/nodes", 2)
    radii = numbers([node["radius"] for node in nodes], "/graph/nodes")
    return _normalised(witness, points, radii)


def _graph(witness: MedialAxis, graph: Json, segments: Sequence[Json]) -> AxisGraph:
    """The graph that the document holds; the strips of its segments are the witness's."""
    _as_many("segments", len(segments), len(witness.curves.degree))
    _numbered("segment", segments)
    ends = [(segment["start_node"], segment["end_node"]) for segment in segments]
    edges = [(edge["segment"], edge["source"], edge["target"]) for edge in graph["edges"]]
    if edges != [(number, *pair) for number, pair in enumerate(ends)]:
        raise NotCertified("edges of its graph do not join the nodes that its segments do")
    start, end = (whole([-1 if pair[side] is None else pair[side] for pair in ends], "/segments") for side in (0, 1))
    kinds = whole([_kind(NODE_KINDS, node["kind"]) for node in graph["nodes"]], "/graph/nodes")
    order = whole(graph["topological_order"], "/graph/topological_order")
    return witness.runs._replace(
        node_kind=kinds, start_node=start, end_node=end, order=order,
        components=whole(graph["components"], "/graph/components").item(),
        cycles=whole(graph["cycles"], "/graph/cycles").item(),
    )  # fmt: skip


def _curves(witness: MedialAxis, segments: Sequence[Json]) -> CurveTable:
    """The curves that the document holds; the strips of their pieces are the witness's."""
    c = witness.curves
    parts = [piece for segment in segments for piece in segment["pieces"]]
    starts = offsets([len(segment["pieces"]) for segment in segments])
    if not np.array_equal(starts, c.part_start):
        raise NotCertified("its segments are in other pieces than those found now; was it another version of the solver's?")
    kinds = [[_kind(SEGMENT_KINDS, thing["kind"]) for thing in things] for things in (segments, parts)]
    if kinds != [c.kind.tolist(), c.part_i[:, 3].tolist()]:
        raise NotCertified("its segments or their pieces are not of the kinds that they are said to be")
    for segment in segments:
        centres, radii = segment["axis"], segment["radius"]
        if any(centres[name] != radii[name] for name in ("degree", "knots", "weights")):
            raise NotCertified(f"segment {segment['id']}: its axis and its radius differ in degree, knots or weights")
    curves = [segment["axis"] for segment in segments]
    points = numbers(joined(curve["control_points"] for curve in curves), "/segments/*/axis/control_points", 2)
    radii = numbers(joined(segment["radius"]["control_values"] for segment in segments), "/segments/*/radius/control_values")
    weights = numbers(joined(curve["weights"] for curve in curves), "/segments/*/axis/weights")
    rows = [len(curve["control_points"]) for curve in curves]
    if rows != [len(curve["weights"]) for curve in curves] or rows != [len(s["radius"]["control_values"]) for s in segments]:
        raise NotCertified("segments have not as many weights or radii as control points")
    spans = c.part_f.copy()
    spans[:, :2] = numbers([piece["t"] for piece in parts], "/segments/*/pieces/*/t", 2)
    return c._replace(
        degree=whole([curve["degree"] for curve in curves], "/segments/*/axis/degree"),
        knot_start=offsets([len(curve["knots"]) for curve in curves]),
        knots=numbers(joined(curve["knots"] for curve in curves), "/segments/*/axis/knots"),
        cp_start=offsets(rows),
        cp=np.column_stack((_normalised(witness, points, radii), weights)),
        max_error=numbers([segment["max_error"] for segment in segments], "/segments/*/max_error") * witness.table.scale,
        part_f=spans,
    )


def _normalised(witness: MedialAxis, points: Floats, radii: Floats) -> Floats:
    """(n, 3) discs in the coordinates of the arrays."""
    table = witness.table
    return np.column_stack(((points - table.origin) * table.scale, radii * table.scale))


# What the certificate does not judge ---------------------------------------------------------------------------------
def _foot_faults(domain: Domain, nodes: Sequence[Json]) -> Iterator[tuple[float, Sequence[float]]]:
    """How far each footpoint is from where it is said to be, and from its disc's circle; and its node's place."""
    for node in nodes:
        centre = numbers(node["point"], "/graph/nodes/*/point")
        for foot in node["footpoints"]:
            place = numbers(foot["point"], "/graph/nodes/*/footpoints/*/point", 2)
            off = np.abs(place - _on_boundary(domain, foot)).max()
            yield max(float(off), abs(float(np.hypot(*(place - centre))) - node["radius"])), node["point"]


def _sample_faults(
    domain: Domain, axis: MedialAxis, segments: Sequence[Json]
) -> Iterator[tuple[float, Sequence[float]]]:
    """How far each sample's circle is from its footpoints, and its disc from the curve beyond that one's error."""
    for segment in segments:
        samples = segment["samples"]
        t = numbers(samples["t"], "/segments/*/samples/t")
        discs = np.column_stack((numbers(samples["points"], "/segments/*/samples/points", 2), samples["radii"]))
        curve = axis.evaluate(np.full(len(t), segment["id"], dtype=np.int64), t)[:, :3]
        away = np.linalg.norm(discs - curve, axis=1) - segment["max_error"]
        for side in ("left", "right"):
            for disc, foot, beyond in zip(discs.tolist(), samples[side], away.tolist(), strict=True):
                off = float(np.hypot(*(_on_boundary(domain, foot) - disc[:2]))) - disc[2]
                yield max(abs(off), beyond), disc[:2]


def _on_boundary(domain: Domain, foot: Json) -> Floats:
    """The point of the input at a footpoint's parameter."""
    loop, edge = whole([foot["loop"], foot["edge"]], "/graph/nodes/*/footpoints").tolist()
    if not (0 <= loop < len(domain.loops) and 0 <= edge < len(domain.loops[loop])):
        raise NotCertified(f"a footpoint lies on edge {edge} of loop {loop}, which the domain does not have")
    curve = domain.loops[loop][edge]
    low, high = curve.domain
    if not low <= foot["u"] <= high:
        raise NotCertified(f"a footpoint lies at u = {foot['u']} of an edge that goes from {low} to {high}")
    point: Floats = curve.evaluate(foot["u"])
    return point


def _check(name: str, faults: list[tuple[float, Sequence[float]]], domain: Domain) -> dict[str, Any]:
    """One check more."""
    worst, place = max(faults, key=lambda fault: fault[0], default=(0.0, (0.0, 0.0)))
    limit = LIMIT + ROUNDING * max(map(abs, domain.bbox)) / domain.size
    measured = worst / domain.size
    return {
        "passed": measured <= limit, "measured": measured, "limit": limit, "unit": "length", "place": list(place),
        "detail": f"largest distance of {name} from the edges that they name, from their circles or their curves",
    }  # fmt: skip


# What is counted and named ------------------------------------------------------------------------------------------
def _kind(kinds: Sequence[str], name: str) -> int:
    """The number of a kind; -1 when there is no such."""
    return kinds.index(name) if name in kinds else -1


def _as_many(what: str, told: int, found: int) -> None:
    if told != found:
        raise NotCertified(f"it has {told} {what}, and the axis of this domain has {found}")


def _numbered(what: str, things: Sequence[Json]) -> None:
    if [thing["id"] for thing in things] != list(range(len(things))):
        raise NotCertified(f"its {what}s are not numbered from 0 on")
