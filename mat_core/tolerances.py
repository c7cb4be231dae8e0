"""Every tolerance of the solver, relative to the domain's normalised size, each with its reason."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Tolerances:
    """One rung of the ladder that `pipeline.medial_axis` climbs until the certificate passes.

    Lengths are in normalised coordinates (larger side of the domain in [0.5, 1]).

    Attributes
    ----------
    rounding : float
        Noise of a normalised coordinate: two units in the last place. Decides what is a straight line or a circle.
    smooth : float
        Radians; joints that turn by less are smooth, unless the caller's `smooth_angle` is smaller.
    same_disc : float
        Two discs found from different contacts are one if centre and radius agree this well.
    same_crossed : float
        The same, for discs whose contacts interleave: they cannot both be maximal, so more is forgiven.
    tie : float
        Relative difference of curvatures below which one more site touches a branch disc.
    same_node : float
        Branch discs joined by a strip are one node if centre and radius agree this well.
    """

    rounding: float = 4.5e-16
    smooth: float = math.inf
    same_disc: float = 1e-12
    same_crossed: float = 1e-10
    tie: float = 1e-11
    same_node: float = 1e-11


LADDER = (
    # what a clean drawing needs, then the same with ties told apart as finely as rounding allows
    Tolerances(),
    Tolerances(same_disc=1e-14, same_crossed=1e-12, tie=1e-13, same_node=1e-13),
    # nearly equal discs are one: inputs with noise of the size of these tolerances
    Tolerances(same_crossed=1e-8),
    Tolerances(same_disc=1e-10, same_crossed=1e-8, tie=1e-9, same_node=1e-9),
    # noise far below the certificate's limits is none: arcs are arcs but for it (a circle of them has no axis but its centre)
    Tolerances(rounding=1e-12, same_crossed=1e-8),
    # nothing smoothed: joints that turn by little are corners with branches of their own
    Tolerances(smooth=1e-13),
    Tolerances(smooth=1e-13, same_disc=1e-15, same_crossed=1e-13, tie=1e-15, same_node=1e-14),
    Tolerances(smooth=1e-13, same_disc=1e-12, same_crossed=1e-12, tie=1e-15, same_node=1e-12),
    Tolerances(smooth=1e-13, same_crossed=1e-8),
    # lines, circles and joints are what they are but for such noise
    Tolerances(smooth=1e-12, rounding=1e-13),
    Tolerances(smooth=1e-11, rounding=1e-12),
    Tolerances(smooth=1e-10, rounding=1e-11, same_disc=1e-10, same_crossed=1e-10, tie=1e-10, same_node=1e-10),
    Tolerances(smooth=3e-9, rounding=1e-10, same_disc=1e-9, same_crossed=1e-9, tie=1e-9, same_node=1e-9),
    Tolerances(same_disc=1e-8, same_crossed=1e-6, tie=1e-7, same_node=1e-8),
)
