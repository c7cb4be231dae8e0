"""Strong predicates on the answer document: the oracle of `tests.reference` judges every disc and every node.

`measure(domain, answer)` returns a `Report`; `assert_axis` fails with all its problems at once. Lengths in a report are
relative to the larger side of the domain's bounding box.

What is looked at, both ways round:

    axis -> boundary    discs of every segment are empty and touch in two separate places, or osculate near a leaf
    boundary -> axis    the maximal disc at many boundary points, and in every normal fan, is on the returned axis
    nodes               as many branches as the disc has separate contacts; leaves are what their kind says
    graph               ends fit, connected, cycles = holes, the order is topological
    footpoints          are on the boundary, at the distance of the radius
"""

from __future__ import annotations

import json
import math
from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from tests.reference import CORNER, TINY, Contacts, CurveSet, Floats, Ints, Reference, full_knots, homogeneous

Json = dict[str, Any]

BESIDE_CORNER = 0.02  # how far such a branch reaches along the boundary, where the corner's own circle is nearly its disc
FLAT_REACH = 1e-6  # of the radius, from the circle to such a corner
UNSEEN_DEPTH = 1e-13  # nor is this seen, from such a corner to a disc that touches both its sides
EXACT = 1e-9  # accuracy asked of nodes and of exact conics
ONE_DISC = 4e-12  # a node may stand for several in a row that are a quarter of this from each other
ONE_CLUSTER = 1e-10  # nodes nearer than this see each other's contacts
BEND_RADIUS = 1e-11  # curvature as tight as this may be that of a vertex
ONE_PLACE = 1e-10  # contacts no farther apart than this are one
ONE_BY_ROUNDING = 1e-14  # so are these, where the boundary does not follow the disc and a minimum is well placed
ONE_BY_SLACK = 1e-8  # and these, of the radius: so far beside a cell's end the distance grows by no more than `true_minima` tells
SEEN = 1e-3  # of the radius of a disc: contacts are no nearer to each other, nor is what touches farther from it
NAMED = 2  # units of a parameter's last place by which a footpoint's may be off
EXACT_KINDS = ("line", "parabola", "hyperbola", "ellipse")
KINDS = (*EXACT_KINDS, "freeform")
NODE_KINDS = ("convex_vertex", "curvature_center", "arc_center", "branch", "point")


@dataclass
class Report:
    """What was measured, and everything that was wrong."""

    worst: dict[str, float] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)

    def note(self, name: str, values: Floats, limits: Floats | float, places: Floats | None = None) -> None:
        """Record the worst of `values` and complain about those over their limits."""
        if not len(values):
            return
        values = np.where(np.isfinite(values), values, np.inf)
        self.worst[name] = max(self.worst.get(name, 0.0), float(values.max()))
        over = values - limits
        if np.any(over > 0):
            i = int(np.argmax(over))
            place = "" if places is None else f" at {np.array2string(places[i], precision=6)}"
            limit = float(np.broadcast_to(limits, values.shape)[i])
            self.problems.append(
                f"{name}: {values[i]:.2e} > {limit:.1e}{place} ({np.count_nonzero(over > 0)} of {len(values)})"
            )

    def require(self, condition: bool, message: str) -> None:
        """A yes or no matter."""
        if not condition:
            self.problems.append(message)


def piece_kinds(segment: Json) -> set[str]:
    """The kinds of a segment's pieces: a segment of several exact kinds is freeform as a whole."""
    return {p["kind"] for p in segment.get("pieces", [segment])}


def is_exact(segment: Json) -> bool:
    """True when all of the segment is made of lines, points and arcs on both sides."""
    return piece_kinds(segment) <= set(EXACT_KINDS)


class Answer:
    """The answer document in the reference's normalised frame."""

    def __init__(self, document: Json, reference: Reference) -> None:
        self.segments: list[Json] = document["segments"]
        self.nodes: list[Json] = document["graph"]["nodes"]
        self.edges: list[Json] = document["graph"]["edges"]
        self.graph: Json = document["graph"]
        self.origin, self.size = reference.frame
        self.node_disc = np.array([[*n["point"], n["radius"]] for n in self.nodes], dtype=float).reshape(-1, 3)
        self.node_disc = (self.node_disc - [*self.origin, 0.0]) / self.size
        self.index = {n["id"]: i for i, n in enumerate(self.nodes)}
        self.degree = Counter(
            end for s in self.segments if s["start_node"] is not None for end in (s["start_node"], s["end_node"])
        )

    def spline(self, segment: Json) -> tuple[int, Floats, Floats]:
        """(degree, knots, homogeneous control points of (x, y, r)) of one segment."""
        axis, radius = segment["axis"], segment["radius"]
        points = np.array(axis["control_points"], dtype=float).reshape(-1, 2)
        values = np.array(radius["control_values"], dtype=float)
        together = np.column_stack([(points - self.origin) / self.size, values / self.size])
        weights = axis.get("weights")
        return (
            int(axis["degree"]),
            full_knots(axis),
            homogeneous(together, np.ones(len(points)) if weights is None else np.array(weights)),
        )

    @cached_property
    def axis(self) -> CurveSet:
        """All segments as curves in (x, y, r)."""
        return CurveSet([self.spline(s) for s in self.segments])

    def samples(self, each: int) -> tuple[Ints, Floats]:
        """(segment, disc): `each` discs inside every segment, closer together towards both ends."""
        f = 0.5 - 0.5 * np.cos(np.pi * (np.arange(each) + 0.5) / each)
        owner = np.repeat(np.arange(len(self.segments)), each)
        spans = [(k[0], k[-1]) for k in (full_knots(s["axis"]) for s in self.segments)]
        u = np.concatenate([a + f * (b - a) for a, b in spans])
        return owner, self.axis.points(owner, u)


def measure(
    domain: Json, answer: Json, tolerance: float = 1e-6, per_segment: int = 7, per_edge: int = 5, seed: int = 0
) -> Report:
    """Judge an answer document by the oracle."""
    report = Report()
    reference = Reference(domain, answer.get("certificate", {}).get("smooth_angle", CORNER))
    try:
        json.dumps(answer, allow_nan=False)
    except ValueError as error:
        report.problems.append(f"document: {error}")
        return report
    check_graph(report, answer, len(domain.get("holes", [])))
    if report.problems:
        return report
    parsed = Answer(answer, reference)
    check_ends(report, parsed, reference)
    if parsed.segments:
        check_discs(report, parsed, reference, tolerance, per_segment)
    check_coverage(report, parsed, reference, tolerance, per_edge, seed)
    check_nodes(report, parsed, reference)
    check_footpoints(report, parsed, reference, tolerance)
    return report


def assert_axis(domain: Json, answer: Json, tolerance: float = 1e-6, **options: int) -> Report:
    """Fail with everything that `measure` found."""
    report = measure(domain, answer, tolerance, **options)
    assert not report.problems, "\n".join([str(domain.get("name", "")), *report.problems])
    return report


def check_graph(report: Report, answer: Json, holes: int) -> None:
    """Ids, edges, order, components and cycles fit together."""
    graph, segments = answer["graph"], answer["segments"]
    ids = [n["id"] for n in graph["nodes"]]
    report.require(len(set(ids)) == len(ids), "graph: node ids repeat")
    report.require(len({s["id"] for s in segments}) == len(segments), "graph: segment ids repeat")
    report.require(all(n["kind"] in NODE_KINDS for n in graph["nodes"]), "graph: unknown node kind")
    report.require(all(s["kind"] in KINDS for s in segments), "graph: unknown segment kind")
    ends = {s["id"]: (s["start_node"], s["end_node"]) for s in segments if s["start_node"] is not None}
    closed = sum(s["start_node"] is None and s["end_node"] is None for s in segments)
    report.require(len(ends) + closed == len(segments), "graph: a segment has one end only")
    if not all(e in set(ids) for pair in ends.values() for e in pair):
        report.problems.append("graph: a segment ends at no node")
        return
    listed = {e["segment"]: (e["source"], e["target"]) for e in graph["edges"] if e["source"] is not None}
    report.require(
        set(listed) == set(ends) and all(sorted(listed[i]) == sorted(ends[i]) for i in ends if i in listed),
        "graph: edges differ from the segments' ends",
    )
    order = {n: i for i, n in enumerate(graph["topological_order"])}
    report.require(
        sorted(order) == sorted(ids) and len(graph["topological_order"]) == len(ids), "graph: order is no permutation"
    )
    report.require(
        all(s == t or order.get(s, 0) < order.get(t, 0) for s, t in listed.values()),
        "graph: the order is not topological",
    )
    kind = {n["id"]: n["kind"] for n in graph["nodes"]}
    if order and "convex_vertex" in kind.values():
        report.require(
            kind.get(graph["topological_order"][0]) == "convex_vertex", "graph: the order starts at no convex vertex"
        )
    parent = {i: i for i in ids}

    def root(i: int) -> int:
        while parent[i] != i:
            i = parent[i]
        return i

    for a, b in ends.values():
        parent[root(a)] = root(b)
    pieces = len({root(i) for i in ids}) + closed
    cycles = len(ends) - len(ids) + len({root(i) for i in ids}) + closed
    report.require(pieces == 1, f"graph: {pieces} components")
    report.require(cycles == holes, f"graph: {cycles} cycles, {holes} holes")
    report.require(
        graph["components"] == pieces and graph["cycles"] == cycles, "graph: states other components or cycles"
    )


def check_ends(report: Report, answer: Answer, reference: Reference) -> None:
    """Segments end at their nodes; axis and radius share their parameter; closed ones close."""
    for s in answer.segments:
        a, r = s["axis"], s["radius"]
        same = (
            a["degree"] == r["degree"]
            and list(full_knots(a)) == list(full_knots(r))
            and a.get("weights") == r.get("weights")
        )
        report.require(same, f"segment {s['id']}: axis and radius have different bases")
    if not answer.segments or report.problems:
        return
    n = len(answer.segments)
    knots = [full_knots(s["axis"]) for s in answer.segments]
    first = answer.axis.points(np.arange(n), np.array([k[0] for k in knots]))
    last = answer.axis.points(np.arange(n), np.array([k[-1] for k in knots]))
    target0, target1 = last.copy(), first.copy()
    for i, s in enumerate(answer.segments):
        if s["start_node"] is not None:
            target0[i] = answer.node_disc[answer.index[s["start_node"]]]
            target1[i] = answer.node_disc[answer.index[s["end_node"]]]
    gap = np.maximum(np.abs(first - target0).max(axis=1), np.abs(last - target1).max(axis=1))
    report.note("ends", gap, EXACT + 10 * reference.floor, first)


def true_minima(reference: Reference, queries: Floats, contacts: Contacts) -> Contacts:
    """Drop cell ends from which the distance goes on decreasing in the neighbouring cell."""
    t0, t1 = reference.ends
    before = np.empty_like(reference.follow)
    before[reference.follow] = np.arange(len(before))
    out = contacts.point - queries[contacts.query]
    slack = 1e-9 * contacts.distance
    onward = np.sum(out * t0[reference.follow[contacts.cell]], axis=1)
    back = np.sum(out * t1[before[contacts.cell]], axis=1)
    keep = ((contacts.s < 1) | (onward >= -slack)) & ((contacts.s > 0) | (back <= slack))
    return Contacts(*(column[keep] for column in contacts))


def check_discs(report: Report, answer: Answer, reference: Reference, tolerance: float, each: int) -> None:
    """Discs inside segments are empty and touch twice, or osculate, or shrink into a convex vertex."""
    owner, disc = answer.samples(each)
    center, radius = disc[:, :2], disc[:, 2]
    exact = np.array([is_exact(s) for s in answer.segments])[owner]
    stated = np.array([float(s["max_error"]) for s in answer.segments])[owner] / answer.size
    bound = EXACT + 10 * reference.floor
    error = np.where(exact, bound, tolerance + bound)
    distance, touching = reference.boundary.contacts(center, 4 * error)
    report.note("distance - radius", np.abs(distance - radius), 2 * error, center)
    report.note("error over stated", np.abs(distance - radius) - 2 * stated, bound, center)
    large = radius > 2e-4
    report.require(bool(reference.inside(center[large]).all()), "a disc's centre lies outside the domain")
    found = true_minima(reference, center, touching)
    spread = np.zeros(len(center))
    anchor = np.zeros_like(center)
    anchor[found.query] = found.point
    np.maximum.at(spread, found.query, np.linalg.norm(found.point - anchor[found.query], axis=1))
    # where a minimum lies is known to 1e-16 / (1 - k r): two contacts of a tight bend, or beside a faint corner, may be near
    follows = np.zeros(len(center))
    bend = np.nan_to_num(reference.at(found.cell, found.s)[2], nan=math.inf) * radius[found.query]
    np.maximum.at(follows, found.query, np.clip(bend, 0.0, 1.0))
    blur = ONE_BY_SLACK * radius + ONE_BY_ROUNDING / np.maximum(1.0 - follows, ONE_BY_ROUNDING) + 10.0 * reference.floor
    lonely = np.nonzero(spread <= np.minimum(np.minimum(ONE_PLACE, 0.01 * radius), blur))[0]
    excuse = _leaf_nearness(reference, center, radius, error, touching)
    lonely = lonely[~excuse[lonely]]
    # a branch into a corner that is too flat to see touches both its sides nearly at the corner itself
    # and one between a reflex vertex and a tight bend beside it touches both there
    flat = np.vstack([reference.flat_corners, reference.bends_beside_reflex])
    if len(flat):
        gap = np.linalg.norm(anchor[lonely][:, None] - flat[None], axis=2)
        # nor can the oracle see how far a corner stands back from a disc that touches both its sides
        back = gap * np.concatenate([reference.flat_turns, np.ones(len(reference.bends_beside_reflex))])
        lonely = lonely[((gap > 1e-5 * radius[lonely][:, None] + 1e-9) & (back > UNSEEN_DEPTH)).all(axis=1)]
    # the sides of a corner that turns by a touch a disc at r a / 2 from it, or at the corner itself where one bends back there:
    # too near to each other, maybe, to be seen as two
    for corner in (c for c in reference.corners if c.turn > 0):
        apart = np.minimum(radius[lonely] * corner.turn, ONE_PLACE)
        lonely = lonely[np.linalg.norm(anchor[lonely] - corner.point, axis=1) > apart]
    shown = "" if not len(lonely) else f"{center[lonely[0]]} r {radius[lonely[0]]:.6g} segment {owner[lonely[0]]}"
    report.require(not len(lonely), f"discs touching one place only: {len(lonely)} of {len(center)}, at {shown}")


def _leaf_nearness(
    reference: Reference, center: Floats, radius: Floats, error: Floats, found: Contacts
) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """True where one contact is enough: it osculates, or is a convex vertex, to within the error of the disc.

    A lateral error e hides the second contact where the contacts are closer than (e / r)^(1/3), which is where
    1 - k r is below some (e / r)^(2/3).
    """
    excuse = radius <= 20 * error
    curvature = reference.at(found.cell, found.s)[2]
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        allowed = 1e-4 + 30 * (error / np.maximum(radius, 1e-12)) ** (2 / 3)
        osculates = np.abs(1 - curvature * radius[found.query]) <= allowed[found.query]
    excuse[found.query[osculates]] = True
    convex = np.array([c.point for c in reference.corners if c.turn > 0]).reshape(-1, 2)
    for point in convex:
        excuse |= np.linalg.norm(center - point, axis=1) <= 20 * error
    for point in reference.boundary.end[reference.stalls]:
        # the second contact of a disc r is within some r^2 of such a vertex, closer than the oracle's grid
        excuse[found.query[np.linalg.norm(found.point - point, axis=1) < 1e-5]] = True
    return excuse


def boundary_probes(reference: Reference, per_edge: int, seed: int) -> tuple[Floats, Floats, Floats]:
    """Boundary points with inward normal and curvature: random ones on every edge, near its ends, in normal fans."""
    rng = np.random.default_rng(seed)
    owner = np.repeat(np.arange(len(reference.names)), per_edge + 2)
    f = rng.random((len(reference.names), per_edge + 2))
    f[:, 0], f[:, 1] = 1e-3, 1 - 1e-3
    curves = [full_knots(e) for loop in reference.loops for e in loop]
    u = np.concatenate([k[0] + row * (k[-1] - k[0]) for k, row in zip(curves, f, strict=True)])
    where = [reference.boundary.locate(int(o), float(v)) for o, v in zip(owner, u, strict=True)]
    p, normal, curvature = reference.at(
        np.array([c for c, _ in where], dtype=np.int64), np.array([s for _, s in where])
    )
    fans = [c for c in reference.corners if c.turn < -1e-4]
    fan_p, fan_n = [], []
    for corner in fans:
        # beside a bend that is a vertex to any disc not all of the fan's normals are seen
        seen = reference.normals_beside(corner) if corner.turn > -1.0 else None
        for g in (1e-3, 0.37, 0.71, 1 - 1e-3):
            angle = math.atan2(corner.normal_in[1], corner.normal_in[0]) + g * corner.turn
            n = np.array([math.cos(angle), math.sin(angle)])
            if seen is not None and max(seen[0][0] * n[1] - seen[0][1] * n[0], n[0] * seen[1][1] - n[1] * seen[1][0]) > 0.0:
                continue
            fan_p.append(corner.point)
            fan_n.append(n)
    p = np.vstack([p, np.array(fan_p).reshape(-1, 2)])
    normal = np.vstack([normal, np.array(fan_n).reshape(-1, 2)])
    curvature = np.concatenate([curvature, np.full(len(fan_p), -np.inf)])
    usable = np.isfinite(normal).all(axis=1) & ~np.isnan(curvature)
    for point in reference.boundary.end[reference.stalls]:
        usable &= np.linalg.norm(p - point, axis=1) > 1e-5
    return p[usable], normal[usable], curvature[usable]


def check_coverage(
    report: Report, answer: Answer, reference: Reference, tolerance: float, per_edge: int, seed: int
) -> None:
    """The maximal disc at every probed boundary point is on the returned axis, as a point of (x, y, r)."""
    probes = boundary_probes(reference, per_edge, seed)
    discs = reference.maximal_discs(*probes)
    true = np.column_stack([discs.center, discs.radius])
    off = np.full(len(true), np.inf)
    if answer.segments:
        off = answer.axis.nearest(true)[0]
    for node in answer.node_disc:
        off = np.minimum(off, np.linalg.norm(true - node, axis=1))
    stated = [tolerance if not is_exact(s) else float(s["max_error"]) / answer.size for s in answer.segments]
    limit = EXACT + 10 * reference.floor + max(stated, default=0.0)
    # a disc that touches twice within what may be a vertex to any disc, or osculates there, is on no branch but its own
    way = np.linalg.norm(discs.partner - probes[0], axis=1)
    sharp = (discs.blur < 1e-3) & np.where(way > 0.0, way > 2 * TINY, discs.radius > BEND_RADIUS)
    # the branch into a corner that is taken as smooth is left out: discs that touch on both sides beside it are on that branch
    for corner in reference.flat_corners:
        ways = [np.linalg.norm(p - corner, axis=1) for p in (probes[0], discs.partner)]
        sharp &= np.maximum(*ways) > BESIDE_CORNER
    report.note("axis missing", off[sharp], limit + 2 * discs.blur[sharp], true[sharp])


def contact_parts(reference: Reference, center: Floats, slack: float) -> list[float]:
    """The separate boundary parts within `slack` of touching the largest disc at `center`: the angle each subtends."""
    boundary = reference.boundary
    distance, found = boundary.contacts(center[None], slack)
    found = true_minima(reference, center[None], found)
    limit = distance[0] + slack + 1e-13
    cells, steps = boundary.grid.shape[:2]
    loop_of = np.array([reference.names[o][0] for o in boundary.owner])
    # 1. all points of the grid and all contacts, in the order of the boundary
    cell = np.concatenate([np.repeat(np.arange(cells), steps), found.cell])
    s = np.concatenate([np.tile(np.linspace(0, 1, steps), cells), found.s])
    point = np.vstack([boundary.grid.reshape(-1, 2), found.point])
    order = np.lexsort((s, cell))
    cell, s, point = cell[order], s[order], point[order]
    touching = np.linalg.norm(point - center, axis=1) <= limit
    parts = []
    for loop in range(len(reference.loops)):
        own = np.nonzero(loop_of[cell] == loop)[0]
        on = touching[own]
        if on.all():
            parts.append(2 * math.pi)
        if on.all() or not on.any():
            continue
        own = np.roll(own, -int(np.argmin(on)))
        # 2. neighbours belong together when the boundary half way between them touches, too
        a, b = own[:-1], own[1:]
        linked = touching[a] & touching[b]
        half = np.nonzero(linked & (cell[a] == cell[b]))[0]
        middle = boundary.evaluate(cell[a[half]], 0.5 * (s[a[half]] + s[b[half]]))[0]
        linked[half] = np.linalg.norm(middle - center, axis=1) <= limit
        for run in np.split(np.arange(len(own)), np.nonzero(~linked)[0] + 1):
            if touching[own[run[0]]]:
                rays = point[own[run]] - center
                angle = np.unwrap(np.arctan2(rays[:, 1], rays[:, 0]))
                parts.append(float(abs(angle[-1] - angle[0])))
    return parts


def minima(reference: Reference, center: Floats, slack: float, apart: float) -> Floats:
    """The boundary points of locally smallest distance within `slack` of the smallest that are `apart`, (m, 2)."""
    found = true_minima(reference, center[None], reference.boundary.contacts(center[None], slack)[1]).point
    kept: list[Floats] = []
    for point in found:
        if all(np.linalg.norm(point - other) > apart for other in kept):
            kept.append(point)
    return np.array(kept).reshape(-1, 2)


def check_nodes(report: Report, answer: Answer, reference: Reference) -> None:
    """Every node is what its kind says and has one branch for every gap between its contacts."""
    floor = 10 * reference.floor
    corners = [c for c in reference.corners if c.turn > 0]
    convex = np.array([c.point for c in corners]).reshape(-1, 2)
    resting = reference.boundary.end[
        reference.stalls
    ]  # infinite curvature shrinks discs to nothing at a reflex vertex, too
    bends = np.array([reference.boundary.end[b.before] for b in reference.bends if b.left > 0]).reshape(-1, 2)
    tips = np.concatenate([bends, reference.points_of_bends])
    at_vertex = np.zeros(len(convex), dtype=int)
    inner = [i for i, n in enumerate(answer.nodes) if n["kind"] != "convex_vertex"]
    for i, n in enumerate(answer.nodes):
        if n["kind"] == "convex_vertex":
            gaps = np.linalg.norm(convex - answer.node_disc[i, :2], axis=1)
            pointed = np.linalg.norm(resting - answer.node_disc[i, :2], axis=1)
            bent = np.linalg.norm(tips - answer.node_disc[i, :2], axis=1)
            nearest = min(v.min(initial=np.inf) for v in (gaps, pointed, bent))
            report.note("convex vertex", np.array([nearest, answer.node_disc[i, 2]]), EXACT + floor)
            at_vertex[gaps <= EXACT + floor] += 1
            report.require(
                answer.degree[n["id"]] == 1, f"node {n['id']}: a convex vertex of degree {answer.degree[n['id']]}"
            )
        elif answer.degree[n["id"]] == 1 and len(bends):
            # the tip of a bend that is a vertex to any disc is one, too; it may have several
            tip = np.linalg.norm(bends - answer.node_disc[i, :2], axis=1).min() + answer.node_disc[i, 2]
            gaps = np.linalg.norm(convex - answer.node_disc[i, :2], axis=1)
            at_vertex[(gaps <= EXACT + floor) & (tip <= EXACT + floor)] += 1
    bent = np.array([np.linalg.norm(bends - point, axis=1).min(initial=np.inf) <= EXACT for point in convex], dtype=bool)
    undone = np.array([c.cell in reference.undone for c in corners], dtype=bool)
    lost = (at_vertex == 0) & ~undone | (at_vertex > 1) & ~bent
    report.require(not lost.any(), f"convex vertices that are not one leaf each: {convex[lost].tolist()}")
    if not inner:
        return
    discs = answer.node_disc[inner]
    distance = reference.boundary.contacts(discs[:, :2])[0]
    report.note("node distance - radius", np.abs(distance - discs[:, 2]), EXACT + floor, discs)
    for i in inner:
        n, center = answer.nodes[i], answer.node_disc[i, :2]
        degree, kind = answer.degree[n["id"]], n["kind"]
        # no disc is seen more coarsely than what a small part of its radius is, and that discs within 1e-12 of each other are one
        radius = float(answer.node_disc[i, 2])
        slack = max(min(2e-8, SEEN * radius), ONE_DISC) + 4 * floor
        loose = contact_parts(reference, center, slack)
        tight = contact_parts(reference, center, min(1e-12, SEEN * radius) + reference.floor)
        where = f"node {n['id']} ({kind}, degree {degree}) at {center} r {answer.node_disc[i, 2]:.6g}"
        whole = max(loose) > 2 * math.pi - 1e-2
        # two contacts may be so close that the boundary between them is within the slack, too
        seen = max(len(loose), len(tight))
        if degree > seen:
            seen = max(seen, len(minima(reference, center, slack, min(ONE_PLACE, SEEN * radius))))
        # a disc that reaches both sides of a corner too flat to see has two contacts there, or one if the corner is smooth
        reached = np.abs(np.linalg.norm(reference.flat_corners - center, axis=1) - answer.node_disc[i, 2])
        flat = int(np.count_nonzero(reached < FLAT_REACH * answer.node_disc[i, 2]))
        seen += hidden_feet(answer, n)
        report.require(whole or degree <= seen + flat, f"{where}: only {seen + flat} contacts")
        if answer.node_disc[i, 2] > 1e-4:
            # what is touched within 1e-12 may be a contact of a node beside this one: together they have that many branches
            beside = np.linalg.norm(answer.node_disc - answer.node_disc[i], axis=1) < ONE_CLUSTER
            others = [answer.degree[answer.nodes[k]["id"]] for k in np.flatnonzero(beside) if k != i]
            branches = degree + sum(max(other - 2, 0) for other in others)
            report.require(whole or branches >= min(len(tight), len(loose)) - flat, f"{where}: {len(tight)} contacts")
        report.require(kind != "branch" or degree >= 3, f"{where}: no branch point")
        report.require(kind != "curvature_center" or degree == 1, f"{where}: no leaf")
        report.require(kind != "arc_center" or max(loose) > 1e-3, f"{where}: touches along no arc")
        report.require(kind != "point" or (whole and not answer.segments), f"{where}: the domain is no disc")


def hidden_feet(answer: Answer, node: Json) -> int:
    """Footpoints of a node beside others, nearer than the oracle tells contacts apart (`check_footpoints` judges them)."""
    feet = np.array([f["point"] for f in node["footpoints"]]) / answer.size
    return sum(bool((np.linalg.norm(feet[:i] - foot, axis=1) < ONE_PLACE).any()) for i, foot in enumerate(feet))


def check_footpoints(report: Report, answer: Answer, reference: Reference, tolerance: float) -> None:
    """Footpoints of nodes, and of samples where there are any, lie on their circles."""
    discs, feet, given = [], [], []
    for i, node in enumerate(answer.nodes):
        for foot in node["footpoints"]:
            discs.append(answer.node_disc[i])
            feet.append(foot)
            given.append((np.array(foot["point"]) - answer.origin) / answer.size)
    nodes = len(feet)
    for s in answer.segments:
        samples = s.get("samples")
        if samples:
            for side in ("left", "right"):
                for point, radius, foot in zip(samples["points"], samples["radii"], samples[side], strict=True):
                    discs.append(np.array([*(np.array(point) - answer.origin) / answer.size, radius / answer.size]))
                    feet.append(foot)
    if not feet:
        return
    number = {name: i for i, name in enumerate(reference.names)}
    owner = np.array([number[(f["loop"], f["edge"])] for f in feet], dtype=np.int64)
    points = reference.boundary.points(owner, np.array([f["u"] for f in feet], dtype=float))
    disc = np.array(discs)
    gap = np.abs(np.linalg.norm(points - disc[:, :2], axis=1) - disc[:, 2])
    floor = EXACT + 10 * reference.floor
    # no double names a point better than its neighbours let it: weights of 1e-6 and 1e6 drive an edge far between two of them
    blur = np.zeros(len(feet))
    for step in (-NAMED, NAMED):
        u = np.array([f["u"] for f in feet], dtype=float)
        beside = reference.boundary.points(owner, u + step * np.spacing(np.abs(u)))
        blur = np.maximum(blur, np.linalg.norm(beside - points, axis=1))
    gap = np.maximum(gap - blur, 0.0)
    if given:
        off = np.linalg.norm(points[:nodes] - np.array(given), axis=1)
        report.note("footpoint's point", np.maximum(off - blur[:nodes], 0.0), floor, disc[:nodes])
    report.note("node footpoint", gap[:nodes], floor, disc[:nodes])
    report.note("sample footpoint", gap[nodes:], floor + tolerance, disc[nodes:])


def node_counts(answer: Json) -> tuple[int, int]:
    """(leaves, cycles) of an answer, counted from its segments."""
    ends = [e for s in answer["segments"] if s["start_node"] is not None for e in (s["start_node"], s["end_node"])]
    degree = Counter(ends)
    return sum(d == 1 for d in degree.values()), int(answer["graph"]["cycles"])


def assert_truth(domain: Json, answer: Json, accuracy: float = EXACT) -> None:
    """Known leaves, cycles and exact discs (x, y, r), `accuracy` relative to the size."""
    truth = domain["truth"]
    leaves, cycles = node_counts(answer)
    assert leaves == truth.get("leaves", leaves), f"{leaves} leaves, {truth['leaves']} expected"
    assert cycles == truth.get("cycles", cycles), f"{cycles} cycles, {truth['cycles']} expected"
    known = np.array([disc for chain in truth.get("mat", []) for disc in chain], dtype=float).reshape(-1, 3)
    if not len(known):
        return
    reference = Reference(domain)
    parsed = Answer(answer, reference)
    known = (known - [*parsed.origin, 0.0]) / parsed.size
    off = np.linalg.norm(known[:, None] - parsed.node_disc[None], axis=2).min(axis=1, initial=np.inf)
    if parsed.segments:
        off = np.minimum(off, parsed.axis.nearest(known)[0])
    assert off.max() <= accuracy + 10 * reference.floor, f"a known disc is {off.max():.2e} off"
