"""Tests of the whole: a domain goes in, the axis that comes out is right."""
