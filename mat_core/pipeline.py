"""The stages in order: sites, skeleton, graph, curves, certificate.

The skeleton is found from maximal discs, or on request by the paper's own march; everything else is the same.

Each single setting of the tolerances has a narrow band of input noise, near its own size, where ties are told apart wrongly; the
bands differ. So the stages are run for each rung of `tolerances.LADDER` until a result passes its certificate (the march, whose
steps decide, has the first rung only). Nothing else is ever returned. Rungs often tell the same discs apart: a skeleton whose
curves or certificate failed is not tried again.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mat_core.axis import MedialAxis
from mat_core.boundary.sites import SiteTable, build_sites
from mat_core.certificate import certify
from mat_core.curves.assemble import build_axis
from mat_core.errors import NotCertified, UnsupportedOption
from mat_core.model.domain import Domain
from mat_core.threads import threads_allowed
from mat_core.tolerances import LADDER, Tolerances
from mat_core.topology.building import build_skeleton
from mat_core.topology.graph import AxisGraph, build_graph
from mat_core.topology.skeleton import Skeleton
from mat_core.tracing.march import march

TOLERANCE_RANGE = (1e-12, 1e-1)
FITS = (1.0, 0.3, 0.03)  # of the tolerance, for curves that are fitted again: what they state may be far below it
OF_CURVES = frozenset(("curves_on_axis", "curves_empty"))  # checks that fail where a curve is farther off than it states
METHODS = ("discs", "march")
CHECK_STEP_RANGE = (1, 10**6)

STAGES = {"sites": 0.0, "skeleton": 0.05, "graph": 0.3, "curves": 0.35, "certificate": 0.45}
"""The stages that are reported as they begin, with the share of a large domain's time that lies before each, roughly."""

LEAST_TOLERANCE = "; all else is right, but the curves can be told to {:.2g} of the size only: ask for no finer tolerance"
"""What a failure says beside that when nothing but the tolerance is out of reach."""

ROUNDED_UP = 1.05  # so that two digits are no less

Progress = Callable[[str, float], None]


def medial_axis(
    domain: Domain,
    tolerance: float = 1e-6,
    method: str = "discs",
    step: float | None = None,
    smooth_angle: float = 1e-6,
    check_step: int | None = None,
    *,
    progress: Progress | None = None,
    threads: int | None = None,
) -> MedialAxis:
    """The certified medial axis transform of a domain.

    Parameters
    ----------
    domain : Domain
        From `Domain.from_dict`.
    tolerance : float
        Largest error of the fitted curves (in x, y and radius together), relative to the larger side of the bounding box;
        1e-12 to 0.1. Segments between lines, circular arcs and points are exact and do not depend on it.
    method : str
        "discs": maximal discs first, then tracing. "march": the paper's published procedure, step by step along the boundary from
        a convex vertex; it needs one, and may miss branches where its steps are too long (`mat_core.tracing.march`).
    step : float, optional
        Largest spacing of sample points along the axis, relative to the larger side of the bounding box; at least 1e-6. The
        curves do not depend on it. With "march" it is the tracing step along the boundary, too (the paper's section 6); there the
        default is 0.001, or one hundredth of the smallest edge if that is smaller, in 200,000 steps at most.
    smooth_angle : float
        Radians, 0 to 0.1; joints that turn by less are smooth: no branch of the axis runs into them (none does into a reflex one,
        so these are only smooth where they hardly turn). They are corners after all where they are how tiny sides bend (a convex
        joint turns by more than a hundredth of the normalised length of a side beside it), or where no axis with them smoothed
        passes its certificate (the rest of the boundary is nearly a circle, say).
    check_step : int, optional
        Tracing steps of "march" from one check for a branch point to the next, 1 to 1,000,000; default 10. "discs", whose check
        is exact, has no use for it.
    progress : callable, optional
        Called as each of `STAGES` begins, with its name and the share that is done. It begins again with each rung of the ladder.
    threads : int, optional
        How many may work on a large domain at a time; the answer does not depend on it, bit by bit. Default: the environment
        variable MAT_CORE_THREADS, and without that all processors this process may run on. Domains of fewer than some thousand
        edges are solved on the caller's thread alone, "march" always is up to its certificate.

    Returns
    -------
    MedialAxis

    Raises
    ------
    UnsupportedOption
        An argument is out of its range; or "march" finds no convex vertex, or would take more than two million steps.
    NotCertified
        No rung of the ladder of tolerances gave a result that passes its certificate; names the check and the place. With
        "march": it lost its way, or missed a branch.

    Notes
    -----
    What no disc sees has no branch of its own: a bend within 4e-13 of the normalised size from an end of an edge or a knot, and a
    rise of the curvature that no disc of the domain reaches over by more than the rounding of a normalised coordinate. Discs are
    those of the boundary without such bends: one of radius r with contacts d apart, one of them on a bend of width w, differs by
    some w r^2 / d^2 from the disc that touches the bend itself.

    After M. Ramanathan and B. Gurumoorthy, "Constructing medial axis transform of planar domains with curved boundaries" (2003),
    with branch points found from maximal discs before anything is traced.
    """
    _check_options(tolerance, method, step, smooth_angle, check_step)
    threads = threads_allowed(threads)
    if method == "march":
        return _march(domain, tolerance, step, smooth_angle, check_step, progress, threads)
    told: NotCertified | None = None
    failed: set[bytes] = set()
    for tolerances in LADDER:
        _begin(progress, "sites")
        table = build_sites(domain, min(smooth_angle, tolerances.smooth), tolerances)
        _begin(progress, "skeleton")
        try:
            skeleton, graph = _network(table, build_skeleton(table, tolerances, threads), tolerances, progress)
        except NotCertified as error:
            told = _more_helpful(told, error)
            continue
        if failed and _fingerprint(table, skeleton) in failed:
            continue
        try:
            return _finish(domain, table, skeleton, graph, tolerance, step, progress, threads)
        except NotCertified as error:
            told = _more_helpful(told, error)
            failed.add(_fingerprint(table, skeleton))
    assert told is not None
    raise told


def _march(
    domain: Domain,
    tolerance: float,
    step: float | None,
    smooth_angle: float,
    check_step: int | None,
    progress: Progress | None,
    threads: int,
) -> MedialAxis:
    """The published procedure, judged as any other result."""
    tolerances = LADDER[0]
    _begin(progress, "sites")
    table = build_sites(domain, min(smooth_angle, tolerances.smooth), tolerances)
    _begin(progress, "skeleton")
    skeleton = march(table, domain.size * table.scale, step, check_step)
    try:
        return _finish(domain, table, *_network(table, skeleton, tolerances, progress), tolerance, step, progress, threads)
    except NotCertified as error:
        advice = f'{error.detail} (a march misses a branch that its steps pass over; use a smaller step, or method "discs")'
        raise NotCertified(advice, error.place, error.certificate) from error


def _network(
    table: SiteTable, skeleton: Skeleton, tolerances: Tolerances, progress: Progress | None
) -> tuple[Skeleton, AxisGraph]:
    """The graph of a skeleton, and the skeleton that it refers to."""
    _begin(progress, "graph")
    return build_graph(table, skeleton, tolerances)


def _fingerprint(table: SiteTable, skeleton: Skeleton) -> bytes:
    """A hash of all that curves and certificate depend on: the boundary as it was cut, and the contracted skeleton."""
    found = hashlib.blake2b(np.float64(table.smooth_angle).tobytes())
    for array in (table.si, table.sf, table.cp, *skeleton):
        found.update(np.ascontiguousarray(array).tobytes())
    return found.digest()


def _finish(
    domain: Domain,
    table: SiteTable,
    skeleton: Skeleton,
    graph: AxisGraph,
    tolerance: float,
    step: float | None,
    progress: Progress | None,
    threads: int,
) -> MedialAxis:
    """Curves and certificate of a skeleton and its graph.

    How far a curve may be from the axis rests on an assumption (`curves.interval`): where the certificate refutes it and nothing
    else, curves are fitted more closely, with other pieces.
    """
    for closer in FITS:
        _begin(progress, "curves")
        axis = build_axis(domain, table, skeleton, graph, tolerance, step, threads, closer)
        _begin(progress, "certificate")
        certificate = certify(table, skeleton, graph, axis.curves, tolerance, domain=domain, threads=threads)
        if certificate.passed:
            return axis.with_certificate(certificate)
        failed = _failed(certificate)
        if not OF_CURVES.issuperset(failed):
            break
    check = certificate["checks"][failed[0]]
    place = tuple(check["place"]) if check.get("place") else None
    error = NotCertified(f"{failed[0]}: {check['detail']}", place, certificate)
    nearest = _nearest(error)
    if nearest < math.inf:
        error = NotCertified(error.detail + LEAST_TOLERANCE.format(ROUNDED_UP * nearest), place, certificate)
    raise error


def _more_helpful(known: NotCertified | None, error: NotCertified) -> NotCertified:
    """The failure of a rung to tell: the first one, unless all is right but that curves are not near enough."""
    return error if known is None or _nearest(error) < _nearest(known) else known


def _nearest(error: NotCertified) -> float:
    """How near the curves are, relative to the size, where this is all that is wrong; else infinity."""
    if _failed(error.certificate) != ["curves_tolerance"]:
        return math.inf
    checks: Any = error.certificate["checks"]
    return float(checks["curves_tolerance"]["measured"])


def _failed(certificate: Mapping[str, Any]) -> list[str]:
    """The names of the checks that a certificate fails; of none, without a certificate."""
    return [name for name, check in certificate.get("checks", {}).items() if not check["passed"]]


def _begin(progress: Progress | None, stage: str) -> None:
    """Report that a stage begins."""
    if progress is not None:
        progress(stage, STAGES[stage])


def _check_options(
    tolerance: float, method: str, step: float | None, smooth_angle: float, check_step: int | None
) -> None:
    """Raise UnsupportedOption for an argument out of its range."""
    if method not in METHODS:
        raise UnsupportedOption("method", f"{method!r} is not available; use one of {', '.join(METHODS)}")
    if not TOLERANCE_RANGE[0] <= tolerance <= TOLERANCE_RANGE[1]:
        raise UnsupportedOption("tolerance", f"{tolerance} is not between {TOLERANCE_RANGE[0]} and {TOLERANCE_RANGE[1]}")
    if step is not None and not (step >= 1e-6 and math.isfinite(step)):
        raise UnsupportedOption("step", f"{step} is not a number of at least 1e-6")
    if not 0.0 <= smooth_angle <= 0.1:
        raise UnsupportedOption("smooth_angle", f"{smooth_angle} is not between 0 and 0.1 rad")
    if check_step is not None:
        low, high = CHECK_STEP_RANGE
        if not isinstance(check_step, int) or isinstance(check_step, bool) or not low <= check_step <= high:
            raise UnsupportedOption("check_step", f"{check_step} is not a whole number of tracing steps from {low} to {high}")
