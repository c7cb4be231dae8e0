"""The axis as a graph, counted anew: faces, components, cycles, leaves, degrees, order, and what each node claims to be.

With D discs, S strips, W arcs in whole contact and C contacts, every contact begins one owned interval of the boundary, so
C = 2 S + W; and the domain with h holes is cut into S + W = 1 - h + C - D faces. Both must hold, and say S - D + 1 = h.
"""

from __future__ import annotations

from mat_core.certificate.report import (
    CONNECTED, CYCLES, DEGREES, FACES, LEAVES, MEASURED, NODE_KINDS, ORDER, REFERENCES, SEGMENTS, count_fault, note,
)
from mat_core.kernels.jit import jit
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, K0, K1, PREV

# kinds of nodes
BRANCH, VERTEX, CURVATURE, ARC_CENTRE, POINT = range(5)
LEAF_CURVATURE = 1e-6  # relative difference of 1/r from the curvature at the foot of a curvature leaf


@jit
def _outside(values, low, high):
    """How many integers are not in low .. high - 1."""
    count = 0
    for n in range(values.shape[0]):
        if values[n] < low or values[n] >= high:
            count += 1
    return count


@jit
def _improper(values, columns):
    """How many parameters in the first columns are not in [0, 1]."""
    count = 0
    for n in range(values.shape[0]):
        for c in range(columns):
            if not 0.0 <= values[n, c] <= 1.0:
                count += 1
    return count


@jit
def _rising(starts, rows, count):
    """Whether these are `rows` offsets that begin at 0, never fall, and end at `count`."""
    if starts.shape[0] != rows:
        return False
    good = starts[0] == 0 and starts[rows - 1] == count
    for n in range(1, rows):
        good = good and starts[n] >= starts[n - 1]
    return good


@jit
def check_references(sites, disc, contact_start, contact_site, contact_s, strip_i, strip_s, whole_i, whole_s, node_disc,
                     run_start, run_strip, start_node, end_node, order, knot_start, knots, control_start, control, part_start,
                     part_i, run_ends, report):
    """All indices point to something, all parameters are in [0, 1]: what the other checks rely on. Fills run_ends (G, 2)."""
    discs = disc.shape[0]
    strips = strip_s.shape[0]
    nodes = node_disc.shape[0]
    faults = _outside(contact_site, 0, sites) + _improper(strip_s, 4) + _improper(whole_s, 2)
    for c in range(contact_s.shape[0]):
        if not 0.0 <= contact_s[c] <= 1.0:
            faults += 1
    for m in range(strips):
        for end in range(2):
            if not 0 <= strip_i[m, end] < sites or not 0 <= strip_i[m, 2 + end] < discs:
                faults += 1
    for m in range(whole_i.shape[0]):
        if not 0 <= whole_i[m, 0] < sites or not 0 <= whole_i[m, 1] < discs:
            faults += 1
    for m in range(part_i.shape[0]):
        if not 0 <= part_i[m, 1] < strips:
            faults += 1
    faults += _outside(node_disc, 0, discs) + _outside(run_strip, 0, strips) + _outside(order, 0, nodes)
    faults += _outside(start_node, -1, nodes) + _outside(end_node, -1, nodes)
    runs = start_node.shape[0] + 1
    if not _rising(contact_start, discs + 1, contact_site.shape[0]) or not _rising(run_start, runs, run_strip.shape[0]):
        faults += 1
    if not _rising(knot_start, runs, knots.shape[0]) or not _rising(control_start, runs, control.shape[0]):
        faults += 1
    if not _rising(part_start, runs, part_i.shape[0]):
        faults += 1
    for g in range(start_node.shape[0]):
        run_ends[g, 0] = start_node[g]
        run_ends[g, 1] = end_node[g]
        if (start_node[g] < 0) != (end_node[g] < 0):
            faults += 1
    if faults == 0:
        for g in range(start_node.shape[0]):
            if run_start[g + 1] == run_start[g] or knot_start[g + 1] == knot_start[g] or control_start[g + 1] == control_start[g]:
                faults += 1
    report[REFERENCES, MEASURED] = faults


@jit
def _find(parent, k):
    """Root of k; halves the paths on its way."""
    while parent[k] != k:
        parent[k] = parent[parent[k]]
        k = parent[k]
    return k


@jit
def _components(parent, n, ends, at0, at1):
    """Components of n vertices with the given pairs of ends; rows with a negative end count as a component of their own."""
    for k in range(n):
        parent[k] = k
    count = n
    for m in range(ends.shape[0]):
        if ends[m, at0] < 0:
            count += 1
            continue
        a = _find(parent, ends[m, at0])
        b = _find(parent, ends[m, at1])
        if a != b:
            parent[a] = b
            count -= 1
    return count


@jit
def check_counts(si, holes, disc, contact_site, strip_i, whole_i, run_ends, node_kind, components, cycles, parent, report):
    """Faces, components, cycles and leaves: from strips and discs, from segments and nodes, and as stated."""
    discs = disc.shape[0]
    strips = strip_i.shape[0]
    wholes = whole_i.shape[0]
    contacts = contact_site.shape[0]
    nodes = node_kind.shape[0]
    faces = abs(strips + wholes - (1 - holes + contacts - discs)) + abs(contacts - 2 * strips - wholes)
    note(report, FACES, float(faces), disc[0, 0], disc[0, 1])

    pieces = _components(parent, discs, strip_i, 2, 3)
    x = disc[0, 0]
    y = disc[0, 1]
    for d in range(discs):
        if _find(parent, d) != _find(parent, 0):
            x = disc[d, 0]
            y = disc[d, 1]
            break
    joined = _components(parent, nodes, run_ends, 0, 1)
    note(report, CONNECTED, float(abs(pieces - 1) + abs(joined - 1) + abs(components - 1)), x, y)
    closed = 0
    for g in range(run_ends.shape[0]):
        if run_ends[g, 0] < 0:
            closed += 1
    # a closed segment without a node is one component with one cycle, hence counts as if it had a node
    from_segments = run_ends.shape[0] - nodes - closed + joined
    wrong = abs(strips - discs + pieces - holes) + abs(from_segments - holes) + abs(cycles - holes)
    note(report, CYCLES, float(wrong), x, y)

    corners = 0
    for i in range(si.shape[0]):
        if si[i, CORNER] == CONVEX_VERTEX:
            corners += 1
    for n in range(nodes):
        if node_kind[n] == VERTEX:
            corners -= 1
    note(report, LEAVES, float(abs(corners)), x, y)


@jit
def check_segments(disc, contact_start, strip_i, whole_i, node_disc, run_start, run_strip, run_forward, run_ends, order, degree,
                   whole_count, node_of, incidence, used, report):
    """Every strip is in one segment, every segment is a chain of strips between its nodes, every disc has its strips.

    Fills degree (D,): strips that end at each disc; whole_count (D,); node_of (D,): node of each disc or -1.
    """
    for d in range(disc.shape[0]):
        degree[d] = 0
        whole_count[d] = 0
        node_of[d] = -1
    for m in range(strip_i.shape[0]):
        degree[strip_i[m, 2]] += 1
        degree[strip_i[m, 3]] += 1
        used[m] = 0
    for m in range(whole_i.shape[0]):
        whole_count[whole_i[m, 1]] += 1
    for n in range(node_disc.shape[0]):
        d = node_disc[n]
        incidence[n] = 0
        if node_of[d] >= 0:
            count_fault(report, DEGREES, disc[d, 0], disc[d, 1])
        node_of[d] = n
    for g in range(run_start.shape[0] - 1):
        closed = run_ends[g, 0] < 0
        first = run_strip[run_start[g]]
        begin = strip_i[first, 2 if run_forward[run_start[g]] else 3]
        at = begin
        if not closed:
            incidence[run_ends[g, 0]] += 1
            incidence[run_ends[g, 1]] += 1
            if node_disc[run_ends[g, 0]] != at:
                count_fault(report, SEGMENTS, disc[at, 0], disc[at, 1])
        for step in range(run_start[g], run_start[g + 1]):
            m = run_strip[step]
            used[m] += 1
            inner = step > run_start[g] or closed
            if strip_i[m, 2 if run_forward[step] else 3] != at or (inner and (node_of[at] >= 0 or degree[at] != 2)):
                count_fault(report, SEGMENTS, disc[at, 0], disc[at, 1])
            at = strip_i[m, 3 if run_forward[step] else 2]
        if at != (begin if closed else node_disc[run_ends[g, 1]]):
            count_fault(report, SEGMENTS, disc[at, 0], disc[at, 1])
    for m in range(strip_i.shape[0]):
        if used[m] != 1:
            d = strip_i[m, 2]
            count_fault(report, SEGMENTS, disc[d, 0], disc[d, 1])
    for d in range(disc.shape[0]):
        n = node_of[d]
        wrong = contact_start[d + 1] - contact_start[d] != degree[d] + whole_count[d]
        wrong = wrong or (n >= 0 and incidence[n] != degree[d]) or ((degree[d] == 2) != (n < 0))
        if wrong:
            count_fault(report, DEGREES, disc[d, 0], disc[d, 1])
    _check_order(disc, node_disc, run_ends, order, incidence, report)


@jit
def _check_order(disc, node_disc, run_ends, order, rank, report):
    """`order` lists every node once, and no segment runs against it."""
    nodes = node_disc.shape[0]
    for n in range(nodes):
        rank[n] = -1
    for n in range(order.shape[0]):
        rank[order[n]] = n
    for n in range(nodes):
        if rank[n] < 0 or order.shape[0] != nodes:
            count_fault(report, ORDER, disc[node_disc[n], 0], disc[node_disc[n], 1])
    for g in range(run_ends.shape[0]):
        if run_ends[g, 0] >= 0 and rank[run_ends[g, 0]] > rank[run_ends[g, 1]]:
            d = node_disc[run_ends[g, 0]]
            count_fault(report, ORDER, disc[d, 0], disc[d, 1])


@jit
def check_kinds(si, sf, disc, contact_start, contact_site, contact_s, degree, whole_count, node_disc, node_kind, report):
    """Every node is what its kind says.

    convex_vertex: a leaf of radius 0 at a convex vertex; curvature_center: a leaf whose radius is that of the boundary's curvature
    at its only contact; arc_center: a leaf that holds arcs in whole contact; branch: three strips or more; point: no strip at all.
    """
    for n in range(node_disc.shape[0]):
        d = node_disc[n]
        r = disc[d, 2]
        contacts = contact_start[d + 1] - contact_start[d]
        first = contact_site[contact_start[d]] if contacts > 0 else 0
        at_start = contacts > 0 and contact_s[contact_start[d]] == 0.0
        kind = node_kind[n]
        good = False
        if kind == BRANCH:
            good = degree[d] >= 3 and contacts >= 3 and r > 0.0
        elif kind == VERTEX:
            good = degree[d] == 1 and contacts == 1 and r == 0.0 and at_start and si[first, CORNER] == CONVEX_VERTEX
        elif kind == CURVATURE:
            k = max(sf[first, K0], sf[si[first, PREV], K1])
            good = degree[d] == 1 and contacts == 1 and at_start and r > 0.0 and abs(k * r - 1.0) <= LEAF_CURVATURE
        elif kind == ARC_CENTRE:
            good = degree[d] == 1 and whole_count[d] >= 1 and r > 0.0
        elif kind == POINT:
            good = degree[d] == 0 and whole_count[d] >= 1 and r > 0.0
        if not good:
            count_fault(report, NODE_KINDS, disc[d, 0], disc[d, 1])
