"""What is judged, as plain arrays: the judge knows the fields it reads, not the modules that made them.

Every reference is followed only after `dangling_references` found all of them sound.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.jit import inner
from mat_core.kernels.layout import DEG, NEXT, PREV, SiteInts
from mat_core.model.edges import HIGHEST_DEGREE

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

# kinds of nodes
BRANCH, VERTEX, CURVATURE, ARC_CENTRE, POINT = range(5)


class Boundary(NamedTuple):
    """The sites, in normalised coordinates: columns of si and sf in `mat_core.kernels.layout`; loop_start (L + 1,)."""

    si: SiteInts
    sf: Floats
    cp: Floats
    loop_start: Ints


class Edges(NamedTuple):
    """The input's edges; all empty when the domain is not at hand.

    cp (n, 3): x, y, weight. loop_start (L + 1,): edges of each loop.
    """

    degree: Ints
    knot_start: Ints
    knots: Floats
    cp_start: Ints
    cp: Floats
    loop_start: Ints


class Discs(NamedTuple):
    """Discs, contacts, strips and arcs in whole contact; normalised coordinates.

    disc (D, 3): x, y, r; the contacts of disc d are contact_start[d] to contact_start[d + 1] - 1 of contact_site and contact_s.
    strip_i (S, 4): right site, left site, disc at the beginning, disc at the end; strip_s (S, 4): from, to on the right (rising);
    from, to on the left (falling). whole_i (W, 2): site, disc; whole_s (W, 2): from, to.
    """

    disc: Floats
    contact_start: Ints
    contact_site: Ints
    contact_s: Floats
    strip_i: Ints
    strip_s: Floats
    whole_i: Ints
    whole_s: Floats


class Network(NamedTuple):
    """Nodes and segments, each segment a run of strips.

    node_disc, node_kind (N,): BRANCH, VERTEX, CURVATURE, ARC_CENTRE or POINT. run_start (G + 1,): first strip of each segment in
    run_strip (R,), in order of travel, run_forward (R,): whether from its beginning. start_node, end_node (G,): -1 when the
    segment is closed without one. order (N,): topological. components, cycles: as stated.
    """

    node_disc: Ints
    node_kind: Ints
    run_start: Ints
    run_strip: Ints
    run_forward: NDArray[np.bool_]
    start_node: Ints
    end_node: Ints
    order: Ints
    components: int
    cycles: int


class Curves(NamedTuple):
    """Curves of the segments, rational B-splines in (x, y, r) over [0, 1]; normalised coordinates.

    cp (n, 4): x, y, r, weight (not multiplied by it). max_error (G,): stated, in (x, y, r) together. part_i (P, 2 or more): its
    column 1 is the strip; part_f (P, 2 or more): columns 0 and 1 are the ends of the piece in t.
    """

    degree: Ints
    knot_start: Ints
    knots: Floats
    cp_start: Ints
    cp: Floats
    max_error: Floats
    part_start: Ints
    part_i: Ints
    part_f: Floats


_NO_NUMBERS = np.empty(0, dtype=np.int64)
NOTHING = (_NO_NUMBERS, _NO_NUMBERS, np.empty(0), _NO_NUMBERS, np.empty((0, 3)), _NO_NUMBERS)  # `Edges` when no domain is at hand

# The fields of each kind from anything that has them, as plain tuples, which kernels take twice as fast as named ones; a kernel
# makes them named again: t = Boundary(*t)
Taken = Callable[[object], tuple[Any, ...]]
boundary_of: Taken = attrgetter(*Boundary._fields)
edges_of: Taken = attrgetter(*Edges._fields)
discs_of: Taken = attrgetter(*Discs._fields)
network_of: Taken = attrgetter(*Network._fields)
curves_of: Taken = attrgetter(*Curves._fields)


@inner
def _out_of_range(values, low, high):
    """1 if an integer is not in low .. high - 1, else 0."""
    for n in range(values.shape[0]):
        if values[n] < low or values[n] >= high:
            return 1
    return 0


@inner
def _column_out_of_range(values, column, low, high):
    """The same for a column."""
    for n in range(values.shape[0]):
        if values[n, column] < low or values[n, column] >= high:
            return 1
    return 0


@inner
def _no_parameters(values, columns):
    """1 if a number in the first columns is not in [0, 1], else 0."""
    for n in range(values.shape[0]):
        for c in range(columns):
            if not 0.0 <= values[n, c] <= 1.0:
                return 1
    return 0


@inner
def _no_offsets(starts, rows, count, least):
    """1 unless these are `rows` offsets from 0 to `count` that rise by `least` or more, else 0."""
    if starts.shape[0] != rows or starts[0] != 0 or starts[rows - 1] != count:
        return 1
    for n in range(1, rows):
        if starts[n] - starts[n - 1] < least:
            return 1
    return 0


@inner
def dangling_references(t, k, g, c):
    """How many tables hold indices or parameters that point to nothing, or have too few rows; the rest relies on 0."""
    sites = t.si.shape[0]
    discs = k.disc.shape[0]
    strips = k.strip_i.shape[0]
    nodes = g.node_disc.shape[0]
    runs = g.start_node.shape[0]
    contacts = k.contact_site.shape[0]
    wrong = 0
    # numbers of rows
    if discs == 0:
        wrong += 1
    if k.strip_s.shape[0] != strips or k.whole_s.shape[0] != k.whole_i.shape[0]:
        wrong += 1
    if k.contact_s.shape[0] != contacts:
        wrong += 1
    if c.part_f.shape[0] != c.part_i.shape[0]:
        wrong += 1
    if g.node_kind.shape[0] != nodes or g.run_forward.shape[0] != g.run_strip.shape[0]:
        wrong += 1
    if g.end_node.shape[0] != runs or c.degree.shape[0] != runs or c.max_error.shape[0] != runs:
        wrong += 1
    # offsets
    wrong += _no_offsets(t.loop_start, t.loop_start.shape[0], sites, 1)
    wrong += _no_offsets(k.contact_start, discs + 1, contacts, 0)
    wrong += _no_offsets(g.run_start, runs + 1, g.run_strip.shape[0], 1)
    wrong += _no_offsets(c.knot_start, runs + 1, c.knots.shape[0], 0)
    wrong += _no_offsets(c.cp_start, runs + 1, c.cp.shape[0], 0)
    wrong += _no_offsets(c.part_start, runs + 1, c.part_i.shape[0], 0)
    if wrong > 0:
        return wrong
    # indices and parameters; degrees that there is room for
    wrong += _column_out_of_range(t.si, DEG, 0, HIGHEST_DEGREE + 1) + _out_of_range(c.degree, 0, HIGHEST_DEGREE + 1)
    wrong += _column_out_of_range(t.si, NEXT, 0, sites) + _column_out_of_range(t.si, PREV, 0, sites)
    wrong += _out_of_range(k.contact_site, 0, sites)
    for n in range(contacts):
        if not 0.0 <= k.contact_s[n] <= 1.0:
            wrong += 1
            break
    wrong += _column_out_of_range(k.strip_i, 0, 0, sites) + _column_out_of_range(k.strip_i, 1, 0, sites)
    wrong += _column_out_of_range(k.strip_i, 2, 0, discs) + _column_out_of_range(k.strip_i, 3, 0, discs)
    wrong += _column_out_of_range(k.whole_i, 0, 0, sites) + _column_out_of_range(k.whole_i, 1, 0, discs)
    wrong += _no_parameters(k.strip_s, 4) + _no_parameters(k.whole_s, 2)
    wrong += _out_of_range(g.node_disc, 0, discs) + _out_of_range(g.order, 0, nodes) + _out_of_range(g.run_strip, 0, strips)
    wrong += _out_of_range(g.start_node, -1, nodes) + _out_of_range(g.end_node, -1, nodes)
    for n in range(runs):
        if (g.start_node[n] < 0) != (g.end_node[n] < 0):
            wrong += 1
            break
    return wrong + _column_out_of_range(c.part_i, 1, 0, strips)
