"""Strategies for domains that are valid by construction, and for things that are not domains."""

from __future__ import annotations

import math
from typing import Any

from hypothesis import strategies as st

Json = Any


@st.composite
def valid_domains(draw: st.DrawFn) -> dict[str, Json]:
    """A loop that is star-shaped about the origin, with or without a round hole, in either orientation.

    The control points of the whole loop stand at increasing angles around the origin. An edge stays in the convex hull
    of its control points, hence in its own sector (edges span less than a half turn): edges meet at their ends only.
    """
    degrees = draw(st.lists(st.integers(1, 3), min_size=4, max_size=9).filter(lambda all_: sum(all_) >= 9))
    count = sum(degrees)
    jitter = draw(st.lists(st.floats(-0.3, 0.3), min_size=count, max_size=count))
    radii = draw(st.lists(st.floats(0.5, 1.5), min_size=count, max_size=count))
    points = [
        [round(radius * math.cos(angle), 6), round(radius * math.sin(angle), 6)]
        for radius, angle in zip(radii, (2 * math.pi * (i + d) / count for i, d in enumerate(jitter)), strict=True)
    ]
    outer = []
    start = 0
    for degree in degrees:
        edge: dict[str, Json] = {
            "degree": degree,
            "control_points": [points[(start + i) % count] for i in range(degree + 1)],
        }
        if draw(st.booleans()):
            edge["weights"] = draw(st.lists(st.floats(0.5, 2.0), min_size=degree + 1, max_size=degree + 1))
        if draw(st.booleans()):
            edge["knots"] = [0.0] * (degree + 1) + [1.0] * (degree + 1)
        outer.append(edge)
        start += degree
    domain: dict[str, Json] = {"outer": reverse(outer) if draw(st.booleans()) else outer}
    if draw(st.booleans()):
        domain["holes"] = [[circle(0.05)]]
    if draw(st.booleans()):
        domain["options"] = {"tolerance": draw(st.sampled_from([1e-4, 1e-6, 1e-7]))}
        domain["options"]["samples"] = draw(st.booleans())
    return domain


def reverse(loop: list[dict[str, Json]]) -> list[dict[str, Json]]:
    """The same loop run the other way."""
    turned = []
    for edge in reversed(loop):
        new = {**edge, "control_points": edge["control_points"][::-1]}
        if "weights" in edge:
            new["weights"] = edge["weights"][::-1]
        turned.append(new)
    return turned


def circle(radius: float) -> dict[str, Json]:
    """A circle about the origin as one closed edge, clockwise."""
    corners = [(1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0)]
    return {
        "degree": 2,
        "control_points": [[radius * x, radius * y] for x, y in corners],
        "knots": [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4],
        "weights": [1, math.sqrt(0.5)] * 4 + [1],
    }


def optional(**members: st.SearchStrategy[Json]) -> st.SearchStrategy[Json]:
    """An object with any of these members."""
    return st.fixed_dictionaries({}, optional=members)


lengths = st.floats(1e-6, 3.0)
places_in_the_plane = st.lists(st.lists(st.floats(-2.0, 2.0), min_size=2, max_size=2), min_size=1, max_size=4)

ARGUMENTS: dict[str, st.SearchStrategy[Json]] = {
    "offset": st.fixed_dictionaries({"distance": lengths | st.floats(-1.0, -1e-3)}, optional={"tolerance": st.just(1e-4)}),
    "inscribed-disc": optional(prominence=lengths),
    "centerline": optional(extend=st.booleans()),
    "prune": optional(angle=st.floats(0.0, math.pi), length=lengths, radius_ratio=st.floats(1.0, 3.0)).map(
        lambda rules: {"scale": 1.2, **rules}
    ),
    "nearest": st.fixed_dictionaries({"points": places_in_the_plane}),
    "width": optional(limit=lengths, angle=st.floats(0.0, math.pi)),
}
"""Arguments that each operation takes with any of the valid domains."""

numbers = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(10**30), 10**30)
scalars = st.none() | st.booleans() | numbers | st.text(max_size=5)
names = st.sampled_from(
    ["outer", "holes", "options", "degree", "control_points", "knots", "weights", "tolerance", "method", "step", "x"]
)
anything = st.recursive(scalars, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(names, inner, max_size=4))


@st.composite
def damaged_domains(draw: st.DrawFn) -> Json:
    """A valid domain in which one value, anywhere, was replaced by something else or taken away."""
    domain = draw(valid_domains())
    holder, key = draw(st.sampled_from(list(places(domain))))
    if draw(st.booleans()):
        holder[key] = draw(anything)
    else:
        del holder[key]
    return domain


def places(node: Json) -> Any:
    """Every (container, key) of a document."""
    items = list(node.items() if isinstance(node, dict) else enumerate(node))
    for key, value in items:
        yield node, key
        if isinstance(value, dict | list):
            yield from places(value)
