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
from mat_core.kernels.layout import ARC_CONTACT, CURVATURE_LEAF, VERTEX_LEAF
from mat_core.kernels.sorting import group
from mat_core.tolerances import Tolerances
from mat_core.topology.contracting import contract
from mat_core.topology.rooms import numbers
from mat_core.topology.skeleton import Skeleton
from mat_core.topology.unite import COORDINATE

Ints = NDArray[np.int64]

BRANCH, CONVEX_VERTEX_NODE, CURVATURE_CENTER, ARC_CENTER, POINT = 0, 1, 2, 3, 4
NODE_KINDS = ("branch", "convex_vertex", "curvature_center", "arc_center", "point")

CONTRACT, WALK = 1, 2  # steps of `draw_graph`

# rows of its room: while it contracts; while it walks, when the former are done with
OF_DISC, OF_CONTACT = range(2)
ENDS, SPARE, HALF_START, HALF_OF, NODE_OF, USED, STACK, STACK_PLACE = range(8)
# rows of what it gives
NODE_DISC, NODE_KIND, ORDER, RUN_START, RUN_STRIP, START_NODE, END_NODE = range(7)


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


@jit
def draw_graph(steps, si, disc, kind, strip_i, strip_s, contact_start, contact_site, contact_s, tolerance, room, strip_alive,
               contact_alive, drawn, run_forward):
    """Steps 1 to 4; returns (strips that died, nodes, runs, strips in them, components, closed runs).

    steps: CONTRACT, WALK; of their sum only the former where strips died, as the skeleton has to be made anew before the walk.
    """
    died = 0
    if steps & CONTRACT:
        died = contract(si, disc, kind, strip_i, strip_s, contact_start, contact_site, contact_s, tolerance, room[OF_DISC],
                        strip_alive, room[OF_CONTACT], contact_alive)
    if died > 0 or not steps & WALK:
        return died, 0, 0, 0, 0, 0
    ends = room[ENDS]
    half_start = room[HALF_START]
    for half in range(2 * strip_i.shape[0]):
        ends[half] = _leave(strip_i, half)
        room[SPARE, half] = half
    group(ends, 2 * strip_i.shape[0], kind.shape[0], half_start, room[HALF_OF], room[SPARE])
    nodes, runs, done, components, closed = _walk_graph(
        strip_i, half_start, room[HALF_OF], kind, room[USED], room[NODE_OF], drawn[NODE_DISC], drawn[RUN_START], drawn[RUN_STRIP],
        run_forward, drawn[START_NODE], drawn[END_NODE], room[STACK], room[STACK_PLACE])
    for n in range(nodes):
        d = drawn[NODE_DISC, n]
        degree = half_start[d + 1] - half_start[d]
        drawn[NODE_KIND, n] = BRANCH if degree >= 3 else (POINT if degree == 0 else kind[d])
        drawn[ORDER, n] = n
    return 0, nodes, runs, done, components, closed


@inner
def _leave(strip_i, half):
    """Disc at which half-strip `half` starts: strip half // 2, from disc0 if even, from disc1 if odd."""
    return strip_i[half // 2, 2 + half % 2]


@inner
def _walk_graph(strip_i, half_start, half_of, kind, used, node_of, order, run_start, run_strip, run_forward, start_node,
                end_node, stack, stack_place):
    """Steps 2 to 4 for halves (strip ends) listed by disc in `half_of[half_start[d]:half_start[d+1]]`.

    Fills `node_of` (disc -> node or -1), `order` (discs of the nodes as they are met) and the runs; returns (nodes, runs, strips,
    components, closed runs).
    """
    n_discs = kind.shape[0]
    for d in range(n_discs):
        node_of[d] = -1
    for n in range(strip_i.shape[0]):
        used[n] = False
    nodes = 0
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
            stack[0] = seed
            stack_place[0] = half_start[seed]
            while top >= 0:
                d = stack[top]
                place = stack_place[top]
                if place == half_start[d + 1]:
                    top -= 1
                    continue
                stack_place[top] = place + 1
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
                    stack[top] = other
                    stack_place[top] = half_start[other]
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
    strip_alive, contact_alive = np.empty(len(k.strip_i), dtype=np.bool_), np.empty(len(k.contact_site), dtype=np.bool_)
    rounding = COORDINATE * max(map(abs, t.origin.tolist())) * t.scale
    shortest = max(tolerances.same_node, rounding)

    def draw(steps: int, k: Skeleton) -> tuple[AxisGraph | None, Ints]:
        strips, discs, contacts = len(k.strip_i), len(k.disc), len(k.contact_site)
        room = numbers(8, max(2 * strips, discs + 1, contacts))
        drawn, run_forward = numbers(7, max(strips + 1, discs)), np.empty(strips, dtype=np.bool_)
        died, nodes, runs, done, components, closed = draw_graph(
            steps, t.si, k.disc, k.disc_kind, k.strip_i, k.strip_s, k.contact_start, k.contact_site, k.contact_s, shortest, room,
            strip_alive, contact_alive, drawn, run_forward)
        if died > 0:
            return None, room[OF_DISC, :discs]
        cycles = (runs - closed) - nodes + (components - closed) + closed
        graph = AxisGraph(drawn[NODE_DISC, :nodes], drawn[NODE_KIND, :nodes], drawn[RUN_START, : runs + 1],
                          drawn[RUN_STRIP, :done], run_forward[:done], drawn[START_NODE, :runs], drawn[END_NODE, :runs],
                          drawn[ORDER, :nodes], components, cycles)
        return graph, room[OF_DISC, :0]

    graph, parent = draw(CONTRACT | WALK, k)
    if graph is None:
        k = _compress(k, parent, strip_alive, contact_alive)
        graph, _ = draw(WALK, k)
    assert graph is not None
    return k, graph


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
