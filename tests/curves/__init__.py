"""Tests of the curves of an axis: exact conics, fits with honest errors, splines, queries."""
