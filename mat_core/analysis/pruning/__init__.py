"""Branches that say little cut off, cycles and components kept."""
