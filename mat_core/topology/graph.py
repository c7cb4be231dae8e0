"""The graph of the axis: nodes are leaves and branch points, segments are runs of strips through degree-2 discs.

Steps: 1. strips of no length are contracted (several discs of one n-way branch point were found one by one); 2. nodes are the
discs where one, or three and more, strips end; 3. a depth-first walk from a convex vertex (else a curvature centre, else any
node) lists the segments, directs each from the node met first to the one met later, and so gives the topological order (paper,
section 6); 4. what is left are closed segments without a node (an annulus).

The paper calls the graph acyclic; that holds for the directed one. Its undirected cycle rank is the number of holes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.sites import SiteTable
from mat_core.kernels.jit import inner, jit
from mat_core.kernels.layout import ARC_CONTACT, CURVATURE_LEAF, NEXT, VERTEX_LEAF
from mat_core.tolerances import Tolerances
from mat_core.topology.skeleton import Skeleton
from mat_core.topology.unite import COORDINATE, find, same_disc, unite

BRANCH, CONVEX_VERTEX_NODE, CURVATURE_CENTER, ARC_CENTER, POINT = 0, 1, 2, 3, 4
NODE_KINDS = ("branch", "convex_vertex", "curvature_center", "arc_center", "point")


class AxisGraph(NamedTuple):
    """Nodes, segments as runs of strips, and their order.

    node_disc (N,): disc of each node. node_kind (N,): index into NODE_KINDS. run_start (G + 1,), run_strip (R,), run_forward
    (R,): strips of each segment in order of travel, and whether each is travelled from its disc0 to its disc1. start_node,
    end_node (G,): -1 for a closed segment without a node. order (N,): nodes in topological order. components, cycles: of the
    undirected graph.
    """

    node_disc: NDArray[np.int64]
    node_kind: NDArray[np.int64]
    run_start: NDArray[np.int64]
    run_strip: NDArray[np.int64]
    run_forward: NDArray[np.bool_]
    start_node: NDArray[np.int64]
    end_node: NDArray[np.int64]
    order: NDArray[np.int64]
    components: int
    cycles: int


@inner
def _contact_at(si, contact_start, contact_site, contact_s, d, site, s):
    """The contact of disc d at s on a site; s = 1 is the start of the next site. Contacts of a disc stand in loop order."""
    if s >= 1.0:
        site = si[site, NEXT]
        s = 0.0
    low = contact_start[d]
    high = contact_start[d + 1]
    while low < high:
        middle = (low + high) // 2
        if contact_site[middle] < site or (contact_site[middle] == site and contact_s[middle] < s):
            low = middle + 1
        else:
            high = middle
    found = low < contact_start[d + 1] and contact_site[low] == site and contact_s[low] == s
    return low if found else -1


@jit
def contract(si, disc, kind, strip_i, strip_s, contact_start, contact_site, contact_s, tolerance, parent, strip_alive,
             contact_parent, contact_alive):
    """Step 1: unite the ends of strips of no length; of each pair of contacts that fall together one dies.

    A strip of no length can still have sides (where a footpoint runs along a circle about the disc's own centre): strips that
    ended at the dead contact then end at the living one, so that all of the boundary stays owned.
    """
    for d in range(disc.shape[0]):
        parent[d] = d
    for c in range(contact_site.shape[0]):
        contact_alive[c] = True
        contact_parent[c] = c
    for n in range(strip_i.shape[0]):
        strip_alive[n] = True
        d0 = strip_i[n, 2]
        d1 = strip_i[n, 3]
        leaf = kind[d0] == VERTEX_LEAF or kind[d0] == CURVATURE_LEAF or kind[d1] == VERTEX_LEAF or kind[d1] == CURVATURE_LEAF
        if leaf or d0 == d1 or find(parent, d0) == find(parent, d1) or not same_disc(disc, d0, d1, tolerance):
            continue
        unite(parent, d0, d1)
        strip_alive[n] = False
        for side in range(2):
            a = _contact_at(si, contact_start, contact_site, contact_s, d0, strip_i[n, side], strip_s[n, 2 * side])
            b = _contact_at(si, contact_start, contact_site, contact_s, d1, strip_i[n, side], strip_s[n, 2 * side + 1])
            if a < 0 or b < 0:
                continue
            a = find(contact_parent, a)
            b = find(contact_parent, b)
            if a != b:
                # a joint stays, a contact found next to it goes
                keep = b if contact_s[b] == 0.0 and contact_s[a] != 0.0 else a
                lose = a if keep == b else b
                contact_parent[lose] = keep
                contact_alive[lose] = False
    for n in range(strip_i.shape[0]):
        if strip_alive[n]:
            for corner in range(4):
                side = corner // 2
                site = strip_i[n, side]
                c = _contact_at(si, contact_start, contact_site, contact_s, strip_i[n, 2 + corner % 2], site, strip_s[n, corner])
                kept = find(contact_parent, c) if c >= 0 else c
                if kept == c:
                    continue
                if contact_site[kept] == site:
                    strip_s[n, corner] = contact_s[kept]
                elif contact_site[kept] == si[site, NEXT] and contact_s[kept] == 0.0:
                    strip_s[n, corner] = 1.0
    for d in range(disc.shape[0]):
        parent[d] = find(parent, d)


@inner
def _leave(strip_i, half):
    """Disc at which half-strip `half` starts: strip half // 2, from disc0 if even, from disc1 if odd."""
    return strip_i[half // 2, 2 + half % 2]


@jit
def walk_graph(strip_i, half_start, half_of, kind, used, node_of, order, run_start, run_strip, run_forward, start_node, end_node,
               stack, nodes):
    """Steps 2 to 4 for halves (strip ends) listed by disc in `half_of[half_start[d]:half_start[d+1]]`.

    Fills `node_of` (disc -> node or -1), `order` (discs of the nodes as they are met) and the runs; returns (nodes, runs, strips,
    components, closed runs).
    """
    n_discs = kind.shape[0]
    for d in range(n_discs):
        node_of[d] = -1
    for n in range(strip_i.shape[0]):
        used[n] = False
    runs = 0
    done = 0
    components = 0
    run_start[0] = 0
    for attempt in range(5):
        for seed in range(n_discs):
            degree = half_start[seed + 1] - half_start[seed]
            if degree == 2 or node_of[seed] >= 0:
                continue
            wanted = attempt == 4 or (attempt == 0 and kind[seed] == VERTEX_LEAF) or (
                attempt == 1 and kind[seed] == CURVATURE_LEAF) or (attempt == 2 and kind[seed] == ARC_CONTACT and degree == 1)
            if not wanted:
                continue
            components += 1
            node_of[seed] = nodes
            order[nodes] = seed
            nodes += 1
            top = 0
            stack[0, 0] = seed
            stack[0, 1] = half_start[seed]
            while top >= 0:
                d = stack[top, 0]
                place = stack[top, 1]
                if place == half_start[d + 1]:
                    top -= 1
                    continue
                stack[top, 1] = place + 1
                half = half_of[place]
                if used[half // 2]:
                    continue
                # follow strips through degree-2 discs to the next node
                while True:
                    used[half // 2] = True
                    run_strip[done] = half // 2
                    run_forward[done] = half % 2 == 0
                    done += 1
                    other = _leave(strip_i, half ^ 1)
                    if half_start[other + 1] - half_start[other] != 2:
                        break
                    first = half_of[half_start[other]]
                    half = half_of[half_start[other] + 1] if first == half ^ 1 else first
                new = node_of[other] < 0
                if new:
                    node_of[other] = nodes
                    order[nodes] = other
                    nodes += 1
                start_node[runs] = node_of[d]
                end_node[runs] = node_of[other]
                if node_of[other] < node_of[d]:
                    # met before: directed from there to here
                    start_node[runs] = node_of[other]
                    end_node[runs] = node_of[d]
                    _reverse(run_strip, run_forward, run_start[runs], done)
                runs += 1
                run_start[runs] = done
                if new:
                    top += 1
                    stack[top, 0] = other
                    stack[top, 1] = half_start[other]
    closed = 0
    for n in range(strip_i.shape[0]):
        if used[n]:
            continue
        half = 2 * n
        while not used[half // 2]:
            used[half // 2] = True
            run_strip[done] = half // 2
            run_forward[done] = half % 2 == 0
            done += 1
            other = _leave(strip_i, half ^ 1)
            first = half_of[half_start[other]]
            half = half_of[half_start[other] + 1] if first == half ^ 1 else first
        start_node[runs] = -1
        end_node[runs] = -1
        runs += 1
        run_start[runs] = done
        closed += 1
        components += 1
    return nodes, runs, done, components, closed


@inner
def _reverse(run_strip, run_forward, first, last):
    """Reverse a run in place."""
    a = first
    b = last - 1
    while a <= b:
        strip = run_strip[a]
        forward = run_forward[a]
        run_strip[a] = run_strip[b]
        run_forward[a] = not run_forward[b]
        run_strip[b] = strip
        run_forward[b] = not forward
        a += 1
        b -= 1


def build_graph(t: SiteTable, k: Skeleton, tolerances: Tolerances) -> tuple[Skeleton, AxisGraph]:
    """The contracted skeleton and its graph.

    Parameters
    ----------
    t : SiteTable
    k : Skeleton
        As solved, with strips of no length between discs that are one.
    tolerances : Tolerances
        `same_node` decides what has no length; nothing has that is shorter than the rounding of the input's coordinates.

    Returns
    -------
    Skeleton, AxisGraph
    """
    n_discs = len(k.disc)
    parent = np.empty(n_discs, dtype=np.int64)
    strip_alive = np.empty(len(k.strip_i), dtype=np.bool_)
    contact_alive = np.empty(len(k.contact_site), dtype=np.bool_)
    rounding = COORDINATE * float(np.abs(t.origin).max()) * t.scale
    contract(t.si, k.disc, k.disc_kind, k.strip_i, k.strip_s, k.contact_start, k.contact_site, k.contact_s,
             max(tolerances.same_node, rounding), parent, strip_alive, np.empty(len(k.contact_site), dtype=np.int64),
             contact_alive)
    if not strip_alive.all():
        k = _compress(k, parent, strip_alive, contact_alive)
        n_discs = len(k.disc)
    ends = k.strip_i[:, 2:].reshape(-1)
    half_of = np.argsort(ends, kind="stable")
    half_start = np.searchsorted(ends[half_of], np.arange(n_discs + 1))
    strips = len(k.strip_i)
    node_of = np.empty(n_discs, dtype=np.int64)
    order = np.empty(n_discs, dtype=np.int64)
    run_start = np.empty(strips + 1, dtype=np.int64)
    run_strip = np.empty(strips, dtype=np.int64)
    run_forward = np.empty(strips, dtype=np.bool_)
    start_node = np.empty(strips, dtype=np.int64)
    end_node = np.empty(strips, dtype=np.int64)
    nodes, runs, done, components, closed = walk_graph(
        k.strip_i, half_start, half_of, k.disc_kind, np.empty(strips, dtype=np.bool_), node_of, order, run_start, run_strip,
        run_forward, start_node, end_node, np.empty((n_discs + 1, 2), dtype=np.int64), 0)
    node_disc = order[:nodes]
    degree = (half_start[1:] - half_start[:-1])[node_disc]
    kind = np.where(degree >= 3, BRANCH, np.where(degree == 0, POINT, k.disc_kind[node_disc]))
    cycles = (runs - closed) - nodes + (components - closed) + closed
    return k, AxisGraph(node_disc, kind, run_start[: runs + 1], run_strip[:done], run_forward[:done], start_node[:runs],
                        end_node[:runs], np.arange(nodes), components, int(cycles))


def _compress(k: Skeleton, parent: NDArray[np.int64], strip_alive: NDArray[np.bool_],
              contact_alive: NDArray[np.bool_]) -> Skeleton:
    """The skeleton without contracted strips, united discs and dead contacts."""
    roots, index = np.unique(parent, return_inverse=True)
    kinds = np.zeros(len(roots), dtype=np.int64)
    np.maximum.at(kinds, index, k.disc_kind)
    owner = np.repeat(np.arange(len(k.disc)), np.diff(k.contact_start))
    owner = index[owner[contact_alive]]
    order = np.argsort(owner, kind="stable")
    strip_i = k.strip_i[strip_alive]
    strip_i[:, 2:] = index[strip_i[:, 2:]]
    whole_i = k.whole_i.copy()
    whole_i[:, 1] = index[whole_i[:, 1]]
    return k._replace(
        disc=k.disc[roots], disc_kind=kinds, contact_start=np.searchsorted(owner[order], np.arange(len(roots) + 1)),
        contact_site=k.contact_site[contact_alive][order], contact_s=k.contact_s[contact_alive][order], strip_i=strip_i,
        strip_s=k.strip_s[strip_alive], whole_i=whole_i)
