"""The axis as a graph, counted anew: faces, components, cycles, leaves, degrees, order, kinds of nodes.

With D discs, S strips, W arcs in whole contact and C contacts, every contact begins one owned interval of the boundary,
so
C = 2 S + W; and the domain with h holes is cut into S + W = 1 - h + C - D faces. Both must hold, and say S - D + 1 = h.
"""

from __future__ import annotations

import math

from mat_core.certificate.inputs import ARC_CENTRE, BRANCH, CURVATURE, POINT, VERTEX
from mat_core.certificate.report import CONNECTED, CYCLES, DEGREES, FACES, LEAVES, NODE_KINDS, ORDER, SEGMENTS, fault
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, K0, K1, PREV

LEAF_CURVATURE = 1e-6  # relative difference of 1/r from the curvature at the foot of a curvature leaf


@inner
def _joined(label, a, b):
    """Join the trees of a and b, whose roots are their smallest members; 1 if they were apart, else 0."""
    while label[a] != a:
        label[a] = label[label[a]]
        a = label[a]
    while label[b] != b:
        label[b] = label[label[b]]
        b = label[b]
    if a == b:
        return 0
    label[max(a, b)] = min(a, b)
    return 1


@inner
def check_counts(t, k, g, label, figures):
    """Faces, components, cycles and leaves: from strips and discs, from segments and nodes, and as stated.

    label: room for a number of each disc, or of each node if these are more.
    """
    holes = t.loop_start.shape[0] - 2
    discs = k.disc.shape[0]
    strips = k.strip_i.shape[0]
    wholes = k.whole_i.shape[0]
    contacts = k.contact_site.shape[0]
    wrong = abs(strips + wholes - (1 - holes + contacts - discs)) + abs(contacts - 2 * strips - wholes)
    fault(figures, FACES, wrong, k.disc[0, 0], k.disc[0, 1])

    for d in range(discs):
        label[d] = d
    pieces = discs
    for m in range(strips):
        pieces -= _joined(label, k.strip_i[m, 2], k.strip_i[m, 3])
    apart = 0
    for d in range(discs):
        # roots are smaller than what hangs on them
        label[d] = label[label[d]]
        if apart == 0 and label[d] != label[0]:
            apart = d
    x = k.disc[apart, 0]
    y = k.disc[apart, 1]

    nodes = g.node_disc.shape[0]
    for n in range(nodes):
        label[n] = n
    joined = nodes
    closed = 0
    for n in range(g.start_node.shape[0]):
        if g.start_node[n] < 0:
            closed += 1
        else:
            joined -= _joined(label, g.start_node[n], g.end_node[n])
    is_open = g.start_node.shape[0] - closed
    # a closed segment without a node is one component with one cycle
    fault(figures, CONNECTED, abs(pieces - 1) + abs(joined + closed - 1) + abs(g.components - 1), x, y)
    found = abs(strips - discs + pieces - holes) + abs(is_open - nodes + joined + closed - holes) + abs(g.cycles - holes)
    fault(figures, CYCLES, found, x, y)

    corners = 0
    for i in range(t.si.shape[0]):
        if t.si[i, CORNER] == CONVEX_VERTEX:
            corners += 1
    for n in range(nodes):
        if g.node_kind[n] == VERTEX:
            corners -= 1
            x = k.disc[g.node_disc[n], 0]
            y = k.disc[g.node_disc[n], 1]
    fault(figures, LEAVES, abs(corners), x, y)


@inner
def check_segments(k, g, degree, wholes, nodes_at, uses, rank, incidence, figures):
    """Every strip is in one segment, every segment is a chain of strips between its nodes, every disc has its strips.

    Fills for each disc `degree`, strips that end there, `wholes`, arcs in whole contact with it, and `nodes_at`; the other arrays
    are room for a number of each strip, node and node.
    """
    discs = k.disc.shape[0]
    nodes = g.node_disc.shape[0]
    for d in range(discs):
        degree[d] = 0
        wholes[d] = 0
        nodes_at[d] = 0
    for m in range(k.strip_i.shape[0]):
        degree[k.strip_i[m, 2]] += 1
        degree[k.strip_i[m, 3]] += 1
        uses[m] = 0
    for m in range(k.whole_i.shape[0]):
        wholes[k.whole_i[m, 1]] += 1
    for n in range(nodes):
        nodes_at[g.node_disc[n]] += 1
        rank[n] = -1
        incidence[n] = 0
    for m in range(g.run_strip.shape[0]):
        uses[g.run_strip[m]] += 1
    for m in range(k.strip_i.shape[0]):
        d = k.strip_i[m, 2]
        fault(figures, SEGMENTS, 1 if uses[m] != 1 else 0, k.disc[d, 0], k.disc[d, 1])
    fault(figures, SEGMENTS, 0, 0.0, 0.0)
    for n in range(g.order.shape[0]):
        rank[g.order[n]] = n
    fault(figures, ORDER, 0, 0.0, 0.0)
    for n in range(nodes):
        d = g.node_disc[n]
        missing = rank[n] < 0 or g.order.shape[0] != nodes
        fault(figures, ORDER, 1 if missing else 0, k.disc[d, 0], k.disc[d, 1])
    for run in range(g.start_node.shape[0]):
        _check_run(k, g, run, degree, nodes_at, rank, incidence, figures)

    # every disc has its strips; every node its segments
    for d in range(discs):
        wrong = k.contact_start[d + 1] - k.contact_start[d] != degree[d] + wholes[d]
        wrong = wrong or nodes_at[d] != (1 if degree[d] != 2 else 0)
        fault(figures, DEGREES, 1 if wrong else 0, k.disc[d, 0], k.disc[d, 1])
    for n in range(nodes):
        d = g.node_disc[n]
        fault(figures, DEGREES, 1 if incidence[n] != degree[d] else 0, k.disc[d, 0], k.disc[d, 1])


@inner
def _check_run(k, g, run, degree, nodes_at, rank, incidence, figures):
    """Each strip of a segment begins where the one before it ended; the first and the last one at its nodes."""
    begun = -1
    reached = -1
    for m in range(g.run_start[run], g.run_start[run + 1]):
        strip = g.run_strip[m]
        begin = k.strip_i[strip, 2] if g.run_forward[m] else k.strip_i[strip, 3]
        if reached < 0:
            begun = begin
        elif begin != reached or nodes_at[begin] != 0 or degree[begin] != 2:
            fault(figures, SEGMENTS, 1, k.disc[begin, 0], k.disc[begin, 1])
        reached = k.strip_i[strip, 3] if g.run_forward[m] else k.strip_i[strip, 2]
    start = g.start_node[run]
    stop = g.end_node[run]
    if start < 0:
        wrong = reached != begun or nodes_at[begun] != 0 or degree[begun] != 2
    else:
        wrong = g.node_disc[start] != begun or g.node_disc[stop] != reached
        incidence[start] += 1
        incidence[stop] += 1
        fault(figures, ORDER, 1 if rank[start] > rank[stop] else 0, k.disc[begun, 0], k.disc[begun, 1])
    fault(figures, SEGMENTS, 1 if wrong else 0, k.disc[begun, 0], k.disc[begun, 1])


@inner
def check_kinds(t, k, g, degree, wholes, figures):
    """Every node is what its kind says.

    convex_vertex: a leaf of radius 0 at a convex vertex; curvature_center: a leaf whose radius is that of the
    boundary's curvature at its only contact; arc_center: a leaf that holds arcs in whole contact; branch: three strips
    or more; point: no strip at all.
    """
    fault(figures, NODE_KINDS, 0, 0.0, 0.0)
    for n in range(g.node_disc.shape[0]):
        d = g.node_disc[n]
        kind = g.node_kind[n]
        r = k.disc[d, 2]
        first = k.contact_start[d]
        contacts = k.contact_start[d + 1] - first
        good = False
        if kind == BRANCH:
            good = degree[d] >= 3 and contacts >= 3 and r > 0.0
        elif kind == ARC_CENTRE:
            good = degree[d] == 1 and wholes[d] >= 1 and r > 0.0
        elif kind == POINT:
            good = degree[d] == 0 and wholes[d] >= 1 and r > 0.0
        elif degree[d] == 1 and contacts == 1 and k.contact_s[first] == 0.0:
            site = k.contact_site[first]
            if kind == VERTEX:
                good = r == 0.0 and t.si[site, CORNER] == CONVEX_VERTEX
            elif kind == CURVATURE:
                curvature = max(t.sf[site, K0], t.sf[t.si[site, PREV], K1])
                good = r > 0.0 and math.isfinite(curvature) and abs(curvature * r - 1.0) <= LEAF_CURVATURE
        fault(figures, NODE_KINDS, 0 if good else 1, k.disc[d, 0], k.disc[d, 1])
