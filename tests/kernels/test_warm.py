"""The command that compiles every kernel: its two processes compile for the same types that one process does."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import numba
import numpy as np
import pytest

from mat_core import UnsupportedOption, warm


def arrays(value: Any) -> Iterator[np.ndarray[Any, Any]]:
    """All arrays in a record of records."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, tuple):
        for member in value:
            yield from arrays(member)


def warming() -> Any:
    """The module; the package has a function of that name."""
    return sys.modules["mat_core.warm"]


def test_what_is_found_uncompiled_has_the_types_of_what_is_found_compiled() -> None:
    compiled = warming()._first_half(lambda number: None)
    uncompiled = warming()._found_uncompiled()
    for one, other in zip(compiled[1:], uncompiled[1:], strict=True):
        types = [numba.typeof(array) for array in arrays(one)]
        assert types
        assert types == [numba.typeof(array) for array in arrays(other)]
    assert uncompiled.domain.arrays.cp.tolist() == compiled.domain.arrays.cp.tolist()


def test_an_unknown_part_is_refused() -> None:
    with pytest.raises(UnsupportedOption, match="part"):
        warm(part="both")


def test_every_stage_is_announced_once_and_the_end_is_told() -> None:
    done = subprocess.run([sys.executable, "-W", "ignore", "-m", "mat_core.warm"], capture_output=True, text=True, check=True)
    told = done.stdout.splitlines()
    stages = warming().STAGES
    assert sorted(told[:-1]) == [f"kernels {i}/{len(stages)}: {stage}" for i, stage in enumerate(stages, 1)]
    assert told[-1].startswith("kernels ready after")
    assert done.stderr == ""
