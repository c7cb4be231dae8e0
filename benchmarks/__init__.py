"""Benchmarks: per stage, size and tolerance."""
