"""The axis belongs to the shape: not to its place, its unit, or the way its boundary is written down.

Nodes agree to 1e-9 of the size. A shift by 1e6 sizes leaves the coordinates about 1e-10 of the size; nodes magnify that
(a branch point between nearly parallel walls by the inverse of their angle), so they are held to 1e-7 there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.assertions import EXACT, Answer, assert_same_axis
from tests.families import CATALOGUE
from tests.reference import Reference
from tests.transforms import SAME_PLACE, mirrored, rotated, scaled, shifted

Json = dict[str, Any]
Solve = Callable[..., Json]

FAR = 1e-7
SHAPES = [
    "rectangle",
    "square",
    "triangle",
    "heptagon",
    "ell",
    "cross_5",
    "star",
    "polygon",
    "circle_3",
    "ellipse",
    "ellipse_4",
    "stadium",
    "rounded_rectangle",
    "half_disc",
    "annulus",
    "eccentric_ring",
    "square_round_hole",
    "lens",
    "lens_one_edge",
    "parabola_cap",
    "gear",
    "keyhole",
    "dumbbell",
    "pipe_bend",
    "heart",
    "thorn",
    "kidney",
    "blob_holes",
    "mixed",
    "mixed_holes",
    "hole_grid",
    "plate",
]


def rotation(angle: float) -> np.ndarray[Any, Any]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s], [-s, c]])


def parsed(domain: Json, answer: Json, origin: Any, size: float) -> Answer:
    """An answer in a frame of its own choice."""
    reference = Reference(domain)
    reference.__dict__["frame"] = (np.asarray(origin, dtype=float), size)
    return Answer(answer, reference)


def moved_discs(answer: Json, place: Callable[[Any], Any], scale: float) -> Json:
    """The answer with all its points moved as the domain was."""
    nodes = [
        {**n, "point": place(np.array(n["point"])).tolist(), "radius": scale * n["radius"]}
        for n in answer["graph"]["nodes"]
    ]
    segments = [
        {
            **s,
            "axis": {**s["axis"], "control_points": place(np.array(s["axis"]["control_points"])).tolist()},
            "radius": {**s["radius"], "control_values": [scale * v for v in s["radius"]["control_values"]]},
        }
        for s in answer["segments"]
    ]
    return {"segments": segments, "graph": {**answer["graph"], "nodes": nodes}}


MOTIONS: dict[str, tuple[Callable[[Json], Json], Callable[[Any], Any], float, float]] = {
    "rotated": (lambda d: rotated(d, 0.7), lambda p: p @ rotation(0.7), 1.0, EXACT),
    "quarter": (lambda d: rotated(d, np.pi / 2), lambda p: p @ rotation(np.pi / 2), 1.0, EXACT),
    "mirrored": (mirrored, lambda p: p * np.array([-1.0, 1.0]), 1.0, EXACT),
    "small": (lambda d: scaled(d, 1e-9), lambda p: p * 1e-9, 1e-9, EXACT),
    "large": (lambda d: scaled(d, 1e9), lambda p: p * 1e9, 1e9, EXACT),
    "inches": (lambda d: scaled(d, 1 / 25.4), lambda p: p / 25.4, 1 / 25.4, EXACT),
    "shifted": (lambda d: shifted(d, 3.3, -7.1), lambda p: p + np.array([3.3, -7.1]), 1.0, EXACT),
    "far": (lambda d: shifted(d, 1e6, -1e6), lambda p: p + np.array([1e6, -1e6]), 1.0, FAR),
}


@pytest.mark.parametrize("change", sorted(SAME_PLACE))
@pytest.mark.parametrize("name", SHAPES)
def test_description(name: str, change: str, solve: Solve) -> None:
    """Reversal, start edge, splitting, knot insertion, degree elevation, order of the holes."""
    domain = CATALOGUE[name]()
    other = SAME_PLACE[change](domain)
    origin, size = Reference(domain).frame
    assert_same_axis(parsed(domain, solve(domain), origin, size), parsed(other, solve(other), origin, size), EXACT)


@pytest.mark.parametrize("motion", sorted(MOTIONS))
@pytest.mark.parametrize("name", SHAPES)
def test_place_and_unit(name: str, motion: str, solve: Solve) -> None:
    """Rigid motions, mirror images, units and far places."""
    change, place, scale, accuracy = MOTIONS[motion]
    domain = CATALOGUE[name]()
    other = change(domain)
    origin, size = Reference(other).frame
    expected = parsed(other, moved_discs(solve(domain), place, scale), origin, size)
    assert_same_axis(expected, parsed(other, solve(other), origin, size), accuracy)
