"""From the JSON object to flat arrays: types, keys and counts, nothing about geometry.

A well-formed object takes the short way: its numbers are gathered in a few passes over flat lists. Only when something
is out of place is every edge looked at by itself, to name each fault and to keep the edges that are sound.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mat_core.errors import Problem
from mat_core.kernels.survey import FACTS, read_edges
from mat_core.memory import maker
from mat_core.model.edges import EDGE_KEYS, HIGHEST_DEGREE, Edge, read_edge
from mat_core.model.loop import BoundaryArrays
from mat_core.model.options import read_options
from mat_core.model.survey import HALF_RANGE, Survey, surveyed
from mat_core.model.values import describe, pointer_to, short

CONTROL_POINT_LIMIT = 2_000_000

ANNOTATIONS = frozenset({"note", "truth"})  # of a domain, any JSON value: for people and test benches, never read
DOMAIN_KEYS = frozenset({"outer", "holes", "options", "name"}) | ANNOTATIONS
NUMBERS = frozenset({float, int})
PAIRS = frozenset({list, tuple})


@dataclass(slots=True)
class Draft:
    """What could be read, what was measured of it, and the faults of form found on the way.

    `edge_of` (E,) is each edge's index in its loop of the document; a loop is `whole` when none of its edges was left
    out.
    """

    arrays: BoundaryArrays
    seen: Survey
    edge_of: NDArray[np.int64]
    whole: NDArray[np.int64]
    options: dict[str, Any] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def place_of(self, e: int) -> tuple[int, int]:
        """Loop of edge e of the flat numbering, and its index in that loop of the document."""
        loop = int(np.searchsorted(self.arrays.loop_start, e, side="right")) - 1
        return loop, int(self.edge_of[e])


def read(obj: object, limit: int = CONTROL_POINT_LIMIT) -> Draft:
    """Read a domain object.

    Parameters
    ----------
    obj : object
        What a JSON parser made of the document.
    limit : int
        Largest number of control points accepted.

    Returns
    -------
    Draft
        Arrays of all sound edges and the problems of form.
    """
    problems: list[Problem] = []
    loops = _read_loops(obj, problems)
    options = {}
    if isinstance(obj, Mapping) and obj.get("options") is not None:
        options = read_options(obj["options"], problems)
    if not problems:
        gathered = _gather(loops)
        if gathered is not None and len(gathered[0].cp) <= limit:
            return Draft(*gathered, np.ones(len(loops), dtype=np.int64), options)
    total = sum(_count_points(edge) for loop in loops for edge in loop)
    if total > limit:
        text = (
            f"the boundary has {total} control points; at most {limit} are accepted. Simplify it, or cut it into parts"
        )
        problems.append(Problem("too-complex", "", text))
        loops = []
    kept: list[list[Edge]] = []
    edge_ids: list[int] = []
    whole: list[int] = []
    for number, loop in enumerate(loops):
        read_edges = [(i, read_edge(edge, number, i, problems)) for i, edge in enumerate(loop)]
        sound = [(i, edge) for i, edge in read_edges if edge is not None]
        kept.append([edge for _, edge in sound])
        edge_ids.extend(i for i, _ in sound)
        whole.append(int(len(sound) == len(loop) and len(loop) > 0))
    gathered = _gather(kept, empty_loops=True)
    assert gathered is not None
    arrays, seen, _ = gathered
    return Draft(arrays, seen, np.array(edge_ids, dtype=np.int64), np.array(whole, dtype=np.int64), options, problems)


def _count_points(edge: object) -> int:
    points = edge.get("control_points") if isinstance(edge, Mapping) else None
    if isinstance(points, np.ndarray) and points.ndim == 0:
        return 0
    return len(points) if isinstance(points, list | tuple | np.ndarray) else 0


def _read_loops(obj: object, problems: list[Problem]) -> list[list[Any]]:
    """The loops as lists of whatever they hold; faults of the document's frame go to `problems`."""

    def fault(pointer: str, text: str, code: str = "invalid-request") -> None:
        problems.append(Problem(code, pointer, text))

    if not isinstance(obj, Mapping):
        fault("", f"a domain is an object with the keys outer and holes, not {describe(obj)}")
        return []
    for key in obj:
        if key not in DOMAIN_KEYS:
            fault(pointer_to("", key), f"unknown key {short(key)}; a domain has outer, holes, options, name, note and truth")
    if obj.get("name") is not None and not isinstance(obj["name"], str):
        fault("/name", f"name must be a string, not {describe(obj['name'])}")
    loops: list[list[Any]] = [[]]
    if "outer" not in obj:
        fault("/outer", "outer is missing: give the outer loop as a list of edges")
    elif not isinstance(obj["outer"], list | tuple):
        fault("/outer", f"outer must be a list of edges, not {describe(obj['outer'])}")
    elif not obj["outer"]:
        fault("/outer", "the outer loop has no edges, so the domain is empty; give at least one", "empty-domain")
    else:
        loops[0] = list(obj["outer"])
    holes = obj.get("holes")
    if holes is None:
        return loops
    if not isinstance(holes, list | tuple):
        fault("/holes", f"holes must be a list of loops, not {describe(holes)}")
        return loops
    for i, hole in enumerate(holes):
        loops.append([])
        if not isinstance(hole, list | tuple):
            fault(f"/holes/{i}", f"a hole must be a list of edges, not {describe(hole)}")
        elif not hole:
            fault(f"/holes/{i}", f"hole {i} has no edges; leave it out or give at least one", "empty-domain")
        else:
            loops[-1] = list(hole)
    return loops


Gathered = tuple[BoundaryArrays, Survey, NDArray[np.int64]]  # with each edge's place in its loop


def _gather(loops: list[list[Any]], empty_loops: bool = False) -> Gathered | None:
    """The flat arrays of well-formed loops, or None when anything at all is out of place."""
    edges = list(chain.from_iterable(loops))
    if not (empty_loops or all(loops)) or not set(map(type, edges)) <= {dict} or not set(chain.from_iterable(edges)) <= EDGE_KEYS:
        return None
    degrees = [edge.get("degree") for edge in edges]
    own = [edge.get("control_points") for edge in edges]
    knots = [edge.get("knots") for edge in edges]
    weights = [edge.get("weights") for edge in edges]
    if not (set(map(type, degrees)) <= {int} and set(map(type, own)) <= {list}):
        return None
    counts = list(map(len, own))
    knot_counts = []
    weight_counts = []
    for p, n, k, w in zip(degrees, counts, knots, weights, strict=True):
        if not 1 <= p <= HIGHEST_DEGREE or n <= p or (k is None and n != p + 1):
            return None
        if not (k is None or (type(k) is list and len(k) == n + p + 1)):
            return None
        if not (w is None or (type(w) is list and len(w) == n)):
            return None
        knot_counts.append(0 if k is None else n + p + 1)
        weight_counts.append(0 if w is None else n)
    points = list(chain.from_iterable(own))
    if not (set(map(type, points)) <= PAIRS and set(map(len, points)) <= {2}):
        return None
    numbers = list(chain.from_iterable(chain(points, filter(None, knots), filter(None, weights))))
    if not set(map(type, numbers)) <= NUMBERS:
        return None
    try:
        values = np.fromiter(numbers, np.float64, len(numbers))  # twice as fast as np.array
    except OverflowError:
        return None
    counted = [*degrees, *counts, *knot_counts, *weight_counts, *map(len, loops)]
    table = np.fromiter(counted, np.int64, len(counted))
    return _laid_out(table, values, len(edges), len(points), sum(degrees), len(loops))


def _laid_out(
    table: NDArray[np.int64], values: NDArray[np.float64], edges: int, points: int, degrees: int, loops: int
) -> Gathered:
    """The arrays of what `mat_core.kernels.survey` takes; `degrees`: their sum."""
    make = maker(edges)
    arrays = BoundaryArrays(
        make(edges, np.int64),
        make(edges + 1, np.int64),
        make((points, 3)),
        make(edges + 1, np.int64),
        make(points + degrees + edges),
        np.empty(loops + 1, dtype=np.int64),
        np.zeros(loops, dtype=np.bool_),
    )
    edge_of = np.empty(edges, dtype=np.int64)
    extent, gaps, facts = np.empty(edges), np.empty(edges), np.empty(FACTS)
    read_edges(table, values, HALF_RANGE, *arrays[:-1], edge_of, extent, gaps, facts)
    return arrays, surveyed(facts, extent, gaps, arrays.cp), edge_of
