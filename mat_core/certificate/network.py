"""The axis as a graph, counted anew: faces, components, cycles, leaves, degrees, order, kinds of nodes.

With D discs, S strips, W arcs in whole contact and C contacts, every contact begins one owned interval of the boundary,
so
C = 2 S + W; and the domain with h holes is cut into S + W = 1 - h + C - D faces. Both must hold, and say S - D + 1 = h.
"""

from __future__ import annotations

import numpy as np

from mat_core.boundary.sites import SiteTable
from mat_core.certificate.inputs import ARC_CENTRE, BRANCH, CURVATURE, POINT, VERTEX, Discs, Ints, Network
from mat_core.certificate.report import Report
from mat_core.kernels.jit import jit
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, K0, K1, PREV

LEAF_CURVATURE = 1e-6  # relative difference of 1/r from the curvature at the foot of a curvature leaf


@jit
def label_components(ends, label):
    """Components of vertices 0 .. n-1 joined by pairs `ends`: fills label (n,), one for each; returns how many."""
    n = label.shape[0]
    for k in range(n):
        label[k] = k
    count = n
    for m in range(ends.shape[0]):
        a = ends[m, 0]
        b = ends[m, 1]
        while label[a] != a:
            label[a] = label[label[a]]
            a = label[a]
        while label[b] != b:
            label[b] = label[label[b]]
            b = label[b]
        if a != b:
            label[max(a, b)] = min(a, b)
            count -= 1
    # roots are smaller than what hangs on them
    for k in range(n):
        label[k] = label[label[k]]
    return count


def check_counts(t: SiteTable, skeleton: Discs, graph: Network, report: Report) -> None:
    """Faces, components, cycles and leaves: from strips and discs, from segments and nodes, and as stated."""
    disc = skeleton.disc
    holes = len(t.loop_start) - 2
    discs = len(disc)
    strips = len(skeleton.strip_i)
    wholes = len(skeleton.whole_i)
    contacts = len(skeleton.contact_site)
    faults = abs(strips + wholes - (1 - holes + contacts - discs)) + abs(contacts - 2 * strips - wholes)
    report.faults("faces", [faults], disc)

    label = np.empty(discs, dtype=np.int64)
    pieces = label_components(np.ascontiguousarray(skeleton.strip_i[:, 2:]), label)
    elsewhere = disc[int((label != label[0]).argmax()) :]
    nodes = len(graph.node_disc)
    ends = np.stack((graph.start_node, graph.end_node), axis=1)
    open_ends = ends[ends[:, 0] >= 0]
    joined = label_components(open_ends, np.empty(nodes, dtype=np.int64))
    closed = len(ends) - len(open_ends)
    # a closed segment without a node is one component with one cycle
    report.faults("connected", [pieces - 1, joined + closed - 1, graph.components - 1], elsewhere)
    cycles = (strips - discs + pieces, len(open_ends) - nodes + joined + closed, graph.cycles)
    report.faults("cycles", [found - holes for found in cycles], elsewhere)

    corners = t.si[:, CORNER] == CONVEX_VERTEX
    leaves = graph.node_kind == VERTEX
    report.faults("leaves", [np.count_nonzero(leaves) - np.count_nonzero(corners)], disc[graph.node_disc[leaves]])


def check_segments(skeleton: Discs, graph: Network, report: Report) -> tuple[Ints, Ints]:
    """Every strip is in one segment, every segment is a chain of strips between its nodes, every disc has its strips.

    Returns strips that end at each disc, and arcs in whole contact with it.
    """
    disc, strip_i = skeleton.disc, skeleton.strip_i
    discs = len(disc)
    nodes = len(graph.node_disc)
    degree = np.bincount(strip_i[:, 2:].ravel(), minlength=discs)
    wholes = np.bincount(skeleton.whole_i[:, 1], minlength=discs)
    nodes_at = np.bincount(graph.node_disc, minlength=discs)
    inner = (nodes_at == 0) & (degree == 2)

    # chains: each strip begins where the one before it ended
    report.faults("segments", np.bincount(graph.run_strip, minlength=len(strip_i)) != 1, disc[strip_i[:, 2]])
    forward = graph.run_forward
    travelled = strip_i[graph.run_strip]
    begin = np.where(forward, travelled[:, 2], travelled[:, 3])
    end = np.where(forward, travelled[:, 3], travelled[:, 2])
    first = graph.run_start[:-1]
    last = graph.run_start[1:] - 1
    is_open = graph.start_node >= 0
    is_first = np.zeros(len(begin), dtype=np.bool_)
    is_first[first] = True
    joined = (begin[1:] == end[:-1]) & inner[begin[1:]]
    report.faults("segments", ~(joined | is_first[1:]), disc[begin[1:]])
    start = np.where(is_open, graph.node_disc[graph.start_node] if nodes else -1, end[last])
    stop = np.where(is_open, graph.node_disc[graph.end_node] if nodes else -1, begin[first])
    unclosed = ~is_open & ~inner[begin[first]]
    report.faults("segments", (start != begin[first]) | (stop != end[last]) | unclosed, disc[begin[first]])

    # every disc has its strips; every node its segments
    incidence = np.bincount(np.concatenate((graph.start_node[is_open], graph.end_node[is_open])), minlength=nodes)
    wrong = np.diff(skeleton.contact_start) != degree + wholes
    wrong |= nodes_at != (degree != 2)
    report.faults("degrees", wrong, disc)
    report.faults("degrees", incidence != degree[graph.node_disc], disc[graph.node_disc])

    rank = np.full(nodes, -1)
    rank[graph.order] = np.arange(len(graph.order))
    missing = rank < 0
    if len(graph.order) != nodes:
        missing[:] = True
    report.faults("order", missing, disc[graph.node_disc])
    against = rank[graph.start_node[is_open]] > rank[graph.end_node[is_open]]
    report.faults("order", against, disc[begin[first[is_open]]])
    return degree, wholes


def check_kinds(t: SiteTable, skeleton: Discs, graph: Network, degree: Ints, wholes: Ints, report: Report) -> None:
    """Every node is what its kind says.

    convex_vertex: a leaf of radius 0 at a convex vertex; curvature_center: a leaf whose radius is that of the
    boundary's curvature at its only contact; arc_center: a leaf that holds arcs in whole contact; branch: three strips
    or more; point: no strip at all.
    """
    if not len(graph.node_disc):
        report.faults("node_kinds", [0], skeleton.disc)
        return
    d = graph.node_disc
    kind = graph.node_kind
    r = skeleton.disc[d, 2]
    begin = skeleton.contact_start[d]
    contacts = skeleton.contact_start[d + 1] - begin
    begin = np.minimum(begin, max(len(skeleton.contact_site) - 1, 0))
    site = skeleton.contact_site[begin]
    leaf = (degree[d] == 1) & (contacts == 1) & (skeleton.contact_s[begin] == 0.0)
    at_corner = t.si[site, CORNER] == CONVEX_VERTEX
    k = np.maximum(t.sf[site, K0], t.sf[t.si[site, PREV], K1])
    curved = np.abs(np.where(np.isfinite(k), k, 0.0) * r - 1.0) <= LEAF_CURVATURE
    holds = (wholes[d] >= 1) & (r > 0.0)
    good = (
        ((kind == BRANCH) & (degree[d] >= 3) & (contacts >= 3) & (r > 0.0))
        | ((kind == VERTEX) & leaf & (r == 0.0) & at_corner)
        | ((kind == CURVATURE) & leaf & (r > 0.0) & curved)
        | ((kind == ARC_CENTRE) & (degree[d] == 1) & holds)
        | ((kind == POINT) & (degree[d] == 0) & holds)
    )
    report.faults("node_kinds", ~good, skeleton.disc[d])
