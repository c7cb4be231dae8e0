"""Every rule of a valid domain, and what the caller is told when one is broken.

    1. form        types, keys, counts                          mat_core.model.reading
    2. splines     finite, clamped, positive weights, one piece  mat_core.model.splines
    3. joins       each edge begins where the last one ended     join_problems
                   what is too small to matter is put right      mat_core.model.healing
    4. meetings    no loop meets itself or another               mat_core.model.meetings
    5. area        each loop encloses some                       area_problems
    6. nesting     holes inside, no hole in a hole               mat_core.model.nesting

A rule is checked on all that passed the rules before it, so that one call names everything that is wrong.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.errors import InvalidDomain, Problem
from mat_core.kernels.measuring import AREA, LENGTH
from mat_core.model.healing import Note, joined_ends, shrink_specks
from mat_core.model.loop import TOUCH, BoundaryArrays, Frame, Outline, box_of, frame_of, outline_of
from mat_core.model.meetings import Meeting, find_meetings, meeting_problems
from mat_core.model.nesting import nesting_problems
from mat_core.model.reading import Draft, read
from mat_core.model.splines import spline_problems
from mat_core.model.survey import Survey
from mat_core.model.values import edge_pointer, loop_name, loop_pointer

CODES = {
    "invalid-request": "the document's form: a wrong type, a missing or unknown key, an option out of range",
    "too-complex": "more control points than are accepted",
    "out-of-range": "numbers too large, too small or too unequal to compute with",
    "invalid-spline": "degree, knots and control points do not make one continuous curve",
    "non-finite": "a coordinate, weight or knot is not a finite number",
    "non-positive-weight": "a weight is zero or negative",
    "zero-length-edge": "an edge is a single point",
    "open-loop": "an edge does not begin where the edge before it ends",
    "self-intersection": "a loop crosses itself, touches itself or runs back along itself",
    "loops-cross": "two loops cross",
    "loops-touch": "two loops touch without crossing",
    "duplicate-loop": "a loop is given twice",
    "empty-domain": "a loop encloses no area, or has no edges",
    "hole-outside": "a hole lies outside the outer loop",
    "hole-in-hole": "a hole lies inside another hole",
}

SMALLEST = 1e-150  # size of a domain, likewise
COARSEST = 1e4  # units in the last place across the domain: with fewer the input is rounding, not shape
JOIN = 1e-10  # of the size: ends no farther apart are one point
JOIN_ULPS = 8.0  # of the largest coordinate: what transforms of the input leave
SHAPELESS = 4e-15  # of the size: what normalised coordinates cannot hold
FLATTEST = 4.0  # gaps of mean width below which a loop has no area
PROBLEM_LIMIT = 1000


class Checked(NamedTuple):
    """A domain that kept all rules."""

    arrays: BoundaryArrays
    given: BoundaryArrays  # before anything was healed; the same object when nothing was
    outline: Outline
    options: dict[str, Any]
    notes: tuple[Note, ...]


def check(obj: object, limit: int) -> Checked:
    """Read a domain object and hold it to every rule.

    Parameters
    ----------
    obj : object
        What a JSON parser made of the document.
    limit : int
        Largest number of control points accepted.

    Returns
    -------
    Checked
        Its arrays, with `reversed` set, and its outline.

    Raises
    ------
    InvalidDomain
        With all problems.
    """
    draft = read(obj, limit)
    arrays, seen, problems = draft.arrays, draft.seen, draft.problems
    if len(arrays.degree) == 0:
        raise InvalidDomain(problems)
    sound = np.ones(len(arrays.degree), dtype=np.bool_)
    rounding = JOIN_ULPS * math.ulp(seen.largest)
    join = max(JOIN * seen.size, rounding)
    problems.extend(spline_problems(draft, max(SHAPELESS * seen.size, rounding), join, sound))
    use = draft.whole.copy()
    problems.extend(join_problems(draft, sound, join, use))
    if use.any():
        arrays, notes = shrink_specks(draft, use, max(TOUCH * seen.size, rounding), join)
        frame = _frame(arrays, seen, use, healed=arrays is not draft.arrays)
        too_fine = range_problem(frame, seen.largest)
        if too_fine is not None:
            raise InvalidDomain([*_sorted(problems), too_fine])
        outline = outline_of(arrays, use, frame)
        meetings, complete = find_meetings(outline)
        flat = flat_loops(outline, use, meetings)
        problems.extend(area_problems(flat))
        problems.extend(meeting_problems(outline, draft, meetings, flat))
        if complete:
            problems.extend(nesting_problems(outline, meetings, flat))
        else:  # nothing is said of which loop is in which: that is told apart pair by pair, and too many pairs are as one
            if problems:
                code, text = problems[-1].code, "the boundary meets itself in more places than are listed; mend these first"
            else:
                code, text = "too-complex", "too many pieces of the boundary are intertwined; cut the domain into parts"
            raise InvalidDomain([*_sorted(problems), Problem(code, "", text)])
    if problems:
        raise InvalidDomain(_sorted(problems))
    runs_left = outline.measures[:, 0] > 0.0
    runs_left[1:] = ~runs_left[1:]
    notes.extend(joined_ends(draft))
    return Checked(arrays._replace(reversed=~runs_left), draft.arrays, outline, draft.options, tuple(notes))


def _sorted(problems: list[Problem]) -> list[Problem]:
    """In the order of the document, whole-document problems first, cut to a readable number."""
    order = sorted(problems, key=lambda p: (-1 if p.loop is None else p.loop, -1 if p.edge is None else p.edge))
    if len(order) > PROBLEM_LIMIT:
        rest = len(order) - PROBLEM_LIMIT
        text = f"{rest} more problems of the same kinds are not listed"
        order[PROBLEM_LIMIT:] = [Problem(order[PROBLEM_LIMIT].code, "", text)]
    return order


def _frame(arrays: BoundaryArrays, seen: Survey, use: NDArray[np.int64], healed: bool) -> Frame:
    """The frame of the loops in use."""
    if seen.sound and not healed and use.all():
        return frame_of(seen.box, seen.largest, seen.widest_gap)
    used = use.astype(np.bool_)
    rows = np.repeat(used, np.diff(arrays.cp_start[arrays.loop_start]))
    closed = np.where(np.repeat(used, np.diff(arrays.loop_start)), seen.gaps, 0.0)
    return frame_of(box_of(arrays.cp[rows]), seen.largest, float(closed.max()))


def range_problem(frame: Frame, largest: float) -> Problem | None:
    """A domain too small for its coordinates or for floats."""
    if frame.size < SMALLEST:
        text = f"the domain is {frame.size:.3g} across; sizes below {SMALLEST:g} cannot be computed with. Scale it up"
        return Problem("out-of-range", "", text)
    if frame.size < COARSEST * math.ulp(largest):
        text = (
            f"the domain is {frame.size:.3g} across but its coordinates reach {largest:.3g}, which leaves no digits "
            "for its shape. Move it nearer to the origin before rounding"
        )
        return Problem("out-of-range", "", text)
    return None


# ------------------------------------------------------------------------------------------------------------ joins


def following_edges(arrays: BoundaryArrays) -> NDArray[np.int64]:
    """The edge after each one (E,), the first of the loop after its last."""
    starts = arrays.loop_start
    following = np.arange(1, len(arrays.degree) + 1)
    filled = starts[1:] > starts[:-1]
    following[starts[1:][filled] - 1] = starts[:-1][filled]
    return following


def join_problems(
    draft: Draft, sound: NDArray[np.bool_], join: float, use: NDArray[np.int64]
) -> Iterator[Problem]:
    """Each edge begins where the last one ended; clears `use` (L,) for open loops and those with an unsound edge."""
    arrays, seen = draft.arrays, draft.seen
    starts = arrays.loop_start
    all_sound = bool(sound.all())
    if all_sound and seen.widest_gap <= join:
        return
    if not all_sound:
        use[np.unique(np.searchsorted(starts, np.flatnonzero(~sound), side="right") - 1)] = 0
    following = following_edges(arrays)
    ends = arrays.cp[arrays.cp_start[1:] - 1, :2]
    begins = arrays.cp[arrays.cp_start[:-1], :2][following]
    apart = ~(seen.gaps <= join)
    for e in np.flatnonzero(apart & sound & sound[following]).tolist():
        loop, edge = draft.place_of(e)
        then = int(draft.edge_of[following[e]])
        closing = e == starts[loop + 1] - 1
        # An edge left out for its form would stand between these two.
        if then != (0 if closing else edge + 1) or (closing and draft.whole[loop] == 0):
            continue
        use[loop] = 0
        (x, y), (bx, by) = ends[e].tolist(), begins[e].tolist()
        text = (
            f"{loop_name(loop)} is open: edge {edge} ends at ({x:.17g}, {y:.17g}) but edge {then} begins at "
            f"({bx:.17g}, {by:.17g}), {math.hypot(bx - x, by - y):.3g} away; ends must meet within {join:.3g}: "
            "give both the same point, or the edge that is missing between them"
        )
        u = float(arrays.knots[arrays.knot_start[e + 1] - 1])
        yield Problem("open-loop", edge_pointer(loop, edge), text, loop, edge, u, x, y, edge_pointer(loop, then))


# ------------------------------------------------------------------------------------------------------------- area


def flat_loops(outline: Outline, use: NDArray[np.int64], meetings: list[Meeting]) -> set[int]:
    """Loops in use without mean width; one that truly crosses itself may have no net area and yet enclose some."""
    area, length = np.abs(outline.measures[:, AREA]), outline.measures[:, LENGTH]
    # What vanished altogether has no length either.
    thin = {loop for loop in np.flatnonzero(area <= FLATTEST * outline.frame.gap * length).tolist() if use[loop]}
    return thin - {m.loops[0] for m in meetings if m.loops[0] == m.loops[1] and m.crosses}


def area_problems(flat: set[int]) -> Iterator[Problem]:
    """A problem for each loop without area."""
    for loop in sorted(flat):
        text = (
            f"{loop_name(loop)} encloses no area: it runs back along itself. Give a loop with an inside, or leave it out"
        )
        yield Problem("empty-domain", loop_pointer(loop), text, loop)
