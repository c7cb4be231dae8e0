"""The closed loops of a boundary: flat arrays, and their outline in gentle pieces in normalised coordinates."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.kernels import outline as columns
from mat_core.kernels.bezier import count_beziers
from mat_core.kernels.measuring import MEASURES, draw_outline, extent
from mat_core.kernels.meeting import arrange, compare
from mat_core.kernels.nearby import TREE_CENTRE, TREE_WIDTH
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
WHOLE = (0.0, 1.0)  # parameter range of a piece
HIGHEST_EXPONENT = 1023  # of a scale that is a float; what would need a larger one is refused for its size
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
    pf: NDArray[np.float64]  # (n, PF_WIDTH)
    cp: NDArray[np.float64]  # (m, 3) normalised control points x, y, weight
    piece_start: NDArray[np.int64]  # (L + 1,); a loop not in use has no pieces
    measures: NDArray[np.float64]  # (L, MEASURES) of each loop, see `mat_core.kernels.measuring`
    work: NDArray[np.float64]  # scratch of the kernels
    stack: NDArray[np.float64]

    def hits(self) -> tuple[NDArray[np.float64], bool]:
        """Where pieces meet that may not, and whether these are all.

        Rows piece, t, piece, t, kind (`mat_core.kernels.intersect`); at most HIT_LIMIT of them.
        """
        n = len(self.pi)
        if n == 0:
            return np.empty((0, 5)), True
        piece = arranged(self.pf[:, columns.XMIN : columns.YMAX + 1], self.piece_start)
        part = np.empty((n, 2))
        part[:] = WHOLE
        pairs = np.empty((256, 2), dtype=np.int64)
        hits = np.empty((HIT_LIMIT, 5))
        limit = min(TASK_LIMIT, 64 + TASKS_A_PIECE * n)
        capacity = 64 + TASKS_A_PART * n
        gap = self.frame.gap
        while True:
            tree, tasks = np.empty((tree_rows(len(piece)), TREE_WIDTH)), np.empty((capacity, 8))
            last = capacity >= limit and not self._can_halve(piece)
            found, planned, _ = compare(
                self.pi, self.pf, self.cp, self.piece_start, gap, self.frame.noise, CUSP_BRANCHES * gap ** (2.0 / 3.0),
                piece, part, tree, pairs, SUBDIVISIONS, last, self.work, self.stack, tasks, hits,
            )  # fmt: skip
            if planned <= capacity or last:
                return hits[:found], found < HIT_LIMIT and planned <= capacity
            if self._can_halve(piece):
                centre = tree[len(tree) // 2 :, TREE_CENTRE][: len(piece)]
                order = arranged(np.hstack((centre, centre)), np.arange(len(piece) + 1))
                piece, part = halved(piece[order], part[order], self.pi[piece[order], columns.DEG] > 1)
                capacity = 64 + TASKS_A_PART * len(piece)
            else:
                capacity = min(4 * capacity, limit)

    def _can_halve(self, piece: NDArray[np.int64]) -> bool:
        """Whether some of these parts of pieces are bent, and they are not too many already."""
        return len(piece) <= MOST_PARTS * len(self.pi) // 2 and bool((self.pi[:, columns.DEG] > 1).any())

    def parameter(self, piece: int, t: float) -> float:
        """The edge's parameter at t of a piece."""
        row = self.pf[piece]
        pace = float(row[columns.PACE]) * t
        return float(row[columns.UA] + pace / (pace + 1.0 - t) * (row[columns.UB] - row[columns.UA]))

    def first_points(self, loops: NDArray[np.int64] | int) -> NDArray[np.float64]:
        """Where loops in use begin, normalised: (2,) of one, (K, 2) of several."""
        return self.cp[self.pi[self.piece_start[loops], columns.CP0], :2]

    def extent(self, loop: int) -> tuple[float, float, float, float]:
        """Tight normalised bounds of a loop's curve: xmin, ymin, xmax, ymax."""
        first, last = self.piece_start[loop : loop + 2].tolist()
        out = np.empty(4)
        extent(self.pi, self.pf, self.cp, first, last, self.work, self.stack, out)
        xmin, ymin, xmax, ymax = out.tolist()
        return xmin, ymin, xmax, ymax


def arranged(box: NDArray[np.float64], start: NDArray[np.int64]) -> NDArray[np.int64]:
    """An order (n,) of pieces or parts with these boxes (n, 4) in which neighbours stand near each other.

    start (G + 1,): where each group of them begins. The pieces of a loop are in such an order already; the loop's place in the
    document says nothing.
    """
    order = np.empty(len(box), dtype=np.int64)
    place, group, spare = np.empty((3, len(start)), dtype=np.int64)
    arrange(np.ascontiguousarray(box), start, place, group, spare, order)
    return order


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


def tree_rows(leaves: int) -> int:
    """Rows of the tree of `mat_core.kernels.nearby` over so many parts."""
    return 2 << max(0, leaves - 1).bit_length()


def box_of(cp: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """The box of points (N, 2 or more): xmin, ymin, xmax, ymax."""
    xmin, ymin = cp[:, :2].min(axis=0).tolist()
    xmax, ymax = cp[:, :2].max(axis=0).tolist()
    return xmin, ymin, xmax, ymax


def frame_of(box: tuple[float, float, float, float], largest: float, moved: float = 0.0) -> Frame:
    """The frame of what has this box of control points.

    `largest`: the biggest coordinate in magnitude; `moved`: the widest gap that is closed.
    """
    xmin, ymin, xmax, ymax = box
    size = max(xmax - xmin, ymax - ymin)
    origin = xmin + 0.5 * (xmax - xmin), ymin + 0.5 * (ymax - ymin)
    scale = math.ldexp(1.0, min(-math.frexp(size)[1], HIGHEST_EXPONENT)) if size > 0.0 else 1.0
    gap = max(TOUCH * size, TOUCH_ULPS * math.ulp(largest)) * scale
    noise = max(math.ulp(largest), moved) * scale
    return Frame(origin, scale, size, gap, noise)


def outline_of(arrays: BoundaryArrays, use_loop: NDArray[np.int64], frame: Frame) -> Outline:
    """Cut the loops marked in `use_loop` (L,) into gentle pieces; one too small for any has none. Assumes sound edges."""
    beziers, rows, most_of_edge, longest, _ = count_beziers(arrays.degree, arrays.cp_start)
    work, breaks, stack = np.empty((most_of_edge + 2 * columns.BLOCK, 3)), np.empty(longest + 2), np.empty((128, 4))
    moved = np.empty_like(arrays.cp)
    piece_start = np.empty(len(arrays.loop_start), dtype=np.int64)
    measures = np.empty((len(arrays.loop_start) - 1, MEASURES))
    factor = 2  # most curves need one or two pieces a span; the loop below copes with the others
    while True:
        pi = np.empty((factor * (beziers + 8), 4), dtype=np.int64)
        pf = np.empty((len(pi), columns.PF_WIDTH))
        pcp = np.empty((factor * (rows + 8 * columns.BLOCK), 3))
        n = draw_outline(
            use_loop, *arrays[:-1], *frame.origin, frame.scale, moved, pi, pf, pcp, piece_start, measures, work, breaks, stack
        )
        if n >= 0:
            return Outline(frame, pi[:n], pf[:n], pcp, piece_start, measures, work, stack)
        factor *= 4
