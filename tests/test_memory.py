"""Room for large domains goes back to the operating system."""

from __future__ import annotations

import mmap
import sys
import weakref
from pathlib import Path

import numpy as np
import pytest

from mat_core.memory import LARGE, MANY, give_back, joined, joined_one_by_one, maker


@pytest.mark.parametrize("rows", [3, MANY - 1, MANY, 100_000])
@pytest.mark.parametrize("dtype", [np.int64, np.int32, np.float64, np.bool_])
def test_arrays_are_as_asked_for_and_can_be_filled(rows: int, dtype: type) -> None:
    array = maker(rows)((rows, 3), dtype)
    assert (array.shape, array.dtype) == ((rows, 3), dtype)
    assert array.flags.c_contiguous
    assert array.flags.aligned
    array[:] = 1
    assert int(array.sum()) == 3 * rows


@pytest.mark.parametrize("rows", [1, MANY])
def test_joined_is_concatenated(rows: int) -> None:
    arrays = [np.arange(2.0 * n).reshape(n, 2) for n in (rows, 0, 7)]
    assert np.array_equal(joined(arrays), np.concatenate(arrays))
    across = [array.T for array in arrays]
    assert np.array_equal(joined(across, axis=1), np.concatenate(across, axis=1))


def test_a_column_is_let_go_of_when_it_is_joined() -> None:
    columns = [[np.ones(n), np.zeros(2)] for n in (5, 6)]
    first = weakref.ref(columns[0][0])
    ones = joined_one_by_one(columns)
    assert next(ones).sum() == 5.0
    assert next(ones).sum() == 6.0
    assert first() is None
    assert next(ones, None) is None


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_what_is_dropped_leaves_the_process() -> None:
    def resident() -> int:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        return pages * mmap.PAGESIZE

    arrays = [maker(MANY)(LARGE, np.float64) for _ in range(8)]
    kept = [np.ones(100) for _ in range(100)]  # of the heap, above which nothing else may be stuck
    for array in arrays:
        array.fill(1.0)
    full = resident()
    size = sum(array.nbytes for array in arrays)
    arrays.clear()
    del array
    give_back()
    assert full - resident() > 0.9 * size
    assert len(kept) == 100
