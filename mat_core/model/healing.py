"""What is put right without asking, and the notes that say so. The table of it stands in the README.

    specks    edges smaller than what counts as touching, left by programs that close a contour or trim a curve to nothing:
              their direction is rounding. They stay in the numbering, shrunk to a point that no later stage looks at.
    joints    ends that miss the next edge's start by no more than the joining distance: the boundary is joined there.

The caller's own numbers are kept beside (`Domain.to_dict`, `Domain.outer`); only what is solved is healed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mat_core.model.loop import BoundaryArrays
from mat_core.model.reading import Draft
from mat_core.model.values import edge_pointer, loop_name, loop_pointer

NOTE_LIMIT = 100  # of each kind; the last one tells how many more there are


@dataclass(frozen=True)
class Note:
    """Something that was healed.

    Attributes
    ----------
    pointer : str
        JSON pointer of the edge it happened to, or of the first of several.
    text : str
        What was done, with its size in the caller's unit.
    """

    pointer: str
    text: str


def shrink_specks(draft: Draft, use: NDArray[np.int64], speck: float, join: float) -> tuple[BoundaryArrays, list[Note]]:
    """The arrays with every edge of at most the extent `speck` shrunk onto the start of the next larger one.

    Only in loops in use. A row of specks that leads farther than `join` is a shape and stays, and so does a loop of
    nothing else.
    """
    arrays, extent = draft.arrays, draft.seen.extent
    if draft.seen.sound and draft.seen.least_extent > speck:
        return arrays, []
    loop_of = np.repeat(np.arange(len(use)), np.diff(arrays.loop_start))
    small = (extent <= speck) & use.astype(np.bool_)[loop_of]
    if not small.any():
        return arrays, []
    cp = arrays.cp.copy()
    shrunk: list[int] = []
    for loop in np.unique(loop_of[small]).tolist():
        first, last = arrays.loop_start[loop : loop + 2].tolist()
        large = first + np.flatnonzero(~small[first:last])
        if len(large) == 0:
            continue
        specks = first + np.flatnonzero(small[first:last])
        following = large[np.searchsorted(large, specks) % len(large)]
        target = arrays.cp[arrays.cp_start[following], :2]
        way = np.abs(arrays.cp[arrays.cp_start[specks], :2] - target).max(axis=1)
        for e, point in zip(specks[way <= join].tolist(), target[way <= join], strict=True):
            cp[arrays.cp_start[e] : arrays.cp_start[e + 1], :2] = point
            shrunk.append(e)

    def note(e: int) -> Note:
        loop, edge = draft.place_of(e)
        text = f"{loop_name(loop)}, edge {edge}: only {extent[e]:.3g} across, less than counts as touching; passed over"
        return Note(edge_pointer(loop, edge), text)

    notes = [note(e) for e in shrunk[:NOTE_LIMIT]]
    if len(shrunk) > NOTE_LIMIT:
        notes.append(Note("", f"{len(shrunk) - NOTE_LIMIT} more edges as small are passed over"))
    return arrays._replace(cp=cp), notes


def joined_ends(draft: Draft) -> list[Note]:
    """A note for each loop whose edges do not all begin at the very point where the one before ended."""
    if draft.seen.widest_gap == 0.0:
        return []
    starts, gaps = draft.arrays.loop_start, draft.seen.gaps
    open_loops = np.unique(np.searchsorted(starts, np.flatnonzero(gaps > 0.0), side="right") - 1).tolist()
    notes = []
    for loop in open_loops[:NOTE_LIMIT]:
        own = gaps[starts[loop] : starts[loop + 1]]
        count, widest = int(np.count_nonzero(own)), int(own.argmax())
        _, edge = draft.place_of(int(starts[loop]) + widest)
        ends = f"{count} ends miss" if count > 1 else "1 end misses"
        text = f"{loop_name(loop)}: {ends} the start of the next edge, by {own[widest]:.3g} at edge {edge}"
        notes.append(Note(edge_pointer(loop, edge), text + (" at most; joined" if count > 1 else "; joined")))
    if len(open_loops) > NOTE_LIMIT:
        more = len(open_loops) - NOTE_LIMIT
        notes.append(Note(loop_pointer(open_loops[NOTE_LIMIT]), f"{more} more loops with ends that were joined"))
    return notes
