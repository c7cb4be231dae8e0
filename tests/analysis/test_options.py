"""What no function can use is refused by name, whatever it is; what it can use gives finite results."""

from __future__ import annotations

import functools
import json
import math
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from mat_core import Domain, MedialAxis, UnsupportedOption, medial_axis
from mat_core.analysis import inscribed_discs, nearest, offset, offsets, prune, width
from tests.families import CATALOGUE

CALLS: dict[str, tuple[str, Callable[[MedialAxis, Any], Any]]] = {
    "offset": ("distance", offset),
    "offsets": ("distance", lambda axis, v: offsets(axis, (0.1, v))[1]),
    "offset, tolerance": ("tolerance", lambda axis, v: offset(axis, 0.1, v)),
    "inscribed_discs": ("prominence", inscribed_discs),
    "width": ("limit", width),
    "width, angle": ("angle", lambda axis, v: width(axis, 0.1, angle=v)),
    "prune, angle": ("angle", lambda axis, v: prune(axis, angle=v)),
    "prune, length": ("length", lambda axis, v: prune(axis, length=v)),
    "prune, radius_ratio": ("radius_ratio", lambda axis, v: prune(axis, radius_ratio=v)),
    "prune, scale": ("scale", lambda axis, v: prune(axis, scale=v)),
    "nearest": ("points", lambda axis, v: nearest(axis, [[v, 0.0], [0.0, v]])),
}
NO_NUMBERS = ("x", 1j, [1.0], {}, np.array([0.3, 0.2]), math.nan)
NUMBERS = (math.inf, -math.inf, -1.0, 0.0, 5e-324, 1e-17, 1e-13, 1e-6, 0.5, np.float32(0.1), 1.0, 1e9, 1e100, 1e300, 10**400,
           -(10**400))  # fmt: skip


@functools.cache
def axis_of(name: str) -> MedialAxis:
    shape = CATALOGUE[name]()
    return medial_axis(Domain.from_dict({"outer": shape["outer"], "holes": shape.get("holes", [])}))


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("value", NO_NUMBERS, ids=repr)
def test_what_is_no_number_is_refused_by_name(call: str, value: Any) -> None:
    option, function = CALLS[call]
    with pytest.raises(UnsupportedOption) as refused:
        function(axis_of("ellipse"), value)
    assert refused.value.option == option


@pytest.mark.parametrize("name", ["circle", "annulus", "ellipse", "mixed_holes"])
@pytest.mark.parametrize("call", CALLS)
def test_any_number_is_used_or_refused_by_name(call: str, name: str) -> None:
    option, function = CALLS[call]
    refused = {option}
    used = 0
    for value in NUMBERS:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                found = function(axis_of(name), value)
            except UnsupportedOption as error:
                refused.add(error.option)
                continue
        json.dumps(found.to_dict(), allow_nan=False)
        used += 1
    assert used
    assert refused == {option}


def test_a_text_is_no_number() -> None:
    for option, function in (CALLS[call] for call in CALLS if call != "nearest"):
        with pytest.raises(UnsupportedOption, match=f'{option}: "1" is not a number'):
            function(axis_of("ellipse"), "1")


def test_a_distance_that_doubles_cannot_tell_is_refused() -> None:
    axis = axis_of("ellipse")
    least = 1e-14 * axis.domain.size
    assert len(offset(axis, 1.01 * least).regions) == 1
    with pytest.raises(UnsupportedOption, match="less than 1e-14 times the size"):
        offset(axis, 0.99 * least)


@pytest.mark.parametrize("points", [[], [[]], [[1, 2, 3]], "ab", [["a", 1]], [[1, 2], [3]], [[0.0, 1e101]], None], ids=repr)
def test_points_have_two_coordinates(points: Any) -> None:
    with pytest.raises(UnsupportedOption, match="points"):
        nearest(axis_of("ellipse"), points)
