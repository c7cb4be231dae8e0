"""The pieces of all strips: small axes in one call, large ones in parts, on several threads.

Stretches share nothing, so a part is made of whole ones and has room of its own; its pieces are numbered on from those before.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.boundary.sites import SiteTable
from mat_core.curves.fit import fit_strips, travel
from mat_core.curves.interval import CHEBYSHEV, MAX_DEGREE, ROWS, SAMPLE_ROWS
from mat_core.curves.pieces import NO_FIT, NO_ROOM, P_PART, P_ROW
from mat_core.curves.way import END_COLUMNS, END_ROWS, MAX_STRIPS, SAMPLE_COLUMNS, WAITING
from mat_core.errors import NotCertified
from mat_core.kernels.layout import EDGE, LOOP
from mat_core.threads import Bounds, cut_between, each
from mat_core.topology.graph import AxisGraph
from mat_core.topology.skeleton import Skeleton

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Pieces(NamedTuple):
    """Pieces of strips in order of travel, and their parts: columns in `curves.pieces`.

    The pieces of a stretch stand at its first strip w, first[w] .. first[w + 1]. piece_i (P + 1, 4), piece_f (P, 2),
    piece_cp (R, 4); part_i (Q, 2), part_f (Q, 4).
    """

    first: Ints
    piece_i: Ints
    piece_f: Floats
    piece_cp: Floats
    part_i: Ints
    part_f: Floats


class _Strips(NamedTuple):
    """All strips in order and direction of travel, and where each is sampled; see `fit.travel` and `curves.way`."""

    strip_i: Ints
    strip_s: Floats
    joined: NDArray[np.bool_]
    way_i: Ints
    way_f: Floats


def fit_all(
    table: SiteTable, skeleton: Skeleton, graph: AxisGraph, tolerance: float, degree: int, threads: int
) -> Pieces:
    """Pieces of all segments, within a tolerance in normalised units as far as rounding lets them."""
    n = len(graph.run_strip)
    s = _Strips(np.empty((n, 4), dtype=np.int64), np.empty((n, 4)), np.empty(n, dtype=np.bool_),
                np.empty((n, 2), dtype=np.int64), np.empty((n, 4)))  # fmt: skip
    travel(table.si, skeleton.strip_i, skeleton.strip_s, graph.run_start, graph.run_strip, graph.run_forward, s.strip_i,
           s.strip_s, s.joined)

    def fit(part: Bounds) -> Pieces | int:
        return _fit_part(table, skeleton.disc, s, part, tolerance, degree)

    made = []
    for pieces in each(fit, cut_between(np.flatnonzero(~s.joined), n) if n else [(0, 0)], threads):
        if isinstance(pieces, int):
            raise _cannot_follow(table, skeleton, int(graph.run_strip[pieces]), tolerance)
        made.append(pieces)
    return made[0] if len(made) == 1 else _gathered(made)


def _fit_part(table: SiteTable, disc: Floats, s: _Strips, part: Bounds, tolerance: float, degree: int) -> Pieces | int:
    """The pieces of the strips from .. to - 1, or the row of the strip that cannot be followed."""
    begin, end = part
    first = np.empty(end - begin + 1, dtype=np.int64)
    room = end - begin + 8
    count = NO_ROOM
    while count == NO_ROOM:
        room *= 4
        piece_i = np.empty((room + 1, 4), dtype=np.int64)
        piece_f = np.empty((room, 2))
        piece_cp = np.empty((ROWS * room, 4))
        part_i = np.empty((room + end - begin, 2), dtype=np.int64)
        part_f = np.empty((room + end - begin, 4))
        # ends after the first growth but for curves of many pieces; at the latest at MAX_PIECES for each stretch
        count = fit_strips(
            table.si, table.sf, table.cp, disc, s.strip_i, s.strip_s, s.joined, tolerance, degree,
            np.empty((END_ROWS, END_COLUMNS)), np.empty((WAITING, END_COLUMNS)), np.empty((SAMPLE_ROWS, SAMPLE_COLUMNS)),
            np.empty((4, 3)), np.empty((MAX_DEGREE, 3)), np.empty((MAX_DEGREE, 3)), CHEBYSHEV, np.empty((MAX_STRIPS, 4)),
            np.empty(ROWS), np.empty(3), np.empty(3), s.way_i, s.way_f, piece_i, piece_f, piece_cp, part_i, part_f, first,
            begin, end)
    if count <= NO_FIT:
        return int(NO_FIT - count)
    rows, parts = piece_i[count, P_ROW], piece_i[count, P_PART]
    made = Pieces(first, piece_i[: count + 1], piece_f[:count], piece_cp[:rows], part_i[:parts], part_f[:parts])
    # copies of what waits for the other parts, for the room is many times as large
    return made if end - begin == len(s.joined) else Pieces(first, made.piece_i.copy(), made.piece_f.copy(),
                                                            made.piece_cp.copy(), made.part_i.copy(), made.part_f.copy())


def _gathered(made: list[Pieces]) -> Pieces:
    """The pieces of all parts in one table, numbered on."""
    pieces = rows = parts = 0
    for p in made:
        p.first[:] += pieces
        p.piece_i[:, P_ROW] += rows
        p.piece_i[:, P_PART] += parts
        pieces, rows, parts = p.first[-1], p.piece_i[-1, P_ROW], p.piece_i[-1, P_PART]
    last = made[-1]
    return Pieces(
        np.concatenate([*(p.first[:-1] for p in made), last.first[-1:]]),
        np.concatenate([*(p.piece_i[:-1] for p in made), last.piece_i[-1:]]),
        *(np.concatenate([p[column] for p in made]) for column in range(2, len(last))))  # fmt: skip


def _cannot_follow(table: SiteTable, skeleton: Skeleton, strip: int, tolerance: float) -> NotCertified:
    """The diagnosis for a strip that was given up, at the middle of its two end discs."""
    site_a, site_b, disc0, disc1 = (int(i) for i in skeleton.strip_i[strip])
    middle = 0.5 * (skeleton.disc[disc0, :2] + skeleton.disc[disc1, :2]) / table.scale + table.origin
    sides = " and ".join(f"edge {table.si[i, EDGE]} of loop {table.si[i, LOOP]}" for i in (site_a, site_b))
    detail = (f"curves: the axis between {sides} does not lead from one of its end discs to the other, so no curve follows it "
              f"within {tolerance / table.scale:.3g}; the discs there were probably joined or told apart wrongly")
    return NotCertified(detail, (float(middle[0]), float(middle[1])) if np.isfinite(middle).all() else None)
