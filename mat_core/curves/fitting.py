"""The pieces of all strips: small axes in one call, large ones in parts, on several threads.

Stretches share nothing, so a part is made of whole ones and has room of its own; its pieces are numbered on from those before.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mat_core.boundary.sites import SiteTable
from mat_core.curves.fit import fit_strips, travel
from mat_core.curves.pieces import NO_FIT, NO_ROOM, P_PART, P_ROW, Pieces, new_pieces
from mat_core.curves.way import Track, new_scratch, new_track
from mat_core.errors import NotCertified
from mat_core.kernels.layout import EDGE, LOOP
from mat_core.memory import joined_one_by_one
from mat_core.model.edges import HIGHEST_DEGREE
from mat_core.threads import Bounds, cut_between, each
from mat_core.topology.graph import AxisGraph
from mat_core.topology.skeleton import Skeleton


def fit_all(
    table: SiteTable, skeleton: Skeleton, graph: AxisGraph, tolerance: float, threads: int
) -> tuple[Pieces, int]:
    """Pieces of all segments and their number, within a tolerance in normalised units as far as rounding lets them."""
    made = _fit_parts(table, skeleton, graph, tolerance, threads)
    for _, count in made:
        if count <= NO_FIT:
            raise _cannot_follow(table, skeleton, int(graph.run_strip[NO_FIT - count]), tolerance)
    return made[0] if len(made) == 1 else _gathered(made)


def _fit_parts(
    table: SiteTable, skeleton: Skeleton, graph: AxisGraph, tolerance: float, threads: int
) -> list[tuple[Pieces, int]]:
    """What `_fit_part` gives for each part; the track, as large as all pieces, is let go of before they are gathered."""
    n = len(graph.run_strip)
    track = new_track(table.si, table.sf, table.cp, skeleton.disc, n)
    travel(track, skeleton.strip_i, skeleton.strip_s, graph.run_start, graph.run_strip, graph.run_forward,
           np.empty((2 * HIGHEST_DEGREE + 2, 2)))
    parts = cut_between(np.flatnonzero(~track.joined), n) if n else [(0, 0)]
    return each(lambda part: _fit_part(track, part, tolerance), parts, threads)


def _fit_part(track: Track, part: Bounds, tolerance: float) -> tuple[Pieces, int]:
    """The pieces of the strips from .. to - 1 and their number, or NO_FIT less the row of the strip that cannot be followed."""
    begin, end = part
    scratch = new_scratch()
    room = end - begin + 8
    count = NO_ROOM
    while count == NO_ROOM:
        # ends after the first growth but for curves of many pieces; at the latest at MAX_PIECES for each stretch
        room *= 4
        made = new_pieces(room, end - begin)
        count = fit_strips(track, scratch, made, tolerance, begin, end)
    alone = end - begin == len(track.joined)
    return made if alone or count < 0 else _used(made, count), count


def _used(p: Pieces, count: int) -> Pieces:
    """A copy of the filled rows, for a part that waits for the others: its room is many times as large."""
    rows, parts = p.piece_i[count, P_ROW], p.piece_i[count, P_PART]
    return Pieces(p.first, p.piece_i[: count + 1].copy(), p.piece_f[:count].copy(), p.cp[:rows].copy(),
                  p.part_i[:parts].copy(), p.part_f[:parts].copy())  # fmt: skip


def _gathered(made: list[tuple[Pieces, int]]) -> tuple[Pieces, int]:
    """The pieces of all parts in one table, numbered on."""
    pieces = rows = parts = 0
    filled = []
    for p, count in made:
        more_rows, more_parts = p.piece_i[count, P_ROW], p.piece_i[count, P_PART]
        p.first[:] += pieces
        p.piece_i[: count + 1, P_ROW] += rows
        p.piece_i[: count + 1, P_PART] += parts
        filled.append(Pieces(p.first[:-1], p.piece_i[:count], p.piece_f[:count], p.cp[:more_rows], p.part_i[:more_parts],
                             p.part_f[:more_parts]))
        pieces += count
        rows += more_rows
        parts += more_parts
    last, count = made[-1]
    filled.append(Pieces(last.first[-1:], last.piece_i[count : count + 1], last.piece_f[:0], last.cp[:0], last.part_i[:0],
                         last.part_f[:0]))
    columns: list[Any] = list(zip(*filled, strict=True))
    made.clear()
    filled.clear()
    return Pieces(*joined_one_by_one(columns)), pieces


def _cannot_follow(table: SiteTable, skeleton: Skeleton, strip: int, tolerance: float) -> NotCertified:
    """The diagnosis for a strip that was given up, at the middle of its two end discs."""
    site_a, site_b, disc0, disc1 = (int(i) for i in skeleton.strip_i[strip])
    middle = 0.5 * (skeleton.disc[disc0, :2] + skeleton.disc[disc1, :2]) / table.scale + table.origin
    sides = " and ".join(f"edge {table.si[i, EDGE]} of loop {table.si[i, LOOP]}" for i in (site_a, site_b))
    detail = (f"curves: the axis between {sides} does not lead from one of its end discs to the other, so no curve follows it "
              f"within {tolerance / table.scale:.3g}; the discs there were probably joined or told apart wrongly")
    return NotCertified(detail, (float(middle[0]), float(middle[1])) if np.isfinite(middle).all() else None)
