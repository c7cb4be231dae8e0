"""The stages in order: sites, skeleton, graph, curves, certificate.

Each single setting of the tolerances has a narrow band of input noise, near its own size, where ties are told apart wrongly; the
bands differ. So the stages are run for each rung of `tolerances.LADDER` until a result passes its certificate. Nothing else is
ever returned.
"""

from __future__ import annotations

import math

from mat_core.axis import MedialAxis
from mat_core.boundary.sites import build_sites
from mat_core.certificate import certify
from mat_core.curves.assemble import build_axis
from mat_core.errors import NotCertified, UnsupportedOption
from mat_core.model.domain import Domain
from mat_core.tolerances import LADDER, Tolerances
from mat_core.topology.graph import build_graph
from mat_core.topology.skeleton import build_skeleton

TOLERANCE_RANGE = (1e-12, 1e-1)
METHODS = ("discs",)


def medial_axis(
    domain: Domain,
    tolerance: float = 1e-6,
    method: str = "discs",
    step: float | None = None,
    smooth_angle: float = 1e-6,
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
        "discs": maximal discs first, then tracing.
    step : float, optional
        Largest spacing of sample points along the axis, relative to the larger side of the bounding box (the paper's tracing
        step, section 6). The curves do not depend on it.
    smooth_angle : float
        Radians, 0 to 0.1; joints that turn by less are smooth: no branch of the axis runs into them. Where no axis with them
        smoothed passes its certificate (the rest of the boundary is nearly a circle, say), they are corners after all.

    Returns
    -------
    MedialAxis

    Raises
    ------
    UnsupportedOption
        An argument is out of its range.
    NotCertified
        No rung of the ladder of tolerances gave a result that passes its certificate; names the check and the place.

    Notes
    -----
    After M. Ramanathan and B. Gurumoorthy, "Constructing medial axis transform of planar domains with curved boundaries" (2003),
    with branch points found from maximal discs before anything is traced.
    """
    _check_options(tolerance, method, step, smooth_angle)
    first: NotCertified | None = None
    for tolerances in LADDER:
        try:
            return _solve(domain, tolerance, step, smooth_angle, tolerances)
        except NotCertified as error:
            first = first or error
    assert first is not None
    raise first


def _solve(domain: Domain, tolerance: float, step: float | None, smooth_angle: float, tolerances: Tolerances) -> MedialAxis:
    """One rung of the ladder."""
    smoothed = min(smooth_angle, tolerances.smooth)
    table = build_sites(domain, smoothed, tolerances)
    skeleton, graph = build_graph(table, build_skeleton(table, tolerances), tolerances)
    axis = build_axis(domain, table, skeleton, graph, tolerance, step)
    certificate = certify(table, skeleton, graph, axis.curves, tolerance, domain=domain)
    certificate["smooth_angle"] = smoothed
    if not certificate["passed"]:
        name, check = next((name, check) for name, check in certificate["checks"].items() if not check["passed"])
        place = tuple(check["place"]) if check.get("place") else None
        raise NotCertified(f"{name}: {check['detail']}", place, certificate)
    return axis.with_certificate(certificate)


def _check_options(tolerance: float, method: str, step: float | None, smooth_angle: float) -> None:
    """Raise UnsupportedOption for an argument out of its range."""
    if method not in METHODS:
        raise UnsupportedOption("method", f"{method!r} is not available; use one of {', '.join(METHODS)}")
    if not TOLERANCE_RANGE[0] <= tolerance <= TOLERANCE_RANGE[1]:
        raise UnsupportedOption("tolerance", f"{tolerance} is not between {TOLERANCE_RANGE[0]} and {TOLERANCE_RANGE[1]}")
    if step is not None and not (step >= 1e-6 and math.isfinite(step)):
        raise UnsupportedOption("step", f"{step} is not a number of at least 1e-6")
    if not 0.0 <= smooth_angle <= 0.1:
        raise UnsupportedOption("smooth_angle", f"{smooth_angle} is not between 0 and 0.1 rad")
