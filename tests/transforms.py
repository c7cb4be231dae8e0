"""Changes of a domain's description that leave its axis alone, or carry it along: B-spline editing and motions.

Edges are edited in homogeneous coordinates (w x, w y, w): Boehm's knot insertion, and degree elevation span by span,
keep every curve the same point by point, up to rounding.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Json = dict[str, Any]
Edge = dict[str, Any]
Floats = NDArray[np.float64]


# Edges ---------------------------------------------------------------------------------------------------------------
def to_homogeneous(edge: Edge) -> Floats:
    """(n, 3) rows (w x, w y, w)."""
    points = np.array(edge["control_points"], dtype=float)
    weights = np.array(edge.get("weights") or np.ones(len(points)), dtype=float)
    return np.column_stack([points * weights[:, None], weights])


def to_edge(degree: int, knots: Floats, h: Floats, rational: bool) -> Edge:
    """The edge of homogeneous control points."""
    edge: Edge = {
        "degree": degree,
        "control_points": (h[:, :2] / h[:, 2:]).tolist(),
        "knots": [float(k) for k in knots],
    }
    if rational:
        edge["weights"] = h[:, 2].tolist()
    return edge


def knots_of(edge: Edge) -> Floats:
    """The knots of an edge, also where a Bezier left them out."""
    degree = edge["degree"]
    return np.array(edge.get("knots") or [0.0] * (degree + 1) + [1.0] * (degree + 1), dtype=float)


def insert_knot(edge: Edge, u: float) -> Edge:
    """The same curve with one more knot at u, strictly inside or where the multiplicity is not yet full."""
    degree, knots, h = edge["degree"], knots_of(edge), to_homogeneous(edge)
    k = int(np.searchsorted(knots, u, side="right")) - 1
    new = np.empty((len(h) + 1, 3))
    for i in range(len(new)):
        if i <= k - degree:
            new[i] = h[i]
        elif i > k or knots[i] == u:
            new[i] = h[i - 1]
        else:
            a = (u - knots[i]) / (knots[i + degree] - knots[i])
            new[i] = a * h[i] + (1 - a) * h[i - 1]
    return to_edge(degree, np.insert(knots, k + 1, u), new, "weights" in edge)


def split(edge: Edge, u: float) -> list[Edge]:
    """Two edges that meet at parameter u."""
    degree = edge["degree"]
    while np.count_nonzero(knots_of(edge) == u) < degree:
        edge = insert_knot(edge, u)
    knots, h = knots_of(edge), to_homogeneous(edge)
    first = int(np.searchsorted(knots, u, side="left"))
    last = int(np.searchsorted(knots, u, side="right"))
    left = np.append(knots[:last], u)
    right = np.insert(knots[first:], 0, u)
    rational = "weights" in edge
    return [to_edge(degree, left, h[:first], rational), to_edge(degree, right, h[first - 1 :], rational)]


def bezier_pieces(edge: Edge) -> list[Edge]:
    """One edge for every knot span."""
    pieces = [edge]
    for u in np.unique(knots_of(edge))[1:-1]:
        pieces[-1:] = split(pieces[-1], float(u))
    return pieces


def elevated(edge: Edge) -> Edge:
    """The same curve one degree higher; inner knots become as multiple as the new degree."""
    degree, knots = edge["degree"], [float(knots_of(edge)[0])]
    rows: list[Floats] = []
    for piece in bezier_pieces(edge):
        h = to_homogeneous(piece)
        a = (np.arange(degree + 2) / (degree + 1))[:, None]
        raised = a * np.vstack([h[:1], h]) + (1 - a) * np.vstack([h, h[-1:]])
        rows.append(raised if not rows else raised[1:])
        knots += [float(knots_of(piece)[-1])] * (degree + 1)
    return to_edge(
        degree + 1, np.array([knots[0]] * (degree + 2) + knots[1:] + [knots[-1]]), np.vstack(rows), "weights" in edge
    )


def reweighted(edge: Edge, ratio: float = 0.7) -> Edge:
    """The same curve run at another pace: weights in a geometric series for a Bezier, all of them larger otherwise."""
    h = to_homogeneous(edge)
    bezier = len(h) == edge["degree"] + 1
    factors = ratio ** np.arange(len(h)) if bezier else np.full(len(h), 1.0 / ratio)
    return {**edge, "weights": (h[:, 2] * factors).tolist()}


def united(loop: list[Edge]) -> list[Edge]:
    """The loop as one edge of its highest degree, its joints at knots of full multiplicity."""
    degree, rational = max(e["degree"] for e in loop), any("weights" in e for e in loop)
    knots, rows = [0.0] * (degree + 1), np.empty((0, 3))
    for edge in loop:
        while edge["degree"] < degree:
            edge = elevated(edge)
        h, own = to_homogeneous(edge), knots_of(edge)
        own = own - own[0] + knots[-1]
        knots += [*own[degree + 1 : -degree - 1].tolist(), *[float(own[-1])] * degree]
        rows = np.vstack([rows, h[1:] * (rows[-1, 2] / h[0, 2])]) if len(rows) else h
    return [to_edge(degree, np.array([*knots, knots[-1]]), rows, rational)]


def backwards(edge: Edge) -> Edge:
    """The same curve run the other way."""
    knots = knots_of(edge)
    turned = {
        **edge,
        "control_points": edge["control_points"][::-1],
        "knots": (knots[0] + knots[-1] - knots[::-1]).tolist(),
    }
    if "weights" in edge:
        turned["weights"] = edge["weights"][::-1]
    return turned


def inside(edge: Edge, f: float) -> float:
    """A parameter at fraction f of the edge's range that is no knot."""
    knots = knots_of(edge)
    u = float(knots[0] + f * (knots[-1] - knots[0]))
    return u if u not in knots else u + 0.01 * float(knots[-1] - knots[0])


# Domains -------------------------------------------------------------------------------------------------------------
def each_loop(domain: Json, change: Callable[[list[Edge]], list[Edge]]) -> Json:
    """Change every loop."""
    return {**domain, "outer": change(domain["outer"]), "holes": [change(h) for h in domain.get("holes", [])]}


def each_edge(domain: Json, change: Callable[[Edge], list[Edge]]) -> Json:
    """Change every edge into one or more."""
    return each_loop(domain, lambda loop: [new for edge in loop for new in change(edge)])


def mapped(domain: Json, place: Callable[[Floats], Floats], scale: float = 1.0) -> Json:
    """Move all points, and the known discs with them."""

    def move(edge: Edge) -> list[Edge]:
        return [{**edge, "control_points": place(np.array(edge["control_points"], dtype=float)).tolist()}]

    changed = each_edge(domain, move)
    truth = dict(domain.get("truth", {}))
    if "mat" in truth:
        discs = [np.array(chain, dtype=float).reshape(-1, 3) for chain in truth["mat"]]
        truth["mat"] = [np.column_stack([place(d[:, :2]), scale * d[:, 2]]).tolist() for d in discs]
    return {**changed, "truth": truth}


def rotated(domain: Json, angle: float) -> Json:
    """Turned about the origin."""
    c, s = math.cos(angle), math.sin(angle)
    return mapped(domain, lambda p: p @ np.array([[c, s], [-s, c]]))


def shifted(domain: Json, dx: float, dy: float) -> Json:
    """Moved; far from the origin the coordinates lose digits."""
    return mapped(domain, lambda p: p + np.array([dx, dy]))


def scaled(domain: Json, factor: float) -> Json:
    """In another unit."""
    return mapped(domain, lambda p: p * factor, factor)


def mirrored(domain: Json) -> Json:
    """Seen from behind: loops then run the wrong way."""
    return mapped(domain, lambda p: p * np.array([-1.0, 1.0]))


def reversed_loops(domain: Json) -> Json:
    """Every loop run the other way."""
    return each_loop(domain, lambda loop: [backwards(e) for e in loop[::-1]])


def restarted(domain: Json, by: int = 1) -> Json:
    """Loops that start at another edge; a loop of one edge starts in its middle."""

    def turn(loop: list[Edge]) -> list[Edge]:
        if len(loop) == 1:
            a, b = split(loop[0], inside(loop[0], 0.4))
            return [b, a]
        return loop[by % len(loop) :] + loop[: by % len(loop)]

    return each_loop(domain, turn)


def divided(domain: Json, f: float = 0.37) -> Json:
    """Every edge cut in two."""
    return each_edge(domain, lambda e: split(e, inside(e, f)))


def refined(domain: Json, f: float = 0.61) -> Json:
    """A knot more in every edge."""
    return each_edge(domain, lambda e: [insert_knot(e, inside(e, f))])


def raised(domain: Json) -> Json:
    """Every edge one degree higher."""
    return each_edge(domain, lambda e: [elevated(e)])


def holes_turned(domain: Json) -> Json:
    """The holes in another order."""
    holes = domain.get("holes", [])
    return {**domain, "holes": holes[1:] + holes[:1]}


def repaced(domain: Json) -> Json:
    """Every edge with other weights, and another speed along it."""
    return each_edge(domain, lambda e: [reweighted(e)])


def single_edges(domain: Json) -> Json:
    """Every loop as one edge."""
    return each_loop(domain, united)


SAME_PLACE: dict[str, Callable[[Json], Json]] = {
    "reversed": reversed_loops,
    "restarted": restarted,
    "divided": divided,
    "refined": refined,
    "raised": raised,
    "repaced": repaced,
    "single_edges": single_edges,
    "holes_turned": holes_turned,
}


def in_parts(domain: Json, shares: Sequence[float]) -> Json:
    """Every edge given in parts, which end at shares of its range."""

    def cut(edge: Edge) -> list[Edge]:
        rest, parts, done = edge, [], 0.0
        for share in shares:
            first, rest = split(rest, inside(rest, (share - done) / (1.0 - done)))
            parts.append(first)
            done = share
        return [*parts, rest]

    return each_edge({"outer": domain["outer"], "holes": domain.get("holes", [])}, cut)
