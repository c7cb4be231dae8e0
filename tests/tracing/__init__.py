"""Tests of the paper's published procedure, of its footpoints and its record of what is traced."""
