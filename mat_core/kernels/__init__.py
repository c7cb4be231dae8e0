"""Compiled leaf functions over flat arrays. They import nothing else of ours."""
