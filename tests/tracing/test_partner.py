"""A partner found from a guess is the one that `trace` finds from nothing, whatever the guess."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mat_core.kernels.curve import evaluate
from mat_core.kernels.jit import jit
from mat_core.kernels.layout import KIND, SPIRAL
from mat_core.tracing.partner import disc_beside
from mat_core.tracing.strip import trace
from tests.curves.shapes import solved

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SHAPES = ("ellipse", "blob_holes", "kidney", "thorn", "spiral", "mixed")
SHARES = (0.003, 0.11, 0.4, 0.5, 0.77, 0.999)
GUESSES = (0.0, 0.02, 0.5, 0.93, 1.0)  # of the partner's range
SAME = 1e-13  # of x, y and r, normalised: what axis points are good to
NEAR = 1e-6  # of the partner's s, where the disc tells it


@jit
def both(
    si: Ints, sf: Floats, cp: Floats, site: Ints, partner: Ints, at: Floats, lo: Floats, hi: Floats, guess: Floats,
    ends: Floats, found: Floats, known: Floats,
) -> None:
    for n in range(site.shape[0]):
        for end in range(2):
            x, y, tx, ty, k, speed = evaluate(si, sf, cp, partner[n], hi[n] if end else lo[n], 0.0, 0.0)
            ends[n, 2 * end] = x
            ends[n, 2 * end + 1] = y
        x, y, r, sj = disc_beside(si, sf, cp, site[n], at[n], partner[n], lo[n], hi[n], guess[n], ends, n)
        found[n, 0] = x
        found[n, 1] = y
        found[n, 2] = r
        found[n, 3] = sj
        x, y, r, sj, dx, dy, dr = trace(si, sf, cp, site[n], at[n], partner[n], lo[n], hi[n])
        known[n, 0] = x
        known[n, 1] = y
        known[n, 2] = r
        known[n, 3] = sj


@pytest.mark.parametrize("name", SHAPES)
def test_from_any_guess(name: str) -> None:
    axis = solved(name, 1e-4)
    table, strip_i, strip_s = axis.table, axis.skeleton.strip_i, axis.skeleton.strip_s
    asked = [
        (a, b, a0 + share * (a1 - a0), b1, b0, b1 + guess * (b0 - b1))
        for (a, b), (a0, a1, b0, b1) in zip(strip_i[:, :2], strip_s, strict=True)
        if SPIRAL in table.si[[a, b], KIND]
        for share in SHARES
        for guess in GUESSES
    ]
    site, partner, at, lo, hi, guess = (np.array(column) for column in zip(*asked, strict=True))
    found, known = np.empty((len(at), 4)), np.empty((len(at), 4))
    both(table.si, table.sf, table.cp, site, partner, at, lo, hi, guess, np.empty((len(at), 4)), found, known)
    assert np.abs(found - known)[:, :3].max() <= SAME
    assert np.abs(found - known)[:, 3].max() <= NEAR
