"""How many leaves an axis must have, counted on the boundary alone.

Every convex vertex is a leaf. So is every local maximum of positive curvature (LMPC) whose osculating disc is empty,
and every circular arc whose disc is empty and touches nothing else. Curvature is looked at on the grid of all cells,
between vertices; a maximum may be smooth, sit at a jump of the curvature, or be a plateau (an arc).
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from tests.assertions import contact_parts
from tests.reference import SMOOTH_TURN, Bend, Floats, Ints, Reference

LARGEST = 2.0  # no disc of a domain of size one is larger
LEVEL = 1e-8  # relative change of curvature below which an arc is circular
ALL_BUT_ARC = 1e-4  # relative change of curvature along an edge that is an arc to the eye
ROUNDED = 1e-13  # that of a true arc, at least
SLIGHT = 1e-10  # relative change of curvature that is none: rounding
JOINT_BLUR = 1e-11  # rounding of a cell's second derivative, in its own parameter: what two cells differ by where they meet
EMPTY = 1e-10  # a disc this much too large still counts as empty
DOUBT = 1e-7  # up to here nobody can say
SHARE_EMPTY, SHARE_DOUBT = 1e-4, 1e-2  # of its radius, if that is less
SHARP_EMPTY, SHARP_SHARE = 1e-12, 1e-8  # beyond this and this share of its radius it may be none
FAINT = 1e-7  # radians; a rise of the curvature to above zero that turns by less is not seen with certainty,
FAINT_DEPTH = 1e-15  # nor one that turns by less than this over its width
RIPPLE = 0.01  # of the curvature in such a bend, between two of its maxima
LEAST_LEAF = 1e-10  # smaller ones may be one with what is near them
AT_VERTEX = 1e-11  # a bend that is a vertex begins and ends this near to it
AROUND = 4  # points of the grid on either side that a maximum is above; where cells meet, rounding makes maxima of one
FLAT = 1e-4  # radians; a corner that turns by less is not seen with certainty
ROUGH = 1e-3  # the disc at the highest point of the grid is this far from empty: so is the sharpened one


class Leaves(NamedTuple):
    """Number of leaves; `doubtful` ones are not counted."""

    certain: int
    doubtful: int


def count_leaves(reference: Reference) -> Leaves:
    """Leaves of the axis, by corners and curvature."""
    flat_corners = sum(SMOOTH_TURN < c.turn <= FLAT or c.cell in reference.undone for c in reference.corners)
    vertices = np.array([c.point for c in reference.corners if c.turn > 0]).reshape(-1, 2)
    at_one = sum(bool((np.linalg.norm(vertices[:i] - v, axis=1) < AT_VERTEX).any()) for i, v in enumerate(vertices))
    flat_corners += at_one  # what looks like two vertices may be one bend
    count = len(vertices) - flat_corners
    at_rest = {int(i) for i in np.nonzero(reference.stalls)[0]}
    doubtful = 2 * sum(c.turn < 0 and c.cell in at_rest for c in reference.corners)  # a leaf of radius 0 for each side
    # right before a bend and right after it there may be a leaf that is as small
    doubtful += sum(2 + max(0, tips(reference, b) - (b.turn > reference.smooth_angle)) for b in reference.bends)
    for cell, s, flat, hidden, faint in candidates(reference):
        p, normal, curvature = (v[0] for v in reference.at(np.array([cell]), np.array([s])))
        if not curvature < 1 / LEAST_LEAF:
            doubtful += 1
            continue
        center = p + normal / curvature
        short = 1 / curvature - reference.boundary.contacts(center[None])[0][0]
        if short > min(DOUBT, SHARE_DOUBT / curvature):
            continue
        if short > min(EMPTY, SHARE_EMPTY / curvature):
            doubtful += hidden
        elif short > SHARP_EMPTY + SHARP_SHARE / curvature:
            doubtful += 1
        elif flat and (flat_corners or hidden > 1):
            doubtful += hidden  # an arc between corners that are too flat to see, or one that is none to more digits
        elif flat:
            count += len(contact_parts(reference, center, 1e-9)) == 1 and not _whole(reference, center)
        else:
            count += not faint
            doubtful += faint
    return Leaves(int(count), doubtful + flat_corners)


def tips(reference: Reference, bend: Bend) -> int:
    """Leaves that may stand inside a bend that is a vertex to any disc but its own: its corners and maxima of its curvature."""
    steps = np.linspace(0, 1, reference.boundary.grid.shape[1])[1:-1]
    k = reference.at(np.repeat(bend.cells, len(steps)), np.tile(steps, len(bend.cells)))[2]
    # a reflex corner inside parts its sides
    parted = len(steps) * (np.nonzero(reference.turns[bend.cells] < -reference.smooth_angle)[0] + 1)
    k = np.insert(k, parted, -np.finfo(float).max)
    rising, low, high, count = True, k[0], k[0], 0
    for value in k:
        low, high = min(low, value), max(high, value)
        if rising and value < high - RIPPLE * abs(high):
            count, rising, low = count + (high > 0), False, value
        elif not rising and value > low + RIPPLE * abs(low):
            rising, high = True, value
    joints = reference.turns[[bend.before, *bend.cells]]
    return int(count + (rising and high > 0) + np.count_nonzero(joints > reference.smooth_angle))


def nearly_circular(reference: Reference) -> int:
    """Leaves that edges may have which are arcs but for next to nothing: two for each of these."""
    count = 0
    for owner in range(len(reference.names)):
        cells = np.repeat(np.nonzero(reference.boundary.owner == owner)[0], 3)
        k = reference.at(cells, np.tile([0.1, 0.5, 0.9], len(cells) // 3))[2]
        count += 2 * bool(k.min() > 0 and ROUNDED * k.max() < np.ptp(k) < ALL_BUT_ARC * k.max())
    return count


def _whole(reference: Reference, center: Floats) -> bool:
    return contact_parts(reference, center, 1e-9)[0] > 2 * np.pi - 1e-6


def candidates(reference: Reference) -> list[tuple[int, float, bool, int, bool]]:
    """Maxima of positive curvature as (cell, s, plateau, slight maxima on the plateau, faint), once each.

    Faint ones rise from below zero and fall again so soon that a disc that touches on both sides reaches over them by rounding.
    """
    found: list[tuple[int, float, bool, int, bool]] = []
    seen: list[Floats] = []
    convex = np.array([c.point for c in reference.corners if c.turn > 0]).reshape(-1, 2)
    for cells, s in smooth_chains(reference):
        point, normal, k = reference.at(cells, s)
        k = np.where(np.isnan(k), np.copysign(1e300, np.nan_to_num(np.roll(k, 1)) + np.nan_to_num(np.roll(k, -1))), k)
        k = joined(reference, cells, k)
        runs = level_runs(k)
        peaks = [
            (a, b)
            for a, b in runs
            if 1e200 > k[a] >= 1 / LARGEST
            and k[max(0, a - AROUND) : a].max(initial=-np.inf) <= k[a]
            and k[b + 1 : b + 1 + AROUND].max(initial=-np.inf) <= k[b]
        ]
        if not peaks:
            continue
        tops = np.array([(a + b) // 2 for a, b in peaks])
        short = 1 / k[tops] - reference.boundary.contacts(point[tops] + normal[tops] / k[tops, None])[0]
        for (a, b), much in zip(peaks, short, strict=True):
            if much > ROUGH:
                continue
            m = (a + b) // 2
            flat = b - a >= 8
            end = point[0] if a == 0 else point[-1] if b == len(k) - 1 else None
            if end is not None and not flat and np.any(np.linalg.norm(convex - end, axis=1) < AT_VERTEX):
                continue  # the convex vertex is the leaf; at a reflex one curvature may have its peak
            cell, at = (int(cells[m]), float(s[m])) if flat else sharpen(reference, cells[a : b + 1], s[a : b + 1])
            disc = np.array([*(point[m] + normal[m] / k[m]), 1 / k[m]])
            gaps = [np.abs(disc - other).max() for other in seen if flat]
            if min(gaps, default=1.0) < EMPTY:
                continue
            hidden = slight_maxima(k[a : b + 1]) + int(min(gaps, default=1.0) < 1e-7)
            if flat:
                seen.append(disc)
            width = 0.0 if flat else rise(reference, cells, s, k, m)
            faint = 0 < k[m] * width < FAINT or 0 < k[m] * width * width < FAINT_DEPTH
            found.append((cell, at, flat, hidden, faint))
    return found


def rise(reference: Reference, cells: Ints, s: Floats, k: Floats, top: int) -> float:
    """How far a maximum of the curvature is from where that rises above zero before it, or falls below after it; else 0."""
    way = 0.0
    peak = reference.at(cells[[top]], s[[top]])[0][0]
    for step in (-1, 1):
        below = top
        while 0 <= below < len(k) and k[below] >= 0:
            below += step
        if not 0 <= below < len(k):
            continue
        lo, hi = float(s[below]), float(s[below - step]) if cells[below - step] == cells[below] else float(step < 0)
        for _ in range(60):
            middle = 0.5 * (lo + hi)
            lo, hi = (middle, hi) if reference.at(cells[[below]], np.array([middle]))[2][0] < 0 else (lo, middle)
        way += float(np.linalg.norm(reference.at(cells[[below]], np.array([lo]))[0][0] - peak))
    return way


def smooth_chains(reference: Reference) -> list[tuple[Ints, Floats]]:
    """The grid of the boundary in its order, cut at vertices; a loop without one wraps round once more."""
    grid = reference.boundary.grid.shape[1]
    loop_of = np.array([reference.names[o][0] for o in reference.boundary.owner])
    cuts = {c.cell for c in reference.corners} | {b.before for b in reference.bends}
    chains = []
    for loop in range(len(reference.loops)):
        cells = [int(c) for c in np.nonzero(loop_of == loop)[0]]
        ends = [i for i, c in enumerate(cells) if c in cuts]
        if not ends:
            k = reference.at(np.repeat(cells, grid), np.tile(np.linspace(0, 1, grid), len(cells)))[2]
            start = int(np.argmin(np.nan_to_num(k, nan=np.inf))) // grid
            pieces = [cells[start:] + cells[: start + 1]]
        else:
            turned = cells[ends[-1] + 1 :] + cells[: ends[-1] + 1]
            stops = [0, *(turned.index(cells[i]) + 1 for i in sorted(ends, key=lambda i: turned.index(cells[i])))]
            pieces = [turned[a:b] for a, b in pairwise(stops)]
        for piece in ([c for c in piece if not reference.bent[c]] for piece in pieces):
            if not piece:
                continue
            chains.append(
                (np.repeat(np.array(piece, dtype=np.int64), grid), np.tile(np.linspace(0, 1, grid), len(piece)))
            )
    return chains


def joined(reference: Reference, cells: Ints, k: Floats) -> Floats:
    """Curvature with one value where two cells of one edge meet: near a zero of the speed their roundings differ widely."""
    owner = np.asarray(reference.boundary.owner)[cells]
    ends = np.nonzero((owner[1:] == owner[:-1]) & (cells[1:] == cells[:-1] + 1))[0]
    mean = 0.5 * (k[ends] + k[ends + 1])
    length = np.ptp(reference.boundary.control[cells[ends], :, :2], axis=1).max(axis=1)
    same = np.abs(k[ends + 1] - k[ends]) * length**2 < JOINT_BLUR
    result = k.copy()
    result[ends[same]] = result[ends[same] + 1] = mean[same]
    return result


def level_runs(k: Floats) -> list[tuple[int, int]]:
    """Runs of equal curvature, first and last index; most are one or two long."""
    change = np.abs(np.diff(k)) > LEVEL * np.maximum(np.abs(k[1:]), np.abs(k[:-1]))
    breaks = np.nonzero(change)[0]
    return list(zip([0, *(int(b) + 1 for b in breaks)], [*(int(b) for b in breaks), len(k) - 1], strict=True))


def slight_maxima(k: Floats) -> int:
    """Maxima of a nearly constant curvature that stand out of the rounding, at least one."""
    blur = SLIGHT * np.abs(k).max()
    count, rising, extreme = 0, True, k[0]
    for value in k:
        extreme = max(extreme, value) if rising else min(extreme, value)
        if abs(value - extreme) > blur:
            count += rising
            rising, extreme = not rising, value
    return max(count + rising, 1)


def sharpen(reference: Reference, cells: Ints, s: Floats) -> tuple[int, float]:
    """The best of a smooth maximum round a run: golden sections within half a grid step either side, cell by cell."""
    step = 1.0 / (reference.boundary.grid.shape[1] - 1)
    best, where = -np.inf, (int(cells[0]), float(s[0]))
    for cell, at in zip(cells, s, strict=True):
        lo, hi = max(0.0, float(at) - step), min(1.0, float(at) + step)
        ratio = (np.sqrt(5) - 1) / 2
        for _ in range(44):
            a, b = hi - ratio * (hi - lo), lo + ratio * (hi - lo)
            ka, kb = reference.at(np.array([cell, cell]), np.array([a, b]))[2]
            lo, hi = (lo, b) if ka >= kb else (a, hi)
        for trial in (0.5 * (lo + hi), float(at)):
            k = float(reference.at(np.array([cell]), np.array([trial]))[2][0])
            if k > best:
                best, where = k, (int(cell), trial)
    return where
