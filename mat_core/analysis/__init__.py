"""What people do with a medial axis: offset, measure, find, prune, rebuild.

Each function takes a `MedialAxis` and gives a frozen result with `to_dict()`; an argument out of its range raises
`UnsupportedOption` that names it. Lengths are in the caller's unit.
"""

from mat_core.analysis.centerline import Centerline, Extension, centerline
from mat_core.analysis.inscribed import InscribedDiscs, Part, inscribed_disc, inscribed_discs
from mat_core.analysis.nearest import Nearest, nearest
from mat_core.analysis.network import Completeness, Feature, completeness, to_networkx
from mat_core.analysis.offsetting.offset import offset, offsets
from mat_core.analysis.offsetting.parallel import Source
from mat_core.analysis.offsetting.regions import Offset, OffsetEdge, OffsetLoop, OffsetRegion
from mat_core.analysis.places import AxisDisc
from mat_core.analysis.proving.proof import ProvenErrors, prove_errors
from mat_core.analysis.pruning.peeling import Cut
from mat_core.analysis.pruning.prune import prune
from mat_core.analysis.pruning.pruned import PrunedAxis, PrunedNode, PrunedSegment
from mat_core.analysis.rebuilding.reconstruct import Reconstruction, reconstruct
from mat_core.analysis.touching import BoundaryInterval
from mat_core.analysis.width import Thickness, Wall, Width, width

__all__ = [
    "AxisDisc",
    "BoundaryInterval",
    "Centerline",
    "Completeness",
    "Cut",
    "Extension",
    "Feature",
    "InscribedDiscs",
    "Nearest",
    "Offset",
    "OffsetEdge",
    "OffsetLoop",
    "OffsetRegion",
    "Part",
    "ProvenErrors",
    "PrunedAxis",
    "PrunedNode",
    "PrunedSegment",
    "Reconstruction",
    "Source",
    "Thickness",
    "Wall",
    "Width",
    "centerline",
    "completeness",
    "inscribed_disc",
    "inscribed_discs",
    "nearest",
    "offset",
    "offsets",
    "prove_errors",
    "prune",
    "reconstruct",
    "to_networkx",
    "width",
]
