"""The answer: the axis as people use it, its segments, nodes, lengths and samples, all views of flat arrays."""

from mat_core.axis.medial_axis import MedialAxis
from mat_core.axis.records import Footpoint, Point
from mat_core.axis.segment import Segment

__all__ = ["Footpoint", "MedialAxis", "Point", "Segment"]
