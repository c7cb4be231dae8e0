"""The closed loops of a boundary: flat arrays, and their outline in gentle pieces in normalised coordinates."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels import outline as columns
from mat_core.kernels.intersect import compare_closely, compare_joints
from mat_core.kernels.nearby import TREE_CENTRE, TREE_WIDTH, compare_pairs, fill_tree
from mat_core.kernels.outline import cut_gently, farthest, sector_areas
from mat_core.model.curve import RationalBSpline

TOUCH = 1e-12  # of the size: what is nearer counts as touching; a thousand times the rounding of normalised coordinates
TOUCH_ULPS = 2.0  # of the largest coordinate: nor can the input itself tell such points apart
CUSP_BRANCHES = (
    10.0  # branches of y**2 = x**3 are a gap apart at x = gap**(2/3); a path of ten such x covers flatter ones
)
HIT_LIMIT = 256  # pairs of pieces reported; a scribble has millions
TASKS_A_PART = 4  # pairs with interlocking hulls; where there are more, bent pieces are cut into flatter parts
MOST_PARTS = 64  # of a piece
TASKS_A_PIECE = 32  # when no cutting helps; sound domains have about one a piece
TASK_LIMIT = 2_000_000  # of them in all
CELL_BITS = 20
CELLS = 1 << CELL_BITS  # of the Z-curve, along each axis of the unit square
SUBDIVISIONS = (
    5_000_000  # of one whole check, some seconds; a tight but clean domain of 10,000 edges needs a few thousand
)


class BoundaryArrays(NamedTuple):
    """The boundary in flat arrays: the input's own coordinates and orientation.

    E edges, N control points, M knots, L loops; edge e has control points cp[cp_start[e] : cp_start[e + 1]] and knots
    knots[knot_start[e] : knot_start[e + 1]]; loop l has the edges loop_start[l] .. loop_start[l + 1] - 1.
    """

    degree: NDArray[np.int64]  # (E,)
    cp_start: NDArray[np.int64]  # (E + 1,)
    cp: NDArray[np.float64]  # (N, 3) x, y, weight: the Euclidean point, not multiplied by its weight
    knot_start: NDArray[np.int64]  # (E + 1,)
    knots: NDArray[np.float64]  # (M,)
    loop_start: NDArray[np.int64]  # (L + 1,); loop 0 is outer, loop i is holes[i - 1]
    reversed: NDArray[np.bool_]  # (L,) True: interior on the right as given, so the loop is to be run backwards

    def edge(self, e: int) -> RationalBSpline:
        """Edge e of the flat numbering as a curve; its arrays are copies."""
        cp = self.cp[self.cp_start[e] : self.cp_start[e + 1]]
        knots = self.knots[self.knot_start[e] : self.knot_start[e + 1]].copy()
        return RationalBSpline(int(self.degree[e]), knots, cp[:, :2].copy(), cp[:, 2].copy())

    def loop(self, index: int) -> tuple[RationalBSpline, ...]:
        """The edges of a loop as curves, in the input's order."""
        return tuple(self.edge(e) for e in range(self.loop_start[index], self.loop_start[index + 1]))


class Frame(NamedTuple):
    """Normalised coordinates: (input - origin) * scale, the size in [0.5, 1]; the scale is a power of two.

    `gap`: the normalised distance below which two walls count as touching; `noise`: by how much a control point may be
    off, by rounding or because it was moved to close a gap.
    """

    origin: tuple[float, float]
    scale: float
    size: float
    gap: float
    noise: float

    def to_input(self, x: float, y: float) -> tuple[float, float]:
        """A normalised point in the caller's coordinates."""
        return self.origin[0] + x / self.scale, self.origin[1] + y / self.scale


class Outline(NamedTuple):
    """The loops in use as gentle pieces (see `mat_core.kernels.outline` for the columns of `pi` and `pf`)."""

    frame: Frame
    pi: NDArray[np.int64]  # (n, 4)
    pf: NDArray[np.float64]  # (n, 8)
    cp: NDArray[np.float64]  # (m, 3) normalised control points x, y, weight
    piece_start: NDArray[np.int64]  # (L + 1,); a loop not in use has no pieces
    measures: NDArray[np.float64]  # (L, 2) signed area, length of the control legs, normalised
    work: NDArray[np.float64]  # scratch of the kernels
    stack: NDArray[np.float64]

    def hits(self) -> tuple[NDArray[np.float64], bool]:
        """Where pieces meet that may not, and whether these are all.

        Rows piece, t, piece, t, kind (`mat_core.kernels.intersect`); at most HIT_LIMIT of them.
        """
        if len(self.pi) == 0:
            return np.empty((0, 5)), True
        piece = neighbours_first(self)
        part = np.tile((0.0, 1.0), (len(piece), 1))
        bent = self.pi[:, columns.DEG] > 1
        pairs = np.empty((256, 2), dtype=np.int64)
        hits = np.empty((HIT_LIMIT, 5))
        counts = np.zeros(2, dtype=np.int64)
        gap = self.frame.gap
        limit = min(TASK_LIMIT, 64 + TASKS_A_PIECE * len(self.pi))
        capacity = 64 + TASKS_A_PART * len(piece)
        tree = box_tree(self, piece, part)
        while True:
            tasks = np.empty((capacity, 8))
            counts[:] = 0
            compare_joints(
                self.pi, self.pf, self.cp, self.piece_start, gap, self.frame.noise, self.work, tasks, hits, counts
            )
            found, planned = counts.tolist()
            planned = compare_pairs(
                self.pi, self.pf, self.cp, self.piece_start, gap, piece, part, tree, pairs, self.work, tasks, planned
            )
            if planned <= capacity:
                break
            if len(piece) <= MOST_PARTS * len(self.pi) // 2 and bent.any():
                leaves = tree[len(tree) // 2 :][: len(piece)]
                order = np.argsort(z_codes(leaves[:, TREE_CENTRE]), kind="stable")
                piece, part = halved(piece[order], part[order], bent[piece[order]])
                tree = box_tree(self, piece, part)
                capacity = 64 + TASKS_A_PART * len(piece)
            elif capacity < limit:
                capacity = min(4 * capacity, limit)
            else:
                break
        found = compare_closely(
            self.pi, self.cp, tasks, min(planned, capacity), gap, CUSP_BRANCHES * gap ** (2.0 / 3.0),
            self.work, self.stack, SUBDIVISIONS, hits, found,
        )  # fmt: skip
        return hits[:found], found < HIT_LIMIT and planned <= capacity

    def first_point(self, loop: int) -> tuple[float, float]:
        """Where a loop in use begins, normalised."""
        x, y = self.cp[self.pi[self.piece_start[loop], columns.CP0], :2].tolist()
        return x, y

    def extent(self, loop: int) -> tuple[float, float, float, float]:
        """Tight normalised bounds of a loop's curve: xmin, ymin, xmax, ymax."""
        pieces = slice(self.piece_start[loop], self.piece_start[loop + 1])
        pi, pf = self.pi[pieces], self.pf[pieces]
        ends = self.cp[pi[:, columns.CP0]]
        bounds = []
        for k, sign in enumerate((-1.0, -1.0, 1.0, 1.0)):
            best = float((sign * ends[:, k % 2]).max())
            # Only pieces whose control box goes farther than all ends can reach beyond them.
            bulging = pi[sign * pf[:, columns.XMIN + k] > best]
            bounds.append(sign * farthest(bulging, self.cp, k % 2, sign, best, self.work, self.stack))
        return bounds[0], bounds[1], bounds[2], bounds[3]


def neighbours_first(outline: Outline) -> NDArray[np.int64]:
    """The pieces (n,) in an order in which neighbours stand near each other: loop by loop, the loops along a Z-curve.

    A loop's own pieces are in such an order already; its place in the document says nothing.
    """
    used = np.flatnonzero(np.diff(outline.piece_start) > 0)
    first = outline.piece_start[used]
    if len(used) < 3:
        return np.arange(len(outline.pi))
    low = np.minimum.reduceat(outline.pf[:, columns.XMIN : columns.XMAX], first, axis=0)
    high = np.maximum.reduceat(outline.pf[:, columns.XMAX : columns.YMAX + 1], first, axis=0)
    code = z_codes(0.5 * (low + high))
    rank = np.empty(len(used), dtype=np.int64)
    rank[np.argsort(code, kind="stable")] = np.arange(len(used))
    return np.argsort(np.repeat(rank, np.diff(outline.piece_start)[used]), kind="stable")


def z_codes(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Places (n,) of normalised points (n, 2) along a Z-curve."""
    cells = ((points + 0.5) * (CELLS - 1)).astype(np.int64)
    code = np.zeros(len(points), dtype=np.int64)
    for bit in range(CELL_BITS):
        code |= ((cells[:, 0] >> bit & 1) << 2 * bit) | ((cells[:, 1] >> bit & 1) << 2 * bit + 1)
    return code


def halved(
    piece: NDArray[np.int64], part: NDArray[np.float64], bent: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The bent parts in halves, the others as they are."""
    copies = 1 + bent
    middle = part.mean(axis=1)[bent]
    piece, part = np.repeat(piece, copies), np.repeat(part, copies, axis=0)
    first = (np.cumsum(copies) - copies)[bent]
    part[first, 1] = part[first + 1, 0] = middle
    return piece, part


def box_tree(outline: Outline, piece: NDArray[np.int64], part: NDArray[np.float64]) -> NDArray[np.float64]:
    """The tree of `mat_core.kernels.nearby` over these parts (n,), (n, 2) of the pieces."""
    leaves = 1 << max(0, len(piece) - 1).bit_length()
    tree = np.empty((2 * leaves, TREE_WIDTH))
    fill_tree(outline.pi, outline.cp, piece, part, outline.work, tree)
    return tree


def frame_of(cp: NDArray[np.float64], largest: float, moved: float = 0.0) -> Frame:
    """The frame of a set of control points (N, 2 or more).

    `largest`: the biggest coordinate in magnitude; `moved`: the widest gap that is closed.
    """
    low = cp[:, :2].min(axis=0)
    high = cp[:, :2].max(axis=0)
    size = float((high - low).max())
    centre = low + 0.5 * (high - low)
    scale = math.ldexp(1.0, -math.frexp(size)[1]) if size > 0.0 else 1.0
    gap = max(TOUCH * size, TOUCH_ULPS * math.ulp(largest)) * scale
    noise = max(math.ulp(largest), moved) * scale
    return Frame((float(centre[0]), float(centre[1])), scale, size, gap, noise)


def outline_of(arrays: BoundaryArrays, use_loop: NDArray[np.int64], frame: Frame) -> Outline:
    """Cut the loops marked in `use_loop` (L,) into gentle pieces; one too small for any has none. Assumes sound edges."""
    cp = arrays.cp.copy()
    with np.errstate(invalid="ignore", over="ignore"):  # loops not in use may be anywhere
        cp[:, 0] = (cp[:, 0] - frame.origin[0]) * frame.scale
        cp[:, 1] = (cp[:, 1] - frame.origin[1]) * frame.scale
    spans = np.diff(arrays.cp_start) - arrays.degree
    total = int(spans.sum()) + 8
    rows = spans * (arrays.degree + 1)
    work = np.empty((int(rows.max(initial=0)) + 2 * columns.BLOCK, 3))
    breaks = np.empty(int(spans.max(initial=0)) + 2)
    stack = np.empty((128, 4))
    piece_start = np.empty(len(arrays.loop_start), dtype=np.int64)
    total_rows = int(rows.sum()) + 8 * columns.BLOCK
    factor = 2  # most curves need one or two pieces a span; the loop below copes with the others
    while True:
        pi = np.empty((factor * total, 4), dtype=np.int64)
        pf = np.empty((factor * total, 8))
        pcp = np.empty((factor * total_rows, 3))
        n = cut_gently(
            use_loop, arrays.loop_start, arrays.degree, arrays.cp_start, cp, arrays.knot_start, arrays.knots,
            pi, pf, pcp, piece_start, work, breaks, stack,
        )  # fmt: skip
        if n >= 0:
            break
        factor *= 4
    pi, pf = pi[:n], pf[:n]
    if n > 0:
        used = int(pi[-1, columns.CP0] + pi[-1, columns.DEG]) + 1
        measures = measure(pi, pf, pcp[:used], piece_start, stack)
    else:
        measures = np.zeros((len(piece_start) - 1, 2))
    return Outline(frame, pi, pf, pcp, piece_start, measures, work, stack)


def measure(
    pi: NDArray[np.int64],
    pf: NDArray[np.float64],
    cp: NDArray[np.float64],
    piece_start: NDArray[np.int64],
    stack: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Fill the columns of `pf` from XMIN on; signed area and length of each loop (L, 2)."""
    first, loop = pi[:, columns.CP0], pi[:, columns.LOOP]
    last = first + pi[:, columns.DEG]
    np.minimum.reduceat(cp[:, :2], first, axis=0, out=pf[:, columns.XMIN : columns.XMAX])
    np.maximum.reduceat(cp[:, :2], first, axis=0, out=pf[:, columns.XMAX : columns.YMAX + 1])
    legs = np.zeros(len(cp))
    np.hypot(np.diff(cp[:, 0]), np.diff(cp[:, 1]), out=legs[:-1])
    legs[last] = 0.0
    length = np.add.reduceat(legs, first)
    pf[:, columns.LEN] = length
    before = np.concatenate(([0.0], np.cumsum(length)))
    pf[:, columns.CUM] = before[:-1] - before[piece_start[loop]]
    area = np.empty(len(pi))
    sector_areas(pi, cp, stack, area)
    area += 0.5 * (cp[first, 0] * cp[last, 1] - cp[first, 1] * cp[last, 0])
    loops = len(piece_start) - 1
    return np.column_stack(
        (np.bincount(loop, weights=area, minlength=loops), np.bincount(loop, weights=length, minlength=loops))
    )
