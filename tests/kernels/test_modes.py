"""The kernels give the same answers uncompiled, and compiled with every index checked.

Each mode runs in a process of its own, the checked one with compiled kernels of its own: kernels that check their
indices must not be found by anybody else.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.kernels.answers import SHAPES, answer

ROOT = Path(__file__).resolve().parents[2]
NEAR = 1e-9  # of any figure of these shapes, whose sizes are some units

Json = dict[str, Any]


def run(**environment: str) -> Json:
    """What `tests.kernels.answers` prints in a process with these variables."""
    settings = {**os.environ, **environment}
    command = [sys.executable, "-m", "tests.kernels.answers"]
    ended = subprocess.run(command, cwd=ROOT, env=settings, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    told: Json = json.loads(ended.stdout)
    return told


def assert_alike(a: Any, b: Any, where: str) -> None:
    """The same members, words and counts; numbers to NEAR."""
    if isinstance(a, dict):
        assert list(a) == list(b), where
        for key in a:
            assert_alike(a[key], b[key], f"{where}/{key}")
    elif isinstance(a, list):
        assert len(a) == len(b), where
        for i, (p, q) in enumerate(zip(a, b, strict=True)):
            assert_alike(p, q, f"{where}/{i}")
    elif isinstance(a, float):
        assert a == pytest.approx(b, rel=NEAR, abs=NEAR), where
    else:
        assert a == b, where


def assert_same_answers(told: Json) -> None:
    """What a process told is what this one finds."""
    assert told["bounded"]
    assert list(told["answers"]) == list(SHAPES)
    for name, shape in SHAPES.items():
        mine = answer(shape)
        assert name == "bow tie" or mine["certificate"]["passed"]
        assert_alike(mine, told["answers"][name], name)


def test_uncompiled() -> None:
    assert_same_answers(run(NUMBA_DISABLE_JIT="1"))


def test_every_index_is_within_bounds(pytestconfig: pytest.Config) -> None:
    """Compiles everything anew the first time, hence the cache that stays: some 50 s, then one."""
    assert pytestconfig.cache is not None
    folder = pytestconfig.cache.mkdir("kernels-boundscheck")
    assert_same_answers(run(NUMBA_BOUNDSCHECK="1", NUMBA_CACHE_DIR=str(folder)))
