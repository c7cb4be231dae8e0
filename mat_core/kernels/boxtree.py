"""A binary tree of slanted boxes over the sites.

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

from mat_core.kernels.jit import inner
from mat_core.kernels.layout import CP0, DEG, FAN, KIND, LINE, X0, X1, XMAX, XMIN, Y0, Y1, YMAX, YMIN
from mat_core.memory import maker

STACK = 128  # twice the depth of a tree over 2**60 sites
IN_LOOP_ORDER = 64  # up to so many sites are not sorted


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
    make = maker(sites)
    return make((2 * leaves, 6)), make(leaves, np.int64), make(sites, np.int64)


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
def distance_sq(box, v, cx, cy):
    """Squared distance of a point to box v; infinite for an empty box."""
    a = cx * box[v, 0] + cy * box[v, 1]
    b = cy * box[v, 0] - cx * box[v, 1]
    return box_distance_sq(a, b, box[v, 2], box[v, 4], box[v, 3], box[v, 5])
