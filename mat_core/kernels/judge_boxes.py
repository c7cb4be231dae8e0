"""Boxes for the certificate's question which sites may reach into a disc; not those that found the axis.

Sites stand along a Morton curve, so that near ones are near in the tree, also on the turns of a spiral. Every box has a direction
of its own: a disc inside a ring of many short sites reaches into few boxes only.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels.jit import inner
from mat_core.kernels.layout import CP0, DEG, FAN, KIND, LINE, X0, X1, Y0, Y1

UNSORTED = 100  # up to so many sites stand in loop order
MOST_NEAR = 32  # leaves gathered for the discs of a piece; where there are more, each disc walks the tree itself
ROUNDING = 1e-14  # of coordinates and of how far discs reach, normalised
_SPREAD = ((16, 0x0000FFFF0000FFFF), (8, 0x00FF00FF00FF00FF), (4, 0x0F0F0F0F0F0F0F0F), (2, 0x3333333333333333),
           (1, 0x5555555555555555))  # moves the bits of a number of 32 bits to the even places


def leaf_order(sf: NDArray[np.float64]) -> NDArray[np.int64]:
    """Sites in the order of the tree's leaves."""
    return morton_order(sf) if len(sf) > UNSORTED else np.arange(len(sf))


def morton_order(sf: NDArray[np.float64]) -> NDArray[np.int64]:
    """Sites by the interleaved bits of their middles' coordinates."""
    code = np.zeros(len(sf), dtype=np.int64)
    for bit, ends in enumerate(((X0, X1), (Y0, Y1))):
        middle = sf[:, ends[0]] + sf[:, ends[1]]
        low = middle.min()
        cell = ((middle - low) * ((2**31 - 1) / max(middle.max() - low, 1e-300))).astype(np.int64)
        for shift, mask in _SPREAD:
            cell = (cell | cell << shift) & mask
        code |= cell << bit
    return np.argsort(code, kind="stable")


@inner
def outside(box, k, x, y, r):
    """Whether box k does not reach into the disc."""
    along = x * box[k, 0] + y * box[k, 1]
    across = y * box[k, 0] - x * box[k, 1]
    dx = max(0.0, box[k, 2] - along, along - box[k, 3])
    dy = max(0.0, box[k, 4] - across, across - box[k, 5])
    return dx * dx + dy * dy >= r * r


@inner
def stretch(ax, ay, bx, by, x, y, r):
    """How far a disc reaches from the line from a to b."""
    dx = bx - ax
    dy = by - ay
    length_sq = dx * dx + dy * dy
    share = ((x - ax) * dx + (y - ay) * dy) / length_sq if length_sq > 0.0 else 0.0
    share = min(max(share, 0.0), 1.0)
    dx = x - ax - share * dx
    dy = y - ay - share * dy
    return math.sqrt(dx * dx + dy * dy) + max(r, 0.0)


@inner
def leaves_near(box, stack, near, ax, ay, bx, by, r):
    """Fill `near` with the leaves that may reach within r of the line from a to b; how many, or -1 if more than MOST_NEAR."""
    if not r < math.inf:
        return -1
    r += ROUNDING
    n = box.shape[0] // 2
    count = 0
    stack[0] = 1
    top = 0
    while top >= 0:
        k = stack[top]
        top -= 1
        along_a = ax * box[k, 0] + ay * box[k, 1]
        along_b = bx * box[k, 0] + by * box[k, 1]
        if max(along_a, along_b) + r < box[k, 2] or min(along_a, along_b) - r > box[k, 3]:
            continue
        across_a = ay * box[k, 0] - ax * box[k, 1]
        across_b = by * box[k, 0] - bx * box[k, 1]
        if max(across_a, across_b) + r < box[k, 4] or min(across_a, across_b) - r > box[k, 5]:
            continue
        if k < n:
            stack[top + 1] = 2 * k
            stack[top + 2] = 2 * k + 1
            top += 2
            continue
        if count == MOST_NEAR:
            return -1
        near[count] = k
        count += 1
    return count


@inner
def _turn_box(box, k, ux, uy):
    """Make box k an empty one along (ux, uy), or along x where that is no direction."""
    length = math.sqrt(ux * ux + uy * uy)
    box[k, 0] = ux / length if length > 0.0 else 1.0
    box[k, 1] = uy / length if length > 0.0 else 0.0
    box[k, 2] = box[k, 4] = math.inf
    box[k, 3] = box[k, 5] = -math.inf


@inner
def _include(box, k, x, y):
    """Widen box k by a point."""
    along = x * box[k, 0] + y * box[k, 1]
    across = y * box[k, 0] - x * box[k, 1]
    box[k, 2] = min(box[k, 2], along)
    box[k, 3] = max(box[k, 3], along)
    box[k, 4] = min(box[k, 4], across)
    box[k, 5] = max(box[k, 5], across)


@inner
def _enclose(box, k, ux, uy):
    """Make box k one along (ux, uy) around both its children; returns its area."""
    _turn_box(box, k, ux, uy)
    for child in range(2 * k, 2 * k + 2):
        if box[child, 2] > box[child, 3]:
            continue
        vx = box[child, 0]
        vy = box[child, 1]
        for end in range(2, 4):
            for side in range(4, 6):
                _include(box, k, box[child, end] * vx - box[child, side] * vy, box[child, end] * vy + box[child, side] * vx)
    return (box[k, 3] - box[k, 2]) * (box[k, 5] - box[k, 4]) if box[k, 2] <= box[k, 3] else 0.0


@inner
def fill_boxes(si, sf, cp, order, box):
    """All boxes (2 n, 6) of the tree: direction, least and largest coordinate along it and across it.

    That of site order[k] goes to row n + k, that of rows 2k and 2k + 1 together to row k; row 1 is the whole. A fan is left out:
    its point is an end of both neighbours.
    """
    n = si.shape[0]
    for leaf in range(n):
        i = order[leaf]
        k = n + leaf
        _turn_box(box, k, sf[i, X1] - sf[i, X0], sf[i, Y1] - sf[i, Y0])
        if si[i, KIND] == LINE:
            _include(box, k, sf[i, X0], sf[i, Y0])
            _include(box, k, sf[i, X1], sf[i, Y1])
        elif si[i, KIND] != FAN:
            for row in range(si[i, CP0], si[i, CP0] + si[i, DEG] + 1):
                _include(box, k, sf[i, X0] + cp[row, 0], sf[i, Y0] + cp[row, 1])
    for k in range(n - 1, 0, -1):
        # the smallest of: upright, along either child, along the line through the ends of their lower sides
        ax = box[2 * k, 2] * box[2 * k, 0] - box[2 * k, 4] * box[2 * k, 1]
        ay = box[2 * k, 2] * box[2 * k, 1] + box[2 * k, 4] * box[2 * k, 0]
        bx = box[2 * k + 1, 3] * box[2 * k + 1, 0] - box[2 * k + 1, 4] * box[2 * k + 1, 1]
        by = box[2 * k + 1, 3] * box[2 * k + 1, 1] + box[2 * k + 1, 4] * box[2 * k + 1, 0]
        best_x = 1.0
        best_y = 0.0
        least = _enclose(box, k, best_x, best_y)
        for choice in range(3):
            ux = bx - ax if choice == 2 else box[2 * k + choice, 0]
            uy = by - ay if choice == 2 else box[2 * k + choice, 1]
            if math.isfinite(ux) and math.isfinite(uy):
                area = _enclose(box, k, ux, uy)
                if area < least:
                    least = area
                    best_x = ux
                    best_y = uy
        _enclose(box, k, best_x, best_y)
