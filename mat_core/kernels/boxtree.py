"""A binary tree of boxes over the sites in loop order, and the maximal-disc query that walks it.

Neighbours on a loop are near each other in the plane, so loop order needs no sorting: leaf l holds sites LEAF*l .. LEAF*l+LEAF-1,
node v has the children 2v and 2v+1, the root is 1, the leaves start at `tree.shape[0] // 2`.
"""

from __future__ import annotations

import math

from mat_core.kernels.curve import evaluate
from mat_core.kernels.disc import touch
from mat_core.kernels.jit import jit
from mat_core.kernels.layout import FAN, KIND, NEXT, PREV, V0, V1, X0, X1, XMAX, XMIN, Y0, Y1, YMAX, YMIN

LEAF = 4
STACK = 128  # twice the depth of a tree over 2**60 sites
ROUNDING = 1e-15  # of a centre, in normalised coordinates


def tree_rows(n_sites: int) -> int:
    """Rows of the tree for n sites: twice the number of leaves, a power of two."""
    leaves = 1
    while leaves * LEAF < n_sites:
        leaves *= 2
    return 2 * leaves


@jit
def build_tree(sf, tree):
    """Fill `tree` (rows, 4) with boxes xmin, ymin, xmax, ymax; an empty leaf has xmin = inf."""
    n = sf.shape[0]
    leaves = tree.shape[0] // 2
    for leaf in range(leaves):
        x0 = y0 = math.inf
        x1 = y1 = -math.inf
        for i in range(leaf * LEAF, min(n, leaf * LEAF + LEAF)):
            x0 = min(x0, sf[i, XMIN])
            y0 = min(y0, sf[i, YMIN])
            x1 = max(x1, sf[i, XMAX])
            y1 = max(y1, sf[i, YMAX])
        v = leaves + leaf
        tree[v, 0] = x0
        tree[v, 1] = y0
        tree[v, 2] = x1
        tree[v, 3] = y1
    for v in range(leaves - 1, 0, -1):
        tree[v, 0] = min(tree[2 * v, 0], tree[2 * v + 1, 0])
        tree[v, 1] = min(tree[2 * v, 1], tree[2 * v + 1, 1])
        tree[v, 2] = max(tree[2 * v, 2], tree[2 * v + 1, 2])
        tree[v, 3] = max(tree[2 * v, 3], tree[2 * v + 1, 3])


@jit
def box_distance_sq(cx, cy, x0, y0, x1, y1):
    """Squared distance of a point to a box; infinite for an empty box."""
    dx = max(x0 - cx, 0.0, cx - x1)
    dy = max(y0 - cy, 0.0, cy - y1)
    return dx * dx + dy * dy


@jit
def touch_candidate(si, sf, cp, i, j, px, py, d0x, d0y, d1x, d1y, nx, ny):
    """`touch` of site j from the point p of site i, about a shared vertex if there is one (d0, d1: p relative to i's ends)."""
    start = si[j, V0] == si[i, V0] or si[j, V1] == si[i, V0]
    end = si[j, V0] == si[i, V1] or si[j, V1] == si[i, V1]
    if start and end:
        start = d0x * d0x + d0y * d0y <= d1x * d1x + d1y * d1y
    if start:
        return touch(si, sf, cp, j, 0.0, 1.0, sf[i, X0], sf[i, Y0], d0x, d0y, nx, ny)
    if end:
        return touch(si, sf, cp, j, 0.0, 1.0, sf[i, X1], sf[i, Y1], d1x, d1y, nx, ny)
    return touch(si, sf, cp, j, 0.0, 1.0, px, py, 0.0, 0.0, nx, ny)


@jit
def query(si, sf, cp, tree, stack, i, s, nx, ny, skip, hint, k_low):
    """The first site that the growing disc tangent at s on site i, with inward normal n, touches: (phi, site, s_site).

    Sites `i` and `skip` are left out; `hint` is tried first; `k_low` > 0 is a lower bound on the answer (no disc of the domain
    is larger than 1 / k_low). Returns site -1 if nothing has phi > k_low.
    """
    px, py, tx, ty, k, speed = evaluate(si, sf, cp, i, s, 0.0, 0.0)
    d0x, d0y, tx, ty, k, speed = evaluate(si, sf, cp, i, s, sf[i, X0], sf[i, Y0])
    d1x, d1y, tx, ty, k, speed = evaluate(si, sf, cp, i, s, sf[i, X1], sf[i, Y1])
    best = k_low
    best_j = -1
    best_s = 0.0
    if hint >= 0 and hint != i and hint != skip:
        phi, sj = touch_candidate(si, sf, cp, i, hint, px, py, d0x, d0y, d1x, d1y, nx, ny)
        if phi > best:
            best = phi
            best_j = hint
            best_s = sj
    r = 1.0 / best
    limit = (r + ROUNDING) * (r + ROUNDING)
    cx = px + r * nx
    cy = py + r * ny
    n = si.shape[0]
    leaves = tree.shape[0] // 2
    top = 0
    stack[0] = 1
    while top >= 0:
        v = stack[top]
        top -= 1
        if box_distance_sq(cx, cy, tree[v, 0], tree[v, 1], tree[v, 2], tree[v, 3]) >= limit:
            continue
        if v < leaves:
            left = box_distance_sq(cx, cy, tree[2 * v, 0], tree[2 * v, 1], tree[2 * v, 2], tree[2 * v, 3])
            right = box_distance_sq(
                cx, cy, tree[2 * v + 1, 0], tree[2 * v + 1, 1], tree[2 * v + 1, 2], tree[2 * v + 1, 3])
            near = 2 * v if left <= right else 2 * v + 1
            top += 1
            stack[top] = 4 * v + 1 - near
            top += 1
            stack[top] = near
            continue
        first = (v - leaves) * LEAF
        for j in range(first, min(n, first + LEAF)):
            if j == i or j == skip or j == hint:
                continue
            if box_distance_sq(cx, cy, sf[j, XMIN], sf[j, YMIN], sf[j, XMAX], sf[j, YMAX]) >= limit:
                continue
            phi, sj = touch_candidate(si, sf, cp, i, j, px, py, d0x, d0y, d1x, d1y, nx, ny)
            if phi > best:
                best = phi
                best_j = j
                best_s = sj
                r = 1.0 / best
                limit = (r + ROUNDING) * (r + ROUNDING)
                cx = px + r * nx
                cy = py + r * ny
    # a contact at the end of a site is tangent there only if the site beyond the joint does not take it over; a fan passes it on
    forward = best_s >= 1.0
    while best_j >= 0 and (best_s >= 1.0 if forward else best_s <= 0.0):
        beyond = si[best_j, NEXT] if forward else si[best_j, PREV]
        if beyond == i or beyond == skip:
            break
        phi, sj = touch_candidate(si, sf, cp, i, beyond, px, py, d0x, d0y, d1x, d1y, nx, ny)
        inside = 0.0 < sj < 1.0
        through = si[beyond, KIND] == FAN and (sj >= 1.0 if forward else sj <= 0.0)
        if phi < best * (1.0 - 1e-12) or not (inside or through):
            break
        best_j = beyond
        best_s = sj
    return best, best_j, best_s
