"""From the JSON object to flat arrays: types, keys and counts, nothing about geometry.

A well-formed object takes the short way: its numbers are gathered in a few passes over flat lists. Only when something
is out of place is every edge looked at by itself, to name each fault and to keep the edges that are sound.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import chain
from numbers import Integral, Real
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mat_core.errors import Problem
from mat_core.model.loop import BoundaryArrays

HIGHEST_DEGREE = 25
CONTROL_POINT_LIMIT = 2_000_000

ANNOTATIONS = frozenset({"note", "truth"})  # of a domain, any JSON value: for people and test benches, never read
DOMAIN_KEYS = frozenset({"outer", "holes", "options", "name"}) | ANNOTATIONS
EDGE_KEYS = frozenset({"degree", "control_points", "knots", "weights"})
BEZIER_KNOTS = {p: [0.0] * (p + 1) + [1.0] * (p + 1) for p in range(1, HIGHEST_DEGREE + 1)}
NUMBERS = frozenset({float, int})
PAIRS = frozenset({list, tuple})

Edge = dict[str, Any]


@dataclass(slots=True)
class Draft:
    """What could be read, with the faults of form found on the way.

    `edge_of` (E,) is each edge's index in its loop of the document; a loop is `whole` when none of its edges was left
    out.
    """

    arrays: BoundaryArrays
    edge_of: NDArray[np.int64]
    whole: NDArray[np.int64]
    options: dict[str, Any] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def place_of(self, e: int) -> tuple[int, int]:
        """Loop of edge e of the flat numbering, and its index in that loop of the document."""
        loop = int(np.searchsorted(self.arrays.loop_start, e, side="right")) - 1
        return loop, int(self.edge_of[e])


def loop_name(loop: int) -> str:
    """A loop in words."""
    return "outer loop" if loop == 0 else f"hole {loop - 1}"


def loop_pointer(loop: int) -> str:
    """JSON pointer of a loop: /outer or /holes/i."""
    return "/outer" if loop == 0 else f"/holes/{loop - 1}"


def edge_pointer(loop: int, edge: int) -> str:
    """JSON pointer of an edge."""
    return f"{loop_pointer(loop)}/{edge}"


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
    total = sum(_count_points(edge) for loop in loops for edge in loop)
    if total > limit:
        text = (
            f"the boundary has {total} control points; at most {limit} are accepted. Simplify it, or cut it into parts"
        )
        problems.append(Problem("too-complex", "", text))
        loops = []
    if not problems:
        arrays = _gather(loops)
        if arrays is not None:
            starts = arrays.loop_start
            edge_of = np.arange(len(arrays.degree)) - np.repeat(starts[:-1], np.diff(starts))
            return Draft(arrays, edge_of, np.ones(len(loops), dtype=np.int64), options)
    kept: list[list[Edge]] = []
    edge_ids: list[int] = []
    whole: list[int] = []
    for number, loop in enumerate(loops):
        read_edges = [(i, _read_edge(edge, number, i, problems)) for i, edge in enumerate(loop)]
        sound = [(i, edge) for i, edge in read_edges if edge is not None]
        kept.append([edge for _, edge in sound])
        edge_ids.extend(i for i, _ in sound)
        whole.append(int(len(sound) == len(loop) and len(loop) > 0))
    arrays = _gather(kept, empty_loops=True)
    assert arrays is not None
    return Draft(arrays, np.array(edge_ids, dtype=np.int64), np.array(whole, dtype=np.int64), options, problems)


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


def _gather(loops: list[list[Any]], empty_loops: bool = False) -> BoundaryArrays | None:
    """The flat arrays of well-formed loops, or None when anything at all is out of place."""
    degree: list[int] = []
    counts: list[int] = []
    points: list[Any] = []
    knot_counts: list[int] = []
    knots: list[Any] = []
    weights: list[Any] = []
    for loop in loops:
        if not loop and not empty_loops:
            return None
        for edge in loop:
            if type(edge) is not dict or not edge.keys() <= EDGE_KEYS:
                return None
            p = edge.get("degree")
            own = edge.get("control_points")
            if type(p) is not int or not 1 <= p <= HIGHEST_DEGREE or type(own) is not list or len(own) <= p:
                return None
            n = len(own)
            given = edge.get("knots")
            if given is None and n == p + 1:
                given = BEZIER_KNOTS[p]
            if type(given) is not list or len(given) != n + p + 1:
                return None
            own_weights = edge.get("weights")
            if own_weights is None:
                own_weights = [1.0] * n
            elif type(own_weights) is not list or len(own_weights) != n:
                return None
            degree.append(p)
            counts.append(n)
            knot_counts.append(n + p + 1)
            points += own
            knots += given
            weights += own_weights
    if not (set(map(type, points)) <= PAIRS and set(map(len, points)) <= {2}):
        return None
    flat = list(chain.from_iterable(points))
    if not set(map(type, chain(flat, knots, weights))) <= NUMBERS:
        return None
    cp = np.empty((len(points), 3))
    try:
        cp[:, :2] = np.array(flat, dtype=np.float64).reshape(-1, 2)
        cp[:, 2] = weights
        knot_values = np.array(knots, dtype=np.float64)
    except OverflowError:
        return None
    return BoundaryArrays(
        np.array(degree, dtype=np.int64),
        _starts(counts),
        cp,
        _starts(knot_counts),
        knot_values,
        _starts([len(loop) for loop in loops]),
        np.zeros(len(loops), dtype=np.bool_),
    )


def _starts(counts: list[int]) -> NDArray[np.int64]:
    starts = np.zeros(len(counts) + 1, dtype=np.int64)
    np.cumsum(counts, out=starts[1:])
    return starts


def _read_edge(edge: object, loop: int, index: int, problems: list[Problem]) -> Edge | None:
    """One edge, cleaned, or None after its faults have been noted."""
    at = edge_pointer(loop, index)
    before = len(problems)

    def fault(pointer: str, text: str, code: str = "invalid-request") -> None:
        problems.append(Problem(code, pointer, text, loop, index))

    if not isinstance(edge, Mapping):
        fault(at, f"an edge is an object with degree and control_points, not {describe(edge)}")
        return None
    for key in edge:
        if key not in EDGE_KEYS:
            fault(
                pointer_to(at, key), f"unknown key {short(key)}; an edge has degree, control_points, knots and weights"
            )
    degree = _read_degree(edge, at, fault)
    points = _read_points(edge, at, fault)
    knots = _read_numbers(edge.get("knots"), f"{at}/knots", "knot", fault)
    weights = _read_numbers(edge.get("weights"), f"{at}/weights", "weight", fault)
    if len(problems) > before or degree is None or points is None:
        return None
    n = len(points)
    if n <= degree:
        text = f"a curve of degree {degree} needs at least {degree + 1} control points, here are {n}"
        fault(f"{at}/control_points", text, "invalid-spline")
    elif knots is None and n != degree + 1:
        text = (
            f"knots may be left out only for {degree + 1} control points (a Bezier curve); here are {n}, give the knots"
        )
        fault(f"{at}/knots", text, "invalid-spline")
    elif knots is not None and len(knots) != n + degree + 1:
        text = f"{n} control points of degree {degree} need {n + degree + 1} knots, here are {len(knots)}"
        fault(f"{at}/knots", text, "invalid-spline")
    if weights is not None and len(weights) != n:
        fault(f"{at}/weights", f"{len(weights)} weights for {n} control points; give one each", "invalid-spline")
    if len(problems) > before:
        return None
    clean: Edge = {"degree": degree, "control_points": points}
    if knots is not None:
        clean["knots"] = knots
    if weights is not None:
        clean["weights"] = weights
    return clean


Fault = Callable[..., None]


def _read_degree(edge: Mapping[Any, Any], at: str, fault: Fault) -> int | None:
    if "degree" not in edge:
        fault(f"{at}/degree", "degree is missing")
        return None
    value = edge["degree"]
    if isinstance(value, bool) or not isinstance(value, Integral):
        fault(f"{at}/degree", f"degree must be an integer, not {describe(value)}")
        return None
    degree = int(value)
    if not 1 <= degree <= HIGHEST_DEGREE:
        fault(f"{at}/degree", f"degree must be 1 to {HIGHEST_DEGREE}, not {short(degree)}", "invalid-spline")
        return None
    return degree


def _read_points(edge: Mapping[Any, Any], at: str, fault: Fault) -> list[list[float]] | None:
    at = f"{at}/control_points"
    if "control_points" not in edge:
        fault(at, "control_points is missing")
        return None
    value = as_list(edge["control_points"])
    if value is None:
        fault(at, f"control_points must be a list of [x, y], not {describe(edge['control_points'])}")
        return None
    points = []
    for i, item in enumerate(value):
        pair = as_list(item)
        if pair is None:
            fault(f"{at}/{i}", f"a control point is [x, y], not {describe(item)}")
            return None
        if len(pair) != 2:
            fault(f"{at}/{i}", f"a control point has two coordinates, here are {len(pair)}", "invalid-spline")
            return None
        point = [as_number(c) for c in pair]
        for k, c in enumerate(point):
            if c is None:
                fault(f"{at}/{i}/{k}", f"a coordinate must be a number, not {describe(pair[k])}")
                return None
        points.append(point)
    return points  # type: ignore[return-value]


def _read_numbers(value: object, at: str, noun: str, fault: Fault) -> list[float] | None:
    if value is None:
        return None
    items = as_list(value)
    if items is None:
        fault(at, f"{noun}s must be a list of numbers, not {describe(value)}")
        return None
    numbers = [as_number(item) for item in items]
    for i, number in enumerate(numbers):
        if number is None:
            fault(f"{at}/{i}", f"a {noun} must be a number, not {describe(items[i])}")
            return None
    return numbers  # type: ignore[return-value]


def as_list(value: object) -> list[Any] | None:
    """Lists, tuples and arrays as a list; None for anything else."""
    if isinstance(value, np.ndarray):
        return list(value) if value.ndim else None
    return list(value) if isinstance(value, list | tuple) else None


def as_number(value: object) -> float | None:
    """A number as float (an integer beyond all floats becomes infinite); None for anything else, booleans too."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf


def describe(value: object) -> str:
    """What a value is, in the words of JSON, short whatever its size."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float | str):
        return short(value)
    if isinstance(value, Mapping):
        return "an object"
    return "a list" if isinstance(value, list | tuple | np.ndarray) else f"a {type(value).__name__}"


def short(value: object) -> str:
    """The value's text, cut to a readable length."""
    if isinstance(value, int) and abs(value) > 10**30:
        return "an integer of more than 30 digits"
    if isinstance(value, str):
        return f'"{value}"' if len(value) <= 40 else f'"{value[:37]}..."'
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def pointer_to(at: str, key: object) -> str:
    """Pointer of a member, its name escaped as RFC 6901 asks and cut short."""
    return f"{at}/{str(key)[:60].replace('~', '~0').replace('/', '~1')}"


def read_options(value: object, problems: list[Problem]) -> dict[str, Any]:
    """The request's options: those given and sound.

    Parameters
    ----------
    value : object
        Member ``options`` of the document.
    problems : list of Problem
        Grows by one for each fault.

    Returns
    -------
    dict
        tolerance, step, smooth_angle (float), method (str), check_step (int), samples (bool); absent keys stay absent.
    """
    if not isinstance(value, Mapping):
        problems.append(Problem("invalid-request", "/options", f"options must be an object, not {describe(value)}"))
        return {}
    options: dict[str, Any] = {}
    for key, given in value.items():
        rule = OPTION_RULES.get(key) if isinstance(key, str) else None
        if rule is None:
            text = f"unknown option {short(key)}; known are {', '.join(OPTION_RULES)}"
            problems.append(Problem("invalid-request", pointer_to("/options", key), text))
        elif given is None and key in {"step", "check_step"}:
            continue
        elif rule.accepts(given):
            options[key] = float(given) if key in FLOAT_OPTIONS else given
        else:
            text = f"{key} must be {rule.asks}, not {describe(given)}"
            problems.append(Problem("invalid-request", f"/options/{key}", text))
    return options


class OptionRule(NamedTuple):
    """What an option may be: the test and its wording."""

    accepts: Callable[[Any], bool]
    asks: str


def _between(low: float, high: float) -> Callable[[Any], bool]:
    def accepts(value: Any) -> bool:
        number = as_number(value)
        return number is not None and low <= number <= high

    return accepts


SMALLEST_TOLERANCE = 1e-12  # relative: rounding of the arithmetic itself leaves about 1e-14
LARGEST_TOLERANCE = 0.1
SMALLEST_STEP = 1e-6  # relative: a million samples along one side
LARGEST_SMOOTH_ANGLE = 0.1  # radians: a sharper corner is meant
FLOAT_OPTIONS = frozenset({"tolerance", "step", "smooth_angle"})
OPTION_RULES = {
    "tolerance": OptionRule(
        _between(SMALLEST_TOLERANCE, LARGEST_TOLERANCE), f"a number from {SMALLEST_TOLERANCE} to {LARGEST_TOLERANCE}"
    ),
    "step": OptionRule(
        _between(SMALLEST_STEP, 1e300),
        f"a number from {SMALLEST_STEP} (relative to the larger side of the bounding box, like tolerance) or null",
    ),
    "method": OptionRule(lambda value: isinstance(value, str) and value in ("discs", "march"), '"discs" or "march"'),
    "check_step": OptionRule(
        lambda value: isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= 10**6,
        "a positive integer or null",
    ),
    "smooth_angle": OptionRule(_between(0.0, LARGEST_SMOOTH_ANGLE), f"an angle from 0 to {LARGEST_SMOOTH_ANGLE} radians"),
    "samples": OptionRule(lambda value: isinstance(value, bool), "true or false"),
}
