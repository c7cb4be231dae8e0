"""Tests of the ways out: the answer document and the picture."""
