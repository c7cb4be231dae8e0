"""Curves at a distance from the boundary, inward and outward, trimmed by the axis."""
