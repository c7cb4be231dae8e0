"""Lengths of stretches of the axis' curves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from mat_core.axis import MedialAxis

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LENGTH_NODES = 12  # Gauss points for the length of one stretch
LENGTH_ERROR = 1e-13  # relative, of the length of a stretch: above it is halved
LENGTH_ROUNDING = 1e-15  # relative to coordinates: no length is known better
LENGTH_HALVINGS = 60  # a weight of 2^60 keeps nearly all of its curve within 2^-60 of its ends


def curve_lengths(axis: MedialAxis, segment: Ints, t0: Floats, t1: Floats) -> Floats:
    """Lengths of stretches of curves of centres.

    Gauss quadrature, halved until halves and whole agree and the length is no less than the chord: a conic with a large weight
    in its middle runs nearly all of its way within a small part of t.

    Parameters
    ----------
    axis : MedialAxis
    segment : (n,) int64
    t0, t1 : (n,) float64
        Ends, t0 <= t1; each stretch lies on one piece.

    Returns
    -------
    (n,) float64
        In the caller's unit.
    """
    out = np.zeros(len(t0))
    row, low, high = np.arange(len(t0)), t0, t1
    whole = _gauss(axis, segment, low, high)
    ends = [axis.evaluate(segment, t)[:, :2] for t in (t0, t1)]
    rounding = LENGTH_ROUNDING * max(axis.domain.size, *(abs(v) for v in axis.domain.bbox))
    # what is left of a stretch need not be known better than the stretch, nor than points are
    allowed = np.maximum(LENGTH_ERROR * np.maximum(whole, np.hypot(*(ends[1] - ends[0]).T)), rounding)
    for step in range(LENGTH_HALVINGS + 1):
        middle = 0.5 * (low + high)
        own = segment[row]
        left, right = _gauss(axis, own, low, middle), _gauss(axis, own, middle, high)
        between = axis.evaluate(own, middle)[:, :2]
        chords = np.hypot(*(between - ends[0]).T) + np.hypot(*(ends[1] - between).T)
        better = left + right
        rough = (np.abs(better - whole) > allowed[row]) | (better < chords - 2.0 * allowed[row])
        rough &= step < LENGTH_HALVINGS
        np.add.at(out, row[~rough], better[~rough])
        if not rough.any():
            break
        row = np.tile(row[rough], 2)
        low, high = np.concatenate((low[rough], middle[rough])), np.concatenate((middle[rough], high[rough]))
        ends = [np.concatenate((ends[0][rough], between[rough])), np.concatenate((between[rough], ends[1][rough]))]
        whole = np.concatenate((left[rough], right[rough]))
    return out


def _gauss(axis: MedialAxis, segment: Ints, t0: Floats, t1: Floats) -> Floats:
    """(n,) integrals of the speed from t0 to t1."""
    nodes, weights = np.polynomial.legendre.leggauss(LENGTH_NODES)
    half = 0.5 * (t1 - t0)
    t = 0.5 * (t0 + t1)[:, None] + half[:, None] * nodes
    d = axis.evaluate(np.repeat(segment, LENGTH_NODES), t.reshape(-1))[:, 3:5]
    out: Floats = half * (np.hypot(d[:, 0], d[:, 1]).reshape(-1, LENGTH_NODES) @ weights)
    return out
