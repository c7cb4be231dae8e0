"""What people do with a medial axis: offset, measure, find, prune, rebuild.

Each function takes a `MedialAxis` and gives a frozen result with `to_dict()`; an argument out of its range raises
`UnsupportedOption` that names it. Lengths are in the caller's unit.
"""

from mat_core.analysis.offset import offset, offsets
from mat_core.analysis.parallel import Source
from mat_core.analysis.reconstruct import Reconstruction, reconstruct
from mat_core.analysis.regions import Offset, OffsetEdge, OffsetLoop, OffsetRegion

__all__ = [
    "Offset",
    "OffsetEdge",
    "OffsetLoop",
    "OffsetRegion",
    "Reconstruction",
    "Source",
    "offset",
    "offsets",
    "reconstruct",
]
