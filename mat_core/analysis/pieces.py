"""The pieces of an axis as Bezier curves in (x, y, r)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mat_core.axis import MedialAxis
from mat_core.kernels.bezier import decompose

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def bezier_pieces(axis: MedialAxis) -> tuple[Ints, Floats]:
    """Every piece, in the order of `CurveTable`'s parts: its own share of the polynomial that may go through several.

    Returns
    -------
    degree : (P,) int64
    rows : (P, largest degree + 1, 4) float64
        Control discs x, y, r (normalised) and weight; the last one repeated where the degree is lower.
    """
    c = axis.curves
    parts = len(c.part_f)
    degree: Ints = c.degree[c.part_segment] if parts else np.empty(0, dtype=np.int64)
    width = int(c.degree.max(initial=1)) + 1
    rows = np.empty((parts, width, 4))
    most = int(np.diff(c.cp_start).max(initial=1)) * width
    out, breaks = np.empty((most, 3)), np.empty(most + 1)
    # two coordinates and a weight at a time: (x, y), then (r, r)
    for columns in ([0, 1, 3], [2, 2, 3]):
        control = np.ascontiguousarray(c.cp[:, columns])
        for g, p in enumerate(c.degree.tolist()):
            k0, k1, c0, c1 = c.knot_start[g], c.knot_start[g + 1], c.cp_start[g], c.cp_start[g + 1]
            n = decompose(p, c.knots, k0, k1 - k0, control, c0, c1 - c0, out, breaks)
            own = slice(int(c.part_start[g]), int(c.part_start[g + 1]))
            spans = np.clip(np.searchsorted(breaks[: n + 1], c.part_f[own, :2].mean(axis=1)) - 1, 0, n - 1)
            begin, end = breaks[spans], breaks[spans + 1]
            share = np.clip((c.part_f[own, :2] - begin[:, None]) / (end - begin)[:, None], 0.0, 1.0)
            found = _shares(out[: n * (p + 1)].reshape(n, p + 1, 3)[spans], share)
            rows[own, : p + 1][:, :, columns] = found
            rows[own, p + 1 :][:, :, columns] = found[:, -1:]
    return degree, rows


def _shares(rows: Floats, share: Floats) -> Floats:
    """The parts [a, b] of Beziers, rows (m, p + 1, 3): two coordinates and a weight; `share` (m, 2)."""
    part = ((share[:, 0] > 0.0) | (share[:, 1] < 1.0)) & (share[:, 0] < share[:, 1])
    if not part.any():
        return rows
    a, b = share[part, 0, None, None], share[part, 1, None, None]
    h = rows[part].copy()
    h[:, :, :2] *= h[:, :, 2:]
    p = h.shape[1] - 1
    for level in range(1, p + 1):
        h[:, level:] = (1.0 - b) * h[:, level - 1 : -1] + b * h[:, level:]
    for level in range(1, p + 1):
        h[:, : p + 1 - level] = (1.0 - a / b) * h[:, : p + 1 - level] + a / b * h[:, 1 : p + 2 - level]
    h[:, :, :2] /= h[:, :, 2:]
    result = rows.copy()
    result[part] = h
    return result
