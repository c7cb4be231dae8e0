"""A binary tree of slanted boxes over the sites, and the maximal-disc query that walks it.

Leaf l holds one site, node v has the children 2v and 2v+1, the root is 1, the leaves start at half of the rows. Which site stands
where is decided by splitting at the median of the larger side, again and again: loop order would do for most shapes, but every
turn of a spiral lies around all turns inside it.

The boxes lie along what they hold. A disc that touches a chain of n short sites from inside reaches into sqrt(n) upright boxes
near each contact, but into a few slanted ones only.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.curve import evaluate
from mat_core.kernels.disc import origin_end, touch
from mat_core.kernels.jit import inner
from mat_core.kernels.layout import (
    CONVEX_VERTEX,
    CORNER,
    CP0,
    DEG,
    FAN,
    KIND,
    LINE,
    NEXT,
    PREV,
    X0,
    X1,
    XMAX,
    XMIN,
    Y0,
    Y1,
    YMAX,
    YMIN,
)

STACK = 128  # twice the depth of a tree over 2**60 sites
IN_LOOP_ORDER = 64  # up to so many sites are not sorted
ROUNDING = 2e-15  # of a centre and of the sides of a box, in normalised coordinates
GREEDY_STEPS = 64
BESIDE = 1e-7  # radii; a foot this near to a convex vertex may lie on either side of it, as far as distances tell


class Tree(NamedTuple):
    """box (rows, 6): direction ux, uy; least and largest coordinate along it and across it. site (rows / 2,): -1 if empty.

    leaf (n,): row of each site's box.
    """

    box: NDArray[np.float64]
    site: NDArray[np.int64]
    leaf: NDArray[np.int64]


def room_for_tree(sites: int) -> tuple[NDArray[Any], ...]:
    """A `Tree` yet to be filled, as a plain tuple, which kernels take twice as fast."""
    leaves = 1
    while leaves < sites:
        leaves *= 2
    return (np.empty((2 * leaves, 6)), np.empty(leaves, dtype=np.int64), np.empty(sites, dtype=np.int64))


@inner
def fill_tree(si, sf, cp, tree, x, y):
    """The tree over all sites; x, y: room for a number of each site."""
    _sort_sites(sf, tree.site, x, y)
    _fill_boxes(si, sf, cp, tree)


@inner
def _select(key, site, first, last, middle):
    """Reorder site[first:last] so that none before `middle` has a larger key than those from there on (quickselect)."""
    a = first
    b = last - 1
    while a < b:
        pivot = key[site[(a + b) // 2]]
        i = a
        j = b
        while i <= j:
            while key[site[i]] < pivot:
                i += 1
            while key[site[j]] > pivot:
                j -= 1
            if i <= j:
                t = site[i]
                site[i] = site[j]
                site[j] = t
                i += 1
                j -= 1
        if middle <= j:
            b = j
        elif middle >= i:
            a = i
        else:
            return


@inner
def _sort_sites(sf, site, x, y):
    """Fill `site` with all sites, halved by x or y of their boxes' middles, aligned with the nodes of the tree; -1 beyond."""
    n = sf.shape[0]
    for i in range(site.shape[0]):
        site[i] = i if i < n else -1
    if n <= IN_LOOP_ORDER:
        return
    for i in range(n):
        x[i] = sf[i, XMIN] + sf[i, XMAX]
        y[i] = sf[i, YMIN] + sf[i, YMAX]
    size = site.shape[0]
    while size > 1:
        half = size // 2
        for first in range(0, n, size):
            if first + half >= n:
                break
            last = min(first + size, n)
            x0 = y0 = math.inf
            x1 = y1 = -math.inf
            for place in range(first, last):
                i = site[place]
                x0 = min(x0, x[i])
                x1 = max(x1, x[i])
                y0 = min(y0, y[i])
                y1 = max(y1, y[i])
            _select(x if x1 - x0 >= y1 - y0 else y, site, first, last, first + half)
        size = half


@inner
def _stretch(box, v, x, y):
    """Make box v hold a point."""
    a = x * box[v, 0] + y * box[v, 1]
    b = y * box[v, 0] - x * box[v, 1]
    box[v, 2] = min(box[v, 2], a)
    box[v, 3] = max(box[v, 3], a)
    box[v, 4] = min(box[v, 4], b)
    box[v, 5] = max(box[v, 5], b)


@inner
def _clear(box, v, ux, uy):
    """An empty box of a direction."""
    box[v, 0] = ux
    box[v, 1] = uy
    box[v, 2] = box[v, 4] = math.inf
    box[v, 3] = box[v, 5] = -math.inf


@inner
def _stretch_over(box, v, child):
    """Make box v hold the corners of box `child`."""
    ux = box[child, 0]
    uy = box[child, 1]
    for corner in range(4):
        a = box[child, 2 + corner % 2]
        b = box[child, 4 + corner // 2]
        _stretch(box, v, a * ux - b * uy, a * uy + b * ux)


@inner
def _fit_over(box, v):
    """Box v over its children: along one of them, or along the line through their middles, whichever is smallest."""
    left = 2 * v
    right = 2 * v + 1
    if box[right, 2] > box[right, 3]:
        for m in range(6):
            box[v, m] = box[left, m]
        return
    least = math.inf
    best_x = 1.0
    best_y = 0.0
    for choice in range(4):
        ux = 1.0
        uy = 0.0
        if choice == 1 or choice == 2:
            ux = box[2 * v + choice - 1, 0]
            uy = box[2 * v + choice - 1, 1]
        elif choice == 3:
            a = box[right, 2] + box[right, 3]
            b = box[right, 4] + box[right, 5]
            c = box[left, 2] + box[left, 3]
            d = box[left, 4] + box[left, 5]
            ux = a * box[right, 0] - b * box[right, 1] - c * box[left, 0] + d * box[left, 1]
            uy = a * box[right, 1] + b * box[right, 0] - c * box[left, 1] - d * box[left, 0]
            length = math.sqrt(ux * ux + uy * uy)
            if length == 0.0:
                continue
            ux /= length
            uy /= length
        _clear(box, v, ux, uy)
        _stretch_over(box, v, left)
        _stretch_over(box, v, right)
        area = (box[v, 3] - box[v, 2]) * (box[v, 5] - box[v, 4])
        if area < least:
            least = area
            best_x = ux
            best_y = uy
    _clear(box, v, best_x, best_y)
    _stretch_over(box, v, left)
    _stretch_over(box, v, right)


@inner
def _fill_boxes(si, sf, cp, tree):
    """All boxes of the tree; a site's lies along its chord."""
    box = tree.box
    leaves = tree.site.shape[0]
    for leaf in range(leaves):
        v = leaves + leaf
        i = tree.site[leaf]
        _clear(box, v, 1.0, 0.0)
        if i < 0:
            continue
        tree.leaf[i] = v
        dx = sf[i, X1] - sf[i, X0]
        dy = sf[i, Y1] - sf[i, Y0]
        length = math.sqrt(dx * dx + dy * dy)
        if length > 0.0:
            _clear(box, v, dx / length, dy / length)
        _stretch(box, v, sf[i, X0], sf[i, Y0])
        _stretch(box, v, sf[i, X1], sf[i, Y1])
        if si[i, KIND] != LINE and si[i, KIND] != FAN:
            for row in range(si[i, CP0], si[i, CP0] + si[i, DEG] + 1):
                _stretch(box, v, sf[i, X0] + cp[row, 0], sf[i, Y0] + cp[row, 1])
    for v in range(leaves - 1, 0, -1):
        _fit_over(box, v)


@inner
def box_distance_sq(cx, cy, x0, y0, x1, y1):
    """Squared distance of a point to an upright box."""
    dx = max(x0 - cx, 0.0, cx - x1)
    dy = max(y0 - cy, 0.0, cy - y1)
    return dx * dx + dy * dy


@inner
def _distance_sq(box, v, cx, cy):
    """Squared distance of a point to box v; infinite for an empty box."""
    a = cx * box[v, 0] + cy * box[v, 1]
    b = cy * box[v, 0] - cx * box[v, 1]
    return box_distance_sq(a, b, box[v, 2], box[v, 4], box[v, 3], box[v, 5])


@inner
def touch_candidate(si, sf, cp, i, j, d0x, d0y, d1x, d1y, nx, ny):
    """`touch` of site j from a point of site i (d0, d1: that point relative to i's ends)."""
    if origin_end(si, i, j, d0x * d0x + d0y * d0y <= d1x * d1x + d1y * d1y) == 0:
        return touch(si, sf, cp, j, 0.0, 1.0, sf[i, X0], sf[i, Y0], d0x, d0y, nx, ny)
    return touch(si, sf, cp, j, 0.0, 1.0, sf[i, X1], sf[i, Y1], d1x, d1y, nx, ny)


@inner
def _nearest_leaf(tree, v, cx, cy):
    """The site that walking down from v to the nearer box leads to: near the point, seldom the nearest."""
    leaves = tree.site.shape[0]
    while v < leaves:
        v *= 2
        if _distance_sq(tree.box, v + 1, cx, cy) < _distance_sq(tree.box, v, cx, cy):
            v += 1
    return tree.site[v - leaves]


@inner
def _pass_on(si, sf, cp, i, skip, px, py, d0x, d0y, d1x, d1y, nx, ny, best, j, s):
    """(site, s) of a contact found at s on site j near one of its ends, where the next site touches the disc as well.

    A contact at the very end is tangent there only if the site beyond does not take it over; a fan passes it on. Beside a convex
    vertex that turns by little both sides touch but for rounding: the disc touches the one on which its foot is farther from the
    vertex.
    """
    forward = s > 0.5
    while True:
        beyond = si[j, NEXT] if forward else si[j, PREV]
        corner = beyond if forward else j
        vx = sf[corner, X0]
        vy = sf[corner, Y0]
        qx, qy, tx, ty, k, speed = evaluate(si, sf, cp, j, s, vx, vy)
        depth = qx * qx + qy * qy
        fan = si[j, KIND] == FAN or si[beyond, KIND] == FAN
        convex = not fan and si[corner, CORNER] == CONVEX_VERTEX and depth * best * best < BESIDE * BESIDE
        at_end = s >= 1.0 if forward else s <= 0.0
        if beyond == i or beyond == skip or not (at_end or convex):
            break
        phi, sj = touch_candidate(si, sf, cp, i, beyond, d0x, d0y, d1x, d1y, nx, ny)
        # both values are of one point, but for rounding: that of phi is the coordinates' over the squared distance
        qx += vx - px
        qy += vy - py
        inside = 0.0 < sj < 1.0
        through = si[beyond, KIND] == FAN and (sj >= 1.0 if forward else sj <= 0.0)
        if phi < best * (1.0 - 1e-12) - ROUNDING / (qx * qx + qy * qy) or not (inside or through):
            break
        if convex:
            qx, qy, tx, ty, k, speed = evaluate(si, sf, cp, beyond, sj, vx, vy)
            if qx * qx + qy * qy <= depth:
                break
        j = beyond
        s = sj
        if inside:
            break
    return j, s


@inner
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
        phi, sj = touch_candidate(si, sf, cp, i, hint, d0x, d0y, d1x, d1y, nx, ny)
        if phi > best:
            best = phi
            best_j = hint
            best_s = sj
    r = 1.0 / best
    limit = (r + ROUNDING) * (r + ROUNDING)
    cx = px + r * nx
    cy = py + r * ny
    # shrink the disc first, as one that reaches across the domain meets boundary everywhere: by what stands near p in the tree,
    # then by what is near its centre; where nothing is that the hint did not meet before, by nothing
    n = si.shape[0]
    climbs = n > IN_LOOP_ORDER
    v = tree.leaf[i] if climbs and best_j < 0 else 1
    steps = 0
    while steps < GREEDY_STEPS:
        climbing = v > 1
        if climbing:
            side = v ^ 1
            v //= 2
            if _distance_sq(tree.box, side, cx, cy) >= limit:
                continue
            j = _nearest_leaf(tree, side, cx, cy)
        else:
            j = _nearest_leaf(tree, 1, cx, cy)
        steps += 1
        phi = -math.inf
        sj = 0.0
        if j >= 0 and j != i and j != skip and j != hint and j != best_j:
            phi, sj = touch_candidate(si, sf, cp, i, j, d0x, d0y, d1x, d1y, nx, ny)
        if phi <= best:
            if climbing:
                continue
            break
        if climbs and steps == 1 and not climbing:
            v = tree.leaf[i]
        best = phi
        best_j = j
        best_s = sj
        r = 1.0 / best
        limit = (r + ROUNDING) * (r + ROUNDING)
        cx = px + r * nx
        cy = py + r * ny
    leaves = tree.site.shape[0]
    box = tree.box
    seen = best_j
    top = 0
    stack[0] = 1
    while top >= 0:
        v = stack[top]
        top -= 1
        if _distance_sq(box, v, cx, cy) >= limit:
            continue
        if v < leaves:
            left = _distance_sq(box, 2 * v, cx, cy)
            right = _distance_sq(box, 2 * v + 1, cx, cy)
            near = 2 * v if left <= right else 2 * v + 1
            if max(left, right) < limit:
                top += 1
                stack[top] = 4 * v + 1 - near
            if min(left, right) < limit:
                top += 1
                stack[top] = near
            continue
        j = tree.site[v - leaves]
        if j == i or j == skip or j == hint or j == seen:
            continue
        phi, sj = touch_candidate(si, sf, cp, i, j, d0x, d0y, d1x, d1y, nx, ny)
        if phi > best:
            best = phi
            best_j = j
            best_s = sj
            r = 1.0 / best
            limit = (r + ROUNDING) * (r + ROUNDING)
            cx = px + r * nx
            cy = py + r * ny
    if best_j >= 0:
        best_j, best_s = _pass_on(si, sf, cp, i, skip, px, py, d0x, d0y, d1x, d1y, nx, ny, best, best_j, best_s)
    return best, best_j, best_s
