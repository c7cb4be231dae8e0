"""The published procedure: M. Ramanathan and B. Gurumoorthy, "Constructing medial axis transform of planar domains with curved
boundaries", Computer-Aided Design (2003). Read beside the paper, section by section:

    paper                                        here
    3     the two criteria                       checks.curvature_holds, checks.cutting
    4     start at a convex vertex               walk.March.run
    5.1   tracing step                           step.tracing_step
    A     footpoint on the other edge            footpoint.corresponding_footpoint, footpoint.axis_point
    5.2   check for a branch point               checks.cutting, walk.March._trace; Proposition 1: record.Record.mark;
          bisection back to it                   branch.bisect_branch
    5.3   tracing from a branch point            branch.make_disc, branch.pair_from;
          where the curvature criterion fails    walk.March._missed, branch.curvature_ahead
    5.4   reflex vertices                        fans of normals are edges of no length: step.parameter_step
    5.5   smooth junctions, LMPC                 walk.March._reach_joint, walk.March._arrive
    5.6   termination                            walk.March.run, record.Record.check_complete

What is ours: edges are cut where their curvature turns; a footpoint at the end of its edge is checked for a branch point, too;
section 5.3 is followed not only where the curvature criterion fails but also where the edge that runs on is what cuts the disc;
edges that touch the disc of a branch point as well become footpoints of it; and what comes out is the flat `Skeleton` of the
discs-first method, so that curves, graph and certificate are the same, and the certificate judges.

The topology here depends on steps. A branch that begins and ends between two checks is missed, a hole in the pocket of a corner
may be (Proposition 2), and a domain without a convex vertex has no start. Then the end is an error that says where.
"""

from __future__ import annotations

import numpy as np

from mat_core.boundary.sites import SiteTable
from mat_core.errors import UnsupportedOption
from mat_core.kernels.layout import CONVEX_VERTEX, CORNER, EDGE, FAN, KIND, LEN, LOOP, SWEEP
from mat_core.topology.skeleton import Skeleton
from mat_core.tracing.march.step import DUMMY_EDGES
from mat_core.tracing.march.walk import March

DEFAULT_STEP = 1e-3  # section 6, for domains scaled to 1
EDGE_SHARE = 0.01  # section 6: one hundredth of the smallest edge, if that is smaller
MOST_DEFAULT_STEPS = 200_000  # ours: one very small edge does not make the default step as small; some seconds
DEFAULT_CHECK_STEP = 10  # section 6: "an order of magnitude greater"
MOST_STEPS = 2_000_000
ROUNDED_UP = 1.05  # what rounding to two digits may take from the step that an error names


def default_step(table: SiteTable, size: float) -> float:
    """Section 6: 0.001 of the size, or one hundredth of the smallest edge of the input, whichever is smaller; normalised.

    Not so small that all steps would be more than `MOST_DEFAULT_STEPS`.
    """
    _, edge = np.unique(table.si[:, [LOOP, EDGE]], axis=0, return_inverse=True)
    lengths = np.bincount(edge.ravel(), weights=table.sf[:, LEN])  # fans have none
    return max(min(DEFAULT_STEP * size, EDGE_SHARE * float(lengths.min())), _way(table) / MOST_DEFAULT_STEPS)


def _way(table: SiteTable) -> float:
    """What is stepped along in all, normalised: no part of the boundary twice, whichever side of a pair it is."""
    fans = table.si[:, KIND] == FAN
    return float(np.sum(table.sf[:, LEN]) + np.sum(np.abs(table.sf[fans, SWEEP])) / DUMMY_EDGES)


def march(table: SiteTable, size: float, step: float | None = None, check_step: int | None = None) -> Skeleton:
    """All discs, contacts and strips of the axis, by the published procedure.

    Parameters
    ----------
    table : SiteTable
    size : float
        Larger side of the domain, normalised.
    step : float, optional
        Tracing step, relative to the size; by default `default_step`.
    check_step : int, optional
        Tracing steps from one check for a branch point to the next; default 10.

    Returns
    -------
    Skeleton
        Not judged yet: the certificate does that.

    Raises
    ------
    UnsupportedOption
        There is no convex vertex to start from (method), or the steps would be too many (step); names one that will do.
    NotCertified
        The march lost its way; says where and why.
    """
    if not (table.si[:, CORNER] == CONVEX_VERTEX).any():
        raise UnsupportedOption(
            "method", '"march" starts at a convex vertex (section 4 of the paper) and this domain has none; use "discs"'
        )
    length = step * size if step is not None else default_step(table, size)
    if not _way(table) <= MOST_STEPS * length:
        steps = f"some {_way(table) / length:.3g} along this boundary, more than {MOST_STEPS}"
        least = ROUNDED_UP * _way(table) / (MOST_STEPS * size)
        advice = f'give {least:.2g} or more, or use method "discs"'
        raise UnsupportedOption("step", f"steps of {length / size:.3g} are {steps}; {advice}")
    walk = March(table, length, check_step or DEFAULT_CHECK_STEP)
    walk.run()
    return walk.record.skeleton()
