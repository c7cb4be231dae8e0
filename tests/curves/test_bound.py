"""`max_error` is a bound: of the distance from the true axis, and of |distance to the boundary - radius|."""

from __future__ import annotations

import functools
import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mat_core import Domain, MedialAxis, medial_axis
from tests.curves.oracle import off_axis
from tests.curves.shapes import shape
from tests.families import smooth
from tests.hunt.draw import draw
from tests.reference import Reference

Json = dict[str, Any]
TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
FAMILIES = ("ellipse", "lens", "kidney", "blob_holes", "heart", "parabola_cap", "mixed", "thorn", "mixed_holes", "keyhole")
OUTLINES = Path(__file__).parents[1] / "corpus" / "outlines.jsonl.gz"
ORACLE = 1e-15  # rounding of the distances it is held against, relative to the size
EACH = 1000  # random t on a segment
SHARE = 25  # of which one in so many is held against the true axis as well


@functools.cache
def outlines() -> tuple[Json, ...]:
    with gzip.open(OUTLINES, "rt") as lines:
        return tuple(json.loads(line) for line in lines)


@functools.cache
def reference(text: str) -> Reference:
    return Reference(json.loads(text))


def solved(content: Json, tolerance: float) -> tuple[MedialAxis, Reference]:
    """An axis and the slow oracle for its boundary."""
    plain = {"outer": content["outer"], "holes": content.get("holes", [])}
    return medial_axis(Domain.from_dict(plain), tolerance=tolerance), reference(json.dumps(plain))


def assert_bounded(axis: MedialAxis, oracle: Reference, each: int, seed: int) -> None:
    """At random t no error is above what its segment states."""
    rng = np.random.default_rng(seed)
    segment = np.repeat(np.arange(len(axis.segments)), each)
    t = rng.random(len(segment))
    stated = np.array([s.max_error for s in axis.segments])[segment]
    disc = axis.evaluate(segment, t)[:, :3]
    origin, size = oracle.frame
    distance = oracle.boundary.nearest((disc[:, :2] - origin) / size)[0] * size
    assert np.all(np.abs(distance - disc[:, 2]) <= stated + (ORACLE + oracle.floor) * size)
    few = np.arange(0, len(t), SHARE)
    off = off_axis(axis, segment[few], t[few]) / axis.table.scale
    known = np.isfinite(off)
    assert known.mean() > 0.9
    assert np.all(off[known] <= stated[few][known] + ORACLE * size)


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_families(tolerance: float) -> None:
    # each shape at every tolerance, with a thousand parameters a segment at one of them
    for n, name in enumerate(FAMILIES):
        axis, oracle = solved(shape(name), tolerance)
        assert_bounded(axis, oracle, EACH if TOLERANCES[n % len(TOLERANCES)] == tolerance else EACH // 10, n)


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_smooth_splines(tolerance: float) -> None:
    for seed in range(6):
        axis, oracle = solved(smooth(seed + 100, 7 + seed), tolerance)
        assert_bounded(axis, oracle, EACH // 4, seed)


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_outlines(tolerance: float) -> None:
    for n, content in enumerate(outlines()):
        axis, oracle = solved(content, tolerance)
        assert_bounded(axis, oracle, 50, n)


def test_a_chord_drawn_straight_states_how_far_its_ends_are() -> None:
    # a quarter of a circle with noise of 1e-10: the leaf and the axis beside it are 2e-10 apart, and one sample told 3e-12 of it
    drawn = draw("noise_arc_circle", 300)
    axis = medial_axis(Domain.from_dict({"outer": drawn["outer"], "holes": drawn.get("holes", [])}), tolerance=1e-9)
    c = axis.curves
    part = np.flatnonzero(c.part_i[:, 3] == 4)
    t = c.part_f[part, :1] + (c.part_f[part, 1:2] - c.part_f[part, :1]) * np.linspace(0.001, 0.999, 101)
    segment = np.repeat(c.part_segment[part], t.shape[1])
    off = off_axis(axis, segment, t.reshape(-1))
    known = np.isfinite(off)
    assert known.sum() > 100
    assert (off <= c.max_error[segment])[known].all()
