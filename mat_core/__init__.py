"""Certified medial axis transforms of planar domains bounded by rational B-splines."""

from mat_core.axis import MedialAxis
from mat_core.errors import InvalidDomain, MatError, NotCertified, Problem, UnsupportedOption
from mat_core.model.domain import Domain
from mat_core.pipeline import medial_axis
from mat_core.warm import warm

__version__ = "0.1.0"

__all__ = [
    "Domain",
    "InvalidDomain",
    "MatError",
    "MedialAxis",
    "NotCertified",
    "Problem",
    "UnsupportedOption",
    "medial_axis",
    "warm",
]
