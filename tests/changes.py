"""What may be done to a domain without doing anything to its axis, other than to carry it along.

Each change gives two domains and the way back from the second to the first. Most begin with the domain as it is: a turn or a
unit rounds its coordinates by some 1e-16 of its size, which moves no node by 1e-9 of it. A shift by a million sizes would
round them by 1e-10, which is another domain, and a branch point between nearly parallel walls magnifies that by the inverse of
their angle. So `far` begins with coordinates on a grid that the shift leaves exact, and the same is asked of it as of all.

What is an arc or a straight joint but for the rounding of its coordinates is taken for one, and far from the origin that
rounding is coarse: there a circle on the grid is a circle, while the same points near the origin are twelve arcs with branches
of 1e-10 between them. Where these differ, the axis has to be that of the domain before it was put on the grid.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tests.transforms import SAME_PLACE, mapped, mirrored, rotated, scaled, shifted

Json = dict[str, Any]
Floats = NDArray[np.float64]
FAR = 1e6  # in sizes of the domain, at least


class Changed(NamedTuple):
    """A domain after a change, and before it: the axis is that of the first of these, or else of the next.

    `back` takes points from after to before, `scale` is what lengths were multiplied by.
    """

    before: tuple[Json, ...]
    after: Json
    back: Callable[[Floats], Floats]
    scale: float = 1.0


def _same_place(domain: Json, change: Callable[[Json], Json]) -> Changed:
    return Changed((domain,), change(domain), lambda p: p)


def _turned(domain: Json, angle: float) -> Changed:
    c, s = math.cos(angle), math.sin(angle)
    return Changed((domain,), rotated(domain, angle), lambda p: p @ np.array([[c, -s], [s, c]]))


def _mirrored(domain: Json) -> Changed:
    return Changed((domain,), mirrored(domain), lambda p: p * np.array([-1.0, 1.0]))


def _in_unit(domain: Json, factor: float) -> Changed:
    return Changed((domain,), scaled(domain, factor), lambda p: p / factor, factor)


def _shifted(domain: Json, by: tuple[float, float]) -> Changed:
    return Changed((domain,), shifted(domain, *by), lambda p: p - np.array(by))


def _far(domain: Json) -> Changed:
    """Moved a million sizes away; all of its coordinates are multiples of the last digit that is left there."""
    points = np.array([p for e in domain["outer"] for p in e["control_points"]])
    unit = 2.0 ** math.ceil(math.log2(np.ptp(points, axis=0).max()))
    grid = unit * 2.0 ** (math.ceil(math.log2(FAR + 1.0)) - 52)
    x, y = np.round(points[0] / grid) * grid
    on_grid = mapped(domain, lambda p: np.round(p / grid) * grid)
    return _shifted(on_grid, (FAR * unit - x, -FAR * unit - y))._replace(before=(on_grid, domain))


CHANGES: dict[str, Callable[[Json], Changed]] = {
    **{name: partial(_same_place, change=change) for name, change in SAME_PLACE.items()},
    "rotated": partial(_turned, angle=0.7),
    "quarter": partial(_turned, angle=math.pi / 2),
    "mirrored": _mirrored,
    "small": partial(_in_unit, factor=1e-9),
    "large": partial(_in_unit, factor=1e9),
    "inches": partial(_in_unit, factor=1 / 25.4),
    "shifted": partial(_shifted, by=(3.3, -7.1)),
    "far": _far,
}


def moved_back(answer: Json, changed: Changed) -> Json:
    """The answer for the domain after the change, as if it were one for the domain before: discs, curves and graph."""

    def points(given: Any) -> Any:
        return changed.back(np.array(given, dtype=float)).tolist()

    def lengths(given: Any) -> Any:
        return (np.array(given, dtype=float) / changed.scale).tolist()

    nodes = [{**n, "point": points(n["point"]), "radius": n["radius"] / changed.scale} for n in answer["graph"]["nodes"]]
    segments = [
        {
            **s,
            "axis": {**s["axis"], "control_points": points(s["axis"]["control_points"])},
            "radius": {**s["radius"], "control_values": lengths(s["radius"]["control_values"])},
        }
        for s in answer["segments"]
    ]
    return {"segments": segments, "graph": {**answer["graph"], "nodes": nodes}}
