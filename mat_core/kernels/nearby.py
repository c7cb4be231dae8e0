"""Which pieces may meet at all: a tree of boxes over them, each box upright and once more along its own pieces.

    upright boxes alone           boxes along the pieces
    +--------+                    The teeth of a comb that stands askew, the spikes of a star, the turns of a zigzag: every
    | /  / / |                    upright box overlaps every other, and all pairs would be compared. Turned along the
    |/  / /  |                    direction that most of its pieces run in, a box is as thin as what it holds.
    +--------+

The leaves are parts of pieces: where bent pieces lie within each other, like the turns of a spiral of arcs, whole ones
would all be near each other, short parts are flat and are not. Node v has the children 2v and 2v + 1, the root is 1;
leaf k, piece[k] over [part[k, 0], part[k, 1]], is row `leaves + k`. Rows of `tree`:

    XMIN, YMIN, XMAX, YMAX     upright box; XMIN = inf where there is nothing
    DX, DY                     direction of the other box
    CX, CY, HALF, BREADTH      its centre, and half its extent along (DX, DY) and across

Coordinates, piece tables and gentle pieces as in `mat_core.kernels.outline`.
"""

from __future__ import annotations

import math

from mat_core.kernels.bezier import Floats, Ints, restrict
from mat_core.kernels.intersect import separated
from mat_core.kernels.jit import inner
from mat_core.kernels.joints import plan
from mat_core.kernels.outline import BLOCK, CP0, CUM, DEG, LEN, LOOP

XMIN, YMIN, XMAX, YMAX, DX, DY, CX, CY, HALF, BREADTH = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
TREE_WIDTH = 10
TREE_CENTRE = slice(CX, CY + 1)

SLACK = 1e-14  # normalised: rounding of a turned box, far below every gap


@inner
def fill_leaf(tree: Floats, v: int, pcp: Floats, c0: int, p: int) -> None:
    """Both boxes of one part, turned along its chord; DX, DY hold that direction, its angle doubled, times the length."""
    ox = pcp[c0, 0]
    oy = pcp[c0, 1]
    dx = pcp[c0 + p, 0] - ox
    dy = pcp[c0 + p, 1] - oy
    length = math.hypot(dx, dy)
    if length > 0.0:
        dx /= length
        dy /= length
    else:
        dx = 1.0
    x0 = y0 = x1 = y1 = a0 = b0 = a1 = b1 = 0.0
    for i in range(1, p + 1):
        x = pcp[c0 + i, 0] - ox
        y = pcp[c0 + i, 1] - oy
        a = x * dx + y * dy
        b = y * dx - x * dy
        x0 = min(x0, x)
        y0 = min(y0, y)
        x1 = max(x1, x)
        y1 = max(y1, y)
        a0 = min(a0, a)
        b0 = min(b0, b)
        a1 = max(a1, a)
        b1 = max(b1, b)
    tree[v, XMIN] = ox + x0
    tree[v, YMIN] = oy + y0
    tree[v, XMAX] = ox + x1
    tree[v, YMAX] = oy + y1
    a = 0.5 * (a0 + a1)
    b = 0.5 * (b0 + b1)
    tree[v, DX] = length * (dx * dx - dy * dy)
    tree[v, DY] = length * 2.0 * dx * dy
    tree[v, CX] = ox + a * dx - b * dy
    tree[v, CY] = oy + a * dy + b * dx
    tree[v, HALF] = 0.5 * (a1 - a0)
    tree[v, BREADTH] = 0.5 * (b1 - b0)


@inner
def settle_direction(tree: Floats, v: int) -> None:
    """The sum in DX, DY becomes a unit vector of half its angle."""
    half = 0.5 * math.atan2(tree[v, DY], tree[v, DX])
    tree[v, DX] = math.cos(half)
    tree[v, DY] = math.sin(half)


@inner
def enclose_children(tree: Floats, v: int) -> None:
    """Both boxes of an inner node from those of its children, whose directions are settled; its own is, after this."""
    for axis in range(2):
        tree[v, axis] = min(tree[2 * v, axis], tree[2 * v + 1, axis])
        tree[v, axis + 2] = max(tree[2 * v, axis + 2], tree[2 * v + 1, axis + 2])
    if tree[v, XMIN] == math.inf:
        return
    settle_direction(tree, v)
    dx = tree[v, DX]
    dy = tree[v, DY]
    ox = tree[2 * v, CX]
    oy = tree[2 * v, CY]
    a0 = b0 = math.inf
    a1 = b1 = -math.inf
    for child in range(2 * v, 2 * v + 2):
        if tree[child, XMIN] == math.inf:
            continue
        along = tree[child, DX] * dx + tree[child, DY] * dy
        across = tree[child, DY] * dx - tree[child, DX] * dy
        a = (tree[child, CX] - ox) * dx + (tree[child, CY] - oy) * dy
        b = (tree[child, CY] - oy) * dx - (tree[child, CX] - ox) * dy
        ra = tree[child, HALF] * abs(along) + tree[child, BREADTH] * abs(across)
        rb = tree[child, HALF] * abs(across) + tree[child, BREADTH] * abs(along)
        a0 = min(a0, a - ra)
        a1 = max(a1, a + ra)
        b0 = min(b0, b - rb)
        b1 = max(b1, b + rb)
    a = 0.5 * (a0 + a1)
    b = 0.5 * (b0 + b1)
    tree[v, CX] = ox + a * dx - b * dy
    tree[v, CY] = oy + a * dy + b * dx
    tree[v, HALF] = 0.5 * (a1 - a0)
    tree[v, BREADTH] = 0.5 * (b1 - b0)


@inner
def fill_tree(pi: Ints, pcp: Floats, piece: Ints, part: Floats, work: Floats, tree: Floats) -> None:
    """Fill all rows of `tree` (twice a power of two that is at least n, TREE_WIDTH) for n parts."""
    leaves = tree.shape[0] // 2
    n = piece.shape[0]
    for k in range(leaves):
        v = leaves + k
        if k < n:
            p = pi[piece[k], DEG]
            restrict(pcp, pi[piece[k], CP0], p, part[k, 0], part[k, 1], work, 0)
            fill_leaf(tree, v, work, 0, p)
        else:
            tree[v, XMIN] = math.inf
            tree[v, YMIN] = math.inf
            tree[v, XMAX] = -math.inf
            tree[v, YMAX] = -math.inf
            tree[v, DX] = 0.0
            tree[v, DY] = 0.0
    # All sums are made before the first of them is turned into a direction.
    for v in range(leaves - 1, 0, -1):
        tree[v, DX] = tree[2 * v, DX] + tree[2 * v + 1, DX]
        tree[v, DY] = tree[2 * v, DY] + tree[2 * v + 1, DY]
    for k in range(n):
        settle_direction(tree, leaves + k)
    for v in range(leaves - 1, 0, -1):
        enclose_children(tree, v)


@inner
def boxes_near(tree: Floats, v: int, w: int, gap: float) -> bool:
    """Whether neither the upright nor the turned boxes of two nodes prove them over `gap` apart; False for empty ones."""
    for axis in range(2):
        # Negated, so that an empty box, from inf to -inf, is near nothing.
        if not (tree[v, axis] <= tree[w, axis + 2] + gap and tree[w, axis] <= tree[v, axis + 2] + gap):
            return False
    x = tree[w, CX] - tree[v, CX]
    y = tree[w, CY] - tree[v, CY]
    along = abs(tree[v, DX] * tree[w, DX] + tree[v, DY] * tree[w, DY])
    across = abs(tree[v, DX] * tree[w, DY] - tree[v, DY] * tree[w, DX])
    for node in range(2):
        a = v if node == 0 else w
        b = w if node == 0 else v
        dx = tree[a, DX]
        dy = tree[a, DY]
        if abs(x * dx + y * dy) > tree[a, HALF] + tree[b, HALF] * along + tree[b, BREADTH] * across + gap:
            return False
        if abs(y * dx - x * dy) > tree[a, BREADTH] + tree[b, HALF] * across + tree[b, BREADTH] * along + gap:
            return False
    return True


@inner
def ways_between(pi: Ints, pf: Floats, piece_start: Ints, i: int, j: int) -> tuple[bool, float, float]:
    """Whether pieces i <= j are to be compared (a gentle one does not meet itself; adjacent ones are looked at elsewhere).

    And the lengths of the boundary from the end of i ahead to j and from the end of j on to i; infinite between loops.
    """
    loop = pi[i, LOOP]
    if loop != pi[j, LOOP]:
        return True, math.inf, math.inf
    last = piece_start[loop + 1] - 1
    ahead = pf[j, CUM] - pf[i, CUM] - pf[i, LEN]
    behind = pf[last, CUM] + pf[last, LEN] - ahead - pf[i, LEN] - pf[j, LEN]
    return j > i + 1 and not (i == piece_start[loop] and j == last), ahead, behind


@inner
def compare_pairs(
    pi: Ints,
    pf: Floats,
    pcp: Floats,
    piece_start: Ints,
    gap: float,
    piece: Ints,
    part: Floats,
    tree: Floats,
    pairs: Ints,
    work: Floats,
    tasks: Floats,
    planned: int,
) -> tuple[int, int]:
    """Tasks for all parts of pieces not adjacent whose control polygons are not separated.

    Returns the numbers of tasks and of pairs of nodes that were looked at. Walks the tree against itself. Ends early when `tasks`
    is full: a number beyond its rows says that a larger one is needed.
    """
    leaves = tree.shape[0] // 2
    looked = 0
    top = 0
    pairs[0, 0] = 1
    pairs[0, 1] = 1
    while top >= 0 and planned <= tasks.shape[0]:
        looked += 1
        v = pairs[top, 0]
        w = pairs[top, 1]
        top -= 1
        if v == w:
            if v >= leaves or tree[v, XMIN] == math.inf:
                continue
        elif not boxes_near(tree, v, w, gap + SLACK):
            continue
        if v < leaves:
            # Both nodes are on one level, v <= w; pushed so that pairs come out in loop order.
            for k in range(3, -1, -1):
                if k != 2 or v != w:
                    top += 1
                    pairs[top, 0] = 2 * v + (k >> 1)
                    pairs[top, 1] = 2 * w + (k & 1)
            continue
        first_is_lower = piece[v - leaves] <= piece[w - leaves]
        a = v - leaves if first_is_lower else w - leaves
        b = w - leaves if first_is_lower else v - leaves
        i = piece[a]
        j = piece[b]
        compared, ahead, behind = ways_between(pi, pf, piece_start, i, j)
        if not compared:
            continue
        restrict(pcp, pi[i, CP0], pi[i, DEG], part[a, 0], part[a, 1], work, 0)
        restrict(pcp, pi[j, CP0], pi[j, DEG], part[b, 0], part[b, 1], work, BLOCK)
        if not separated(work, pi[i, DEG], pi[j, DEG], gap):
            planned = plan(
                tasks, planned, i, part[a, 0], part[a, 1], j, part[b, 0], part[b, 1], ahead, behind
            )
    return planned, looked
