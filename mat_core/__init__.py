"""Certified medial axis transforms of planar domains bounded by rational B-splines."""

from pathlib import Path

from mat_core.axis import MedialAxis
from mat_core.errors import InvalidDomain, MatError, NotCertified, Problem, UnsupportedOption
from mat_core.model.domain import Domain
from mat_core.pipeline import medial_axis
from mat_core.warm import warm

__version__ = (Path(__file__).parent / "VERSION").read_text(encoding="ascii").strip()

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
